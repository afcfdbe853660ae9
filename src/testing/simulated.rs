//! Simulated sets.

use std::path::Path;

use firstbounce_core::Unwatched;
use firstbounce_lab::simulate::{BallOptions, SimulateOptions, simulate, write_simulated};

/// Writes a set of a corner with its balls in pictures as small as there can be.
pub fn write_tiny_set(folder: &Path) {
    let albedos = SimulateOptions::default().albedos;
    let options = SimulateOptions {
        patches: 40,
        size_px: 16,
        samples_per_pixel_side: 1,
        truth_bounces: 2,
        balls: Some(BallOptions { size_px: 32, ..BallOptions::for_paint(&albedos) }),
        ..SimulateOptions::default()
    };
    write_simulated(&simulate(&options, &Unwatched).unwrap(), folder).unwrap();
}
