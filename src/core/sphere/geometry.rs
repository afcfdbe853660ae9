//! The surface of a ball behind its circle.

use super::{BallError, Circle};
use nalgebra::Vector3;

/// How the camera projects the ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// All lines of sight are parallel to z.
    Orthographic,
    /// All lines of sight meet in the camera.
    Perspective {
        /// Focal length in pixels.
        focal_length_px: f64,
        /// Where the optical axis meets the image the ball lies in, in pixels.
        principal_point_px: (f64, f64),
    },
}

/// The outward normal of the ball and the direction to the camera at one pixel; unit vectors in the object frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Outward unit normal.
    pub normal: Vector3<f64>,
    /// Unit vector from the surface to the camera.
    pub direction_to_camera: Vector3<f64>,
}

impl SurfacePoint {
    /// Where light comes from that a mirror ball sends into the camera here: d = 2 (n.v) n - v.
    pub fn direction_mirrored(&self) -> Vector3<f64> {
        2.0 * self.normal.dot(&self.direction_to_camera) * self.normal - self.direction_to_camera
    }
}

/// A sphere behind its circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    circle: Circle,
    view: View,
}

impl Ball {
    /// The ball whose outline is `circle` in a camera that projects by `view`.
    pub fn new(circle: Circle, view: View) -> Self {
        Self { circle, view }
    }

    /// Its outline.
    pub fn circle(&self) -> Circle {
        self.circle
    }

    /// The same camera with the outline moved by `shift_px` and grown by `growth_px`.
    pub fn perturbed(&self, shift_px: (f64, f64), growth_px: f64) -> Self {
        let (x, y) = self.circle.centre_px;
        let circle =
            Circle { centre_px: (x + shift_px.0, y + shift_px.1), radius_px: self.circle.radius_px + growth_px };
        Self { circle, view: self.view }
    }

    /// The surface seen at a position in pixels; `None` outside the outline.
    pub fn surface_at(&self, x_px: f64, y_px: f64) -> Option<SurfacePoint> {
        match self.view {
            View::Orthographic => {
                let x = (x_px - self.circle.centre_px.0) / self.circle.radius_px;
                let y = (self.circle.centre_px.1 - y_px) / self.circle.radius_px;
                let z_squared = 1.0 - x * x - y * y;
                (z_squared >= 0.0).then(|| SurfacePoint {
                    normal: Vector3::new(x, y, z_squared.sqrt()),
                    direction_to_camera: Vector3::z(),
                })
            }
            View::Perspective { focal_length_px, principal_point_px } => {
                self.surface_in_perspective(x_px, y_px, focal_length_px, principal_point_px)
            }
        }
    }

    /// Meets the line of sight with a sphere at unit distance whose outline is as wide as the circle. The outline of a
    /// ball off the axis is an ellipse; its short axis, across the line to the principal point, is its true width.
    fn surface_in_perspective(&self, x: f64, y: f64, focal: f64, (px, py): (f64, f64)) -> Option<SurfacePoint> {
        let sight = |x: f64, y: f64| Vector3::new((x - px) / focal, (py - y) / focal, -1.0).normalize();
        let (cx, cy) = self.circle.centre_px;
        let centre = sight(cx, cy);
        let off_axis = (cx - px).hypot(cy - py);
        let across = if off_axis > 1e-9 { ((py - cy) / off_axis, (cx - px) / off_axis) } else { (1.0, 0.0) };
        let r = self.circle.radius_px;
        let radius = centre.cross(&sight(cx + r * across.0, cy + r * across.1)).norm();

        let ray = sight(x, y);
        let along = ray.dot(&centre);
        let discriminant = along * along - 1.0 + radius * radius;
        (discriminant >= 0.0).then(|| SurfacePoint {
            normal: (ray * (along - discriminant.sqrt()) - centre) / radius,
            direction_to_camera: -ray,
        })
    }
}

/// The circle through three points of its rim, in pixels.
///
/// Errors: points on one line, or on one another.
pub fn circle_through(points: [(f64, f64); 3]) -> Result<Circle, BallError> {
    let [(ax, ay), (bx, by), (cx, cy)] = points;
    let ((bx, by), (cx, cy)) = ((bx - ax, by - ay), (cx - ax, cy - ay));
    let twice_area = bx * cy - by * cx;
    let (b, c) = (bx * bx + by * by, cx * cx + cy * cy);
    let longest = b.max(c).max((bx - cx).powi(2) + (by - cy).powi(2));
    // A circle far larger than its points are apart is known from none of them.
    if twice_area.is_nan() || twice_area.abs() <= 1e-3 * longest {
        return Err(BallError::OnOneLine);
    }
    let (x, y) = ((cy * b - by * c) / (2.0 * twice_area), (bx * c - cx * b) / (2.0 * twice_area));
    Ok(Circle { centre_px: (ax + x, ay + y), radius_px: x.hypot(y) })
}

/// The direction from the ball's centre to a lamp that its surface point `normal` sees in `direction`, the lamp being
/// `distance_radii` ball radii from the centre.
pub(crate) fn seen_from_centre(normal: Vector3<f64>, direction: Vector3<f64>, distance_radii: f64) -> Vector3<f64> {
    let along = normal.dot(&direction);
    let reach = (along * along + distance_radii * distance_radii - 1.0).max(0.0).sqrt() - along;
    (normal + direction * reach).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    const CIRCLE: Circle = Circle { centre_px: (100.0, 80.0), radius_px: 50.0 };

    #[test]
    fn three_points_of_a_rim_make_its_circle_and_three_on_a_line_none() {
        let on_rim = |turn: f64| (100.0 + 50.0 * turn.cos(), 80.0 + 50.0 * turn.sin());
        for turns in [[0.0, 2.0, 4.0], [5.0, 0.5, 1.2], [3.0, 3.4, 2.6]] {
            let Circle { centre_px: (x, y), radius_px } = circle_through(turns.map(on_rim)).unwrap();
            assert!((x - 100.0).abs() < 1e-9 && (y - 80.0).abs() < 1e-9 && (radius_px - 50.0).abs() < 1e-9);
        }
        let line = [(1.0, 1.0), (2.0, 2.0), (5.0, 5.0)];
        for points in [line, [(3.0, 4.0); 3], [(0.0, 0.0), (1.0, 0.0), (1.0, 0.0)], [(f64::NAN, 0.0); 3]] {
            assert_eq!(circle_through(points), Err(BallError::OnOneLine));
        }
    }

    #[test]
    fn the_mirror_law_holds_in_both_views() {
        let views =
            [View::Orthographic, View::Perspective { focal_length_px: 900.0, principal_point_px: (120.0, 90.0) }];
        for view in views {
            let point = Ball::new(CIRCLE, view).surface_at(110.0, 75.0).unwrap();
            let mirrored = point.direction_mirrored();
            assert!((mirrored.norm() - 1.0).abs() < 1e-12);
            let half_way = (mirrored + point.direction_to_camera).normalize();
            assert!((half_way - point.normal).norm() < 1e-12);
        }
    }

    #[test]
    fn a_far_camera_sees_what_an_orthographic_one_sees() {
        let far = View::Perspective { focal_length_px: 1e7, principal_point_px: (100.0, 80.0) };
        let near_truth = Ball::new(CIRCLE, View::Orthographic).surface_at(120.0, 60.0).unwrap();
        let found = Ball::new(CIRCLE, far).surface_at(120.0, 60.0).unwrap();
        assert!((near_truth.normal - found.normal).norm() < 1e-4);
    }

    #[test]
    fn perspective_normals_at_the_rim_are_square_to_the_line_of_sight() {
        let view = View::Perspective { focal_length_px: 400.0, principal_point_px: (100.0, 80.0) };
        let point = Ball::new(CIRCLE, view).surface_at(100.0 + 50.0 - 1e-9, 80.0).unwrap();
        assert!(point.normal.dot(&point.direction_to_camera).abs() < 1e-3);
    }

    #[test]
    fn parallax_is_undone() {
        let normal = Vector3::new(0.3, -0.2, 0.9).normalize();
        let lamp = Vector3::new(4.0, 7.0, 30.0);
        let seen = (lamp - normal).normalize();
        assert!((seen_from_centre(normal, seen, lamp.norm()) - lamp.normalize()).norm() < 1e-12);
    }
}
