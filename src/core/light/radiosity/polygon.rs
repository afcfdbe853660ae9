//! Closed forms for the light between a point or a polygon and another polygon, and the cut that keeps what a plane
//! lets be seen.

use std::f64::consts::TAU;

use nalgebra::{Point3, Unit, Vector3};

/// A triangle, or what one plane leaves of it: at most four corners, counter-clockwise seen from the front.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Polygon {
    corners: [Point3<f64>; 4],
    len: usize,
}

impl Polygon {
    /// The part of a triangle in front of the plane through `origin`; fewer than three corners if nothing is left.
    pub(crate) fn triangle_before(
        triangle: &[Point3<f64>; 3],
        origin: &Point3<f64>,
        normal: &Unit<Vector3<f64>>,
    ) -> Self {
        let heights = triangle.map(|corner| normal.dot(&(corner - origin)));
        let mut kept = Self { corners: [*origin; 4], len: 0 };
        for (k, corner) in triangle.iter().enumerate() {
            let next = (k + 1) % 3;
            if heights[k] >= 0.0 {
                kept.push(*corner);
            }
            if heights[k] * heights[next] < 0.0 {
                kept.push(corner + (triangle[next] - corner) * (heights[k] / (heights[k] - heights[next])));
            }
        }
        kept
    }

    fn push(&mut self, corner: Point3<f64>) {
        self.corners[self.len] = corner;
        self.len += 1;
    }

    fn edges(&self) -> impl Iterator<Item = (Point3<f64>, Point3<f64>)> {
        (0..self.len).map(|k| (self.corners[k], self.corners[(k + 1) % self.len]))
    }
}

/// Form factor from a point to the part of a triangle above its horizon, exact (Lambert 1760; Baum, Rushmeier, Winget
/// 1989): `F = 1/2pi sum over edges of angle * (normal . edge plane)`. The point must lie in front of the triangle.
pub(crate) fn point_to_triangle(point: &Point3<f64>, normal: &Unit<Vector3<f64>>, triangle: &[Point3<f64>; 3]) -> f64 {
    let visible = Polygon::triangle_before(triangle, point, normal);
    let sum: f64 = visible
        .edges()
        .map(|(start, end)| {
            let (a, b) = (start - point, end - point);
            let across = b.cross(&a);
            let sine = across.norm();
            // An edge seen end-on, or one that touches the point, spans no area.
            if sine > 0.0 { sine.atan2(a.dot(&b)) * normal.dot(&across) / sine } else { 0.0 }
        })
        .sum();
    (sum / TAU).max(0.0)
}

/// Area times form factor between two polygons that see each other wholly, in the square of their unit, symmetric, right
/// for polygons that touch: `A F = 1/2pi` times the double contour integral of `ln r dx . dy` (Goral et al. 1984). The
/// inner integral is closed; where edges touch it has `t ln t` kinks at the ends, which the outer rule crowds out, and where
/// they pass each other closely it is halved until it is smooth.
pub(crate) fn polygon_to_polygon(from: &Polygon, to: &Polygon) -> f64 {
    let mut sum = 0.0;
    for (start, end) in from.edges() {
        let along = end - start;
        for (to_start, to_end) in to.edges() {
            let to_along = to_end - to_start;
            let cosine = along.dot(&to_along);
            let length = to_along.norm();
            if cosine == 0.0 || length == 0.0 {
                continue;
            }
            let inner = |t: f64| mean_log_distance(&(start + along * t), &to_start, &to_along, length);
            sum += cosine * adaptive_integral(&inner, (0.0, 1.0), gauss_8(&inner, 0.0, 1.0), 0);
        }
    }
    (sum / TAU).max(0.0)
}

/// The integral whose value by one rule is `whole`: halved while the halves do not agree with it.
fn adaptive_integral(f: &impl Fn(f64) -> f64, (low, high): (f64, f64), whole: f64, halvings: usize) -> f64 {
    const TOLERANCE: f64 = 1e-6;
    const MAX_HALVINGS: usize = 6;
    let middle = (low + high) / 2.0;
    let halves = [gauss_8(f, low, middle), gauss_8(f, middle, high)];
    let sum = halves[0] + halves[1];
    if halvings == MAX_HALVINGS || (sum - whole).abs() < TOLERANCE {
        return sum;
    }
    adaptive_integral(f, (low, middle), halves[0], halvings + 1)
        + adaptive_integral(f, (middle, high), halves[1], halvings + 1)
}

/// Gauss's rule of eight points, crowded at both ends by `t = 3 s^2 - 2 s^3`.
fn gauss_8(f: &impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    let width = high - low;
    let term = |&(s, weight): &(f64, f64)| weight * 6.0 * s * (1.0 - s) * f(low + width * s * s * (3.0 - 2.0 * s));
    width * GAUSS_8.iter().map(term).sum::<f64>()
}

/// Mean of `ln |point - y|` over `y` on the segment from `start` along `along`, which is `length` long and not zero.
fn mean_log_distance(point: &Point3<f64>, start: &Point3<f64>, along: &Vector3<f64>, length: f64) -> f64 {
    let offset = point - start;
    let foot = offset.dot(along) / length;
    let height_squared = (offset.norm_squared() - foot * foot).max(0.0);
    let height = height_squared.sqrt();
    let antiderivative = |u: f64| {
        let squared = u * u + height_squared;
        let log = if squared > 0.0 { 0.5 * u * squared.ln() } else { 0.0 };
        log + if height > 0.0 { height * (u / height).atan() } else { 0.0 }
    };
    (antiderivative(length - foot) - antiderivative(-foot)) / length - 1.0
}

/// Gauss-Legendre positions and weights on 0..1.
const GAUSS_8: [(f64, f64); 8] = [
    (0.019_855_071_751_231_856, 0.050_614_268_145_188_13),
    (0.101_666_761_293_186_64, 0.111_190_517_226_687_24),
    (0.237_233_795_041_835_5, 0.156_853_322_938_943_64),
    (0.408_282_678_752_175_1, 0.181_341_891_689_181),
    (0.591_717_321_247_825, 0.181_341_891_689_181),
    (0.762_766_204_958_164_5, 0.156_853_322_938_943_64),
    (0.898_333_238_706_813_4, 0.111_190_517_226_687_24),
    (0.980_144_928_248_768_1, 0.050_614_268_145_188_13),
];

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: f64, y: f64, z: f64) -> Point3<f64> {
        Point3::new(x, y, z)
    }

    /// Two triangles of the rectangle from `origin` along `u`, then `v`; the front is on the side of `u x v`.
    fn rectangle(origin: Point3<f64>, u: Vector3<f64>, v: Vector3<f64>) -> [[Point3<f64>; 3]; 2] {
        [[origin, origin + u, origin + u + v], [origin, origin + u + v, origin + v]]
    }

    fn exchange(a: [[Point3<f64>; 3]; 2], b: [[Point3<f64>; 3]; 2]) -> f64 {
        let whole = |[a, b, c]: [Point3<f64>; 3]| Polygon { corners: [a, b, c, c], len: 3 };
        let pairs = a.iter().flat_map(|s| b.iter().map(move |t| (whole(*s), whole(*t))));
        pairs.map(|(s, t)| polygon_to_polygon(&s, &t)).sum()
    }

    #[test]
    fn a_point_over_the_corner_of_a_rectangle_has_the_handbook_form_factor() {
        // Parallel rectangle a x b at distance 1, the point over one corner (Siegel & Howell, configuration 3).
        let (a, b) = (0.7_f64, 1.9_f64);
        let expected =
            (a / a.hypot(1.0) * (b / a.hypot(1.0)).atan() + b / b.hypot(1.0) * (a / b.hypot(1.0)).atan()) / TAU;
        let sheet = rectangle(point(0.0, 0.0, 1.0), Vector3::y() * b, Vector3::x() * a);
        let found: f64 = sheet.iter().map(|t| point_to_triangle(&Point3::origin(), &Vector3::z_axis(), t)).sum();
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }

    #[test]
    fn below_the_horizon_nothing_counts() {
        let half = [point(1.0, -1.0, -5.0), point(1.0, 1.0, -5.0), point(1.0, 0.0, 5.0)];
        let upper = Polygon::triangle_before(&half, &Point3::origin(), &Vector3::z_axis());
        assert_eq!(upper.len, 3);
        assert!(upper.edges().all(|(start, _)| start.z >= 0.0));
    }

    #[test]
    fn squares_that_share_an_edge_have_the_handbook_form_factor() {
        // Perpendicular unit squares with a common edge: 0.20004 (Siegel & Howell, configuration 33).
        let floor = rectangle(Point3::origin(), Vector3::x(), Vector3::y());
        let wall = rectangle(Point3::origin(), Vector3::y(), Vector3::z());
        let found = exchange(floor, wall);
        assert!((found - 0.200_044).abs() < 1e-6, "{found}");
    }

    #[test]
    fn facing_squares_have_the_handbook_form_factor() {
        // Parallel unit squares at distance 1: 0.19982.
        let floor = rectangle(Point3::origin(), Vector3::x(), Vector3::y());
        let ceiling = rectangle(point(0.0, 0.0, 1.0), Vector3::y(), Vector3::x());
        let found = exchange(floor, ceiling);
        assert!((found - 0.199_825).abs() < 2e-6, "{found}");
    }
}
