//! A camera over a view: between points of the object and places on the screen.

use nalgebra::{Matrix4, Point3, UnitVector3};

use super::{Camera, Lens, half_angle};

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
    /// `near` and `far` are distances from the eye along the view.
    pub(super) fn new(camera: Camera, eye: Point3<f64>, (near, far): (f64, f64), size: [f64; 2]) -> Self {
        Self { camera, axes: camera.axes(), eye, near, far, size: size.map(|side| side.max(1.0)) }
    }

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
