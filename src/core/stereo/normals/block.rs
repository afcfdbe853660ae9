//! Runs of pixels that are good in every light of distant lamps, one matrix for all; the rest goes pixel by pixel.

use std::ops::Range;

use nalgebra::{DMatrix, Vector3};

use super::pixel::{PixelNormal, Stage};
use super::{OUTSIDE, SHADOW_USED, SHADOWED, Tally, UNSOLVED};
use crate::block::{BLOCK, all_false, all_true, all_zero, combine, sum_of};
use crate::linear_algebra;

/// The part of the normals that one job writes.
pub(super) struct Target<'a> {
    pub first_pixel: usize,
    pub x: &'a mut [f32],
    pub y: &'a mut [f32],
    pub z: &'a mut [f32],
    pub albedo: &'a mut [f32],
    pub noise_deg: &'a mut [f32],
    pub marks: &'a mut [u8],
}

/// The pseudo-inverse of the lamps' matrix, in single precision.
pub(super) struct Kernel {
    /// For each axis, the weight of each light.
    rows: [Vec<f32>; 3],
    /// For each light, 1 / intensity: makes lamps comparable.
    relative: Vec<f32>,
    /// For each light, its vector in the fit, for the misfit.
    toward: Vec<Vector3<f32>>,
}

impl Kernel {
    /// `None` when some lamp is near, or the matrix has no inverse.
    pub fn new(stage: &Stage) -> Option<Self> {
        let toward = stage.distant.as_ref()?;
        let matrix = DMatrix::from_fn(toward.len(), 3, |l, axis| toward[l][axis]);
        let inverse = linear_algebra::pseudo_inverse(&matrix)?;
        Some(Self {
            rows: std::array::from_fn(|axis| inverse.row(axis).iter().map(|&weight| weight as f32).collect()),
            relative: toward.iter().map(|vector| vector.norm().recip() as f32).collect(),
            toward: toward.iter().map(|vector| vector.cast()).collect(),
        })
    }
}

pub(super) fn run_job(mut target: Target, stage: &Stage, kernel: Option<&Kernel>) -> Tally {
    let mut tally = Tally::default();
    let end = target.marks.len();
    for start in (0..end).step_by(BLOCK) {
        let block = start..(start + BLOCK).min(end);
        let pixels = target.first_pixel + block.start..target.first_pixel + block.end;
        let good = all_true(&stage.mask.data()[pixels.clone()])
            && stage.lights.iter().all(|light| all_zero(&light.marks.data()[pixels.clone()]));
        match kernel {
            Some(kernel) if good => good_block(&mut target, stage, kernel, block, &mut tally),
            _ => block.for_each(|at| mixed_pixel(&mut target, stage, at, &mut tally)),
        }
    }
    tally
}

fn good_block(target: &mut Target, stage: &Stage, kernel: &Kernel, block: Range<usize>, tally: &mut Tally) {
    let pixels = target.first_pixel + block.start..target.first_pixel + block.end;
    let direct: Vec<_> = stage.lights.iter().map(|light| &light.direct.data()[pixels.clone()]).collect();
    let len = block.len();
    let (x, y, z) = (&mut target.x[block.clone()], &mut target.y[block.clone()], &mut target.z[block.clone()]);
    combine(x, 0.0, &kernel.rows[0], &direct);
    combine(y, 0.0, &kernel.rows[1], &direct);
    combine(z, 0.0, &kernel.rows[2], &direct);

    // Before the normals are normalised: which pixels have a shadow or a light that does not fit?
    let mut doubtful = [false; BLOCK];
    let doubtful = &mut doubtful[..len];
    find_doubtful(doubtful, [x, y, z], stage, kernel, &direct);

    // Slices cut to one length spare the compiler its checks, so that it works on several pixels at a time.
    let (x, y, z) = (&mut x[..len], &mut y[..len], &mut z[..len]);
    let albedo = &mut target.albedo[block.clone()][..len];
    for i in 0..len {
        let length = (x[i] * x[i] + y[i] * y[i] + z[i] * z[i]).sqrt();
        let inverse = if length > 0.0 { 1.0 / length } else { 0.0 };
        albedo[i] = length;
        x[i] *= inverse;
        y[i] *= inverse;
        z[i] *= inverse;
    }
    let noise_deg = &mut target.noise_deg[block.clone()][..len];
    noise_deg.fill(0.0);
    for (l, light) in stage.lights.iter().enumerate() {
        let Some(noise) = light.noise else { continue };
        let effect = Vector3::new(kernel.rows[0][l], kernel.rows[1][l], kernel.rows[2][l]);
        let squared = effect.norm_squared();
        let sigma = &noise.data()[pixels.clone()][..len];
        for i in 0..len {
            let along = x[i] * effect.x + y[i] * effect.y + z[i] * effect.z;
            noise_deg[i] += sigma[i] * sigma[i] * (squared - along * along);
        }
    }
    for i in 0..len {
        let inverse = if albedo[i] > 0.0 { 1.0 / albedo[i] } else { 0.0 };
        noise_deg[i] = noise_deg[i].max(0.0).sqrt() * inverse * f32::to_degrees(1.0);
    }
    tally.solved += len;
    tally.albedo += f64::from(sum_of(albedo));
    tally.noise_deg += f64::from(sum_of(noise_deg));
    target.marks[block.clone()].fill(0);

    if all_false(doubtful) {
        return;
    }
    for (i, _) in doubtful.iter().enumerate().filter(|(_, doubtful)| **doubtful) {
        let at = block.start + i;
        tally.solved -= 1;
        tally.albedo -= f64::from(target.albedo[at]);
        tally.noise_deg -= f64::from(target.noise_deg[at]);
        mixed_pixel(target, stage, at, tally);
    }
}

/// Marks the pixels that need `Stage::solve`: a light in shadow, a misfit, or no light at all.
fn find_doubtful(doubtful: &mut [bool], scaled: [&[f32]; 3], stage: &Stage, kernel: &Kernel, direct: &[&[f32]]) {
    let len = doubtful.len();
    let (mut low, mut high) = ([f32::INFINITY; BLOCK], [0.0_f32; BLOCK]);
    let (low, high) = (&mut low[..len], &mut high[..len]);
    for (light, relative) in direct.iter().zip(&kernel.relative) {
        let light = &light[..len];
        for i in 0..len {
            let value = light[i] * relative;
            low[i] = if value < low[i] { value } else { low[i] };
            high[i] = if value > high[i] { value } else { high[i] };
        }
    }
    let fraction = stage.options.shadow_fraction as f32;
    for i in 0..len {
        doubtful[i] = (low[i] < fraction * high[i]) | (high[i] <= 0.0);
    }
    if direct.len() < 5 {
        return;
    }
    let fraction = stage.options.outlier_fraction as f32;
    let [x, y, z] = scaled.map(|plane| &plane[..len]);
    for ((light, relative), toward) in direct.iter().zip(&kernel.relative).zip(&kernel.toward) {
        let light = &light[..len];
        for i in 0..len {
            let misfit = (light[i] - (x[i] * toward.x + y[i] * toward.y + z[i] * toward.z)).abs() * relative;
            doubtful[i] |= misfit > fraction * high[i];
        }
    }
}

fn mixed_pixel(target: &mut Target, stage: &Stage, at: usize, tally: &mut Tally) {
    let pixel = target.first_pixel + at;
    let inside = stage.mask.data()[pixel];
    let found = if inside { stage.solve(pixel) } else { PixelNormal::none(0) };
    target.x[at] = found.normal.x as f32;
    target.y[at] = found.normal.y as f32;
    target.z[at] = found.normal.z as f32;
    target.albedo[at] = found.albedo as f32;
    target.noise_deg[at] = found.noise_deg as f32;
    target.marks[at] = if inside { found.marks } else { OUTSIDE };
    if !inside {
        return;
    }
    if found.marks & UNSOLVED != 0 {
        tally.unsolved += 1;
        return;
    }
    tally.solved += 1;
    tally.shadowed += usize::from(found.marks & SHADOWED != 0);
    tally.shadow_used += usize::from(found.marks & SHADOW_USED != 0);
    tally.albedo += found.albedo;
    tally.noise_deg += found.noise_deg;
}
