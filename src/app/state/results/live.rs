//! Values that follow from the document at once, without waiting for a stage: alpha, beta, the bounce operator and that of one
//! colour ratio a light. A typed value is in force in the frame in which it is typed.

use std::borrow::Cow;
use std::sync::Arc;

use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::{Calibrated, PipelineError, rig_of};
use firstbounce_core::methods::colours_and_shape::even_operator;
use firstbounce_core::separate::BounceSystem;
use firstbounce_core::trust;
use nalgebra::DMatrix;

use super::stages::Given;
use super::{Calibration, Results, StageError};
use crate::app::state::document::Document;

/// alpha, beta and the order m in force.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    /// Names of the lights.
    pub lights: Vec<String>,
    /// By light, then colour; `None` where it is unknown.
    pub alpha: Vec<Option<Vec<f64>>>,
    /// By colour; `None` where it is unknown.
    pub beta: Option<Vec<f64>>,
    /// The order m.
    pub bounces: usize,
    /// By light, then colour: the noise that weights the fit.
    sigma: Vec<Vec<f64>>,
    /// By light, then colour: mean linear light of the object.
    mean: Vec<Vec<f64>>,
}

/// What is in force under one light.
struct OfLight<'a> {
    index: usize,
    alpha: &'a [f64],
    beta: &'a [f64],
    sigma: Cow<'a, [f64]>,
}

impl Rig {
    /// What is missing; `None` where alpha and beta are known.
    pub fn missing(&self) -> Option<StageError> {
        if self.beta.is_none() {
            return Some(StageError::NoBeta);
        }
        let light = self.alpha.iter().position(Option::is_none)?;
        Some(StageError::NoAlpha { light: self.lights[light].clone() })
    }

    /// The bounce operator of a light; an error says what is missing or impossible.
    pub fn system(&self, light: &str) -> Result<BounceSystem, StageError> {
        self.system_of_order(light, self.bounces)
    }

    /// The same for another order m.
    pub fn system_of_order(&self, light: &str, bounces: usize) -> Result<BounceSystem, StageError> {
        let OfLight { alpha, beta, sigma, .. } = self.of_light(light)?;
        Ok(BounceSystem::new(alpha, beta, &sigma, bounces).map_err(PipelineError::from)?)
    }

    /// The 2 x n matrix that takes the photos of a light to direct and indirect light, with one colour ratio of indirect light:
    /// that of all light of the object.
    pub fn even_operator(&self, light: &str) -> Result<DMatrix<f64>, StageError> {
        let OfLight { index, alpha, beta, sigma } = self.of_light(light)?;
        let mean = self.mean.get(index).filter(|mean| mean.len() == beta.len()).ok_or(StageError::Reading)?;
        let normalised: Vec<f64> = mean.iter().zip(alpha).map(|(mean, alpha)| mean / alpha).collect();
        let reference = normalised.first().copied().filter(|light| *light > 0.0).unwrap_or(1.0);
        let ratio: Vec<f64> = normalised.iter().map(|light| light / reference).collect();
        Ok(even_operator(alpha, beta, &ratio, &sigma).map_err(PipelineError::from)?)
    }

    fn of_light(&self, light: &str) -> Result<OfLight<'_>, StageError> {
        let missing = || self.missing().unwrap_or_else(|| StageError::NoLight { light: light.to_owned() });
        let index = self.lights.iter().position(|name| name == light).ok_or_else(missing)?;
        let (Some(beta), Some(Some(alpha))) = (&self.beta, self.alpha.get(index)) else { return Err(missing()) };
        let known = self.sigma.get(index).filter(|sigma| sigma.len() == beta.len());
        let sigma = known.map_or_else(|| Cow::Owned(vec![1.0; beta.len()]), |sigma| Cow::Borrowed(&**sigma));
        Ok(OfLight { index, alpha, beta, sigma })
    }
}

impl Given {
    /// Whether a set gives all of this, with whatever values.
    fn is_given_by(&self, set: &CaptureSet) -> bool {
        let (values, now) = (&self.values, &set.calibration);
        let directions =
            values.direction.keys().chain(self.lights.iter().filter_map(|light| light.direction.map(|_| &light.name)));
        (values.beta.is_none() || now.beta.is_some())
            && values.alpha.keys().all(|light| now.alpha.contains_key(light))
            && values.intensity.keys().all(|light| now.intensity.contains_key(light))
            && directions.into_iter().all(|light| set.given_direction(light).is_some())
    }
}

impl Results {
    /// What a verdict on this document's separation depends on: as the pipeline takes it, with typed values in force at
    /// once. An error says what is missing.
    pub fn trust_rig(&self, document: &Document) -> Result<trust::Rig, StageError> {
        let set = &document.set;
        let loaded = self.loaded().ok_or(StageError::Reading)?;
        let nothing = Calibrated::default();
        let calibration = self.calibration_of(set);
        let calibration = calibration
            .as_deref()
            .filter(|calibration| calibration.lights.iter().eq(set.lights.iter().map(|light| &light.name)));
        let calibrated = calibration.map_or(&nothing, |calibration| &*calibration.calibrated);
        Ok(rig_of(set, &loaded.levels, calibrated)?)
    }

    /// What is known of a set's rig beyond what it gives now. While a typed value that was taken back is still in force in
    /// the last calibration, the balls alone say it.
    fn calibration_of(&self, set: &CaptureSet) -> Option<Arc<Calibration>> {
        let colours = |of: &Arc<Calibration>| of.colours.iter().eq(set.colours.iter().map(|colour| &colour.name));
        let exact = |of: &Arc<Calibration>| of.given.values == set.calibration && of.given.lights == set.lights;
        let last = self.calibration().filter(colours);
        let balls = || self.measured().filter(colours);
        let holds = |of: &Arc<Calibration>| of.given.is_given_by(set);
        last.clone().filter(exact).or_else(balls).or_else(|| last.filter(holds))
    }

    /// alpha, beta and m of this document: what it gives, else what was calibrated last.
    pub fn rig(&self, document: &Document) -> Rig {
        let set = &document.set;
        let calibration = self.calibration_of(set);
        let colours = &set.colours;
        let fits = |values: &&Vec<f64>| values.len() == colours.len();
        let values =
            |known: &Vec<firstbounce_capture::pipeline::Known<f64>>| known.iter().map(|k| k.value).collect::<Vec<_>>();
        let alone = (colours.len() == 1).then(|| vec![1.0]);
        let alpha = |name: &str| {
            let given = set.calibration.alpha.get(name).filter(fits).cloned();
            let measured = || {
                let calibration = calibration.as_ref()?;
                let index = calibration.lights.iter().position(|light| light == name)?;
                calibration.calibrated.alpha.get(index)?.as_ref().map(values)
            };
            given.or_else(measured).or_else(|| alone.clone())
        };
        let beta = set.calibration.beta.as_ref().filter(fits).cloned();
        let measured = || calibration.as_ref()?.calibrated.beta.as_ref().map(values);
        let levels = self.loaded().map(|loaded| loaded.levels.clone()).unwrap_or_default();
        Rig {
            lights: set.lights.iter().map(|light| light.name.clone()).collect(),
            alpha: set.lights.iter().map(|light| alpha(&light.name)).collect(),
            beta: beta.or_else(measured).or_else(|| alone.clone()),
            bounces: set.bounces(),
            sigma: levels.sigma,
            mean: levels.mean,
        }
    }
}
