//! Photos to bounces.

use std::sync::Arc;

use firstbounce_capture::pipeline::{Separated, separate_lights};

use super::{Calibration, Loaded, Step, bits, scene};
use crate::app::state::document::Document;
use crate::app::state::results::engine::{AnyKey, Done, Known, Stage, Work};
use crate::app::state::results::error::StageError;
use crate::app::state::results::pictures::{Batch, MarksName, PlaneName};
use crate::app::state::results::{Of, Plain, Results};

/// The stage.
pub struct Separate;

#[derive(PartialEq)]
struct Key {
    load: u64,
    lights: Vec<String>,
    alpha: Vec<Vec<u64>>,
    beta: Vec<u64>,
    bounces: usize,
}

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

    fn job_name(&self) -> String {
        "Separate bounces".into()
    }

    fn key(&self, known: &Known) -> Option<AnyKey> {
        let (rig, _) = known.ready::<Calibration>(Step::Calibrate)?;
        let (loaded, load) = known.ready::<Loaded>(Step::Load)?;
        loaded.object.as_ref().ok()?;
        let rig = &rig.calibrated;
        let set = &known.document.set;
        Some(AnyKey::new(Key {
            load,
            lights: set.lights.iter().map(|light| light.name.clone()).collect(),
            alpha: rig.alpha.iter().map(|alpha| Some(bits(alpha.as_ref()?))).collect::<Option<_>>()?,
            beta: bits(rig.beta.as_ref()?),
            bounces: set.bounces(),
        }))
    }

    fn work(&self, document: Arc<Document>, results: &Results) -> Option<Work> {
        let (loaded, rig) = (results.loaded()?, results.calibration()?);
        Some(Box::new(move |job| {
            let set = &document.set;
            let separated = separate_lights(&scene(set, &loaded, &rig)?, set.bounces(), job)?;
            let names = set.lights.iter().map(|light| light.name.as_str());
            let pictures = pictures(names, &separated);
            Ok(Done::new(separated).with_pictures(pictures))
        }))
    }

    fn why_blocked(&self, document: &Document, results: &Results) -> StageError {
        match results.loaded().map(|loaded| loaded.object.as_ref().err().cloned()) {
            Some(Some(error)) => error,
            _ => results.rig(document).missing().unwrap_or(StageError::NoBeta),
        }
    }
}

fn pictures<'a>(lights: impl Iterator<Item = &'a str>, separated: &Separated) -> Batch {
    let mut batch = Batch::new(Step::Separate);
    for (light, separation) in lights.zip(&separated.lights) {
        for (k, bounce) in (1..).zip(&separation.bounces) {
            batch.put(PlaneName::Bounce(light.into(), k), bounce);
        }
        if let Some(noise) = &separation.direct_noise {
            batch.put(Plain::Noise.of(Of::light(light)), noise);
        }
        if let Some(residual) = &separation.residual {
            batch.put(Plain::Residual.of(Of::light(light)), residual);
        }
        batch.put_marks(MarksName::Separation(light.into()), &separation.marks);
    }
    batch
}
