//! Lens distortion undone: from pixels as a lens draws them to those of a pinhole.
//!
//! The model is OpenCV's with k1, k2, p1 and p2 (`calib3d`, "Camera Calibration and 3D Reconstruction"), after D. C. Brown,
//! "Decentering distortion of lenses", Photogrammetric Engineering 32(3), 1966. With x, y the pinhole's picture of a point at unit
//! distance, y down, and r^2 = x^2 + y^2,
//!
//! ```text
//! x' = x (1 + k1 r^2 + k2 r^4) + 2 p1 x y + p2 (r^2 + 2 x^2)
//! y' = y (1 + k1 r^2 + k2 r^4) + p1 (r^2 + 2 y^2) + 2 p2 x y
//! ```

use rayon::prelude::*;
use thiserror::Error;

use super::photo::{CLIPPED, DARK};
use crate::{Marks, Photo, Plane};

/// Steps of Newton's method that take a pixel back to the pinhole's; each doubles the digits.
const MAX_STEPS: usize = 20;
/// Where those steps have arrived, in pixels.
const ARRIVED_PX: f64 = 1e-9;
/// Points along each side of a picture at which the map is looked at.
const GRID: usize = 65;
/// Pixels that say how the variance of the others changes.
const VARIANCE_SAMPLES: usize = 10_007;
/// The map keeps at least this share of the area of a pixel: less, and it is about to fold.
const MIN_AREA: f64 = 0.05;

/// A lens before a pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Focal length in pixels.
    pub focal_length_px: f64,
    /// Where the optical axis meets the picture, in pixels; the centre of the top left pixel is (0.5, 0.5).
    pub principal_point_px: (f64, f64),
    /// k1, k2, p1 and p2.
    pub coefficients: [f64; 4],
}

/// Why distortion cannot be undone.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum DistortionError {
    /// Two places of the object come to one pixel.
    #[error(
        "the distortion folds the picture over at pixel {:.0}, {:.0}: these coefficients do not belong to this picture; check them, \
         the focal length and the principal point", at_px.0, at_px.1
    )]
    Folds {
        /// Where, in the undistorted picture.
        at_px: (f64, f64),
    },
}

impl Lens {
    /// Where the lens draws what a pinhole would draw at (x, y) pixels.
    pub fn distorted(&self, at: (f64, f64)) -> (f64, f64) {
        let (x, y) = self.normalised(at);
        let (x, y) = self.model(x, y);
        (self.focal_length_px * x + self.principal_point_px.0, self.focal_length_px * y + self.principal_point_px.1)
    }

    /// Where a pinhole would draw what the lens draws at (x, y) pixels; `None` where nothing comes there.
    pub fn undistorted(&self, at: (f64, f64)) -> Option<(f64, f64)> {
        let (x0, y0) = self.normalised(at);
        let (mut x, mut y) = (x0, y0);
        for _ in 0..MAX_STEPS {
            let (fx, fy) = self.model(x, y);
            let (ex, ey) = (fx - x0, fy - y0);
            if ex.hypot(ey) * self.focal_length_px < ARRIVED_PX {
                let (cx, cy) = self.principal_point_px;
                return Some((self.focal_length_px * x + cx, self.focal_length_px * y + cy));
            }
            let [[a, b], [c, d]] = self.slopes(x, y);
            let area = a * d - b * c;
            if area.is_nan() || area.abs() <= f64::MIN_POSITIVE {
                return None;
            }
            (x, y) = (x - (d * ex - b * ey) / area, y - (a * ey - c * ex) / area);
        }
        None
    }

    /// Refuses a lens that draws two places of a picture of this size at one pixel.
    ///
    /// # Errors
    /// [`DistortionError::Folds`].
    pub fn check(&self, (width, height): (usize, usize)) -> Result<(), DistortionError> {
        let at = |k: usize, side: usize| side as f64 * k as f64 / (GRID - 1) as f64;
        for (row, column) in (0..GRID).flat_map(|row| (0..GRID).map(move |column| (row, column))) {
            let at_px = (at(column, width), at(row, height));
            let (x, y) = self.normalised(at_px);
            let [[a, b], [c, d]] = self.slopes(x, y);
            if (a * d - b * c).is_nan() || a * d - b * c < MIN_AREA {
                return Err(DistortionError::Folds { at_px });
            }
        }
        Ok(())
    }

    fn normalised(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let (cx, cy) = self.principal_point_px;
        ((x - cx) / self.focal_length_px, (y - cy) / self.focal_length_px)
    }

    fn model(&self, x: f64, y: f64) -> (f64, f64) {
        let [k1, k2, p1, p2] = self.coefficients;
        let r2 = x * x + y * y;
        let radial = 1.0 + r2 * (k1 + r2 * k2);
        (
            x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        )
    }

    /// Derivatives of the model: of x' by x and y, of y' by x and y.
    fn slopes(&self, x: f64, y: f64) -> [[f64; 2]; 2] {
        let [k1, k2, p1, p2] = self.coefficients;
        let r2 = x * x + y * y;
        let radial = 1.0 + r2 * (k1 + r2 * k2);
        let growth = 2.0 * (k1 + 2.0 * k2 * r2);
        let across = growth * x * y + 2.0 * (p1 * x + p2 * y);
        [
            [radial + growth * x * x + 2.0 * p1 * y + 6.0 * p2 * x, across],
            [across, radial + growth * y * y + 6.0 * p1 * y + 2.0 * p2 * x],
        ]
    }
}

/// A photo without distortion.
#[derive(Clone, Debug)]
pub struct Undistorted {
    /// The photo, of the same size and camera.
    pub photo: Photo,
    /// Variance of a pixel over that of the pixels that it is made of, in the mean: neighbours share their noise.
    pub variance_share: f64,
}

/// Resamples a photo as a pinhole would have taken it, by the cubic through four pixels each way (Catmull and Rom). A pixel that takes
/// of a clipped or a dark one is marked as that one is, one outside the photo as it was taken
/// dark.
///
/// # Errors
/// As [`Lens::check`].
pub fn undistort(photo: &Photo, lens: &Lens) -> Result<Undistorted, DistortionError> {
    let size = photo.linear.size();
    lens.check(size)?;
    let pixel = |index: usize| {
        let at = ((index % size.0) as f64 + 0.5, (index / size.0) as f64 + 0.5);
        sample(photo, lens.distorted(at))
    };
    let outside = Sample { light: 0.0, mark: DARK, squares: 1.0 };
    let light_and_mark = |index: usize| {
        let Sample { light, mark, .. } = pixel(index).unwrap_or(outside);
        (light, mark)
    };
    let (light, marks): (Vec<f32>, Vec<u8>) = (0..size.0 * size.1).into_par_iter().map(light_and_mark).unzip();
    let linear = Plane::from_vec(size.0, size.1, light).unwrap_or_default();
    let marks = Marks::from_vec(size.0, size.1, marks).unwrap_or_default();
    let step = (size.0 * size.1).div_ceil(VARIANCE_SAMPLES).max(1);
    let squares: Vec<f64> = (0..size.0 * size.1).step_by(step).filter_map(pixel).map(|sample| sample.squares).collect();
    let variance_share = if squares.is_empty() { 1.0 } else { squares.iter().sum::<f64>() / squares.len() as f64 };
    Ok(Undistorted { photo: Photo { linear, marks }, variance_share })
}

#[derive(Clone, Copy)]
struct Sample {
    light: f32,
    mark: u8,
    /// Sum of the squares of the weights.
    squares: f64,
}

/// The light at a place of a photo; `None` outside. At the edge the last pixels go on.
fn sample(photo: &Photo, (x, y): (f64, f64)) -> Option<Sample> {
    let (width, height) = photo.linear.size();
    if !((0.0..=width as f64).contains(&x) && (0.0..=height as f64).contains(&y)) {
        return None;
    }
    let taps = |at: f64, side: usize| {
        let first = (at - 0.5).floor();
        let weights = catmull_rom(at - 0.5 - first);
        let pixel = |k: usize| (first + k as f64 - 1.0).clamp(0.0, side as f64 - 1.0) as usize;
        [0, 1, 2, 3].map(|k| (pixel(k), weights[k]))
    };
    let (columns, rows) = (taps(x, width), taps(y, height));
    let (mut light, mut mark) = (0.0, 0);
    for (row, across) in rows {
        for (column, along) in columns {
            let weight = across * along;
            if weight != 0.0 {
                light += weight * f64::from(photo.linear.at(column, row));
                mark |= photo.marks.at(column, row) & (CLIPPED | DARK);
            }
        }
    }
    let squares = |taps: [(usize, f64); 4]| taps.iter().map(|(_, weight)| weight * weight).sum::<f64>();
    Some(Sample { light: light as f32, mark, squares: squares(columns) * squares(rows) })
}

/// Weights of four neighbours for a place at `t` (0 to 1) from the second to the third.
fn catmull_rom(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [0.5 * (-t + 2.0 * t2 - t3), 0.5 * (2.0 - 5.0 * t2 + 3.0 * t3), 0.5 * (t + 4.0 * t2 - 3.0 * t3), 0.5 * (t3 - t2)]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    use super::*;

    const LENS: Lens = Lens {
        focal_length_px: 1000.0,
        principal_point_px: (320.5, 240.5),
        coefficients: [-0.25, 0.08, 0.001, -0.0015],
    };

    /// Numbers of OpenCV 5.0 (`projectPoints`), whose top left pixel has its centre at (0, 0).
    #[test]
    fn the_formula_is_that_of_opencv() {
        let cases = [
            ((0.0, 0.0), (11.751_039_999_999_92, 9.153_280_000_000_024)),
            ((100.0, 400.0), (103.647_022_399_999_97, 397.340_892_8)),
            ((639.0, 479.0), (626.582_250_362_860_6, 470.033_857_027_346_87)),
            ((320.0, 240.0), (320.0, 240.0)),
            ((600.0, 30.0), (591.224_59, 36.566_245_000_000_01)),
        ];
        for ((x, y), (expected_x, expected_y)) in cases {
            let (found_x, found_y) = LENS.distorted((x + 0.5, y + 0.5));
            assert!((found_x - 0.5 - expected_x).abs() < 1e-9 && (found_y - 0.5 - expected_y).abs() < 1e-9, "{x} {y}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 64, rng_seed: RngSeed::Fixed(9), ..ProptestConfig::default() })]

        #[test]
        fn a_pixel_comes_back_to_a_hundredth(
            x in 0.0..640.0, y in 0.0..480.0, k1 in -0.4..0.4, k2 in -0.2..0.2, p1 in -0.01..0.01, p2 in -0.01..0.01,
        ) {
            let lens = Lens { coefficients: [k1, k2, p1, p2], ..LENS };
            prop_assert!(lens.check((640, 480)).is_ok());
            let (back_x, back_y) = lens.undistorted(lens.distorted((x, y))).unwrap();
            prop_assert!((back_x - x).hypot(back_y - y) < 0.01, "{} {} for {} {}", back_x, back_y, x, y);
        }

        #[test]
        fn any_lens_is_taken_or_refused(focal in any::<f64>(), x in any::<f64>(), coefficients in any::<[f64; 4]>()) {
            let lens = Lens { focal_length_px: focal, principal_point_px: (x, 1.0), coefficients };
            let photo = Photo::unmarked(Plane::filled(5, 4, 0.5));
            let _ = (undistort(&photo, &lens), lens.undistorted((2.0, x)));
        }
    }

    /// A smooth pattern with waves of 16 pixels and longer.
    fn pattern(x: f64, y: f64) -> f64 {
        0.5 + 0.2 * (x / 2.6).sin() * (y / 4.0).cos() + 0.2 * (x / 30.0 + y / 45.0).sin()
    }

    fn lens(coefficients: [f64; 4]) -> Lens {
        Lens { focal_length_px: 300.0, principal_point_px: (83.0, 57.0), coefficients }
    }

    #[test]
    fn a_picture_that_a_lens_drew_comes_back_to_a_half_percent_of_its_contrast() {
        for coefficients in [[-0.25, 0.08, 0.001, -0.0015], [0.2, -0.05, -0.002, 0.001], [0.0; 4]] {
            let lens = lens(coefficients);
            let drawn = Plane::from_fn(160, 120, |x, y| {
                let (x, y) = lens.undistorted((x as f64 + 0.5, y as f64 + 0.5)).unwrap();
                pattern(x, y) as f32
            });
            let found = undistort(&Photo::unmarked(drawn), &lens).unwrap();
            for y in 3..117 {
                for x in 3..157 {
                    if found.photo.marks.at(x, y) == 0 {
                        let off = f64::from(found.photo.linear.at(x, y)) - pattern(x as f64 + 0.5, y as f64 + 0.5);
                        assert!(off.abs() < 0.005, "{coefficients:?} at {x} {y}: {off}");
                    }
                }
            }
            let outside = found.photo.marks.count(DARK);
            assert_eq!(outside > 0, coefficients[0] > 0.0, "a picture drawn larger was cut off");
            assert!(coefficients != [0.0; 4] || found.variance_share == 1.0);
        }
    }

    #[test]
    fn noise_after_resampling_is_what_the_weights_say() {
        let mut seed = 1u64;
        let mut noise = || {
            (0..12)
                .map(|_| {
                    seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    (seed >> 33) as f64 / (1u64 << 31) as f64
                })
                .sum::<f64>()
                - 6.0
        };
        let photo = Photo::unmarked(Plane::from_fn(200, 200, |_, _| noise() as f32));
        let found = undistort(&photo, &lens([-0.3, 0.1, 0.0, 0.0])).unwrap();
        let variance = found.photo.linear.data().iter().map(|light| f64::from(*light).powi(2)).sum::<f64>() / 40_000.0;
        assert!((variance / found.variance_share - 1.0).abs() < 0.03, "{variance}, {}", found.variance_share);
        assert!((0.5..0.9).contains(&found.variance_share), "{}", found.variance_share);
    }

    #[test]
    fn a_lens_that_folds_the_picture_is_refused_at_the_place() {
        let folding = Lens { coefficients: [-8.0, 0.0, 0.0, 0.0], ..LENS };
        assert!(matches!(folding.check((640, 480)), Err(DistortionError::Folds { .. })));
        assert!(folding.check((640, 480)).unwrap_err().to_string().contains("folds the picture over at pixel"));
        // The same lens is right near its axis.
        let near = Lens { principal_point_px: (50.0, 50.0), ..folding };
        assert!(near.check((100, 100)).is_ok());
    }

    #[test]
    fn a_clipped_pixel_spoils_what_is_made_of_it_and_no_other() {
        let mut photo = Photo::unmarked(Plane::filled(40, 40, 0.5));
        photo.marks.set(20, 20, CLIPPED);
        let found = undistort(&photo, &lens([-0.2, 0.0, 0.0, 0.0])).unwrap();
        let clipped = found.photo.marks.count(CLIPPED);
        assert!((1..=25).contains(&clipped), "{clipped}");
        assert!(found.photo.linear.data().iter().all(|light| (light - 0.5).abs() < 1e-6));
    }
}
