//! Smaller and smaller copies of a picture, so that a picture shown small is averaged and not a pick of its pixels.

use rayon::prelude::*;

/// The smallest copy has at most this many pixels on its longer side.
const SMALLEST_SIDE: usize = 32;

/// Copies up to this many pixels are made by the calling thread alone. On the UI thread that is quicker than waiting until the
/// other cores are done with long work.
const ALONE_PIXELS: usize = 1 << 18;

/// What a texture may hold.
pub trait Texel: Copy + Send + Sync + bytemuck::Pod {
    /// One pixel of the smaller copy for four of the larger.
    fn merge(four: [Self; 4]) -> Self;
}

impl Texel for f32 {
    /// The mean of the pixels that have a value.
    fn merge(four: [Self; 4]) -> Self {
        let sum: f32 = four.iter().sum();
        if sum.is_finite() {
            return 0.25 * sum;
        }
        let finite = four.iter().filter(|value| value.is_finite());
        finite.clone().sum::<f32>() / finite.count() as f32
    }
}

impl Texel for u8 {
    /// All their bits: one clipped pixel is enough to be warned of.
    fn merge(four: [Self; 4]) -> Self {
        four[0] | four[1] | four[2] | four[3]
    }
}

/// How many copies there are, the picture itself included.
pub fn level_count((width, height): (usize, usize)) -> u32 {
    let mut side = width.max(height);
    let mut levels = 1;
    while side > SMALLEST_SIDE {
        side /= 2;
        levels += 1;
    }
    levels
}

/// The size of a copy: halves, rounded down, of the one before it.
pub fn level_size((width, height): (usize, usize), level: u32) -> (usize, usize) {
    ((width >> level).max(1), (height >> level).max(1))
}

/// Averages blocks of two by two pixels; an odd last row or column is left out. Pixel `(x, y)` of the result covers `(2x, 2y)`
/// to `(2x + 1, 2y + 1)`.
pub fn halve<T: Texel>(size: (usize, usize), data: &[T]) -> Vec<T> {
    let (width, height) = size;
    let half = level_size(size, 1);
    let mut result = vec![T::zeroed(); half.0 * half.1];
    let fill = |(y, row): (usize, &mut [T])| {
        let above = &data[2 * y * width..][..width];
        let below = &data[(2 * y + 1).min(height - 1) * width..][..width];
        for (x, pixel) in row.iter_mut().enumerate() {
            let (left, right) = (2 * x, (2 * x + 1).min(width - 1));
            *pixel = T::merge([above[left], above[right], below[left], below[right]]);
        }
    };
    if result.len() <= ALONE_PIXELS {
        result.chunks_mut(half.0).enumerate().for_each(fill);
    } else {
        result.par_chunks_mut(half.0).enumerate().for_each(fill);
    }
    result
}

/// Every copy but the picture itself: levels 1, 2, and so on.
pub fn smaller_copies<T: Texel>(size: (usize, usize), data: &[T]) -> Vec<Vec<T>> {
    let mut copies: Vec<Vec<T>> = Vec::new();
    for level in 1..level_count(size) {
        let copy = halve(level_size(size, level - 1), copies.last().map_or(data, Vec::as_slice));
        copies.push(copy);
    }
    copies
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_keep_the_mean_of_an_even_picture() {
        let data: Vec<f32> = (0..64 * 128).map(|i| (i * 7919 % 101) as f32).collect();
        let mean = |values: &[f32]| values.iter().map(|&v| f64::from(v)).sum::<f64>() / values.len() as f64;
        let copies = smaller_copies((64, 128), &data);
        assert_eq!(copies.len(), 2);
        assert_eq!(copies[1].len(), 16 * 32);
        assert!((mean(&copies[1]) - mean(&data)).abs() < 1e-3);
    }

    #[test]
    fn pixels_without_a_value_do_not_spoil_their_neighbours() {
        assert_eq!(halve((2, 2), &[1.0, f32::NAN, 3.0, f32::INFINITY]), vec![2.0]);
        assert!(halve((2, 2), &[f32::NAN; 4])[0].is_nan());
    }

    #[test]
    fn odd_and_single_rows_are_halved_too() {
        assert_eq!(halve((3, 1), &[1.0_f32, 3.0, 9.0]), vec![2.0]);
        assert_eq!(halve((2, 2), &[0_u8, 1, 2, 0]), vec![3]);
    }
}
