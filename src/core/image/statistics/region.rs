//! Statistics of a plane over a rectangle or a lasso.

use rayon::prelude::*;

use crate::{Mask, Plane};

/// Where to look, in pixels: x right, y down, the centre of the top left pixel is (0.5, 0.5). A pixel belongs to a region
/// that holds its centre.
#[derive(Clone, Debug, PartialEq)]
pub enum Region {
    /// Between two opposite corners.
    Rectangle([f64; 2], [f64; 2]),
    /// Inside a closed line (even-odd rule).
    Lasso(Vec<[f64; 2]>),
}

/// The statistics of a region. All are `NaN`-free: values that are no number are counted and left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegionStatistics {
    /// Pixels with a finite value.
    pub pixels: usize,
    /// Pixels without.
    pub not_finite: usize,
    /// Mean.
    pub mean: f64,
    /// Standard deviation of the pixels (over n - 1).
    pub sd: f64,
    /// Smallest value.
    pub min: f64,
    /// 5 of 100 pixels are below.
    pub percentile_5: f64,
    /// Half of the pixels are below.
    pub median: f64,
    /// 95 of 100 pixels are below.
    pub percentile_95: f64,
    /// Largest value.
    pub max: f64,
}

impl Region {
    /// The pixels of a plane of this size that lie inside.
    pub fn mask(&self, width: usize, height: usize) -> Mask {
        let mut data = vec![false; width * height];
        data.par_chunks_mut(width.max(1)).enumerate().for_each(|(y, row)| {
            for [from, to] in self.spans(y as f64 + 0.5) {
                // Pixel x has its centre at x + 0.5.
                let first = (from - 0.5).ceil().clamp(0.0, width as f64) as usize;
                let end = (to - 0.5).ceil().clamp(first as f64, width as f64) as usize;
                row[first..end].fill(true);
            }
        });
        Mask::from_vec(width, height, data).unwrap_or_else(|| Mask::filled(width, height, false))
    }

    /// The stretches of the line y = `y_px` that lie inside.
    fn spans(&self, y_px: f64) -> Vec<[f64; 2]> {
        match self {
            Self::Rectangle(a, b) => {
                let inside = (a[1].min(b[1])..a[1].max(b[1])).contains(&y_px);
                if inside { vec![[a[0].min(b[0]), a[0].max(b[0])]] } else { Vec::new() }
            }
            Self::Lasso(corners) => {
                let sides = corners.iter().zip(corners.iter().cycle().skip(1));
                let crossed = sides.filter(|(a, b)| (a[1] <= y_px) != (b[1] <= y_px));
                let mut crossings: Vec<_> =
                    crossed.map(|(a, b)| a[0] + (y_px - a[1]) / (b[1] - a[1]) * (b[0] - a[0])).collect();
                crossings.sort_by(f64::total_cmp);
                crossings.as_chunks::<2>().0.to_vec()
            }
        }
    }
}

/// Statistics of the values inside `mask`; `None` where it holds no finite value or has another size.
pub fn statistics(plane: &Plane, mask: &Mask) -> Option<RegionStatistics> {
    if mask.size() != plane.size() {
        return None;
    }
    let chosen = plane.data().par_iter().zip(mask.data()).filter(|(_, inside)| **inside).map(|(value, _)| *value);
    let all: Vec<f32> = chosen.collect();
    let mut values: Vec<f32> = all.par_iter().copied().filter(|value| value.is_finite()).collect();
    let pixels = values.len();
    if pixels == 0 {
        return None;
    }
    let mean = values.par_iter().map(|value| f64::from(*value)).sum::<f64>() / pixels as f64;
    // Around the mean: a sum of squares would lose the spread of bright light.
    let squares: f64 = values.par_iter().map(|value| (f64::from(*value) - mean).powi(2)).sum();
    values.par_sort_unstable_by(f32::total_cmp);
    let percentile = |share: f64| f64::from(values[((pixels - 1) as f64 * share).round() as usize]);
    Some(RegionStatistics {
        pixels,
        not_finite: all.len() - pixels,
        mean,
        sd: (squares / (pixels.max(2) - 1) as f64).sqrt(),
        min: percentile(0.0),
        percentile_5: percentile(0.05),
        median: percentile(0.5),
        percentile_95: percentile(0.95),
        max: percentile(1.0),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_holds_the_pixels_whose_centres_it_holds() {
        let mask = Region::Rectangle([4.6, 3.0], [1.0, 1.4]).mask(8, 6);
        assert_eq!(mask, Mask::from_fn(8, 6, |x, y| (1..5).contains(&x) && (1..3).contains(&y)));
    }

    #[test]
    fn a_lasso_around_a_disc_has_its_area() {
        let corner = |i: usize| {
            let angle = std::f64::consts::TAU * i as f64 / 200.0;
            [100.0 + 60.0 * angle.cos(), 90.0 + 60.0 * angle.sin()]
        };
        let mask = Region::Lasso((0..200).map(corner).collect()).mask(220, 180);
        let area = std::f64::consts::PI * 3600.0;
        assert!((mask.count() as f64 / area - 1.0).abs() < 0.005);
        assert!(mask.at(100, 90) && !mask.at(41, 40));
    }

    #[test]
    fn a_lasso_beyond_the_picture_is_cut() {
        let lasso = Region::Lasso(vec![[-50.0, -50.0], [500.0, -50.0], [500.0, 500.0], [-50.0, 500.0]]);
        assert_eq!(lasso.mask(9, 7).count(), 63);
        assert_eq!(Region::Lasso(Vec::new()).mask(9, 7).count(), 0);
    }

    #[test]
    fn statistics_of_a_ramp_are_those_of_whole_numbers() {
        let ramp = Plane::from_fn(101, 1, |x, _| 1000.0 + x as f32);
        let found = statistics(&ramp, &Mask::filled(101, 1, true)).unwrap();
        assert_eq!((found.min, found.median, found.max, found.mean), (1000.0, 1050.0, 1100.0, 1050.0));
        assert_eq!((found.percentile_5, found.percentile_95), (1005.0, 1095.0));
        // Variance of 0..n: n (n + 2) / 12 over n + 1 values, times (n + 1) / n.
        assert!((found.sd.powi(2) - 101.0 * 102.0 / 12.0).abs() < 1e-6);
    }

    #[test]
    fn values_that_are_no_number_are_left_out_and_counted() {
        let plane = Plane::from_vec(3, 1, vec![f32::NAN, 2.0, 4.0]).unwrap();
        let found = statistics(&plane, &Mask::filled(3, 1, true)).unwrap();
        assert_eq!((found.pixels, found.not_finite, found.mean), (2, 1, 3.0));
        assert!(statistics(&plane, &Mask::filled(3, 1, false)).is_none());
        assert!(statistics(&plane, &Mask::filled(2, 1, true)).is_none());
    }
}
