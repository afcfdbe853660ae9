//! The light on a mirror ball: all of it, and what one lamp adds to it.

use super::SEEN_SHARE;
use crate::interval::{quantile, robust_sd};
use crate::sphere::Ball;
use crate::{Photo, Plane};

/// As many other lamps show what lasts; of more, some spread over all of them are taken.
const MAX_COMPARED: usize = 8;

/// A reflection of something that each lamp lights from elsewhere moves by less than this many radii of the ball.
const NEARBY_RADII: f64 = 0.04;

/// The square around the ball with everything off the ball black.
pub(super) struct BallView<'a> {
    /// Column and row of the square's top left pixel in the photo.
    pub origin: (usize, usize),
    /// The photo.
    pub light: Plane,
    /// The photo less the least light that all other lamps' photos show in a pixel or next to it: what is reflected under
    /// every lamp vanishes, also where it moved by a pixel.
    pub own: Plane,
    lasting: Plane,
    /// The photos of other lamps that are compared.
    others: Vec<&'a Photo>,
    nearby_px: usize,
}

impl<'a> BallView<'a> {
    pub fn new(photo: &Photo, other_lamps: &[&'a Photo], ball: &Ball, max_radii: f64) -> Self {
        let circle = ball.circle();
        let ((cx, cy), r) = (circle.centre_px, circle.radius_px);
        let size = photo.linear.size();
        let origin = ((cx - r).max(0.0) as usize, (cy - r).max(0.0) as usize);
        let end = |centre: f64, side: usize| ((centre + r).ceil() as usize).min(side);
        let (width, height) = (end(cx, size.0) - origin.0, end(cy, size.1) - origin.1);
        let value = |plane: &Plane, x: usize, y: usize| {
            let (x, y) = (x + origin.0, y + origin.1);
            let on_ball = circle.radii_from_centre(x as f64 + 0.5, y as f64 + 0.5) <= max_radii;
            let value = plane.at(x, y);
            if on_ball && value.is_finite() { value } else { 0.0 }
        };
        let light = Plane::from_fn(width, height, |x, y| value(&photo.linear, x, y));
        let step = other_lamps.len().div_ceil(MAX_COMPARED).max(1);
        let others: Vec<&Photo> = other_lamps.iter().step_by(step).copied().collect();
        let least = |x: usize, y: usize| others.iter().map(|other| value(&other.linear, x, y)).reduce(f32::min);
        let least = Plane::from_fn(width, height, |x, y| least(x, y).unwrap_or(0.0));
        let lasting = Plane::from_fn(width, height, |x, y| largest_around(&least, x, y));
        let own = Plane::from_fn(width, height, |x, y| (light.at(x, y) - lasting.at(x, y)).max(0.0));
        let nearby_px = ((NEARBY_RADII * r) as usize).max(1);
        Self { origin, light, own, lasting, others, nearby_px }
    }

    /// Whether most other lamps make a spot of this peak near a pixel of the square too: a reflection of something that
    /// they all light, or that moved a little.
    pub fn is_nearby_too(&self, (x, y): (usize, usize), peak: f64) -> bool {
        let (width, height) = self.light.size();
        let reach = self.nearby_px;
        let is_bright = |other: &&&Photo| {
            let mut rows = y.saturating_sub(reach)..(y + reach + 1).min(height);
            rows.any(|y| {
                let mut columns = x.saturating_sub(reach)..(x + reach + 1).min(width);
                columns.any(|x| {
                    let added = other.linear.at(x + self.origin.0, y + self.origin.1) - self.lasting.at(x, y);
                    f64::from(added) > SEEN_SHARE * peak
                })
            })
        };
        2 * self.others.iter().filter(is_bright).count() > self.others.len()
    }

    /// Whether light that other lamps show too lies against a spot, so that part of the spot may be hidden by it.
    pub fn is_beside_lasting(&self, spot: &[(usize, usize)], peak: f64) -> bool {
        let (width, height) = self.light.size();
        let lasts = |x: usize, y: usize| {
            let (light, own) = (f64::from(self.light.at(x, y)), f64::from(self.own.at(x, y)));
            light >= 0.5 * peak && own < 0.5 * light
        };
        spot.iter().any(|&(x, y)| {
            let mut around = (y.saturating_sub(2)..(y + 3).min(height))
                .flat_map(|y| (x.saturating_sub(2)..(x + 3).min(width)).map(move |x| (x, y)));
            around.any(|(x, y)| lasts(x, y))
        })
    }
}

fn largest_around(plane: &Plane, x: usize, y: usize) -> f32 {
    let (width, height) = plane.size();
    let rows = y.saturating_sub(1)..(y + 2).min(height);
    let columns = x.saturating_sub(1)..(x + 2).min(width);
    rows.flat_map(|y| plane.row(y)[columns.clone()].iter().copied()).fold(0.0, f32::max)
}

/// The brightest pixel, where it is brighter than its surroundings and their noise can explain.
pub(super) fn outstanding_peak(light: &Plane) -> Result<f64, f64> {
    let mut values: Vec<f64> = light.data().iter().map(|&v| f64::from(v)).collect();
    let (background, brightest) = (quantile(&mut values, 0.5), quantile(&mut values, 1.0));
    let noise = robust_sd(values.iter().map(|value| value - background));
    let level = (3.0 * background.max(1e-3)).max(background + 8.0 * noise);
    if brightest > level { Ok(brightest) } else { Err(brightest) }
}

/// Connected pixels (eight neighbours) at or above a level.
pub(super) fn components(light: &Plane, level: f64) -> Vec<Vec<(usize, usize)>> {
    let (width, height) = light.size();
    let bright = |x: usize, y: usize| f64::from(light.at(x, y)) >= level;
    let mut visited = vec![false; width * height];
    let mut found = Vec::new();
    for start in (0..width * height).filter(|&i| bright(i % width, i / width)) {
        if std::mem::replace(&mut visited[start], true) {
            continue;
        }
        let mut component = vec![(start % width, start / width)];
        let mut next = 0;
        while let Some(&(x, y)) = component.get(next) {
            next += 1;
            for ny in y.saturating_sub(1)..(y + 2).min(height) {
                for nx in x.saturating_sub(1)..(x + 2).min(width) {
                    if bright(nx, ny) && !std::mem::replace(&mut visited[ny * width + nx], true) {
                        component.push((nx, ny));
                    }
                }
            }
        }
        found.push(component);
    }
    found
}
