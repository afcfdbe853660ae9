//! A value for each pixel of a picture: the base of planes, masks and marks.

use std::sync::Arc;

use rayon::prelude::*;

/// `width` x `height` values, row by row, the top row first. A clone shares the values until one of the two is changed:
/// pictures of 24 megapixels are held by several results at once.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Raster<T> {
    width: usize,
    height: usize,
    data: Arc<Vec<T>>,
}

impl<T> Raster<T> {
    /// Takes rows of pixels as they are; `None` if `data` is not `width * height` long.
    pub fn from_vec(width: usize, height: usize, data: Vec<T>) -> Option<Self> {
        (data.len() == width * height).then(|| Self { width, height, data: Arc::new(data) })
    }

    /// A raster whose value at column `x`, row `y` is `value(x, y)`.
    pub fn from_fn(width: usize, height: usize, mut value: impl FnMut(usize, usize) -> T) -> Self {
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
    pub fn data(&self) -> &[T] {
        &self.data
    }

    /// Row `y`, left to right. Panics outside the raster, like a slice.
    pub fn row(&self, y: usize) -> &[T] {
        &self.data[y * self.width..(y + 1) * self.width]
    }
}

impl<T: Copy> Raster<T> {
    /// One value everywhere.
    pub fn filled(width: usize, height: usize, value: T) -> Self {
        Self { width, height, data: Arc::new(vec![value; width * height]) }
    }

    /// All values, row by row, to be changed in place.
    pub fn data_mut(&mut self) -> &mut [T] {
        let data: &mut Vec<T> = Arc::make_mut(&mut self.data);
        data
    }

    /// The values, without the shape.
    pub fn into_vec(self) -> Vec<T> {
        Arc::unwrap_or_clone(self.data)
    }

    /// A raster of this size in which every value fills a square of `step` x `step` pixels: from the cells of a coarse grid to
    /// pixels. The last row and column of cells reach as far as there are pixels.
    pub fn repeated(&self, step: usize, (width, height): (usize, usize)) -> Self {
        if self.data.is_empty() {
            return Self { width: 0, height: 0, data: Arc::default() };
        }
        let cell = |pixel: usize, cells: usize| (pixel / step.max(1)).min(cells - 1);
        Raster::from_fn(width, height, |x, y| self.at(cell(x, self.width), cell(y, self.height)))
    }

    /// The value at column `x`, row `y`. Panics outside the raster, like a slice.
    pub fn at(&self, x: usize, y: usize) -> T {
        debug_assert!(x < self.width);
        self.data[y * self.width + x]
    }

    /// Sets the value at column `x`, row `y`. Panics outside the raster, like a slice.
    pub fn set(&mut self, x: usize, y: usize, value: T) {
        debug_assert!(x < self.width);
        let width = self.width;
        self.data_mut()[y * width + x] = value;
    }
}

impl<T: Copy + Send + Sync> Raster<T> {
    /// The raster whose values are `of` these; computed on all cores.
    pub fn map<U: Send>(&self, of: impl Fn(T) -> U + Sync) -> Raster<U> {
        let data = self.data.par_iter().map(|&value| of(value)).collect();
        Raster { width: self.width, height: self.height, data: Arc::new(data) }
    }
}

impl<T: Copy> Raster<T> {
    /// Every so many-th pixel along columns and rows alone, the first of each among them.
    pub fn thinned(&self, every: usize) -> Self {
        if every <= 1 {
            return self.clone();
        }
        Self::from_fn(self.width.div_ceil(every), self.height.div_ceil(every), |x, y| {
            self.data[y * every * self.width + x * every]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_raster_refuses_data_of_another_length() {
        assert!(Raster::from_vec(3, 2, vec![0.0; 5]).is_none());
    }

    #[test]
    fn cells_are_repeated_up_to_the_size_of_the_pixels() {
        let cells = Raster::from_vec(2, 2, vec![1, 2, 3, 4]).unwrap();
        let pixels = cells.repeated(2, (5, 3));
        assert_eq!(pixels.size(), (5, 3));
        assert_eq!(pixels.data(), [1, 1, 2, 2, 2, 1, 1, 2, 2, 2, 3, 3, 4, 4, 4]);
        assert_eq!(cells.repeated(1, (2, 2)), cells);
        assert_eq!(Raster::<u8>::default().repeated(2, (4, 4)).size(), (0, 0));
    }

    #[test]
    fn a_clone_keeps_its_values_when_the_original_changes() {
        let mut original = Raster::filled(3, 2, 1.0);
        let clone = original.clone();
        original.set(1, 1, 5.0);
        assert_eq!((original.at(1, 1), clone.at(1, 1)), (5.0, 1.0));
    }

    #[test]
    fn a_clone_shares_its_values_until_a_change() {
        let mut original = Raster::filled(3, 2, 1u8);
        let clone = original.clone();
        assert!(std::ptr::eq(original.data(), clone.data()));
        original.set(0, 0, 2);
        assert!(!std::ptr::eq(original.data(), clone.data()));
    }
}
