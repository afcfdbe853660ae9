//! The order in which values are measured: each needs the ones before.

use firstbounce_core::calibrate::{
    IntensityOptions, Lamp, RatioOptions, StrengthReport, measure_ratio, measure_strength, pool_beta,
    relative_intensities,
};
use firstbounce_core::interval::Estimate;
use nalgebra::Vector3;
use rayon::prelude::*;

use super::super::PipelineError;
use super::balls::{BallPhotos, BallShots, needed};
use super::direction::{MeasuredDirection, measure_direction};
use super::{Calibrated, Known, Preference, RatioEvidence, Source};
use crate::set::{CaptureSet, SphereKind};

/// Values by colour, where there are any, and the ratios behind them.
type Measured = (Option<Vec<Known<f64>>>, Vec<RatioEvidence>);

/// A calibration on its way.
pub(super) struct Measuring<'a> {
    set: &'a CaptureSet,
    preference: Preference,
    grey: Option<BallShots>,
    material: Option<BallShots>,
    mirror: Option<BallShots>,
    calibrated: Calibrated,
}

impl<'a> Measuring<'a> {
    /// Takes the balls that will be looked at.
    pub fn new(set: &'a CaptureSet, preference: Preference, photos: &BallPhotos) -> Result<Self, PipelineError> {
        let needed = needed(set, preference);
        let ball = |kind| if needed.contains(&kind) { BallShots::among(photos, set, kind) } else { Ok(None) };
        let (grey, material, mirror) =
            (ball(SphereKind::Grey)?, ball(SphereKind::Material)?, ball(SphereKind::Mirror)?);

        let mut calibrated = Calibrated::default();
        for ball in [&grey, &material, &mirror].into_iter().flatten() {
            calibrated.circles.push(ball.circle.clone());
            calibrated.warnings.extend_from_slice(ball.file_warnings());
        }
        Ok(Self { set, preference, grey, material, mirror, calibrated })
    }

    pub fn run(mut self) -> Result<Calibrated, PipelineError> {
        let alphas = (0..self.set.lights.len()).into_par_iter().map(|l| self.alpha(l));
        for (alpha, evidence) in alphas.collect::<Result<Vec<_>, PipelineError>>()? {
            self.calibrated.alpha.push(alpha);
            self.calibrated.ratios.extend(evidence);
        }
        let (beta, evidence) = self.beta()?;
        self.calibrated.beta = beta;
        self.calibrated.ratios.extend(evidence);
        let directions = self.directions()?;
        self.intensities(&directions)?;
        for (light, direction) in self.set.lights.iter().zip(directions) {
            let doubts = direction.doubts.iter().map(|doubt| format!("light {}: {doubt}", light.name));
            self.calibrated.warnings.extend(doubts);
            self.calibrated.direction_doubts.push(direction.doubts);
            self.calibrated.highlights.push(direction.highlights);
        }
        Ok(self.calibrated)
    }

    /// The winner of what the file gives and what a ball gives.
    fn choose<T>(&self, given: Option<T>, measured: Option<T>) -> Option<T> {
        match self.preference {
            Preference::File => given.or(measured),
            Preference::Balls | Preference::BallsUnderGivenLights => measured.or(given),
        }
    }

    fn wants_balls(&self, given: bool) -> bool {
        self.preference != Preference::File || !given
    }

    fn alpha(&self, l: usize) -> Result<Measured, PipelineError> {
        let colours = self.set.colours.len();
        if colours == 1 {
            return Ok((Some(vec![Known::by_definition()]), Vec::new()));
        }
        let light = &self.set.lights[l].name;
        let given = self.set.calibration.alpha.get(light);
        let evidence = match &self.grey {
            Some(ball) if self.wants_balls(given.is_some()) => self.ratios(ball, l)?,
            _ => None,
        };
        let measured = evidence.as_deref().map(|evidence| known_ratios(evidence, Source::GreyBall));
        let given = given.map(|values| values.iter().copied().map(Known::from_file).collect());
        Ok((self.choose(given, measured), evidence.unwrap_or_default()))
    }

    /// The ratios of each other colour over the reference colour on a ball under light `l`; `None` without photos of it.
    fn ratios(&self, ball: &BallShots, l: usize) -> Result<Option<Vec<RatioEvidence>>, PipelineError> {
        let Some(reference) = ball.photo(l, 0) else { return Ok(None) };
        let light = &self.set.lights[l].name;
        let ratio = |c: usize| {
            let Some(photo) = ball.photo(l, c) else { return Ok(None) };
            let report = measure_ratio(reference, photo, &ball.ball, &RatioOptions::default())
                .map_err(|reason| PipelineError::calibrate(light, ball.kind, reason))?;
            Ok(Some(RatioEvidence { ball: ball.kind, light: l, colour: c, report }))
        };
        (1..self.set.colours.len()).map(ratio).collect()
    }

    fn beta(&self) -> Result<Measured, PipelineError> {
        let colours = self.set.colours.len();
        if colours == 1 {
            return Ok((Some(vec![Known::by_definition()]), Vec::new()));
        }
        let given = &self.set.calibration.beta;
        let (measured, evidence) = match &self.material {
            Some(ball) if self.wants_balls(given.is_some()) => self.measured_beta(ball)?,
            _ => (None, Vec::new()),
        };
        let given = given.as_ref().map(|values| values.iter().copied().map(Known::from_file).collect());
        Ok((self.choose(given, measured), evidence))
    }

    /// Pooled over the lights that have both balls.
    fn measured_beta(&self, ball: &BallShots) -> Result<Measured, PipelineError> {
        let lights: Vec<_> = (0..self.set.lights.len()).collect();
        let evidence = lights.par_iter().map(|&l| self.ratios(ball, l)).collect::<Result<Vec<_>, PipelineError>>()?;
        let ratios: Vec<_> = evidence
            .iter()
            .map(|evidence| evidence.as_deref().map(|evidence| known_ratios(evidence, Source::MaterialBall)))
            .collect();
        let evidence = evidence.into_iter().flatten().flatten().collect();
        let mut beta = vec![Known::by_definition()];
        for c in 1..self.set.colours.len() {
            let both = ratios.iter().zip(&self.calibrated.alpha);
            let both: Vec<_> =
                both.filter_map(|(paint, alpha)| Some((&paint.as_ref()?[c], &alpha.as_ref()?[c]))).collect();
            if both.is_empty() {
                return Ok((None, evidence));
            }
            let pairs: Vec<(Estimate, Estimate)> = both.iter().map(|(p, a)| (p.estimate(), a.estimate())).collect();
            let pooled =
                pool_beta(&pairs).map_err(|reason| PipelineError::calibrate("all", SphereKind::Material, reason))?;
            let pixels = both.first().and_then(|(paint, _)| paint.pixels.clone());
            beta.push(Known::measured(pooled, Source::MaterialBall, pixels));
        }
        Ok((Some(beta), evidence))
    }

    /// What the balls say of every light's direction; the directions in force go into `calibrated`.
    fn directions(&mut self) -> Result<Vec<MeasuredDirection>, PipelineError> {
        let lights = self.set.lights.len();
        let measured = self
            .set
            .lights
            .par_iter()
            .enumerate()
            .map(|(l, light)| {
                let typed = self.set.given_direction(&light.name);
                measure_direction(light, l, lights, self.mirror.as_ref(), self.grey.as_ref(), typed)
            })
            .collect::<Result<Vec<_>, _>>()?;
        for (light, measured) in self.set.lights.iter().zip(&measured) {
            let given = self.set.given_direction(&light.name).map(Known::from_file);
            let measured = measured.known.clone();
            let direction = match self.preference {
                Preference::BallsUnderGivenLights => given.or(measured),
                Preference::File | Preference::Balls => self.choose(given, measured),
            };
            self.calibrated.direction.push(direction.or_else(|| light.position_mm.map(|p| Known::from_file(unit(p)))));
        }
        Ok(measured)
    }

    /// Strengths on the grey ball; what cannot be measured is taken as equal, with a warning.
    fn intensities(&mut self, directions: &[MeasuredDirection]) -> Result<(), PipelineError> {
        let strengths = (0..self.set.lights.len())
            .into_par_iter()
            .map(|l| self.strength(l, directions[l].half_angle_deg))
            .collect::<Result<Option<Vec<StrengthReport>>, PipelineError>>()?;
        let first_strength = strengths.as_ref().and_then(|strengths| strengths.first()).map(|first| first.strength);
        let measured: Option<Vec<_>> = strengths.map(|strengths| {
            let relative = relative_intensities(&strengths.iter().collect::<Vec<_>>());
            let known = relative.into_iter().zip(strengths);
            known.map(|(estimate, report)| Known::measured(estimate, Source::GreyBall, Some(report.pixels))).collect()
        });
        let mut assumed = Vec::new();
        for (l, light) in self.set.lights.iter().enumerate() {
            let given = self.set.calibration.intensity.get(&light.name).copied().map(Known::from_file);
            let measured = measured.as_ref().map(|all| all[l].clone());
            let intensity = self.choose(given, measured).unwrap_or_else(|| {
                assumed.push(light.name.as_str());
                Known { value: 1.0, interval: None, source: Source::Assumed, pixels: None }
            });
            self.calibrated.intensity.push(intensity);
        }
        let first_intensity = self.calibrated.intensity.first().map(|known| known.value);
        self.calibrated.grey_light =
            first_strength.zip(first_intensity).map(|(strength, intensity)| strength / intensity);
        if !assumed.is_empty() {
            self.calibrated.warnings.push(format!(
                "no grey ball tells the intensity of {}: taken as 1, which bends the normals if these lamps are not equally strong",
                assumed.join(", ")
            ));
        }
        Ok(())
    }

    /// The strength of light `l` in the reference colour; `None` without a photo of the grey ball or a direction.
    fn strength(&self, l: usize, half_angle_deg: f64) -> Result<Option<StrengthReport>, PipelineError> {
        let Some(ball) = &self.grey else { return Ok(None) };
        let Some(photo) = ball.photo(l, 0) else { return Ok(None) };
        let light = &self.set.lights[l];
        let lamp = match (light.position_mm, ball.radius_mm(), &self.calibrated.direction[l]) {
            (Some(position), Some(ball_radius_mm), _) => {
                Lamp::Near { position_mm: Vector3::from(position), ball_centre_mm: Vector3::zeros(), ball_radius_mm }
            }
            (_, _, Some(direction)) => {
                Lamp::Distant { direction_to_light: Vector3::from(direction.value), half_angle_deg }
            }
            (_, _, None) => return Ok(None),
        };
        let options = IntensityOptions { circle_sd_px: ball.circle_sd_px, ..IntensityOptions::default() };
        let report = measure_strength(photo, &ball.ball, &lamp, &options)
            .map_err(|reason| PipelineError::calibrate(&light.name, SphereKind::Grey, reason))?;
        Ok(Some(report))
    }
}

/// The reference colour's 1 and the measured ratios of the others.
fn known_ratios(evidence: &[RatioEvidence], source: Source) -> Vec<Known<f64>> {
    let measured = |RatioEvidence { report, .. }: &RatioEvidence| {
        Known::measured(report.ratio, source, Some(report.pixels.clone()))
    };
    std::iter::once(Known::by_definition()).chain(evidence.iter().map(measured)).collect()
}

fn unit(vector: [f64; 3]) -> [f64; 3] {
    Vector3::from(vector).normalize().into()
}
