//! Whether lamps and photos belong together: the directions as they are given against those that usual mistakes would make
//! of them, each by how well it explains the photos.
//!
//! With three lamps any photos have normals, and only the slope residual says whether these are those of a surface; with more,
//! the photometric residual also says which lamp's light no normal explains. Neither is judged by itself, for shadows, steps and
//! light between walls add to both: another order of the lamps must explain the photos far better.

use nalgebra::Vector3;

use super::SmallPhoto;
use super::photometric::{Sample, median, residual, residual_of_lamps, with_fitted_intensities};
use super::slopes::{Misfit, misfit};
use crate::options::{OptionError, check_range};
use crate::{Mask, Plane, Watch};

/// When lamps and photos count as not belonging together. Right sets of bowls, corners, grooves, trays and statuettes have
/// slopes off by 0.1 to 3.1 degrees; with a wrong order of their lamps 4.2 to 25.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct LampOptions {
    /// Slopes that miss a surface by less say nothing, in degrees.
    pub min_misfit_deg: f64,
    /// Another order must have slopes that are off so many times less.
    pub min_better_slopes: f64,
    /// Slopes off by more in the middle of all pixels are those of no surface, though no other order is better; in degrees.
    pub max_misfit_deg: f64,
    /// Unexplained light below this share of the albedo says nothing.
    pub min_residual: f64,
    /// Above it normals do not explain the photos, though no other order is better. Rings of lamps explain theirs but for 0.0003
    /// to 0.01, in a wrong order but for 0.001 to 0.2.
    pub max_residual: f64,
    /// Another order must leave so many times less light unexplained.
    pub min_better_residual: f64,
    /// Photos of two lamps that differ by less than this share of what others do are of one lamp.
    pub max_equal_share: f64,
}

impl Default for LampOptions {
    fn default() -> Self {
        Self {
            min_misfit_deg: 3.0,
            min_better_slopes: 2.0,
            max_misfit_deg: 8.0,
            min_residual: 0.002,
            max_residual: 0.08,
            min_better_residual: 3.0,
            max_equal_share: 0.08,
        }
    }
}

impl LampOptions {
    /// Whether every option is in its range.
    pub fn check(&self) -> Result<(), OptionError> {
        let positive = [
            ("min_misfit_deg", self.min_misfit_deg),
            ("max_misfit_deg", self.max_misfit_deg),
            ("min_residual", self.min_residual),
            ("max_residual", self.max_residual),
            ("max_equal_share", self.max_equal_share),
        ];
        for (option, value) in positive {
            check_range(option, value, value > 0.0 && value.is_finite(), "a positive number")?;
        }
        for (option, value) in
            [("min_better_slopes", self.min_better_slopes), ("min_better_residual", self.min_better_residual)]
        {
            check_range(option, value, value > 1.0 && value.is_finite(), "above 1")?;
        }
        Ok(())
    }
}

/// A lamp and what it shows.
#[derive(Clone, Copy, Debug)]
pub struct LampPhoto<'a> {
    /// Of the reference colour.
    pub photo: &'a SmallPhoto,
    /// To the lamp, as long as it is strong.
    pub toward: Vector3<f64>,
}

/// A mistake that would explain the photos.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mistake {
    /// y points down, or x to the left: no shading tells which, since a surface turned inside out has the same.
    Flipped,
    /// x and y are swapped.
    Swapped,
    /// x and y are swapped, and one of them is flipped.
    SwappedAndFlipped,
    /// The directions of two lamps are exchanged.
    Exchanged(usize, usize),
    /// Each lamp has the direction of the one after it, or before it.
    Shifted,
    /// One lamp fits none of the others.
    Odd(usize),
}

/// What a fault was measured on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Proof {
    /// Mean angle by which normals miss a surface in degrees, as it is and without the mistake.
    SlopesDeg(f64, f64),
    /// Share of the light that no normal explains, as it is and without the mistake.
    LightShare(f64, f64),
}

/// Lamps and photos that do not belong together.
#[derive(Clone, Debug, PartialEq)]
pub enum LampFault {
    /// A mistake explains the photos far better; all that do so equally well.
    Mistaken {
        /// The likeliest first.
        like: Vec<Mistake>,
        /// The numbers.
        proof: Proof,
    },
    /// Two lamps have one and the same light.
    Doubled {
        /// Which.
        lamps: [usize; 2],
        /// How much their photos differ, as a share of their light.
        difference: f64,
    },
    /// No normals explain the light of all lamps.
    Unexplained {
        /// The share of the light that remains.
        share: f64,
    },
    /// The normals are those of no surface.
    NoSurface {
        /// Mean angle by which they miss one, in degrees.
        misfit_deg: f64,
    },
}

/// Orders that explain the photos as well as the best but for this share are as likely.
const AS_GOOD: f64 = 1.15;
/// And but for this, in degrees: what remains on smooth surfaces is noise.
const AS_GOOD_DEG: f64 = 0.3;
/// Intensities that are fitted to the photos leave so many times more light unexplained.
const FITTED: f64 = 10.0;
/// Pixels on which the photometric residual is looked at.
const MAX_SAMPLES: usize = 1000;
/// Among so many lamps each is exchanged with each; of more, the worst.
const MAX_EXCHANGED: usize = 12;
/// Among so many lamps each is exchanged with each where the slopes judge; evenly placed ones explain their light in either place.
const MAX_EXCHANGED_BY_SLOPES: usize = 4;
/// Lamps closer together than this share the same light, as the length of the difference of their unit vectors.
const MIN_APART: f64 = 0.1;
/// Fewer cells show no surface.
const MIN_CELLS: usize = 50;

/// What is wrong between lamps and photos. `knows_intensities` is false where the lamps' strengths are only assumed equal.
pub fn judge_lamps(
    lamps: &[LampPhoto],
    knows_intensities: bool,
    options: &LampOptions,
    watch: &dyn Watch,
) -> Result<Vec<LampFault>, OptionError> {
    options.check()?;
    let Some(inside) = common(lamps).filter(|_| lamps.len() >= 3) else { return Ok(Vec::new()) };
    if let Some(doubled) = doubled(lamps, &inside, options) {
        return Ok(vec![doubled]);
    }
    let judge = Judge { samples: samples(lamps, &inside), lamps, inside, knows_intensities, options };
    let given: Vec<_> = lamps.iter().map(|lamp| lamp.toward).collect();
    if let Some(fault) = judge.by_light(&given, watch) {
        return Ok(vec![fault]);
    }
    Ok(judge.by_slopes(&given, watch).into_iter().collect())
}

struct Judge<'a> {
    lamps: &'a [LampPhoto<'a>],
    inside: Mask,
    samples: Vec<Sample>,
    knows_intensities: bool,
    options: &'a LampOptions,
}

impl Judge<'_> {
    /// Four lamps or more: light that no normal explains.
    fn by_light(&self, given: &[Vector3<f64>], watch: &dyn Watch) -> Option<LampFault> {
        let count = given.len();
        let residual_of = |toward: &[Vector3<f64>]| {
            if self.knows_intensities {
                residual(&self.samples, toward)
            } else {
                residual(&self.samples, &with_fitted_intensities(&self.samples, toward))
            }
        };
        let min_residual = self.options.min_residual * if self.knows_intensities { 1.0 } else { FITTED };
        let found = residual_of(given).filter(|found| *found >= min_residual)?;
        let worst = self.worst(given);
        let pairs =
            worst.iter().enumerate().flat_map(|(k, a)| worst[..k].iter().map(move |b| Mistake::Exchanged(*b, *a)));
        let orders = [Mistake::Shifted].into_iter().chain(pairs);
        let judged = |mistake: Mistake| {
            let without = undone(given, mistake).into_iter().filter_map(|order| residual_of(&order));
            Some((mistake, if watch.cancelled() { None } else { without.min_by(f64::total_cmp) }?))
        };
        let limit = found / self.options.min_better_residual;
        let better: Vec<_> = orders.filter_map(judged).filter(|(_, residual)| *residual <= limit).collect();
        if let Some(fault) = fault(better, |best| best * AS_GOOD, |best| Proof::LightShare(found, best)) {
            return Some(fault);
        }
        // Of five lamps the other four still say whether they fit together.
        let odd = |l: usize| {
            let toward: Vec<_> = given.iter().enumerate().filter(|(k, _)| *k != l).map(|(_, toward)| *toward).collect();
            let without =
                |sample: &Sample| sample.iter().enumerate().filter(|(k, _)| *k != l).map(|(_, x)| *x).collect();
            let samples: Vec<Sample> = self.samples.iter().map(without).collect();
            let toward = if self.knows_intensities { toward } else { with_fitted_intensities(&samples, &toward) };
            Some((Mistake::Odd(l), residual(&samples, &toward)?))
        };
        let all =
            worst.iter().filter(|_| count >= 5).filter_map(|l| odd(*l)).filter(|(_, residual)| *residual <= limit);
        let unexplained = || (found > self.options.max_residual).then_some(LampFault::Unexplained { share: found });
        fault(all.collect(), |best| best * AS_GOOD, |best| Proof::LightShare(found, best)).or_else(unexplained)
    }

    /// The lamps that explain their light worst, in the order of the set.
    fn worst(&self, given: &[Vector3<f64>]) -> Vec<usize> {
        let of_lamps = residual_of_lamps(&self.samples, given);
        let mut lamps: Vec<usize> = (0..given.len()).collect();
        lamps.sort_by(|a, b| of_lamps[*b].total_cmp(&of_lamps[*a]));
        lamps.truncate(MAX_EXCHANGED);
        lamps.sort_unstable();
        lamps
    }

    /// Any number of lamps: normals that are those of no surface.
    fn by_slopes(&self, given: &[Vector3<f64>], watch: &dyn Watch) -> Option<LampFault> {
        let photos: Vec<&Plane> = self.lamps.iter().map(|lamp| &lamp.photo.light).collect();
        let misfit_of = |toward: &[Vector3<f64>]| {
            let fitted =
                (!self.knows_intensities && toward.len() > 3).then(|| with_fitted_intensities(&self.samples, toward));
            misfit(&photos, fitted.as_deref().unwrap_or(toward), &self.inside)
        };
        let Misfit { mean_deg, median_deg } = misfit_of(given)?;
        if mean_deg < self.options.min_misfit_deg {
            return None;
        }
        let turns = [Mistake::Flipped, Mistake::Swapped, Mistake::SwappedAndFlipped];
        // Of more lamps their light says which are exchanged.
        let exchanged = if given.len() <= MAX_EXCHANGED_BY_SLOPES { given.len() } else { 0 };
        let pairs = (0..exchanged).flat_map(|b| (0..b).map(move |a| Mistake::Exchanged(a, b)));
        let mistakes = turns.into_iter().chain([Mistake::Shifted]).chain(pairs);
        let judged = |mistake: Mistake| {
            let without = undone(given, mistake).into_iter().filter_map(|order| Some(misfit_of(&order)?.mean_deg));
            Some((mistake, if watch.cancelled() { None } else { without.min_by(f64::total_cmp) }?))
        };
        let limit = mean_deg / self.options.min_better_slopes;
        let better: Vec<_> = mistakes.filter_map(judged).filter(|(_, misfit)| *misfit <= limit).collect();
        let as_good = |best: f64| (best * AS_GOOD).max(best + AS_GOOD_DEG);
        let no_surface =
            || (median_deg > self.options.max_misfit_deg).then_some(LampFault::NoSurface { misfit_deg: mean_deg });
        fault(better, as_good, |best| Proof::SlopesDeg(mean_deg, best)).or_else(no_surface)
    }
}

/// The best of some mistakes with those that are as good, in the order in which they were tried.
fn fault(better: Vec<(Mistake, f64)>, as_good: impl Fn(f64) -> f64, proof: impl Fn(f64) -> Proof) -> Option<LampFault> {
    let best = better.iter().map(|(_, value)| *value).min_by(f64::total_cmp)?;
    let like = better.iter().filter(|(_, value)| *value <= as_good(best)).map(|(mistake, _)| *mistake);
    Some(LampFault::Mistaken { like: like.collect(), proof: proof(best) })
}

/// The lamps as they would be without a mistake, in each way in which it can have been made.
fn undone(given: &[Vector3<f64>], mistake: Mistake) -> Vec<Vec<Vector3<f64>>> {
    let turned = |turn: fn(&Vector3<f64>) -> Vector3<f64>| vec![given.iter().map(turn).collect()];
    match mistake {
        Mistake::Flipped => turned(|v| Vector3::new(v.x, -v.y, v.z)),
        Mistake::Swapped => turned(|v| Vector3::new(v.y, v.x, v.z)),
        Mistake::SwappedAndFlipped => turned(|v| Vector3::new(-v.y, v.x, v.z)),
        Mistake::Exchanged(a, b) => {
            let mut order = given.to_vec();
            order.swap(a, b);
            vec![order]
        }
        Mistake::Shifted => {
            let (mut forward, mut back) = (given.to_vec(), given.to_vec());
            forward.rotate_left(1);
            back.rotate_right(1);
            vec![forward, back]
        }
        Mistake::Odd(_) => Vec::new(),
    }
}

/// The cells that every photo shows whole; without a mask, the brighter part of them.
fn common(lamps: &[LampPhoto]) -> Option<Mask> {
    let first = lamps.first()?;
    let size = first.photo.light.size();
    if lamps.iter().any(|lamp| lamp.photo.light.size() != size || lamp.toward.norm() <= 0.0) {
        return None;
    }
    let all = Mask::from_fn(size.0, size.1, |x, y| lamps.iter().all(|lamp| lamp.photo.whole.at(x, y)));
    let brightest = |x, y| lamps.iter().map(|lamp| lamp.photo.light.at(x, y)).fold(0.0, f32::max);
    let object = (!first.photo.is_masked).then(|| Mask::brighter_part(&Plane::from_fn(size.0, size.1, brightest)));
    let inside =
        Mask::from_fn(size.0, size.1, |x, y| all.at(x, y) && object.as_ref().is_none_or(|object| object.at(x, y)));
    (inside.count() >= MIN_CELLS).then_some(inside)
}

/// By pixel, the light of every lamp.
fn samples(lamps: &[LampPhoto], inside: &Mask) -> Vec<Sample> {
    let cells: Vec<usize> = (0..inside.data().len()).filter(|cell| inside.data()[*cell]).collect();
    let every = cells.len().div_ceil(MAX_SAMPLES).max(1);
    let light = |cell: &usize| lamps.iter().map(|lamp| f64::from(lamp.photo.light.data()[*cell])).collect();
    cells.iter().step_by(every).map(light).collect()
}

/// Two lamps whose photos differ by far less than lamps so far apart do.
fn doubled(lamps: &[LampPhoto], inside: &Mask, options: &LampOptions) -> Option<LampFault> {
    let samples = samples(lamps, inside);
    let unit = |l: usize| lamps[l].toward.normalize();
    let pairs = (0..lamps.len()).flat_map(|a| (a + 1..lamps.len()).map(move |b| [a, b]));
    let differences: Vec<_> = pairs
        .filter_map(|[a, b]| {
            let apart = (unit(a) - unit(b)).norm();
            let difference = samples.iter().map(|sample| (sample[a] - sample[b]).powi(2)).sum::<f64>();
            let light = samples.iter().map(|sample| sample[a].powi(2) + sample[b].powi(2)).sum::<f64>() / 2.0;
            (apart >= MIN_APART && light > 0.0).then(|| ([a, b], (difference / light).sqrt(), apart))
        })
        .collect();
    let usual = median(differences.iter().map(|(_, difference, apart)| difference / apart).collect())?;
    let (lamps, difference, apart) = differences.into_iter().min_by(|a, b| (a.1 / a.2).total_cmp(&(b.1 / b.2)))?;
    (difference / apart <= options.max_equal_share * usual).then_some(LampFault::Doubled { lamps, difference })
}
