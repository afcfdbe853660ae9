//! The light that two patches exchange.

use nalgebra::Point3;

use super::{
    patches::{Patch, Patches},
    polygon::{Polygon, polygon_to_polygon},
};

/// Beyond this many radii (of both patches together) their centres stand for them: error about 1/4 (radius/distance)^2.
const CENTRES_SUFFICE: f64 = 10.0;
/// Beyond this many, the three-point rule of degree 2 on each; nearer, and where they touch, the contour integral.
const THREE_POINTS_SUFFICE: f64 = 2.0;

/// Area of `a` times its form factor to `b` (symmetric) with what lies between them left out, and how many rays the
/// pair deserves: many small far pairs need one each for what few near ones need `rays_if_near`.
pub(super) fn unoccluded_exchange_mm2(a: &Patch, b: &Patch, flat_mm: f64, rays_if_near: usize) -> (f64, usize) {
    let (above_a, above_b) = (a.height_mm(&b.centre), b.height_mm(&a.centre));
    if above_a <= flat_mm - b.radius_mm || above_b <= flat_mm - a.radius_mm {
        return (0.0, 0);
    }
    if is_below(a, b, above_a, flat_mm) || is_below(b, a, above_b, flat_mm) {
        return (0.0, 0);
    }
    let distance_squared = (b.centre - a.centre).norm_squared();
    let radii = a.radius_mm + b.radius_mm;
    let within = |limit: f64| distance_squared < limit * limit * radii * radii;
    if within(THREE_POINTS_SUFFICE) {
        return (nearby_exchange_mm2(a, b), rays_if_near);
    }
    if within(CENTRES_SUFFICE) {
        let (from, to) = (three_points(a), three_points(b));
        let sum: f64 = from.iter().flat_map(|x| to.iter().map(|y| kernel(a, b, x, y))).sum();
        return (a.area_mm2 * b.area_mm2 * sum / 9.0, rays_if_near);
    }
    (a.area_mm2 * b.area_mm2 * kernel(a, b, &a.centre, &b.centre), 1)
}

/// The difference between the exchange found from `a` and from `b`, relative to it, for patches near enough for the one
/// rule that is not symmetric in itself; `None` for others. Form factors below 0.01 count as 0.01.
pub(super) fn reciprocity_residual(a: &Patch, b: &Patch, flat_mm: f64) -> Option<f64> {
    let near = (b.centre - a.centre).norm() < THREE_POINTS_SUFFICE * (a.radius_mm + b.radius_mm);
    let (exchange, _) = if near { unoccluded_exchange_mm2(a, b, flat_mm, 1) } else { (0.0, 0) };
    let floor = 1e-2 * a.area_mm2.min(b.area_mm2);
    (exchange > 0.0).then(|| (nearby_exchange_mm2(b, a) - exchange).abs() / exchange.max(floor))
}

/// The same by the closed contour integral over the parts in front of each other's plane.
fn nearby_exchange_mm2(a: &Patch, b: &Patch) -> f64 {
    let a_part = Polygon::triangle_before(&a.corners, &b.centre, &b.normal);
    let b_part = Polygon::triangle_before(&b.corners, &a.centre, &a.normal);
    polygon_to_polygon(&a_part, &b_part)
}

/// Whether `other`, whose centre has the height `centre_height` over the plane of `patch`, is nowhere in front of it.
fn is_below(patch: &Patch, other: &Patch, centre_height: f64, flat_mm: f64) -> bool {
    centre_height < other.radius_mm && other.corners.iter().all(|corner| patch.height_mm(corner) <= flat_mm)
}

/// `cos cos / (pi r^2)` between a point of `a` and one of `b`; zero behind either.
fn kernel(a: &Patch, b: &Patch, x: &Point3<f64>, y: &Point3<f64>) -> f64 {
    let across = y - x;
    let distance_squared = across.norm_squared();
    let cosines = a.normal.dot(&across).max(0.0) * (-b.normal.dot(&across)).max(0.0);
    cosines / (std::f64::consts::PI * distance_squared * distance_squared)
}

fn three_points(patch: &Patch) -> [Point3<f64>; 3] {
    patch.corners.map(|corner| nalgebra::center(&patch.centre, &corner))
}

/// The fraction of `rays` between stratified points of the two patches that meets no third patch.
pub(super) fn visible_fraction(patches: &Patches, a: usize, b: usize, rays: usize) -> f64 {
    let (from, to) = (&patches.as_slice()[a], &patches.as_slice()[b]);
    let clear = (0..rays).filter(|&ray| {
        let [s, t, u, v] = four_uniform((a as u64) << 32 | b as u64, ray);
        let (x, y) = (uniform_point(from, s, t), uniform_point(to, u, v));
        !patches.occluders().blocked(&x, &y, [Some(a), Some(b)])
    });
    clear.count() as f64 / rays as f64
}

/// A uniform point of the triangle for two uniform numbers: the square folded along its diagonal.
pub(crate) fn uniform_point(patch: &Patch, s: f64, t: f64) -> Point3<f64> {
    if s + t > 1.0 { patch.point(1.0 - s, 1.0 - t) } else { patch.point(s, t) }
}

/// Point `index` of a four-dimensional additive recurrence (Roberts 2018), shifted by a hash of `seed`: evenly spread
/// for one pair, unrelated between pairs, the same in every run.
fn four_uniform(seed: u64, index: usize) -> [f64; 4] {
    // The real root above 1 of x^5 = x + 1.
    const GOLDEN_4: f64 = 1.167_303_978_261_418_7;
    let mut state = seed;
    let mut step = 1.0;
    [(); 4].map(|()| {
        step /= GOLDEN_4;
        (hashed_unit(&mut state) + index as f64 * step).fract()
    })
}

/// SplitMix64 (Steele, Lea, Flood 2014) as a number in 0..1.
fn hashed_unit(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}
