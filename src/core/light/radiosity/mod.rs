//! Light that bounces between the patches of one Lambertian surface (radiosity; Goral, Torrance, Greenberg, Battaile
//! 1984). Bounce 1 is `rho E`, bounce k + 1 is `rho F` times bounce k, and their sum solves `(I - rho F) B = rho E`.
//!
//! Units: irradiance and radiosity are relative to a white facet that faces a lamp of intensity 1, so that bounce 1 of a
//! facet that faces it is `rho`.

mod bounces;
mod form_factors;
mod occlusion;
mod pair;
mod patches;
pub(crate) mod polygon;

use thiserror::Error;

use crate::options::OptionError;

pub use bounces::{BounceOptions, BounceReport, Radiosities, bounces};
pub use form_factors::{FormFactorOptions, FormFactorReport, FormFactors, form_factors};
pub use occlusion::{Hit, Occluders};
pub use patches::{Patch, Patches};

/// Why the light could not be bounced.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RadiosityError {
    /// Nothing to light.
    #[error("the mesh has no triangles; load one with at least one face")]
    NoTriangles,
    /// A triangle names a vertex that is not there, or one that is not finite.
    #[error("triangle {triangle} has a missing or non-finite vertex; repair the mesh")]
    BadTriangle {
        /// The index of the triangle.
        triangle: usize,
    },
    /// A surface of a size that single-precision rays cannot be traced over.
    #[error(
        "the surface is {diagonal_mm:e} mm from end to end; it must be from 1e-6 to 1e7 mm: check its unit or the camera's scale"
    )]
    Extent {
        /// The diagonal of the box around it.
        diagonal_mm: f64,
    },
    /// An albedo no paint has.
    #[error("albedo {albedo} is not between 0 and 1; no paint reflects that much")]
    BadAlbedo {
        /// The albedo asked for.
        albedo: f64,
    },
    /// An option out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// Irradiance for another surface.
    #[error("the irradiance has {found} values and the surface {expected} patches; compute it on the same patches")]
    WrongLength {
        /// Values given.
        found: usize,
        /// Patches.
        expected: usize,
    },
    /// The solver ran out of iterations.
    #[error("all bounces: residual {residual:.1e} after {iterations} iterations; allow more, or a larger residual")]
    NotConverged {
        /// Relative residual reached.
        residual: f64,
        /// Iterations done.
        iterations: usize,
    },
    /// The watcher asked to stop.
    #[error("cancelled")]
    Cancelled,
}

#[cfg(test)]
mod tests;
