//! The decompositions of small matrices, each with an end.
//!
//! nalgebra iterates for ever, or panics, where an entry is NaN or infinite or the product of two entries overflows.
//! Every decomposition in the project is made here, where such matrices are refused; a test reads the sources for others.

use nalgebra::allocator::Allocator;
use nalgebra::{
    Const, DMatrix, DVector, DefaultAllocator, Dim, DimDiff, DimSub, Dyn, Matrix3, OMatrix, SMatrix, SVD, SVector,
    SymmetricEigen, U1, U3,
};

/// Sums of products of larger entries may overflow.
const MAX_ENTRY: f64 = 1e100;

/// A matrix takes about three iterations for each of its singular values; the largest here has some dozens.
const MAX_ITERATIONS: usize = 2000;

/// What nalgebra's own constructors take for the precision of singular values.
const SVD_PRECISION: f64 = 5.0 * f64::EPSILON;

fn is_bounded<'m>(mut entries: impl Iterator<Item = &'m f64>) -> bool {
    entries.all(|entry| entry.abs() <= MAX_ENTRY)
}

fn is_finite<'m>(mut entries: impl Iterator<Item = &'m f64>) -> bool {
    entries.all(|entry| entry.is_finite())
}

/// The singular values, in no order; `None` for an empty matrix and for entries that are no numbers or too large.
pub(crate) fn singular_values(matrix: &DMatrix<f64>) -> Option<DVector<f64>> {
    Some(svd(matrix, false)?.singular_values)
}

/// The Moore-Penrose inverse; `None` as for [`singular_values`], and where an entry of it would be no number.
pub(crate) fn pseudo_inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    svd(matrix, true)?.pseudo_inverse(0.0).ok().filter(|inverse| is_finite(inverse.iter()))
}

/// The same of a matrix whose smallest singular value is more than the share `above` of the largest; `None` for others.
pub(crate) fn pseudo_inverse_of_regular(matrix: &DMatrix<f64>, above: f64) -> Option<DMatrix<f64>> {
    let mut svd = svd(matrix, true)?;
    if svd.singular_values.min() <= above * svd.singular_values.max() {
        return None;
    }
    svd.sort_by_singular_values();
    svd.pseudo_inverse(0.0).ok().filter(|inverse| is_finite(inverse.iter()))
}

fn svd(matrix: &DMatrix<f64>, with_vectors: bool) -> Option<SVD<f64, Dyn, Dyn>> {
    if matrix.is_empty() || !is_bounded(matrix.iter()) {
        return None;
    }
    SVD::try_new_unordered(matrix.clone(), with_vectors, with_vectors, SVD_PRECISION, MAX_ITERATIONS)
}

/// The singular value decomposition `u s v_t` of a 3 x 3 matrix as `u` and `v_t`, largest value first.
pub(crate) fn singular_vectors(matrix: &Matrix3<f64>) -> Option<(Matrix3<f64>, Matrix3<f64>)> {
    if !is_bounded(matrix.iter()) {
        return None;
    }
    // nalgebra decomposes this matrix for its answer, and does not survive an answer of `None`.
    SymmetricEigen::try_new(matrix.tr_mul(matrix), SVD_PRECISION, MAX_ITERATIONS)?;
    let svd: SVD<f64, U3, U3> = SVD::try_new(*matrix, true, true, SVD_PRECISION, MAX_ITERATIONS)?;
    svd.u.zip(svd.v_t)
}

/// Eigenvalues and eigenvectors of a symmetric matrix, in no order; `None` for entries that are no numbers or too large.
pub(crate) fn symmetric_eigen<D>(matrix: OMatrix<f64, D, D>) -> Option<SymmetricEigen<f64, D>>
where
    D: Dim + DimSub<U1>,
    DefaultAllocator: Allocator<D, D> + Allocator<D> + Allocator<DimDiff<D, U1>>,
{
    if !is_bounded(matrix.iter()) {
        return None;
    }
    SymmetricEigen::try_new(matrix, f64::EPSILON, MAX_ITERATIONS)
}

/// The inverse; `None` where there is none, and for entries that are no numbers or too large.
pub(crate) fn inverse<const N: usize>(matrix: &SMatrix<f64, N, N>) -> Option<SMatrix<f64, N, N>> {
    if !is_bounded(matrix.iter()) {
        return None;
    }
    matrix.try_inverse().filter(|inverse| is_finite(inverse.iter()))
}

/// Solves `matrix x = right` for a symmetric, positive definite matrix; `None` for others, and as [`inverse`].
pub(crate) fn solve_positive_definite<const N: usize>(
    matrix: SMatrix<f64, N, N>,
    right: &SVector<f64, N>,
) -> Option<SVector<f64, N>>
where
    Const<N>: DimSub<Dyn>,
{
    if !is_bounded(matrix.iter()) {
        return None;
    }
    Some(matrix.cholesky()?.solve(right)).filter(|solution| is_finite(solution.iter()))
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use nalgebra::{Matrix4, Vector4};
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    use super::*;

    /// Numbers that end no iteration, or whose products are none.
    const EXTREMES: [f64; 7] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN, 1e160, -1e300];

    fn refused_with(entry: f64) {
        let three = Matrix3::new(1.0, 2.0, 3.0, 2.0, entry, 1.0, 3.0, 1.0, 5.0);
        let any = DMatrix::from_fn(5, 3, |i, j| if (i, j) == (3, 1) { entry } else { (i * 3 + j * j) as f64 });
        assert!(singular_values(&any).is_none() && pseudo_inverse(&any).is_none(), "{entry}");
        assert!(singular_vectors(&three).is_none() && symmetric_eigen(three).is_none(), "{entry}");
        assert!(inverse(&three).is_none(), "{entry}");
        let four = Matrix4::from_diagonal(&Vector4::new(1.0, 1.0, entry, 1.0));
        assert!(solve_positive_definite(four, &Vector4::repeat(1.0)).is_none(), "{entry}");
    }

    #[test]
    fn a_matrix_that_holds_no_number_or_a_huge_one_is_refused_at_once() {
        EXTREMES.into_iter().for_each(refused_with);
        assert!(singular_values(&DMatrix::zeros(0, 3)).is_none());
    }

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(1), cases: 300, ..ProptestConfig::default() })]
        #[test]
        fn every_matrix_of_numbers_comes_to_an_end(
            entries in prop::collection::vec((-1.0..1.0f64, -160..100i32), 36), rows in 1..12usize,
        ) {
            let entries: Vec<f64> = entries.into_iter().map(|(digits, power)| digits * 10f64.powi(power)).collect();
            let any = DMatrix::from_iterator(rows, 3, entries.iter().copied().cycle().take(3 * rows));
            let _ = (singular_values(&any), pseudo_inverse(&any), pseudo_inverse_of_regular(&any, 1e-13));
            let three = Matrix3::from_iterator(entries.iter().copied());
            let _ = (singular_vectors(&three), inverse(&three), symmetric_eigen(three + three.transpose()));
            let six = nalgebra::Matrix6::from_iterator(entries.iter().copied());
            let _ = symmetric_eigen(six + six.transpose());
        }

        #[test]
        fn the_numbers_are_those_of_the_endless_ways(entries in prop::collection::vec(-1e3..1e3f64, 15)) {
            let any = DMatrix::from_row_slice(5, 3, &entries);
            prop_assert_eq!(singular_values(&any).unwrap(), any.singular_values_unordered());
            prop_assert_eq!(pseudo_inverse(&any).unwrap(), any.clone().pseudo_inverse(0.0).unwrap());
            let ordered = any.clone().svd(true, true).pseudo_inverse(0.0).unwrap();
            prop_assert_eq!(pseudo_inverse_of_regular(&any, 0.0).unwrap(), ordered);
            let three = Matrix3::from_row_slice(&entries[..9]);
            let svd = three.svd(true, true);
            prop_assert_eq!(singular_vectors(&three).unwrap(), (svd.u.unwrap(), svd.v_t.unwrap()));
            let symmetric = three * three.transpose();
            prop_assert_eq!(symmetric_eigen(symmetric).unwrap().eigenvalues, symmetric.symmetric_eigenvalues());
        }
    }

    #[test]
    fn no_matrix_is_decomposed_elsewhere() {
        let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("linear_algebra.rs");
        let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let mut files = Vec::new();
        rust_files(&sources, &mut files);
        assert!(files.contains(&sources.join("core/linear_algebra.rs")) && files.len() > 100);
        let of_tests = |path: &Path| {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            path.components().any(|part| ["tests", "benches"].iter().any(|folder| part.as_os_str() == *folder))
                || stem.ends_with("tests")
        };
        let here = here.canonicalize().unwrap();
        for path in files.into_iter().filter(|path| !of_tests(path) && path.canonicalize().unwrap() != here) {
            let text = std::fs::read_to_string(&path).unwrap();
            for call in DECOMPOSITIONS {
                assert!(!text.contains(call), "{}: call linear_algebra instead of {call}", path.display());
            }
        }
    }

    const DECOMPOSITIONS: [&str; 24] = [
        ".svd(",
        ".svd_unordered(",
        ".try_svd",
        "SVD::",
        ".singular_values",
        ".pseudo_inverse(",
        ".rank(",
        ".symmetric_eigen",
        ".try_symmetric_eigen",
        "SymmetricEigen::",
        ".eigenvalues()",
        ".complex_eigenvalues(",
        ".schur(",
        "Schur::",
        ".hessenberg(",
        ".bidiagonalize(",
        ".cholesky(",
        "Cholesky::",
        ".lu(",
        ".full_piv_lu(",
        ".qr(",
        ".col_piv_qr(",
        ".try_inverse(",
        ".try_inverse_mut(",
    ];

    fn rust_files(folder: &Path, files: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                rust_files(&path, files);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                files.push(path);
            }
        }
    }
}
