//! Compares surfaces with the truth, over the same pixels whatever the way to them.

use firstbounce_core::image::evaluate::{relative_error, rmse_without_offset};
use firstbounce_core::mesh::LengthUnit;
use firstbounce_core::separate::Separation;
use firstbounce_core::stereo::depth::Depth;
use firstbounce_core::{Camera, Mask, NormalMap, Plane};

use super::super::truth::{true_normals, true_plane};
use super::super::{PipelineError, camera_of};
use super::Angles;
use crate::set::CaptureSet;

/// What a rendered set knows of itself.
pub(super) struct Truth {
    pub normals: NormalMap,
    /// Where the camera's scale is known.
    pub depth: Option<Plane>,
    /// By light.
    pub direct: Option<Vec<Plane>>,
}

impl Truth {
    pub(super) fn of(set: &CaptureSet, size: (usize, usize)) -> Result<Self, PipelineError> {
        let path = set.truth_depth();
        let known = camera_of(set, size).unit() == LengthUnit::Millimetre && path.is_file();
        Ok(Self {
            normals: true_normals(&set.truth_normals(), size)?,
            depth: known.then(|| true_plane(&path, size)).transpose()?,
            direct: true_bounces(set, 1, size)?,
        })
    }
}

pub(super) struct Judge {
    pub camera: Camera,
    /// Pixels with a true normal.
    pub with_truth: Mask,
    /// Of those, what every way solved.
    pub compared: Mask,
    pub truth: Truth,
}

impl Judge {
    pub(super) fn normals(&self, found: &NormalMap) -> Result<Angles, PipelineError> {
        let error = found.angular_error(&self.truth.normals, &self.compared);
        error.map(Angles::from).ok_or(PipelineError::NothingToCompare)
    }

    pub(super) fn depth_rmse_mm(&self, found: &Depth) -> Option<f64> {
        let both = mask_where(&self.with_truth, |pixel| found.mask.data()[pixel]);
        rmse_without_offset(&found.depth_mm, self.truth.depth.as_ref()?, &both, &found.mask)
    }

    /// Mean of a plane over the compared pixels.
    pub(super) fn mean(&self, plane: &Plane) -> f64 {
        let compared = plane.data().iter().zip(self.compared.data()).filter(|(_, compared)| **compared);
        compared.map(|(value, _)| f64::from(*value)).sum::<f64>() / self.compared.count().max(1) as f64
    }

    /// For each bounce that has a truth, the mean over the lights of its relative error.
    pub(super) fn bounce_errors(&self, set: &CaptureSet, lights: &[Separation]) -> Result<Vec<f64>, PipelineError> {
        let mut errors = Vec::new();
        for k in 1..=lights.first().map_or(0, |light| light.bounces.len()) {
            let Some(truth) = true_bounces(set, k, self.compared.size())? else { break };
            let found = lights.iter().map(|light| &light.bounces[k - 1]);
            let each: Vec<_> = found.zip(&truth).filter_map(|(f, t)| relative_error(f, t, &self.compared)).collect();
            if each.is_empty() {
                break;
            }
            errors.push(each.iter().sum::<f64>() / each.len() as f64);
        }
        Ok(errors)
    }
}

/// The true light of a bounce under every light; `None` where a light has no such file.
fn true_bounces(set: &CaptureSet, k: usize, size: (usize, usize)) -> Result<Option<Vec<Plane>>, PipelineError> {
    let paths: Vec<_> = set.lights.iter().map(|light| set.truth_bounce(k, &light.name)).collect();
    if !paths.iter().all(|path| path.is_file()) {
        return Ok(None);
    }
    paths.iter().map(|path| true_plane(path, size)).collect::<Result<_, _>>().map(Some)
}

/// The pixels of `mask` for which `keep` holds.
pub(super) fn mask_where(mask: &Mask, keep: impl Fn(usize) -> bool) -> Mask {
    let data = mask.data().iter().enumerate().map(|(pixel, &inside)| inside && keep(pixel)).collect();
    Mask::from_vec(mask.width(), mask.height(), data).unwrap_or_else(|| mask.clone())
}
