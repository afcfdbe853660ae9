//! alpha and beta: ratios of the colours on the grey ball and on the ball of the paint.

use firstbounce_core::calibrate::{RatioOptions, measure_ratio, pool_beta};
use firstbounce_core::interval::Estimate;
use rayon::prelude::*;

use super::super::super::PipelineError;
use super::super::balls::BallShots;
use super::super::{Known, RatioEvidence, Source};
use super::Measuring;
use crate::set::SphereKind;

/// Values by colour, where there are any, and the ratios behind them.
type Measured = (Option<Vec<Known<f64>>>, Vec<RatioEvidence>);

impl Measuring<'_> {
    pub(super) fn alpha(&self, l: usize) -> Result<Measured, PipelineError> {
        let colours = self.set.colours.len();
        if colours == 1 {
            return Ok((Some(vec![Known::by_definition()]), Vec::new()));
        }
        let given = self.set.calibration.alpha.get(&self.set.lights[l].name);
        let evidence = self.grey.as_ref().map_or(Ok(None), |ball| self.ratios(ball, l));
        let evidence = self.unless_given(given.is_some(), evidence)?;
        let measured = evidence.as_deref().map(|evidence| known_ratios(evidence, Source::GreyBall));
        Ok((self.choose_all(given, measured), evidence.unwrap_or_default()))
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

    pub(super) fn beta(&self) -> Result<Measured, PipelineError> {
        let colours = self.set.colours.len();
        if colours == 1 {
            return Ok((Some(vec![Known::by_definition()]), Vec::new()));
        }
        let given = self.set.calibration.beta.as_ref();
        let measured = self.material.as_ref().map(|ball| self.measured_beta(ball)).transpose();
        let (measured, evidence) = self.unless_given(given.is_some(), measured)?.unwrap_or_default();
        Ok((self.choose_all(given, measured), evidence))
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
            let mut pooled = pool(&pairs)?;
            let slopes = self.slopes(&evidence, c);
            if slopes.iter().any(|slopes| slopes.offset) {
                let pairs: Vec<_> = slopes.iter().map(|slopes| (slopes.paint, slopes.alpha)).collect();
                pooled = pooled.widened_to(&pool(&pairs)?);
            }
            let pixels = both.first().and_then(|(paint, _)| paint.pixels.clone());
            beta.push(Known::measured(pooled, Source::MaterialBall, pixels));
        }
        Ok((Some(beta), evidence))
    }

    /// What the light that changes over the balls says of colour `c`, by light.
    fn slopes(&self, of_paint: &[RatioEvidence], c: usize) -> Vec<Slopes> {
        let of_paint = of_paint.iter().filter(|evidence| evidence.colour == c);
        let slopes = |evidence: &RatioEvidence| {
            let alpha = &self.calibrated.alpha[evidence.light].as_ref()?[c];
            let grey = self.calibrated.evidence(SphereKind::Grey, evidence.light, c).map(|grey| &grey.report);
            let grey = grey.filter(|_| alpha.source == Source::GreyBall);
            Some(Slopes {
                paint: evidence.report.slope,
                alpha: grey.map_or(alpha.estimate(), |grey| grey.slope),
                offset: evidence.report.offset || grey.is_some_and(|grey| grey.offset),
            })
        };
        of_paint.filter_map(slopes).collect()
    }
}

/// The reference colour's 1 and the measured ratios of the others.
fn known_ratios(evidence: &[RatioEvidence], source: Source) -> Vec<Known<f64>> {
    let measured = |RatioEvidence { report, .. }: &RatioEvidence| {
        let ratio = if report.offset { report.ratio.widened_to(&report.slope) } else { report.ratio };
        Known::measured(ratio, source, Some(report.pixels.clone()))
    };
    std::iter::once(Known::by_definition()).chain(evidence.iter().map(measured)).collect()
}

/// The ratios of light that changes over the balls, of one light and colour.
struct Slopes {
    paint: Estimate,
    alpha: Estimate,
    /// Whether either ball's own ratio is off it.
    offset: bool,
}

fn pool(paint_over_alpha: &[(Estimate, Estimate)]) -> Result<Estimate, PipelineError> {
    pool_beta(paint_over_alpha).map_err(|reason| PipelineError::calibrate("all", SphereKind::Material, reason))
}
