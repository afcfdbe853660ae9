//! The strengths of the lamps, on the grey ball.

use firstbounce_core::calibrate::{IntensityOptions, Lamp, StrengthReport, measure_strength, relative_intensities};
use firstbounce_core::interval::Estimate;
use nalgebra::Vector3;
use rayon::prelude::*;

use super::super::super::PipelineError;
use super::super::direction::MeasuredDirection;
use super::super::warning::Warning;
use super::super::{Known, Source};
use super::Measuring;
use crate::set::SphereKind;

impl Measuring<'_> {
    /// Strengths on the grey ball; what cannot be measured is taken as equal, with a warning.
    pub(super) fn intensities(&mut self, directions: &[MeasuredDirection]) -> Result<(), PipelineError> {
        let strengths = (0..self.set.lights.len())
            .into_par_iter()
            .map(|l| self.strength(l, directions[l].half_angle_deg))
            .collect::<Result<Option<Vec<StrengthReport>>, PipelineError>>()?;
        let first_strength = strengths.as_ref().and_then(|strengths| strengths.first()).map(|first| first.strength);
        let measured: Option<Vec<_>> = strengths.map(|strengths| {
            let relative = relative_intensities(&strengths.iter().collect::<Vec<_>>());
            let known = relative.into_iter().zip(strengths).zip(without_room_light(directions));
            known
                .map(|((estimate, report), without)| {
                    let estimate = without.map_or(estimate, |without| estimate.widened_to(&Estimate::exact(without)));
                    Known::measured(estimate, Source::GreyBall, Some(report.pixels))
                })
                .collect()
        });
        let mut assumed = Vec::new();
        for (l, light) in self.set.lights.iter().enumerate() {
            let given = self.set.calibration.intensity.get(&light.name).copied().map(Known::from_file);
            let measured = measured.as_ref().map(|all| all[l].clone());
            let intensity = self.choose(given, measured).unwrap_or_else(|| {
                assumed.push(light.name.as_str());
                Known::new(1.0, Source::Assumed)
            });
            self.calibrated.intensity.push(intensity);
        }
        let first_intensity = self.calibrated.intensity.first().map(|known| known.value);
        self.calibrated.grey_light =
            first_strength.zip(first_intensity).map(|(strength, intensity)| strength / intensity);
        if !assumed.is_empty() {
            self.calibrated.warnings.push(Warning::AssumedIntensities { lights: assumed }.to_string());
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

/// By light, its strength over the first light's where the light of the room is left out of both; `None` where there is
/// none.
fn without_room_light(directions: &[MeasuredDirection]) -> Vec<Option<f64>> {
    let shading = |l: usize| directions.get(l).and_then(|direction| direction.shading.as_ref());
    let without = |l: usize| {
        let (first, this) = (shading(0)?, shading(l)?);
        (l > 0 && (first.room_light || this.room_light)).then_some(this.strength / first.strength)
    };
    (0..directions.len()).map(without).collect()
}
