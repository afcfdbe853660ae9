//! The tools of a 3D view: point, distance, section.

use std::sync::Arc;

use nalgebra::{Point3, UnitVector3, Vector3};

use super::profile::Profile;
use crate::app::state::surfaces::LayerName;
use crate::gpu::mesh::{Camera, Kept};

/// What a click does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// Reads the position of a point.
    #[default]
    Point,
    /// Measures the distance between two points.
    Distance,
    /// Moves the section plane.
    Section,
}

/// Across what the section plane lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cut {
    /// Across x.
    X,
    /// Across y: the profile runs from left to right, as a row of the photo.
    #[default]
    Y,
    /// Across z: a contour line.
    Z,
    /// Along z through two picked points.
    Points,
}

impl Cut {
    /// All, in the order of the choice.
    pub const ALL: [Self; 4] = [Self::X, Self::Y, Self::Z, Self::Points];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::X => "Across x",
            Self::Y => "Across y",
            Self::Z => "Across z",
            Self::Points => "Through two points",
        }
    }

    /// The coordinate that stays the same in the plane.
    pub fn axis(self) -> Option<usize> {
        match self {
            Self::X => Some(0),
            Self::Y => Some(1),
            Self::Z => Some(2),
            Self::Points => None,
        }
    }
}

/// A section plane with the two directions of its plot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionPlane {
    /// A point in it.
    pub point: Point3<f64>,
    /// Across it.
    pub normal: UnitVector3<f64>,
    /// To the right in the plot.
    pub along: UnitVector3<f64>,
    /// Upward in the plot.
    pub up: UnitVector3<f64>,
    /// Where the plot's horizontal axis begins.
    pub origin: Point3<f64>,
    /// The names of the plot's axes.
    pub names: [&'static str; 2],
}

/// A point on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Picked {
    /// Of which surface.
    pub layer: LayerName,
    /// In the object frame.
    pub point: Point3<f64>,
}

/// What a 3D view keeps from frame to frame.
#[derive(Default)]
pub struct ViewState {
    /// What a click does.
    pub tool: Tool,
    /// The last points that were picked, two at most.
    pub picked: Vec<Picked>,
    /// How the section plane lies.
    pub cut: Cut,
    /// Where it lies along x, y and z; `None` for the middle of the surface.
    pub at: [Option<f64>; 3],
    pub(super) profile: Option<Profile>,
    /// The eye before the reference alone, while pairs are picked.
    pub(super) reference_camera: Option<Camera>,
    pub(in crate::app::views) kept: Arc<Kept>,
    /// Width over height when it was drawn last.
    pub(super) aspect: f64,
}

impl ViewState {
    /// A click on a surface.
    pub fn pick(&mut self, picked: Picked) {
        let pair = self.tool == Tool::Distance || (self.tool == Tool::Section && self.cut == Cut::Points);
        if !pair || self.picked.len() >= 2 {
            self.picked.clear();
        }
        self.picked.push(picked);
        if let Some(axis) = self.cut.axis().filter(|_| self.tool == Tool::Section) {
            self.at[axis] = Some(picked.point[axis]);
        }
    }

    /// From one picked point to the other.
    pub fn distance(&self) -> Option<f64> {
        match self.picked.as_slice() {
            [from, to] => Some((to.point - from.point).norm()),
            _ => None,
        }
    }

    /// The section plane, if the tool is on and knows one; `middle` is that of the surface.
    pub fn plane(&self, middle: &Point3<f64>) -> Option<SectionPlane> {
        if self.tool != Tool::Section {
            return None;
        }
        let [x, y, z] = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
        let Some(axis) = self.cut.axis() else {
            let [from, to] = self.picked.as_slice() else { return None };
            let across = to.point - from.point;
            let along = UnitVector3::try_new(Vector3::new(across.x, across.y, 0.0), 1e-9)?;
            let normal = UnitVector3::new_normalize(along.cross(&z));
            let names = ["distance from the first point", "z"];
            return Some(SectionPlane { point: from.point, normal, along, up: z, origin: from.point, names });
        };
        let mut point = Point3::origin();
        point[axis] = self.at[axis].unwrap_or(middle[axis]);
        let origin = Point3::origin();
        Some(match self.cut {
            Cut::X => SectionPlane { point, normal: x, along: y, up: z, origin, names: ["y", "z"] },
            Cut::Z => SectionPlane { point, normal: z, along: x, up: y, origin, names: ["x", "y"] },
            _ => SectionPlane { point, normal: y, along: x, up: z, origin, names: ["x", "z"] },
        })
    }
}

/// "Point on direct light: x 1.25, y -3.50, z 20.13 mm"
pub fn point_words(picked: &Picked, unit: &str) -> String {
    let [x, y, z]: [f64; 3] = picked.point.into();
    format!("Point on {}: x {x:.3}, y {y:.3}, z {z:.3} {unit}", picked.layer.in_sentence())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64, z: f64) -> Picked {
        Picked { layer: LayerName::AFTER, point: Point3::new(x, y, z) }
    }

    #[test]
    fn a_third_click_begins_a_new_distance() {
        let mut state = ViewState { tool: Tool::Distance, ..ViewState::default() };
        state.pick(at(0.0, 0.0, 0.0));
        assert_eq!(state.distance(), None);
        state.pick(at(3.0, 0.0, 4.0));
        assert_eq!(state.distance(), Some(5.0));
        state.pick(at(1.0, 1.0, 1.0));
        assert_eq!((state.picked.len(), state.distance()), (1, None));
    }

    #[test]
    fn the_plane_through_two_points_holds_both_and_the_viewing_axis() {
        let mut state = ViewState { tool: Tool::Section, cut: Cut::Points, ..ViewState::default() };
        let middle = Point3::new(5.0, 6.0, 7.0);
        assert!(state.plane(&middle).is_none());
        state.pick(at(1.0, 2.0, 3.0));
        state.pick(at(4.0, 6.0, -3.0));
        let plane = state.plane(&middle).unwrap();
        for picked in &state.picked {
            assert!(plane.normal.dot(&(picked.point - plane.point)).abs() < 1e-12);
        }
        assert!(plane.normal.z.abs() < 1e-12);
        assert!((plane.along.dot(&(state.picked[1].point - plane.origin)) - 5.0).abs() < 1e-12);
        state.cut = Cut::X;
        assert_eq!(state.plane(&middle).unwrap().point.x, 5.0);
        state.pick(at(8.0, 0.0, 0.0));
        assert_eq!(state.plane(&middle).unwrap().point.x, 8.0);
    }
}
