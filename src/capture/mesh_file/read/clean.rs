//! From what a file holds to a mesh in mm that every stage can use.

use firstbounce_core::Mesh;
use firstbounce_core::mesh::LengthUnit;
use firstbounce_core::mesh::topology::MeshFault;
use nalgebra::{Point3, Vector3};

use super::{LengthScale, MeshProblem, MeshWarning, RawMesh};

/// A surface measured to a hundredth of a millimetre needs coordinates at least that fine.
const COARSE_STEP_MM: f64 = 0.01;

/// A file whose normals oppose so many of its triangles, as a share of the vertices, has wrong normals: some oppose at a
/// crease.
const OPPOSING_SHARE: f64 = 0.02;

pub(super) fn clean(mut raw: RawMesh, scale: LengthScale) -> Result<(Mesh, Vec<MeshWarning>), MeshProblem> {
    let without_place = drop_unused_without_place(&mut raw);
    let polygons = raw.polygons;
    let mesh = in_mm(raw, scale)?;
    if let Some(fault) = mesh.fault() {
        return Err(MeshProblem::Fault(fault));
    }
    let (mut mesh, welded) = mesh.welded();
    if mesh.triangles.is_empty() {
        return Err(MeshProblem::Fault(MeshFault::NoTriangle { vertices: mesh.positions.len() }));
    }
    let of_triangles = mesh.area_weighted_normals();
    let opposing = mesh.normals.iter().zip(&of_triangles).filter(|(normal, other)| normal.dot(other) < 0.0).count();
    let are_wrong = opposing as f64 > OPPOSING_SHARE * mesh.positions.len() as f64;
    if mesh.normals.is_empty() || are_wrong {
        mesh.normals = of_triangles;
    }

    let unused = welded.unused_vertices + without_place;
    let non_manifold = mesh.open_edges().non_manifold;
    let largest = mesh.positions.iter().flat_map(|p| p.iter().copied()).fold(0.0f32, |most, x| most.max(x.abs()));
    let (largest_mm, step_mm) = (f64::from(largest), f64::from(largest.next_up() - largest));
    let warnings = [
        (polygons > 0, MeshWarning::PolygonsSplit { count: polygons }),
        (welded.duplicate_vertices > 0, MeshWarning::DuplicatesJoined { count: welded.duplicate_vertices }),
        (unused > 0, MeshWarning::UnusedDropped { count: unused }),
        (welded.collapsed_triangles > 0, MeshWarning::CollapsedDropped { count: welded.collapsed_triangles }),
        (are_wrong, MeshWarning::NormalsComputed { opposing }),
        (non_manifold > 0, MeshWarning::NonManifold { edges: non_manifold }),
        (step_mm > COARSE_STEP_MM, MeshWarning::CoarseCoordinates { largest_mm, step_mm }),
    ];
    Ok((mesh, warnings.into_iter().filter_map(|(applies, warning)| applies.then_some(warning)).collect()))
}

/// A cloud of points; those that are no numbers are left out.
pub(super) fn points(mut raw: RawMesh, scale: LengthScale) -> Result<(Mesh, Vec<MeshWarning>), MeshProblem> {
    let count = drop_unused_without_place(&mut raw);
    let mesh = in_mm(raw, scale)?;
    match mesh.fault_of_points() {
        Some(fault) => Err(MeshProblem::Fault(fault)),
        None if count > 0 => Ok((mesh, vec![MeshWarning::UnusedDropped { count }])),
        None => Ok((mesh, vec![])),
    }
}

fn in_mm(raw: RawMesh, scale: LengthScale) -> Result<Mesh, MeshProblem> {
    for (what, count) in [("vertices", raw.positions.len()), ("triangles", raw.triangles.len())] {
        if u32::try_from(count).is_err() {
            return Err(MeshProblem::TooLarge { what, count });
        }
    }
    let scaled = |x: f64| (x * scale.millimetres()) as f32;
    let normals: Vec<Vector3<f32>> = raw.normals.into_iter().map(Vector3::from).collect();
    let has_length = |n: &Vector3<f32>| n.norm_squared().is_normal();
    let coloured = raw.colours.as_flattened().iter().all(|channel| channel.is_finite());
    Ok(Mesh {
        positions: raw.positions.into_iter().map(|p| Point3::from(p.map(scaled))).collect(),
        normals: if normals.iter().all(has_length) { normals.iter().map(Vector3::normalize).collect() } else { vec![] },
        colours: if coloured { raw.colours.iter().map(|c| c.map(|x| x.clamp(0.0, 1.0))).collect() } else { vec![] },
        triangles: raw.triangles,
        unit: LengthUnit::Millimetre,
    })
}

/// Takes out vertices that are no numbers and that no triangle uses; how many there were.
fn drop_unused_without_place(raw: &mut RawMesh) -> usize {
    let has_place = |position: &[f64; 3]| position.iter().all(|x| x.is_finite());
    if raw.positions.iter().all(has_place) {
        return 0;
    }
    let mut keeps: Vec<bool> = raw.positions.iter().map(has_place).collect();
    for corner in raw.triangles.as_flattened() {
        if let Some(keep) = keeps.get_mut(*corner as usize) {
            *keep = true;
        }
    }
    let places = keeps.iter().scan(0, |next, keep| {
        let place = *next;
        *next += u32::from(*keep);
        Some(place)
    });
    let place_of: Vec<u32> = places.collect();
    // An index that leads nowhere goes on to do so.
    let moved = |corner: &mut u32| *corner = place_of.get(*corner as usize).copied().unwrap_or(u32::MAX);
    raw.triangles.as_flattened_mut().iter_mut().for_each(moved);
    let before = raw.positions.len();
    retain(&mut raw.positions, &keeps);
    retain(&mut raw.normals, &keeps);
    retain(&mut raw.colours, &keeps);
    before - raw.positions.len()
}

fn retain<T>(values: &mut Vec<T>, keeps: &[bool]) {
    let mut keeps = keeps.iter();
    values.retain(|_| keeps.next().copied().unwrap_or(true));
}
