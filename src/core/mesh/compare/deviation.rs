//! The deviation of a mesh from the one it was made from.

use rayon::prelude::*;

use super::surface::Surface;
use super::{CompareError, Side, check_sound};
use crate::{Mesh, Watch};

/// Vertices measured between two looks at the watch.
const BLOCK: usize = 1 << 16;

/// Distances of one mesh's vertices from another mesh's surface, in the unit of both.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// Mean distance.
    pub mean: f64,
    /// The largest distance.
    pub largest: f64,
}

/// Measures every vertex of `mesh` against the closest point of `surface`: of two versions of one surface, where a border
/// that shrank is a deviation like any other. A vertex that has no closest point, or none with a normal, enters no figure. The
/// meshes lie in one frame and have one unit, which may be the pixel.
///
/// # Errors
/// Meshes that are empty or not finite, no vertex that can be measured; cancelled.
pub fn deviation(mesh: &Mesh, surface: &Mesh, watch: &dyn Watch) -> Result<Deviation, CompareError> {
    check_sound(mesh, Side::Moving)?;
    let surface = Surface::in_own_unit(surface, Side::Fixed)?;
    let (mut sum, mut largest, mut measured) = (0.0_f64, 0.0_f64, 0);
    for (block, positions) in mesh.positions.chunks(BLOCK).enumerate() {
        if watch.cancelled() {
            return Err(CompareError::Cancelled);
        }
        let distance = |position: &nalgebra::Point3<f32>| {
            let point = (position.cast::<f64>() - surface.centre).into();
            surface.closest(&point, f64::MAX).map(|foot| foot.signed_mm.abs())
        };
        let distances: Vec<f64> = positions.par_iter().filter_map(distance).collect();
        measured += distances.len();
        sum += distances.iter().sum::<f64>();
        largest = distances.into_iter().fold(largest, f64::max);
        watch.progress((block * BLOCK + positions.len()) as f32 / mesh.positions.len() as f32);
    }
    if measured == 0 {
        return Err(CompareError::NoExtent { side: Side::Fixed });
    }
    Ok(Deviation { mean: sum / measured as f64, largest })
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use super::*;
    use crate::Unwatched;
    use crate::mesh::LengthUnit;
    use crate::mesh::compare::test_meshes::relief;
    use crate::mesh::topology::MeshFault;

    #[test]
    fn a_shrunken_border_counts_and_pixels_do_too() {
        let flat = |cells, pitch| Mesh { unit: LengthUnit::Pixel, ..relief(cells, pitch, |_, _| 0.0) };
        // 20 by 20 around the origin against 16 by 16: the corners stick out by 2 in both directions.
        let found = deviation(&flat(20, 1.0), &flat(16, 1.0), &Unwatched).unwrap();
        assert!((found.largest - 8.0_f64.sqrt()).abs() < 1e-5, "{found:?}");
        assert!(found.mean > 0.3 && found.mean < 1.0, "{found:?}");
        assert_eq!(deviation(&flat(16, 1.0), &flat(20, 1.0), &Unwatched).unwrap(), Deviation::default());
    }

    #[test]
    fn what_lies_too_far_to_be_measured_is_refused() {
        // So far away that the square of the distance is no single-precision number.
        let vertex_1 = MeshFault::TooFar { vertex: 1, coordinate: 1e25 };
        let surface = relief(1, 2.0, |_, _| 0.0);
        let at = |points: &[[f32; 3]]| Mesh {
            positions: points.iter().map(|point| Point3::from(*point)).collect(),
            normals: vec![],
            colours: vec![],
            triangles: vec![[0, 1, 2]],
            unit: LengthUnit::Millimetre,
        };
        let (near, far) = ([0.1, 0.2, 3.0], [1e25, 0.0, 0.0]);
        let found = deviation(&at(&[near, far, near]), &surface, &Unwatched);
        assert_eq!(found, Err(CompareError::Mesh { side: Side::Moving, fault: vertex_1 }));
    }
}
