//! Before and after against the reference, by the functions that `firstbounce compare` runs.

use std::sync::Arc;

use firstbounce_capture::pipeline::{Compared, Frame, Registration, compare_meshes};
use firstbounce_core::mesh::compare::{AlignOptions, CompareError, DistanceOptions, Freedom, Start};
use firstbounce_core::{Mesh, Portion, Watch};
use nalgebra::Isometry3;
use thiserror::Error;

use super::{Basis, News, Reference};
use crate::app::base::bars::Bars;
use crate::app::base::jobs::{Job, Jobs};
use crate::app::state::document::{Pose, Poses};
use crate::app::state::results::{Meshes, SurfaceName};
use crate::app::state::surfaces::LayerName;

/// Why nothing was compared.
#[derive(Clone, Copy, Debug, Error)]
pub enum NothingToCompare {
    /// No surface of the document.
    #[error("the surface is not computed yet: see Shape")]
    Surface,
    /// No reference.
    #[error("there is no reference yet: load one first")]
    Reference,
}

/// How the surfaces come to the reference.
#[derive(Clone, Debug, PartialEq)]
pub enum How {
    /// They stay where they are.
    AsTheyLie,
    /// They are aligned from here.
    Align(Start),
}

/// Both surfaces against the reference.
pub struct Outcome {
    /// Of the direct light.
    pub after: Compared,
    /// Before, or why it could not be compared.
    pub before: Result<Compared, CompareError>,
    /// The distances of the surface after.
    pub bars: Bars,
}

impl Outcome {
    /// One surface's numbers.
    pub fn of(&self, layer: LayerName) -> Option<&Compared> {
        match layer {
            LayerName::AFTER => Some(&self.after),
            LayerName::Surface(SurfaceName::Before) => self.before.as_ref().ok(),
            LayerName::Surface(SurfaceName::By(_)) | LayerName::Reference => None,
        }
    }

    /// Where the surfaces lie; `None` where they were not aligned.
    fn poses(&self) -> Option<Poses> {
        let pose = |compared: &Compared| compared.alignment.as_ref().map(|found| Pose::from(found.moving_to_fixed));
        let after = pose(&self.after)?;
        Some(Poses { after, before: self.before.as_ref().ok().and_then(pose).unwrap_or(after) })
    }
}

impl Reference {
    /// Compares off the UI thread; an error says what is missing.
    pub fn compare(
        &mut self,
        how: How,
        poses: Option<Poses>,
        meshes: Option<Arc<Meshes>>,
        jobs: &mut Jobs,
    ) -> Result<(), NothingToCompare> {
        let meshes = meshes.ok_or(NothingToCompare::Surface)?;
        let loaded = self.loaded.ready().ok_or(NothingToCompare::Reference)?;
        let (reference, freedom) = (loaded.mesh.clone(), Frame::Camera.freedom(loaded.frame));
        let name = match how {
            How::AsTheyLie => "Compare with the reference",
            How::Align(_) => "Align with the reference",
        };
        let basis = Basis { meshes: meshes.clone(), reference: reference.clone(), poses };
        let task = jobs.start(name, move |job| outcome(&how, freedom, poses, &meshes, &reference, job));
        self.compared.start(basis, task);
        self.pairs = None;
        Ok(())
    }

    pub(super) fn take_compared(&mut self, news: &mut Vec<News>) {
        let Some((mut basis, outcome)) = self.compared.take() else { return };
        match &outcome {
            Ok(outcome) => {
                if let Some(poses) = outcome.poses() {
                    basis.poses = Some(poses);
                    news.push(News::Aligned(poses));
                }
            }
            Err(error) => news.push(News::Failed(error.clone())),
        }
        self.compared.keep(basis, outcome);
    }
}

fn outcome(
    how: &How,
    freedom: Freedom,
    poses: Option<Poses>,
    meshes: &Meshes,
    reference: &Mesh,
    job: &Job,
) -> Result<Outcome, CompareError> {
    let one = |how: &How, search: bool, mesh: &Mesh, pose: Option<Pose>, from: f32| {
        let watch: &dyn Watch = job;
        let aligning = Portion { watch, from, to: from + 0.35 };
        let measuring = Portion { watch, from: from + 0.35, to: from + 0.5 };
        let registration = match (how, pose) {
            (How::Align(start), _) => {
                Registration::Align(AlignOptions { start: start.clone(), freedom, search, ..AlignOptions::default() })
            }
            (How::AsTheyLie, Some(pose)) => Registration::Known(Isometry3::from(pose)),
            (How::AsTheyLie, None) => Registration::None,
        };
        let options = DistanceOptions::default();
        compare_meshes(mesh, reference, &registration, &options, (&aligning, &measuring))
    };
    let after = one(how, true, &meshes.after, poses.map(|poses| poses.after), 0.0)?;
    // Both come from one camera: where the surface after lies, that before lies nearly too, and need not be searched for.
    let (how, search) = match &after.alignment {
        Some(found) => (How::Align(Start::Pose(found.moving_to_fixed)), false),
        None => (how.clone(), true),
    };
    let before = one(&how, search, &meshes.before, poses.map(|poses| poses.before), 0.5);
    if job.is_cancelled() {
        return Err(CompareError::Cancelled);
    }
    let bars = Bars::of(after.comparison.signed_mm.iter().flatten().map(|signed| f64::from(*signed)));
    Ok(Outcome { after, before, bars })
}
