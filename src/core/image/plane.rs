//! One channel of a picture.

use std::sync::Arc;

/// A planar picture of `width` x `height` f32 values, row by row, the top row first. A clone shares the values until one
/// of the two is changed: pictures of 24 megapixels are held by several results at once.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    width: usize,
    height: usize,
    data: Arc<Vec<f32>>,
}

impl Plane {
    /// A plane of one value everywhere.
    pub fn filled(width: usize, height: usize, value: f32) -> Self {
        Self { width, height, data: Arc::new(vec![value; width * height]) }
    }

    /// Takes rows of pixels as they are; `None` if `data` is not `width * height` long.
    pub fn from_vec(width: usize, height: usize, data: Vec<f32>) -> Option<Self> {
        (data.len() == width * height).then(|| Self { width, height, data: Arc::new(data) })
    }

    /// A plane whose value at column `x`, row `y` is `value(x, y)`.
    pub fn from_fn(width: usize, height: usize, mut value: impl FnMut(usize, usize) -> f32) -> Self {
        let mut data = Vec::with_capacity(width * height);
        for y in 0..height {
            data.extend((0..width).map(|x| value(x, y)));
        }
        Self { width, height, data: Arc::new(data) }
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// `(width, height)` in pixels.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// All values, row by row.
    pub fn data(&self) -> &[f32] {
        &self.data
    }

    /// All values, row by row, to be changed in place.
    pub fn data_mut(&mut self) -> &mut [f32] {
        let data: &mut Vec<f32> = Arc::make_mut(&mut self.data);
        data
    }

    /// The values, without the shape.
    pub fn into_vec(self) -> Vec<f32> {
        Arc::unwrap_or_clone(self.data)
    }

    /// The value at column `x`, row `y`. Panics outside the plane, like a slice.
    pub fn at(&self, x: usize, y: usize) -> f32 {
        debug_assert!(x < self.width);
        self.data[y * self.width + x]
    }

    /// Sets the value at column `x`, row `y`. Panics outside the plane, like a slice.
    pub fn set(&mut self, x: usize, y: usize, value: f32) {
        debug_assert!(x < self.width);
        let width = self.width;
        self.data_mut()[y * width + x] = value;
    }

    /// Row `y`, left to right.
    pub fn row(&self, y: usize) -> &[f32] {
        &self.data[y * self.width..(y + 1) * self.width]
    }

    /// The value at a continuous position in pixels (pixel centres at .5), bilinear, clamped at the border.
    pub fn sample(&self, x_px: f64, y_px: f64) -> f64 {
        let x = (x_px - 0.5).clamp(0.0, self.width as f64 - 1.0);
        let y = (y_px - 0.5).clamp(0.0, self.height as f64 - 1.0);
        let (x0, y0) = (x.floor() as usize, y.floor() as usize);
        let (x1, y1) = ((x0 + 1).min(self.width - 1), (y0 + 1).min(self.height - 1));
        let (u, v) = (x - x0 as f64, y - y0 as f64);
        let at = |x, y| f64::from(self.at(x, y));
        (at(x0, y0) * (1.0 - u) + at(x1, y0) * u) * (1.0 - v) + (at(x0, y1) * (1.0 - u) + at(x1, y1) * u) * v
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_refuses_data_of_another_length() {
        assert!(Plane::from_vec(3, 2, vec![0.0; 5]).is_none());
    }

    #[test]
    fn a_clone_keeps_its_values_when_the_original_changes() {
        let mut original = Plane::filled(3, 2, 1.0);
        let clone = original.clone();
        original.set(1, 1, 5.0);
        assert_eq!((original.at(1, 1), clone.at(1, 1)), (5.0, 1.0));
    }

    #[test]
    fn sampling_a_ramp_returns_the_ramp() {
        let ramp = Plane::from_fn(8, 6, |x, y| 2.0 * (x as f32 + 0.5) - (y as f32 + 0.5));
        for (x, y) in [(0.5, 0.5), (3.25, 2.75), (7.5, 5.5), (1.0, 4.0)] {
            assert!((ramp.sample(x, y) - (2.0 * x - y)).abs() < 1e-6);
        }
    }
}
