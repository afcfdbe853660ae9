//! What direct light and surfaces depend on: the parts that several stages' keys are made of.

use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::Method;
use firstbounce_capture::set::{Projection, ShapeSettings};

use super::{Calibration, Loaded, Step, bits};
use crate::app::state::document::NayarSettings;
use crate::app::state::results::engine::Known;

/// Where the lamps are and how the camera sees.
#[derive(PartialEq)]
pub struct Placement {
    directions: Vec<Option<[u64; 3]>>,
    positions_mm: Vec<Option<[f64; 3]>>,
    intensities: Vec<u64>,
    projection: Projection,
}

impl Placement {
    pub fn of(set: &CaptureSet, rig: &Calibration) -> Self {
        let directions = rig.calibrated.direction.iter();
        Self {
            directions: directions.map(|known| known.as_ref().map(|known| known.value.map(f64::to_bits))).collect(),
            positions_mm: set.lights.iter().map(|light| light.position_mm).collect(),
            intensities: bits(&rig.calibrated.intensity),
            projection: set.camera.projection,
        }
    }
}

/// What the direct light that a method finds depends on.
#[derive(PartialEq)]
pub struct LightBy {
    method: Method,
    load: u64,
    lights: Vec<String>,
    /// alpha and beta, where more than one colour is looked at.
    colours: Option<(Vec<Vec<u64>>, Vec<u64>)>,
    /// Of the paper's method, its order m.
    bounces: Option<usize>,
    /// Where a shape is recovered on the way.
    placement: Option<Placement>,
    settings: ShapeSettings,
    nayar: Option<NayarSettings>,
    /// What scales the albedo, where the method needs it: the grey ball's albedo and light, the light of white.
    scale: Option<[Option<u64>; 3]>,
    /// Where the grey ball must be looked at once more, the calibration whose circles count.
    calibrate: Option<u64>,
}

impl LightBy {
    /// `None` where the photos, or the alpha and beta that the method needs, are not there.
    pub fn of(method: Method, known: &Known) -> Option<Self> {
        let (calibration, calibrate) = known.ready::<Calibration>(Step::Calibrate)?;
        let (loaded, load) = known.ready::<Loaded>(Step::Load)?;
        loaded.object.as_ref().ok()?;
        let (set, rig, needs) = (&known.document.set, &calibration.calibrated, method.needs());
        let alpha = || rig.alpha.iter().map(|alpha| Some(bits(alpha.as_ref()?))).collect::<Option<_>>();
        let colours = || Some((alpha()?, bits(rig.beta.as_ref()?)));
        let given = &set.calibration;
        let scale = [given.grey_albedo, rig.grey_light, given.white_light].map(|value| value.map(f64::to_bits));
        let looks_at_white = needs.absolute_albedo || method.compares_albedo();
        Some(Self {
            method,
            load,
            lights: set.lights.iter().map(|light| light.name.clone()).collect(),
            colours: if needs.all_colours { Some(colours()?) } else { None },
            bounces: (method == Method::Colours).then(|| set.bounces()),
            placement: (method != Method::Colours).then(|| Placement::of(set, &calibration)),
            settings: settings_of(method, &set.shape),
            nayar: (method == Method::Shape).then(|| known.document.settings.nayar.clone()),
            scale: looks_at_white.then_some(scale),
            calibrate: (looks_at_white && rig.grey_light.is_none()).then_some(calibrate),
        })
    }
}

/// The settings, but for those that the method has no use for.
fn settings_of(method: Method, settings: &ShapeSettings) -> ShapeSettings {
    let unused = ShapeSettings::default();
    match method {
        Method::Colours => ShapeSettings { indirect_window_px: settings.indirect_window_px, ..unused },
        Method::ColoursAndShape => ShapeSettings { indirect_window_px: unused.indirect_window_px, ..settings.clone() },
        Method::Shape => {
            ShapeSettings { indirect_window_px: unused.indirect_window_px, paint: unused.paint, ..settings.clone() }
        }
    }
}
