//! The document: what a person edits, with undo, and everything that keeps it safe.

mod disk;
mod editor;
mod opening;
mod recovery;
mod reference;
mod settings;
#[cfg(test)]
mod tests;

use firstbounce_capture::CaptureSet;

pub use disk::{DiskWatch, SaveError, VIEW_FILE, relocated};
pub(crate) use disk::{kept_view, read_view, write_view};
pub use editor::Editor;
pub use opening::LeftOpening;
pub use recovery::{Recovered, Recovery, save_everything_now};
pub use reference::{Pose, Poses, ReferenceSettings, ReferenceSource};
pub use settings::{NayarSettings, Settings, ShapeSettings};

/// Everything that a person edits and that undo brings back. Small: photos and results are elsewhere.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Document {
    /// What capture.toml says.
    pub set: CaptureSet,
    /// How the window solves the set.
    pub settings: Settings,
}

impl Document {
    /// The set without the lights that the shape is recovered without.
    pub fn used_set(&self) -> CaptureSet {
        let used = |light: &String| !self.settings.shape.left_out.contains(light);
        let mut set = self.set.clone();
        set.lights.retain(|light| used(&light.name));
        set.shots.retain(|shot| shot.light.as_ref().is_none_or(used));
        set.calibration.alpha.retain(|light, _| used(light));
        set.calibration.direction.retain(|light, _| used(light));
        set.calibration.intensity.retain(|light, _| used(light));
        set
    }
}
