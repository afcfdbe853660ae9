//! Colours and shape together: the colours tell direct from indirect light, the shape says what the indirect light is made of.

use firstbounce_core::methods::colours_and_shape::{
    ColoursAndShapeError, ColoursAndShapeReport, IndirectMaps, LightReport, Photographed, SeparatedLight,
    separate_by_colours_and_shape,
};
use firstbounce_core::separate::{LightPhotos, SeparateReport, Separation};
use firstbounce_core::stereo::normals::NormalsError;
use firstbounce_core::stereo::shape::ShapeError;

use super::super::watch::Part;
use super::super::{Direct, PipelineError, PipelineWatch, Separated, Stage};
use super::{Found, Input, MethodReport, Needs, OnShape, Row};

pub(super) const ROW: Row = Row {
    title: "colours and shape",
    purpose: "Photos in several colours tell direct from indirect light, and the shape says what the indirect light is made of",
    needs: Needs { all_colours: true, absolute_albedo: false, surface_before: false },
    one_paint: true,
    stage: Stage::Separate,
    direct_light,
};

/// What the method reports of itself.
#[derive(Clone, Debug, PartialEq)]
pub struct ColoursAndShapeSolved {
    /// How it went.
    pub report: ColoursAndShapeReport,
    /// By light, how the indirect light was found.
    pub maps: Vec<IndirectMaps>,
}

impl ColoursAndShapeSolved {
    /// What the user should know before trusting the surface.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if let Some(error) = &self.report.no_shape {
            let why = match error {
                ShapeError::Normals(NormalsError::TooFewLights { .. }) => {
                    "normals need three lights with a known direction".to_owned()
                }
                error => error.to_string(),
            };
            warnings.push(format!("the shape was not used ({why}): each light has one colour ratio of indirect light"));
        }
        if let Some(amount) = self.report.amount.filter(|amount| amount.has_other_paint()) {
            warnings.push(format!(
                "the colours of {:.0} % of the object do not fit beta: another paint is there; of it the reference colour alone was used",
                100.0 * amount.other_paint_share
            ));
        } else if let Some(amount) = self.report.amount.filter(|amount| amount.is_uneven()) {
            warnings.push(format!(
                "part of the cavity is out of view: the amount of indirect light varies by {:.0} % over the object",
                100.0 * amount.unevenness
            ));
        }
        warnings
    }
}

fn direct_light(input: &Input, watch: &dyn PipelineWatch, on_shape: &mut OnShape) -> Result<Found, PipelineError> {
    let Input { scene, options, .. } = input;
    let beta = scene.calibrated.beta_values()?;
    let alpha = (0..scene.object.photos.len()).map(|l| scene.alpha(l)).collect::<Result<Vec<_>, _>>()?;
    let photos: Vec<Vec<_>> =
        scene.object.photos.iter().map(|row| row.iter().map(|photo| &**photo).collect()).collect();
    let light = |l: usize| LightPhotos {
        photos: &photos[l],
        noise: &scene.object.noise[l],
        alpha: &alpha[l],
        beta: &beta,
        mask: &scene.object.mask,
    };
    let lights: Vec<_> = (0..photos.len()).map(light).collect();
    // Without a direction for every lamp there is no shape: the method then does without, and says so.
    let lamps = scene.lamps(&options.left_out).unwrap_or_else(|_| vec![None; lights.len()]);
    let camera = scene.camera();
    let photographed = Photographed { lights: &lights, lamps: &lamps, mask: &scene.object.mask, camera: &camera };
    let (method, shape) = (&options.colours_and_shape, &options.shape_after());
    let part = Part::of(watch, Stage::Separate, 0, 1);
    let found = separate_by_colours_and_shape(&photographed, method, shape, &part, on_shape);
    let found = found.map_err(|error| match error {
        ColoursAndShapeError::Cancelled => PipelineError::Cancelled,
        error => PipelineError::ColoursAndShape(error),
    })?;
    let reports = found.report.lights.iter().zip(&lights).map(|(report, light)| separate_report(report, light));
    let reports = reports.collect();
    let (separations, rest): (Vec<_>, Vec<_>) = found.lights.into_iter().map(split).unzip();
    let (indirect, direct) = rest.into_iter().unzip();
    let report = MethodReport::ColoursAndShape(ColoursAndShapeSolved { report: found.report, maps: found.maps });
    Ok(Found { separated: Separated { lights: separations, reports }, indirect, direct, shape: None, report })
}

/// The direct light as bounce 1, and what goes beside it.
fn split(light: SeparatedLight) -> (Separation, (firstbounce_core::Plane, Direct)) {
    let SeparatedLight { direct, indirect, noise, marks } = light;
    let separation = Separation {
        bounces: vec![direct.clone()],
        direct_noise: Some(noise.clone()),
        residual: None,
        marks: marks.clone(),
    };
    (separation, (indirect, Direct { light: direct, noise: Some(noise), marks, report: None }))
}

fn separate_report(report: &LightReport, light: &LightPhotos) -> SeparateReport {
    // Noise of a photo of the reference colour at the object's typical light.
    let photo = light.typical_sigma().first().map_or(0.0, |sigma| sigma / light.alpha[0]);
    SeparateReport {
        bounces: 1,
        colours: light.beta.len(),
        gain: vec![if photo > 0.0 { report.mean_noise / photo } else { 0.0 }],
        condition_number: 1.0,
        noise: vec![report.mean_noise],
        mean: vec![report.mean_direct],
        residual_rms: 0.0,
        residual_expected: 0.0,
        solved_pixels: report.solved_pixels,
        reduced_pixels: report.reduced_pixels,
        unsolved_clipped_pixels: report.unsolved_clipped_pixels,
        unsolved_dark_pixels: report.unsolved_dark_pixels,
    }
}
