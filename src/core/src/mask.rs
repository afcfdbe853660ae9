//! Which pixels belong to the object.

/// A yes or no for each pixel, row by row, the top row first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mask {
    width: usize,
    height: usize,
    data: Vec<bool>,
}

impl Mask {
    /// A mask with one answer everywhere.
    pub fn filled(width: usize, height: usize, value: bool) -> Self {
        Self { width, height, data: vec![value; width * height] }
    }

    /// Takes rows of answers as they are; `None` if `data` is not `width * height` long.
    pub fn from_vec(width: usize, height: usize, data: Vec<bool>) -> Option<Self> {
        (data.len() == width * height).then_some(Self { width, height, data })
    }

    /// A mask whose answer at column `x`, row `y` is `inside(x, y)`.
    pub fn from_fn(width: usize, height: usize, mut inside: impl FnMut(usize, usize) -> bool) -> Self {
        let mut data = Vec::with_capacity(width * height);
        for y in 0..height {
            data.extend((0..width).map(|x| inside(x, y)));
        }
        Self { width, height, data }
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

    /// All answers, row by row.
    pub fn data(&self) -> &[bool] {
        &self.data
    }

    /// All answers, row by row, to be changed in place.
    pub fn data_mut(&mut self) -> &mut [bool] {
        &mut self.data
    }

    /// The answer at column `x`, row `y`. Panics outside the mask, like a slice.
    pub fn at(&self, x: usize, y: usize) -> bool {
        debug_assert!(x < self.width);
        self.data[y * self.width + x]
    }

    /// How many pixels are inside.
    pub fn count(&self) -> usize {
        self.data.iter().filter(|&&inside| inside).count()
    }
}
