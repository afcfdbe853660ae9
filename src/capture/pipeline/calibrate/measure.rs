//! The order in which values are measured: each needs the ones before.

use firstbounce_core::calibrate::{
    IntensityOptions, Lamp, RatioOptions, StrengthReport, measure_ratio, measure_strength, pool_beta,
    relative_intensities,
};
use firstbounce_core::interval::Estimate;
use nalgebra::Vector3;
use rayon::prelude::*;

use super::super::PipelineError;
use super::super::checks::of_rig;
use super::balls::{BallPhotos, BallShots, needed};
use super::direction::{MeasuredDirection, add_common_doubts, measure_direction};
use super::position::{measure_position, other_mirrors};
use super::scale::contradicted_scale;
use super::unknown_crosstalk::unknown_crosstalk;
use super::warning::Warning;
use super::{BallCircle, BallNotFound, Calibrated, Known, Preference, RatioEvidence, Source};
use crate::set::{BallValue, CaptureSet, SphereKind};

/// Values by colour, where there are any, and the ratios behind them.
type Measured = (Option<Vec<Known<f64>>>, Vec<RatioEvidence>);

/// The kinds of balls in the order in which they are looked at.
const SPHERES: [SphereKind; 3] = [SphereKind::Grey, SphereKind::Material, SphereKind::Mirror];

/// A calibration on its way.
pub(super) struct Measuring<'a> {
    set: &'a CaptureSet,
    preference: Preference,
    grey: Option<BallShots>,
    material: Option<BallShots>,
    mirror: Option<BallShots>,
    /// The further mirror balls: in the same pictures, and those of the ball in its second place.
    other_mirrors: Vec<BallShots>,
    calibrated: Calibrated,
}

impl<'a> Measuring<'a> {
    /// Takes the balls that will be looked at.
    pub fn new(set: &'a CaptureSet, preference: Preference, photos: &BallPhotos) -> Result<Self, PipelineError> {
        let needed = needed(set, preference);
        let mut not_found = Vec::new();
        let mut ball = |kind, found| match found {
            _ if !needed.contains(&kind) => Ok(None),
            Err(PipelineError::Ball { subject, reason }) => {
                not_found.push(BallNotFound { kind, subject, reason });
                Ok(None)
            }
            found => found,
        };
        let [grey, material, mirror] = SPHERES.map(|kind| ball(kind, BallShots::among(photos, set, kind)));
        let (grey, material, mirror) = (grey?, material?, mirror?);
        let moved = ball(SphereKind::Mirror, BallShots::moved(photos, set))?;

        let mut calibrated = Calibrated { not_found, ..Calibrated::default() };
        for ball in [&grey, &material, &mirror, &moved].into_iter().flatten() {
            calibrated.circles.push(ball.circle.clone());
        }
        let circles = calibrated.circles.iter().filter_map(BallCircle::doubt);
        calibrated.warnings.extend(circles.map(|doubt| Warning::Circle(doubt).to_string()));
        calibrated.warnings.extend(contradicted_scale(set).iter().map(ToString::to_string));
        let (other_mirrors, warnings) = other_mirrors(set, mirror.as_ref(), moved);
        calibrated.warnings.extend(warnings.iter().map(ToString::to_string));
        Ok(Self { set, preference, grey, material, mirror, other_mirrors, calibrated })
    }

    pub fn run(mut self) -> Result<Calibrated, PipelineError> {
        let alphas = (0..self.set.lights.len()).into_par_iter().map(|l| self.alpha(l));
        for (alpha, evidence) in alphas.collect::<Result<Vec<_>, PipelineError>>()? {
            self.calibrated.alpha.push(alpha);
            self.calibrated.ratios.extend(evidence);
        }
        let (beta, evidence) = self.beta()?;
        let of_crosstalk = unknown_crosstalk(self.set, &self.calibrated, &evidence);
        self.calibrated.warnings.extend(of_crosstalk.iter().map(ToString::to_string));
        self.calibrated.beta = beta;
        self.calibrated.ratios.extend(evidence);
        let mut directions = self.directions()?;
        add_common_doubts(&self.set.lights, &self.calibrated.direction, &mut directions);
        self.intensities(&directions)?;
        self.check_not_found()?;
        self.room_light(&directions);
        self.warn_of_typed();
        self.positions(&directions);
        for direction in directions {
            self.calibrated.direction_doubts.push(direction.doubts);
            self.calibrated.highlights.push(direction.highlights);
        }
        let captures = of_rig(self.set, &self.calibrated);
        self.calibrated.warnings.extend(captures.iter().map(ToString::to_string));
        Ok(self.calibrated)
    }

    /// A ball that was not found is an error where a value that it gives is not known. beta may still be measured on the
    /// object.
    fn check_not_found(&mut self) -> Result<(), PipelineError> {
        let calibrated = &self.calibrated;
        let open = |value: BallValue| match value {
            BallValue::Alpha => calibrated.alpha.iter().any(Option::is_none),
            BallValue::Beta => false,
            BallValue::Intensity => calibrated.intensity.iter().any(|known| known.source == Source::Assumed),
            BallValue::Direction => calibrated.direction.iter().any(Option::is_none),
        };
        let values = [BallValue::Alpha, BallValue::Intensity, BallValue::Direction];
        let is_missed = |ball: &&BallNotFound| values.iter().any(|&value| ball.kind.gives(value) && open(value));
        if let Some(ball) = calibrated.not_found.iter().find(is_missed) {
            return Err(ball.error());
        }
        let warnings = calibrated.not_found.iter().map(|ball| Warning::BallNotFound(ball).to_string());
        let warnings: Vec<_> = warnings.collect();
        self.calibrated.warnings.extend(warnings);
        Ok(())
    }

    /// By light, how much of its light on the balls is not the lamp's.
    fn room_light(&mut self, directions: &[MeasuredDirection]) {
        // A circle that is off its ball gives such a fit too.
        let grey_is_off = self.grey.as_ref().is_some_and(|ball| ball.circle.doubt().is_some());
        let share = |(l, direction): (usize, &MeasuredDirection)| {
            let of_shading = direction
                .shading
                .iter()
                .filter(|report| report.room_light && !grey_is_off)
                .map(|report| report.ambient);
            let ratios = self.calibrated.ratios.iter().filter(|ratio| ratio.light == l && ratio.report.offset);
            let of_ratios =
                ratios.map(|RatioEvidence { report, .. }| (report.ratio.value / report.slope.value - 1.0).abs());
            of_shading.chain(of_ratios).reduce(f64::max)
        };
        let shares: Vec<Option<f64>> = directions.iter().enumerate().map(share).collect();
        self.calibrated.room_light = shares;
    }

    /// Positions of lamps, where there are several mirror balls or one in two places.
    fn positions(&mut self, directions: &[MeasuredDirection]) {
        let position = |(l, direction): (usize, &MeasuredDirection)| {
            let (first, report) = (self.mirror.as_ref()?, direction.highlights.as_ref()?);
            let others = &self.other_mirrors;
            if others.is_empty() { None } else { measure_position(self.set, l, (first, report), others) }
        };
        self.calibrated.position = directions.par_iter().enumerate().map(position).collect();
    }

    /// Typed values that the balls contradict; of directions, see the doubts about them.
    fn warn_of_typed(&mut self) {
        let set = self.set;
        let mut warn = |what: String, known: &Known<f64>, typed: f64| {
            if let Some(off) = known.contradicted() {
                let (measured, half_width) =
                    (off.measured.value, off.measured.value * off.measured.relative_half_width());
                self.calibrated.warnings.push(Warning::Typed { what, typed, measured, half_width }.to_string());
            }
        };
        let given = &set.calibration;
        let beside = |typed: f64, known: &Known<f64>| Known::from_file(typed).beside(Some(known));
        for (light, (alpha, intensity)) in
            set.lights.iter().zip(self.calibrated.alpha.iter().zip(&self.calibrated.intensity))
        {
            let of_colours = given.alpha.get(&light.name).into_iter().flatten().zip(alpha.iter().flatten());
            for ((&typed, known), colour) in of_colours.zip(&set.colours) {
                warn(format!("alpha of light {} in {}", light.name, colour.name), &beside(typed, known), typed);
            }
            if let Some(&typed) = given.intensity.get(&light.name) {
                warn(format!("the intensity of light {}", light.name), &beside(typed, intensity), typed);
            }
        }
        let of_colours = given.beta.iter().flatten().zip(self.calibrated.beta.iter().flatten());
        for ((&typed, known), colour) in of_colours.zip(&set.colours) {
            warn(format!("beta in {}", colour.name), &beside(typed, known), typed);
        }
    }

    /// The winner of what the file gives and what a ball gives, which keeps what the ball says.
    fn choose<T: Copy>(&self, given: Option<Known<T>>, measured: Option<Known<T>>) -> Option<Known<T>> {
        match (self.preference, given) {
            (Preference::File, Some(given)) => Some(given.beside(measured.as_ref())),
            (_, given) => measured.or(given),
        }
    }

    /// The same of the values of all colours.
    fn choose_all(&self, given: Option<&Vec<f64>>, measured: Option<Vec<Known<f64>>>) -> Option<Vec<Known<f64>>> {
        let of_colour = |c: usize| measured.as_ref().and_then(|measured| measured.get(c)).cloned();
        let choose = |(c, &value): (usize, &f64)| self.choose(Some(Known::from_file(value)), of_colour(c));
        match given {
            Some(given) if self.preference == Preference::File || measured.is_none() => {
                given.iter().enumerate().map(choose).collect()
            }
            _ => measured,
        }
    }

    /// What a ball says; where the file's value wins, a ball that cannot be used is no error.
    fn unless_given<T>(
        &self,
        given: bool,
        measured: Result<Option<T>, PipelineError>,
    ) -> Result<Option<T>, PipelineError> {
        if given && self.preference == Preference::File { Ok(measured.ok().flatten()) } else { measured }
    }

    fn alpha(&self, l: usize) -> Result<Measured, PipelineError> {
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

    fn beta(&self) -> Result<Measured, PipelineError> {
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
                Preference::BallsUnderGivenLights => given.map(|given| given.beside(measured.as_ref())).or(measured),
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

fn unit(vector: [f64; 3]) -> [f64; 3] {
    Vector3::from(vector).normalize().into()
}
