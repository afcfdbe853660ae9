//! From what a file holds to a mesh in mm that every stage can use.

use firstbounce_core::Mesh;
use firstbounce_core::mesh::LengthUnit;
use firstbounce_core::mesh::topology::MeshFault;
use nalgebra::{Point3, Vector3};

use super::{LengthScale, MeshProblem, MeshWarning, RawMesh};

/// A surface measured to a hundredth of a millimetre needs coordinates at least that fine.
const COARSE_STEP_MM: f64 = 0.01;

pub(super) fn clean(raw: RawMesh, scale: LengthScale) -> Result<(Mesh, Vec<MeshWarning>), MeshProblem> {
    for (what, count) in [("vertices", raw.positions.len()), ("triangles", raw.triangles.len())] {
        if u32::try_from(count).is_err() {
            return Err(MeshProblem::TooLarge { what, count });
        }
    }
    let in_mm = |x: f64| (x * scale.millimetres()) as f32;
    let normals: Vec<Vector3<f32>> = raw.normals.into_iter().map(Vector3::from).collect();
    let has_length = |n: &Vector3<f32>| n.norm_squared().is_normal();
    let coloured = raw.colours.as_flattened().iter().all(|channel| channel.is_finite());
    let mesh = Mesh {
        positions: raw.positions.into_iter().map(|p| Point3::from(p.map(in_mm))).collect(),
        normals: if normals.iter().all(has_length) { normals.iter().map(Vector3::normalize).collect() } else { vec![] },
        colours: if coloured { raw.colours.iter().map(|c| c.map(|x| x.clamp(0.0, 1.0))).collect() } else { vec![] },
        triangles: raw.triangles,
        unit: LengthUnit::Millimetre,
    };
    if let Some(fault) = mesh.fault() {
        return Err(MeshProblem::Fault(fault));
    }
    let (mut mesh, welded) = mesh.welded();
    if mesh.triangles.is_empty() {
        return Err(MeshProblem::Fault(MeshFault::NoTriangle { vertices: mesh.positions.len() }));
    }
    if mesh.normals.is_empty() {
        mesh.normals = mesh.area_weighted_normals();
    }

    let non_manifold = mesh.open_edges().non_manifold;
    let largest = mesh.positions.iter().flat_map(|p| p.iter().copied()).fold(0.0f32, |most, x| most.max(x.abs()));
    let (largest_mm, step_mm) = (f64::from(largest), f64::from(largest.next_up() - largest));
    let warnings = [
        (raw.polygons > 0, MeshWarning::PolygonsSplit { count: raw.polygons }),
        (welded.duplicate_vertices > 0, MeshWarning::DuplicatesJoined { count: welded.duplicate_vertices }),
        (welded.unused_vertices > 0, MeshWarning::UnusedDropped { count: welded.unused_vertices }),
        (welded.collapsed_triangles > 0, MeshWarning::CollapsedDropped { count: welded.collapsed_triangles }),
        (non_manifold > 0, MeshWarning::NonManifold { edges: non_manifold }),
        (step_mm > COARSE_STEP_MM, MeshWarning::CoarseCoordinates { largest_mm, step_mm }),
    ];
    Ok((mesh, warnings.into_iter().filter_map(|(applies, warning)| applies.then_some(warning)).collect()))
}
