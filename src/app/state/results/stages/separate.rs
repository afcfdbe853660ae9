//! Photos to direct light, by the method in force.

use std::sync::Arc;

use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::{Direct, Found, Lit, Method, MethodReport, Separated, find_light};
use firstbounce_core::stereo::shape::Shape;
use firstbounce_core::{Mask, Plane};
use rayon::prelude::*;

use super::depends::LightBy;
use super::{Step, scene};
use crate::app::state::document::Document;
use crate::app::state::results::engine::{AnyKey, Done, Known, Stage, Work};
use crate::app::state::results::error::StageError;
use crate::app::state::results::pictures::{Batch, MarksName, PlaneName};
use crate::app::state::results::{Of, Plain, Results};

/// What the method in force found.
#[derive(Clone, Debug)]
pub struct MethodLight {
    /// Which method.
    pub method: Method,
    /// The bounces that it tells apart, direct light first.
    pub separated: Arc<Separated>,
    /// By light, all light that bounced more than once; empty for a method that keeps bounces apart.
    pub indirect: Arc<Vec<Plane>>,
    /// By light, what the surface is recovered from.
    pub direct: Arc<Vec<Direct>>,
    /// What the method reports of itself.
    pub report: MethodReport,
    /// The shape of the photos before separation, where the method needed it.
    pub before: Option<Arc<Shape>>,
    /// The shape of the direct light, where the method found it on the way.
    pub after: Option<Arc<Shape>>,
    /// What the user should know before trusting it.
    pub warnings: Vec<String>,
}

/// The stage.
pub struct Separate;

impl Stage for Separate {
    fn step(&self) -> Step {
        Step::Separate
    }

    fn needs(&self) -> Option<Step> {
        Some(Step::Calibrate)
    }

    fn title(&self) -> String {
        "Separation".into()
    }

    fn job_name(&self, document: &Document) -> String {
        format!("Separate by {}", document.method().title())
    }

    fn key(&self, known: &Known) -> Option<AnyKey> {
        LightBy::of(known.document.method(), known).map(AnyKey::new)
    }

    fn work(&self, document: Arc<Document>, results: &Results) -> Option<Work> {
        let (loaded, rig) = (results.loaded()?, results.calibration()?);
        Some(Box::new(move |job| {
            let options = document.options(document.method());
            let lit = find_light(scene(&document.set, &loaded, &rig)?, None, &options, &mut Vec::new(), job)?;
            let (light, set, mask) = method_light(options.method, lit);
            let pictures = pictures(&set, &light, &mask);
            let warnings = light.warnings.clone();
            Ok(Done::new(light).with_pictures(pictures).with_warnings(warnings))
        }))
    }

    fn why_blocked(&self, document: &Document, results: &Results) -> StageError {
        match results.loaded().map(|loaded| loaded.object.as_ref().err().cloned()) {
            Some(Some(error)) => error,
            _ => results.rig(document).missing().unwrap_or(StageError::NoBeta),
        }
    }
}

fn method_light(method: Method, lit: Lit) -> (MethodLight, CaptureSet, Mask) {
    let Lit { set, scene, before, found, .. } = lit;
    let Found { separated, indirect, direct, shape, report } = found;
    let solved_pixels = shape.as_ref().map_or(0, |shape| shape.report.normals.solved_pixels);
    let light = MethodLight {
        method,
        separated: Arc::new(separated),
        indirect: Arc::new(indirect),
        direct: Arc::new(direct),
        warnings: report.warnings(solved_pixels),
        report,
        before,
        after: shape.map(Arc::new),
    };
    (light, set.into_owned(), scene.object.into_owned().mask)
}

fn pictures(set: &CaptureSet, light: &MethodLight, mask: &Mask) -> Batch {
    let mut batch = Batch::new(Step::Separate);
    for (l, (of, direct)) in set.lights.iter().zip(&*light.direct).enumerate() {
        let name = of.name.as_str();
        batch.put(Plain::Direct.of(Of::light(name)), &direct.light);
        if let Some(indirect) = light.indirect.get(l) {
            batch.put(Plain::Indirect.of(Of::light(name)), indirect);
        }
        if let Some(noise) = &direct.noise {
            batch.put(Plain::Noise.of(Of::light(name)), noise);
        }
        if let Some(separation) = light.separated.lights.get(l) {
            if light.method == Method::Colours {
                for (k, bounce) in (1..).zip(&separation.bounces) {
                    batch.put(PlaneName::Bounce(name.into(), k), bounce);
                }
            }
            if let Some(residual) = &separation.residual {
                batch.put(Plain::Residual.of(Of::light(name)), residual);
            }
            batch.put_marks(MarksName::Separation(name.into()), &separation.marks);
        }
    }
    maps(&mut batch, set, light, mask);
    batch
}

/// How the indirect light was found, brought from the cells of a grid to pixels.
fn maps(batch: &mut Batch, set: &CaptureSet, light: &MethodLight, mask: &Mask) {
    let Some(found) = light.report.colours_and_shape() else { return };
    let in_pixels = |cells: &Plane| {
        let mut plane = cells.repeated(found.report.step_px, mask.size());
        let inside = mask.data().par_iter();
        // Where there is no object a value would only widen the range of the colours.
        plane.data_mut().par_iter_mut().zip(inside).filter(|(_, inside)| !**inside).for_each(|(v, _)| *v = f32::NAN);
        plane
    };
    for (of, maps) in set.lights.iter().zip(&found.maps) {
        for (colour, ratio) in set.colours.iter().zip(&maps.ratio).skip(1) {
            batch.put(Plain::IndirectRatio.of(Of::light_in(&of.name, &colour.name)), &in_pixels(ratio));
        }
        if let Some(amount) = &maps.amount {
            let amount = in_pixels(amount);
            batch.put(Plain::IndirectAmount.of(Of::light(&of.name)), &amount);
            if let Some(albedo) = found.report.closure.as_ref().and_then(|closure| closure.albedo) {
                let over_albedo = amount.map(|amount| amount / albedo as f32);
                batch.put(Plain::AmountOverAlbedo.of(Of::light(&of.name)), &over_albedo);
            }
        }
    }
}
