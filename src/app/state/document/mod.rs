//! The document: the set and its settings, with undo, saving and recovery.

mod disk;
mod editor;
mod opening;
mod recovery;
mod reference;
mod settings;
#[cfg(test)]
mod tests;

use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::{Method, SolveOptions};

pub use disk::{DiskWatch, SaveError, VIEW_FILE, relocated};
pub(crate) use disk::{kept_view, read_view, write_view};
pub use editor::Editor;
pub use opening::LeftOpening;
pub use recovery::{Recovered, Recovery, save_everything_now};
pub use reference::{Pose, Poses, ReferenceSettings, ReferenceSource};
pub use settings::{NayarSettings, Settings};

/// Everything that the user edits and that undo brings back. Small: photos and results are elsewhere.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Document {
    /// What capture.toml says.
    pub set: CaptureSet,
    /// How the window solves the set.
    pub settings: Settings,
}

impl Document {
    /// How direct light is told from indirect light.
    pub fn method(&self) -> Method {
        self.set.method()
    }

    /// Whether the set is also solved by this method, which is not the one in force.
    pub fn is_compared(&self, method: Method) -> bool {
        method != self.method() && self.settings.is_compared(method)
    }

    /// The methods that the set is also solved by.
    pub fn compared(&self) -> impl Iterator<Item = Method> {
        Method::ALL.into_iter().filter(|method| self.is_compared(*method))
    }

    /// As the pipeline takes it, by a method.
    pub fn options(&self, method: Method) -> SolveOptions {
        SolveOptions { method, nayar: self.settings.nayar.options(), ..SolveOptions::of(&self.set) }
    }
}
