//! One channel of a picture.

use super::raster::Raster;

/// A planar picture of f32 values.
pub type Plane = Raster<f32>;

impl Plane {
    /// The value at a continuous position in pixels (pixel centres at .5), bilinear, clamped at the border.
    pub fn sample(&self, x_px: f64, y_px: f64) -> f64 {
        let (width, height) = self.size();
        let x = (x_px - 0.5).clamp(0.0, width as f64 - 1.0);
        let y = (y_px - 0.5).clamp(0.0, height as f64 - 1.0);
        let (x0, y0) = (x.floor() as usize, y.floor() as usize);
        let (x1, y1) = ((x0 + 1).min(width - 1), (y0 + 1).min(height - 1));
        let (u, v) = (x - x0 as f64, y - y0 as f64);
        let at = |x, y| f64::from(self.at(x, y));
        (at(x0, y0) * (1.0 - u) + at(x1, y0) * u) * (1.0 - v) + (at(x0, y1) * (1.0 - u) + at(x1, y1) * u) * v
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sampling_a_ramp_returns_the_ramp() {
        let ramp = Plane::from_fn(8, 6, |x, y| 2.0 * (x as f32 + 0.5) - (y as f32 + 0.5));
        for (x, y) in [(0.5, 0.5), (3.25, 2.75), (7.5, 5.5), (1.0, 4.0)] {
            assert!((ramp.sample(x, y) - (2.0 * x - y)).abs() < 1e-6);
        }
    }
}
