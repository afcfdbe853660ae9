//! Capture checks that need the rig: whether lamps and photos belong together.

use std::sync::Arc;

use firstbounce_capture::pipeline::{CaptureReport, CheckOptions};

use super::{Calibration, Loaded, Step};
use crate::app::state::document::Document;
use crate::app::state::results::Results;
use crate::app::state::results::engine::{AnyKey, Done, Known, Stage, Work};

/// What is wrong with photos and rig.
#[derive(Clone, Debug)]
pub struct Checked {
    /// The worst first.
    pub captures: CaptureReport,
}

/// The stage.
pub struct Check;

impl Stage for Check {
    fn step(&self) -> Step {
        Step::Check
    }

    fn needs(&self) -> Option<Step> {
        Some(Step::Calibrate)
    }

    fn title(&self) -> String {
        "Capture checks".into()
    }

    fn job_name(&self, _: &Document) -> String {
        "Check captures".into()
    }

    fn key(&self, known: &Known) -> Option<AnyKey> {
        let (_, load) = known.ready::<Loaded>(Step::Load)?;
        let (_, calibrate) = known.ready::<Calibration>(Step::Calibrate)?;
        Some(AnyKey::new((load, calibrate)))
    }

    fn work(&self, document: Arc<Document>, results: &Results) -> Option<Work> {
        let (loaded, rig) = (results.loaded()?, results.calibration()?);
        Some(Box::new(move |job| {
            let options = CheckOptions::default();
            let captures = loaded.captures.with_rig(&document.set, &rig.calibrated, &options, job);
            // Those of the photos were reported when they were read, those of the balls when they were measured.
            let known = [loaded.captures.report.lines(), rig.calibrated.warnings.clone()].concat();
            let warnings = captures.lines().into_iter().filter(|line| !known.contains(line)).collect();
            Ok(Done::new(Checked { captures }).with_warnings(warnings))
        }))
    }
}
