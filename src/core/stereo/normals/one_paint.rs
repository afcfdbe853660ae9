//! Photometric stereo where the whole object has one paint: the albedo is one number, and of each pixel only the direction of
//! its normal is unknown. With `L_l = k intensity_l n . d_l` and k from all pixels, unit normals are refined by Gauss-Newton on the
//! sphere, weighted by noise.

use nalgebra::{Matrix2, Vector2, Vector3};
use rayon::prelude::*;

use super::pixel::{Sample, Stage};
use super::{Normals, PaintReport, SHADOW_USED, SHADOWED};
use crate::Watch;
use crate::block::JOB;
use crate::interval::median;
use crate::linear_algebra;
use crate::separate::{OUTSIDE, UNSOLVED};

/// Enough pixels to know the albedo by.
const SAMPLED_PIXELS: usize = 20_000;
/// With the albedo known, two lights give a normal: those in shadow are left out.
const LIGHTS_FOR_ONE_PAINT: usize = 2;
/// Without it, a normal needs three.
const LIGHTS_FOR_A_NORMAL: usize = 3;
/// Refinements of the albedo.
const ALBEDO_ROUNDS: usize = 4;
/// Steps of Gauss-Newton, and the turn after which it has come to rest.
const MAX_STEPS: usize = 6;
const AT_REST: f64 = 1e-5;
/// A normal that turns farther than this (about 30 degrees) has left its solution, one that is noisier has none.
const MIN_COSINE: f64 = 0.87;
const MAX_NOISE_DEG: f64 = 60.0;
/// How firmly a normal is held to where it was, as a share of what the lights say, where fewer than all reach it.
const HOLD: f64 = 0.01;
/// An albedo strays where it differs from the object's by more than this share and three times its own noise.
const STRAY: f64 = 0.1;

/// What the albedos of an object say about its paint.
pub(super) fn judge(stage: &Stage, normals: &Normals) -> Option<PaintReport> {
    // Under low lamps hardly a pixel is lit by all of them: the lights that normals need are enough.
    let is_lit = |marks: u8| marks & (UNSOLVED | OUTSIDE | SHADOW_USED) == 0;
    let count = normals.marks.data().par_iter().filter(|marks| is_lit(**marks)).count();
    let every = (count / SAMPLED_PIXELS).max(1);
    let lit = (0..normals.marks.data().len()).filter(|&pixel| is_lit(normals.marks.data()[pixel]));
    let pixels: Vec<usize> = lit.step_by(every).collect();
    let with_normal = |pixel: usize| {
        let (samples, ..) = stage.used(pixel, LIGHTS_FOR_A_NORMAL);
        Some((pixel, samples, normals.map.at_index(pixel)?.cast::<f64>()))
    };
    let mut all: Vec<_> = pixels.into_iter().filter_map(with_normal).collect();
    let own = |pixel: usize| f64::from(normals.albedo.data()[pixel]);
    if all.is_empty() {
        return None;
    }
    let mut albedo = median(&mut all.iter().map(|(pixel, ..)| own(*pixel)).collect::<Vec<_>>());
    let is_stray = |(pixel, samples, normal): &&(usize, Vec<Sample>, Vector3<f64>)| {
        (own(*pixel) - albedo).abs() > STRAY * albedo + 3.0 * noise_of_albedo(samples, normal)
    };
    let stray_share = all.par_iter().filter(is_stray).count() as f64 / all.len().max(1) as f64;
    for _ in 0..ALBEDO_ROUNDS {
        all.par_iter_mut().for_each(|(_, samples, normal)| {
            *normal = refine(samples, *normal, albedo, false).map_or(*normal, |refined| refined.normal);
        });
        albedo = median(&mut all.par_iter().map(|(_, samples, normal)| albedo_of(samples, normal)).collect::<Vec<_>>());
    }
    Some(PaintReport { one: true, albedo, stray_share })
}

/// Refines all normals to those of one albedo.
pub(super) fn refine_all(stage: &Stage, normals: &mut Normals, albedo: f64, watch: &dyn Watch) {
    let Normals { map, albedo: albedos, noise_deg, marks } = normals;
    let [x, y, z] = map.planes_mut().map(|plane| plane.data_mut().par_chunks_mut(JOB));
    let rest = (albedos.data_mut().par_chunks_mut(JOB), noise_deg.data_mut().par_chunks_mut(JOB));
    (x, y, z, rest.0, rest.1, marks.data_mut().par_chunks_mut(JOB)).into_par_iter().enumerate().for_each(
        |(job, (x, y, z, albedos, noise_deg, marks))| {
            if watch.cancelled() {
                return;
            }
            for (at, marks) in marks.iter_mut().enumerate().filter(|(_, marks)| **marks & (UNSOLVED | OUTSIDE) == 0) {
                let (samples, left_out, _) = stage.used(job * JOB + at, LIGHTS_FOR_ONE_PAINT);
                let normal = Vector3::new(x[at], y[at], z[at]).cast::<f64>();
                let Some(refined) = refine(&samples, normal, albedo, samples.len() < LIGHTS_FOR_A_NORMAL) else {
                    continue;
                };
                [x[at], y[at], z[at]] = refined.normal.cast::<f32>().into();
                albedos[at] = albedo_of(&samples, &refined.normal) as f32;
                noise_deg[at] = refined.noise_deg as f32;
                if left_out & SHADOWED != 0 {
                    *marks = *marks & !SHADOW_USED | SHADOWED;
                }
            }
        },
    );
}

struct Refined {
    normal: Vector3<f64>,
    noise_deg: f64,
}

/// The unit normal that explains the light of one pixel best; `None` where the light says too little. A lamp behind the
/// surface says nothing; then, or where lights were left out, the others decide, and the normal is held near where it was.
fn refine(samples: &[Sample], start: Vector3<f64>, albedo: f64, is_short: bool) -> Option<Refined> {
    let mut normal = start;
    let mut noise_deg = 0.0;
    for _ in 0..MAX_STEPS {
        let (u, v) = tangents(&normal);
        let (mut matrix, mut noise, mut right) = (Matrix2::zeros(), Matrix2::zeros(), Vector2::zeros());
        let mut is_held = is_short;
        for sample in samples {
            let facing = sample.toward.dot(&normal);
            if facing <= 0.0 {
                is_held = true;
                continue;
            }
            let weight = weight_of(sample);
            let slope = albedo * Vector2::new(sample.toward.dot(&u), sample.toward.dot(&v));
            matrix += weight * slope * slope.transpose();
            noise += (weight * sample.sigma).powi(2) * slope * slope.transpose();
            right += weight * (sample.light - albedo * facing) * slope;
        }
        let held = if is_held { HOLD * matrix.trace() } else { 0.0 };
        matrix += Matrix2::from_diagonal_element(held);
        right += held * Vector2::new((start - normal).dot(&u), (start - normal).dot(&v));
        let inverse = linear_algebra::inverse(&matrix)?;
        let turn = inverse * right;
        noise_deg = (inverse * noise * inverse).trace().max(0.0).sqrt().to_degrees();
        normal = (normal + turn.x * u + turn.y * v).normalize();
        if turn.norm() < AT_REST {
            break;
        }
    }
    (normal.dot(&start) > MIN_COSINE && noise_deg < MAX_NOISE_DEG).then_some(Refined { normal, noise_deg })
}

/// Two unit vectors across the normal and each other.
fn tangents(normal: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let aside = if normal.z.abs() < 0.9 { Vector3::z() } else { Vector3::x() };
    let u = normal.cross(&aside).normalize();
    (u, normal.cross(&u))
}

/// One over the variance; light of unknown noise counts by itself.
fn weight_of(sample: &Sample) -> f64 {
    if sample.sigma > 0.0 { sample.sigma.powi(-2) } else { 1.0 }
}

/// The albedo that explains the light of one pixel best, its normal known.
fn albedo_of(samples: &[Sample], normal: &Vector3<f64>) -> f64 {
    let (mut product, mut square) = (0.0, 0.0);
    for sample in samples {
        let facing = sample.toward.dot(normal).max(0.0);
        product += weight_of(sample) * facing * sample.light;
        square += weight_of(sample) * facing * facing;
    }
    if square > 0.0 { product / square } else { 0.0 }
}

/// Standard deviation of the length of the least-squares solution.
fn noise_of_albedo(samples: &[Sample], normal: &Vector3<f64>) -> f64 {
    let along = |(sample, effect): (&Sample, Vector3<f64>)| (sample.sigma * effect.dot(normal)).powi(2);
    match super::pixel::effects(samples) {
        Some(effects) => samples.iter().zip(effects).map(along).sum::<f64>().sqrt(),
        None => f64::INFINITY,
    }
}
