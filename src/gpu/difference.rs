//! Differences of two pictures, in numbers.

use firstbounce_core::Mask;
use rayon::prelude::*;
use thiserror::Error;

use super::Layer;

/// `a - b` over the pixels where both have a value, in the unit of the layers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Mean, signed: whether one picture is brighter on the whole.
    pub mean: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// Largest magnitude.
    pub max: f64,
    /// The pixel `(x, y)` with the largest magnitude.
    pub max_at: (usize, usize),
    /// How many pixels were compared.
    pub pixels: usize,
}

/// Why two pictures could not be compared.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum DifferenceError {
    /// Different sizes.
    #[error("{}x{} and {}x{} pixels cannot be compared; choose pictures of one size", .0.0, .0.1, .1.0, .1.1)]
    SizesDiffer((usize, usize), (usize, usize)),
    /// The pictures have no value at a common pixel, or the mask is empty.
    #[error("no pixel has a value in both pictures; check the mask")]
    NoPixel,
}

#[derive(Clone, Copy, Default)]
struct Sums {
    sum: f64,
    squares: f64,
    max: f64,
    max_at: (usize, usize),
    pixels: usize,
}

/// Compares two layers of one size, inside the mask if there is one. The sums are taken row by row, so that the result does not
/// depend on the number of cores.
pub fn difference(a: &Layer, b: &Layer, mask: Option<&Mask>) -> Result<Difference, DifferenceError> {
    let (width, height) = a.size();
    for other in [Some(b.size()), mask.map(Mask::size)].into_iter().flatten() {
        if other != a.size() {
            return Err(DifferenceError::SizesDiffer(a.size(), other));
        }
    }
    let rows: Vec<Sums> = (0..height).into_par_iter().map(|y| row_sums(a, b, mask, width, y)).collect();
    let total = rows.iter().fold(Sums::default(), |total, row| Sums {
        sum: total.sum + row.sum,
        squares: total.squares + row.squares,
        max: total.max.max(row.max),
        max_at: if row.max > total.max { row.max_at } else { total.max_at },
        pixels: total.pixels + row.pixels,
    });
    if total.pixels == 0 {
        return Err(DifferenceError::NoPixel);
    }
    let pixels = total.pixels as f64;
    Ok(Difference {
        mean: total.sum / pixels,
        rms: (total.squares / pixels).sqrt(),
        max: total.max,
        max_at: total.max_at,
        pixels: total.pixels,
    })
}

fn row_sums(a: &Layer, b: &Layer, mask: Option<&Mask>, width: usize, y: usize) -> Sums {
    let (first, second) = (row_of(a, width, y), row_of(b, width, y));
    let mut sums = Sums::default();
    for (x, (a, b)) in first.iter().zip(&second).enumerate() {
        let delta = a - b;
        if !delta.is_finite() || mask.is_some_and(|mask| !mask.at(x, y)) {
            continue;
        }
        sums.sum += delta;
        sums.squares += delta * delta;
        sums.pixels += 1;
        if delta.abs() > sums.max {
            sums.max = delta.abs();
            sums.max_at = (x, y);
        }
    }
    sums
}

fn row_of(layer: &Layer, width: usize, y: usize) -> Vec<f64> {
    let mut row = vec![0.0; width];
    for (plane, weight) in layer.terms() {
        let values = plane.plane.row(y);
        row.iter_mut().zip(values).for_each(|(sum, &value)| *sum += f64::from(*weight) * f64::from(value));
    }
    row
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use firstbounce_core::Plane;

    use super::super::CanvasPlane;
    use super::*;

    fn layer(plane: Plane) -> Layer {
        CanvasPlane::new(Arc::new(plane)).into()
    }

    #[test]
    fn a_ramp_against_nothing_has_the_moments_of_a_ramp() {
        // 0, 1, ..., n - 1: mean (n - 1) / 2, mean square (n - 1)(2n - 1) / 6.
        let ramp = layer(Plane::from_fn(10, 8, |x, y| (10 * y + x) as f32));
        let found = difference(&ramp, &layer(Plane::filled(10, 8, 0.0)), None).unwrap();
        assert!((found.mean - 39.5).abs() < 1e-12);
        assert!((found.rms - (79.0 * 159.0 / 6.0_f64).sqrt()).abs() < 1e-12);
        assert_eq!((found.max, found.max_at, found.pixels), (79.0, (9, 7), 80));
    }

    #[test]
    fn pixels_outside_the_mask_and_without_a_value_are_left_out() {
        let a = layer(Plane::from_vec(2, 2, vec![f32::NAN, -3.0, 100.0, 1.0]).unwrap());
        let mask = Mask::from_fn(2, 2, |x, y| (x, y) != (0, 1));
        let found = difference(&a, &layer(Plane::filled(2, 2, 0.0)), Some(&mask)).unwrap();
        assert_eq!((found.mean, found.max, found.max_at, found.pixels), (-1.0, 3.0, (1, 0), 2));
        let nothing = difference(&a, &a, Some(&Mask::filled(2, 2, false)));
        assert_eq!(nothing.unwrap_err(), DifferenceError::NoPixel);
    }
}
