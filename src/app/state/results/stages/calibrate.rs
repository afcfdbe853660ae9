//! The rig: by the balls alone, and as it is in force.

use std::sync::Arc;

use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::{
    Calibrated, ObjectPhotos, PhotoStore, Preference, SolveOptions, add_beta_of_object, calibrate_with,
};
use firstbounce_capture::set::{self, BallValue, Light, Separation, ShapeSettings, Subject, Truth};

use super::{Loaded, Step, without_given};
use crate::app::base::jobs::Job;
use crate::app::state::document::Document;
use crate::app::state::results::Results;
use crate::app::state::results::engine::{AnyKey, Done, Known, Stage, Work};
use crate::app::state::results::error::StageError;

/// A calibration and the names it counts by.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// Names of the lights.
    pub lights: Vec<String>,
    /// Names of the colours.
    pub colours: Vec<String>,
    /// The values.
    pub calibrated: Arc<Calibrated>,
    /// What the file gave when they were measured.
    pub(in crate::app::state::results) given: Given,
}

/// What a set's file gives of a rig.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Given {
    pub(in crate::app::state::results) values: set::Calibration,
    pub(in crate::app::state::results) lights: Vec<Light>,
}

/// The stage: `Measure` prefers what the balls say, `Calibrate` what the file gives.
pub struct Calibrate(pub Step, pub Preference);

#[derive(PartialEq)]
struct Key {
    set: CaptureSet,
    /// Of the object's photos, where beta is measured on them.
    object: Option<u64>,
    reloads: u64,
}

impl Stage for Calibrate {
    fn step(&self) -> Step {
        self.0
    }

    fn needs(&self) -> Option<Step> {
        Some(Step::Load)
    }

    fn title(&self) -> String {
        if self.0 == Step::Measure { "Measuring the balls".into() } else { "Calibration".into() }
    }

    fn job_name(&self, _: &Document) -> String {
        if self.0 == Step::Measure { "Measure balls".into() } else { "Calibrate".into() }
    }

    fn key(&self, known: &Known) -> Option<AnyKey> {
        let set = &known.document.set;
        // A set that contradicts itself is shown, and solved when it is put right.
        let (_, loaded) =
            known.ready::<Loaded>(Step::Load).filter(|_| !set.lights.is_empty() && set.check().is_empty())?;
        let object = self.measures_object(set).then_some(loaded);
        Some(AnyKey::new(Key { set: self.seen(set), object, reloads: known.results.reloads }))
    }

    fn work(&self, document: Arc<Document>, results: &Results) -> Option<Work> {
        let (set, preference, store) = (self.seen(&document.set), self.1, results.photos.clone());
        // What the balls say of a rig whose file goes first is no warning.
        let is_in_force = self.0 == Step::Calibrate;
        let object = results.loaded().filter(|_| self.measures_object(&document.set));
        let object = object.and_then(|loaded| loaded.object.clone().ok());
        Some(Box::new(move |job| {
            let rig = calibration(&set, preference, object.as_deref(), &store, job)?;
            let warnings = if is_in_force { rig.calibrated.warnings.clone() } else { Vec::new() };
            Ok(Done::new(rig).with_warnings(warnings))
        }))
    }
}

impl Calibrate {
    /// The set, reduced to what decides over the calibration.
    fn seen(&self, set: &CaptureSet) -> CaptureSet {
        match self.0 {
            Step::Measure => without_given(&rig_of(set)),
            _ if self.measures_object(set) => {
                CaptureSet { name: String::new(), truth: Truth::default(), ..set.clone() }
            }
            _ => rig_of(set),
        }
    }

    /// Whether beta is measured on the object: neither the file nor a ball gives it.
    fn measures_object(&self, set: &CaptureSet) -> bool {
        self.0 == Step::Calibrate && set.calibration.beta.is_none() && !set.has_ball_for(BallValue::Beta)
    }
}

fn rig_of(set: &CaptureSet) -> CaptureSet {
    let mut rig = CaptureSet { name: String::new(), mask: None, truth: Truth::default(), ..set.clone() };
    rig.separation = Separation::default();
    rig.shape = ShapeSettings::default();
    // They scale the paint's albedo, and no value of the rig.
    (rig.calibration.grey_albedo, rig.calibration.white_light) = (None, None);
    // Balls that stand in the scene are seen in the object's shots.
    if !rig.spheres.iter().any(|sphere| sphere.subject == Subject::Object) {
        rig.shots.retain(|shot| shot.subject != Subject::Object);
    }
    rig
}

fn calibration(
    set: &CaptureSet,
    preference: Preference,
    object: Option<&ObjectPhotos>,
    store: &PhotoStore,
    job: &Job,
) -> Result<Calibration, StageError> {
    let mut calibrated = calibrate_with(set, preference, store, job)?;
    if let Some(object) = object {
        add_beta_of_object(set, object, &mut calibrated, &SolveOptions::of(set), job)?;
    }
    Ok(Calibration {
        lights: set.lights.iter().map(|light| light.name.clone()).collect(),
        colours: set.colours.iter().map(|colour| colour.name.clone()).collect(),
        calibrated: Arc::new(calibrated),
        given: Given { values: set.calibration.clone(), lights: set.lights.clone() },
    })
}
