//! Another method beside the paper's, for comparison.

use std::ops::Deref;
use std::sync::Arc;

use firstbounce_capture::pipeline::{Method, SolveOptions, Solved, Surface, SurfaceName, reconstruct};
use firstbounce_core::AngularError;

use super::{Calibration, Meshes, Shapes, Step, scene};
use crate::app::state::document::Document;
use crate::app::state::results::engine::{AnyKey, Done, Known, Stage, Work};
use crate::app::state::results::error::StageError;
use crate::app::state::results::pictures::Batch;
use crate::app::state::results::{Of, Plain, Results};

/// What another method found.
#[derive(Clone, Debug)]
pub struct ByMethod {
    /// Everything, as the command line would find it.
    pub solved: Arc<Solved>,
    /// Its surface.
    pub surface: Surface,
    /// How far its normals are from those of bounce 1; `None` where no pixel has both.
    pub from_bounce_1: Option<AngularError>,
    /// What the user should know before trusting it.
    pub warnings: Vec<String>,
}

/// The stage.
pub struct Compare(pub Method);

#[derive(PartialEq)]
struct Key {
    mesh: u64,
    /// What scales the albedo, where the method needs it: the grey ball's albedo and light, the light of white.
    scale: Option<[Option<u64>; 3]>,
    /// Where the grey ball must be looked at once more, the calibration whose circles count.
    calibrate: Option<u64>,
    options: SolveOptions,
}

impl Stage for Compare {
    fn step(&self) -> Step {
        Step::ByMethod(self.0)
    }

    fn needs(&self) -> Option<Step> {
        Some(Step::Mesh)
    }

    fn title(&self) -> String {
        let title = self.0.title();
        title[..1].to_uppercase() + &title[1..]
    }

    fn job_name(&self) -> String {
        format!("Solve by {}", self.0.title())
    }

    fn key(&self, known: &Known) -> Option<AnyKey> {
        if !known.document.settings.is_compared(self.0) {
            return None;
        }
        let (_, mesh) = known.ready::<Meshes>(Step::Mesh)?;
        let (rig, calibrate) = known.ready::<Calibration>(Step::Calibrate)?;
        let (given, needs_scale) = (&known.document.set.calibration, self.0.needs().absolute_albedo);
        Some(AnyKey::new(Key {
            mesh,
            scale: needs_scale.then(|| {
                [given.grey_albedo, rig.calibrated.grey_light, given.white_light].map(|x| x.map(f64::to_bits))
            }),
            calibrate: (needs_scale && rig.calibrated.grey_light.is_none()).then_some(calibrate),
            options: known.document.options(self.0),
        }))
    }

    fn work(&self, document: Arc<Document>, results: &Results) -> Option<Work> {
        let (loaded, rig, shapes, meshes) =
            (results.loaded()?, results.calibration()?, results.shapes()?, results.meshes()?);
        let method = self.0;
        Some(Box::new(move |job| {
            let scene = scene(&document.set, &loaded, &rig)?;
            let before = Surface { shape: shapes.before.clone(), mesh: meshes.before.clone() };
            let options = document.options(method);
            let solved = reconstruct(scene, Some(before), &options, Vec::new(), job)?;
            let found = found(solved, &shapes)?;
            let (pictures, warnings) = (pictures(method, &found), found.warnings.clone());
            Ok(Done::new(found).with_pictures(pictures).with_warnings(warnings))
        }))
    }

    fn why_blocked(&self, document: &Document, _: &Results) -> StageError {
        if document.settings.is_compared(self.0) {
            StageError::TooEarly
        } else {
            StageError::NotAsked { method: self.0 }
        }
    }
}

fn found(solved: Solved, shapes: &Shapes) -> Result<ByMethod, StageError> {
    let surface = solved.after?;
    let solved = Solved { after: Ok(surface.clone()), ..solved };
    let from_bounce_1 = surface.shape.normals.map.angular_error(&shapes.after.normals.map, &solved.object.mask);
    let warnings = solved.report.warnings(surface.shape.report.normals.solved_pixels);
    Ok(ByMethod { solved: Arc::new(solved), surface, from_bounce_1, warnings })
}

fn pictures(method: Method, found: &ByMethod) -> Batch {
    let mut batch = Batch::new(Step::ByMethod(method));
    for (light, direct) in found.solved.set.lights.iter().zip(found.solved.direct.deref()) {
        batch.put(Plain::DirectBy.of(Of::light_by(method, &light.name)), &direct.light);
    }
    batch.put_shape(SurfaceName::By(method), &found.surface.shape);
    batch
}
