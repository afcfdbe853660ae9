//! Capture sets whose truth is known: a scene is lit and photographed in memory, then written as any other set.
//!
//! The photos hold light without end (`core::radiosity`, all bounces), seen by a camera that errs; the truth tells the
//! first bounces apart. [`prepare`] does what depends on the surface alone, so that a preview can change paint, lamps and
//! camera without it.

mod error;
mod lamps;
mod options;
mod photos;
mod plan;
mod write;

use firstbounce_core::light::radiosity::{
    BounceOptions, FormFactorOptions, FormFactorReport, FormFactors, Patches, form_factors,
};
use firstbounce_core::light::scene::{
    RenderOptions, RenderReport, Rendering, SceneError, framed_through, mean_height_seen, refined, render,
    seen_from_behind,
};
use firstbounce_core::{Camera, Mask, Mesh, NormalMap, Plane, Portion, Watch};

use firstbounce_capture::set::{CaptureSet, Subject};

pub use error::SimulateError;
pub use lamps::{LampOptions, LampPlace, LampPlaces, NoLamp};
pub use options::{BallOptions, Exposure, Measures, Scene, SimulateOptions};
pub use plan::{PlanGrid, plan_advice, plan_rig};
pub use write::{RigRecord, check_folder, write_simulated};

/// More of the visible surface than this seen from behind is a mesh turned inside out.
const INSIDE_OUT: f64 = 0.5;
/// Less than this is the rounding of an edge.
const SPECK: f64 = 0.002;
/// A surface lies at z = 0 when its height differs from it by less than this fraction of its diagonal.
const LEVEL: f64 = 1e-4;
/// How often a surface is put lower or higher.
const MAX_LOOKS: usize = 5;

/// A surface whose light can be simulated for any paint and lamps, and the camera before it.
#[derive(Clone, Debug)]
pub struct PreparedScene {
    factors: FormFactors,
    camera: Camera,
    /// How good the form factors are.
    pub report: FormFactorReport,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// One photo as a file stores it.
#[derive(Clone, Debug)]
pub struct StoredPhoto {
    /// What it shows.
    pub subject: Subject,
    /// Index of the light.
    pub light: usize,
    /// Index of the colour; `None` for a mirror ball.
    pub colour: Option<usize>,
    /// Index of the colour of the only lamp that was on; `None` where all of the light were.
    pub alone: Option<usize>,
    /// Stored values, whole numbers.
    pub stored: Plane,
}

/// What is true of a simulated set.
#[derive(Clone, Debug)]
pub struct SimulatedTruth {
    /// Pixels that the object fills wholly.
    pub mask: Mask,
    /// Its normals.
    pub normals: NormalMap,
    /// Its depth.
    pub depth_mm: Plane,
    /// By light: linear light of bounce 1, 2, .. in the reference colour.
    pub bounces: Vec<Vec<Plane>>,
    /// What the lamps and the paint are.
    pub rig: RigRecord,
}

/// A capture set in memory.
#[derive(Clone, Debug)]
pub struct Simulated {
    /// The set; its folder is empty until it is written.
    pub set: CaptureSet,
    /// Every photo, in the order of the set's shots.
    pub photos: Vec<StoredPhoto>,
    /// What is true of it.
    pub truth: SimulatedTruth,
    /// What the simulation reports.
    pub report: SimulateReport,
}

/// What a simulation reports.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulateReport {
    /// The scene's name.
    pub scene: String,
    /// The form factors.
    pub factors: FormFactorReport,
    /// The rendering.
    pub render: RenderReport,
    /// Of the object's light in the reference colour, the share that bounced twice or more.
    pub indirect_share: f64,
    /// Pixels of the object that clip, in the photo with the most of them.
    pub clipped_pixels: usize,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Simulates a capture set in memory.
///
/// # Errors
/// One line: options out of range, a mesh that is inside out or too fine, a lamp that lights nothing, or `Cancelled`.
pub fn simulate(options: &SimulateOptions, watch: &dyn Watch) -> Result<Simulated, SimulateError> {
    options.check()?;
    let prepared = prepare(options, &Portion { watch, from: 0.0, to: 0.4 })?;
    simulate_prepared(&prepared, options, &Portion { watch, from: 0.4, to: 1.0 })
}

/// Finds what depends on scene, patches, lens and picture size alone: the form factors and the camera.
///
/// # Errors
/// As [`simulate`].
pub fn prepare(options: &SimulateOptions, watch: &dyn Watch) -> Result<PreparedScene, SimulateError> {
    let (patches, camera) = placed(mesh_of(&options.scene, options.patches)?, options)?;
    let mut warnings = Vec::new();
    let name = options.scene.name();
    match seen_from_behind(&patches, &camera) {
        None => return Err(SceneError::NothingToSee.into()),
        Some(share) if share > INSIDE_OUT => {
            return Err(SimulateError::InsideOut { name: name.to_owned(), percent: 100.0 * share });
        }
        Some(share) if share > SPECK => warnings.push(format!(
            "{name}: {:.1} % of what the camera sees is the back of an open surface; it stays black",
            100.0 * share
        )),
        Some(_) => {}
    }
    let factor_options =
        FormFactorOptions { memory_limit_bytes: options.memory_limit_bytes, ..FormFactorOptions::default() };
    let (factors, report) = form_factors(patches, &factor_options, watch)?;
    if !report.stored {
        warnings.push(format!(
            "form factors of {} patches need {} MiB, more than the limit of {} MiB: they are computed again for every bounce, \
             which takes longer",
            report.patches,
            (2 * report.patches as u64 * (report.patches as u64 - 1)) >> 20,
            options.memory_limit_bytes >> 20
        ));
    }
    Ok(PreparedScene { factors, camera, report, warnings })
}

/// Lights and photographs a scene that was prepared for the same scene, patches, lens and picture size.
///
/// # Errors
/// As [`simulate`].
pub fn simulate_prepared(
    prepared: &PreparedScene,
    options: &SimulateOptions,
    watch: &dyn Watch,
) -> Result<Simulated, SimulateError> {
    options.check()?;
    let lamps: Vec<_> = options.lamps.iter().map(LampOptions::lamp).collect();
    let render_options = RenderOptions {
        bounces: BounceOptions {
            albedos: options.albedos.clone(),
            bounces: options.truth_bounces,
            ..BounceOptions::default()
        },
        samples_per_pixel_side: options.samples_per_pixel_side,
        ..RenderOptions::default()
    };
    let rendering = Portion { watch, from: 0.0, to: 0.85 };
    let (rendering, render_report) = render(&prepared.factors, &lamps, &prepared.camera, &render_options, &rendering)?;
    every_lamp_lights(options, &rendering)?;
    let mut simulated =
        photos::photograph(prepared, options, rendering, render_report, &Portion { watch, from: 0.85, to: 1.0 })?;
    simulated.report.warnings.splice(0..0, prepared.warnings.iter().cloned());
    Ok(simulated)
}

/// The surface before its camera, at the height at which depth from normals will be put: near lamps and a pinhole stand where
/// they do over that z = 0.
fn placed(mut mesh: Mesh, options: &SimulateOptions) -> Result<(Patches, Camera), SimulateError> {
    // A first guess that no pinhole is in.
    let (low, high) = mesh.bounds().ok_or(SceneError::NothingToSee)?;
    let mut height_mm = f64::from(low.z + high.z) / 2.0;
    let mut looks = 0;
    loop {
        mesh.positions.iter_mut().for_each(|position| position.z -= height_mm as f32);
        let (framed, camera) = framed_through(mesh, options.lens, options.size_px)?;
        let patches = Patches::from_mesh(&framed)?;
        height_mm = mean_height_seen(&patches, &camera).ok_or(SceneError::NothingToSee)?;
        looks += 1;
        // A pinhole sees another part of a surface that has moved, if only a little.
        if height_mm.abs() < LEVEL * patches.diagonal_mm() || looks == MAX_LOOKS {
            return Ok((patches, camera));
        }
        mesh = framed;
    }
}

/// The scene's surface in about as many triangles as asked for.
fn mesh_of(scene: &Scene, patches: usize) -> Result<Mesh, SimulateError> {
    let (name, mesh) = match scene {
        Scene::Shape(shape) => return Ok(shape.mesh(patches)?),
        Scene::Mesh { name, mesh } => (name, mesh),
    };
    let (triangles, most) = (mesh.triangles.len(), SimulateOptions::MAX_PATCHES);
    if triangles > most {
        return Err(SimulateError::TooManyTriangles { name: name.clone(), triangles, most });
    }
    // Readers smooth normals over creases; without any, patches find the creases themselves.
    Ok(refined(Mesh { normals: Vec::new(), ..mesh.clone() }, patches))
}

fn every_lamp_lights(options: &SimulateOptions, rendering: &Rendering) -> Result<(), SimulateError> {
    for (lamp, light) in options.lamps.iter().zip(&rendering.lights) {
        if !light.bounces[0].data().iter().any(|&direct| direct > 0.0) {
            return Err(SimulateError::LampLightsNothing { light: lamp.name.clone() });
        }
    }
    Ok(())
}
