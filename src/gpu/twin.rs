//! The shader in plain Rust: what thumbnails are drawn with, and what the tests hold the shader to.

use std::sync::Arc;

use firstbounce_core::{Marks, Plane};
use rayon::prelude::*;

use super::colour::{colour, zebra};
use super::drawing::{Drawing, Sampling};
use super::pyramid::{halve, level_size};
use super::source::CanvasMarks;

/// A drawing with the copies of its planes that it reads.
pub struct Twin<'a> {
    drawing: Drawing<'a>,
    sampling: Sampling,
    planes: Vec<Arc<Plane>>,
    marks: Option<CanvasMarks>,
    mask: Option<CanvasMarks>,
}

impl<'a> Twin<'a> {
    /// Prepares the drawing.
    pub fn new(drawing: Drawing<'a>) -> Self {
        let source = drawing.source;
        let sampling = drawing.placement.sampling(source.size(), 0);
        let level = sampling.level;
        Self {
            drawing,
            sampling,
            planes: source.planes.iter().map(|plane| reduced_plane(&plane.plane, level)).collect(),
            marks: source.marks.as_ref().map(|marks| reduced_marks(marks, level)),
            mask: source.mask.as_ref().map(|mask| reduced_marks(mask, level)),
        }
    }

    /// The colour at a position of the target in physical pixels (centres at .5), 0 to 1 in gamma space, and alpha.
    pub fn pixel(&self, target_px: [f32; 2]) -> [f32; 4] {
        let [red, green, blue] = self.opaque_pixel(target_px);
        [red, green, blue, 1.0]
    }

    /// The numbers at a position of the target; `None` outside the picture and where there is no value.
    pub fn values(&self, target_px: [f32; 2]) -> Option<[f32; 3]> {
        let texel = self.texel(target_px)?;
        let mut planes = self.planes.iter();
        self.drawing.source.values(|_| planes.next().map_or(f32::NAN, |plane| self.sample(plane, texel)))
    }

    /// `width * height` pixels of the target from its top left corner, four sRGB bytes each.
    pub fn picture(&self, width: usize, height: usize) -> Vec<u8> {
        let mut bytes = vec![0; 4 * width * height];
        bytes.par_chunks_mut(4 * width.max(1)).enumerate().for_each(|(y, row)| {
            for (x, pixel) in row.chunks_exact_mut(4).enumerate() {
                let colour = self.pixel([x as f32 + 0.5, y as f32 + 0.5]);
                pixel.copy_from_slice(&colour.map(|channel| (channel.clamp(0.0, 1.0) * 255.0).round() as u8));
            }
        });
        bytes
    }

    fn opaque_pixel(&self, target_px: [f32; 2]) -> [f32; 3] {
        let Drawing { source, display, background, .. } = self.drawing;
        let (Some(texel), Some(values)) = (self.texel(target_px), self.values(target_px)) else { return background };
        let mut pixel = colour(values, source.kind(), display);
        let bits = self.marks.as_ref().map_or(0, |marks| mark_at(marks, texel));
        for (bit, tint) in display.tints.iter().enumerate() {
            if bits >> bit & 1 == 1 {
                pixel = mix(pixel, tint.colour.map(|channel| f32::from(channel) / 255.0), tint.strength);
            }
        }
        if self.mask.as_ref().is_some_and(|mask| mark_at(mask, texel) == 0) {
            pixel = mix(pixel, background, display.mask_dimming);
        }
        zebra(values, source.kind(), display, target_px).unwrap_or(pixel)
    }

    /// The position in texels of the copy that is read, `None` outside the picture.
    fn texel(&self, target_px: [f32; 2]) -> Option<[f32; 2]> {
        let (width, height) = self.drawing.source.size();
        let placement = self.drawing.placement;
        let x = (target_px[0] - placement.origin_px[0]) / placement.scale;
        let y = (target_px[1] - placement.origin_px[1]) / placement.scale;
        let texel_size = (self.sampling.level as f32).exp2();
        (x >= 0.0 && y >= 0.0 && x < width as f32 && y < height as f32).then(|| [x / texel_size, y / texel_size])
    }

    /// Blends four texels, or takes the one under the position.
    fn sample(&self, plane: &Plane, [x, y]: [f32; 2]) -> f32 {
        let at = |x: f32, y: f32| {
            let column = (x.max(0.0) as usize).min(plane.width() - 1);
            plane.at(column, (y.max(0.0) as usize).min(plane.height() - 1))
        };
        if self.sampling.nearest {
            return at(x, y);
        }
        let (left, top) = ((x - 0.5).floor(), (y - 0.5).floor());
        let (u, v) = (x - 0.5 - left, y - 0.5 - top);
        let above = at(left, top) * (1.0 - u) + at(left + 1.0, top) * u;
        let below = at(left, top + 1.0) * (1.0 - u) + at(left + 1.0, top + 1.0) * u;
        above * (1.0 - v) + below * v
    }
}

fn mark_at(marks: &CanvasMarks, [x, y]: [f32; 2]) -> u8 {
    marks.at((x as usize).min(marks.marks.width() - 1), (y as usize).min(marks.marks.height() - 1))
}

fn mix(from: [f32; 3], to: [f32; 3], strength: f32) -> [f32; 3] {
    std::array::from_fn(|channel| from[channel] * (1.0 - strength) + to[channel] * strength)
}

fn reduced_plane(plane: &Arc<Plane>, level: u32) -> Arc<Plane> {
    (0..level).fold(plane.clone(), |larger, _| {
        let (width, height) = level_size(larger.size(), 1);
        let smaller = Plane::from_vec(width, height, halve(larger.size(), larger.data()));
        smaller.map_or(larger, Arc::new)
    })
}

fn reduced_marks(marks: &CanvasMarks, level: u32) -> CanvasMarks {
    let reduced = (0..level).fold(marks.marks.clone(), |larger, _| {
        let (width, height) = level_size(larger.size(), 1);
        Marks::from_vec(width, height, halve(larger.size(), larger.data())).unwrap_or(larger)
    });
    CanvasMarks { key: marks.key, marks: reduced }
}
