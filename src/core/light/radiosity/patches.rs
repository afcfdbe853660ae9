//! The flat pieces of a surface that exchange light.

use std::collections::HashMap;

use nalgebra::{Point3, Unit, Vector3};
use rayon::prelude::*;

use super::{RadiosityError, occlusion::Occluders};
use crate::Mesh;

/// Facets that meet at less than this angle belong to one smooth surface where the mesh brings no normals.
const CREASE_DEG: f64 = 30.0;
/// Heights over a plane below this fraction of the surface's diagonal are rounding of the mesh's f32 coordinates.
const FLAT: f64 = 1e-6;

/// Sizes over which rays are traced in single precision.
const DIAGONALS_MM: std::ops::RangeInclusive<f64> = 1e-6..=1e7;

/// One triangle of the surface. Its front is the side from which its corners run counter-clockwise; only the front
/// reflects, both sides block.
#[derive(Clone, Copy, Debug)]
pub struct Patch {
    /// The corners, counter-clockwise seen from the front.
    pub corners: [Point3<f64>; 3],
    /// The smooth surface's unit normal at each corner.
    pub corner_normals: [Vector3<f64>; 3],
    /// The facet's own unit normal; zero for a triangle without area.
    pub normal: Unit<Vector3<f64>>,
    /// The mean of the corners.
    pub centre: Point3<f64>,
    /// Area in the square of the mesh's unit.
    pub area_mm2: f64,
    /// Distance from the centre to the farthest corner.
    pub radius_mm: f64,
}

impl Patch {
    fn new(corners: [Point3<f64>; 3]) -> Self {
        let [a, b, c] = corners;
        let across = (b - a).cross(&(c - a));
        let doubled_area = across.norm();
        let unit = if doubled_area > 0.0 { across / doubled_area } else { Vector3::zeros() };
        let centre = Point3::from((a.coords + b.coords + c.coords) / 3.0);
        Self {
            corners,
            corner_normals: [unit; 3],
            normal: Unit::new_unchecked(unit),
            centre,
            area_mm2: doubled_area / 2.0,
            radius_mm: corners.iter().map(|corner| (corner - centre).norm()).fold(0.0, f64::max),
        }
    }

    /// The point with the barycentric weights `(1 - u - v, u, v)`.
    pub(crate) fn point(&self, u: f64, v: f64) -> Point3<f64> {
        let [a, b, c] = self.corners;
        a + (b - a) * u + (c - a) * v
    }

    /// Height of a point over the facet's plane, positive in front.
    pub(crate) fn height_mm(&self, point: &Point3<f64>) -> f64 {
        self.normal.dot(&(point - self.centre))
    }
}

/// A surface as patches, one for each triangle of the mesh and in its order, with what blocks the light between them.
#[derive(Clone, Debug)]
pub struct Patches {
    patches: Vec<Patch>,
    occluders: Occluders,
    diagonal_mm: f64,
    unoccluded: bool,
}

impl Patches {
    /// Takes every triangle of the mesh. Without normals in the mesh, facets that meet at under 30 degrees share a
    /// smooth one. A triangle without area exchanges no light.
    pub fn from_mesh(mesh: &Mesh) -> Result<Self, RadiosityError> {
        if mesh.triangles.is_empty() {
            return Err(RadiosityError::NoTriangles);
        }
        let mut patches = mesh
            .triangles
            .iter()
            .enumerate()
            .map(|(triangle, indices)| corners(mesh, indices).ok_or(RadiosityError::BadTriangle { triangle }))
            .map(|corners| corners.map(Patch::new))
            .collect::<Result<Vec<_>, _>>()?;
        if mesh.normals.len() == mesh.positions.len() {
            for (patch, triangle) in patches.iter_mut().zip(&mesh.triangles) {
                patch.corner_normals = triangle.map(|vertex| mesh.normals[vertex as usize].cast());
            }
        } else {
            smooth_normals(&mut patches);
        }
        let (low, high) = bounds(&patches);
        let diagonal_mm = (high - low).norm();
        if !DIAGONALS_MM.contains(&diagonal_mm) {
            return Err(RadiosityError::Extent { diagonal_mm });
        }
        let occluders = Occluders::new(&patches, diagonal_mm);
        let unoccluded = is_unoccluded(&patches, diagonal_mm * FLAT);
        Ok(Self { patches, occluders, diagonal_mm, unoccluded })
    }

    /// The patches.
    pub fn as_slice(&self) -> &[Patch] {
        &self.patches
    }

    /// How many patches there are.
    pub fn len(&self) -> usize {
        self.patches.len()
    }

    /// Never true: a surface has a patch.
    pub fn is_empty(&self) -> bool {
        self.patches.is_empty()
    }

    /// What blocks the light.
    pub fn occluders(&self) -> &Occluders {
        &self.occluders
    }

    /// The diagonal of the box around the surface.
    pub fn diagonal_mm(&self) -> f64 {
        self.diagonal_mm
    }

    /// Whether no patch can stand between two others: a corner, a groove, a bowl with a flat rim.
    pub fn is_unoccluded(&self) -> bool {
        self.unoccluded
    }

    /// Heights below this are rounding.
    pub(crate) fn flat_mm(&self) -> f64 {
        self.diagonal_mm * FLAT
    }

    /// For each corner of each patch, the patches that share its smooth surface there, the patch itself among them.
    pub(crate) fn around_corners(&self) -> Vec<[Vec<usize>; 3]> {
        let at_corner = patches_at_corners(&self.patches);
        let cosine = CREASE_DEG.to_radians().cos();
        let around = |patch: &Patch, k: usize| {
            let here = at_corner.get(&key(&patch.corners[k])).into_iter().flatten();
            let normal_of = |other: usize, corner: usize| self.patches[other].corner_normals[corner];
            let smooth = |&&(_, other, corner): &&_| normal_of(other, corner).dot(&patch.corner_normals[k]) > cosine;
            here.filter(smooth).map(|&(_, other, _)| other).collect()
        };
        self.patches.par_iter().map(|patch| [0, 1, 2].map(|k| around(patch, k))).collect()
    }
}

fn corners(mesh: &Mesh, triangle: &[u32; 3]) -> Option<[Point3<f64>; 3]> {
    let corner = |k: usize| mesh.positions.get(triangle[k] as usize).map(|p| p.cast::<f64>());
    let corners = [corner(0)?, corner(1)?, corner(2)?];
    corners.iter().all(|c| c.coords.iter().all(|x| x.is_finite())).then_some(corners)
}

fn bounds(patches: &[Patch]) -> (Point3<f64>, Point3<f64>) {
    let first = patches[0].corners[0];
    let all = patches.iter().flat_map(|patch| &patch.corners);
    all.fold((first, first), |(low, high), corner| (low.inf(corner), high.sup(corner)))
}

type CornerKey = [u64; 3];

fn key(corner: &Point3<f64>) -> CornerKey {
    // Adding zero makes -0 and 0 one key.
    [corner.x, corner.y, corner.z].map(|x| (x + 0.0).to_bits())
}

/// For each corner position: the unit normal, index and corner number of the patches that meet there.
fn patches_at_corners(patches: &[Patch]) -> HashMap<CornerKey, Vec<(Vector3<f64>, usize, usize)>> {
    let mut at_corner: HashMap<_, Vec<_>> = HashMap::with_capacity(patches.len());
    for (index, patch) in patches.iter().enumerate() {
        for (k, corner) in patch.corners.iter().enumerate() {
            at_corner.entry(key(corner)).or_default().push((patch.normal.into_inner(), index, k));
        }
    }
    at_corner
}

fn smooth_normals(patches: &mut [Patch]) {
    let at_corner = patches_at_corners(patches);
    let cosine = CREASE_DEG.to_radians().cos();
    let areas: Vec<f64> = patches.iter().map(|patch| patch.area_mm2).collect();
    for patch in patches {
        patch.corner_normals = patch.corners.map(|corner| {
            let around = at_corner.get(&key(&corner)).into_iter().flatten();
            let smooth = around.filter(|(normal, _, _)| normal.dot(&patch.normal) > cosine);
            let sum: Vector3<f64> = smooth.map(|&(normal, other, _)| normal * areas[other]).sum();
            sum.try_normalize(0.0).unwrap_or(patch.normal.into_inner())
        });
    }
}

/// Whether every patch's plane has all that can exchange light on one side of it: then no segment between two such
/// patches can cross a third.
fn is_unoccluded(patches: &[Patch], flat_mm: f64) -> bool {
    let mut corners: Vec<Point3<f64>> = patches.iter().flat_map(|patch| patch.corners).collect();
    corners.sort_unstable_by_key(key);
    corners.dedup();
    let sees_something = |patch: &&Patch| corners.iter().any(|corner| patch.height_mm(corner) > flat_mm);
    let mut active: Vec<Point3<f64>> = patches.par_iter().filter(sees_something).flat_map_iter(|p| p.corners).collect();
    active.sort_unstable_by_key(key);
    active.dedup();
    patches.par_iter().all(|patch| {
        let (mut before, mut behind) = (false, false);
        active.iter().all(|corner| {
            let height = patch.height_mm(corner);
            before |= height > flat_mm;
            behind |= height < -flat_mm;
            !(before && behind)
        })
    })
}
