//! One colour ratio for all indirect light of a light: the same small matrix for every pixel.

use nalgebra::DMatrix;

use super::split::Split;
use crate::separate::{SeparateError, check_order};

/// The 2 x n matrix that takes the n photos of a light, in their own linear light, to direct light L_1 and indirect light I of
/// the reference colour: `N_c / alpha_c = beta_c L_1 + beta_c ratio_c I`, weighted by the photos' noise `sigma`.
///
/// # Errors
/// As [`check_order`]; `Singular` where the ratios do not tell direct from indirect light.
pub fn even_operator(alpha: &[f64], beta: &[f64], ratio: &[f64], sigma: &[f64]) -> Result<DMatrix<f64>, SeparateError> {
    check_order(alpha, beta, 1)?;
    let noise = |c: usize| sigma[c] / alpha[c];
    let least = (0..beta.len()).map(noise).fold(f64::INFINITY, f64::min);
    let precision = |c: usize| if least > 0.0 && noise(c).is_finite() { (least / noise(c)).powi(2) } else { 1.0 };
    // Column c is what unit light in colour c alone would be split into.
    let column = |lit: usize| {
        let mut split = Split::default();
        for c in 0..beta.len() {
            let light = if c == lit { alpha[c].recip() } else { 0.0 };
            split.add(light, precision(c), beta[c], ratio[c]);
        }
        let (information, weighted) = split.indirect();
        split.direct().map(|(direct, _)| [direct, weighted / information])
    };
    let columns: Option<Vec<_>> = (0..beta.len()).map(column).collect();
    let columns = columns.ok_or(SeparateError::Singular { bounces: 2, condition_number: f64::INFINITY })?;
    Ok(DMatrix::from_fn(2, beta.len(), |row, c| columns[c][row]))
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;
    use proptest::prelude::*;

    use super::*;

    const BETA: [f64; 3] = [1.0, 0.6, 0.3];

    proptest! {
        #[test]
        fn light_that_was_mixed_by_one_ratio_is_split(
            direct in 0.0..1.0_f64,
            indirect in 0.0..1.0_f64,
            r in 0.3..0.9_f64,
            alpha in prop::collection::vec(0.3..4.0_f64, 3),
            sigma in prop::collection::vec(0.1..2.0_f64, 3),
        ) {
            let ratio = [1.0, r, r * r];
            let operator = even_operator(&alpha, &BETA, &ratio, &sigma).unwrap();
            let photos = DVector::from_fn(3, |c, _| alpha[c] * BETA[c] * (direct + ratio[c] * indirect));
            let split = operator * photos;
            prop_assert!((split[0] - direct).abs() < 1e-9 && (split[1] - indirect).abs() < 1e-9);
        }
    }

    #[test]
    fn photos_without_known_noise_count_alike() {
        let ratio = [1.0, 0.7, 0.5];
        let of = |sigma: f64| even_operator(&[1.0; 3], &BETA, &ratio, &[sigma; 3]).unwrap();
        assert!((of(0.0) - of(1.0)).norm() < 1e-12);
    }

    #[test]
    fn ratios_that_are_all_alike_tell_nothing_apart() {
        let refused = even_operator(&[1.0; 3], &BETA, &[1.0; 3], &[1.0; 3]);
        assert!(matches!(refused, Err(SeparateError::Singular { .. })));
    }
}
