//! The distance of every vertex to a reference.

use nalgebra::{Isometry3, Matrix4, Point3, Vector3};
use rayon::prelude::*;

use super::surface::Surface;
use super::{CompareError, Side, check_points};
use crate::options::check_range;
use crate::{Mesh, Watch};

/// Vertices measured between two looks at the watch.
const BLOCK: usize = 1 << 16;

/// What `limit_mm` may be.
const LIMITS_MM: std::ops::RangeInclusive<f64> = 1e-6..=1e9;

/// What counts as a counterpart.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DistanceOptions {
    /// How far a vertex may be from the reference to have a counterpart there, in mm; by default a tenth of the
    /// reference's diagonal.
    pub limit_mm: Option<f64>,
}

impl DistanceOptions {
    /// Refuses a limit that no surface can be within, or that single precision cannot compute with.
    pub fn check(&self) -> Result<(), CompareError> {
        let limit_mm = self.limit_mm.unwrap_or(1.0);
        Ok(check_range("limit_mm", limit_mm, LIMITS_MM.contains(&limit_mm), "from 1e-6 to 1e9 mm")?)
    }
}

/// How far mesh A is from mesh B. The figures are over the vertices of A that have a counterpart on B.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// For each vertex of A its distance to the surface of B, positive outside, negative inside; `None` where B ends
    /// before it or is beyond the limit.
    pub signed_mm: Vec<Option<f32>>,
    /// Mean of the distances without their signs.
    pub mean_mm: f64,
    /// Mean of the distances with their signs: how far A lies outside B on the whole.
    pub bias_mm: f64,
    /// Root mean square distance.
    pub rms_mm: f64,
    /// 95 % of the vertices are closer than this.
    pub p95_mm: f64,
    /// The largest distance.
    pub max_mm: f64,
    /// Fraction of A's vertices that have a counterpart, 0 to 1.
    pub overlap: f64,
    /// Mean angle between A's vertex normals and B's normals at the closest points; NaN for points without normals.
    pub orientation_error_deg: f64,
    /// Angle of the rotation that was applied to A.
    pub rotation_deg: f64,
    /// Translation part of `matrix`.
    pub translation_mm: Vector3<f64>,
    /// The motion that was applied to A, for column vectors: A onto B.
    pub matrix: Matrix4<f64>,
}

/// Measures every vertex of `a`, moved by `a_to_b`, against the surface of `b`.
///
/// # Errors
/// Meshes that are empty, not finite, or in pixels; a limit that is not positive; `NothingWithin` if no vertex has
/// a counterpart; cancelled.
pub fn distances(
    a: &Mesh,
    b: &Mesh,
    a_to_b: &Isometry3<f64>,
    options: &DistanceOptions,
    watch: &dyn Watch,
) -> Result<Comparison, CompareError> {
    options.check()?;
    check_points(a, Side::Moving)?;
    let surface = Surface::new(b, Side::Fixed)?;
    let limit_mm = options.limit_mm.unwrap_or(0.1 * surface.diagonal_mm);
    // The normals of points that have none are of no direction, and so is their angle to any.
    let computed = match (a.normals.is_empty(), a.triangles.is_empty()) {
        (true, true) => vec![Vector3::repeat(f32::NAN); a.positions.len()],
        (true, false) => a.area_weighted_normals(),
        (false, _) => vec![],
    };
    let normals = if a.normals.is_empty() { &computed } else { &a.normals };

    let mut met = Vec::with_capacity(a.positions.len());
    for (positions, normals) in a.positions.chunks(BLOCK).zip(normals.chunks(BLOCK)) {
        if watch.cancelled() {
            return Err(CompareError::Cancelled);
        }
        met.par_extend(positions.par_iter().zip(normals).map(|(position, normal)| {
            let point = Point3::from(a_to_b * position.cast::<f64>() - surface.centre);
            let foot = surface.closest(&point, limit_mm).filter(|foot| !foot.beyond_border)?;
            Some((foot.signed_mm, (a_to_b.rotation * normal.cast()).angle(&foot.normal).to_degrees()))
        }));
        watch.progress(met.len() as f32 / a.positions.len() as f32);
    }
    summary(&met, a_to_b, limit_mm)
}

fn summary(met: &[Option<(f64, f64)>], a_to_b: &Isometry3<f64>, limit_mm: f64) -> Result<Comparison, CompareError> {
    let mut sizes: Vec<f64> = met.iter().flatten().map(|(signed, _)| signed.abs()).collect();
    if sizes.is_empty() {
        return Err(CompareError::NothingWithin { limit_mm });
    }
    let count = sizes.len() as f64;
    sizes.par_sort_unstable_by(f64::total_cmp);
    let at = |fraction: f64| sizes[((count * fraction).ceil() as usize).clamp(1, sizes.len()) - 1];
    let mean = |value: fn(&(f64, f64)) -> f64| met.iter().flatten().map(value).sum::<f64>() / count;
    Ok(Comparison {
        signed_mm: met.iter().map(|met| met.map(|(signed, _)| signed as f32)).collect(),
        mean_mm: mean(|(signed, _)| signed.abs()),
        bias_mm: mean(|(signed, _)| *signed),
        rms_mm: mean(|(signed, _)| signed * signed).sqrt(),
        p95_mm: at(0.95),
        max_mm: at(1.0),
        overlap: count / met.len() as f64,
        orientation_error_deg: mean(|(_, degrees)| *degrees),
        rotation_deg: a_to_b.rotation.angle().to_degrees(),
        translation_mm: a_to_b.translation.vector,
        matrix: a_to_b.to_homogeneous(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Unwatched;
    use crate::mesh::compare::test_meshes::relief;

    fn measure(a: &Mesh, b: &Mesh, limit_mm: Option<f64>) -> Comparison {
        distances(a, b, &Isometry3::identity(), &DistanceOptions { limit_mm }, &Unwatched).unwrap()
    }

    #[test]
    fn a_shell_half_a_mm_outside_a_sphere_is_half_a_mm_away_everywhere() {
        let cap = |radius: f64| move |x: f64, y: f64| (radius * radius - x * x - y * y).sqrt();
        let found = measure(&relief(100, 0.3, cap(50.5)), &relief(160, 0.25, cap(50.0)), None);
        assert!((found.mean_mm - 0.5).abs() < 1e-3 && (found.bias_mm - 0.5).abs() < 1e-3, "{found:?}");
        assert!((found.rms_mm - 0.5).abs() < 1e-3 && (found.p95_mm - 0.5).abs() < 2e-3);
        assert!(found.orientation_error_deg < 0.2 && found.overlap == 1.0);
        let inside = measure(&relief(100, 0.3, cap(49.5)), &relief(160, 0.25, cap(50.0)), None);
        assert!((inside.bias_mm + 0.5).abs() < 1e-3);
    }

    #[test]
    fn a_ramp_has_the_distances_and_the_angle_of_a_ramp() {
        // Heights up to 1.6 mm over 40 mm, over a larger plane.
        let slope = 0.04f64;
        let found = measure(&relief(80, 0.5, |x, _| slope * (x + 20.0)), &relief(60, 1.0, |_, _| 0.0), None);
        assert!((found.mean_mm - 0.8).abs() < 1e-4 && (found.max_mm - 1.6).abs() < 1e-4);
        assert!((found.rms_mm - 1.6 / 3f64.sqrt()).abs() < 0.01);
        assert!((found.p95_mm - 0.95 * 1.6).abs() < 0.02);
        assert!((found.orientation_error_deg - slope.atan().to_degrees()).abs() < 1e-3);
    }

    #[test]
    fn what_the_reference_lacks_does_not_count() {
        let plane = relief(40, 1.0, |_, _| 0.0);
        // Half of the copy hangs over the edge; what lies over the plane is 3 mm above it.
        let copy = plane.clone().moved(&Isometry3::translation(20.5, 0.0, 3.0));
        let found = measure(&copy, &plane, None);
        assert!((found.overlap - 20.0 / 41.0).abs() < 1e-9 && (found.max_mm - 3.0).abs() < 1e-5);
        assert_eq!(found.signed_mm.iter().filter(|signed| signed.is_none()).count(), 21 * 41);
        let none = DistanceOptions { limit_mm: Some(2.0) };
        let refused = distances(&copy, &plane, &Isometry3::identity(), &none, &Unwatched);
        assert_eq!(refused, Err(CompareError::NothingWithin { limit_mm: 2.0 }));
    }
}
