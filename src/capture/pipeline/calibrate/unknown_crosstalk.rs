//! What the balls show of crosstalk that is not known.

use super::warning::Warning;
use super::{Calibrated, MAX_HALF_WIDTHS, RatioEvidence};
use crate::set::{CaptureSet, SphereKind};

/// beta of one paint differs from light to light by less, as a share: balls are not perfect.
const MAX_BETA_SPREAD: f64 = 0.01;

/// Colours that are channels of one photo and have another beta under each light: a channel sees more than its lamp. Room light
/// does that too, and is told by itself. `of_paint` are the ratios on the ball of the paint; those on the grey ball are in
/// `calibrated`.
pub(super) fn unknown_crosstalk<'a>(
    set: &'a CaptureSet,
    calibrated: &Calibrated,
    of_paint: &[RatioEvidence],
) -> Vec<Warning<'a>> {
    if set.camera.crosstalk.is_some() || !set.has_rgb_photos() {
        return Vec::new();
    }
    let warning = |(c, colour): (usize, &'a crate::set::Colour)| {
        let of_lights = of_paint.iter().filter(|evidence| evidence.colour == c).filter_map(|evidence| {
            let grey = calibrated.evidence(SphereKind::Grey, evidence.light, c)?;
            let is_offset = evidence.report.offset || grey.report.offset;
            let (paint, alpha) = (evidence.report.ratio, grey.report.ratio);
            let value = paint.value / alpha.value;
            (!is_offset).then(|| (value, value * paint.relative_half_width().hypot(alpha.relative_half_width())))
        });
        let mut of_lights: Vec<(f64, f64)> = of_lights.collect();
        of_lights.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let (low, high) = (*of_lights.first()?, *of_lights.last()?);
        let (difference, half_width) = (high.0 - low.0, low.1.hypot(high.1));
        let is_real = difference > MAX_HALF_WIDTHS * half_width && difference > MAX_BETA_SPREAD * low.0;
        is_real.then_some(Warning::UnknownCrosstalk { colour: &colour.name, beta: [low.0, high.0] })
    };
    set.colours.iter().enumerate().filter_map(warning).collect()
}
