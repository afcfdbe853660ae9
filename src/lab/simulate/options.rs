//! The options of a simulation.

use std::path::Path;

use firstbounce_core::Mesh;
use firstbounce_core::light::scene::{Lens, Shape};
use firstbounce_core::options::check_range;

use super::{LampOptions, SimulateError};
use crate::{Crosstalk, Sensor};
use firstbounce_capture::mesh_file::read::{LengthScale, MeshError, read_mesh};
use firstbounce_capture::set::{MAX_COLOURS, MAX_LIGHTS, Number};

/// The surface that is photographed.
#[derive(Clone, Debug, PartialEq)]
pub enum Scene {
    /// A built-in shape.
    Shape(Shape),
    /// Any mesh, in mm, its fronts toward +z; refined where it has fewer triangles than patches are asked for.
    Mesh {
        /// What the user calls it.
        name: String,
        /// The surface.
        mesh: Mesh,
    },
}

/// The measures of the built-in shapes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measures {
    /// The shape's main length; `None` for its own: a wall of a corner or groove (60 mm), the sphere's radius of a bowl or
    /// cap (40 mm), the side of a tray (100 mm).
    pub size_mm: Option<f64>,
    /// Between the walls of a groove (90 degrees), or from a cap's axis to its edge, seen from the sphere's centre (60
    /// degrees).
    pub angle_deg: Option<f64>,
}

impl Scene {
    /// The names of the built-in shapes.
    pub const BUILT_IN: [&str; 5] = ["corner", "groove", "bowl", "cap", "tray"];

    /// Those of them that [`Measures::angle_deg`] changes.
    pub const WITH_ANGLE: [&str; 2] = ["groove", "cap"];

    /// The built-in shape of this name; `None` for a name that is none of [`Scene::BUILT_IN`].
    pub fn built_in(name: &str, measures: Measures) -> Option<Self> {
        let size = |default: f64| measures.size_mm.unwrap_or(default);
        let angle = |default: f64| measures.angle_deg.unwrap_or(default);
        let bowl =
            |half_angle_deg: f64| Shape::Bowl { radius_mm: size(40.0), half_angle_deg, rim_mm: 0.3 * size(40.0) };
        Some(Self::Shape(match name {
            "corner" => Shape::Corner { wall_mm: size(60.0), roll_deg: -10.0 },
            "groove" => Shape::Groove { wall_mm: size(60.0), length_mm: 1.5 * size(60.0), angle_deg: angle(90.0) },
            "bowl" => bowl(90.0),
            "cap" => bowl(angle(60.0)),
            "tray" => Shape::Tray { side_mm: size(100.0) },
            _ => return None,
        }))
    }

    /// The mesh of a file, called as the file is, and what the user should know of it. `flip` turns its faces the other way
    /// round.
    ///
    /// # Errors
    /// As [`read_mesh`].
    pub fn read(path: &Path, unit: LengthScale, flip: bool) -> Result<(Self, Vec<String>), MeshError> {
        let file = read_mesh(path, unit)?;
        let warnings = file.warnings.iter().map(|warning| format!("{}: {warning}", path.display())).collect();
        let mut mesh = file.mesh;
        if flip {
            mesh.triangles.iter_mut().for_each(|[_, b, c]| std::mem::swap(b, c));
        }
        let name = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        Ok((Self::Mesh { name, mesh }, warnings))
    }

    /// A built-in shape's main length in mm, as [`Measures`] takes it; `None` for a mesh.
    pub fn size_mm(&self) -> Option<f64> {
        match self {
            Self::Shape(Shape::Corner { wall_mm, .. } | Shape::Groove { wall_mm, .. }) => Some(*wall_mm),
            Self::Shape(Shape::Bowl { radius_mm, .. }) => Some(*radius_mm),
            Self::Shape(Shape::Tray { side_mm }) => Some(*side_mm),
            Self::Mesh { .. } => None,
        }
    }

    /// What the user calls it.
    pub fn name(&self) -> &str {
        match self {
            Self::Shape(Shape::Corner { .. }) => "corner",
            Self::Shape(Shape::Groove { .. }) => "groove",
            Self::Shape(Shape::Bowl { half_angle_deg, .. }) if *half_angle_deg < 90.0 => "cap",
            Self::Shape(Shape::Bowl { .. }) => "bowl",
            Self::Shape(Shape::Tray { .. }) => "tray",
            Self::Mesh { name, .. } => name,
        }
    }
}

/// How bright the photos are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// The brightest pixel of all photos but the mirror ball's comes to this linear light; 1 is where it clips.
    Brightest(f64),
    /// The linear light of a white facet that faces the first lamp in the reference colour.
    White(f64),
}

/// The calibration balls, photographed by themselves in the object's place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallOptions {
    /// Side of the balls' pictures; a ball fills five sixths of it.
    pub size_px: usize,
    /// Albedo of the grey ball in every colour.
    pub grey_albedo: f64,
}

impl BallOptions {
    /// Balls for a paint: an 18 % grey ball as photographers use, or a darker one where the paint is darker still, so that
    /// the ball never is the brightest thing.
    pub fn for_paint(albedos: &[f64]) -> Self {
        Self { size_px: 200, grey_albedo: albedos.iter().copied().fold(0.18, f64::min) }
    }
}

/// Everything about a simulated capture set.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulateOptions {
    /// What the set is called.
    pub name: String,
    /// What is photographed.
    pub scene: Scene,
    /// About how many patches exchange light. Time grows with the square.
    pub patches: usize,
    /// Above this, form factors are not kept but computed again for every bounce.
    pub memory_limit_bytes: u64,
    /// The paint: an albedo for each colour, the reference colour first.
    pub albedos: Vec<f64>,
    /// A name for each colour.
    pub colours: Vec<String>,
    /// The lamps.
    pub lamps: Vec<LampOptions>,
    /// The lens.
    pub lens: Lens,
    /// Side of the object's square pictures.
    pub size_px: usize,
    /// Samples along each side of a pixel.
    pub samples_per_pixel_side: usize,
    /// How many bounces the truth holds.
    pub truth_bounces: usize,
    /// The sensor; its exposure is 1, see `exposure`.
    pub sensor: Sensor,
    /// How bright the photos are.
    pub exposure: Exposure,
    /// What each colour's photo sees of the other colours' lamps; `None` for nothing.
    pub crosstalk: Option<Crosstalk>,
    /// Store the colours as channels of one RGB photo, and photograph the grey ball under each lamp colour alone, too: what crosstalk is
    /// measured on. For up to three colours.
    pub crosstalk_shots: bool,
    /// The calibration balls; `None` for a set that lacks them.
    pub balls: Option<BallOptions>,
}

impl Default for SimulateOptions {
    /// A corner of three walls in the paint of the demo, three lamps.
    fn default() -> Self {
        let albedos = vec![0.75, 0.38];
        let shape = Shape::Corner { wall_mm: 60.0, roll_deg: -10.0 };
        Self {
            name: "Simulated corner".into(),
            scene: Scene::Shape(shape),
            patches: 1500,
            memory_limit_bytes: 2 << 30,
            colours: Self::colour_names(albedos.len()),
            lamps: LampOptions::ring(3, 20.0),
            lens: Lens::Orthographic,
            size_px: 256,
            samples_per_pixel_side: 3,
            truth_bounces: 4,
            sensor: Sensor { frames: 16, ..Sensor::default() },
            exposure: Exposure::Brightest(0.85),
            crosstalk: None,
            crosstalk_shots: false,
            balls: Some(BallOptions::for_paint(&albedos)),
            albedos,
        }
    }
}

/// A paint that reflects something, and not everything.
fn is_albedo(albedo: f64) -> bool {
    Number::GreyAlbedo.allows(albedo) && albedo < 1.0
}

impl SimulateOptions {
    /// Names for `count` colours: c1, c2, ..
    pub fn colour_names(count: usize) -> Vec<String> {
        (1..=count).map(|c| format!("c{c}")).collect()
    }

    /// Where no light is stored by a sensor that stores this much at most, unless the user says otherwise.
    pub fn usual_black_level(white_level: f64) -> f64 {
        (white_level / 128.0).round()
    }

    /// alpha of every lamp: what it gives, or what it makes up for the paint.
    pub fn alpha(&self) -> Vec<Vec<f64>> {
        self.lamps.iter().enumerate().map(|(l, lamp)| lamp.alpha_for(&self.albedos, l)).collect()
    }

    /// Whether every option is in its range. Lengths of shapes are checked where the shape is made.
    pub fn check(&self) -> Result<(), SimulateError> {
        if let Some(&albedo) = self.albedos.iter().find(|albedo| !is_albedo(**albedo)) {
            return Err(SimulateError::BadAlbedo { albedo });
        }
        let albedos = self.albedos.len() as f64;
        let range = "one for each lamp colour, at least one";
        check_range("the number of albedos", albedos, !self.albedos.is_empty(), range)?;
        let colours = self.albedos.len();
        check_range("the number of albedos", albedos, colours <= MAX_COLOURS, "at most 32")?;
        if self.colours.len() != colours {
            return Err(SimulateError::Count { what: "colour names", found: self.colours.len(), expected: colours });
        }
        let lamps = self.lamps.len();
        check_range("the number of lamps", lamps as f64, lamps >= 1, "at least 1; normals need 3")?;
        check_range("the number of lamps", lamps as f64, lamps <= MAX_LIGHTS, "at most 1000")?;
        for lamp in &self.lamps {
            lamp.check(colours)?;
        }
        for (option, value, least, most, range) in [
            ("patches", self.patches, 2, Self::MAX_PATCHES, "2 to 60000"),
            ("pixels", self.size_px, 16, 4096, "16 to 4096"),
            ("samples", self.samples_per_pixel_side, 1, 16, "1 to 16"),
            ("bounces", self.truth_bounces, 1, 16, "1 to 16"),
            ("the size of the balls' pictures", self.balls.map_or(200, |balls| balls.size_px), 32, 4096, "32 to 4096"),
        ] {
            check_range(option, value as f64, (least..=most).contains(&value), range)?;
        }
        if let Some(balls) = self.balls.filter(|balls| !is_albedo(balls.grey_albedo)) {
            return Err(SimulateError::BadAlbedo { albedo: balls.grey_albedo });
        }
        if self.crosstalk_shots {
            let channels = self.colours.len();
            check_range("the number of colours of RGB photos", channels as f64, (2..=3).contains(&channels), "2 or 3")?;
            let what = "balls of crosstalk shots";
            check_range(
                what,
                f64::from(u8::from(self.balls.is_some())),
                self.balls.is_some(),
                "1: do not leave the balls out",
            )?;
        }
        match self.exposure {
            Exposure::Brightest(light) => {
                let in_range = (1e-6..=1.0).contains(&light);
                check_range("the light of the brightest pixel", light, in_range, "from 1e-6 to 1")?;
            }
            Exposure::White(light) => {
                check_range("the exposure", light, Number::WhiteLight.allows(light), "from 1e-9 to 1e9")?;
            }
        }
        Ok(self.sensor.check()?)
    }

    /// More would take hours.
    pub const MAX_PATCHES: usize = 60_000;
}
