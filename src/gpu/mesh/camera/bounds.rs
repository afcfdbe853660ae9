//! Bounds of all that is to be in view.

use nalgebra::{Isometry3, Point3, Vector3};

/// The box around everything that is shown, along the axes of the object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    low: Point3<f64>,
    high: Point3<f64>,
}

impl Bounds {
    /// The box between two corners; a single point is taken with a room of 1 around it.
    pub fn new(low: Point3<f64>, high: Point3<f64>) -> Self {
        if low == high {
            let room = Vector3::repeat(1.0 / 3.0_f64.sqrt());
            return Self { low: low - room, high: high + room };
        }
        Self { low, high }
    }

    /// The middle of the box.
    pub fn centre(&self) -> Point3<f64> {
        nalgebra::center(&self.low, &self.high)
    }

    /// Of the ball around the box; more than zero.
    pub fn radius(&self) -> f64 {
        (self.high - self.low).norm() / 2.0
    }

    /// The ends of the box along an axis: 0 for x, 1 for y, 2 for z.
    pub fn along(&self, axis: usize) -> [f64; 2] {
        [self.low[axis], self.high[axis]]
    }

    /// The box's corners.
    pub fn corners(&self) -> [Point3<f64>; 8] {
        let side = |corner: usize, axis: usize| {
            if corner >> axis & 1 == 0 { self.low[axis] } else { self.high[axis] }
        };
        std::array::from_fn(|corner| Point3::new(side(corner, 0), side(corner, 1), side(corner, 2)))
    }

    /// The box around this one after a motion.
    pub fn moved(&self, motion: &Isometry3<f64>) -> Self {
        let corners = self.corners().map(|corner| motion * corner);
        let (mut low, mut high) = (corners[0], corners[0]);
        for corner in &corners[1..] {
            (low, high) = (low.inf(corner), high.sup(corner));
        }
        Self { low, high }
    }

    /// The box around both.
    pub fn with(&self, other: &Self) -> Self {
        Self { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }
}
