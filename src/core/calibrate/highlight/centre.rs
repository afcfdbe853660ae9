//! The centre of a bright spot, to a fraction of a pixel.

use crate::Plane;
use rayon::prelude::*;

/// The centre of a spot whose core has `core_px` pixels, and its standard deviation in each axis, in pixels of the plane.
pub(super) fn centre_of(spot: &[(usize, usize)], light: &Plane, core_px: usize) -> ((f64, f64), f64) {
    if core_px < LARGE_CORE_PX { light_centre(spot, light) } else { top_centre(spot, light, core_px) }
}

/// Cores of fewer pixels are centred on all their light; larger ones are saturated or streaked and are centred on their
/// top.
const LARGE_CORE_PX: usize = 30;

/// Centre of all light of a small spot and its surroundings, down to a tenth of its peak. Where in its pixel a lamp
/// smaller than a pixel lies is not known: a uniform error of half a pixel either way.
fn light_centre(spot: &[(usize, usize)], light: &Plane) -> ((f64, f64), f64) {
    const PIXEL_SD: f64 = 0.289;
    let peak = spot.iter().map(|&(x, y)| light.at(x, y)).fold(0.0, f32::max);
    let xs = || spot.iter().map(|&(x, _)| x);
    let ys = || spot.iter().map(|&(_, y)| y);
    let columns = xs().min().unwrap_or(0).saturating_sub(2)..(xs().max().unwrap_or(0) + 3).min(light.width());
    let rows = ys().min().unwrap_or(0).saturating_sub(2)..(ys().max().unwrap_or(0) + 3).min(light.height());
    let around = rows.flat_map(|y| columns.clone().map(move |x| (x, y)));
    let bright = around.filter(|&(x, y)| light.at(x, y) >= 0.1 * peak);
    let centre = centroid(bright.map(|(x, y)| (x, y, f64::from(light.at(x, y)))));
    (centre, PIXEL_SD + 0.05 * (spot.len() as f64).sqrt())
}

/// Centre of the top of a large spot, smoothed by a third of its core's radius. What the choice of the level changes,
/// and a twentieth of the core's radius, are its error.
fn top_centre(spot: &[(usize, usize)], light: &Plane, core_px: usize) -> ((f64, f64), f64) {
    let radius = (core_px as f64 / std::f64::consts::PI).sqrt();
    let sigma = radius / 3.0;
    let smooth: Vec<(usize, usize, f64)> =
        spot.par_iter().map(|&(x, y)| (x, y, smoothed(light, x, y, sigma))).collect();
    let peak = smooth.iter().map(|&(.., v)| v).fold(0.0, f64::max);
    let at_level =
        |level: f64| centroid(smooth.iter().filter(|&&(.., v)| v >= level * peak).map(|&(x, y, _)| (x, y, 1.0)));
    let centre = at_level(0.92);
    let shifts = [0.8, 0.97].map(|level| (at_level(level).0 - centre.0).hypot(at_level(level).1 - centre.1));
    let spread = shifts.iter().sum::<f64>() / 2.0;
    (centre, spread.hypot(0.05 * radius).hypot(0.1))
}

fn centroid(pixels: impl Iterator<Item = (usize, usize, f64)>) -> (f64, f64) {
    let (x, y, weight) = pixels.fold((0.0, 0.0, 0.0), |(sx, sy, sw), (x, y, w)| {
        (sx + w * (x as f64 + 0.5), sy + w * (y as f64 + 0.5), sw + w)
    });
    (x / weight, y / weight)
}

fn smoothed(light: &Plane, x: usize, y: usize, sigma: f64) -> f64 {
    let reach = (3.0 * sigma).ceil() as usize;
    let (mut sum, mut weight) = (0.0, 0.0);
    for ny in y.saturating_sub(reach)..(y + reach + 1).min(light.height()) {
        for nx in x.saturating_sub(reach)..(x + reach + 1).min(light.width()) {
            let squared = nx.abs_diff(x).pow(2) + ny.abs_diff(y).pow(2);
            let w = (-0.5 * squared as f64 / (sigma * sigma)).exp();
            sum += w * f64::from(light.at(nx, ny));
            weight += w;
        }
    }
    sum / weight
}
