//! The photos on the grid on which arriving light is computed: pixel by pixel, or in blocks of pixels where the photos are
//! large, for light that arrives from other walls varies slowly.

use rayon::prelude::*;

use crate::separate::LightPhotos;
use crate::{Camera, Mask, Plane, Projection};

/// Photos of all lights in every colour on the grid.
pub(super) struct Grid {
    /// Pixels along a cell.
    pub step_px: usize,
    /// Cells that lie in the object by half or more.
    pub mask: Mask,
    /// The camera as if a cell were its pixel.
    pub camera: Camera,
    /// By light.
    pub lights: Vec<GridLight>,
}

/// One light.
pub(super) struct GridLight {
    /// By colour.
    pub colours: Vec<GridPhoto>,
    /// Albedo ratio by colour.
    pub beta: Vec<f64>,
}

/// One light in one colour.
#[derive(Clone)]
pub(super) struct GridPhoto {
    /// `N_c / alpha_c`.
    pub light: Plane,
    /// One over its variance; zero where no pixel of the cell is usable.
    pub precision: Plane,
}

impl Grid {
    /// The finest grid of at most about `cells` cells inside the mask.
    pub(super) fn new(lights: &[LightPhotos], mask: &Mask, camera: &Camera, cells: usize) -> Self {
        let step_px = ((mask.count() as f64 / cells as f64).sqrt().ceil() as usize).max(1);
        let count = cells_of(mask, step_px);
        let cell_area = (step_px * step_px) as u32;
        let grid_light = |light: &LightPhotos| GridLight {
            colours: (0..light.beta.len()).map(|c| grid_photo(light, c, mask, step_px)).collect(),
            beta: light.beta.to_vec(),
        };
        Self {
            step_px,
            mask: Mask::from_fn(count.width(), count.height(), |x, y| 2 * count.at(x, y) >= cell_area),
            camera: coarser(camera, step_px),
            lights: lights.iter().map(grid_light).collect(),
        }
    }

    /// Every so many-th cell along columns and rows alone.
    pub(super) fn thinned(&self, every: usize) -> Self {
        let photo = |photo: &GridPhoto| GridPhoto {
            light: photo.light.thinned(every),
            precision: photo.precision.thinned(every),
        };
        let light = |light: &GridLight| GridLight {
            colours: light.colours.iter().map(photo).collect(),
            beta: light.beta.clone(),
        };
        Self {
            step_px: self.step_px * every,
            mask: self.mask.thinned(every),
            camera: coarser(&self.camera, every),
            lights: self.lights.iter().map(light).collect(),
        }
    }

    /// Gives colours that are clipped or dark in a cell the light that the reference colour there suggests, or the other way round, by
    /// the `ratio` of each light and colour: it shines on other walls.
    pub(super) fn fill_unusable(&mut self, ratio: impl Fn(usize, usize) -> f32) {
        for (l, light) in self.lights.iter_mut().enumerate() {
            let (reference, others) = light.colours.split_at_mut(1);
            for (other, c) in others.iter_mut().zip(1..) {
                let (ratio, a, b) = (ratio(l, c), &mut reference[0], other);
                for cell in 0..a.precision.data().len() {
                    match (a.precision.data()[cell] > 0.0, b.precision.data()[cell] > 0.0) {
                        (true, false) => b.light.data_mut()[cell] = ratio * a.light.data()[cell],
                        (false, true) if ratio > 0.0 => a.light.data_mut()[cell] = b.light.data()[cell] / ratio,
                        _ => {}
                    }
                }
            }
        }
    }

    /// `(width, height)` in cells.
    pub(super) fn size(&self) -> (usize, usize) {
        self.mask.size()
    }
}

/// Pixels of the mask in each cell.
fn cells_of(mask: &Mask, step_px: usize) -> crate::Raster<u32> {
    let (width, height) = (mask.width().div_ceil(step_px), mask.height().div_ceil(step_px));
    let row = |row: usize| {
        let mut counts = vec![0; width];
        for y in row * step_px..((row + 1) * step_px).min(mask.height()) {
            for (cell, pixels) in counts.iter_mut().zip(mask.row(y).chunks(step_px)) {
                *cell += pixels.iter().filter(|inside| **inside).count() as u32;
            }
        }
        counts
    };
    let data: Vec<u32> = (0..height).into_par_iter().flat_map_iter(row).collect();
    crate::Raster::from_vec(width, height, data).unwrap_or_default()
}

/// Mean of a photo over the usable pixels of each cell; over all pixels of the mask where none is usable, for clipped light
/// shines on other walls too.
fn grid_photo(light: &LightPhotos, c: usize, mask: &Mask, step_px: usize) -> GridPhoto {
    let (photo, noise, alpha) = (light.photos[c], light.noise[c], light.alpha[c]);
    let (width, height) = (mask.width().div_ceil(step_px), mask.height().div_ceil(step_px));
    let row = |row: usize| {
        let mut sums = vec![(0.0_f64, 0u32, 0.0_f64, 0u32); width];
        for y in row * step_px..((row + 1) * step_px).min(mask.height()) {
            let pixels = mask.row(y).iter().zip(photo.linear.row(y)).zip(photo.marks.row(y)).enumerate();
            for (x, ((_, &value), &marks)) in pixels.filter(|(_, ((inside, value), _))| **inside && value.is_finite()) {
                let (usable, usable_count, any, any_count) = &mut sums[x / step_px];
                *any += f64::from(value);
                *any_count += 1;
                if marks == 0 {
                    *usable += f64::from(value);
                    *usable_count += 1;
                }
            }
        }
        sums.into_iter().map(move |(usable, usable_count, any, any_count)| {
            if usable_count == 0 {
                return ((any / f64::from(any_count.max(1)) / alpha) as f32, 0.0);
            }
            let mean = usable / f64::from(usable_count);
            let variance = noise.variance(mean).max(f64::MIN_POSITIVE) / alpha.powi(2) / f64::from(usable_count);
            ((mean / alpha) as f32, variance.recip().min(f64::from(f32::MAX)) as f32)
        })
    };
    let (light, precision): (Vec<f32>, Vec<f32>) = (0..height).into_par_iter().flat_map_iter(row).unzip();
    let plane = |data| Plane::from_vec(width, height, data).unwrap_or_default();
    GridPhoto { light: plane(light), precision: plane(precision) }
}

/// The camera whose pixels are blocks of these. Where the last column or row of blocks is not full, the middle of an orthographic
/// picture moves by less than half a block: only near lamps could notice.
fn coarser(camera: &Camera, step_px: usize) -> Camera {
    let step = step_px as f64;
    let projection = match camera.projection {
        Projection::Orthographic { mm_per_pixel } => {
            // Without a scale lengths are in pixels of the photo, which the depth does not depend on.
            Projection::Orthographic { mm_per_pixel: mm_per_pixel.map(|pitch| pitch * step) }
        }
        Projection::Perspective { focal_length_px, principal_point_px: (x, y), working_distance_mm } => {
            Projection::Perspective {
                focal_length_px: focal_length_px / step,
                principal_point_px: (x / step, y / step),
                working_distance_mm,
            }
        }
    };
    Camera { projection, size: (camera.size.0.div_ceil(step_px), camera.size.1.div_ceil(step_px)) }
}
