//! Shape: normals and depth, of bounce 1 and before.

use std::sync::Arc;

use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::{
    Direct, Method, Separated, SolveOptions, SurfaceName, denoise_lights, judge, raw_lights, recover,
};
use firstbounce_capture::set::{Projection, ShapeSettings};
use firstbounce_core::stereo::shape::Shape;
use firstbounce_core::trust::Trust;
use firstbounce_core::{AngularError, NormalMap, Plane};
use rayon::prelude::*;

use super::{Calibration, Loaded, Step, bits, scene};
use crate::app::base::jobs::Job;
use crate::app::state::document::Document;
use crate::app::state::results::engine::{AnyKey, Done, Known, Stage, Work};
use crate::app::state::results::error::StageError;
use crate::app::state::results::pictures::{Batch, PlaneName};
use crate::app::state::results::{Of, Plain, Results};

/// Normals and depth.
#[derive(Clone, Debug)]
pub struct Shapes {
    /// By light: bounce 1 with less noise.
    pub direct: Arc<Vec<Direct>>,
    /// How far that can be trusted.
    pub trust: Trust,
    /// From bounce 1.
    pub after: Arc<Shape>,
    /// From the photos with all their light.
    pub before: Arc<Shape>,
    /// How far the normals turned; `None` where no pixel has both.
    pub turned: Option<AngularError>,
}

/// The stage.
pub struct Recover;

#[derive(PartialEq)]
struct Key {
    separate: u64,
    lights: Vec<String>,
    directions: Vec<Option<[u64; 3]>>,
    positions_mm: Vec<Option<[f64; 3]>>,
    intensities: Vec<u64>,
    projection: Projection,
    settings: ShapeSettings,
}

impl Stage for Recover {
    fn step(&self) -> Step {
        Step::Shape
    }

    fn needs(&self) -> Option<Step> {
        Some(Step::Separate)
    }

    fn title(&self) -> String {
        "Shape recovery".into()
    }

    fn job_name(&self) -> String {
        "Recover shape".into()
    }

    fn key(&self, known: &Known) -> Option<AnyKey> {
        let (_, separate) = known.ready::<Separated>(Step::Separate)?;
        let (rig, _) = known.ready::<Calibration>(Step::Calibrate)?;
        let (set, rig) = (&known.document.set, &rig.calibrated);
        Some(AnyKey::new(Key {
            separate,
            lights: set.lights.iter().map(|light| light.name.clone()).collect(),
            directions: rig
                .direction
                .iter()
                .map(|known| known.as_ref().map(|known| known.value.map(f64::to_bits)))
                .collect(),
            positions_mm: set.lights.iter().map(|light| light.position_mm).collect(),
            intensities: bits(&rig.intensity),
            projection: set.camera.projection,
            settings: set.shape.clone(),
        }))
    }

    fn work(&self, document: Arc<Document>, results: &Results) -> Option<Work> {
        let (loaded, rig, separated) = (results.loaded()?, results.calibration()?, results.separated()?);
        Some(Box::new(move |job| {
            let options = document.options(Method::Colours);
            let shapes = shapes(&document.set, &loaded, &rig, &separated, &options, job)?;
            let pictures = pictures(&document.set, &shapes);
            Ok(Done::new(shapes).with_pictures(pictures))
        }))
    }
}

fn shapes(
    set: &CaptureSet,
    loaded: &Loaded,
    rig: &Calibration,
    separated: &Separated,
    options: &SolveOptions,
    job: &Job,
) -> Result<Shapes, StageError> {
    let scene = scene(set, loaded, rig)?;
    let direct = denoise_lights(&scene, separated, &options.denoise, job)?;
    let bounces = separated.reports.first().map_or(1, |report| report.bounces);
    let trust = judge(set, &loaded.levels, &rig.calibrated, &options.trust(bounces))?;
    let raw = raw_lights(&scene.object, job)?;
    // Lights that are left out are left out of both, so that before and after differ by the bounces alone.
    let after = recover(&scene, &direct, &options.left_out, &options.shape_after(), job)?;
    let before = recover(&scene, &raw.direct(), &options.left_out, &options.shape, job)?;
    let turned = before.normals.map.angular_error(&after.normals.map, &after.normals.solved());
    Ok(Shapes { direct: Arc::new(direct), trust, after: Arc::new(after), before: Arc::new(before), turned })
}

fn pictures(set: &CaptureSet, shapes: &Shapes) -> Batch {
    let mut batch = Batch::new(Step::Shape);
    for (light, direct) in set.lights.iter().zip(&*shapes.direct) {
        batch.put(Plain::Direct.of(Of::light(&light.name)), &direct.light);
    }
    batch.put_shape(SurfaceName::After, &shapes.after);
    batch.put_shape(SurfaceName::Before, &shapes.before);
    if let Some(turned) = turned(&shapes.before.normals.map, &shapes.after.normals.map) {
        batch.put(PlaneName::Turned, &turned);
    }
    batch
}

/// Angles between two maps of normals in degrees; not a number where one has none.
fn turned(before: &NormalMap, after: &NormalMap) -> Option<Plane> {
    let (width, height) = after.size();
    let angle = |index: usize| match (before.at_index(index), after.at_index(index)) {
        // The arc cosine of a float knows no angle below 0.02 degrees.
        (Some(a), Some(b)) => a.cross(&b).norm().atan2(a.dot(&b)).to_degrees(),
        _ => f32::NAN,
    };
    Plane::from_vec(width, height, (0..width * height).into_par_iter().map(angle).collect())
}
