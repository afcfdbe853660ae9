//! A photo small enough to be kept and to be judged in many ways.

use rayon::prelude::*;

use crate::image::photo::CLIPPED;
use crate::{Mask, Photo, Plane};

/// Cells along the longer side: finer than the shape of an object, coarse enough to average noise away.
const MAX_SIDE: usize = 64;

/// A photo's means over cells of pixels, around the object.
#[derive(Clone, Debug, PartialEq)]
pub struct SmallPhoto {
    /// Mean linear light.
    pub light: Plane,
    /// The cells all of whose pixels belong to the object, and none of which is clipped.
    pub whole: Mask,
    /// Whether the object's pixels were known.
    pub is_masked: bool,
}

impl SmallPhoto {
    /// Of a photo; without a mask all of it counts. `None` for a mask without a pixel.
    pub fn of(photo: &Photo, mask: Option<&Mask>) -> Option<Self> {
        let mask = mask.filter(|mask| mask.size() == photo.linear.size());
        let [left, top, width, height] = region(photo.linear.size(), mask)?;
        let step = width.max(height).div_ceil(MAX_SIDE).max(1);
        let (columns, rows) = ((width / step).max(1), (height / step).max(1));
        let cell = |index: usize| {
            let (x, y) = (left + index % columns * step, top + index / columns * step);
            let pixels =
                (y..(y + step).min(top + height)).flat_map(|y| (x..(x + step).min(left + width)).map(move |x| (x, y)));
            let is_good = |x, y| mask.is_none_or(|mask| mask.at(x, y)) && photo.marks.at(x, y) & CLIPPED == 0;
            let add = |(sum, count, good), (x, y)| (sum + photo.linear.at(x, y), count + 1, good && is_good(x, y));
            let (sum, count, good) = pixels.fold((0.0, 0, true), add);
            (sum / count.max(1) as f32, good)
        };
        let (light, whole) = (0..columns * rows).into_par_iter().map(cell).unzip();
        let (light, whole) = (Plane::from_vec(columns, rows, light)?, Mask::from_vec(columns, rows, whole)?);
        Some(Self { light, whole, is_masked: mask.is_some() })
    }
}

/// Left, top, width and height of the pixels around a mask with a margin, where the outline lies; of all without one.
pub(super) fn region((width, height): (usize, usize), mask: Option<&Mask>) -> Option<[usize; 4]> {
    let Some(mask) = mask else { return Some([0, 0, width, height]) };
    let row_has = |y: &usize| mask.row(*y).contains(&true);
    let (top, bottom) = ((0..height).find(row_has)?, (0..height).rev().find(row_has)?);
    let rows = || (top..=bottom).map(|y| mask.row(y));
    let left = rows().filter_map(|row| row.iter().position(|inside| *inside)).min()?;
    let right = rows().filter_map(|row| row.iter().rposition(|inside| *inside)).max()?;
    let margin = (right - left).max(bottom - top) / 16 + 4;
    let (left, top) = (left.saturating_sub(margin), top.saturating_sub(margin));
    Some([left, top, (right + 1 + margin).min(width) - left, (bottom + 1 + margin).min(height) - top])
}
