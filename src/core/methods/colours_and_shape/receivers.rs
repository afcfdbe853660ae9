//! Normals that receive light: the noise of a pixel's own normal must not become noise of the light that arrives there.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::{Mask, NormalMap, Plane};

/// Normals that differ by more than this, about 25 degrees, belong to different walls.
const SAME_WALL: f32 = 0.9;

/// Every normal as the mean of those around it that lie on the same wall, weighted by a Gaussian along rows, then columns.
pub(super) fn smoothed(normals: &NormalMap, mask: &Mask, sigma_px: f64) -> NormalMap {
    let reach = (2.0 * sigma_px).round() as usize;
    let weights: Vec<f32> = (0..=reach).map(|k| (-0.5 * (k as f64 / sigma_px.max(0.1)).powi(2)).exp() as f32).collect();
    along(&along(normals, mask, &weights, (1, 0)), mask, &weights, (0, 1))
}

fn along(normals: &NormalMap, mask: &Mask, weights: &[f32], (right, down): (usize, usize)) -> NormalMap {
    let (width, height) = normals.size();
    let at = |x: usize, y: usize| {
        if x < width && y < height && mask.at(x, y) { normals.at(x, y) } else { None }
    };
    let of_row = |y: usize| {
        let of_pixel = move |x: usize| {
            let Some(own) = at(x, y) else { return Vector3::zeros() };
            let mut sum = own * weights[0];
            for (k, weight) in weights.iter().enumerate().skip(1) {
                let before = x.checked_sub(k * right).zip(y.checked_sub(k * down));
                for (x, y) in [before, Some((x + k * right, y + k * down))].into_iter().flatten() {
                    sum += at(x, y)
                        .filter(|normal| normal.dot(&own) > SAME_WALL)
                        .map_or(Vector3::zeros(), |n| n * *weight);
                }
            }
            sum.normalize()
        };
        (0..width).map(of_pixel)
    };
    let smooth: Vec<Vector3<f32>> = (0..height).into_par_iter().flat_map_iter(of_row).collect();
    let plane = |axis: usize| {
        Plane::from_vec(width, height, smooth.iter().map(|normal| normal[axis]).collect()).unwrap_or_default()
    };
    NormalMap::from_planes(plane(0), plane(1), plane(2)).unwrap_or_else(|| normals.clone())
}
