//! The stages: one file each, and one row of the table.

mod by_method;
mod calibrate;
mod check;
mod depends;
mod load;
mod mesh;
mod separate;
mod shape;

use std::fmt;

use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::{Known, Method, Preference, Scene};
use firstbounce_capture::set::{self, Separation, ShapeSettings, Truth};

use super::engine::Stage;
use super::error::StageError;

pub use by_method::ByMethod;
pub use calibrate::{Calibration, Given};
pub use check::Checked;
pub use load::{Loaded, LoadedShot};
pub use mesh::Meshes;
pub use separate::MethodLight;
pub use shape::Shapes;

/// The stages, in the order in which they run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Step {
    /// Photos to linear light.
    Load,
    /// What the balls say, whatever the file gives.
    Measure,
    /// The rig in force.
    Calibrate,
    /// Whether lamps and photos belong together.
    Check,
    /// Photos to direct light, by the method in force.
    Separate,
    /// Normals and depth, of the direct light and before.
    Shape,
    /// Depth to triangles.
    Mesh,
    /// Another method, where it is asked for.
    ByMethod(Method),
}

/// The table, in the order in which stages run.
pub fn all() -> Vec<Box<dyn Stage>> {
    let mut stages: Vec<Box<dyn Stage>> = vec![
        Box::new(load::Load),
        Box::new(calibrate::Calibrate(Step::Measure, Preference::Balls)),
        Box::new(calibrate::Calibrate(Step::Calibrate, Preference::File)),
        Box::new(check::Check),
        Box::new(separate::Separate),
        Box::new(shape::Recover),
        Box::new(mesh::Triangulate),
    ];
    stages.extend(Method::ALL.into_iter().map(|method| Box::new(by_method::Compare(method)) as Box<dyn Stage>));
    stages
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let stage = all().into_iter().find(|stage| stage.step() == *self);
        f.write_str(&stage.map_or_else(String::new, |stage| stage.title()))
    }
}

/// The object's photos and the rig, as the pipeline takes them.
fn scene<'a>(set: &'a CaptureSet, loaded: &'a Loaded, rig: &'a Calibration) -> Result<Scene<'a>, StageError> {
    let object = loaded.object.as_ref().map_err(Clone::clone)?;
    Ok(Scene::of(set, object, &rig.calibrated))
}

/// Measured values as a key holds them: the bits of each. A value may be no number, as on a damaged photo, and NaN is not
/// equal to itself: such a key would never be that of a result, and its stage would be computed without end.
fn bits(known: &[Known<f64>]) -> Vec<u64> {
    known.iter().map(|known| known.value.to_bits()).collect()
}

/// The set without the values that the file gives.
fn without_given(set: &CaptureSet) -> CaptureSet {
    let mut set = CaptureSet { calibration: set::Calibration::default(), ..set.clone() };
    set.separation = Separation::default();
    set.truth = Truth::default();
    set.shape = ShapeSettings::default();
    set.lights.iter_mut().for_each(|light| light.direction = None);
    set
}

#[cfg(test)]
mod tests {
    use firstbounce_capture::pipeline::Source;

    use super::*;

    #[test]
    fn a_key_of_measured_values_that_are_no_numbers_is_that_of_its_result() {
        let known = [Known { value: f64::NAN, interval: None, source: Source::GreyBall, pixels: None, measured: None }];
        assert_eq!(bits(&known), bits(&known));
        assert_ne!(bits(&known), bits(&[Known { value: 0.5, ..known[0].clone() }]));
    }
}
