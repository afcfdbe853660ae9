//! Lens distortion undone in a photo, once, before anything looks at it.

use std::sync::Arc;

use firstbounce_core::Mask;
use firstbounce_core::image::distortion::{Undistorted, undistort};
use firstbounce_core::image::noise::estimate_noise;

use super::key::LensKey;
use crate::image_file::{ImageError, LinearLight, LinearOptions};

/// A photo as a pinhole would have taken it. Resampling smooths grain: where nothing else tells the noise, it is measured before.
pub(super) fn undistorted(
    light: LinearLight,
    lens: Option<&LensKey>,
    options: &LinearOptions,
) -> Result<LinearLight, ImageError> {
    let (width, height) = light.photo.linear.size();
    let Some(lens) = lens.and_then(|lens| lens.lens((width, height))) else { return Ok(light) };
    let refused = |reason| {
        let path = light.files.first().map(|(path, _)| path.clone()).unwrap_or_default();
        ImageError::Distortion { path, reason }
    };
    let Undistorted { photo, variance_share, .. } = undistort(&light.photo, &lens).map_err(refused)?;
    let is_known = options.noise_floor.is_some() || light.noise.is_some();
    let grain = || {
        let everywhere = Mask::filled(width, height, true);
        estimate_noise(&light.photo, &everywhere, f64::from(light.quantisation_step)).scaled(variance_share)
    };
    let combined_noise = (!is_known).then(grain);
    Ok(LinearLight { photo: Arc::new(photo), combined_noise, variance_share, ..light })
}
