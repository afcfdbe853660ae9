//! Occlusion between two points.

use nalgebra::{Point3, Vector3};
use obvhs::{
    BvhBuildParams,
    aabb::Aabb,
    cwbvh::{CwBvh, builder::build_cwbvh},
    ray::{Ray, RayHit},
};

use super::patches::Patch;

/// The tree's boxes and rays are f32: boxes grow by this fraction of the diagonal so that rounding loses no triangle.
const BOX_MARGIN: f64 = 1e-5;
/// Walls that meet in a crease overlap by the rounding of their f32 corners: nothing blocks within this fraction of the
/// diagonal from either end of a segment.
const CLEARANCE: f64 = 1e-5;

/// Where a ray first meets the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The patch, an index into `Patches::as_slice`.
    pub patch: usize,
    /// Distance in lengths of the ray's direction.
    pub distance: f64,
    /// Barycentric weights of the second and third corner.
    pub weights: (f64, f64),
}

/// The triangles of a surface in a bounding volume hierarchy (`obvhs`); the tests against triangles are in f64.
#[derive(Clone, Debug)]
pub struct Occluders {
    tree: CwBvh,
    /// In the order of the tree's leaves: first corner, the two edges from it, and the patch they belong to.
    triangles: Vec<(Point3<f64>, [Vector3<f64>; 2], usize)>,
    clearance_mm: f64,
}

impl Occluders {
    pub(super) fn new(patches: &[Patch], diagonal_mm: f64) -> Self {
        let margin = Vector3::repeat(diagonal_mm * BOX_MARGIN);
        let bounds = |patch: &Patch| {
            let [a, b, c] = patch.corners;
            Aabb::new(single(&(a.inf(&b).inf(&c) - margin)).into(), single(&(a.sup(&b).sup(&c) + margin)).into())
        };
        let boxes: Vec<Aabb> = patches.iter().map(bounds).collect();
        let tree = build_cwbvh(&boxes, BvhBuildParams::medium_build(), &mut Default::default());
        let leaf = |&patch: &u32| {
            let [a, b, c] = patches[patch as usize].corners;
            (a, [b - a, c - a], patch as usize)
        };
        let triangles = tree.primitive_indices.iter().map(leaf).collect();
        Self { tree, triangles, clearance_mm: diagonal_mm * CLEARANCE }
    }

    /// The first triangle on the ray from `origin` along `direction`, seen from either side, other than `skip`.
    pub fn first_hit(&self, origin: &Point3<f64>, direction: &Vector3<f64>, skip: Option<usize>) -> Option<Hit> {
        let ray = Ray::new(single(origin).into(), single(&Point3::from(*direction)).into(), 0.0, f32::INFINITY);
        let mut nearest: Option<Hit> = None;
        self.tree.ray_traverse(ray, &mut RayHit::none(), |_, leaf| {
            let Some(hit) = self.intersect(leaf, origin, direction).filter(|hit| Some(hit.patch) != skip) else {
                return f32::INFINITY;
            };
            if nearest.is_none_or(|nearest| hit.distance < nearest.distance) {
                nearest = Some(hit);
            }
            // The tree compares in f32; a hair more keeps a nearer hit from being pruned by rounding.
            (hit.distance * (1.0 + 1e-6)) as f32
        });
        nearest
    }

    /// Whether a triangle other than the two in `skip` crosses the open segment.
    pub fn blocked(&self, from: &Point3<f64>, to: &Point3<f64>, skip: [Option<usize>; 2]) -> bool {
        let direction = to - from;
        let ray = Ray::new(single(from).into(), single(&Point3::from(direction)).into(), 0.0, 1.0);
        let clearance = self.clearance_mm / direction.norm();
        let between = clearance..1.0 - clearance;
        !self.tree.ray_traverse_miss(ray, |_, leaf| match self.intersect(leaf, from, &direction) {
            Some(hit) if between.contains(&hit.distance) && !skip.contains(&Some(hit.patch)) => hit.distance as f32,
            _ => f32::INFINITY,
        })
    }

    /// Moeller and Trumbore 1997, from either side.
    fn intersect(&self, leaf: usize, origin: &Point3<f64>, direction: &Vector3<f64>) -> Option<Hit> {
        // Rays along the seam of two triangles must hit one of them.
        const SEAM: f64 = 1e-9;
        let (corner, [first, second], patch) = &self.triangles[leaf];
        let p = direction.cross(second);
        let determinant = first.dot(&p);
        if determinant == 0.0 {
            return None;
        }
        let from_corner = origin - corner;
        let u = from_corner.dot(&p) / determinant;
        if !(-SEAM..=1.0 + SEAM).contains(&u) {
            return None;
        }
        let q = from_corner.cross(first);
        let v = direction.dot(&q) / determinant;
        let distance = second.dot(&q) / determinant;
        (v >= -SEAM && u + v <= 1.0 + SEAM && distance > 1e-9).then_some(Hit {
            patch: *patch,
            distance,
            weights: (u, v),
        })
    }
}

fn single(point: &Point3<f64>) -> [f32; 3] {
    // Adding zero turns -0 into 0: the tree takes the sign of a direction's component in two ways that differ for -0.
    [point.x as f32 + 0.0, point.y as f32 + 0.0, point.z as f32 + 0.0]
}
