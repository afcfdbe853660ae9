//! Edge points of a photo, at a size at which a ball can be found fast.

use crate::Plane;
use crate::interval::quantile;
use rayon::prelude::*;

/// A rectangle of pixels in the photos and the whole number of pixels that one working pixel spans.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub x0: usize,
    pub y0: usize,
    pub width: usize,
    pub height: usize,
    pub scale: usize,
}

impl Window {
    /// The part of an image of `size` between the given columns and rows, reduced so that no side exceeds `max_side`.
    pub fn new(x: std::ops::Range<usize>, y: std::ops::Range<usize>, max_side: usize) -> Self {
        let scale = x.len().max(y.len()).div_ceil(max_side).max(1);
        Self { x0: x.start, y0: y.start, width: x.len() / scale, height: y.len() / scale, scale }
    }

    /// A working position in pixels of the photo.
    pub fn to_photo(self, (x, y): (f64, f64)) -> (f64, f64) {
        (x * self.scale as f64 + self.x0 as f64, y * self.scale as f64 + self.y0 as f64)
    }
}

/// A point on an edge: its position in working pixels and the unit vector toward the brighter side.
#[derive(Clone, Copy, Debug)]
pub(super) struct EdgePoint {
    pub x: f64,
    pub y: f64,
    pub uphill: (f64, f64),
    strength: f64,
}

/// Light that counts as white, 1 after this: the 99.5th percentile, so that a highlight does not hide a dark ball.
pub(super) fn white_of(image: &Plane) -> f64 {
    let step = (image.data().len() / 100_000).max(1);
    let mut sample: Vec<f64> =
        image.data().iter().step_by(step).map(|&v| f64::from(v)).filter(|v| v.is_finite()).collect();
    quantile(&mut sample, 0.995).max(1e-6)
}

/// A square root evens out the noise of photons and lets the edge of a dark ball count; the offset keeps it finite at
/// zero.
pub(super) fn evened(linear: f64, white: f64) -> f64 {
    const FLOOR: f64 = 0.003;
    ((linear / white).clamp(0.0, 1.0) + FLOOR).sqrt()
}

/// The mean over the photos of their evened light, box-averaged down to the working size.
pub(super) fn working_image(images: &[&Plane], window: Window) -> Plane {
    let whites: Vec<f64> = images.iter().map(|image| white_of(image)).collect();
    let scale = window.scale;
    let weight = 1.0 / (images.len() * scale * scale) as f64;
    let mut data = vec![0.0f32; window.width * window.height];
    data.par_chunks_mut(window.width.max(1)).enumerate().for_each(|(row, out)| {
        for (image, &white) in images.iter().zip(&whites) {
            for y in 0..scale {
                let line = &image.row(window.y0 + row * scale + y)[window.x0..];
                for (value, block) in out.iter_mut().zip(line.chunks_exact(scale)) {
                    let sum: f64 = block.iter().map(|&v| evened(f64::from(v), white)).sum();
                    *value += (sum * weight) as f32;
                }
            }
        }
    });
    Plane::from_vec(window.width, window.height, data).unwrap_or_else(|| Plane::filled(0, 0, 0.0))
}

/// The strongest edge points of a working image, at most `count`: maxima of the gradient across the edge (Canny 1986),
/// above five times the noise of the gradient.
pub(super) fn edge_points(image: &Plane, count: usize) -> Vec<EdgePoint> {
    let (width, height) = image.size();
    if width < 8 || height < 8 {
        return Vec::new();
    }
    let smooth = smoothed(&smoothed(image));
    let slope = |x: usize, y: usize| {
        let gx = f64::from(smooth.at(x + 1, y)) - f64::from(smooth.at(x - 1, y));
        let gy = f64::from(smooth.at(x, y + 1)) - f64::from(smooth.at(x, y - 1));
        (gx / 2.0, gy / 2.0)
    };
    let inside = |x: usize, y: usize| x > 0 && y > 0 && x + 1 < width && y + 1 < height;
    let strength =
        Plane::from_fn(
            width,
            height,
            |x, y| {
                if inside(x, y) { slope(x, y).0.hypot(slope(x, y).1) as f32 } else { 0.0 }
            },
        );
    let mut sample: Vec<f64> = strength.data().iter().map(|&v| f64::from(v)).collect();
    let noise = quantile(&mut sample, 0.5) / 1.177;
    let threshold = (5.0 * noise).min(0.1 * quantile(&mut sample, 0.999)).max(0.002);

    let mut points: Vec<EdgePoint> = (2..height - 2)
        .into_par_iter()
        .flat_map_iter(|y| {
            let (strength, slope) = (&strength, &slope);
            (2..width - 2).filter_map(move |x| {
                let here = f64::from(strength.at(x, y));
                if here < threshold {
                    return None;
                }
                let (gx, gy) = slope(x, y);
                let uphill = (gx / here, gy / here);
                let (cx, cy) = (x as f64 + 0.5, y as f64 + 0.5);
                let ahead = strength.sample(cx + uphill.0, cy + uphill.1);
                let behind = strength.sample(cx - uphill.0, cy - uphill.1);
                (here >= ahead && here > behind).then(|| {
                    let offset = 0.5 * (ahead - behind) / (2.0 * here - ahead - behind).max(1e-12);
                    EdgePoint { x: cx + offset * uphill.0, y: cy + offset * uphill.1, uphill, strength: here }
                })
            })
        })
        .collect();
    points.sort_by(|a, b| b.strength.total_cmp(&a.strength));
    points.truncate(count);
    points
}

/// One pass of the binomial filter 1 2 1 along rows and columns, standard deviation 0.7 px.
fn smoothed(image: &Plane) -> Plane {
    let (width, height) = image.size();
    let along_rows = Plane::from_fn(width, height, |x, y| {
        let row = image.row(y);
        (row[x.saturating_sub(1)] + 2.0 * row[x] + row[(x + 1).min(width - 1)]) / 4.0
    });
    Plane::from_fn(width, height, |x, y| {
        let (above, below) = (along_rows.at(x, y.saturating_sub(1)), along_rows.at(x, (y + 1).min(height - 1)));
        (above + 2.0 * along_rows.at(x, y) + below) / 4.0
    })
}
