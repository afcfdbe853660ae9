//! From photos and rig to the direct light of every light: one method a file, each a row of one table.

mod colours;
mod colours_and_shape;
mod shape;
#[cfg(test)]
mod tests;

use firstbounce_core::Plane;
use firstbounce_core::stereo::shape::Shape;

use super::{Direct, Known, PipelineError, PipelineWatch, Scene, Separated, SolveOptions, Stage};
use crate::set::{CaptureSet, Method};

pub use colours::{denoise_lights, separate_lights};
pub use colours_and_shape::ColoursAndShapeSolved;
pub use colours_and_shape::add_beta_of_object;
pub use shape::{AlbedoScale, NayarSolved};

pub(super) use shape::{white_light, white_light_if_known};

/// What the rest of the program knows of a method.
pub(super) struct Row {
    /// In a sentence: "Nayar's method".
    pub title: &'static str,
    /// One line of help.
    pub purpose: &'static str,
    pub needs: Needs,
    /// It uses the light of a white facet where that is known, and does without elsewhere.
    pub compares_albedo: bool,
    /// It takes the whole object for one paint; photometric stereo may do so too.
    pub one_paint: bool,
    /// The stage whose time it takes.
    pub stage: Stage,
    pub direct_light: fn(&Input, &dyn PipelineWatch, &mut OnShape) -> Result<Found, PipelineError>,
}

/// What a method needs beside photos, directions and intensities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Needs {
    /// Photos in all colours of the set, with alpha and beta; without, the reference colour's do.
    pub all_colours: bool,
    /// The light of a white facet, which makes albedos absolute.
    pub absolute_albedo: bool,
    /// The surface that the photos show before separation.
    pub surface_before: bool,
}

/// Shown every shape on the way, where a method has some.
pub type OnShape<'a> = dyn FnMut(&Shape) + 'a;

/// What a method finds direct light from.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// Photos and rig, in the colours that the method needs.
    pub scene: &'a Scene<'a>,
    /// By light, the photos before separation, where the method needs the surface that they show.
    pub raw: Option<&'a Separated>,
    /// The surface that they show, where the method needs it.
    pub before: Option<&'a Shape>,
    /// Linear light of a white facet that faces a lamp of intensity 1, where the method needs it, or uses it and it is known.
    pub white_light: Option<&'a Known<f64>>,
    /// The options of every method.
    pub options: &'a SolveOptions,
}

/// The direct light of every light.
#[derive(Debug)]
pub struct Found {
    /// The bounces that the light was separated into, direct light first.
    pub separated: Separated,
    /// By light, all light that bounced more than once; empty for a method that keeps bounces apart.
    pub indirect: Vec<Plane>,
    /// By light, what the surface is recovered from.
    pub direct: Vec<Direct>,
    /// The surface, where the method finds it on the way.
    pub shape: Option<Shape>,
    /// What the method reports of itself.
    pub report: MethodReport,
}

/// What a method reports of itself, beside the separation of each light.
#[derive(Clone, Debug, PartialEq)]
pub enum MethodReport {
    /// Nothing more.
    None,
    /// Of Nayar's method.
    Nayar(NayarSolved),
    /// Of colours and shape together.
    ColoursAndShape(Box<ColoursAndShapeSolved>),
}

impl MethodReport {
    /// What the user should know before trusting the surface.
    pub fn warnings(&self, solved_pixels: usize) -> Vec<String> {
        match self {
            Self::None => Vec::new(),
            Self::Nayar(solved) => solved.warnings(solved_pixels),
            Self::ColoursAndShape(solved) => solved.warnings(),
        }
    }

    /// That of Nayar's method.
    pub fn nayar(&self) -> Option<&NayarSolved> {
        match self {
            Self::Nayar(solved) => Some(solved),
            Self::None | Self::ColoursAndShape(_) => None,
        }
    }

    /// That of colours and shape together.
    pub fn colours_and_shape(&self) -> Option<&ColoursAndShapeSolved> {
        match self {
            Self::ColoursAndShape(solved) => Some(solved),
            Self::None | Self::Nayar(_) => None,
        }
    }
}

impl Method {
    fn row(self) -> &'static Row {
        match self {
            Self::Colours => &colours::ROW,
            Self::ColoursAndShape => &colours_and_shape::ROW,
            Self::Shape => &shape::ROW,
        }
    }

    /// In a sentence: "Nayar's method".
    pub fn title(self) -> &'static str {
        self.row().title
    }

    /// One line of help.
    pub fn purpose(self) -> &'static str {
        self.row().purpose
    }

    /// What it needs.
    pub fn needs(self) -> Needs {
        self.row().needs
    }

    /// Whether it uses the light of a white facet where that is known.
    pub fn compares_albedo(self) -> bool {
        self.row().compares_albedo
    }

    pub(super) fn stage(self) -> Stage {
        self.row().stage
    }

    /// Why a set cannot be separated by it, whatever is chosen; `None` where it can.
    pub fn impossible_for(self, set: &CaptureSet) -> Option<&'static str> {
        let is_short = self.needs().all_colours && set.colours.len() < 2;
        is_short.then_some("it needs photos in two lamp colours or more")
    }

    /// Whether it takes the whole object for one paint.
    pub fn assumes_one_paint(self) -> bool {
        self.row().one_paint
    }

    /// The set as the method looks at it. Where crosstalk is undone, every channel is looked at.
    pub fn set_of(self, set: &CaptureSet) -> CaptureSet {
        if self.needs().all_colours || set.has_crosstalk() { set.clone() } else { set.in_one_colour() }
    }

    /// The photos and the rig as the method looks at them. One that needs a single colour has no use for a light that the
    /// surface is recovered without.
    pub fn scene_of<'a>(self, scene: Scene<'a>, options: &SolveOptions) -> Scene<'a> {
        if self.needs().all_colours { scene } else { scene.in_one_colour().without(&options.left_out) }
    }

    /// Finds the direct light of every light; `on_shape` is shown every shape on the way.
    ///
    /// # Errors
    /// What the method needs and the input lacks, or why it failed.
    pub fn direct_light(
        self,
        input: &Input,
        watch: &dyn PipelineWatch,
        on_shape: &mut OnShape,
    ) -> Result<Found, PipelineError> {
        (self.row().direct_light)(input, watch, on_shape)
    }
}
