//! Radiosity that runs linearly over each patch and without a step between those of one smooth surface.

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use crate::light::radiosity::{Patch, Patches};
use crate::linear_algebra;

/// A radiosity over one patch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Linear {
    at_centre: f32,
    gradient: Vector3<f32>,
}

impl Linear {
    /// The value at an offset from the patch's centre.
    pub(crate) fn at(&self, offset: &Vector3<f32>) -> f32 {
        self.at_centre + self.gradient.dot(offset)
    }

    fn through(patch: &Patch, values: [f64; 3]) -> Self {
        let [a, b, c] = patch.corners;
        let slopes = (c - b) * values[0] + (a - c) * values[1] + (b - a) * values[2];
        let doubled_area = 2.0 * patch.area_mm2;
        let gradient = if doubled_area > 0.0 { patch.normal.cross(&slopes) / doubled_area } else { Vector3::zeros() };
        Self { at_centre: (values.iter().sum::<f64>() / 3.0) as f32, gradient: gradient.cast() }
    }
}

/// For each patch, each channel (a mean for each patch) as a linear function. The value at a corner is the mean of what
/// the patches around it extrapolate to it, each with the gradient its neighbours suggest.
pub(crate) fn linear_over_patches(patches: &Patches, channels: &[&[f64]]) -> Vec<Vec<Linear>> {
    let all = patches.as_slice();
    let around = patches.around_corners();
    let gradients: Vec<Vec<Vector3<f64>>> =
        (0..all.len()).into_par_iter().map(|index| gradients(all, index, &around[index], channels)).collect();
    let linear = |index: usize| {
        let corner_value = |channel: usize, k: usize| {
            let corner = all[index].corners[k];
            let from = |&other: &usize| {
                channels[channel][other] + gradients[other][channel].dot(&(corner - all[other].centre))
            };
            let sum: f64 = around[index][k].iter().map(from).sum();
            (sum / around[index][k].len() as f64).max(0.0)
        };
        let through = |channel| Linear::through(&all[index], [0, 1, 2].map(|k| corner_value(channel, k)));
        (0..channels.len()).map(through).collect()
    };
    (0..all.len()).into_par_iter().map(linear).collect()
}

/// The gradient of every channel at one patch: least squares over the patches it shares corners with.
fn gradients(patches: &[Patch], index: usize, around: &[Vec<usize>; 3], channels: &[&[f64]]) -> Vec<Vector3<f64>> {
    let patch = &patches[index];
    let mut neighbours: Vec<usize> = around.iter().flatten().copied().filter(|&other| other != index).collect();
    neighbours.sort_unstable();
    neighbours.dedup();
    let normal = patch.normal.into_inner();
    // Nothing is known along the normal: the gradient shall be zero there.
    let mut matrix: Matrix3<f64> = normal * normal.transpose() * neighbours.len() as f64;
    let weighted = |&other: &usize| {
        let offset = patches[other].centre - patch.centre;
        (other, offset, offset / offset.norm_squared().max(f64::MIN_POSITIVE))
    };
    let weighted: Vec<_> = neighbours.iter().map(weighted).collect();
    for (_, offset, pull) in &weighted {
        matrix += pull * offset.transpose();
    }
    let inverse =
        (neighbours.len() >= 2).then(|| linear_algebra::inverse(&matrix)).flatten().unwrap_or_else(Matrix3::zeros);
    let gradient = |channel: &&[f64]| {
        inverse
            * weighted.iter().map(|(other, _, pull)| pull * (channel[*other] - channel[index])).sum::<Vector3<f64>>()
    };
    channels.iter().map(gradient).collect()
}
