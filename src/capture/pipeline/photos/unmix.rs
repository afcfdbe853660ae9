//! Crosstalk undone in the photos of one subject.

use std::sync::Arc;

use firstbounce_core::Photo;
use firstbounce_core::image::mixing::{Mixing, MixingError};
use firstbounce_core::image::noise::NoiseModel;
use indexmap::IndexMap;

use super::object::stated_noise;
use crate::image_file::LinearLight;
use crate::set::CaptureSet;

/// By (light, colour).
type Shots = IndexMap<(usize, Option<usize>), Arc<LinearLight>>;

/// Replaces photos in the channels of a camera by photos in the light of each lamp colour, where the set gives the crosstalk. Lights
/// without a photo in every colour stay as they are: what is missing there is told elsewhere. All photos have one size.
pub(super) fn unmix(set: &CaptureSet, shots: &mut Shots) -> Result<(), MixingError> {
    let Some(rows) = &set.camera.crosstalk else { return Ok(()) };
    let mixing = Mixing::new(rows, set.colours.len())?;
    for light in 0..set.lights.len() {
        let of_light = (0..set.colours.len()).map(|colour| shots.get(&(light, Some(colour))).cloned());
        let Some(channels) = of_light.collect::<Option<Vec<_>>>() else { continue };
        for (colour, unmixed) in unmixed(set, &mixing, &channels)?.into_iter().enumerate() {
            shots.insert((light, Some(colour)), Arc::new(unmixed));
        }
    }
    Ok(())
}

fn unmixed(set: &CaptureSet, mixing: &Mixing, channels: &[Arc<LinearLight>]) -> Result<Vec<LinearLight>, MixingError> {
    let photos: Vec<&Photo> = channels.iter().map(|light| &*light.photo).collect();
    let dark_below: Vec<f32> = channels.iter().map(|light| light.dark_below / light.exposure).collect();
    // Grain is measured on what comes out; what is known of each channel by itself is carried over.
    let noise: Option<Vec<NoiseModel>> = channels.iter().map(|light| stated_noise(set, light)).collect();
    let lights = mixing.undo(&photos, &dark_below)?.into_iter().zip(channels).enumerate();
    let light = |(colour, (photo, channel)): (usize, (Photo, &Arc<LinearLight>))| {
        let combined_noise = noise.as_ref().map(|noise| mixing.noise(colour, &photos, noise)).transpose()?;
        Ok(LinearLight { photo: Arc::new(photo), noise: None, combined_noise, ..(**channel).clone() })
    };
    lights.map(light).collect()
}
