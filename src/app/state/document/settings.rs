//! The window's settings beyond capture.toml.

use std::ops::RangeInclusive;

use firstbounce_capture::CaptureSet;
use firstbounce_capture::export::OutputOptions;
use firstbounce_capture::pipeline::Method;
use firstbounce_capture::set::{Number, ShapeSettings};
use firstbounce_core::methods::by_shape::ByShapeOptions;
use serde::{Deserialize, Serialize};

use super::reference::{Poses, ReferenceSettings};

/// How the window solves a set.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// From direct light to the surface, as earlier versions kept it here; capture.toml keeps it now.
    #[serde(skip_serializing)]
    shape: Option<ShapeSettings>,
    /// The methods that the set is also solved by, for comparison: it takes seconds, or minutes.
    pub compared: Vec<Method>,
    /// For Nayar's method.
    pub nayar: NayarSettings,
    /// What to write, and by which conventions.
    pub export: OutputOptions,
    /// The scan that the surface is compared with.
    pub reference: Option<Box<ReferenceSettings>>,
}

impl Settings {
    /// The same with every number within its range: files beside a set may say anything.
    pub fn within_ranges(mut self) -> Self {
        if let Some(shape) = &mut self.shape {
            for (share, number) in
                [(&mut shape.shadow_share, Number::ShadowShare), (&mut shape.misfit_share, Number::MisfitShare)]
            {
                *share = clamped(*share, &number.range());
            }
            shape.rounds = clamped(shape.rounds, &Number::Rounds.whole_range());
            shape.indirect_window_px = clamped(shape.indirect_window_px, &Number::IndirectWindowPx.whole_range());
        }
        self.nayar.patches = clamped(self.nayar.patches, &NayarSettings::PATCHES);
        self.nayar.max_iterations = clamped(self.nayar.max_iterations, &NayarSettings::ITERATIONS);
        if let Some(reference) = &mut self.reference {
            reference.poses = reference.poses.filter(Poses::is_usable);
        }
        self
    }

    /// Whether the set is to be solved by this method too, where another one is in force.
    pub fn is_compared(&self, method: Method) -> bool {
        self.compared.contains(&method)
    }

    /// Solves the set by this method too, or no longer.
    pub fn compare(&mut self, method: Method, compare: bool) {
        self.compared.retain(|other| *other != method);
        self.compared.extend(compare.then_some(method));
    }

    /// Takes over what earlier versions kept beside the set, where the set says nothing else.
    pub(super) fn take_over(&mut self, set: &mut CaptureSet) {
        if std::mem::take(&mut self.nayar.compute) {
            self.compare(Method::Shape, true);
        }
        if let Some(mut shape) = self.shape.take().filter(|_| set.shape == ShapeSettings::default()) {
            shape.leave_out.retain(|light| set.light_index(light).is_some());
            set.shape = shape;
        }
    }
}

/// How the set is solved by Nayar's method; the numbers' defaults are those of the command line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct NayarSettings {
    /// Whether the method is compared, as earlier versions kept it here.
    #[serde(skip_serializing)]
    compute: bool,
    /// About how many patches exchange light.
    pub patches: usize,
    /// Iterations after which to stop.
    pub max_iterations: usize,
}

impl Default for NayarSettings {
    fn default() -> Self {
        let ByShapeOptions { patches, max_iterations, .. } = ByShapeOptions::default();
        Self { compute: false, patches, max_iterations }
    }
}

/// JSON has no word for what is no number, so a comparison always has an answer.
fn clamped<T: PartialOrd + Copy>(value: T, range: &RangeInclusive<T>) -> T {
    match value {
        low if low < *range.start() => *range.start(),
        high if high > *range.end() => *range.end(),
        within => within,
    }
}

impl NayarSettings {
    /// What `patches` may be.
    pub const PATCHES: RangeInclusive<usize> = 16..=20_000;
    /// What `max_iterations` may be.
    pub const ITERATIONS: RangeInclusive<usize> = 1..=100;

    /// As the pipeline takes them.
    pub fn options(&self) -> ByShapeOptions {
        ByShapeOptions { patches: self.patches, max_iterations: self.max_iterations, ..ByShapeOptions::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = include_str!("../../../capture/FORMAT.md");

    #[test]
    fn the_page_of_formats_names_every_setting_that_is_kept_and_no_other() {
        let section = PAGE.split("## firstbounce-view.json").nth(1).unwrap();
        let mut named: Vec<_> =
            section.split("`settings.").skip(1).map(|rest| rest.split('`').next().unwrap()).collect();
        named.sort_unstable();
        let kept = serde_json::to_value(Settings::default()).unwrap();
        let mut kept: Vec<_> = kept.as_object().unwrap().keys().map(String::as_str).collect();
        kept.sort_unstable();
        assert_eq!(named, kept);
    }
}
