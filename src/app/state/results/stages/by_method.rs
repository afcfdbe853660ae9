//! Another method beside the one in force, for comparison.

use std::ops::Deref;
use std::sync::Arc;

use firstbounce_capture::pipeline::{Method, SolveOptions, Solved, Surface, SurfaceName, reconstruct};
use firstbounce_core::AngularError;

use super::depends::LightBy;
use super::{Meshes, Shapes, Step, scene};
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
    /// How far its normals are from those of the method in force; `None` where no pixel has both.
    pub from_after: Option<AngularError>,
    /// What the user should know before trusting it.
    pub warnings: Vec<String>,
}

/// The stage.
pub struct Compare(pub Method);

#[derive(PartialEq)]
struct Key {
    mesh: u64,
    light: LightBy,
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

    fn job_name(&self, _: &Document) -> String {
        format!("Solve by {}", self.0.title())
    }

    fn key(&self, known: &Known) -> Option<AnyKey> {
        if !known.document.is_compared(self.0) {
            return None;
        }
        let (_, mesh) = known.ready::<Meshes>(Step::Mesh)?;
        let light = LightBy::of(self.0, known)?;
        Some(AnyKey::new(Key { mesh, light, options: known.document.options(self.0) }))
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

    fn why_blocked(&self, document: &Document, results: &Results) -> StageError {
        match self.0 {
            method if document.method() == method => StageError::InForce { method },
            method if document.is_compared(method) => results.rig(document).missing().unwrap_or(StageError::TooEarly),
            method => StageError::NotAsked { method },
        }
    }
}

fn found(solved: Solved, shapes: &Shapes) -> Result<ByMethod, StageError> {
    let surface = solved.after?;
    let solved = Solved { after: Ok(surface.clone()), ..solved };
    let from_after = surface.shape.normals.map.angular_error(&shapes.after.normals.map, &solved.object.mask);
    let warnings = solved.report.warnings(surface.shape.report.normals.solved_pixels);
    Ok(ByMethod { solved: Arc::new(solved), surface, from_after, warnings })
}

fn pictures(method: Method, found: &ByMethod) -> Batch {
    let mut batch = Batch::new(Step::ByMethod(method));
    for (light, direct) in found.solved.set.lights.iter().zip(found.solved.direct.deref()) {
        batch.put(Plain::DirectBy.of(Of::light_by(method, &light.name)), &direct.light);
    }
    batch.put_shape(SurfaceName::By(method), &found.surface.shape);
    batch
}
