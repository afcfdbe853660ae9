//! Colours and shape together: the colours tell direct light from indirect light, and the shape tells what the indirect light is
//! made of. See "Colours and shape together" in [`crate::method`].
//!
//! With `N_c' = N_c / alpha_c` and `K f (x)` the light that arrives at x from a surface that shines with f,
//!
//! ```text
//! N_ref = L_1 + I,    N_c' = beta_c L_1 + beta_c r_c I,    r_c(x) = K N_c'(x) / K N_ref(x),    I = s K N_ref
//! ```
//!
//! holds for light that bounces without end. The ratio r_c needs no albedo: of K any factor cancels. The amount s is the albedo of
//! the reference colour where all of the surface is known, and varies slowly elsewhere; it is fitted in windows.

mod amount;
mod apply;
mod arriving;
mod closure;
mod consistency;
mod direct;
mod end_of_ratio;
mod even;
mod fit;
mod grid;
mod indirect;
mod of_object;
mod pyramid;
mod receivers;
mod report;
mod split;
#[cfg(test)]
mod tests;
mod visibility;

use rayon::prelude::*;
use thiserror::Error;

use crate::image::gaussian::gaussian;
use crate::options::{OptionError, check_range};
use crate::separate::{LightPhotos, MIN_BETA_DISTANCE, SeparateError};
use crate::stereo::normals::Lamp;
use crate::stereo::shape::{Shape, ShapeError, ShapeOptions, recover_shape};
use crate::{Camera, Marks, Mask, Plane, Portion, Watch};
use arriving::arriving_light;
use grid::Grid;
use indirect::{Indirect, indirect_light};
use pyramid::Pyramid;
use visibility::Visibility;

pub use amount::{AmountReport, MAX_UNEVENNESS};
pub use closure::{ClosureFinding, ClosureOptions, ClosureReport, ColourClosure};
pub use end_of_ratio::EndOfRatio;
pub use even::even_operator;
pub use of_object::{BetaDoubt, ObjectBeta, beta_of_object};
pub use report::{ColoursAndShapeReport, LightReport};

/// Normals that receive light are smoothed by a Gaussian of this standard deviation, within each wall.
const RECEIVER_WINDOW_PX: f64 = 2.0;

/// Cells without a normal take the light that arrives around them, within a Gaussian of this standard deviation, unless as few
/// cells around them are known as this.
const FILL_WINDOW_PX: f64 = 6.0;
const MIN_FILL_WEIGHT: f32 = 1e-3;

/// How to separate.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ColoursAndShapeOptions {
    /// How often light is gathered over the shape and the shape recovered from what is left. 0 leaves the shape out: one colour
    /// ratio for each light.
    pub rounds: usize,
    /// The most cells on which arriving light is computed; photos of more pixels are averaged in blocks for it.
    pub cells: usize,
    /// Arriving light is smoothed by a Gaussian of this standard deviation before its colour ratio is taken.
    pub ratio_window_px: f64,
    /// The amount of indirect light is fitted in Gaussian windows of this standard deviation.
    pub amount_window_px: f64,
    /// How that amount is held against the albedo.
    pub closure: ClosureOptions,
}

impl Default for ColoursAndShapeOptions {
    fn default() -> Self {
        let closure = ClosureOptions::default();
        Self { rounds: 1, cells: 250_000, ratio_window_px: 1.0, amount_window_px: 6.0, closure }
    }
}

/// Shapes that were recovered so often have long come to rest.
const MAX_ROUNDS: usize = 20;

impl ColoursAndShapeOptions {
    /// Whether every option is in its range.
    pub fn check(&self) -> Result<(), OptionError> {
        check_range("rounds", self.rounds as f64, self.rounds <= MAX_ROUNDS, "from 0 to 20")?;
        let in_range = (1000..=100_000_000).contains(&self.cells);
        check_range("cells", self.cells as f64, in_range, "from 1000 to 100 million")?;
        let window = 0.0..=100.0;
        check_range("ratio_window_px", self.ratio_window_px, window.contains(&self.ratio_window_px), "from 0 to 100")?;
        let in_range = (0.5..=100.0).contains(&self.amount_window_px);
        check_range("amount_window_px", self.amount_window_px, in_range, "from 0.5 to 100")?;
        self.closure.check()
    }
}

/// Why the light could not be separated.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ColoursAndShapeError {
    /// An option out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// Photos, calibration and mask do not fit together, or two colours that differ are missing.
    #[error(transparent)]
    Photos(#[from] SeparateError),
    /// The watch cancelled.
    #[error("cancelled")]
    Cancelled,
}

/// Why the shape is not used: then each light has one colour ratio of indirect light.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoShape {
    /// There is none.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// Without it the photos fit one paint better.
    #[error(
        "the shape misleads: the albedo varies by {:.1} % with it and by {:.1} % without; where fewer than three lamps reach, the \
         shape is a guess",
        100.0 * over_shape,
        100.0 * even
    )]
    Misfit {
        /// How much the albedo varies without the shape, relative.
        even: f64,
        /// And with it.
        over_shape: f64,
    },
    /// There is far more light than the walls in view can send.
    #[error(
        "most of the cavity is out of view: there is {amount:.1} times as much indirect light as the walls in view receive"
    )]
    OutOfView {
        /// The amount of indirect light over what arrives.
        amount: f64,
    },
}

/// What was photographed in two colours or more.
#[derive(Clone, Copy, Debug)]
pub struct Photographed<'a> {
    /// By light.
    pub lights: &'a [LightPhotos<'a>],
    /// By light, where it is and its intensity; `None` for one that the surface is recovered without.
    pub lamps: &'a [Option<(Lamp, f64)>],
    /// The object.
    pub mask: &'a Mask,
    /// What sees it.
    pub camera: &'a Camera,
    /// Linear light of a white facet that faces a lamp of intensity 1, in the reference colour; `None` where it is not known: then
    /// the amount of indirect light cannot be held against the albedo.
    pub white_light: Option<f64>,
}

/// One light, separated.
#[derive(Clone, Debug, PartialEq)]
pub struct SeparatedLight {
    /// L_1 in linear light of the reference colour.
    pub direct: Plane,
    /// I, all light that bounced more than once.
    pub indirect: Plane,
    /// Predicted noise (standard deviation) of L_1.
    pub noise: Plane,
    /// Marks of the colours' photos together, and `UNSOLVED` or `OUTSIDE`.
    pub marks: Marks,
}

/// All lights, separated.
#[derive(Clone, Debug, PartialEq)]
pub struct ColoursAndShape {
    /// By light.
    pub lights: Vec<SeparatedLight>,
    /// By light, how the indirect light was found.
    pub maps: Vec<IndirectMaps>,
    /// How it went.
    pub report: ColoursAndShapeReport,
}

/// What is known of the indirect light of one light, a value for each cell of the grid.
#[derive(Clone, Debug, PartialEq)]
pub struct IndirectMaps {
    /// By colour, the colour ratio r of indirect light over that of the reference colour, with the lamps' ratios divided out.
    pub ratio: Vec<Plane>,
    /// s, what part of the arriving light is sent on; `None` where no shape was used.
    pub amount: Option<Plane>,
}

/// Separates direct from indirect light. `on_shape` is shown every shape on the way, a pixel for each cell of the grid.
///
/// # Errors
/// `ColoursAndShapeError`: options or calibration out of range, or cancelled. Where no shape can be recovered, one colour ratio a
/// light is used, and the report says why.
pub fn separate_by_colours_and_shape(
    photographed: &Photographed,
    options: &ColoursAndShapeOptions,
    shape_options: &ShapeOptions,
    watch: &dyn Watch,
    on_shape: &mut dyn FnMut(&Shape),
) -> Result<ColoursAndShape, ColoursAndShapeError> {
    options.check()?;
    photographed.check()?;
    let steps = 2 * options.rounds + 2;
    let on_grid =
        OnGrid::find(photographed, options, shape_options, &|step| Portion::of(watch, step, steps), on_shape)?;
    let on_grid = match on_grid.misleads(photographed, shape_options) {
        Some(why) => on_grid.without_shape(why),
        None => on_grid,
    };
    let closure = on_grid.closure(photographed, options, shape_options, &Portion::of(watch, steps - 2, steps));
    let OnGrid { grid, even, indirect, amount, no_shape, .. } = on_grid;
    let separated =
        apply::apply(photographed.lights, photographed.mask, &grid, &indirect, &Portion::of(watch, steps - 1, steps));
    let separated = separated.ok_or(ColoursAndShapeError::Cancelled)?;
    let report = ColoursAndShapeReport {
        step_px: grid.step_px,
        no_shape,
        amount,
        closure,
        lights: separated.iter().zip(&even).map(|(light, even)| LightReport::of(light, even)).collect(),
    };
    let maps = indirect.into_iter().map(|indirect| indirect.into_maps(grid.size())).collect();
    Ok(ColoursAndShape { lights: separated, maps, report })
}

/// What is found on the grid.
struct OnGrid {
    grid: Grid,
    /// By light, one ratio for all cells.
    even: Vec<Indirect>,
    /// By light.
    indirect: Vec<Indirect>,
    /// By light, K N_ref; empty without a shape.
    arriving: Vec<Plane>,
    /// `None` without a shape, or where no light arrives.
    amount: Option<AmountReport>,
    /// The last shape, and why there is none or it is left out.
    shape: Option<Shape>,
    no_shape: Option<NoShape>,
}

impl OnGrid {
    fn find<'w>(
        photographed: &Photographed,
        options: &ColoursAndShapeOptions,
        shape_options: &ShapeOptions,
        part: &dyn Fn(usize) -> Portion<'w>,
        on_shape: &mut dyn FnMut(&Shape),
    ) -> Result<Self, ColoursAndShapeError> {
        let Photographed { lights, mask, camera, .. } = *photographed;
        let mut grid = Grid::new(lights, mask, camera, options.cells);
        let even: Vec<_> = grid.lights.iter().map(|light| Indirect::even(light, &grid.mask)).collect();
        grid.fill_unusable(|l, c| even[l].ratio[c].at(0));
        let (indirect, arriving) = (even.clone(), Vec::new());
        let mut found = Self { grid, even, indirect, arriving, amount: None, shape: None, no_shape: None };
        for round in 0..options.rounds {
            let direct = direct::direct_light(&found.grid, &found.indirect);
            let direct = direct::placed(&direct, photographed.lamps);
            let (mask, camera) = (&found.grid.mask, &found.grid.camera);
            let shape = match recover_shape(&direct, mask, camera, shape_options, &part(2 * round)) {
                Ok(shape) => shape,
                Err(error) if error.is_cancelled() => return Err(ColoursAndShapeError::Cancelled),
                Err(error) => {
                    found.no_shape = Some(error.into());
                    break;
                }
            };
            on_shape(&shape);
            let arriving = arriving_at(&found.grid, &shape, &part(2 * round + 1));
            let arriving = arriving.ok_or(ColoursAndShapeError::Cancelled)?;
            (found.indirect, found.arriving, found.amount) =
                indirect_light(&found.grid, &found.even, arriving, options);
            found.shape = Some(shape);
        }
        Ok(found)
    }

    /// Why the shape misleads, where it does.
    fn misleads(&self, photographed: &Photographed, shape_options: &ShapeOptions) -> Option<NoShape> {
        let (shape, amount) = (self.shape.as_ref()?, self.amount.as_ref()?);
        let Photographed { lamps, .. } = *photographed;
        let indirect = (&self.even[..], &self.indirect[..]);
        let depth_mm = &shape.depth.depth_mm;
        consistency::why_even_is_better(&self.grid, indirect, amount, lamps, depth_mm, &shape_options.normals)
    }

    /// Back to one ratio a light.
    fn without_shape(self, why: NoShape) -> Self {
        let indirect = self.even.clone();
        Self { indirect, arriving: Vec::new(), amount: None, shape: None, no_shape: Some(why), ..self }
    }

    /// `None` where no shape tells the amount of indirect light.
    fn closure(
        &self,
        photographed: &Photographed,
        options: &ColoursAndShapeOptions,
        shape_options: &ShapeOptions,
        watch: &dyn Watch,
    ) -> Option<ClosureReport> {
        let found = closure::Found {
            grid: &self.grid,
            indirect: &self.indirect,
            arriving: &self.arriving,
            amount: self.amount?,
            depth: &self.shape.as_ref()?.depth.depth_mm,
            amount_window_px: options.amount_window_px,
        };
        let Photographed { lamps, white_light, .. } = *photographed;
        Some(closure::closure(&found, lamps, white_light, &options.closure, &shape_options.normals, watch))
    }
}

impl Photographed<'_> {
    /// # Errors
    /// Sizes and counts that differ, calibration that is no positive number, or a beta that is 1 in every colour.
    fn check(&self) -> Result<(), ColoursAndShapeError> {
        for light in self.lights {
            light.check()?;
            let colours = light.beta.len();
            crate::separate::check_order(light.alpha, light.beta, 1)?;
            let differs = |beta: &f64| (beta - light.beta[0]).abs() >= MIN_BETA_DISTANCE;
            match light.beta.iter().skip(1).position(differs) {
                Some(_) => {}
                None if colours < 2 => return Err(SeparateError::Order { bounces: 2, colours }.into()),
                None => {
                    let beta = [light.beta[0], light.beta[1]];
                    return Err(SeparateError::SameAlbedo { first: 0, second: 1, beta }.into());
                }
            }
        }
        Ok(())
    }
}

/// By light, then colour, the light that arrives at every cell. `None` when cancelled.
fn arriving_at(grid: &Grid, shape: &Shape, watch: &dyn Watch) -> Option<Vec<Vec<Plane>>> {
    let channels: Vec<&[f32]> =
        grid.lights.iter().flat_map(|light| light.colours.iter().map(|photo| photo.light.data())).collect();
    let known = shape.depth.mask.data().iter().zip(grid.mask.data()).map(|(a, b)| *a && *b).collect();
    let known = Mask::from_vec(grid.mask.width(), grid.mask.height(), known).unwrap_or_default();
    let pyramid = Pyramid::new(shape, &grid.camera, &known, &channels);
    let mut depth = shape.depth.depth_mm.clone();
    for (depth, known) in depth.data_mut().iter_mut().zip(known.data()) {
        *depth = if *known { *depth } else { f32::NEG_INFINITY };
    }
    let normals = receivers::smoothed(&shape.normals.map, &known, RECEIVER_WINDOW_PX);
    let visibility = Visibility::new(&pyramid, &grid.camera, &depth);
    let mut planes = arriving_light(&pyramid, &normals, &known, visibility.as_ref(), watch)?;
    if known.count() < grid.mask.count() {
        fill(&mut planes, &known);
    }
    let mut planes = planes.into_iter();
    Some(grid.lights.iter().map(|light| planes.by_ref().take(light.colours.len()).collect()).collect())
}

/// Gives cells without a normal, such as those with a clipped colour, the light that arrives around them: it varies slowly.
fn fill(planes: &mut [Plane], known: &Mask) {
    let weight = gaussian(&known.map(|known| if known { 1.0 } else { 0.0 }), FILL_WINDOW_PX);
    for plane in planes {
        let around = gaussian(plane, FILL_WINDOW_PX);
        let cells = plane.data_mut().par_iter_mut().zip(around.data()).zip(weight.data()).zip(known.data());
        cells.filter(|(_, known)| !**known).for_each(|(((value, around), weight), _)| {
            *value = if *weight > MIN_FILL_WEIGHT { around / weight } else { 0.0 };
        });
    }
}
