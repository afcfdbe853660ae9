//! The other method, for comparison: Nayar, Ikeuchi and Kanade 1991 on the photos of the reference colour.

use firstbounce_capture::pipeline::{
    AlbedoScale, Beginning, Known, NayarSolved, camera_of, raw_lights, simulate_away, triangulate, white_light,
};
use firstbounce_core::mesh::MeshOptions;
use firstbounce_core::methods::by_shape::ByShapeReport;
use firstbounce_core::stereo::shape::Shape;
use firstbounce_core::{AngularError, Mesh, Plane};

use super::Calibration;
use super::run::{Loaded, Shapes, Used, kept, line};
use crate::app::base::jobs::Job;
use crate::app::state::document::Document;

/// What Nayar's method found.
#[derive(Clone, Debug)]
pub struct ByNayar {
    /// Normals, albedo, depth.
    pub shape: Shape,
    /// The depth as triangles.
    pub mesh: Mesh,
    /// Names of the lights that were used, and the direct light of each.
    pub direct: Vec<(String, Plane)>,
    /// How the iterations went.
    pub report: ByShapeReport,
    /// Linear light of a white facet that faces a lamp of intensity 1.
    pub white_light: Known<f64>,
    /// How far its normals are from those of bounce 1; `None` where no pixel has both.
    pub from_bounce_1: Option<AngularError>,
    /// What a person should know before trusting it.
    pub warnings: Vec<String>,
}

pub fn run(
    document: &Document,
    loaded: &Loaded,
    calibration: &Calibration,
    shapes: &Shapes,
    job: &Job,
) -> Result<ByNayar, String> {
    let object = loaded.object.as_ref().map_err(Clone::clone)?;
    let calibrated = &calibration.calibrated;
    let white_light = white_light(&document.set, calibrated, &AlbedoScale::default(), job).map_err(line)?;
    let raw = raw_lights(object, job).map_err(line)?;
    let camera = camera_of(&document.set, object.mask.size());
    let Used { set, calibrated, used } = Used::of(document, calibrated);
    let beginning = Beginning {
        raw: &kept(&raw, &used),
        pseudo_shape: &shapes.before,
        mask: &object.mask,
        camera: &camera,
        white_light: white_light.value,
    };
    let (options, shape) = (document.settings.nayar.options(), document.settings.shape.options().shape);
    let found = simulate_away(&set, &calibrated, &beginning, &options, &shape, job, &mut |_, _| {}).map_err(line)?;
    let from_bounce_1 = found.shape.normals.map.angular_error(&shapes.after.normals.map, &object.mask);
    let solved = NayarSolved { report: found.report.clone(), white_light: white_light.clone() };
    let warnings = solved.warnings(found.shape.report.normals.solved_pixels);
    let direct = set.lights.iter().map(|light| light.name.clone()).zip(found.direct).collect();
    let mesh = triangulate(&found.shape, &camera, &MeshOptions::default()).map_err(line)?;
    Ok(ByNayar { shape: found.shape, mesh, direct, report: found.report, white_light, from_bounce_1, warnings })
}
