//! A bracket: several exposures of one photo, combined into one by noise weight, with clipped ones left out.
//!
//! P. Debevec and J. Malik, "Recovering high dynamic range radiance maps from photographs", SIGGRAPH 1997, for values that are
//! linear; weights as in M. Granados, B. Ajdin, M. Wand, C. Theobalt, H.-P. Seidel and H. Lensch, "Optimal HDR reconstruction with
//! linear digital cameras", CVPR 2010.

use rayon::prelude::*;
use thiserror::Error;

use super::noise::NoiseModel;
use super::photo::{CLIPPED, DARK};
use crate::options::{OptionError, check_range};
use crate::{Marks, Photo, Plane};

/// One exposure of a bracket.
#[derive(Clone, Copy, Debug)]
pub struct BracketPart<'a> {
    /// Linear light, divided by the exposure.
    pub photo: &'a Photo,
    /// Relative exposure: values clip at one over it.
    pub exposure: f64,
    /// Its noise after that division.
    pub noise: NoiseModel,
}

/// How exposures are combined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BracketOptions {
    /// A pixel of one exposure is left out where the shorter ones around it expect it nearer to white than this many standard
    /// deviations: left out by its own value, only those that noise made darker would remain.
    pub clip_sigmas: f64,
    /// Exposures whose values differ by more than this share from what they state contradict them.
    pub max_contradiction: f64,
}

impl Default for BracketOptions {
    fn default() -> Self {
        // Cameras write 1/15 s for 1/16 s: 7 %.
        Self { clip_sigmas: 3.0, max_contradiction: 0.08 }
    }
}

impl BracketOptions {
    /// Whether every option is in its range.
    pub fn check(&self) -> Result<(), OptionError> {
        let range = 0.0..=10.0;
        check_range("clip_sigmas", self.clip_sigmas, range.contains(&self.clip_sigmas), "from 0 to 10")?;
        let range = 0.0..=1.0;
        check_range("max_contradiction", self.max_contradiction, range.contains(&self.max_contradiction), "from 0 to 1")
    }
}

/// Why exposures could not be combined.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BracketError {
    /// There is none.
    #[error("a bracket needs at least one exposure")]
    Empty,
    /// Photos of different sizes.
    #[error("exposure {} is {found:?} pixels, the first {expected:?}: all must have one size", part + 1)]
    Size {
        /// Which exposure, from 0.
        part: usize,
        /// Width and height.
        found: (usize, usize),
        /// Those of the first.
        expected: (usize, usize),
    },
    /// An exposure that is no positive number.
    #[error("exposure {} is {exposure}: it must be a number above 0", part + 1)]
    Exposure {
        /// Which, from 0.
        part: usize,
        /// Its value.
        exposure: f64,
    },
    /// An option out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
}

/// The combination.
#[derive(Clone, Debug, PartialEq)]
pub struct Bracket {
    /// Linear light. Clipped only where every exposure is, dark only where the longest one that counts is.
    pub photo: Photo,
    /// Its noise, fitted to that of the pixels: it steps where an exposure clips.
    pub noise: NoiseModel,
    /// How it went.
    pub report: BracketReport,
}

/// How the exposures went together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BracketReport {
    /// By exposure, the share of pixels in which it counts.
    pub used_share: Vec<f64>,
    /// Exposures that contradict their values.
    pub contradictions: Vec<Contradiction>,
}

/// Two exposures whose values say another ratio than they state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contradiction {
    /// Index of the longer exposure.
    pub part: usize,
    /// Its exposure over that of the next shorter one, as stated.
    pub stated: f64,
    /// The same by their values.
    pub measured: f64,
}

/// Fewer common pixels say nothing of a ratio.
const MIN_COMMON_PIXELS: usize = 100;
/// Values between these shares of white tell a ratio of exposures.
const TELLING: std::ops::Range<f64> = 0.05..0.8;
/// Whether an exposure clips is judged by so many pixels on each side.
const AROUND_PX: usize = 8;
/// Pixels whose noise the model is fitted to, about.
const SAMPLED_PIXELS: usize = 4096;

/// Combines exposures of one photo.
///
/// # Errors
/// `BracketError`: none, different sizes, an exposure or option out of its range.
pub fn combine_bracket(parts: &[BracketPart], options: &BracketOptions) -> Result<Bracket, BracketError> {
    options.check()?;
    check(parts)?;
    let mut order: Vec<usize> = (0..parts.len()).collect();
    order.sort_by(|a, b| parts[*a].exposure.total_cmp(&parts[*b].exposure));
    let sorted: Vec<BracketPart> = order.iter().map(|index| parts[*index]).collect();
    let (width, height) = sorted[0].photo.linear.size();
    let mut linear = Plane::filled(width, height, 0.0);
    let mut marks = Marks::filled(width, height, 0);
    let every = (width * height / SAMPLED_PIXELS).max(1);
    let rows = linear.data_mut().par_chunks_mut(width.max(1)).zip(marks.data_mut().par_chunks_mut(width.max(1)));
    let (used, samples) = rows
        .enumerate()
        .map(|(y, (light, marks))| {
            let (mut used, mut samples) = (vec![0usize; sorted.len()], Vec::new());
            let counts = Counts::of_row(&sorted, y, options);
            for (x, (light, mark)) in light.iter_mut().zip(marks).enumerate() {
                let pixel = y * width + x;
                let found = combine_pixel(&sorted, pixel, counts.at(x), &mut used);
                (*light, *mark) = (found.light as f32, found.mark);
                if pixel % every == 0 && found.mark & CLIPPED == 0 {
                    samples.push((found.light, found.variance));
                }
            }
            (used, samples)
        })
        .reduce(
            || (vec![0; sorted.len()], Vec::new()),
            |(used, mut samples), (other, more)| {
                samples.extend(more);
                (used.into_iter().zip(other).map(|(a, b)| a + b).collect(), samples)
            },
        );
    let source = sorted[0].noise.source;
    let noise = NoiseModel::fit(&samples, source).unwrap_or(sorted[0].noise);
    let mut used_share = vec![0.0; parts.len()];
    for (index, count) in order.iter().zip(used) {
        used_share[*index] = count as f64 / (width * height).max(1) as f64;
    }
    let pairs = order.windows(2).zip(sorted.windows(2));
    let contradictions = pairs.filter_map(|(indices, pair)| contradiction(indices[1], &pair[0], &pair[1], options));
    let report = BracketReport { used_share, contradictions: contradictions.collect() };
    Ok(Bracket { photo: Photo { linear, marks }, noise, report })
}

fn check(parts: &[BracketPart]) -> Result<(), BracketError> {
    let expected = parts.first().ok_or(BracketError::Empty)?.photo.linear.size();
    for (part, BracketPart { photo, exposure, .. }) in parts.iter().enumerate() {
        if photo.linear.size() != expected {
            return Err(BracketError::Size { part, found: photo.linear.size(), expected });
        }
        if !(exposure.is_finite() && *exposure > 0.0) {
            return Err(BracketError::Exposure { part, exposure: *exposure });
        }
    }
    Ok(())
}

/// How many exposures count in each pixel of a row: from the shortest on, as long as they do not clip.
struct Counts {
    /// By pixel: the count, the sum of exposures, and that of stored light (light times exposure).
    pixels: Vec<(usize, f64, f64)>,
}

impl Counts {
    fn of_row(parts: &[BracketPart], y: usize, options: &BracketOptions) -> Self {
        let mut counts = Self { pixels: vec![(0, 0.0, 0.0); parts[0].photo.linear.width()] };
        for (index, part) in parts.iter().enumerate() {
            let white = 1.0 / part.exposure;
            let expected: Vec<Option<f64>> = (0..counts.pixels.len()).map(|x| counts.expected_around(x)).collect();
            let (light, marks) = (part.photo.linear.row(y), part.photo.marks.row(y));
            for (x, pixel) in counts.pixels.iter_mut().enumerate() {
                let clips = expected[x]
                    .is_some_and(|expected| expected + options.clip_sigmas * part.noise.variance(white).sqrt() > white);
                if pixel.0 == index && marks[x] & !DARK == 0 && !clips {
                    *pixel = (pixel.0 + 1, pixel.1 + part.exposure, pixel.2 + part.exposure * f64::from(light[x]));
                }
            }
        }
        counts
    }

    fn at(&self, x: usize) -> (usize, f64) {
        let (count, exposure, sum) = self.pixels[x];
        (count, sum / exposure)
    }

    /// The light by the exposures so far, over the pixels around: by its own noise alone a pixel would choose its exposures, and with
    /// them a bias.
    fn expected_around(&self, x: usize) -> Option<f64> {
        let around = x.saturating_sub(AROUND_PX)..(x + AROUND_PX + 1).min(self.pixels.len());
        let known = self.pixels[around].iter().filter(|(count, ..)| *count > 0);
        let (sum, count) =
            known.fold((0.0, 0), |(sum, count), (_, exposure, light)| (sum + light / exposure, count + 1));
        (count > 0).then(|| sum / f64::from(count))
    }
}

struct Combined {
    light: f64,
    variance: f64,
    mark: u8,
}

/// One pixel; `parts` from the shortest to the longest exposure, whose uses are counted. So many of them count, which expect this
/// light by exposure alone: their weights do not know the noise of this pixel and leave no bias.
fn combine_pixel(parts: &[BracketPart], pixel: usize, (count, expected): (usize, f64), used: &mut [usize]) -> Combined {
    let light = |part: &BracketPart| f64::from(part.photo.linear.data()[pixel]);
    if count == 0 {
        // The shortest exposure is clipped: longer ones are too.
        let first = &parts[0];
        let light = light(first);
        return Combined { light, variance: first.noise.variance(light), mark: first.photo.marks.data()[pixel] };
    }
    let (mut precision, mut weighted) = (0.0, 0.0);
    for (part, used) in parts[..count].iter().zip(used) {
        let weight = part.noise.variance(expected).max(f64::MIN_POSITIVE).recip();
        precision += weight;
        weighted += weight * light(part);
        *used += 1;
    }
    let mark = parts[count - 1].photo.marks.data()[pixel];
    Combined { light: weighted / precision, variance: precision.recip(), mark }
}

/// Whether the values of two exposures say another ratio than the exposures themselves.
fn contradiction(
    index: usize,
    shorter: &BracketPart,
    longer: &BracketPart,
    options: &BracketOptions,
) -> Option<Contradiction> {
    let pixels = (shorter.photo.linear.data().par_iter(), shorter.photo.marks.data());
    let longer_pixels = longer.photo.linear.data().par_iter().zip(longer.photo.marks.data());
    let both = pixels.into_par_iter().zip(longer_pixels);
    let telling = both.filter(|((_, a), (light, b))| {
        **a == 0 && **b == 0 && TELLING.contains(&(f64::from(**light) * longer.exposure))
    });
    let sums = telling.map(|((short, _), (long, _))| (f64::from(*short), f64::from(*long), 1usize));
    let (short, long, count) = sums.reduce(|| (0.0, 0.0, 0), |a, b| (a.0 + b.0, a.1 + b.1, a.2 + b.2));
    let stated = longer.exposure / shorter.exposure;
    let measured = stated * long / short;
    let differs = (measured / stated - 1.0).abs() > options.max_contradiction;
    (count >= MIN_COMMON_PIXELS && short > 0.0 && differs).then_some(Contradiction { part: index, stated, measured })
}

#[cfg(test)]
mod tests {
    use rand::rngs::StdRng;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    use super::*;

    const FULL_WELL: f64 = 20_000.0;
    const READ_NOISE: f64 = 12.0;
    const EXPOSURES: [f64; 3] = [16.0, 1.0, 4.0];

    fn noise(exposure: f64) -> NoiseModel {
        NoiseModel::of_camera(FULL_WELL, READ_NOISE, 1, exposure)
    }

    /// A ramp as a camera takes it: noisy, and clipped at white.
    fn taken(exposure: f64, seed: u64) -> Photo {
        let mut random = StdRng::seed_from_u64(seed);
        let mut photo = Photo::unmarked(ramp().map(|light| light));
        let Photo { linear, marks } = &mut photo;
        for (light, mark) in linear.data_mut().iter_mut().zip(marks.data_mut()) {
            let sigma = noise(exposure).sigma(f64::from(*light));
            let stored = (f64::from(*light) + sigma * random.sample::<f64, _>(StandardNormal)) * exposure;
            *mark = if stored >= 1.0 { CLIPPED } else { 0 };
            *light = (stored.min(1.0) / exposure) as f32;
        }
        photo
    }

    /// Each row has one light, from 0.0005 to 0.9.
    fn ramp() -> Plane {
        Plane::from_fn(400, 120, |_, y| (0.0005 * 1800_f64.powf(y as f64 / 119.0)) as f32)
    }

    fn combined(exposures: &[f64], stated: &[f64]) -> Bracket {
        let photos: Vec<Photo> = exposures.iter().zip(1..).map(|(exposure, seed)| taken(*exposure, seed)).collect();
        let rescaled: Vec<Photo> = (photos.into_iter().zip(exposures).zip(stated))
            .map(|((photo, taken), stated)| {
                let scale = (taken / stated) as f32;
                Photo { linear: photo.linear.map(|light| light * scale), ..photo }
            })
            .collect();
        let parts: Vec<_> = (rescaled.iter().zip(stated))
            .map(|(photo, exposure)| BracketPart { photo, exposure: *exposure, noise: noise(*exposure) })
            .collect();
        combine_bracket(&parts, &BracketOptions::default()).unwrap()
    }

    /// The noise of the best weights, with every exposure that does not clip.
    fn ideal_sigma(light: f64) -> f64 {
        let unclipped = EXPOSURES.iter().filter(|exposure| *exposure * light < 1.0);
        unclipped.map(|exposure| noise(*exposure).variance(light).recip()).sum::<f64>().recip().sqrt()
    }

    #[test]
    fn the_noise_is_that_of_the_ideal_combination_and_no_seam_is_biased() {
        let found = combined(&EXPOSURES, &EXPOSURES);
        for y in 0..120 {
            let truth = f64::from(ramp().at(0, y));
            let errors: Vec<f64> = found.photo.linear.row(y).iter().map(|light| f64::from(*light) - truth).collect();
            let mean = errors.iter().sum::<f64>() / errors.len() as f64;
            let sigma = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
            let ideal = ideal_sigma(truth);
            // Of 400 pixels: four standard errors of the mean.
            assert!(mean.abs() < 4.0 * sigma / 20.0 + 2e-4 * truth, "{truth}: {mean} beside {sigma}");
            // Next to white an exposure is left out although a part of its pixels is not clipped.
            let near_white = EXPOSURES.iter().any(|exposure| (0.9..1.0).contains(&(exposure * truth)));
            assert!(near_white || sigma < 1.17 * ideal, "{truth}: {sigma}, ideal {ideal}");
        }
        let sum = |of: &dyn Fn(usize) -> f64| (0..120).map(of).sum::<f64>() / 120.0;
        let ratio = |y: usize| {
            let truth = f64::from(ramp().at(0, y));
            let errors = found.photo.linear.row(y).iter().map(|light| (f64::from(*light) - truth).powi(2));
            (errors.sum::<f64>() / 400.0).sqrt() / ideal_sigma(truth)
        };
        assert!(sum(&ratio) < 1.1, "{}", sum(&ratio));
    }

    #[test]
    fn exposures_that_contradict_their_values_are_named_with_the_measured_ratio() {
        let found = combined(&EXPOSURES, &[16.0, 1.0, 5.0]);
        let [third, first] = found.report.contradictions[..] else { panic!("{:?}", found.report) };
        assert_eq!((third.part, third.stated), (2, 5.0));
        assert!((third.measured / 4.0 - 1.0).abs() < 0.01, "{third:?}");
        assert_eq!(first.part, 0);
        assert!(combined(&EXPOSURES, &EXPOSURES).report.contradictions.is_empty());
    }

    #[test]
    fn a_pixel_is_clipped_only_where_every_exposure_is() {
        let white = Photo { linear: Plane::filled(4, 4, 1.0), marks: Marks::filled(4, 4, CLIPPED) };
        let grey = Photo::unmarked(Plane::filled(4, 4, 0.5));
        let part = |photo, exposure| BracketPart { photo, exposure, noise: noise(exposure) };
        let options = BracketOptions::default();
        let found = combine_bracket(&[part(&white, 4.0), part(&grey, 1.0)], &options).unwrap();
        assert_eq!((found.photo.marks.at(0, 0), found.photo.linear.at(0, 0)), (0, 0.5));
        assert_eq!(found.report.used_share, [0.0, 1.0]);
        let found = combine_bracket(&[part(&white, 4.0), part(&white, 1.0)], &options).unwrap();
        assert_eq!(found.photo.marks.at(0, 0), CLIPPED);
        assert_eq!(combine_bracket(&[], &options), Err(BracketError::Empty));
        let refused = combine_bracket(&[part(&grey, 0.0)], &options);
        assert_eq!(refused, Err(BracketError::Exposure { part: 0, exposure: 0.0 }));
    }
}
