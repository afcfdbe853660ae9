//! When a photo was taken.

use std::path::Path;
use std::time::SystemTime;

use super::{TakenAt, picture_metadata};

/// When a photo was taken, and who says so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeTaken {
    /// What the camera wrote into the file.
    Camera(SystemTime),
    /// When the file was written: the camera's time, unless copying changed it.
    File(SystemTime),
}

impl TimeTaken {
    /// The time by itself.
    pub fn time(self) -> SystemTime {
        match self {
            Self::Camera(time) | Self::File(time) => time,
        }
    }
}

/// When the photo at `path` was taken, as far as the file shows it.
pub fn time_taken(path: &Path) -> Option<TimeTaken> {
    let of_camera = picture_metadata(path).ok().and_then(|metadata| metadata.taken).and_then(as_time);
    of_camera.map(TimeTaken::Camera).or_else(|| path.metadata().ok()?.modified().ok().map(TimeTaken::File))
}

/// As if the camera's clock showed universal time: times of one camera are compared with each other alone.
fn as_time(taken: TakenAt) -> Option<SystemTime> {
    let TakenAt { date: [year, month, day], time: [hour, minute, second], millisecond } = taken;
    let written = format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}.{millisecond:03}Z");
    humantime::parse_rfc3339(&written).ok()
}
