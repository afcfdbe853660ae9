//! Depth from normals: least squares integration on any mask.
//!
//! Minimises the sum over neighbouring pixels i, j inside the mask of w_ij (z_j - z_i - s_ij)^2, s_ij the step that the
//! two normals ask for: the discrete form of min (z_x - p)^2 + (z_y - q)^2, p = -n_x / n_z, q = -n_y / n_z, with a free
//! boundary. The normal equations are a graph Laplacian, so a mask may have holes and islands; conjugate gradients
//! under a multigrid cycle solve them in time linear in the pixels.

mod coarsen;
mod laplacian;
mod multigrid;
mod solve;
mod steps;
#[cfg(test)]
mod tests;

use rayon::prelude::*;
use thiserror::Error;

use crate::options::{OptionError, check_range};
use crate::{Camera, Mask, NormalMap, Plane, Projection, Watch};
use multigrid::Hierarchy;
use steps::{Region, Steps};

/// How to integrate.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct DepthOptions {
    /// Where to stop: the norm of the residual, and the estimated error in slope, over those at the start; 1e-8 to 1.
    pub tolerance: f64,
    /// Iterations after which to give up.
    pub max_iterations: usize,
    /// The steepest slope (pixels of height per pixel) that is believed; steeper normals are clamped to it.
    pub max_slope: f64,
}

impl Default for DepthOptions {
    fn default() -> Self {
        Self { tolerance: 1e-5, max_iterations: 200, max_slope: 20.0 }
    }
}

impl DepthOptions {
    /// Whether every option is in its range.
    ///
    /// # Errors
    /// `DepthError::Option` names the first that is not.
    pub fn check(&self) -> Result<(), DepthError> {
        check_range("tolerance", self.tolerance, (1e-8..1.0).contains(&self.tolerance), "from 1e-8 to below 1")?;
        check_range("max_iterations", self.max_iterations as f64, self.max_iterations >= 1, "at least 1")?;
        let slope = self.max_slope;
        Ok(check_range("max_slope", slope, slope > 0.0 && slope.is_finite(), "a positive number")?)
    }
}

/// Why there is no depth.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum DepthError {
    /// An option out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// The camera's geometry cannot be.
    #[error("the camera's lengths must be positive numbers, not {projection:?}; correct [camera]")]
    Camera {
        /// What it was set to.
        projection: Projection,
    },
    /// Two inputs differ in size.
    #[error("the {what} has {found:?} pixels, but the normals have {normals:?}; use pictures of one size")]
    Size {
        /// The input that differs.
        what: &'static str,
        /// Its width and height.
        found: (usize, usize),
        /// Width and height of the normals.
        normals: (usize, usize),
    },
    /// The mask has no pixel with a normal.
    #[error("none of the mask's {pixels} pixels has a normal; check the mask and the lights")]
    NoNormal {
        /// Pixels inside the mask.
        pixels: usize,
    },
    /// The iterations ran out.
    #[error(
        "the depth still has a relative residual of {relative_residual:.1e} after {iterations} iterations, not \
         {tolerance:.1e}; allow more iterations or a larger tolerance"
    )]
    NotConverged {
        /// Iterations made.
        iterations: usize,
        /// Residual reached.
        relative_residual: f64,
        /// Residual asked for.
        tolerance: f64,
    },
    /// The watch cancelled.
    #[error("the integration was cancelled")]
    Cancelled,
}

/// How well the depth holds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DepthReport {
    /// Pixels that got a depth.
    pub pixels: usize,
    /// Unconnected parts of the mask; the depth between them is not known.
    pub islands: usize,
    /// Iterations of the solver.
    pub iterations: usize,
    /// |b - A z| / |b| of the normal equations.
    pub relative_residual: f64,
    /// Integrability residual: weighted root mean square difference between the depth's slopes and the normals' (pixels of
    /// height per pixel). Zero where the normals are those of a surface.
    pub rms_slope_residual: f64,
    /// Pixels whose slope was steeper than `max_slope`, or that faced away.
    pub clamped_pixels: usize,
    /// Pixels inside the mask without a normal or without confidence; their slope is guessed from their neighbours'.
    pub pixels_without_normal: usize,
}

/// A depth map.
#[derive(Clone, Debug, PartialEq)]
pub struct Depth {
    /// z toward the camera in mm, or in pixels where the camera has no scale; zero outside `mask`. The mean over each
    /// island is zero (orthographic), or its geometric mean distance is the working distance (perspective).
    pub depth_mm: Plane,
    /// Where there is a depth.
    pub mask: Mask,
    /// At each pixel the root mean square difference between the depth's slopes and the normals'.
    pub slope_residual: Plane,
    /// How well it holds.
    pub report: DepthReport,
}

/// Integrates `normals` over `mask`.
///
/// `confidence` weighs the pixels (the inverse variance of their slopes is best; only its ratios matter). A pixel
/// of the mask without a normal or without confidence is bridged with the slopes around it. All pictures have the camera's size.
///
/// # Errors
/// `DepthError`: options, camera or sizes out of range, no pixel to integrate, no convergence, or cancelled.
pub fn integrate(
    normals: &NormalMap,
    mask: &Mask,
    confidence: Option<&Plane>,
    camera: &Camera,
    options: &DepthOptions,
    watch: &dyn Watch,
) -> Result<Depth, DepthError> {
    options.check()?;
    if !camera.is_valid() {
        return Err(DepthError::Camera { projection: camera.projection });
    }
    let sizes =
        [("mask", Some(mask.size())), ("confidence", confidence.map(Plane::size)), ("camera", Some(camera.size))];
    for (what, found) in sizes {
        if let Some(found) = found.filter(|&found| found != normals.size()) {
            return Err(DepthError::Size { what, found, normals: normals.size() });
        }
    }
    let region = Region::around(mask).ok_or(DepthError::NoNormal { pixels: 0 })?;

    // The steps between pixels, the levels of the multigrid, the heights.
    let (steps, grid) = Steps::new(normals, mask, confidence, camera, region, options.max_slope);
    let pixels = grid.inside().par_iter().filter(|&&inside| inside).count();
    if pixels == 0 {
        return Err(DepthError::NoNormal { pixels: mask.count() });
    }
    let hierarchy = Hierarchy::new(grid);
    let mut solution = solve::solve(&hierarchy, &steps, options, watch)?;
    hierarchy.centre_islands(&mut solution.height);

    let (residual, rms_slope_residual) = steps.slope_residual(hierarchy.grid(), &solution.height);
    let mut slope_residual = Plane::filled(mask.width(), mask.height(), 0.0);
    region.place(&residual, mask.width(), slope_residual.data_mut());
    let mut depth_mm = Plane::filled(mask.width(), mask.height(), 0.0);
    let inside = hierarchy.grid().inside();
    let depth = solution.height.par_iter().zip(inside).map(|(&h, &inside)| if inside { z_mm(camera, h) } else { 0.0 });
    region.place(&depth.collect::<Vec<f32>>(), mask.width(), depth_mm.data_mut());
    let mut with_depth = Mask::filled(mask.width(), mask.height(), false);
    region.place(inside, mask.width(), with_depth.data_mut());

    let report = DepthReport {
        pixels,
        islands: hierarchy.islands(),
        iterations: solution.iterations,
        relative_residual: solution.relative_residual,
        rms_slope_residual,
        clamped_pixels: steps.clamped_pixels,
        pixels_without_normal: steps.pixels_without_normal,
    };
    Ok(Depth { depth_mm, mask: with_depth, slope_residual, report })
}

/// z from the solver's height in pixels.
fn z_mm(camera: &Camera, height: f64) -> f32 {
    let z = match camera.projection {
        Projection::Orthographic { mm_per_pixel } => height * mm_per_pixel.unwrap_or(1.0),
        Projection::Perspective { focal_length_px, working_distance_mm, .. } => {
            -working_distance_mm * (-height / focal_length_px).exp_m1()
        }
    };
    z as f32
}
