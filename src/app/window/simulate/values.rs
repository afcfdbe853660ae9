//! The form's values, and the options that they mean.

use firstbounce_capture::mesh_file::read::LengthScale;
use firstbounce_core::light::scene::Lens;
use firstbounce_lab::Sensor;
use firstbounce_lab::simulate::{BallOptions, LampOptions, Measures, Scene, SimulateError, SimulateOptions};
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
    pub scene: SceneValues,
    pub ring: RingValues,
    pub lens: LensValues,
    pub balls: bool,
    /// The order m that is planned for.
    pub bounces: usize,
    /// Patches, paint, pictures and sensor, which the options take as they are; the rest is made of the above.
    pub base: SimulateOptions,
}

/// What is photographed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneValues {
    pub kind: SceneKind,
    pub size_mm: f64,
    pub angle_deg: f64,
    /// Of a mesh.
    pub unit: LengthScale,
    /// Whether the faces of a mesh are turned round.
    pub flip: bool,
}

/// The lamps on their ring.
#[derive(Clone, Debug, PartialEq)]
pub struct RingValues {
    pub kind: LampKind,
    pub tilt_deg: f64,
    /// Of near lamps, from the object.
    pub distance_mm: f64,
    /// Of square lamps.
    pub side_mm: f64,
    /// Of each lamp.
    pub intensities: Vec<f64>,
}

/// The lens.
#[derive(Clone, Debug, PartialEq)]
pub struct LensValues {
    pub is_perspective: bool,
    pub distance_mm: f64,
}

impl Default for Values {
    fn default() -> Self {
        let base = SimulateOptions::default();
        let mut scene = SceneValues::default();
        scene.take_measures();
        Self {
            scene,
            ring: RingValues {
                kind: LampKind::default(),
                tilt_deg: DEFAULT_TILT_DEG,
                distance_mm: DEFAULT_DISTANCE_MM,
                side_mm: DEFAULT_LAMP_SIDE_MM,
                intensities: base.lamps.iter().map(|lamp| lamp.intensity).collect(),
            },
            lens: LensValues { is_perspective: false, distance_mm: DEFAULT_DISTANCE_MM },
            balls: base.balls.is_some(),
            bounces: 2,
            base,
        }
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

impl SceneValues {
    /// Gives the shape its usual measures.
    pub fn take_measures(&mut self) {
        self.size_mm = self.kind.built_in(Measures::default()).and_then(|scene| scene.size_mm()).unwrap_or(0.0);
        self.angle_deg = self.kind.angle().map_or(0.0, |(_, degrees)| degrees);
    }

    fn built_in(&self) -> Option<Scene> {
        let angle_deg = self.kind.angle().map(|_| self.angle_deg);
        self.kind.built_in(Measures { size_mm: Some(self.size_mm), angle_deg })
    }
}

impl RingValues {
    /// So many lamps; new ones are as strong as those of a new ring.
    pub fn resize(&mut self, count: usize) {
        let fresh = LampOptions::ring(count, self.tilt_deg);
        self.intensities.truncate(count);
        self.intensities.extend(fresh.iter().skip(self.intensities.len()).map(|lamp| lamp.intensity));
    }

    fn lamps(&self) -> Vec<LampOptions> {
        let (count, tilt_deg, distance_mm) = (self.intensities.len(), self.tilt_deg, self.distance_mm);
        let mut lamps = match self.kind {
            LampKind::Distant => LampOptions::ring(count, tilt_deg),
            LampKind::Point => LampOptions::near_ring(count, tilt_deg, distance_mm, None),
            LampKind::Area => LampOptions::near_ring(count, tilt_deg, distance_mm, Some(self.side_mm)),
        };
        lamps.iter_mut().zip(&self.intensities).for_each(|(lamp, intensity)| lamp.intensity = *intensity);
        lamps
    }
}

impl LensValues {
    fn lens(&self) -> Lens {
        match self.is_perspective {
            true => Lens::Perspective { working_distance_mm: self.distance_mm },
            false => Lens::Orthographic,
        }
    }
}

impl Values {
    /// The order m that these colours can be separated with.
    pub fn order(&self) -> usize {
        self.bounces.min(self.base.albedos.len())
    }

    /// The options that these values mean.
    ///
    /// # Errors
    /// What to change.
    pub fn options(&self, mesh: &MeshChoice) -> Result<SimulateOptions, ValuesError> {
        let scene = match self.scene.built_in() {
            Some(scene) => scene,
            None => mesh.scene()?,
        };
        let (albedos, sensor) = (&self.base.albedos, self.base.sensor);
        let black_level = SimulateOptions::usual_black_level(sensor.white_level());
        let options = SimulateOptions {
            name: format!("Simulated {}", scene.name()),
            scene,
            colours: SimulateOptions::colour_names(albedos.len()),
            lamps: self.ring.lamps(),
            lens: self.lens.lens(),
            sensor: Sensor { black_level, ..sensor },
            balls: self.balls.then(|| BallOptions::for_paint(albedos)),
            ..self.base.clone()
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
        let values =
            Values { scene: SceneValues { kind: SceneKind::Mesh, ..SceneValues::default() }, ..Values::default() };
        let line = values.options(&MeshChoice::default()).unwrap_err().to_string();
        assert!(line.contains("choose a mesh file"), "{line}");
    }
}
