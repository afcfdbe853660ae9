//! The point where a ray meets a mesh: from a click to the surface.

use nalgebra::{Point3, Vector3};
use parry3d::math::Vector;
use parry3d::query::{Ray, RayCast};
use parry3d::shape::TriMesh;

use super::Mesh;

/// A mesh with a bounding volume hierarchy, around its own centre so that f32 is enough wherever it lies.
pub struct Pickable {
    triangles: TriMesh,
    centre: Point3<f64>,
    radius: f64,
}

impl Pickable {
    /// Builds the hierarchy: about a second for three million triangles. `None` for a mesh without triangles.
    pub fn new(mesh: &Mesh) -> Option<Self> {
        let (low, high) = mesh.bounds()?;
        let (low, high) = (low.cast::<f64>(), high.cast::<f64>());
        let centre = nalgebra::center(&low, &high);
        let centred = |p: &Point3<f32>| Vector::from_array((p.cast::<f64>() - centre).cast::<f32>().into());
        let triangles = TriMesh::new(mesh.positions.iter().map(centred).collect(), mesh.triangles.clone()).ok()?;
        Some(Self { triangles, centre, radius: (high - low).norm() / 2.0 })
    }

    /// The first point of the surface that the ray meets, from either side. `direction` need not be of unit length.
    pub fn first_hit(&self, origin: &Point3<f64>, direction: &Vector3<f64>) -> Option<Point3<f64>> {
        let direction = direction.try_normalize(0.0)?;
        let from = origin - self.centre;
        // Numbers stay small when the ray begins where it enters the sphere around the mesh.
        let entry = (-from.dot(&direction) - self.radius).max(0.0);
        let start = from + direction * entry;
        let ray = Ray {
            origin: Vector::from_array(start.cast::<f32>().into()),
            dir: Vector::from_array(direction.cast::<f32>().into()),
        };
        let reach = 2.5 * self.radius as f32;
        let along = self.triangles.cast_local_ray(&ray, reach.max(f32::MIN_POSITIVE), false)?;
        Some(self.centre + start + direction * f64::from(along))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::compare::test_meshes::{bumps, relief};

    #[test]
    fn a_ray_along_z_meets_the_relief_at_its_height_wherever_it_lies() {
        for away in [0.0, 10_000.0] {
            let mut mesh = relief(120, 0.25, bumps);
            mesh.positions.iter_mut().for_each(|p| p.x += away as f32);
            let pickable = Pickable::new(&mesh).unwrap();
            for (x, y) in [(0.0, 0.0), (7.25, -3.5), (-11.0, 12.75)] {
                let origin = Point3::new(x + away, y, 5000.0);
                let hit = pickable.first_hit(&origin, &Vector3::new(0.0, 0.0, -3.0)).unwrap();
                assert!((hit.z - bumps(x, y)).abs() < 2e-3, "{hit} {}", bumps(x, y));
                let behind = pickable.first_hit(&Point3::new(x + away, y, -900.0), &Vector3::z()).unwrap();
                assert!((behind - hit).norm() < 2e-3);
            }
            assert!(pickable.first_hit(&Point3::new(away + 40.0, 0.0, 50.0), &-Vector3::z()).is_none());
        }
    }
}
