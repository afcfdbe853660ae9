//! Colours and shape together in numbers.

use firstbounce_core::methods::colours_and_shape::{AmountReport, ColourClosure, EndOfRatio, LightReport};
use indexmap::IndexMap;
use serde::Serialize;

use crate::pipeline::ColoursAndShapeSolved;
use crate::set::CaptureSet;

/// How the method went, and what it says of albedo and beta.
#[derive(Clone, Debug, Serialize)]
pub struct ColoursAndShapeRecord {
    /// Pixels along a cell of the grid on which arriving light was computed.
    pub step_px: usize,
    /// By light.
    pub light: IndexMap<String, LightWords>,
    /// s, the amount of indirect light; absent without a shape.
    pub amount: Option<AmountReport>,
    /// k, the absolute albedo in the reference colour; absent where the light of white is not known, or for several paints.
    pub k: Option<f64>,
    /// s over k, of s the part that can be compared.
    pub s_over_k: Option<f64>,
    /// Linear light of a white facet that faces a lamp of intensity 1.
    pub white_light: Option<f64>,
    /// Where that comes from.
    pub white_light_source: Option<&'static str>,
    /// By colour but the reference, what the object says of beta.
    pub beta: IndexMap<String, BetaWords>,
    /// What follows, in sentences.
    pub verdict: Vec<String>,
}

/// One light.
#[derive(Clone, Debug, Serialize)]
pub struct LightWords {
    /// By colour, the ratio of all the object's light over that of the reference colour.
    pub ratio: Vec<f64>,
    /// Mean direct light.
    pub mean_direct: f64,
    /// Mean indirect light.
    pub mean_indirect: f64,
}

/// What the object says of one colour's beta.
#[derive(Clone, Debug, Serialize)]
pub struct BetaWords {
    /// Beta in force.
    pub in_force: f64,
    /// What the object tells of it.
    pub object: Option<f64>,
    /// Its 95 % interval.
    pub interval: Option<[f64; 2]>,
    /// The beta for which s is k.
    pub agreeing: Option<f64>,
    /// The end of the colour's ratio.
    pub end: Option<EndOfRatio>,
}

impl ColoursAndShapeRecord {
    /// Of a run.
    pub fn of(set: &CaptureSet, solved: &ColoursAndShapeSolved) -> Self {
        let (report, closure) = (&solved.report, solved.report.closure.as_ref());
        let of_light = |LightReport { ratio, mean_direct, mean_indirect, .. }: &LightReport| LightWords {
            ratio: ratio.clone(),
            mean_direct: *mean_direct,
            mean_indirect: *mean_indirect,
        };
        let of_colour = |ColourClosure { beta, object, .. }: &ColourClosure| BetaWords {
            in_force: *beta,
            object: object.map(|object| object.estimate.value),
            interval: object.map(|object| [object.estimate.interval.low, object.estimate.interval.high]),
            agreeing: object.and_then(|object| object.agreeing).map(|agreeing| agreeing.value),
            end: object.map(|object| object.end),
        };
        let colours = closure.into_iter().flat_map(|closure| &closure.colours).map(of_colour);
        let findings = closure.into_iter().flat_map(|closure| &closure.findings);
        Self {
            step_px: report.step_px,
            light: set.lights.iter().map(|light| light.name.clone()).zip(report.lights.iter().map(of_light)).collect(),
            amount: report.amount,
            k: closure.and_then(|closure| closure.albedo),
            s_over_k: closure.and_then(|closure| closure.s_over_k),
            white_light: solved.white_light.as_ref().map(|white| white.value),
            white_light_source: solved.white_light.as_ref().map(|white| white.source.words()),
            beta: solved.colours.iter().skip(1).cloned().zip(colours).collect(),
            verdict: findings.map(|finding| finding.words(&solved.colours)).collect(),
        }
    }

    /// Albedo and amount in a line; `None` without a shape.
    pub fn line(&self) -> Option<String> {
        let amount = self.amount.filter(AmountReport::is_known)?;
        let range =
            format!("amount of indirect light s {:.3}, uneven by {:.0} %", amount.mean, 100.0 * amount.unevenness);
        Some(match self.k.zip(self.s_over_k) {
            Some((k, ratio)) => format!("albedo k {k:.4}; {range}; s / k {ratio:.3}"),
            None => format!("{range}; the grey ball's albedo would give the paint's to compare it with"),
        })
    }
}
