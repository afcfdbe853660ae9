//! The eye of the 3D view: where it is, what it sees, and the way between points of the object and of the screen.
//!
//! The object frame is that of the capture: x right, y up, z toward the photographing camera. The front view is what that
//! camera saw.

use nalgebra::{Isometry3, Matrix4, Point3, UnitVector3, Vector3};
use serde::{Deserialize, Serialize};

/// Angle of view from top to bottom.
const FIELD_OF_VIEW_DEG: f64 = 30.0;
/// The object fills this part of the view when it is fitted.
const FILLED: f64 = 0.94;
/// The nearest that is drawn, as a part of the farthest: what is left to the depth buffer.
const NEAREST: f64 = 1e-3;
/// The eye stays within these multiples of the object's radius.
const DISTANCES: (f64, f64) = (1e-3, 1e3);

/// How distance shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Lens {
    /// Near is larger.
    #[default]
    Perspective,
    /// One scale for the whole view.
    Orthographic,
}

/// The views that have names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StandardView {
    /// From +z, as the photos.
    Front,
    /// From -z.
    Back,
    /// From -x.
    Left,
    /// From +x.
    Right,
    /// From +y.
    Top,
    /// From -y.
    Bottom,
    /// From the front, the right and above.
    Corner,
}

impl StandardView {
    /// All, in the order of a menu.
    pub const ALL: [Self; 7] =
        [Self::Front, Self::Back, Self::Left, Self::Right, Self::Top, Self::Bottom, Self::Corner];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Front => "Front",
            Self::Back => "Back",
            Self::Left => "Left",
            Self::Right => "Right",
            Self::Top => "Top",
            Self::Bottom => "Bottom",
            Self::Corner => "Corner",
        }
    }

    /// The turns to the right and upward that lead there, in degrees.
    fn turns_deg(self) -> (f64, f64) {
        match self {
            Self::Front => (0.0, 0.0),
            Self::Back => (180.0, 0.0),
            Self::Left => (-90.0, 0.0),
            Self::Right => (90.0, 0.0),
            Self::Top => (0.0, 90.0),
            Self::Bottom => (0.0, -90.0),
            Self::Corner => (30.0, 25.0),
        }
    }
}

/// The ball around everything that is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its centre.
    pub centre: Point3<f64>,
    /// Its radius, more than zero.
    pub radius: f64,
}

impl Ball {
    /// The ball around a box.
    pub fn around(low: &Point3<f64>, high: &Point3<f64>) -> Self {
        let radius = (high - low).norm() / 2.0;
        Self { centre: nalgebra::center(low, high), radius: if radius > 0.0 { radius } else { 1.0 } }
    }

    /// The ball after a motion.
    pub fn moved(&self, motion: &Isometry3<f64>) -> Self {
        Self { centre: motion * self.centre, radius: self.radius }
    }

    /// The smallest ball around both.
    pub fn with(&self, other: &Self) -> Self {
        let apart = (other.centre - self.centre).norm();
        if apart + other.radius <= self.radius {
            return *self;
        }
        if apart + self.radius <= other.radius {
            return *other;
        }
        let radius = (apart + self.radius + other.radius) / 2.0;
        let centre = self.centre + (other.centre - self.centre) * ((radius - self.radius) / apart);
        Self { centre, radius }
    }
}

/// An eye that looks at a target and turns about it, the y axis staying upright.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// What stays in the middle of the view.
    pub target: [f64; 3],
    /// Turn to the right about the y axis: at 90 the eye is at +x.
    pub yaw_deg: f64,
    /// Turn upward: at 90 the eye is at +y.
    pub pitch_deg: f64,
    /// From the target to the eye.
    pub distance: f64,
    /// How distance shows.
    pub lens: Lens,
}

impl Camera {
    /// Everything in the ball, seen from a named side, in a view of the given width over height.
    pub fn fitted(ball: &Ball, view: StandardView, lens: Lens, aspect: f64) -> Self {
        let (yaw_deg, pitch_deg) = view.turns_deg();
        let from = Self { target: [0.0; 3], yaw_deg, pitch_deg, distance: 1.0, lens };
        from.refitted(ball, aspect)
    }

    /// The same direction, with everything in the ball in sight.
    pub fn refitted(&self, ball: &Ball, aspect: f64) -> Self {
        let narrow = aspect.min(1.0);
        let half = half_angle();
        let distance = match self.lens {
            Lens::Perspective => ball.radius / (FILLED * (half.tan() * narrow).atan()).sin(),
            Lens::Orthographic => ball.radius / (FILLED * half.tan() * narrow),
        };
        Self { target: ball.centre.into(), distance, ..*self }
    }

    /// Seen from a named side, the target and the distance staying.
    pub fn turned_to(&self, view: StandardView) -> Self {
        let (yaw_deg, pitch_deg) = view.turns_deg();
        Self { yaw_deg, pitch_deg, ..*self }
    }

    /// Turned about the target; it stays upright.
    pub fn orbited(&self, right_deg: f64, up_deg: f64) -> Self {
        let yaw_deg = (self.yaw_deg + right_deg + 180.0).rem_euclid(360.0) - 180.0;
        Self { yaw_deg, pitch_deg: (self.pitch_deg + up_deg).clamp(-90.0, 90.0), ..*self }
    }

    /// Moved sideways, so that what lies in the target's plane follows the hand: `right` and `up` are parts of the view's
    /// height.
    pub fn panned(&self, right: f64, up: f64) -> Self {
        let height = 2.0 * self.half_height();
        let [x, y, _] = self.axes();
        let target = self.target() - (x.into_inner() * right + y.into_inner() * up) * height;
        Self { target: target.into(), ..*self }
    }

    /// Everything `1 / factor` times as large, `about` staying where it is on the screen. `ball` keeps the eye within reach.
    pub fn dollied(&self, factor: f64, about: &Point3<f64>, ball: &Ball) -> Self {
        let distance = (self.distance * factor).clamp(DISTANCES.0 * ball.radius, DISTANCES.1 * ball.radius);
        let factor = distance / self.distance;
        let target = about + (self.target() - about) * factor;
        Self { target: target.into(), distance, ..*self }
    }

    /// Looking at another point from the same side.
    pub fn looking_at(&self, point: &Point3<f64>) -> Self {
        Self { target: (*point).into(), ..*self }
    }

    /// What stays in the middle of the view.
    pub fn target(&self) -> Point3<f64> {
        self.target.into()
    }

    /// Right, up, and from the target to the eye.
    pub fn axes(&self) -> [UnitVector3<f64>; 3] {
        let (yaw, pitch) = (self.yaw_deg.to_radians(), self.pitch_deg.to_radians());
        let right = Vector3::new(yaw.cos(), 0.0, -yaw.sin());
        let back = Vector3::new(yaw.sin() * pitch.cos(), pitch.sin(), yaw.cos() * pitch.cos());
        [right, back.cross(&right), back].map(UnitVector3::new_normalize)
    }

    /// Half the height of what is seen in the target's plane.
    pub fn half_height(&self) -> f64 {
        self.distance * half_angle().tan()
    }

    /// All that a frame needs to know, for a view of `size` (in any unit: points or pixels) onto what is in the ball.
    pub fn frame(&self, size: [f64; 2], ball: &Ball) -> Frame {
        let axes = self.axes();
        let eye = self.target() + axes[2].into_inner() * self.distance;
        let middle = axes[2].dot(&(eye - ball.centre));
        let (near, far) = (middle - ball.radius * 1.001, middle + ball.radius * 1.001);
        let (near, far) = match self.lens {
            Lens::Orthographic => (near, far),
            Lens::Perspective => {
                let far = far.max(self.distance * NEAREST);
                (near.max(far * NEAREST), far * (1.0 + NEAREST))
            }
        };
        Frame { camera: *self, axes, eye, near, far, size: size.map(|side| side.max(1.0)) }
    }
}

fn half_angle() -> f64 {
    FIELD_OF_VIEW_DEG.to_radians() / 2.0
}

/// A line of sight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it begins, in front of everything that is shown.
    pub origin: Point3<f64>,
    /// Away from the eye.
    pub direction: UnitVector3<f64>,
}

/// A camera over a view of a given size. Places on the screen are counted from its top left corner, y down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    camera: Camera,
    axes: [UnitVector3<f64>; 3],
    eye: Point3<f64>,
    near: f64,
    far: f64,
    size: [f64; 2],
}

impl Frame {
    /// Right, up, and toward the eye.
    pub fn axes(&self) -> [UnitVector3<f64>; 3] {
        self.axes
    }

    /// Where the eye is and 1; for an orthographic lens the direction to it and 0.
    pub fn eye(&self) -> [f64; 4] {
        let direction = self.axes[2];
        match self.camera.lens {
            Lens::Perspective => [self.eye.x, self.eye.y, self.eye.z, 1.0],
            Lens::Orthographic => [direction.x, direction.y, direction.z, 0.0],
        }
    }

    /// From points of the object to clip space: x right, y up, depth 0 at the nearest, 1 at the farthest.
    pub fn clip_from_world(&self) -> Matrix4<f64> {
        let [x, y, z] = self.axes;
        let row =
            |axis: &UnitVector3<f64>| nalgebra::RowVector4::new(axis.x, axis.y, axis.z, -axis.dot(&self.eye.coords));
        let view = Matrix4::from_rows(&[row(&x), row(&y), row(&z), nalgebra::RowVector4::new(0.0, 0.0, 0.0, 1.0)]);
        let (near, far) = (self.near, self.far);
        let along = 1.0 / (near - far);
        let (aspect, tangent, half) = (self.aspect(), half_angle().tan(), self.camera.half_height());
        let mut lens = Matrix4::zeros();
        match self.camera.lens {
            Lens::Perspective => {
                lens[(0, 0)] = 1.0 / (tangent * aspect);
                lens[(1, 1)] = 1.0 / tangent;
                (lens[(2, 2)], lens[(2, 3)]) = (far * along, near * far * along);
                lens[(3, 2)] = -1.0;
            }
            Lens::Orthographic => {
                lens[(0, 0)] = 1.0 / (half * aspect);
                lens[(1, 1)] = 1.0 / half;
                (lens[(2, 2)], lens[(2, 3)]) = (along, near * along);
                lens[(3, 3)] = 1.0;
            }
        }
        lens * view
    }

    /// Where a point is on the screen, and its depth from 0 to 1; `None` behind the eye.
    pub fn project(&self, point: &Point3<f64>) -> Option<[f64; 3]> {
        let clip = self.clip_from_world() * point.to_homogeneous();
        let [x, y, z, w]: [f64; 4] = clip.into();
        (w > 0.0).then(|| [(x / w + 1.0) / 2.0 * self.size[0], (1.0 - y / w) / 2.0 * self.size[1], z / w])
    }

    /// The line of sight through a place on the screen.
    pub fn ray(&self, at: [f64; 2]) -> Ray {
        let [x, y] = self.on_plane(at);
        let [right, up, back] = self.axes.map(UnitVector3::into_inner);
        match self.camera.lens {
            Lens::Perspective => {
                let direction = right * x + up * y - back * self.camera.distance;
                Ray { origin: self.eye, direction: UnitVector3::new_normalize(direction) }
            }
            Lens::Orthographic => {
                let origin = self.eye + right * x + up * y - back * self.near;
                Ray { origin, direction: -self.axes[2] }
            }
        }
    }

    /// The point that is seen at a place of the screen in a depth from 0 to 1.
    pub fn unproject(&self, at: [f64; 2], depth: f64) -> Point3<f64> {
        let (near, far) = (self.near, self.far);
        let away = match self.camera.lens {
            Lens::Perspective => near * far / (far - depth * (far - near)),
            Lens::Orthographic => near + depth * (far - near),
        };
        let [x, y] = self.on_plane(at);
        let [right, up, back] = self.axes.map(UnitVector3::into_inner);
        let wider = match self.camera.lens {
            Lens::Perspective => away / self.camera.distance,
            Lens::Orthographic => 1.0,
        };
        self.eye + (right * x + up * y) * wider - back * away
    }

    /// The point in the target's plane that is seen at a place of the screen.
    pub fn on_target_plane(&self, at: [f64; 2]) -> Point3<f64> {
        let [x, y] = self.on_plane(at);
        self.camera.target() + self.axes[0].into_inner() * x + self.axes[1].into_inner() * y
    }

    /// How long one unit of the screen is in the target's plane.
    pub fn unit_on_target(&self) -> f64 {
        2.0 * self.camera.half_height() / self.size[1]
    }

    fn aspect(&self) -> f64 {
        self.size[0] / self.size[1]
    }

    /// A place on the screen as distances from the target, right and up in its plane.
    fn on_plane(&self, at: [f64; 2]) -> [f64; 2] {
        let unit = self.unit_on_target();
        [(at[0] - self.size[0] / 2.0) * unit, (self.size[1] / 2.0 - at[1]) * unit]
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    use super::*;

    const SIZE: [f64; 2] = [640.0, 480.0];

    fn ball() -> Ball {
        Ball { centre: Point3::new(10.0, -5.0, 30.0), radius: 60.0 }
    }

    fn lens() -> impl Strategy<Value = Lens> {
        prop_oneof![Just(Lens::Perspective), Just(Lens::Orthographic)]
    }

    prop_compose! {
        fn camera()(
            lens in lens(), yaw_deg in -180.0..180.0f64, pitch_deg in -90.0..90.0f64, distance in 40.0..900.0f64,
            target in prop::array::uniform3(-50.0..50.0f64),
        ) -> Camera {
            Camera { target, yaw_deg, pitch_deg, distance, lens }
        }
    }

    fn close(a: &Point3<f64>, b: &Point3<f64>) -> bool {
        (a - b).norm() < 1e-6
    }

    #[test]
    fn the_named_views_look_along_the_axes() {
        let seen_from = |view| *Camera::fitted(&ball(), view, Lens::Perspective, 1.5).axes()[2];
        let expected = [
            (StandardView::Front, Vector3::z()),
            (StandardView::Back, -Vector3::z()),
            (StandardView::Left, -Vector3::x()),
            (StandardView::Right, Vector3::x()),
            (StandardView::Top, Vector3::y()),
            (StandardView::Bottom, -Vector3::y()),
        ];
        for (view, direction) in expected {
            assert!((seen_from(view) - direction).norm() < 1e-12, "{view:?}");
        }
        let [right, up, _] = Camera::fitted(&ball(), StandardView::Front, Lens::Perspective, 1.5).axes();
        assert!((*right - Vector3::x()).norm() < 1e-12 && (*up - Vector3::y()).norm() < 1e-12);
    }

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

        #[test]
        fn what_is_projected_and_unprojected_is_the_same_point(
            camera in camera(), x in 0.0..640.0f64, y in 0.0..480.0f64, depth in 0.0..1.0f64,
        ) {
            let frame = camera.frame(SIZE, &ball());
            let point = frame.unproject([x, y], depth);
            let [x2, y2, depth2] = frame.project(&point).unwrap();
            prop_assert!((x2 - x).abs() < 1e-6 && (y2 - y).abs() < 1e-6 && (depth2 - depth).abs() < 1e-6);
            // The line of sight goes through it.
            let ray = frame.ray([x, y]);
            prop_assert!((point - ray.origin).cross(&ray.direction).norm() < 1e-6 * camera.distance);
        }

        #[test]
        fn orbiting_keeps_the_target_in_the_middle_and_the_eye_at_its_distance(
            camera in camera(), right in -400.0..400.0f64, up in -200.0..200.0f64,
        ) {
            let turned = camera.orbited(right, up);
            let frame = turned.frame(SIZE, &ball());
            let [x, y, _] = frame.project(&turned.target()).unwrap();
            prop_assert!((x - 320.0).abs() < 1e-6 && (y - 240.0).abs() < 1e-6);
            prop_assert!(turned.target == camera.target && turned.distance == camera.distance);
            prop_assert!((-90.0..=90.0).contains(&turned.pitch_deg) && turned.axes()[0].y.abs() < 1e-12);
        }

        #[test]
        fn dollying_keeps_the_point_under_the_cursor(
            camera in camera(), x in 0.0..640.0f64, y in 0.0..480.0f64, depth in 0.05..0.95f64, factor in 0.5..2.0f64,
        ) {
            let before = camera.frame(SIZE, &ball());
            let about = before.unproject([x, y], depth);
            let after = camera.dollied(factor, &about, &ball());
            let [x2, y2, _] = after.frame(SIZE, &ball()).project(&about).unwrap();
            prop_assert!((x2 - x).abs() < 1e-4 && (y2 - y).abs() < 1e-4, "{x2} {y2}");
            prop_assert!((after.distance / camera.distance - factor).abs() < 1e-9);
        }

        #[test]
        fn panning_moves_the_target_plane_with_the_hand(camera in camera(), dx in -200.0..200.0f64, dy in -200.0..200.0f64) {
            let held = camera.frame(SIZE, &ball()).on_target_plane([320.0, 240.0]);
            let panned = camera.panned(dx / SIZE[1], -dy / SIZE[1]);
            let [x, y, _] = panned.frame(SIZE, &ball()).project(&held).unwrap();
            prop_assert!((x - 320.0 - dx).abs() < 1e-6 && (y - 240.0 - dy).abs() < 1e-6);
        }

        #[test]
        fn a_fitted_ball_is_in_sight_and_nothing_of_it_is_cut(
            lens in lens(), aspect in 0.4..2.5f64, direction in prop::array::uniform3(-1.0..1.0f64), view in 0..7usize,
        ) {
            let size = [480.0 * aspect, 480.0];
            let frame = Camera::fitted(&ball(), StandardView::ALL[view], lens, aspect).frame(size, &ball());
            let Some(direction) = Vector3::from(direction).try_normalize(1e-3) else { return Ok(()) };
            let [x, y, depth] = frame.project(&(ball().centre + direction * ball().radius)).unwrap();
            prop_assert!((0.0..=size[0]).contains(&x) && (0.0..=size[1]).contains(&y) && (0.0..=1.0).contains(&depth));
        }

        #[test]
        fn the_ball_around_two_balls_holds_both(
            a in prop::array::uniform3(-50.0..50.0f64), b in prop::array::uniform3(-50.0..50.0f64),
            ra in 0.1..40.0f64, rb in 0.1..40.0f64,
        ) {
            let (a, b) = (Ball { centre: a.into(), radius: ra }, Ball { centre: b.into(), radius: rb });
            let both = a.with(&b);
            for one in [a, b] {
                prop_assert!((one.centre - both.centre).norm() + one.radius <= both.radius + 1e-9);
            }
        }
    }

    #[test]
    fn a_scale_bar_is_true_in_the_target_plane() {
        let camera = Camera::fitted(&ball(), StandardView::Corner, Lens::Perspective, 1.5);
        let frame = camera.frame(SIZE, &ball());
        let (left, right) = (frame.on_target_plane([100.0, 240.0]), frame.on_target_plane([200.0, 240.0]));
        assert!(((right - left).norm() - 100.0 * frame.unit_on_target()).abs() < 1e-9);
        assert!(close(&frame.on_target_plane([320.0, 240.0]), &camera.target()));
    }
}
