//! What a stage's job gives back to the engine.

use firstbounce_capture::pipeline::Separated;

use super::depends::{self, Keys};
use super::pictures::Batch;
use super::{ByNayar, Calibration, Loaded, Meshes, Shapes, Step};

/// What a stage's job gives.
pub enum Outcome {
    Load(depends::LoadKey, Result<(Loaded, Batch), String>),
    Measure(depends::MeasureKey, Result<Calibration, String>),
    Calibrate(depends::CalibrateKey, Result<Calibration, String>),
    Separate(depends::SeparateKey, Result<(Separated, Batch), String>),
    Shape(depends::ShapeKey, Result<Box<(Shapes, Batch)>, String>),
    Mesh(depends::MeshKey, Result<Meshes, String>),
    Nayar(depends::NayarKey, Result<Box<(ByNayar, Batch)>, String>),
}

impl Outcome {
    /// The outcome of a job that never answered.
    pub fn lost(step: Step, keys: &Keys, line: String) -> Self {
        let lost = line;
        match (step, keys.clone()) {
            (Step::Measure, Keys { measure: Some(key), .. }) => Self::Measure(key, Err(lost)),
            (Step::Calibrate, Keys { calibrate: Some(key), .. }) => Self::Calibrate(key, Err(lost)),
            (Step::Separate, Keys { separate: Some(key), .. }) => Self::Separate(key, Err(lost)),
            (Step::Shape, Keys { shape: Some(key), .. }) => Self::Shape(key, Err(lost)),
            (Step::Mesh, Keys { mesh: Some(key), .. }) => Self::Mesh(key, Err(lost)),
            (Step::Nayar, Keys { nayar: Some(key), .. }) => Self::Nayar(key, Err(lost)),
            (_, Keys { load, .. }) => Self::Load(load, Err(lost)),
        }
    }

    /// What a person should know before trusting the result.
    pub fn warnings(&self) -> &[String] {
        match self {
            Self::Load(_, Ok((loaded, _))) => &loaded.warnings,
            Self::Calibrate(_, Ok(calibration)) => &calibration.calibrated.warnings,
            Self::Nayar(_, Ok(found)) => &found.0.warnings,
            _ => &[],
        }
    }

    pub fn error(&self) -> Option<&str> {
        match self {
            Self::Load(_, Err(line))
            | Self::Measure(_, Err(line))
            | Self::Calibrate(_, Err(line))
            | Self::Separate(_, Err(line))
            | Self::Shape(_, Err(line))
            | Self::Mesh(_, Err(line))
            | Self::Nayar(_, Err(line)) => Some(line),
            _ => None,
        }
    }
}
