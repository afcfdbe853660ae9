//! Options of a simulated scene, shared by `simulate` and `plan`.

use std::path::Path;

use anyhow::bail;
use clap::Args;
use firstbounce_core::light::scene::Lens;
use firstbounce_lab::simulate::{BallOptions, Exposure, LampOptions, LampPlaces, Measures, Scene, SimulateOptions};
use firstbounce_lab::{Crosstalk, Sensor};
use nalgebra::DMatrix;

use super::unit::Unit;

/// The scene, its paint, the lamps and the camera.
#[derive(Args, Debug)]
pub struct SceneArgs {
    /// corner, groove, bowl, cap, tray, or a mesh: OBJ, PLY or STL, z toward the camera
    #[arg(value_name = "SCENE")]
    scene: String,
    /// The paint's albedo in each lamp colour, the reference colour first
    #[arg(long, value_name = "A,B,..", value_delimiter = ',', default_values_t = [0.75, 0.38])]
    albedos: Vec<f64>,
    /// A name for each colour [default: c1,c2,..]
    #[arg(long, value_name = "NAME,..", value_delimiter = ',')]
    colours: Vec<String>,
    /// Lamps: ring:COUNT:TILT in degrees, dir:X,Y,Z, point:X,Y,Z in mm or area:X,Y,Z:SIDE in mm; several by ; or by
    /// giving it again
    #[arg(long, value_name = "LAMPS", value_delimiter = ';', default_value = "ring:3:20")]
    lights: Vec<LampPlaces>,
    /// Strength of each lamp in the reference colour [default: 1, 1.05, 0.95, repeated]
    #[arg(long, value_name = "A,B,..", value_delimiter = ',')]
    intensities: Vec<f64>,
    /// Intensity of each colour over the reference colour's, for all lamps, or for each lamp by ; [default: what makes up
    /// for the paint, a few percent differently from lamp to lamp]
    #[arg(long, value_name = "1,A,..;..", value_delimiter = ';', value_parser = numbers)]
    alpha: Vec<Numbers>,
    /// The shape's main length: a wall, a radius, a side
    #[arg(long, value_name = "MM")]
    size: Option<f64>,
    /// Between the walls of a groove, or from a cap's axis to its edge [default: 90, or 60]
    #[arg(long, value_name = "DEGREES")]
    angle: Option<f64>,
    /// What one unit of the mesh is [default: mm]
    #[arg(long, value_enum)]
    unit: Option<Unit>,
    /// Turn the mesh's faces the other way round
    #[arg(long)]
    flip: bool,
    /// About how many patches exchange light
    #[arg(long, value_name = "COUNT", default_value_t = SimulateOptions::default().patches)]
    patches: usize,
    /// Memory for form factors; beyond it they are computed again for every bounce
    #[arg(long, value_name = "MIB", default_value_t = SimulateOptions::default().memory_limit_bytes >> 20)]
    memory: u64,
    /// A pinhole camera this far from the object instead of parallel rays
    #[arg(long, value_name = "MM")]
    perspective: Option<f64>,
    /// Electrons of a pixel where it clips; inf for a camera without noise
    #[arg(long, value_name = "ELECTRONS", default_value_t = Sensor::default().full_well_electrons)]
    full_well: f64,
    /// Read noise
    #[arg(long, value_name = "ELECTRONS", default_value_t = Sensor::default().read_noise_electrons)]
    read_noise: f64,
    /// Bits of a stored value
    #[arg(long, default_value_t = Sensor::default().bits)]
    bits: u32,
    /// The stored value at no light [default: 1/128 of the white level]
    #[arg(long, value_name = "LEVEL")]
    black_level: Option<f64>,
    /// Frames averaged in each photo
    #[arg(long, value_name = "COUNT", default_value_t = SimulateOptions::default().sensor.frames)]
    frames: usize,
    /// Exposure: the linear light of the brightest pixel, or white:LIGHT for that of a white facet that faces the first lamp
    #[arg(long, value_name = "LIGHT", default_value = "0.85", value_parser = exposure)]
    exposure: Exposure,
}

/// Numbers for one lamp.
#[derive(Clone, Debug)]
pub struct Numbers(pub Vec<f64>);

/// Numbers with commas between.
pub fn numbers(text: &str) -> Result<Numbers, String> {
    let number = |part: &str| part.trim().parse::<f64>().map_err(|_| format!("\"{part}\" is no number"));
    text.split(',').map(number).collect::<Result<_, _>>().map(Numbers)
}

fn exposure(text: &str) -> Result<Exposure, String> {
    let (white, number) = text.strip_prefix("white:").map_or((false, text), |number| (true, number));
    let light = number.trim().parse().map_err(|_| format!("\"{number}\" is no number"))?;
    Ok(if white { Exposure::White(light) } else { Exposure::Brightest(light) })
}

/// A crosstalk matrix from its rows; one row of one number is what each colour sees of every other.
pub fn crosstalk(rows: &[Numbers], colours: usize) -> anyhow::Result<Option<Crosstalk>> {
    match rows {
        [] => Ok(None),
        [Numbers(leak)] if leak.len() == 1 => Ok(Some(Crosstalk::even(colours, leak[0])?)),
        rows if rows.len() == colours && rows.iter().all(|row| row.0.len() == colours) => {
            Ok(Some(Crosstalk::new(DMatrix::from_fn(colours, colours, |i, j| rows[i].0[j]))?))
        }
        _ => bail!("the crosstalk needs one number, or a row of {colours} numbers for each of the {colours} colours"),
    }
}

impl SceneArgs {
    /// As the simulation takes them, and what to warn of.
    pub fn options(&self) -> anyhow::Result<(SimulateOptions, Vec<String>)> {
        let (scene, warnings) = self.scene()?;
        let count = self.albedos.len();
        let sensor = Sensor {
            full_well_electrons: self.full_well,
            read_noise_electrons: self.read_noise,
            bits: self.bits,
            frames: self.frames,
            ..Sensor::default()
        };
        let black_level = self.black_level.unwrap_or_else(|| SimulateOptions::usual_black_level(sensor.white_level()));
        let options = SimulateOptions {
            name: format!("Simulated {}", scene.name()),
            scene,
            patches: self.patches,
            memory_limit_bytes: self.memory << 20,
            colours: if self.colours.is_empty() { SimulateOptions::colour_names(count) } else { self.colours.clone() },
            lamps: self.lamps()?,
            lens: self.perspective.map_or(Lens::Orthographic, |mm| Lens::Perspective { working_distance_mm: mm }),
            sensor: Sensor { black_level, ..sensor },
            exposure: self.exposure,
            balls: Some(BallOptions::for_paint(&self.albedos)),
            albedos: self.albedos.clone(),
            ..SimulateOptions::default()
        };
        options.check()?;
        Ok((options, warnings))
    }

    fn scene(&self) -> anyhow::Result<(Scene, Vec<String>)> {
        if let Some(scene) = Scene::built_in(&self.scene, Measures { size_mm: self.size, angle_deg: self.angle }) {
            self.check_shape()?;
            return Ok((scene, Vec::new()));
        }
        let path = Path::new(&self.scene);
        // A word without a dot or a slash was meant as a shape.
        if !path.exists() && path.extension().is_none() && path.components().count() < 2 {
            bail!("there is no scene \"{}\"; take {}, or a mesh file", self.scene, Scene::BUILT_IN.join(", "));
        }
        for (given, option) in [(self.size.is_some(), "--size"), (self.angle.is_some(), "--angle")] {
            if given {
                bail!(
                    "{option} is for the built-in shapes; a mesh file has its own measures, in the unit that --unit gives"
                );
            }
        }
        Ok(Scene::read(path, self.unit.unwrap_or(Unit::Mm).into(), self.flip)?)
    }

    /// Refuses what a built-in shape would take no notice of.
    fn check_shape(&self) -> anyhow::Result<()> {
        let scene = self.scene.as_str();
        if self.angle.is_some() && !Scene::WITH_ANGLE.contains(&scene) {
            bail!("--angle is for {}; leave it out for {scene}", Scene::WITH_ANGLE.join(" and "));
        }
        for (given, option) in [(self.unit.is_some(), "--unit"), (self.flip, "--flip")] {
            if given {
                bail!("{option} is for a mesh file; leave it out for {scene}");
            }
        }
        Ok(())
    }

    fn lamps(&self) -> anyhow::Result<Vec<LampOptions>> {
        let mut lamps = LampOptions::named(self.lights.iter().flat_map(|places| places.0.iter().copied()));
        let count = lamps.len();
        if !self.intensities.is_empty() {
            if self.intensities.len() != count {
                bail!("{} intensities for {count} lamps; give one for each", self.intensities.len());
            }
            lamps.iter_mut().zip(&self.intensities).for_each(|(lamp, intensity)| lamp.intensity = *intensity);
        }
        match self.alpha.as_slice() {
            [] => {}
            [Numbers(all)] => lamps.iter_mut().for_each(|lamp| lamp.alpha = Some(all.clone())),
            each if each.len() == count => {
                lamps.iter_mut().zip(each).for_each(|(lamp, alpha)| lamp.alpha = Some(alpha.0.clone()));
            }
            each => bail!("alpha of {} lamps for {count} lamps; give one list, or one for each", each.len()),
        }
        Ok(lamps)
    }
}
