//! The planner for a rig that could be simulated.

use crate::{Plan, PlanMethod, PlanOptions, plan};
use firstbounce_core::Watch;

use super::{Exposure, LampOptions, SimulateError, SimulateOptions, prepare};

/// What to plan for, and how finely.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanGrid {
    /// The method; `None` for the one that a set with these colours would be separated by.
    pub method: Option<PlanMethod>,
    /// Numbers of frames to look at.
    pub frames: Vec<usize>,
    /// Ratios of the last albedo to the first to look at.
    pub ratios: Vec<f64>,
    /// Side of the picture that is rendered for it, at most.
    pub size_px: usize,
    /// Patches of the surface for it.
    pub patches: usize,
}

impl Default for PlanGrid {
    fn default() -> Self {
        let PlanOptions { frames, ratios, .. } = PlanOptions::default();
        Self { method: None, frames, ratios, size_px: 192, patches: 500 }
    }
}

/// Plans for the rig of `options` on pictures that are no larger than `grid` says. In smaller ones more of the pixels lie along
/// creases, where colours and shape together err more than elsewhere.
///
/// # Errors
/// As [`super::simulate`].
pub fn plan_rig(options: &SimulateOptions, grid: &PlanGrid, watch: &dyn Watch) -> Result<Plan, SimulateError> {
    let small = SimulateOptions {
        size_px: options.size_px.min(grid.size_px),
        patches: grid.patches.min(options.patches),
        ..options.clone()
    };
    small.check()?;
    let part = |from, to| firstbounce_core::Portion { watch, from, to };
    let prepared = prepare(&small, &part(0.0, 0.3))?;
    // A fixed exposure is that of one paint: another would be exposed again.
    let (brightest, white) = match options.exposure {
        Exposure::Brightest(light) => (light, None),
        Exposure::White(light) => (PlanOptions::default().brightest, Some(light)),
    };
    let plan_options = PlanOptions {
        albedos: options.albedos.clone(),
        lamps: options.lamps.iter().map(LampOptions::lamp).collect(),
        alpha: options.alpha(),
        method: grid.method.unwrap_or(PlanMethod::of_colours(options.albedos.len())),
        sensor: options.sensor,
        brightest,
        white,
        frames: grid.frames.clone(),
        ratios: grid.ratios.clone(),
        ..PlanOptions::default()
    };
    Ok(plan(&prepared.factors, &prepared.camera, &plan_options, &part(0.3, 1.0))?)
}

/// More than this much of an error is worth another rig.
const WORTH_IT: f64 = 0.9;

/// What to do about a plan's error for a photo of `frames` frames, in a sentence or two made of its numbers.
pub fn plan_advice(plan: &Plan, frames: usize) -> String {
    let Some(own) = plan.by_frames.iter().find(|point| point.frames == frames).or(plan.by_frames.last()) else {
        return String::new();
    };
    let count = |frames: usize| if frames == 1 { "1 frame".to_owned() } else { format!("{frames} frames") };
    let rig = match own.albedos.len() {
        0 | 1 => count(own.frames),
        _ => format!("{} at ratio {:.2}", count(own.frames), own.ratio),
    };
    let (error, noise, remainder, of) = (own.error_deg, own.noise_deg, own.remainder_deg, plan.method.remainder());
    let found = format!("{rig}: {error:.2} degrees; noise alone makes {noise:.2}, {of} alone {remainder:.2}.");
    if own.albedos.len() < 2 {
        return format!("{found} One colour separates nothing: a second colour does.");
    }
    let mut lines = vec![found];
    let most = plan.by_frames.iter().max_by_key(|point| point.frames).unwrap_or(own);
    let enough = plan.by_frames.iter().filter(|point| point.frames > own.frames);
    let enough = enough.min_by_key(|point| (point.noise_deg > point.remainder_deg, point.frames));
    lines.push(match enough {
        // Noise is what hurts, and there are numbers of frames that help.
        Some(more) if noise > remainder && more.error_deg < WORTH_IT * error => {
            format!("More frames help: {} give {:.2} degrees.", count(more.frames), more.error_deg)
        }
        _ if most.frames > own.frames => {
            let hardly = format!("More frames hardly help ({} give {:.2})", count(most.frames), most.error_deg);
            match plan.method {
                PlanMethod::ColoursAndShape => format!("{hardly}."),
                PlanMethod::Colours { bounces } => {
                    let colours = if bounces < own.albedos.len() { "order" } else { "one more colour, for order" };
                    format!("{hardly}; to go below the later bounces takes {colours} m = {}.", bounces + 1)
                }
            }
        }
        _ => "These are the most frames that were looked at.".into(),
    });
    if let Some(best) = plan.best_ratio().filter(|best| best.frames == own.frames && best.error_deg < WORTH_IT * error)
    {
        lines.push(format!("A paint of ratio {:.2} would give {:.2} degrees.", best.ratio, best.error_deg));
    }
    if error >= plan.raw_deg {
        lines.push(format!(
            "The photos before separation give {:.2}: separating does not pay on this rig.",
            plan.raw_deg
        ));
    }
    lines.join(" ")
}

#[cfg(test)]
mod tests {
    use crate::PlanPoint;

    use super::*;

    fn point(frames: usize, noise_deg: f64, remainder_deg: f64) -> PlanPoint {
        let error_deg = noise_deg.hypot(remainder_deg);
        PlanPoint { albedos: vec![0.8, 0.4], ratio: 0.5, frames, gain: 3.0, noise_deg, remainder_deg, error_deg }
    }

    fn plan_of(by_frames: Vec<PlanPoint>) -> Plan {
        Plan { method: PlanMethod::Colours { bounces: 2 }, raw_deg: 10.0, by_frames, by_ratio: Vec::new() }
    }

    #[test]
    fn the_advice_asks_for_what_helps() {
        let noisy = plan_of(vec![point(1, 4.0, 1.0), point(4, 2.0, 1.0), point(16, 1.0, 1.0), point(64, 0.5, 1.0)]);
        let advice = plan_advice(&noisy, 1);
        assert!(advice.contains("More frames help: 16 frames give 1.41 degrees"), "{advice}");
        let clean = plan_of(vec![point(8, 0.3, 2.4), point(64, 0.1, 2.4)]);
        let advice = plan_advice(&clean, 8);
        assert!(advice.starts_with("8 frames at ratio 0.50: 2.42 degrees"), "{advice}");
        assert!(advice.contains("hardly help (64 frames give 2.40)") && advice.contains("one more colour"), "{advice}");
        let by_shape = Plan { method: PlanMethod::ColoursAndShape, ..clean.clone() };
        let advice = plan_advice(&by_shape, 8);
        assert!(advice.contains("the method alone 2.40") && advice.ends_with("give 2.40)."), "{advice}");
        let hopeless = plan_of(vec![point(1, 30.0, 1.0)]);
        assert!(plan_advice(&hopeless, 1).contains("separating does not pay"));
        let better = Plan { by_ratio: vec![PlanPoint { ratio: 0.2, ..point(8, 0.1, 1.0) }], ..clean };
        assert!(plan_advice(&better, 8).contains("A paint of ratio 0.20 would give 1.00 degrees"));
    }
}
