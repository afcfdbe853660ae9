//! The form's values, and the options that they mean.

use firstbounce_capture::mesh_file::read::LengthScale;
use firstbounce_core::light::scene::Lens;
use firstbounce_lab::Sensor;
use firstbounce_lab::simulate::{BallOptions, Exposure, LampOptions, Measures, Scene, SimulateError, SimulateOptions};
use thiserror::Error;

use super::mesh::{MeshChoice, NoScene};

/// Where a lens is put first: a few times as far as the built-in shapes are wide.
const DEFAULT_DISTANCE_MM: f64 = 400.0;
const DEFAULT_LAMP_SIDE_MM: f64 = 60.0;
/// Of a new ring, as of the options' own.
const DEFAULT_TILT_DEG: f64 = 20.0;

/// What is photographed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SceneKind {
    #[default]
    Corner,
    Groove,
    Bowl,
    Cap,
    Tray,
    Mesh,
}

impl SceneKind {
    /// All, in the order of a choice.
    pub const ALL: [Self; 6] = [Self::Corner, Self::Groove, Self::Bowl, Self::Cap, Self::Tray, Self::Mesh];

    /// As the user reads it.
    pub fn title(self) -> &'static str {
        match self {
            Self::Corner => "Corner",
            Self::Groove => "Groove",
            Self::Bowl => "Bowl",
            Self::Cap => "Cap",
            Self::Tray => "Tray",
            Self::Mesh => "Mesh file",
        }
    }

    /// What the size measures; `None` for a mesh, which has its own.
    pub fn size_name(self) -> Option<&'static str> {
        match self {
            Self::Corner | Self::Groove => Some("Length of a wall"),
            Self::Bowl | Self::Cap => Some("Radius of the sphere"),
            Self::Tray => Some("Side of the tray"),
            Self::Mesh => None,
        }
    }

    /// What the angle measures, and what it is at first.
    pub fn angle(self) -> Option<(&'static str, f64)> {
        match self {
            Self::Groove => Some(("Angle between the walls", 90.0)),
            Self::Cap => Some(("Half angle of the cap", 60.0)),
            _ => None,
        }
    }

    /// The built-in shape of this kind; `None` for a mesh.
    pub fn built_in(self, measures: Measures) -> Option<Scene> {
        Scene::built_in(&self.title().to_lowercase(), measures)
    }
}

/// What the lamps are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LampKind {
    #[default]
    Distant,
    Point,
    Area,
}

impl LampKind {
    /// All, in the order of a choice.
    pub const ALL: [Self; 3] = [Self::Distant, Self::Point, Self::Area];

    /// As the user reads it.
    pub fn title(self) -> &'static str {
        match self {
            Self::Distant => "Far away",
            Self::Point => "Near, small",
            Self::Area => "Near, square",
        }
    }
}

/// What is chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct Values {
    pub scene: SceneKind,
    pub size_mm: f64,
    pub angle_deg: f64,
    pub unit: LengthScale,
    pub flip: bool,
    pub patches: usize,
    pub albedos: Vec<f64>,
    /// The order m that is planned for.
    pub bounces: usize,
    pub lamps: LampKind,
    pub tilt_deg: f64,
    /// Of near lamps, from the object.
    pub lamp_distance_mm: f64,
    /// Of square lamps.
    pub lamp_side_mm: f64,
    /// Of each lamp of the ring.
    pub intensities: Vec<f64>,
    pub is_perspective: bool,
    pub distance_mm: f64,
    pub pixels: usize,
    pub bits: u32,
    pub frames: usize,
    pub full_well: f64,
    pub read_noise: f64,
    /// Linear light of the brightest pixel.
    pub exposure: f64,
    pub balls: bool,
    pub seed: u64,
}

impl Default for Values {
    fn default() -> Self {
        let options = SimulateOptions::default();
        let exposure = match options.exposure {
            Exposure::Brightest(light) | Exposure::White(light) => light,
        };
        let mut values = Self {
            scene: SceneKind::default(),
            size_mm: 0.0,
            angle_deg: 0.0,
            unit: LengthScale::default(),
            flip: false,
            patches: options.patches,
            albedos: options.albedos,
            bounces: 2,
            lamps: LampKind::default(),
            tilt_deg: DEFAULT_TILT_DEG,
            lamp_distance_mm: DEFAULT_DISTANCE_MM,
            lamp_side_mm: DEFAULT_LAMP_SIDE_MM,
            intensities: options.lamps.iter().map(|lamp| lamp.intensity).collect(),
            is_perspective: false,
            distance_mm: DEFAULT_DISTANCE_MM,
            pixels: options.size_px,
            bits: options.sensor.bits,
            frames: options.sensor.frames,
            full_well: options.sensor.full_well_electrons,
            read_noise: options.sensor.read_noise_electrons,
            exposure,
            balls: options.balls.is_some(),
            seed: options.sensor.seed,
        };
        values.take_measures();
        values
    }
}

/// Why the values are no options yet.
#[derive(Debug, Error)]
pub enum ValuesError {
    /// There is no scene.
    #[error(transparent)]
    Scene(#[from] NoScene),
    /// A value is out of its range.
    #[error(transparent)]
    Options(#[from] SimulateError),
}

impl Values {
    /// Gives the shape its usual measures.
    pub fn take_measures(&mut self) {
        self.size_mm = self.scene.built_in(Measures::default()).and_then(|scene| scene.size_mm()).unwrap_or(0.0);
        self.angle_deg = self.scene.angle().map_or(0.0, |(_, degrees)| degrees);
    }

    /// So many lamps on the ring; new ones are as strong as those of a new ring.
    pub fn resize_ring(&mut self, count: usize) {
        let fresh = LampOptions::ring(count, self.tilt_deg);
        self.intensities.truncate(count);
        self.intensities.extend(fresh.iter().skip(self.intensities.len()).map(|lamp| lamp.intensity));
    }

    /// The order m that these colours can be separated with.
    pub fn order(&self) -> usize {
        self.bounces.min(self.albedos.len())
    }

    fn ring(&self) -> Vec<LampOptions> {
        let (count, tilt_deg, distance_mm) = (self.intensities.len(), self.tilt_deg, self.lamp_distance_mm);
        let mut lamps = match self.lamps {
            LampKind::Distant => LampOptions::ring(count, tilt_deg),
            LampKind::Point => LampOptions::near_ring(count, tilt_deg, distance_mm, None),
            LampKind::Area => LampOptions::near_ring(count, tilt_deg, distance_mm, Some(self.lamp_side_mm)),
        };
        lamps.iter_mut().zip(&self.intensities).for_each(|(lamp, intensity)| lamp.intensity = *intensity);
        lamps
    }

    /// The options that these values mean.
    ///
    /// # Errors
    /// What to change.
    pub fn options(&self, mesh: &MeshChoice) -> Result<SimulateOptions, ValuesError> {
        let measures = Measures { size_mm: Some(self.size_mm), angle_deg: self.scene.angle().map(|_| self.angle_deg) };
        let scene = match self.scene.built_in(measures) {
            Some(scene) => scene,
            None => mesh.scene()?,
        };
        let sensor = Sensor {
            full_well_electrons: self.full_well,
            read_noise_electrons: self.read_noise,
            bits: self.bits,
            frames: self.frames,
            seed: self.seed,
            ..Sensor::default()
        };
        let black_level = SimulateOptions::usual_black_level(sensor.white_level());
        let distance = Lens::Perspective { working_distance_mm: self.distance_mm };
        let options = SimulateOptions {
            name: format!("Simulated {}", scene.name()),
            scene,
            patches: self.patches,
            colours: SimulateOptions::colour_names(self.albedos.len()),
            lamps: self.ring(),
            lens: if self.is_perspective { distance } else { Lens::Orthographic },
            size_px: self.pixels,
            sensor: Sensor { black_level, ..sensor },
            exposure: Exposure::Brightest(self.exposure),
            balls: self.balls.then(|| BallOptions::for_paint(&self.albedos)),
            albedos: self.albedos.clone(),
            ..SimulateOptions::default()
        };
        options.check()?;
        Ok(options)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_chosen_at_first_is_what_the_command_line_takes() {
        let options = Values::default().options(&MeshChoice::default()).unwrap();
        let own = SimulateOptions::default();
        assert_eq!(options, SimulateOptions { sensor: options.sensor, ..own.clone() });
        assert_eq!(options.sensor, Sensor { black_level: 512.0, ..own.sensor });
    }

    #[test]
    fn a_mesh_that_was_not_chosen_is_asked_for() {
        let values = Values { scene: SceneKind::Mesh, ..Values::default() };
        let line = values.options(&MeshChoice::default()).unwrap_err().to_string();
        assert!(line.contains("choose a mesh file"), "{line}");
    }
}
