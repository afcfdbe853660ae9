//! The window's settings beyond capture.toml.

use firstbounce_capture::CaptureSet;
use firstbounce_capture::export::OutputOptions;
use firstbounce_capture::pipeline::Method;
use firstbounce_capture::set::ShapeSettings;
use firstbounce_core::methods::by_shape::ByShapeOptions;
use serde::{Deserialize, Serialize};

use super::reference::ReferenceSettings;

/// How the window solves a set.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// From bounce 1 to the surface, as earlier versions kept it here; capture.toml keeps it now.
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
    /// Whether the set is also solved by this method.
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

impl NayarSettings {
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
