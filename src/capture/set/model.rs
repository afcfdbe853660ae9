//! The content of a capture set file, as plain data with the format's defaults.

use std::path::PathBuf;

use firstbounce_core::denoise::DenoiseOptions;
use firstbounce_core::stereo::normals::{NormalsOptions, Paint};
use firstbounce_core::stereo::shape::ShapeOptions;
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use super::method::Method;
pub use super::subject::{BallValue, Naming, SphereKind, Subject};
pub use crate::image_file::{Channel, Encoding};

/// One object photographed under several lights in several colours.
///
/// Shots name their light and colour, as the file does; [`CaptureSet::check`] reports what does not fit together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CaptureSet {
    /// The folder that relative paths start from.
    pub folder: PathBuf,
    /// What the user calls the set; empty where the file gives no name.
    pub name: String,
    /// A picture whose non-zero pixels are the object, as written in the file.
    pub mask: Option<String>,
    /// The camera that took every shot.
    pub camera: Camera,
    /// The lamp colours; the first is the reference colour.
    pub colours: Vec<Colour>,
    /// The lamp positions.
    pub lights: Vec<Light>,
    /// The photos.
    pub shots: Vec<Shot>,
    /// The circles of the calibration balls that are known.
    pub spheres: Vec<Sphere>,
    /// Calibration that is given; what is absent is measured from the balls.
    pub calibration: Calibration,
    /// How to separate the bounces.
    pub separation: Separation,
    /// How surfaces are recovered.
    pub shape: ShapeSettings,
    /// Where the truth lies, for evaluation.
    pub truth: Truth,
}

/// The camera and what its files store.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Camera {
    /// How space becomes pixels.
    pub projection: Projection,
    /// How light becomes stored values; `None`: as each file says, and linear where it says nothing.
    pub encoding: Option<Encoding>,
    /// Which layer of layered files holds the photo; `None` for the one without a prefix or the only picture
    /// among them.
    pub layer: Option<String>,
    /// The stored value at no light.
    pub black_level: f64,
    /// The stored value where it clips; `None`: the file type's maximum.
    pub white_level: Option<f64>,
    /// Electrons of a pixel at the white level, where the sensor's photon noise is known. Optional in the file.
    pub full_well_electrons: Option<f64>,
    /// Standard deviation of the read noise in electrons, where known. Optional in the file.
    pub read_noise_electrons: Option<f64>,
    /// k1, k2, p1 and p2 of the lens as OpenCV defines them, of a camera with perspective; `None` for a pinhole. Optional in the file.
    pub distortion: Option<[f64; 4]>,
    /// What the channel of each colour (row) sees of the lamp of each colour (column), over what that lamp's own channel sees of it;
    /// `None`: as `crosstalk` shots show, or nothing. Optional in the file.
    pub crosstalk: Option<Vec<Vec<f64>>>,
}

/// How space becomes pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Parallel rays.
    Orthographic {
        /// Object-space pitch; `None`: the shape is in pixels.
        mm_per_pixel: Option<f64>,
    },
    /// Rays through one point.
    Perspective {
        /// Focal length in pixels.
        focal_length_px: f64,
        /// Where the optical axis meets the picture, in pixels; `None`: the picture's centre.
        principal_point: Option<[f64; 2]>,
        /// From the camera to the object's z = 0.
        working_distance_mm: f64,
    },
}

impl Default for Projection {
    fn default() -> Self {
        Self::Orthographic { mm_per_pixel: None }
    }
}

/// One lamp colour and where a file holds it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Colour {
    /// The colour's name, also used in file names.
    pub name: String,
    /// The channel that holds it.
    pub channel: Channel,
}

/// One physical lamp position.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Light {
    /// The light's name, also used in file names.
    pub name: String,
    /// From the object to the light, of any length: typed, or measured elsewhere.
    pub direction: Option<[f64; 3]>,
    /// A near lamp; the origin is the object's z = 0 on the optical axis.
    pub position_mm: Option<[f64; 3]>,
}

/// One photo, or repeats of one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shot {
    /// What is in the picture.
    pub subject: Subject,
    /// The light's name; none for a dark frame.
    pub light: Option<String>,
    /// The colour's name; none for a dark frame, optional for a mirror ball and a flat field.
    pub colour: Option<String>,
    /// Repeats, averaged in linear light; as written in the file.
    pub files: Vec<String>,
    /// Relative; linear values are divided by it. `None`: by the exposures that the files state, and 1 where they state none.
    pub exposure: Option<f64>,
    /// By file, where they are a bracket: several exposures of one photo, combined by noise weight. Empty for repeats. Optional in the
    /// file.
    pub exposures: Vec<f64>,
    /// Where these files differ from the camera's encoding.
    pub encoding: Option<Encoding>,
    /// Where these files differ from the camera's layer.
    pub layer: Option<String>,
}

/// The circle of a ball in the pictures of one subject.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sphere {
    /// Which shots it lies in; `Object` when the ball is in the scene.
    pub subject: Subject,
    /// What the ball is made of.
    pub kind: SphereKind,
    /// Its outline.
    pub circle: Circle,
    /// Its diameter in mm, where it is known: what gives the scale. Optional in the file.
    pub diameter_mm: Option<f64>,
}

/// A circle in pixels; the centre of the top left pixel is (0.5, 0.5).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Circle {
    /// Centre, x right and y down, in pixels.
    pub centre: [f64; 2],
    /// Radius in pixels.
    pub radius: f64,
}

/// Calibration values by the words of the file. Tables by light hold only the lights whose values are known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Calibration {
    /// Per colour: albedo over the reference colour's; the first is 1.
    pub beta: Option<Vec<f64>>,
    /// By light, per colour: intensity over the reference colour's; the first is 1.
    pub alpha: IndexMap<String, Vec<f64>>,
    /// By light: from the object to the light, of any length.
    pub direction: IndexMap<String, [f64; 3]>,
    /// By light: strength in the reference colour, relative to the first light.
    pub intensity: IndexMap<String, f64>,
    /// Albedo of the grey ball in the reference colour, as its maker states it: with it the ball gives `white_light`.
    /// Optional in the file.
    pub grey_albedo: Option<f64>,
    /// Linear light of a white facet (albedo 1) that faces a lamp of intensity 1 in the reference colour, where it is
    /// known: what makes the paint's albedo absolute. Optional in the file.
    pub white_light: Option<f64>,
}

/// How to separate the bounces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Separation {
    /// How direct light is told from indirect light; `None` leaves the choice to [`CaptureSet::method`].
    pub method: Option<Method>,
    /// The order m of the paper's method; `None` leaves the choice to [`CaptureSet::bounces`].
    pub bounces: Option<usize>,
}

/// How surfaces are recovered. Absent keys have the defaults of the program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ShapeSettings {
    /// Names of lights that photometric stereo does without.
    #[serde(alias = "left_out")]
    pub leave_out: Vec<String>,
    /// A light is in shadow below this share of the brightest light's, 0 to 1.
    #[serde(alias = "shadow_fraction")]
    pub shadow_share: f64,
    /// With five or more lights, one that misses the fit by more than this share is left out, 0 to 1.
    #[serde(alias = "outlier_fraction")]
    pub misfit_share: f64,
    /// How many near-light iterations there are: the depth found so far says how near each lamp is.
    pub rounds: usize,
    /// Half width of the window in which the noise of indirect light is averaged, in pixels; 0 for none.
    #[serde(alias = "indirect_radius_px")]
    pub indirect_window_px: usize,
    /// Whether the object has one albedo.
    #[serde(with = "super::method::paint_word")]
    pub paint: Paint,
}

impl Default for ShapeSettings {
    fn default() -> Self {
        let NormalsOptions { shadow_fraction, outlier_fraction, .. } = NormalsOptions::default();
        Self {
            leave_out: Vec::new(),
            shadow_share: shadow_fraction,
            misfit_share: outlier_fraction,
            rounds: ShapeOptions::default().rounds,
            indirect_window_px: DenoiseOptions::default().radius_px,
            paint: Paint::default(),
        }
    }
}

/// Where the truth lies, for evaluation; as written in the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Truth {
    /// R G B = x y z, zero outside.
    pub normals: String,
    /// Depth in mm, z toward the camera, zero outside the mask.
    pub depth: String,
    /// Linear light of bounce `{k}` under light `{light}` in the reference colour.
    pub bounce: String,
}

impl Default for Truth {
    fn default() -> Self {
        Self {
            normals: "truth/normals.exr".into(),
            depth: "truth/depth.exr".into(),
            bounce: "truth/bounce{k}-{light}.exr".into(),
        }
    }
}
