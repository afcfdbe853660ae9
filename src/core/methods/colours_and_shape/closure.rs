//! Closure: the amount s of indirect light is the albedo of the paint, and so is k, the light of the paint over that of a white
//! facet. Where the two differ, either part of the cavity is out of view (then s is uneven) or beta is off. See "Closure" in
//! [`crate::method`].
//!
//! The colour ratios r_c and the arriving light K N_ref do not depend on beta. So s and k are found for another beta without
//! gathering light again.

use super::amount::Tiles;
use super::direct::{direct_light, placed};
use super::end_of_ratio::{Arriving, ends_of_ratio};
use super::fit::{Fit, amounts};
use super::grid::{Grid, GridLight};
use super::indirect::Indirect;
use super::{AmountReport, MAX_UNEVENNESS, ObjectBeta};
use crate::interval::{Estimate, Interval};
use crate::options::{OptionError, check_range};
use crate::separate::MIN_BETA_DISTANCE;
use crate::stereo::normals::{Lamp, NormalsOptions, Paint, PaintReport, Surface, normals};
use crate::{NormalMap, Plane, Portion, Watch};

/// How s and k are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ClosureOptions {
    /// The most cells that are looked at for each beta that is tried.
    pub cells: usize,
    /// s and k differ by as much, relative, where all is well: patches, creases, the grey ball.
    pub allowed_difference: f64,
}

impl Default for ClosureOptions {
    fn default() -> Self {
        // At the true beta s / k is 1.02 to 1.03 on rendered bowls whose whole cavity is in view.
        Self { cells: 20_000, allowed_difference: 0.04 }
    }
}

impl ClosureOptions {
    /// Whether every option is in its range.
    pub fn check(&self) -> Result<(), OptionError> {
        let in_range = (1000..=100_000_000).contains(&self.cells);
        check_range("cells", self.cells as f64, in_range, "from 1000 to 100 million")?;
        let in_range = (0.001..=1.0).contains(&self.allowed_difference);
        check_range("allowed_difference", self.allowed_difference, in_range, "from 0.001 to 1")
    }
}

/// Betas that are tried for one colour, beside the one in force.
const TRIALS: usize = 4;
/// The first of them differs by this share, and none by more than the other from the one before.
const FIRST_STEP: f64 = 0.01;
const MAX_STEP: f64 = 0.08;
/// s and k this near, relative, are the same.
const SAME: f64 = 1e-3;
/// Where s over k changes less than this for a change of beta, both relative, it says nothing of beta.
const MIN_SLOPE: f64 = 0.5;
/// No paint reflects more than it receives, and no likely error of beta makes s so much larger than k: light from out of view does.
const MAX_ALBEDO: f64 = 1.0;
const MAX_S_OVER_K: f64 = 1.2;
/// The effect of beta is found by a change of this share.
const PERCENT: f64 = 0.01;

/// What s, k and the ends of the colour ratios say.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosureReport {
    /// Light of the paint, facing a lamp of intensity 1, in the reference colour; `None` for an object of several paints.
    pub paint_light: Option<f64>,
    /// k, the absolute albedo in the reference colour; `None` where the light of white is not known either.
    pub albedo: Option<f64>,
    /// s over k, of s the part that can be compared: all where it is even, else where it is lowest.
    pub s_over_k: Option<f64>,
    /// By colour, the reference left out.
    pub colours: Vec<ColourClosure>,
    /// What follows, the most important first.
    pub findings: Vec<ClosureFinding>,
}

/// What s, k and the end of the ratio say of one colour's beta.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColourClosure {
    /// Beta in force.
    pub beta: f64,
    /// What the object tells of it; `None` where nothing is lit.
    pub object: Option<ObjectBeta>,
    /// By how many degrees 1 % of beta turns the normals, on the mean.
    pub turn_deg_per_percent: Option<f64>,
}

/// What closure says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ClosureFinding {
    /// s is even, and is k.
    Closed {
        /// s over k.
        s_over_k: f64,
    },
    /// s is uneven, or too large for any paint or for this one: then it is no measure of beta.
    OutOfView {
        /// How uneven.
        unevenness: f64,
        /// s over k, where k is known.
        s_over_k: Option<f64>,
    },
    /// s is even, and the object tells another beta.
    BetaOff {
        /// Index of the colour.
        colour: usize,
        /// Beta in force.
        beta: f64,
        /// What the object tells.
        object: Estimate,
    },
    /// s is even and smaller than k by more than is allowed, and beta is as the object tells.
    AmountOff {
        /// s over k.
        s_over_k: f64,
    },
    /// Some part of the object has a ratio that no indirect light can make of this beta.
    BeyondBeta {
        /// Index of the colour.
        colour: usize,
        /// Beta in force.
        beta: f64,
        /// The end of the ratio.
        end: f64,
    },
}

impl ClosureFinding {
    /// Whether it puts the result in doubt.
    pub fn is_doubt(&self) -> bool {
        !matches!(self, Self::Closed { .. })
    }

    /// One sentence; `colours` are names, the reference first.
    pub fn words(&self, colours: &[String]) -> String {
        let name = |colour: usize| colours.get(colour).map_or("?", String::as_str);
        match *self {
            Self::Closed { s_over_k } => {
                format!("the amount of indirect light agrees with the paint's albedo: s / k is {s_over_k:.3}")
            }
            Self::OutOfView { unevenness, .. } if unevenness > MAX_UNEVENNESS => format!(
                "part of the cavity is out of view: the amount of indirect light varies by {:.0} % over the object",
                100.0 * unevenness
            ),
            Self::OutOfView { s_over_k: Some(s_over_k), .. } => format!(
                "part of the cavity is out of view, or the grey ball brighter than stated: the amount of indirect light is \
                 {s_over_k:.2} times the paint's albedo"
            ),
            Self::OutOfView { s_over_k: None, .. } => {
                "part of the cavity is out of view: there is more indirect light than any paint would send on".into()
            }
            Self::BetaOff { colour, beta, object: Estimate { value, interval } } => format!(
                "beta of {} is probably too {}: the object itself tells {value:.4} ({:.4} to {:.4}) and not {beta:.4}",
                name(colour),
                if beta > value { "large" } else { "small" },
                interval.low,
                interval.high,
            ),
            Self::AmountOff { s_over_k } => format!(
                "the amount of indirect light is {s_over_k:.2} times the paint's albedo though beta fits the object: the grey ball \
                 may be darker than stated"
            ),
            Self::BeyondBeta { colour, beta, end } => format!(
                "beta of {} is too {}: parts of the object reflect {end:.4} times as much as in the reference colour, and light \
                 between the walls cannot make that of {beta:.4}",
                name(colour),
                if end > beta { "small" } else { "large" },
            ),
        }
    }
}

/// The indirect light as it was found on the grid.
pub(super) struct Found<'a> {
    pub grid: &'a Grid,
    pub indirect: &'a [Indirect],
    /// By light, K N_ref.
    pub arriving: &'a [Plane],
    pub amount: AmountReport,
    pub depth: &'a Plane,
    /// In pixels of the photos.
    pub amount_window_px: f64,
}

/// Compares s and k; `white_light` is that of a white facet, where it is known.
pub(super) fn closure(
    found: &Found,
    lamps: &[Option<(Lamp, f64)>],
    white_light: Option<f64>,
    options: &ClosureOptions,
    normals_options: &NormalsOptions,
    watch: &dyn Watch,
) -> ClosureReport {
    let trial = Trial::new(found, lamps, options, *normals_options, watch);
    let in_force: Vec<f64> = found.grid.lights.first().map_or_else(Vec::new, |light| light.beta.clone());
    let all: Vec<usize> = (0..in_force.len()).collect();
    let first = trial.run(&all, &in_force, normals_options.paint);
    let paint_light = first.as_ref().and_then(|first| first.paint).filter(|paint| paint.one).map(|paint| paint.albedo);
    let albedo = paint_light.zip(white_light).map(|(light, white)| light / white);
    let comparable = first.as_ref().map_or_else(Vec::new, |first| first.tiles.comparable());
    let amount = first.as_ref().and_then(|first| first.tiles.mean_of(&comparable)).map(|(amount, _)| amount);
    let amount = amount.filter(|_| found.amount.is_known());
    let s_over_k = amount.zip(albedo).map(|(amount, albedo)| amount / albedo);
    let unevenness = if found.amount.is_uneven() { found.amount.unevenness } else { 0.0 };
    let white_light = white_light.filter(|_| albedo.is_some() && found.amount.is_known());
    let agreeing = |c: usize| {
        let pair = Pair { trial: &trial, colour: c, tiles: &comparable, white_light: white_light? };
        pair.agreeing(in_force[c], unevenness, options)
    };
    let turn = |c: usize| {
        let mut changed = in_force.clone();
        changed[c] *= 1.0 + PERCENT;
        let changed = trial.run(&all, &changed, normals_options.paint)?;
        mean_angle_deg(&first.as_ref()?.normals, &changed.normals)
    };
    let arriving = Arriving { indirect: found.indirect, light: found.arriving, amount: found.amount.mean };
    let ends = ends_of_ratio(found.grid, Some(arriving));
    let colours = ends.into_iter().zip(1..).map(|(end, c)| ColourClosure {
        beta: in_force[c],
        object: end.map(|end| ObjectBeta::of(end, agreeing(c))),
        turn_deg_per_percent: turn(c),
    });
    let colours: Vec<_> = colours.collect();
    let findings = findings(&colours, &found.amount, s_over_k, options);
    ClosureReport { paint_light, albedo, s_over_k, colours, findings }
}

fn findings(
    colours: &[ColourClosure],
    amount: &AmountReport,
    s_over_k: Option<f64>,
    options: &ClosureOptions,
) -> Vec<ClosureFinding> {
    let mut findings = Vec::new();
    let is_too_much =
        amount.is_known() && (amount.mean > MAX_ALBEDO || s_over_k.is_some_and(|s_over_k| s_over_k > MAX_S_OVER_K));
    for (colour, &ColourClosure { beta, object, .. }) in (1..).zip(colours) {
        let Some(object) = object else { continue };
        let ObjectBeta { estimate, end, .. } = object;
        // An uneven amount tells only that it is uneven; that light is brighter than beta allows counts all the same.
        if !amount.is_uneven() && !is_too_much && object.is_known() && !estimate.interval.contains(beta) {
            findings.push(ClosureFinding::BetaOff { colour, beta, object: estimate });
        } else if object.is_beyond(beta) {
            findings.push(ClosureFinding::BeyondBeta { colour, beta, end: end.value });
        }
    }
    // With beta as the object tells, rendered caps that are all in view come to 1.05.
    let allowed = 2.0 * options.allowed_difference;
    match s_over_k {
        _ if amount.is_uneven() || is_too_much => {
            findings.push(ClosureFinding::OutOfView { unevenness: amount.unevenness, s_over_k });
        }
        Some(ratio) if findings.is_empty() => findings.push(match ratio {
            ratio if ratio > 1.0 + allowed => ClosureFinding::OutOfView { unevenness: amount.unevenness, s_over_k },
            ratio if ratio < 1.0 - allowed => ClosureFinding::AmountOff { s_over_k: ratio },
            ratio => ClosureFinding::Closed { s_over_k: ratio },
        }),
        _ => {}
    }
    findings
}

/// `None` where no cell has both normals.
fn mean_angle_deg(first: &NormalMap, second: &NormalMap) -> Option<f64> {
    let pairs = (0..first.size().0 * first.size().1).filter_map(|cell| first.at_index(cell).zip(second.at_index(cell)));
    // By the chord: the arc cosine of numbers near 1 loses small angles.
    let angles = pairs.map(|(a, b)| 2.0 * (f64::from((a - b).norm()) / 2.0).min(1.0).asin().to_degrees());
    let (sum, count) = angles.fold((0.0, 0usize), |(sum, count), angle| (sum + angle, count + 1));
    (count > 0).then(|| sum / count as f64)
}

/// What is found again for every beta that is tried, on fewer cells.
struct Trial<'a> {
    grid: Grid,
    indirect: Vec<Indirect>,
    arriving: Vec<Plane>,
    depth: Plane,
    lamps: &'a [Option<(Lamp, f64)>],
    amount_window: f64,
    normals: NormalsOptions,
    watch: Portion<'a>,
}

/// What one beta makes of the photos.
struct Outcome {
    tiles: Tiles,
    paint: Option<PaintReport>,
    normals: NormalMap,
}

impl<'a> Trial<'a> {
    fn new(
        found: &Found,
        lamps: &'a [Option<(Lamp, f64)>],
        options: &ClosureOptions,
        normals: NormalsOptions,
        watch: &'a dyn Watch,
    ) -> Self {
        let cells = found.grid.mask.count() as f64;
        let every = ((cells / options.cells as f64).sqrt().ceil() as usize).max(1);
        Self {
            grid: found.grid.thinned(every),
            indirect: found.indirect.iter().map(|indirect| indirect.thinned(every)).collect(),
            arriving: found.arriving.iter().map(|plane| plane.thinned(every)).collect(),
            depth: found.depth.thinned(every),
            lamps,
            amount_window: found.amount_window_px / every as f64,
            normals,
            watch: Portion::still(watch, 1.0),
        }
    }

    /// s over the object, and the paint, by some of the colours; `beta` is by these.
    fn run(&self, colours: &[usize], beta: &[f64], paint: Paint) -> Option<Outcome> {
        let light = |light: &GridLight| GridLight {
            colours: colours.iter().map(|&c| light.colours[c].clone()).collect(),
            beta: beta.to_vec(),
        };
        let lights = self.grid.lights.iter().map(light).collect();
        if self.watch.cancelled() {
            return None;
        }
        let grid = Grid { lights, mask: self.grid.mask.clone(), ..self.grid };
        let of_colours = |indirect: &Indirect| Indirect {
            ratio: colours.iter().map(|&c| indirect.ratio[c].clone()).collect(),
            amount: None,
        };
        let mut indirect: Vec<_> = self.indirect.iter().map(of_colours).collect();
        let fits: Vec<Fit> = (grid.lights.iter().zip(&indirect).zip(&self.arriving))
            .map(|((light, indirect), arriving)| Fit::new(&grid, light, indirect, arriving))
            .collect();
        let tiles = Tiles::of(&grid.mask, &fits)?;
        let share = tiles.report().median.max(0.0);
        let arriving: Vec<&Plane> = self.arriving.iter().collect();
        for (indirect, amount) in indirect.iter_mut().zip(amounts(&fits, &arriving, share, self.amount_window)) {
            indirect.amount = Some(amount);
        }
        let direct = direct_light(&grid, &indirect);
        let surface = Surface { camera: &grid.camera, depth_mm: Some(&self.depth) };
        let options = NormalsOptions { paint, ..self.normals };
        let (found, report) = normals(&placed(&direct, self.lamps), &grid.mask, surface, &options, &self.watch).ok()?;
        Some(Outcome { tiles, paint: report.paint, normals: found.map })
    }
}

/// The reference and one other colour, which alone tell s and k.
struct Pair<'a> {
    trial: &'a Trial<'a>,
    colour: usize,
    /// Where s is compared.
    tiles: &'a [usize],
    white_light: f64,
}

impl Pair<'_> {
    /// The logarithm of s over k, and its noise.
    fn difference(&self, beta: f64) -> Option<(f64, f64)> {
        let Outcome { tiles, paint, .. } = self.trial.run(&[0, self.colour], &[1.0, beta], Paint::One)?;
        let (amount, noise) = tiles.mean_of(self.tiles).filter(|(amount, _)| *amount > 0.0)?;
        let albedo = paint?.albedo / self.white_light;
        (albedo > 0.0).then(|| ((amount / albedo).ln(), noise / amount))
    }

    /// The beta for which s is k, by secants. `unevenness` is how far s may lie above the albedo where it is lowest.
    fn agreeing(&self, beta: f64, unevenness: f64, options: &ClosureOptions) -> Option<Estimate> {
        let allowed = |log: f64| {
            let tried = log.exp();
            if beta < 1.0 { tried.clamp(0.01, 1.0 - MIN_BETA_DISTANCE) } else { tried.max(1.0 + MIN_BETA_DISTANCE) }
                .ln()
        };
        let (mut last, mut at) = (beta.ln(), allowed(beta.ln() - FIRST_STEP));
        let mut last_difference = self.difference(last.exp())?.0;
        let (mut difference, mut noise) = self.difference(at.exp())?;
        let mut slope = (difference - last_difference) / (at - last);
        for _ in 1..TRIALS {
            if slope.abs() < MIN_SLOPE || !slope.is_finite() {
                return None;
            }
            let next = allowed(at - (difference / slope).clamp(-MAX_STEP, MAX_STEP));
            if difference.abs() < SAME || next == at {
                break;
            }
            (last, last_difference, at) = (at, difference, next);
            (difference, noise) = self.difference(at.exp())?;
            slope = (difference - last_difference) / (at - last);
        }
        // The last step of Newton costs no trial.
        let log = allowed(at - (difference / slope).clamp(-MAX_STEP, MAX_STEP));
        let tolerance = options.allowed_difference.hypot(2.0 * noise);
        let ends = [log - tolerance / slope, log + (tolerance + unevenness) / slope].map(f64::exp);
        let interval = Interval { low: ends[0].min(ends[1]), high: ends[0].max(ends[1]) };
        (interval.low.is_finite() && interval.high.is_finite()).then(|| Estimate { value: log.exp(), interval })
    }
}
