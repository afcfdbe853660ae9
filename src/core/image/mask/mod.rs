//! The pixels that belong to the object.

mod draw;

use rayon::prelude::*;

use super::raster::Raster;
use crate::Plane;

pub use draw::Combine;

/// Steps of brightness between which the threshold is looked for.
const HISTOGRAM_STEPS: usize = 1024;

/// A yes or no for each pixel: true inside the object.
pub type Mask = Raster<bool>;

impl Mask {
    /// The pixels brighter than what best parts the picture in two (N. Otsu, "A threshold selection method from
    /// gray-level histograms", IEEE Trans. SMC 9(1), 1979): an object on a dark ground.
    pub fn brighter_part(picture: &Plane) -> Self {
        Self::brighter_than(picture, Self::best_threshold(picture))
    }

    /// What best parts a picture in two, as [`Self::brighter_part`] does.
    pub fn best_threshold(picture: &Plane) -> f32 {
        otsu_threshold(picture.data())
    }

    /// The connected part that each pixel belongs to, numbered from 1; 0 outside. Pixels connect along rows and columns.
    pub fn islands(&self) -> Vec<u32> {
        let (inside, (width, height)) = (self.data(), self.size());
        let mut island = vec![0; inside.len()];
        let mut count = 0;
        let mut open = Vec::new();
        for start in 0..island.len() {
            if !inside[start] || island[start] != 0 {
                continue;
            }
            count += 1;
            island[start] = count;
            open.push(start);
            while let Some(pixel) = open.pop() {
                let (x, y) = (pixel % width, pixel / width);
                let beside = [
                    (x > 0).then(|| pixel - 1),
                    (x + 1 < width).then(|| pixel + 1),
                    (y > 0).then(|| pixel - width),
                    (y + 1 < height).then(|| pixel + width),
                ];
                for next in beside.into_iter().flatten().filter(|&next| inside[next]) {
                    if island[next] == 0 {
                        island[next] = count;
                        open.push(next);
                    }
                }
            }
        }
        island
    }

    /// How many pixels are inside.
    pub fn count(&self) -> usize {
        self.data().iter().filter(|&&inside| inside).count()
    }
}

/// The threshold that maximises the variance between the two parts.
fn otsu_threshold(values: &[f32]) -> f32 {
    let (low, high) = values
        .par_iter()
        .map(|&value| (value, value))
        .reduce(|| (f32::INFINITY, f32::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
    let width = (high - low) / HISTOGRAM_STEPS as f32;
    if width.is_nan() || width <= 0.0 {
        return low;
    }
    let step_of = |value: f32| (((value - low) / width) as usize).min(HISTOGRAM_STEPS - 1);
    let mut histogram = vec![0usize; HISTOGRAM_STEPS];
    values.iter().for_each(|&value| histogram[step_of(value)] += 1);

    let total = values.len() as f64;
    let mean = |(step, &count): (usize, &usize)| step as f64 * count as f64 / total;
    let mean_of_all: f64 = histogram.iter().enumerate().map(mean).sum();
    let (mut share, mut mean_below) = (0.0, 0.0);
    let mut best = (0.0, 0);
    for (step, count) in histogram.iter().enumerate() {
        share += *count as f64 / total;
        mean_below += mean((step, count));
        let between = (mean_of_all * share - mean_below).powi(2) / (share * (1.0 - share));
        if between > best.0 {
            best = (between, step);
        }
    }
    low + width * (best.1 + 1) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lit_disc_parts_from_its_dark_ground() {
        let inside = |x: usize, y: usize| (x as f32 - 50.0).powi(2) + (y as f32 - 40.0).powi(2) < 900.0;
        let shade = |x: usize, y: usize| 0.01 * ((x * 7 + y * 3) % 5) as f32;
        let picture =
            Plane::from_fn(100, 80, |x, y| shade(x, y) + if inside(x, y) { 0.3 + 0.004 * x as f32 } else { 0.0 });
        assert_eq!(Mask::brighter_part(&picture), Mask::from_fn(100, 80, inside));
    }

    #[test]
    fn a_flat_picture_has_no_brighter_part() {
        assert_eq!(Mask::brighter_part(&Plane::filled(9, 9, 0.4)).count(), 0);
    }
}
