//! The order in which values are measured: each needs the ones before.

mod intensities;
mod ratios;
mod typed;

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
}

fn unit(vector: [f64; 3]) -> [f64; 3] {
    Vector3::from(vector).normalize().into()
}
