//! Shape: normals and depth, of the direct light and before.

use std::sync::Arc;

use firstbounce_capture::pipeline::{
    CaptureWarning, ObjectLevels, SolveOptions, SurfaceName, check_surface, judge, judge_method, raw_lights, recover,
};
use firstbounce_capture::set::ShapeSettings;
use firstbounce_core::stereo::shape::Shape;
use firstbounce_core::trust::Trust;
use firstbounce_core::{AngularError, NormalMap, Plane};
use rayon::prelude::*;

use super::depends::Placement;
use super::{Calibration, Loaded, MethodLight, Step, scene};
use crate::app::base::jobs::Job;
use crate::app::state::document::Document;
use crate::app::state::results::Results;
use crate::app::state::results::engine::{AnyKey, Done, Known, Stage, Work};
use crate::app::state::results::error::StageError;
use crate::app::state::results::pictures::{Batch, PlaneName};

/// Normals and depth.
#[derive(Clone, Debug)]
pub struct Shapes {
    /// How far the direct light can be trusted.
    pub trust: Trust,
    /// From the direct light that the method in force finds.
    pub after: Arc<Shape>,
    /// From the photos with all their light.
    pub before: Arc<Shape>,
    /// How far the normals turned; `None` where no pixel has both.
    pub turned: Option<AngularError>,
    /// What the surface shows of the captures.
    pub captures: Vec<CaptureWarning>,
}

/// The stage.
pub struct Recover;

#[derive(PartialEq)]
struct Key {
    separate: u64,
    lights: Vec<String>,
    placement: Placement,
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

    fn job_name(&self, _: &Document) -> String {
        "Recover shape".into()
    }

    fn key(&self, known: &Known) -> Option<AnyKey> {
        let (_, separate) = known.ready::<MethodLight>(Step::Separate)?;
        let (rig, _) = known.ready::<Calibration>(Step::Calibrate)?;
        let set = &known.document.set;
        Some(AnyKey::new(Key {
            separate,
            lights: set.lights.iter().map(|light| light.name.clone()).collect(),
            placement: Placement::of(set, &rig),
            settings: set.shape.clone(),
        }))
    }

    fn work(&self, document: Arc<Document>, results: &Results) -> Option<Work> {
        let (loaded, rig, light) = (results.loaded()?, results.calibration()?, results.method_light()?);
        Some(Box::new(move |job| {
            let options = document.options(light.method);
            let shapes = shapes(&document, &loaded, &rig, &light, &options, job)?;
            let pictures = pictures(&shapes);
            let warnings = shapes.captures.iter().map(ToString::to_string).collect();
            Ok(Done::new(shapes).with_pictures(pictures).with_warnings(warnings))
        }))
    }
}

fn shapes(
    document: &Document,
    loaded: &Loaded,
    rig: &Calibration,
    light: &MethodLight,
    options: &SolveOptions,
    job: &Job,
) -> Result<Shapes, StageError> {
    let sees_all = options.method.needs().all_colours;
    let scene = options.method.scene_of(scene(&document.set, loaded, rig)?, options);
    let of_scene = (!sees_all).then(|| ObjectLevels::of(&scene.set, &scene.object));
    let levels = of_scene.as_ref().unwrap_or(&loaded.levels);
    // Lights that are left out are left out of both, so that before and after differ by the separation alone.
    let after = match &light.after {
        Some(after) => after.clone(),
        None => Arc::new(recover(&scene, &light.direct, &options.left_out, &options.shape_after(), job)?),
    };
    let before = match &light.before {
        Some(before) => before.clone(),
        None => {
            let raw = raw_lights(&scene.object, job)?;
            Arc::new(recover(&scene, &raw.direct(), &options.left_out, &options.shape, job)?)
        }
    };
    let trust = match light.report.colours_and_shape() {
        Some(solved) => judge_method(&scene.calibrated, &light.separated.reports, solved, Some(&after)),
        None => {
            let trust_options = options.trust(options.calibrated_bounces_of(&scene.set));
            judge(&scene.set, levels, &scene.calibrated, &trust_options)?
        }
    };
    let turned = before.normals.map.angular_error(&after.normals.map, &after.normals.solved());
    let captures = check_surface(&after.depth.mask, &options.checks);
    Ok(Shapes { trust, after, before, turned, captures })
}

fn pictures(shapes: &Shapes) -> Batch {
    let mut batch = Batch::new(Step::Shape);
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
