//! The rigid motion between picked points, in closed form.

use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion};

use super::CompareError;
use crate::linear_algebra;

/// A pair's spread across its longest line must be this fraction of the spread along it.
const MIN_SPREAD: f64 = 1e-3;

/// A rigid motion fitted to pairs of points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidFit {
    /// Takes the first point of each pair near the second.
    pub motion: Isometry3<f64>,
    /// What is left between them, root mean square, in the points' unit.
    pub rms: f64,
}

/// The rigid motion that takes the first points of `pairs` closest to the second ones, in the least squares sense.
///
/// Kabsch 1978; the guard against a mirrored solution is from Umeyama 1991, equation 43.
///
/// # Errors
/// `PairsOnALine` if there are fewer than three pairs, if one side's points lie on a line, or if one is not finite.
pub fn rigid_from_pairs(pairs: &[(Point3<f64>, Point3<f64>)]) -> Result<RigidFit, CompareError> {
    let on_a_line = CompareError::PairsOnALine { count: pairs.len() };
    let is_finite = |p: &Point3<f64>| p.iter().all(|x| x.is_finite());
    if pairs.len() < 3 || !pairs.iter().all(|(from, to)| is_finite(from) && is_finite(to)) {
        return Err(on_a_line);
    }
    let count = pairs.len() as f64;
    let from_centre = Point3::from(pairs.iter().map(|(from, _)| from.coords).sum::<nalgebra::Vector3<f64>>() / count);
    let to_centre = Point3::from(pairs.iter().map(|(_, to)| to.coords).sum::<nalgebra::Vector3<f64>>() / count);
    let mut covariance = Matrix3::zeros();
    let mut spreads = [Matrix3::zeros(); 2];
    for (from, to) in pairs {
        let (from, to) = (from - from_centre, to - to_centre);
        covariance += to * from.transpose();
        spreads[0] += from * from.transpose();
        spreads[1] += to * to.transpose();
    }
    for spread in spreads {
        let Some(eigen) = linear_algebra::symmetric_eigen(spread) else { return Err(on_a_line) };
        let mut variances = eigen.eigenvalues;
        variances.as_mut_slice().sort_by(f64::total_cmp);
        if variances[1] <= MIN_SPREAD.powi(2) * variances[2] {
            return Err(on_a_line);
        }
    }
    let Some((u, v_t)) = linear_algebra::singular_vectors(&covariance) else { return Err(on_a_line) };
    let mut mirror = Matrix3::identity();
    mirror[(2, 2)] = (u * v_t).determinant().signum();
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(u * mirror * v_t));
    let motion = Isometry3::from_parts(Translation3::from(to_centre - rotation * from_centre), rotation);
    let rms = (pairs.iter().map(|(from, to)| (motion * from - to).norm_squared()).sum::<f64>() / count).sqrt();
    Ok(RigidFit { motion, rms })
}

#[cfg(test)]
mod tests {
    use nalgebra::{Vector3, vector};
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]
        #[test]
        fn three_pairs_give_back_the_motion_that_made_them(
            axis in prop::array::uniform3(-3.0..3.0f64), shift in prop::array::uniform3(-1e4..1e4f64),
        ) {
            let motion = Isometry3::new(Vector3::from(shift), Vector3::from(axis));
            let corners = [[0.0, 0.0, 0.0], [40.0, 3.0, -2.0], [5.0, 30.0, 8.0]].map(Point3::from);
            let fit = rigid_from_pairs(&corners.map(|p| (p, motion * p))).unwrap();
            prop_assert!(fit.motion.rotation.angle_to(&motion.rotation) < 1e-7);
            prop_assert!((fit.motion.translation.vector - motion.translation.vector).norm() < 1e-6);
            prop_assert!(fit.rms < 1e-6);
        }
    }

    #[test]
    fn points_on_a_line_are_refused() {
        let line = [0.0, 1.0, 2.0].map(|t| Point3::from(vector![t, 2.0 * t, 5.0]));
        assert_eq!(rigid_from_pairs(&line.map(|p| (p, p))), Err(CompareError::PairsOnALine { count: 3 }));
        assert_eq!(rigid_from_pairs(&line.map(|p| (p, p))[..2]), Err(CompareError::PairsOnALine { count: 2 }));
    }
}
