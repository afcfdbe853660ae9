//! Sums over square windows at a cost that does not grow with the window, and the lines fitted in them.

use rayon::prelude::*;

use super::{DenoiseOptions, TypicalNoise};
use crate::Plane;
use crate::separate::Separation;

/// Columns that a core sums at a time.
const STRIP: usize = 64;

/// The line I = slope T + offset of the window around each pixel, and where windows hold any pixel.
pub(super) struct Lines {
    slope: Plane,
    offset: Plane,
    weight: Plane,
}

/// Fits a line in the window around every solved pixel.
pub(super) fn lines(
    separation: &Separation,
    total: &Plane,
    typical: &TypicalNoise,
    options: &DenoiseOptions,
    solved: &(impl Fn(usize) -> bool + Sync),
) -> Lines {
    let (width, height) = total.size();
    let direct = &separation.bounces[0];
    let masked = |value: &(dyn Fn(f32, f32) -> f32 + Sync)| {
        let data = (0..width * height).into_par_iter().map(|pixel| {
            let total = total.data()[pixel];
            if solved(pixel) { value(total, total - direct.data()[pixel]) } else { 0.0 }
        });
        let plane = Plane::from_vec(width, height, data.collect()).unwrap_or_else(|| total.clone());
        window_sum(&plane, options.radius_px)
    };
    let count = masked(&|_, _| 1.0);
    let sum_t = masked(&|t, _| t);
    let sum_i = masked(&|_, i| i);
    let sum_tt = masked(&|t, _| t * t);
    let sum_ti = masked(&|t, i| t * i);

    let mut lines = Lines {
        slope: Plane::filled(width, height, 0.0),
        offset: Plane::filled(width, height, 0.0),
        weight: Plane::filled(width, height, 0.0),
    };
    let Lines { slope, offset, weight } = &mut lines;
    (slope.data_mut(), offset.data_mut(), weight.data_mut()).into_par_iter().enumerate().for_each(
        |(pixel, (slope, offset, weight))| {
            let n = f64::from(count.data()[pixel]);
            if n < 1.0 || !solved(pixel) {
                return;
            }
            let mean = |sum: &Plane| f64::from(sum.data()[pixel]) / n;
            let (t, i) = (mean(&sum_t), mean(&sum_i));
            // What noise alone puts into the covariances is no sign of a line.
            let variance = (mean(&sum_tt) - t * t - typical.total).max(0.0);
            let covariance = mean(&sum_ti) - t * i - typical.shared;
            let even = (options.evenness * t).powi(2) + typical.total;
            let a = if n < 3.0 { 0.0 } else { (covariance / (variance + even)).clamp(0.0, 1.0) };
            *slope = a as f32;
            *offset = (i - a * t) as f32;
            *weight = 1.0;
        },
    );
    lines
}

/// The mean slope and offset of the windows that each pixel lies in.
pub(super) fn average(lines: &Lines, radius_px: usize) -> (Plane, Plane) {
    let weight = window_sum(&lines.weight, radius_px);
    let mean = |plane: &Plane| {
        let mut sum = window_sum(plane, radius_px);
        sum.data_mut().par_iter_mut().zip(weight.data()).for_each(|(sum, weight)| *sum /= weight.max(1.0));
        sum
    };
    (mean(&lines.slope), mean(&lines.offset))
}

/// At each pixel the sum over the window of half width `radius_px` around it, as far as it lies in the picture.
fn window_sum(plane: &Plane, radius_px: usize) -> Plane {
    let (width, height) = plane.size();
    let mut rows = Plane::filled(width, height, 0.0);
    rows.data_mut().par_chunks_mut(width.max(1)).enumerate().for_each(|(y, out)| slide(plane.row(y), out, radius_px));

    // Down the columns, a strip of them at a time: the running sums of a strip stay in the cache.
    let strips: Vec<Vec<f32>> = (0..width)
        .into_par_iter()
        .step_by(STRIP)
        .map(|start| strip_sums(&rows, start..(start + STRIP).min(width), radius_px))
        .collect();
    let mut sums = Plane::filled(width, height, 0.0);
    sums.data_mut().par_chunks_mut(width.max(1)).enumerate().for_each(|(y, out)| {
        for (strip, out) in strips.iter().zip(out.chunks_mut(STRIP)) {
            out.copy_from_slice(&strip[y * out.len()..(y + 1) * out.len()]);
        }
    });
    sums
}

/// Running sums along a row, in double precision, so that what was added leaves again without a trace.
fn slide(row: &[f32], out: &mut [f32], radius: usize) {
    let mut sum: f64 = row.iter().take(radius).map(|&value| f64::from(value)).sum();
    for x in 0..row.len() {
        if let Some(&entering) = row.get(x + radius) {
            sum += f64::from(entering);
        }
        if x > radius {
            sum -= f64::from(row[x - radius - 1]);
        }
        out[x] = sum as f32;
    }
}

fn strip_sums(rows: &Plane, columns: std::ops::Range<usize>, radius: usize) -> Vec<f32> {
    let height = rows.height();
    let mut sums = vec![0.0_f64; columns.len()];
    let add = |y: usize, sign: f64, sums: &mut [f64]| {
        sums.iter_mut().zip(&rows.row(y)[columns.clone()]).for_each(|(sum, &value)| *sum += sign * f64::from(value));
    };
    (0..radius.min(height)).for_each(|y| add(y, 1.0, &mut sums));
    let mut out = Vec::with_capacity(columns.len() * height);
    for y in 0..height {
        if y + radius < height {
            add(y + radius, 1.0, &mut sums);
        }
        if y > radius {
            add(y - radius - 1, -1.0, &mut sums);
        }
        out.extend(sums.iter().map(|&sum| sum as f32));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn running_sums_are_the_sums_of_the_windows() {
        let plane = Plane::from_fn(150, 37, |x, y| ((x * 31 + y * 17) % 23) as f32 - 7.0);
        for radius in [1, 3, 40] {
            let sums = window_sum(&plane, radius);
            for (x, y) in [(0_usize, 0_usize), (149, 36), (70, 20), (64, 1), (3, 36)] {
                let rows = y.saturating_sub(radius)..(y + radius + 1).min(37);
                let columns = x.saturating_sub(radius)..(x + radius + 1).min(150);
                let direct: f32 = rows.flat_map(|row| plane.row(row)[columns.clone()].iter()).sum();
                assert!((sums.at(x, y) - direct).abs() < 1e-3, "radius {radius} at {x}, {y}");
            }
        }
    }
}
