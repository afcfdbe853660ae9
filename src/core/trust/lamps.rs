//! From errors of direct light to degrees of normal, through the matrix of the lamps.

use nalgebra::{DMatrix, Matrix3, Vector3};

use super::{LightTrust, NormalTrust, Rig, TrustOptions, calibration, values};
use crate::denoise::denoised_noise;
use crate::linear_algebra;
use crate::separate::BounceSystem;

/// Lamps whose directions span less than this (smallest over largest singular value) lie in a plane.
const MIN_SPREAD: f64 = 0.01;

/// The lamps, and the facets they light.
pub(super) struct Lamps {
    /// For each light, the change of albedo times normal per unit of its direct light.
    effects: Vec<Vector3<f64>>,
    /// Mean of the outer product of albedo times normal with itself.
    facets: Matrix3<f64>,
}

impl Lamps {
    /// `None` for fewer than three lights of known direction, or lights in a plane.
    pub fn of(rig: &Rig, lights: &[LightTrust], systems: &[BounceSystem]) -> Option<Self> {
        let toward: Vec<_> = rig.lights.iter().map(|light| light.toward).collect::<Option<_>>()?;
        if toward.len() < 3 {
            return None;
        }
        let matrix = DMatrix::from_fn(toward.len(), 3, |l, axis| toward[l][axis]);
        let singular = linear_algebra::singular_values(&matrix)?;
        if singular.min() < MIN_SPREAD * singular.max() {
            return None;
        }
        let inverse = linear_algebra::pseudo_inverse(&matrix)?;
        let effects: Vec<_> =
            inverse.column_iter().map(|column| Vector3::new(column[0], column[1], column[2])).collect();
        let products = direct_products(rig, lights, systems);
        let facets = &inverse * products * inverse.transpose();
        let facets = facets.fixed_view::<3, 3>(0, 0).into_owned();
        (facets.trace() > 0.0).then_some(Self { effects, facets })
    }

    /// Root mean square angles by each kind of error.
    pub fn normal_trust(
        &self,
        rig: &Rig,
        lights: &[LightTrust],
        systems: &[BounceSystem],
        options: &TrustOptions,
    ) -> NormalTrust {
        let noise = |of: &dyn Fn(usize) -> f64| {
            self.degrees((0..lights.len()).map(|l| self.turn_squared(self.effects[l] * of(l))).sum())
        };
        let sigma = |l: usize| rig.lights[l].sigma.as_slice();
        NormalTrust {
            noise_deg: noise(&|l| systems[l].noise(sigma(l))[0]),
            denoised_noise_deg: noise(&|l| denoised_noise(&systems[l], sigma(l), &options.denoise)),
            calibration_deg: self.degrees(self.calibration_squared(rig, lights, systems)),
        }
    }

    /// Each alpha errs by itself; an error of beta is the same under every light.
    fn calibration_squared(&self, rig: &Rig, lights: &[LightTrust], systems: &[BounceSystem]) -> f64 {
        let mut alone = 0.0;
        let mut together = vec![Vector3::zeros(); values(&rig.beta).len()];
        for ((light, trust), (system, effect)) in rig.lights.iter().zip(lights).zip(systems.iter().zip(&self.effects)) {
            for source in calibration::sources(rig, light, system, &trust.bounces) {
                let change = effect * source.effect(0);
                if source.is_beta {
                    together[source.colour] += change;
                } else {
                    alone += self.turn_squared(change);
                }
            }
        }
        alone + together.into_iter().map(|change| self.turn_squared(change)).sum::<f64>()
    }

    /// A change along the normal changes the albedo only; the rest turns the normal. Mean over the facets, times the mean
    /// square of their albedo.
    fn turn_squared(&self, change: Vector3<f64>) -> f64 {
        change.norm_squared() - change.dot(&(self.facets * change)) / self.facets.trace()
    }

    fn degrees(&self, turn_squared: f64) -> f64 {
        (turn_squared.max(0.0) / self.facets.trace()).sqrt().to_degrees()
    }
}

/// Mean over the pixels of the product of every two lights' bounce 1, without what noise adds to the squares.
fn direct_products(rig: &Rig, lights: &[LightTrust], systems: &[BounceSystem]) -> DMatrix<f64> {
    let colours = rig.beta.len();
    if rig.products.nrows() != colours * lights.len() {
        return DMatrix::from_fn(lights.len(), lights.len(), |a, b| lights[a].bounces[0] * lights[b].bounces[0]);
    }
    DMatrix::from_fn(lights.len(), lights.len(), |a, b| {
        let block = rig.products.view((a * colours, b * colours), (colours, colours));
        let (first, second) = (systems[a].operator.row(0), systems[b].operator.row(0));
        let noise = if a == b { systems[a].noise(&rig.lights[a].sigma)[0].powi(2) } else { 0.0 };
        (first * block * second.transpose())[(0, 0)] - noise
    })
}
