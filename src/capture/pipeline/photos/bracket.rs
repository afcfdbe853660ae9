//! Brackets: a shot whose files were exposed differently is read exposure by exposure, and combined to one photo.

use std::sync::{Arc, Mutex, PoisonError};

use firstbounce_core::Mask;
use firstbounce_core::image::bracket::{Bracket, BracketOptions, BracketPart, Contradiction, combine_bracket};

use super::object::noise_of;
use super::{Exposures, ShotLight};
use crate::image_file::{ImageError, ImageWarning, LinearLight};
use crate::set::{CaptureSet, Shot};

/// The exposures of a shot, each a shot of its own; one where it is no bracket.
pub(super) fn parts_of(shot: &Shot, exposures: &Exposures) -> Vec<Shot> {
    let Some(bracket) = exposures.bracket(shot) else { return vec![shot.clone()] };
    let mut parts: Vec<Shot> = Vec::new();
    for (file, exposure) in shot.files.iter().zip(bracket) {
        match parts.iter_mut().find(|part| part.exposure == Some(*exposure)) {
            Some(part) => part.files.push(file.clone()),
            None => parts.push(Shot {
                files: vec![file.clone()],
                exposure: Some(*exposure),
                exposures: Vec::new(),
                ..shot.clone()
            }),
        }
    }
    parts
}

/// Gathers the exposures of one shot as they come.
pub(super) struct Gathered {
    parts: Mutex<Vec<Option<ShotLight>>>,
}

impl Gathered {
    pub fn of(parts: usize) -> Self {
        Self { parts: Mutex::new(vec![None; parts]) }
    }

    /// Puts an exposure by; the photo once all are there.
    pub fn put(&self, set: &CaptureSet, part: usize, light: &ShotLight) -> Option<ShotLight> {
        let mut parts = self.parts.lock().unwrap_or_else(PoisonError::into_inner);
        parts[part] = Some(light.clone());
        let all: Vec<ShotLight> = parts.iter().cloned().collect::<Option<_>>()?;
        parts.clear();
        drop(parts);
        Some(match all.into_iter().collect::<Result<Vec<_>, _>>() {
            Ok(parts) if parts.len() == 1 => Ok(parts[0].clone()),
            Ok(parts) => combined(set, &parts).map(Arc::new).map_err(Arc::new),
            Err(error) => Err(error),
        })
    }
}

fn combined(set: &CaptureSet, lights: &[Arc<LinearLight>]) -> Result<LinearLight, ImageError> {
    let noise = |light: &LinearLight| {
        let (width, height) = light.photo.linear.size();
        noise_of(set, light, &Mask::filled(width, height, true))
    };
    let part = |light: &Arc<LinearLight>| (light.clone(), f64::from(light.exposure), noise(light));
    let parts: Vec<_> = lights.iter().map(part).collect();
    let parts: Vec<_> = parts
        .iter()
        .map(|(light, exposure, noise)| BracketPart { photo: &light.photo, exposure: *exposure, noise: *noise })
        .collect();
    let first_path = |light: &LinearLight| light.files.first().map(|(path, _)| path.clone()).unwrap_or_default();
    let refused = |reason| ImageError::Bracket { path: first_path(&lights[0]), reason };
    let Bracket { photo, noise, report } = combine_bracket(&parts, &BracketOptions::default()).map_err(refused)?;
    let contradicted = |&Contradiction { part, stated, measured }: &Contradiction| ImageWarning::ExposureContradicted {
        path: first_path(&lights[part]),
        stated,
        measured,
    };
    let warnings = lights.iter().flat_map(|light| light.warnings.clone());
    let least = |of: fn(&LinearLight) -> f32| lights.iter().map(|light| of(light)).fold(f32::INFINITY, f32::min);
    Ok(LinearLight {
        photo: Arc::new(photo),
        repeats: lights.iter().map(|light| light.repeats).sum(),
        noise: None,
        combined_noise: Some(noise),
        variance_share: 1.0,
        dark_below: least(|light| light.dark_below / light.exposure),
        exposure: 1.0,
        files: lights.iter().flat_map(|light| light.files.clone()).collect(),
        quantisation_step: least(|light| light.quantisation_step),
        warnings: warnings.chain(report.contradictions.iter().map(contradicted)).collect(),
        facts: lights.iter().flat_map(|light| light.facts.clone()).collect(),
    })
}
