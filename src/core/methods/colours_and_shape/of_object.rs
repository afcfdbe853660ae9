//! Beta from the object itself, where there is no ball of its paint. See "Beta without a ball of the paint" in [`crate::method`].

use super::end_of_ratio::{Arriving, EndOfRatio, ends_of_ratio};
use super::grid::Grid;
use super::{ClosureOptions, ColoursAndShapeError, ColoursAndShapeOptions, OnGrid, Photographed};
use crate::interval::{Estimate, Interval};
use crate::separate::LightPhotos;
use crate::stereo::shape::ShapeOptions;
use crate::{Portion, Watch};

/// Betas are found this often, each time with the shape that the last ones give.
const ROUNDS: usize = 3;
/// Arriving light is computed on at most so many cells: beta needs means only.
const CELLS: usize = 40_000;
/// On these larger cells s may differ from k by so much, relative.
const ALLOWED_DIFFERENCE: f64 = 0.06;
/// Photos of two colours agree to this share at best (linearity, lens, lamps that drift), as a standard deviation.
const AGREEMENT: f64 = 0.002;
/// Where indirect light still takes this share from the end of the ratio, no part of the object is free of it.
const ALL_CAVITY: f64 = 0.01;

/// What the object tells of one colour's beta.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectBeta {
    /// Beta and its 95 % interval.
    pub estimate: Estimate,
    /// The end of the colour's ratio over the reference colour.
    pub end: EndOfRatio,
    /// The beta for which the amount of indirect light agrees with the albedo; `None` where the light of white is not known, or no
    /// shape.
    pub agreeing: Option<Estimate>,
    /// What makes it doubtful.
    pub doubt: Option<BetaDoubt>,
}

/// What makes a beta doubtful that the object tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BetaDoubt {
    /// The end of the ratio and closure disagree.
    Disagree,
    /// Indirect light falls in everywhere, and no albedo tells how much.
    AllCavity,
    /// No shape was found: nothing tells whether indirect light falls in everywhere.
    NoShape,
}

/// Beta of every colour but the reference, from the object alone. The betas of `photographed` are not looked at. Empty where
/// nothing is lit.
///
/// # Errors
/// `ColoursAndShapeError`, as [`super::separate_by_colours_and_shape`].
pub fn beta_of_object(
    photographed: &Photographed,
    options: &ColoursAndShapeOptions,
    shape_options: &ShapeOptions,
    watch: &dyn Watch,
) -> Result<Vec<ObjectBeta>, ColoursAndShapeError> {
    let allowed_difference = options.closure.allowed_difference.max(ALLOWED_DIFFERENCE);
    let closure = ClosureOptions { allowed_difference, ..options.closure };
    let options = ColoursAndShapeOptions { cells: options.cells.min(CELLS), rounds: 1, closure, ..*options };
    options.check()?;
    for light in photographed.lights {
        light.check()?;
    }
    let grid = Grid::new(photographed.lights, photographed.mask, photographed.camera, options.cells);
    let Some(ends) = ends_of_ratio(&grid, None).into_iter().collect::<Option<Vec<_>>>() else {
        return Ok(Vec::new());
    };
    let from_ends: Vec<_> = ends.into_iter().map(|end| ObjectBeta::of(end, None)).collect();
    let mut found = from_ends.clone();
    for round in 0..ROUNDS {
        let beta: Vec<f64> = std::iter::once(1.0).chain(found.iter().map(|found| found.estimate.value)).collect();
        let lights: Vec<_> = photographed.lights.iter().map(|light| LightPhotos { beta: &beta, ..*light }).collect();
        let photographed = Photographed { lights: &lights, ..*photographed };
        // Colours that the paint reflects alike tell nothing; what is known so far says so.
        if photographed.check().is_err() {
            break;
        }
        let part = |step: usize| Portion::of(watch, 2 * round + step, 2 * ROUNDS);
        let on_grid = OnGrid::find(&photographed, &options, shape_options, &part, &mut |_| {})?;
        let Some(closure) = on_grid.closure(&photographed, &options, shape_options, &part(1)) else {
            found = on_grid.ends_without_arriving_light().unwrap_or(found);
            break;
        };
        let of_colours: Option<Vec<_>> = closure.colours.into_iter().map(|colour| colour.object).collect();
        found = of_colours.unwrap_or(found);
        // Before the last round beta is still off, and so is the shape.
        if round + 1 == ROUNDS && on_grid.misleads(&photographed, shape_options).is_some() {
            return Ok(from_ends);
        }
    }
    Ok(found)
}

impl OnGrid {
    /// Where a shape was found on which no light arrives anywhere, the ends are free of it; `None` without a shape.
    fn ends_without_arriving_light(&self) -> Option<Vec<ObjectBeta>> {
        self.shape.as_ref()?;
        let arriving = Arriving { indirect: &self.indirect, light: &self.arriving, amount: 1.0 };
        let ends = ends_of_ratio(&self.grid, Some(arriving)).into_iter();
        ends.map(|end| Some(ObjectBeta::of(end?, None))).collect()
    }
}

impl ObjectBeta {
    /// Whether the estimate is one, and not a mere bound.
    pub(super) fn is_known(&self) -> bool {
        self.agreeing.is_some() || self.end.indirect_share.is_some_and(|share| share < ALL_CAVITY)
    }

    /// Whether no indirect light can make the end of the ratio of `beta`.
    pub(super) fn is_beyond(&self, beta: f64) -> bool {
        let EndOfRatio { value, noise, .. } = self.end;
        let allowed = 3.0 * noise.hypot(AGREEMENT * value);
        if value < 1.0 { value > beta + allowed } else { value < beta - allowed }
    }

    /// What makes it doubtful, in a sentence; `colour` is its name.
    pub fn doubt_words(&self, colour: &str) -> Option<String> {
        let Estimate { interval, .. } = self.estimate;
        let range = format!("{:.4} to {:.4}", interval.low, interval.high);
        Some(match self.doubt? {
            BetaDoubt::Disagree => format!(
                "the object contradicts itself about beta of {colour}: its colour ratio ends at {:.4}, and the amount of indirect \
                 light asks for {:.4}; are the grey ball's albedo and alpha right, and is the object of one paint?",
                self.end.value,
                self.agreeing.map_or(self.end.value, |agreeing| agreeing.value),
            ),
            BetaDoubt::AllCavity => format!(
                "beta of {colour} is a guess ({range}): light from other walls falls on all of the object; state the grey ball's \
                 albedo (grey_albedo), or photograph a ball of the paint"
            ),
            BetaDoubt::NoShape => format!(
                "beta of {colour} is a guess ({range}): nothing tells whether any part of the object is free of light from other \
                 walls; photograph a ball of the paint"
            ),
        })
    }

    /// Both err toward 1's far side: the end of the ratio where indirect light falls in everywhere, closure where walls are out of
    /// view. So the one nearer to 1 counts, on the side where beta lies.
    pub(super) fn of(end: EndOfRatio, agreeing: Option<Estimate>) -> Self {
        let is_darker = end.value < 1.0;
        let noise = 2.0 * end.noise.hypot(AGREEMENT * end.value);
        // By how much the end may fall short of beta, as far as the amount of indirect light is known.
        let short = 2.0 * end.indirect_share.unwrap_or(0.0).min(0.25);
        let free = if is_darker { end.value / (1.0 - short) } else { end.value / (1.0 + short) };
        let of_end = Interval { low: end.value.min(free) - noise, high: end.value.max(free) + noise };
        // Closure counts within what the indirect light at the end allows: it knows K and the grey ball less well.
        let is_bound = agreeing
            .is_some_and(|agreeing| (agreeing.value > end.value) == is_darker && of_end.contains(agreeing.value));
        let estimate = match agreeing {
            Some(agreeing) if is_bound => {
                let Interval { low, high } = agreeing.interval;
                let bound = if is_darker { end.value - noise } else { end.value + noise };
                let interval = if is_darker {
                    Interval { low: low.max(bound).min(agreeing.value), high }
                } else {
                    Interval { low, high: high.min(bound).max(agreeing.value) }
                };
                Estimate { value: agreeing.value, interval }
            }
            _ => Estimate { value: end.value, interval: of_end },
        };
        let apart = |agreeing: Estimate| {
            let Interval { low, high } = agreeing.interval;
            high < of_end.low || low > of_end.high
        };
        let doubt = match (end.indirect_share, agreeing) {
            (_, Some(agreeing)) => apart(agreeing).then_some(BetaDoubt::Disagree),
            (Some(share), None) => (share > ALL_CAVITY).then_some(BetaDoubt::AllCavity),
            (None, None) => Some(BetaDoubt::NoShape),
        };
        Self { estimate, end, agreeing, doubt }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn end(value: f64, indirect_share: Option<f64>) -> EndOfRatio {
        EndOfRatio { value, noise: 1e-4, indirect_share }
    }

    fn agreeing(value: f64) -> Option<Estimate> {
        Some(Estimate { value, interval: Interval::around(value, 0.01 * value) })
    }

    /// Both err away from 1's side: the larger of two below 1, the smaller of two above.
    #[test]
    fn the_estimate_that_indirect_light_spoils_less_is_taken() {
        for (ends, agrees, taken) in [(0.50, 0.49, 0.50), (0.47, 0.50, 0.50), (2.0, 2.04, 2.0), (2.1, 2.0, 2.0)] {
            let told = ObjectBeta::of(end(ends, Some(0.06)), agreeing(agrees));
            assert_eq!(told.estimate.value, taken, "{told:?}");
            assert!(told.estimate.interval.contains(taken), "{told:?}");
        }
    }

    #[test]
    fn an_end_in_light_from_other_walls_is_a_bound_and_said_to_be() {
        let free = ObjectBeta::of(end(0.5, Some(0.0)), None);
        assert!(free.is_known() && free.doubt.is_none() && free.estimate.relative_half_width() < 0.006, "{free:?}");
        let cavity = ObjectBeta::of(end(0.475, Some(0.06)), None);
        assert!(!cavity.is_known() && cavity.estimate.interval.contains(0.505), "{cavity:?}");
        assert!(cavity.doubt_words("green").unwrap().contains("beta of green is a guess"));
    }

    #[test]
    fn estimates_that_contradict_each_other_are_told() {
        let told = ObjectBeta::of(end(0.5, Some(0.0)), agreeing(0.45));
        assert_eq!(told.doubt, Some(BetaDoubt::Disagree));
        assert!(told.is_beyond(0.49) && !told.is_beyond(0.51));
        assert!(ObjectBeta::of(end(2.0, None), None).is_beyond(2.1));
    }
}
