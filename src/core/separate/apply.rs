//! One pass over the photos of a light: the operator on blocks that are good throughout, pixel by pixel elsewhere.

use std::collections::HashMap;

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::{BounceSystem, LightPhotos, OUTSIDE, Separation, UNSOLVED};
use crate::Watch;
use crate::block::{BLOCK, JOB, all_true, all_zero, combine, sum_of};
use crate::image::photo::CLIPPED;

/// Sums over the pixels of a light.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    pub sums: Vec<f64>,
    pub residual_squares: f64,
    pub solved: usize,
    pub reduced: usize,
    pub unsolved_clipped: usize,
    pub unsolved_dark: usize,
}

impl Tally {
    fn of(bounces: usize) -> Self {
        Self { sums: vec![0.0; bounces], ..Self::default() }
    }

    fn join(mut self, other: Self) -> Self {
        self.sums.iter_mut().zip(other.sums).for_each(|(sum, more)| *sum += more);
        self.residual_squares += other.residual_squares;
        self.solved += other.solved;
        self.reduced += other.reduced;
        self.unsolved_clipped += other.unsolved_clipped;
        self.unsolved_dark += other.unsolved_dark;
        self
    }
}

/// The part of a separation that one job writes.
struct Target<'a> {
    first_pixel: usize,
    bounces: Vec<&'a mut [f32]>,
    noise: &'a mut [f32],
    residual: Option<&'a mut [f32]>,
    marks: &'a mut [u8],
}

/// A bounce system in single precision, over some of the colours (zero for the others).
struct Kernel {
    /// m rows of n: L_k from N_c.
    rows: Vec<Vec<f32>>,
    /// n rows of n: what is left of N_c / alpha_c.
    left: Vec<Vec<f32>>,
    /// Variance of L_1: a constant, and a factor on each N_c.
    variance: (f32, Vec<f32>),
}

/// n x n: N_c / alpha_c minus what the bounces explain of it, from the photos' own linear light.
pub(super) fn residual_operator(system: &BounceSystem, alpha: &[f64]) -> DMatrix<f64> {
    let inverse_alpha =
        DMatrix::from_fn(alpha.len(), alpha.len(), |c, from| if c == from { 1.0 / alpha[c] } else { 0.0 });
    inverse_alpha - &system.mixing * &system.operator
}

impl Kernel {
    fn new(system: &BounceSystem, light: &LightPhotos, colours: &[usize]) -> Self {
        let count = light.beta.len();
        let spread = |matrix: &DMatrix<f64>, row: usize| {
            let mut full = vec![0.0; count];
            colours.iter().enumerate().for_each(|(c, &colour)| full[colour] = matrix[(row, c)] as f32);
            full
        };
        let alpha: Vec<_> = colours.iter().map(|&colour| light.alpha[colour]).collect();
        let left = residual_operator(system, &alpha);
        let direct = spread(&system.operator, 0);
        let constant = direct.iter().zip(light.noise).map(|(w, noise)| w * w * noise.floor as f32).sum();
        let per_signal = direct.iter().zip(light.noise).map(|(w, noise)| w * w * noise.per_signal as f32).collect();
        Self {
            rows: (0..system.operator.nrows()).map(|k| spread(&system.operator, k)).collect(),
            left: (0..colours.len()).map(|c| spread(&left, c)).collect(),
            variance: (constant, per_signal),
        }
    }
}

/// Fills `separation`, which has the right shape, and returns the sums; `None` when cancelled.
pub(super) fn apply(
    separation: &mut Separation,
    light: &LightPhotos,
    system: &BounceSystem,
    sigma: &[f64],
    watch: &dyn Watch,
) -> Option<Tally> {
    let all: Vec<_> = (0..light.beta.len()).collect();
    let kernel = Kernel::new(system, light, &all);
    let jobs = jobs_of(separation);
    let total = jobs.len().max(1);
    let done = std::sync::atomic::AtomicUsize::new(0);
    let bounces = kernel.rows.len();
    let tally = jobs
        .into_par_iter()
        .map(|target| {
            if watch.cancelled() {
                return None;
            }
            let tally = run_job(target, light, &kernel, sigma);
            let finished = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
            watch.progress(finished as f32 / total as f32);
            Some(tally)
        })
        .try_reduce(|| Tally::of(bounces), |a, b| Some(a.join(b)));
    tally.filter(|_| !watch.cancelled())
}

fn jobs_of(separation: &mut Separation) -> Vec<Target<'_>> {
    let mut bounces: Vec<_> = separation.bounces.iter_mut().map(|plane| plane.data_mut().chunks_mut(JOB)).collect();
    let mut noise = separation.direct_noise.iter_mut().flat_map(|plane| plane.data_mut().chunks_mut(JOB));
    let mut residual = separation.residual.as_mut().map(|plane| plane.data_mut().chunks_mut(JOB));
    let marks = separation.marks.data_mut().chunks_mut(JOB).enumerate();
    marks
        .map(|(job, marks)| Target {
            first_pixel: job * JOB,
            bounces: bounces.iter_mut().filter_map(Iterator::next).collect(),
            noise: noise.next().unwrap_or_default(),
            residual: residual.as_mut().and_then(Iterator::next),
            marks,
        })
        .collect()
}

fn run_job(mut target: Target, light: &LightPhotos, kernel: &Kernel, sigma: &[f64]) -> Tally {
    let mut tally = Tally::of(kernel.rows.len());
    let mut subsets = HashMap::new();
    let end = target.marks.len();
    for start in (0..end).step_by(BLOCK) {
        let block = start..(start + BLOCK).min(end);
        let pixels = target.first_pixel + block.start..target.first_pixel + block.end;
        let good = all_true(&light.mask.data()[pixels.clone()])
            && light.photos.iter().all(|photo| all_zero(&photo.marks.data()[pixels.clone()]));
        if good {
            good_block(&mut target, light, kernel, block, &mut tally);
        } else {
            block.for_each(|at| mixed_pixel(&mut target, light, kernel, sigma, at, &mut subsets, &mut tally));
        }
    }
    tally
}

/// Every pixel of the block is inside the mask and good in every colour: plain sums of scaled slices.
fn good_block(
    target: &mut Target,
    light: &LightPhotos,
    kernel: &Kernel,
    block: std::ops::Range<usize>,
    tally: &mut Tally,
) {
    let first = target.first_pixel;
    let photos: Vec<&[f32]> =
        light.photos.iter().map(|photo| &photo.linear.data()[first + block.start..first + block.end]).collect();
    for ((bounce, row), sum) in target.bounces.iter_mut().zip(&kernel.rows).zip(&mut tally.sums) {
        let bounce = &mut bounce[block.clone()];
        combine(bounce, 0.0, row, &photos);
        *sum += f64::from(sum_of(bounce));
    }
    let noise = &mut target.noise[block.clone()];
    combine(noise, kernel.variance.0, &kernel.variance.1, &photos);
    noise.iter_mut().for_each(|variance| *variance = variance.max(0.0).sqrt());

    if let Some(residual) = &mut target.residual {
        let residual = &mut residual[block.clone()];
        residual.fill(0.0);
        let mut left = [0.0; BLOCK];
        let left = &mut left[..block.len()];
        for row in &kernel.left {
            combine(left, 0.0, row, &photos);
            residual.iter_mut().zip(&*left).for_each(|(square, left)| *square += left * left);
        }
        let share = 1.0 / kernel.left.len() as f32;
        residual.iter_mut().for_each(|square| *square *= share);
        tally.residual_squares += f64::from(sum_of(residual));
        residual.iter_mut().for_each(|square| *square = square.sqrt());
    }
    target.marks[block.clone()].fill(0);
    tally.solved += block.len();
}

/// A pixel that may be outside the mask or have bad colours: it is fitted from its good colours if they are enough.
fn mixed_pixel(
    target: &mut Target,
    light: &LightPhotos,
    kernel: &Kernel,
    sigma: &[f64],
    at: usize,
    subsets: &mut HashMap<u32, Option<Kernel>>,
    tally: &mut Tally,
) {
    let pixel = target.first_pixel + at;
    let marks = light.photos.iter().fold(0, |all, photo| all | photo.marks.data()[pixel]);
    let good = light.photos.iter().enumerate().filter(|(_, photo)| photo.marks.data()[pixel] == 0);
    let key = good.fold(0u32, |key, (colour, _)| key | 1 << colour);
    let inside = light.mask.data()[pixel];
    let kernel = match (inside, marks) {
        (false, _) => None,
        (true, 0) => Some(kernel),
        (true, _) => subsets.entry(key).or_insert_with(|| subset(key, light, kernel.rows.len(), sigma)).as_ref(),
    };
    let Some(kernel) = kernel else {
        target.bounces.iter_mut().for_each(|bounce| bounce[at] = 0.0);
        target.noise[at] = 0.0;
        target.residual.iter_mut().for_each(|residual| residual[at] = 0.0);
        target.marks[at] = if inside { marks | UNSOLVED } else { OUTSIDE };
        if inside && marks & CLIPPED != 0 {
            tally.unsolved_clipped += 1;
        } else if inside {
            tally.unsolved_dark += 1;
        }
        return;
    };

    // A bad colour has zero weight, whatever its value.
    let dot = |weights: &[f32]| {
        weights.iter().zip(light.photos).map(|(weight, photo)| weight * photo.linear.data()[pixel]).sum::<f32>()
    };
    for ((bounce, row), sum) in target.bounces.iter_mut().zip(&kernel.rows).zip(&mut tally.sums) {
        bounce[at] = dot(row);
        *sum += f64::from(bounce[at]);
    }
    target.noise[at] = (kernel.variance.0 + dot(&kernel.variance.1)).max(0.0).sqrt();
    if let Some(residual) = &mut target.residual {
        let square = kernel.left.iter().map(|row| dot(row).powi(2)).sum::<f32>() / kernel.left.len() as f32;
        tally.residual_squares += f64::from(square);
        residual[at] = square.sqrt();
    }
    target.marks[at] = marks;
    tally.solved += 1;
    tally.reduced += usize::from(marks != 0);
}

/// The kernel of the colours in `key`; `None` where they are too few or too alike.
fn subset(key: u32, light: &LightPhotos, bounces: usize, sigma: &[f64]) -> Option<Kernel> {
    let colours: Vec<_> = (0..light.beta.len()).filter(|colour| key >> colour & 1 == 1).collect();
    let pick = |values: &[f64]| colours.iter().map(|&colour| values[colour]).collect::<Vec<_>>();
    let system = BounceSystem::new(&pick(light.alpha), &pick(light.beta), &pick(sigma), bounces).ok()?;
    Some(Kernel::new(&system, light, &colours))
}
