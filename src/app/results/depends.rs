//! What each stage depends on: an edit makes stale only the stages whose key it changes.
//!
//! A measured value may be no number, as on a damaged photo, and NaN is not equal to itself: such a key would never be
//! that of a result, and its stage would be computed without end. So keys hold the bits of measured values.

use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::Known;
use firstbounce_capture::set::{Calibration, Projection, Separation, Subject, Truth};

use super::Results;
use super::stage::Step;
use crate::app::document::{Document, NayarSettings, ShapeSettings};

/// A measured value: the bits of its f64.
type Bits = u64;

#[derive(Clone, Debug, PartialEq)]
pub struct LoadKey {
    /// The set, reduced to what decides over the photos.
    set: CaptureSet,
    reloads: u64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct MeasureKey {
    pub set: CaptureSet,
    reloads: u64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct CalibrateKey {
    pub set: CaptureSet,
    reloads: u64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct SeparateKey {
    load: u64,
    pub lights: Vec<String>,
    alpha: Vec<Vec<Bits>>,
    beta: Vec<Bits>,
    pub bounces: usize,
}

#[derive(Clone, Debug, PartialEq)]
pub struct ShapeKey {
    separate: u64,
    pub lights: Vec<String>,
    directions: Vec<Option<[Bits; 3]>>,
    positions_mm: Vec<Option<[f64; 3]>>,
    intensities: Vec<Bits>,
    projection: Projection,
    settings: ShapeSettings,
}

#[derive(Clone, Debug, PartialEq)]
pub struct MeshKey {
    shape: u64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct NayarKey {
    shape: u64,
    grey_albedo: Option<f64>,
    white_light: Option<f64>,
    grey_light: Option<Bits>,
    /// Where the grey ball must be looked at once more, the calibration whose circles count.
    calibrate: Option<u64>,
    settings: NayarSettings,
}

/// The keys of all stages; `None` where a stage cannot be computed yet.
#[derive(Clone, Debug, PartialEq)]
pub struct Keys {
    pub load: LoadKey,
    pub measure: Option<MeasureKey>,
    pub calibrate: Option<CalibrateKey>,
    pub separate: Option<SeparateKey>,
    pub shape: Option<ShapeKey>,
    pub mesh: Option<MeshKey>,
    pub nayar: Option<NayarKey>,
}

impl Keys {
    pub fn of(document: &Document, results: &Results) -> Self {
        let set = &document.set;
        let reloads = results.reloads;
        let load = LoadKey { set: photos_of(set), reloads };
        let mut keys =
            Self { load, measure: None, calibrate: None, separate: None, shape: None, mesh: None, nayar: None };
        // A set that contradicts itself is shown, and solved when it is put right.
        if set.lights.is_empty() || !results.load.is_ready(Some(&keys.load)) || !set.check().is_empty() {
            return keys;
        }
        keys.measure = Some(MeasureKey { set: without_given(&rig_of(set)), reloads });
        keys.calibrate = Some(CalibrateKey { set: rig_of(set), reloads });
        keys.separate = separate_key(&keys, set, results);
        keys.shape = shape_key(&keys, document, results);
        keys.mesh = results
            .shape
            .is_ready(keys.shape.as_ref())
            .then_some(MeshKey { shape: results.shape.generation })
            .filter(|_| keys.shape.is_some());
        keys.nayar = nayar_key(&keys, document, results);
        keys
    }

    /// The same without the keys of stages after `step`.
    pub fn upto(&self, step: Step) -> Self {
        let mut keys = self.clone();
        let after = |other: Step| other > step;
        if after(Step::Measure) {
            keys.measure = None;
        }
        if after(Step::Calibrate) {
            keys.calibrate = None;
        }
        if after(Step::Separate) {
            keys.separate = None;
        }
        if after(Step::Shape) {
            keys.shape = None;
        }
        if after(Step::Mesh) {
            keys.mesh = None;
        }
        if after(Step::Nayar) {
            keys.nayar = None;
        }
        keys
    }
}

fn separate_key(keys: &Keys, set: &CaptureSet, results: &Results) -> Option<SeparateKey> {
    if !results.calibrate.is_ready(keys.calibrate.as_ref()) || results.load.last.as_ref()?.object.is_err() {
        return None;
    }
    let calibrated = &results.calibrate.last.as_ref()?.calibrated;
    let values = |known: &Vec<Known<f64>>| known.iter().map(|known| known.value.to_bits()).collect();
    Some(SeparateKey {
        load: results.load.generation,
        lights: set.lights.iter().map(|light| light.name.clone()).collect(),
        alpha: calibrated.alpha.iter().map(|alpha| alpha.as_ref().map(values)).collect::<Option<_>>()?,
        beta: values(calibrated.beta.as_ref()?),
        bounces: set.bounces(),
    })
}

fn shape_key(keys: &Keys, document: &Document, results: &Results) -> Option<ShapeKey> {
    if !results.separate.is_ready(keys.separate.as_ref()) {
        return None;
    }
    let (set, calibrated) = (&document.set, &results.calibrate.last.as_ref()?.calibrated);
    Some(ShapeKey {
        separate: results.separate.generation,
        lights: keys.separate.as_ref()?.lights.clone(),
        directions: calibrated
            .direction
            .iter()
            .map(|known| known.as_ref().map(|known| known.value.map(f64::to_bits)))
            .collect(),
        positions_mm: set.lights.iter().map(|light| light.position_mm).collect(),
        intensities: calibrated.intensity.iter().map(|known| known.value.to_bits()).collect(),
        projection: set.camera.projection,
        settings: document.settings.shape.clone(),
    })
}

fn nayar_key(keys: &Keys, document: &Document, results: &Results) -> Option<NayarKey> {
    let settings = &document.settings.nayar;
    if !settings.compute || !results.shape.is_ready(keys.shape.as_ref()) {
        return None;
    }
    let Calibration { grey_albedo, white_light, .. } = document.set.calibration;
    let grey_light = results.calibrate.last.as_ref()?.calibrated.grey_light;
    Some(NayarKey {
        shape: results.shape.generation,
        grey_albedo,
        white_light,
        grey_light: grey_light.map(f64::to_bits),
        calibrate: grey_light.is_none().then_some(results.calibrate.generation),
        settings: settings.clone(),
    })
}

/// What decides over the photos in linear light.
fn photos_of(set: &CaptureSet) -> CaptureSet {
    let mut set = without_given(set);
    set.camera.projection = Projection::default();
    set.lights.iter_mut().for_each(|light| light.position_mm = None);
    set.spheres.clear();
    set.name.clear();
    set
}

/// What decides over the calibration.
fn rig_of(set: &CaptureSet) -> CaptureSet {
    let mut rig = CaptureSet { name: String::new(), mask: None, truth: Truth::default(), ..set.clone() };
    rig.separation = Separation::default();
    // They scale the paint's albedo, and no value of the rig.
    (rig.calibration.grey_albedo, rig.calibration.white_light) = (None, None);
    // Balls that stand in the scene are seen in the object's shots.
    if !rig.spheres.iter().any(|sphere| sphere.subject == Subject::Object) {
        rig.shots.retain(|shot| shot.subject != Subject::Object);
    }
    rig
}

/// Without the values that the file gives.
fn without_given(set: &CaptureSet) -> CaptureSet {
    let mut set = CaptureSet { calibration: Calibration::default(), ..set.clone() };
    set.separation = Separation::default();
    set.truth = Truth::default();
    set.lights.iter_mut().for_each(|light| light.direction = None);
    set
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use firstbounce_capture::pipeline::simulate::{SimulateOptions, simulate, write_simulated};
    use firstbounce_capture::pipeline::{Calibrated, Source};
    use firstbounce_core::Unwatched;

    use super::super::{Given, run};
    use super::*;
    use crate::app::jobs::Jobs;

    /// As a ball measures it whose photos are damaged.
    fn no_number<T>(value: T) -> Known<T> {
        Known { value, interval: None, source: Source::GreyBall, pixels: None }
    }

    #[test]
    fn a_stage_of_measured_values_that_are_no_numbers_is_computed_once() {
        let place = tempfile::tempdir().unwrap();
        let options = SimulateOptions { patches: 40, size_px: 16, truth_bounces: 1, balls: None, ..Default::default() };
        write_simulated(&simulate(&options, &Unwatched).unwrap(), &place.path().join("set")).unwrap();
        let mut document = Document { set: CaptureSet::open(place.path().join("set")).unwrap(), ..Document::default() };
        document.set.separation.bounces = Some(2);

        let mut results = Results::default();
        let set = document.set.clone();
        let task = Jobs::new(Arc::new(|| ())).start("load", move |job| run::load(&set, job));
        let loaded = loop {
            if let Some(loaded) = task.poll() {
                break loaded;
            }
        };
        results.load.finish(Keys::of(&document, &results).load, loaded);
        let nan = || no_number(f64::NAN);
        let calibrated = Calibrated {
            alpha: vec![Some(vec![nan(), nan()]); 3],
            beta: Some(vec![nan(), nan()]),
            intensity: vec![nan(), nan(), nan()],
            direction: vec![Some(no_number([f64::NAN; 3])); 3],
            ..Calibrated::default()
        };
        let given = Given::default();
        let calibration = super::super::Calibration { lights: Vec::new(), colours: Vec::new(), calibrated, given };
        let calibrate = Keys::of(&document, &results).calibrate.unwrap();
        results.calibrate.finish(calibrate, Ok(calibration));
        let separate = Keys::of(&document, &results).separate.unwrap();
        results
            .separate
            .finish(separate, Ok(firstbounce_capture::pipeline::Separated { lights: vec![], reports: vec![] }));
        let keys = Keys::of(&document, &results);
        assert!(results.separate.is_ready(keys.separate.as_ref()), "separated once more");
        assert_eq!(keys, Keys::of(&document, &results));
        assert!(keys.shape.is_some());
    }
}
