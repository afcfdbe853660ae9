//! Colour fringe: edges of one lamp colour, or of one channel, that lie beside those of the reference colour.

use std::collections::BTreeMap;

use firstbounce_core::capture_checks::{FringeSpectrum, FringeWindow, find_fringe};

use super::{CaptureWarning, CheckOptions, Seen};
use crate::set::CaptureSet;

/// Warns of each colour whose edges lie beside those of the reference.
pub(super) fn fringes(
    set: &CaptureSet,
    options: &CheckOptions,
    window: Option<&FringeWindow>,
    seen: &BTreeMap<usize, Seen>,
) -> Vec<CaptureWarning> {
    let (Some(window), Some((reference, others))) = (window, set.colours.split_first()) else { return Vec::new() };
    let spectrum = |light: &str, colour: &str| -> Option<&FringeSpectrum> {
        let is_it = |shot: usize| {
            let shot = &set.shots[shot];
            shot.light.as_deref() == Some(light) && shot.colour.as_deref() == Some(colour)
        };
        seen.iter().filter(|(shot, _)| is_it(**shot)).find_map(|(_, seen)| seen.fringe.as_ref())
    };
    let warning = |colour: &String| {
        let pair = |light: &str| Some((spectrum(light, &reference.name)?, spectrum(light, colour)?));
        let lights: Vec<_> = set.lights.iter().filter_map(|light| pair(&light.name)).collect();
        // The options were checked when the check began.
        let fringe = find_fringe(window, &lights, &options.fringe).ok().flatten()?;
        Some(CaptureWarning::ColourFringe {
            reference: reference.name.clone(),
            colour: colour.clone(),
            shift_px: fringe.shift_px,
            at_px: fringe.at_px,
            is_uniform: fringe.is_uniform,
        })
    };
    others.iter().filter_map(|colour| warning(&colour.name)).collect()
}
