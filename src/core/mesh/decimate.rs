//! Fewer triangles for the same surface.

use nalgebra::Point3;
use optimesh::simplifier::{SimplifyTarget, VertexData, simplify};
use thiserror::Error;

use crate::mesh::compare::{CompareError, Deviation, deviation};
use crate::mesh::topology::MeshFault;
use crate::{Mesh, Portion, Watch};

/// Fewer than a tetrahedron has are no shape.
const MIN_TRIANGLES: usize = 4;

/// How far to go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DecimateOptions {
    /// How many triangles to leave, at most.
    pub triangles: usize,
}

impl Default for DecimateOptions {
    fn default() -> Self {
        Self { triangles: 100_000 }
    }
}

impl DecimateOptions {
    /// Whether every option is in its range.
    ///
    /// # Errors
    /// `DecimateError::TooFew` for fewer triangles than make a shape.
    pub fn check(&self) -> Result<(), DecimateError> {
        let triangles = self.triangles;
        if triangles < MIN_TRIANGLES { Err(DecimateError::TooFew { triangles }) } else { Ok(()) }
    }
}

/// Why a mesh was not decimated.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum DecimateError {
    /// Fewer triangles than make a shape.
    #[error("{triangles} triangles are too few for a mesh; leave at least {MIN_TRIANGLES}")]
    TooFew {
        /// What was asked for.
        triangles: usize,
    },
    /// The mesh is unusable.
    #[error("the mesh {0}")]
    Mesh(MeshFault),
    /// Nothing is left.
    #[error("{triangles} triangles are too few for this mesh: nothing of it would be left; ask for more")]
    Gone {
        /// What was asked for.
        triangles: usize,
    },
    /// What was lost could not be measured.
    #[error("the decimated mesh cannot be measured: {0}")]
    Unmeasured(CompareError),
    /// The watch said so.
    #[error("the decimation was cancelled")]
    Cancelled,
}

/// What decimation did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DecimateReport {
    /// Triangles before.
    pub triangles_before: usize,
    /// Triangles left. More than asked for where fewer would tear the surface or fold it.
    pub triangles: usize,
    /// How far the vertices of the full mesh lie from the decimated surface, in the mesh's unit.
    pub deviation: Deviation,
}

/// A mesh with fewer triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct Decimated {
    /// The mesh. Its vertices are vertices of the full one, with their normals and colours, in the same order.
    pub mesh: Mesh,
    /// For each vertex its index in the full mesh, to take along what else is known of it.
    pub kept: Vec<u32>,
    /// What was lost.
    pub report: DecimateReport,
}

/// Takes triangles away until `options.triangles` are left, where the surface is bent least first: edges collapse in the
/// order of their quadric error (Garland and Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH
/// 1997). Borders collapse along themselves only, islands stay apart, no triangle is turned over. A mesh that has no more
/// triangles than that stays as it is.
///
/// # Errors
/// `DecimateError`: too few triangles, an unusable mesh, cancelled.
pub fn decimate(mesh: &Mesh, options: &DecimateOptions, watch: &dyn Watch) -> Result<Decimated, DecimateError> {
    options.check()?;
    if let Some(fault) = mesh.fault() {
        return Err(DecimateError::Mesh(fault));
    }
    let triangles_before = mesh.triangles.len();
    if triangles_before <= options.triangles {
        let report = DecimateReport { triangles_before, triangles: triangles_before, deviation: Deviation::default() };
        return Ok(Decimated { mesh: mesh.clone(), kept: (0..mesh.positions.len() as u32).collect(), report });
    }
    let triangles = collapsed(mesh, options.triangles);
    if triangles.is_empty() {
        return Err(DecimateError::Gone { triangles: options.triangles });
    }
    watch.progress(0.5);
    if watch.cancelled() {
        return Err(DecimateError::Cancelled);
    }

    let (decimated, kept) = with_triangles(mesh, triangles);
    let deviation = deviation(mesh, &decimated, &Portion::of(watch, 1, 2)).map_err(|error| match error {
        CompareError::Cancelled => DecimateError::Cancelled,
        error => DecimateError::Unmeasured(error),
    })?;
    let report = DecimateReport { triangles_before, triangles: decimated.triangles.len(), deviation };
    Ok(Decimated { mesh: decimated, kept, report })
}

/// The triangles that are left, by the vertices of the full mesh.
fn collapsed(mesh: &Mesh, triangles: usize) -> Vec<[u32; 3]> {
    let positions: Vec<f32> = mesh.positions.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
    let vertices = VertexData { positions: &positions, count: mesh.positions.len(), stride: size_of::<Point3<f32>>() };
    // No bound on the error: it is measured afterwards, and reported.
    let target = SimplifyTarget { target_index_count: 3 * triangles, target_error: f32::MAX, options: 0 };
    let mut indices = vec![0; 3 * mesh.triangles.len()];
    let (left, _) = simplify(&mut indices, mesh.triangles.as_flattened(), &vertices, &target);
    indices.truncate(left);
    indices.as_chunks().0.to_vec()
}

/// The part of `mesh` that `triangles` use, and the old index of each of its vertices.
fn with_triangles(mesh: &Mesh, mut triangles: Vec<[u32; 3]>) -> (Mesh, Vec<u32>) {
    let mut used = vec![false; mesh.positions.len()];
    triangles.iter().flatten().for_each(|&corner| used[corner as usize] = true);
    let kept: Vec<u32> = (0..).zip(&used).filter(|(_, used)| **used).map(|(old, _)| old).collect();
    let mut number = vec![0; used.len()];
    (0..).zip(&kept).for_each(|(new, &old)| number[old as usize] = new);
    triangles.iter_mut().flatten().for_each(|corner| *corner = number[*corner as usize]);
    let pick = |old: &u32| *old as usize;
    let mesh = Mesh {
        positions: kept.iter().map(|old| mesh.positions[pick(old)]).collect(),
        normals: kept.iter().filter_map(|old| mesh.normals.get(pick(old)).copied()).collect(),
        colours: kept.iter().filter_map(|old| mesh.colours.get(pick(old)).copied()).collect(),
        triangles,
        unit: mesh.unit,
    };
    (mesh, kept)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::mesh::{LengthUnit, MeshOptions, from_depth};
    use crate::{Camera, Mask, Plane, Projection, Unwatched};

    const SIZE: usize = 120;

    /// Waves over a mask, every attribute a function of the position, 0.25 mm a pixel.
    fn waves(mask: &Mask, height: impl Fn(f32, f32) -> f32) -> Mesh {
        let camera = Camera { projection: Projection::Orthographic { mm_per_pixel: Some(0.25) }, size: (SIZE, SIZE) };
        let depth = Plane::from_fn(SIZE, SIZE, |x, y| height(x as f32, y as f32));
        let albedo = Plane::from_fn(SIZE, SIZE, |x, y| (x + y) as f32 / 240.0);
        from_depth(&depth, mask, &camera, None, Some(&albedo), &MeshOptions::default()).unwrap().0
    }

    fn ring() -> Mask {
        Mask::from_fn(SIZE, SIZE, |x, y| (15.0..55.0).contains(&(x as f32 - 60.0).hypot(y as f32 - 60.0)))
    }

    fn decimated(mesh: &Mesh, triangles: usize) -> Decimated {
        decimate(mesh, &DecimateOptions { triangles }, &Unwatched).unwrap()
    }

    fn doubled_area(mesh: &Mesh, corners: &[u32; 3]) -> Vector3<f32> {
        let [a, b, c] = corners.map(|corner| mesh.positions[corner as usize]);
        (b - a).cross(&(c - a))
    }

    #[test]
    fn waves_keep_their_border_their_winding_and_their_attributes() {
        let full = waves(&ring(), |x, y| 2.0 * (x / 17.0).sin() + 1.5 * (y / 13.0).cos());
        let Decimated { mesh, kept, report } = decimated(&full, 3000);
        assert_eq!((report.triangles_before, report.triangles), (full.triangles.len(), mesh.triangles.len()));
        assert!(mesh.triangles.len() <= 3000 && mesh.triangles.len() > 2900);
        assert_eq!(mesh.fault(), None);
        // Along a straight border a triangle may stand upright; none faces away.
        assert!(mesh.triangles.iter().all(|corners| doubled_area(&mesh, corners).z >= 0.0));
        assert_eq!(mesh.unit, LengthUnit::Millimetre);
        for (new, &old) in kept.iter().enumerate() {
            let old = old as usize;
            assert_eq!(mesh.positions[new], full.positions[old]);
            assert_eq!((mesh.normals[new], mesh.colours[new]), (full.normals[old], full.colours[old]));
        }
        // The seen area is kept to a part of a pixel along the rims, and there are as many rims.
        let area = |mesh: &Mesh| mesh.triangles.iter().map(|corners| doubled_area(mesh, corners).z / 2.0).sum::<f32>();
        assert!((area(&mesh) / area(&full) - 1.0).abs() < 0.005, "{} of {}", area(&mesh), area(&full));
        let euler = |mesh: &Mesh| {
            let inner = (3 * mesh.triangles.len() - mesh.open_edges().border.len()) / 2;
            let edges = inner + mesh.open_edges().border.len();
            mesh.positions.len() as i64 - edges as i64 + mesh.triangles.len() as i64
        };
        assert_eq!((euler(&full), euler(&mesh)), (0, 0), "a ring stays a ring");
        assert!(report.deviation.mean < 0.01 && report.deviation.largest < 0.1, "{:?}", report.deviation);
        assert!(report.deviation.mean > 0.0 && report.deviation.mean < report.deviation.largest);
    }

    #[test]
    fn a_plane_needs_few_triangles_and_loses_nothing() {
        let plane = waves(&Mask::filled(SIZE, SIZE, true), |x, y| 0.1 * x - 0.2 * y);
        let found = decimated(&plane, 100);
        assert!(found.mesh.triangles.len() <= 100);
        assert!(found.report.deviation.largest < 1e-4, "{:?}", found.report.deviation);
    }

    #[test]
    fn fewer_triangles_cost_more() {
        let full = waves(&ring(), |x, y| 2.0 * (x / 9.0).sin() + 1.5 * (y / 7.0).cos());
        let [coarse, fine] = [500, 5000].map(|triangles| decimated(&full, triangles).report.deviation);
        assert!(coarse.mean > 3.0 * fine.mean, "{coarse:?} {fine:?}");
    }

    #[test]
    fn islands_stay_apart_and_a_small_mesh_stays_as_it_is() {
        let islands = Mask::from_fn(SIZE, SIZE, |x, y| y % 60 > 5 && x % 40 > 3);
        let full = waves(&islands, |x, _| (x / 11.0).sin());
        let found = decimated(&full, 400).mesh;
        // A triangle across a gap would be long and thin: none is wider than an island.
        let wide = |corners: &[u32; 3]| {
            let x = corners.map(|corner| found.positions[corner as usize].x);
            x.iter().copied().fold(f32::MIN, f32::max) - x.iter().copied().fold(f32::MAX, f32::min) > 9.0
        };
        assert!(!found.triangles.iter().any(wide));
        let same = decimated(&found, found.triangles.len());
        assert_eq!(same.mesh, found);
        assert_eq!(same.report.deviation, Deviation::default());
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let mesh = waves(&ring(), |_, _| 0.0);
        let refused = |mesh: &Mesh, triangles| decimate(mesh, &DecimateOptions { triangles }, &Unwatched).unwrap_err();
        assert_eq!(refused(&mesh, 3), DecimateError::TooFew { triangles: 3 });
        let empty = Mesh { triangles: vec![], ..mesh.clone() };
        assert!(matches!(refused(&empty, 100), DecimateError::Mesh(MeshFault::NoTriangle { .. })));
    }
}
