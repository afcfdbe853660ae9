//! The eye of the 3D view: where it is, what it sees, and the way between points of the object and of the screen.
//!
//! The object frame is that of the capture: x right, y up, z toward the photographing camera. The front view is what that
//! camera saw.

mod bounds;
mod frame;
#[cfg(test)]
mod tests;

use nalgebra::{Point3, UnitVector3, Vector3};
use serde::{Deserialize, Serialize};

pub use bounds::Bounds;
pub use frame::{Frame, Ray};

/// Angle of view from top to bottom.
const FIELD_OF_VIEW_DEG: f64 = 30.0;
/// The box around the object fills this part of the view when it is fitted.
const FILLED: f64 = 0.94;
/// The nearest that is drawn, as a part of the farthest: what is left to the depth buffer.
const NEAREST: f64 = 1e-3;
/// The eye stays within these multiples of the object's radius.
const DISTANCES: (f64, f64) = (1e-3, 1e3);

/// Beyond this single precision, which the card draws with, loses the object.
const MAX_LENGTH: f64 = 1e12;
/// A few thousand turns.
const MAX_ANGLE_DEG: f64 = 1e6;

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
    /// Whether it can look at anything: its numbers come from a file that may say anything.
    pub fn is_usable(&self) -> bool {
        let lengths = self.target.iter().copied().chain([self.distance]);
        let angles = [self.yaw_deg, self.pitch_deg];
        self.distance > 0.0
            && lengths.into_iter().all(|length| length.abs() <= MAX_LENGTH)
            && angles.into_iter().all(|angle| angle.abs() <= MAX_ANGLE_DEG)
    }

    /// Everything in the bounds, seen from a named side, in a view of the given width over height.
    pub fn fitted(bounds: &Bounds, view: StandardView, lens: Lens, aspect: f64) -> Self {
        let (yaw_deg, pitch_deg) = view.turns_deg();
        let from = Self { target: [0.0; 3], yaw_deg, pitch_deg, distance: 1.0, lens };
        from.refitted(bounds, aspect)
    }

    /// The same direction, with everything in the bounds in sight and no more room around it than that takes.
    pub fn refitted(&self, bounds: &Bounds, aspect: f64) -> Self {
        let target = bounds.centre();
        let reach = FILLED * half_angle().tan();
        let needed = |corner: Point3<f64>| {
            let [right, up, near] = self.axes().map(|axis| axis.dot(&(corner - target)));
            let sideways = (right.abs() / aspect).max(up.abs()) / reach;
            match self.lens {
                Lens::Perspective => near + sideways,
                Lens::Orthographic => sideways,
            }
        };
        let distance = bounds.corners().map(needed).into_iter().fold(DISTANCES.0 * bounds.radius(), f64::max);
        Self { target: target.into(), distance, ..*self }
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

    /// Everything `1 / factor` times as large, `about` staying where it is on the screen. `bounds` keeps the eye within reach.
    pub fn dollied(&self, factor: f64, about: &Point3<f64>, bounds: &Bounds) -> Self {
        let distance = (self.distance * factor).clamp(DISTANCES.0 * bounds.radius(), DISTANCES.1 * bounds.radius());
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

    /// All that a frame needs to know, for a view of `size` (in any unit: points or pixels) onto what is in the bounds.
    pub fn frame(&self, size: [f64; 2], bounds: &Bounds) -> Frame {
        let axes = self.axes();
        let eye = self.target() + axes[2].into_inner() * self.distance;
        let middle = axes[2].dot(&(eye - bounds.centre()));
        let reach = bounds.radius() * 1.001;
        let (near, far) = (middle - reach, middle + reach);
        let (near, far) = match self.lens {
            Lens::Orthographic => (near, far),
            Lens::Perspective => {
                let far = far.max(self.distance * NEAREST);
                (near.max(far * NEAREST), far * (1.0 + NEAREST))
            }
        };
        Frame::new(*self, eye, (near, far), size)
    }
}

fn half_angle() -> f64 {
    FIELD_OF_VIEW_DEG.to_radians() / 2.0
}
