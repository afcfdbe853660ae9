//! The verdict on colours and shape together, from the method's own numbers: no light is charged to bounces that a fit does not know,
//! and no noise is that of a difference.

use super::reason::{Found, sorted};
use super::{Level, LightTrust, Limits, NormalTrust, Reason, Trust};
use crate::interval::Estimate;
use crate::methods::colours_and_shape::{ClosureFinding, ClosureReport, ColourClosure};
use crate::separate::SeparateReport;

/// What the method reports.
#[derive(Clone, Copy, Debug)]
pub struct ColoursAndShapeLevels<'a> {
    /// By light.
    pub lights: &'a [SeparateReport],
    /// Mean predicted noise of the normals in degrees; `None` without a surface.
    pub normal_noise_deg: Option<f64>,
    /// By colour, the reference first.
    pub beta: &'a [Estimate],
    /// Amount against albedo, where a shape told it.
    pub closure: Option<&'a ClosureReport>,
}

/// Judges the direct light that colours and shape together give.
pub fn judge_colours_and_shape(levels: &ColoursAndShapeLevels, limits: &Limits) -> Trust {
    let lights: Vec<_> = levels.lights.iter().map(light_trust).collect();
    let bends = bends(levels);
    let calibration_deg = bends.iter().map(|(_, degrees)| degrees.powi(2)).sum::<f64>().sqrt();
    let normal = levels.normal_noise_deg.map(|noise| NormalTrust {
        noise_deg: noise,
        denoised_noise_deg: noise,
        calibration_deg,
    });
    let mut found = Vec::new();
    if let Some(light) = lights.iter().position(|light| light.bounces.first().is_none_or(|direct| *direct <= 0.0)) {
        found.push(limits.light_percent.judged(f64::INFINITY, Reason::Negative { light }));
    }
    if let Some(degrees) = levels.normal_noise_deg {
        found.push(limits.normal_deg.judged(degrees, Reason::NormalNoise { degrees }));
    }
    if let Some((colour, _)) = bends.iter().max_by(|a, b| a.1.total_cmp(&b.1)) {
        let reason = Reason::BetaBend { degrees: calibration_deg, colour: *colour };
        found.push(limits.normal_deg.judged(calibration_deg, reason));
    }
    let findings = levels.closure.iter().flat_map(|closure| &closure.findings);
    let of_beta = findings.filter(|finding| is_of_beta(finding));
    found.extend(of_beta.map(|finding| Found::care(Reason::Closure(*finding))));
    let reasons = sorted(found);
    let level = reasons.first().map_or(Level::Fine, |(level, _)| *level);
    Trust { bounces: 1, level, reasons, advice: Vec::new(), lights, normal }
}

/// Walls out of view cost little: the amount is fitted in windows.
fn is_of_beta(finding: &ClosureFinding) -> bool {
    matches!(finding, ClosureFinding::BetaOff { .. } | ClosureFinding::BeyondBeta { .. })
}

/// By colour, what one standard deviation of beta turns the normals by, in degrees.
fn bends(levels: &ColoursAndShapeLevels) -> Vec<(usize, f64)> {
    let colours = levels.closure.iter().flat_map(|closure| closure.colours.iter().zip(1..));
    let bend = |(colour, c): (&ColourClosure, usize)| {
        let beta = levels.beta.get(c)?;
        Some((c, colour.turn_deg_per_percent? * 100.0 * beta.sd() / beta.value))
    };
    colours.filter_map(bend).collect()
}

fn light_trust(report: &SeparateReport) -> LightTrust {
    let direct = report.mean.first().copied().unwrap_or_default();
    let noise = report.noise.first().copied().unwrap_or_default();
    let percent = if direct > 0.0 { 100.0 * noise / direct } else { f64::INFINITY };
    LightTrust {
        bounces: report.mean.clone(),
        gain: report.gain.clone(),
        condition_number: None,
        noise_percent: percent,
        denoised_noise_percent: percent,
        calibration_percent: None,
        truncation_percent: None,
        return_share: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interval::Interval;
    use crate::methods::colours_and_shape::ColourClosure;
    use crate::trust::Names;

    fn judged(normal_noise_deg: f64, half_width: f64, findings: Vec<ClosureFinding>) -> Trust {
        let colour = ColourClosure { beta: 0.5, object: None, turn_deg_per_percent: Some(0.2) };
        let closure =
            ClosureReport { paint_light: None, albedo: None, s_over_k: None, colours: vec![colour], findings };
        let beta = [Estimate::exact(1.0), Estimate { value: 0.5, interval: Interval::around(0.5, half_width) }];
        let levels = ColoursAndShapeLevels {
            lights: &[],
            normal_noise_deg: Some(normal_noise_deg),
            beta: &beta,
            closure: Some(&closure),
        };
        judge_colours_and_shape(&levels, &Limits::default())
    }

    fn said(trust: &Trust) -> String {
        let colours = ["blue", "green"].map(String::from);
        let names = Names { colours: &colours, lights: &[] };
        trust.reasons.iter().map(|(_, reason)| reason.words(&names)).collect::<Vec<_>>().join("; ")
    }

    #[test]
    fn noise_and_the_interval_of_beta_are_judged_in_degrees() {
        let quiet = judged(0.4, 0.002, Vec::new());
        assert_eq!((quiet.level, said(&quiet)), (Level::Fine, String::new()));
        let sd_percent = 100.0 * 0.002 / 1.96 / 0.5;
        assert!((quiet.normal.unwrap().calibration_deg / (0.2 * sd_percent) - 1.0).abs() < 1e-9);
        assert!(said(&judged(2.5, 0.002, Vec::new())).contains("noise turns normals by about 2.5 degrees"));
        let unsure = judged(0.4, 0.2, Vec::new());
        assert!(said(&unsure).contains("the interval of beta of green leaves normals uncertain"), "{}", said(&unsure));
    }

    /// An amount that varies is fitted in windows; a wrong beta is not made good.
    #[test]
    fn a_wrong_beta_asks_for_care_and_walls_out_of_view_do_not() {
        let cut = judged(0.4, 0.002, vec![ClosureFinding::OutOfView { unevenness: 0.2, s_over_k: None }]);
        assert_eq!(cut.level, Level::Fine);
        let wrong = judged(0.4, 0.002, vec![ClosureFinding::BeyondBeta { colour: 1, beta: 0.5, end: 0.52 }]);
        assert_eq!(wrong.level, Level::TakeCare);
        assert!(said(&wrong).contains("beta of green is too small"), "{}", said(&wrong));
    }
}
