//! When a photo was taken.

use std::path::Path;
use std::time::SystemTime;

/// When a photo was taken, and who says so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TakenAt {
    /// What the camera wrote into the file.
    Camera(SystemTime),
    /// When the file was written: the camera's time, unless copying changed it.
    File(SystemTime),
}

impl TakenAt {
    /// The time by itself.
    pub fn time(self) -> SystemTime {
        match self {
            Self::Camera(time) | Self::File(time) => time,
        }
    }
}

/// When the photo at `path` was taken, as far as the file shows it.
pub fn time_taken(path: &Path) -> Option<TakenAt> {
    path.metadata().ok()?.modified().ok().map(TakenAt::File)
}
