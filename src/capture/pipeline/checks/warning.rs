//! Capture warnings as data.

use std::fmt;
use std::path::Path;

use firstbounce_core::capture_checks::{LampFault, Mistake, Proof};
use firstbounce_core::trust::Level;

use super::written;
use crate::image_file::{FileFacts, ImageWarning};
use crate::pipeline::DirectionDoubt;
use crate::set::CaptureSet;

/// Something about a capture that makes normals wrong.
#[derive(Clone, Debug, PartialEq)]
pub enum CaptureWarning {
    /// One photo where there should be several.
    EqualFiles {
        /// The files, as the capture file writes them; one where several shots name the same.
        files: Vec<String>,
        /// The shots, in words.
        shots: Vec<String>,
    },
    /// Pixels pile up at a value below the white level: they are clipped, and do not count as clipped.
    ValuesEnd {
        /// The files.
        files: FilesOf,
        /// The stored value.
        value: f32,
        /// The largest share of a file's pixels that have it.
        share: f64,
        /// The white level in force, where the capture file gives one.
        white_level: Option<f64>,
    },
    /// A white level that files of this type cannot reach.
    WhiteLevelOutOfReach {
        /// The files.
        files: FilesOf,
        /// The white level of the capture file.
        white_level: f64,
        /// The largest value that the files hold.
        maximum: f32,
    },
    /// Photos that are averaged and do not show the same.
    RepeatsDiffer {
        /// The file that differs most.
        file: String,
        /// The repeats before it.
        before: Vec<String>,
        /// The difference as a share of their light, but for noise.
        change: f64,
    },
    /// Photos that lie beside those of the other lamps.
    Moved {
        /// Under which light.
        light: String,
        /// The files.
        files: FilesOf,
        /// How far, x right and y down, in pixels.
        shift_px: [f64; 2],
    },
    /// Edges of one colour that lie beside those of another.
    ColourFringe {
        /// The reference colour.
        reference: String,
        /// The other.
        colour: String,
        /// How far its edges lie beside those of the reference where that is most, x right and y down, in pixels.
        shift_px: [f64; 2],
        /// Where that is.
        at_px: [f64; 2],
        /// Whether all of the picture is shifted alike.
        is_uniform: bool,
    },
    /// Much of the object is at the white level.
    Clipped {
        /// The files, the worst first.
        files: FilesOf,
        /// The largest share of the object's pixels that are clipped in one of them.
        share: f64,
    },
    /// What files say of themselves, or show by themselves; all of one kind, and of photos of one subject.
    Files {
        /// Never empty.
        warnings: Vec<ImageWarning>,
        /// The files.
        files: FilesOf,
    },
    /// Light on the balls that does not come from the lamps.
    RoomLight {
        /// Which lights, and its share of their light on the ball.
        lights: Vec<(String, f64)>,
    },
    /// A direction of which reflections on the mirror ball, or the balls against each other, make one doubt.
    Direction {
        /// The light.
        light: String,
        /// What makes it doubtful.
        doubt: DirectionDoubt,
    },
    /// Lamps and photos that do not belong together.
    Lamps {
        /// Names of the lamps that were looked at.
        lights: Vec<String>,
        /// What is wrong, by their places there.
        fault: LampFault,
    },
    /// An object in several parts: the depth between them is not known.
    Islands {
        /// How many.
        islands: usize,
        /// The share of the pixels that lie beside the largest.
        share_beside: f64,
    },
}

/// The kind of a warning of two photos of one lamp.
pub(super) const ONE_LAMP_TWICE: &str = "one-lamp-twice";

/// Files of which one thing is said.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FilesOf {
    /// As the capture file writes them, each once; never empty.
    pub files: Vec<String>,
}

impl FilesOf {
    pub(super) fn of<'f>(set: &CaptureSet, files: impl Iterator<Item = &'f FileFacts>) -> Option<Self> {
        let mut names: Vec<String> = Vec::new();
        for file in files {
            let name = written(set, &file.path);
            if !names.contains(&name) {
                names.push(name);
            }
        }
        (!names.is_empty()).then_some(Self { files: names })
    }

    pub(super) fn of_paths<'p>(set: &CaptureSet, paths: impl Iterator<Item = &'p Path>) -> Self {
        let mut files: Vec<String> = paths.map(|path| written(set, path)).collect();
        files.dedup();
        Self { files }
    }
}

impl fmt::Display for FilesOf {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.files.as_slice() {
            [] => Ok(()),
            [only] => f.write_str(only),
            [first, more @ ..] => write!(f, "{first} and {} more", more.len()),
        }
    }
}

impl CaptureWarning {
    /// Its kind, in one word for programs.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::EqualFiles { .. } => "equal-files",
            Self::ValuesEnd { .. } => "values-end",
            Self::WhiteLevelOutOfReach { .. } => "white-level",
            Self::RepeatsDiffer { .. } => "repeats-differ",
            Self::Moved { .. } => "moved",
            Self::ColourFringe { .. } => "colour-fringe",
            Self::Clipped { .. } => "clipped",
            Self::Files { warnings, .. } => warnings.first().map_or("file", file_kind),
            Self::RoomLight { .. } => "room-light",
            Self::Direction { doubt, .. } if doubt.is_of_highlight() => "static-reflection",
            Self::Direction { .. } => "direction",
            Self::Lamps { fault: LampFault::Doubled { .. }, .. } => ONE_LAMP_TWICE,
            Self::Lamps { .. } => "lamps",
            Self::Islands { .. } => "islands",
        }
    }

    /// The files that it is about, as the capture file writes them.
    pub fn files(&self) -> Vec<String> {
        match self {
            Self::EqualFiles { files, .. } => files.clone(),
            Self::ValuesEnd { files, .. }
            | Self::WhiteLevelOutOfReach { files, .. }
            | Self::Moved { files, .. }
            | Self::Clipped { files, .. }
            | Self::Files { files, .. } => files.files.clone(),
            Self::RepeatsDiffer { file, .. } => vec![file.clone()],
            Self::ColourFringe { .. }
            | Self::RoomLight { .. }
            | Self::Direction { .. }
            | Self::Lamps { .. }
            | Self::Islands { .. } => Vec::new(),
        }
    }

    /// The lights that it is about.
    pub fn lights(&self) -> Vec<String> {
        match self {
            Self::Moved { light, .. } | Self::Direction { light, .. } => vec![light.clone()],
            Self::RoomLight { lights } => lights.iter().map(|(light, _)| light.clone()).collect(),
            Self::Lamps { lights, fault } => lamps_of(fault).into_iter().map(|l| lights[l].clone()).collect(),
            _ => Vec::new(),
        }
    }

    /// How much it spoils: roughly the degrees by which normals are off.
    pub(super) fn badness(&self) -> f64 {
        match self {
            Self::EqualFiles { .. } => 40.0,
            Self::WhiteLevelOutOfReach { .. } => 30.0,
            Self::RepeatsDiffer { change, .. } => 15.0 * change.min(2.0),
            Self::ValuesEnd { share, .. } => 200.0 * share,
            Self::Lamps { fault: LampFault::Mistaken { proof: Proof::SlopesDeg(misfit, _), .. }, .. } => 20.0 + misfit,
            Self::Lamps { .. } => 20.0,
            Self::Moved { shift_px: [x, y], .. } | Self::ColourFringe { shift_px: [x, y], .. } => 0.3 * x.hypot(*y),
            Self::Clipped { share, .. } => 20.0 * share,
            Self::Files { warnings, .. } => warnings.iter().map(file_badness).fold(0.0, f64::max),
            // A ratio that is off by a share, of which the lamps differ.
            Self::RoomLight { lights } => 60.0 * lights.iter().map(|(_, share)| *share).fold(0.0, f64::max),
            Self::Direction { doubt: DirectionDoubt::Given { angle_deg, .. }, .. } => *angle_deg,
            Self::Direction { doubt, .. } => match doubt.level() {
                Level::DoNotTrust => 30.0,
                Level::TakeCare | Level::Fine => 3.0,
            },
            Self::Islands { share_beside, .. } => *share_beside,
        }
    }
}

/// The lamps that a fault is about; none where it is about all.
fn lamps_of(fault: &LampFault) -> Vec<usize> {
    match fault {
        LampFault::Doubled { lamps, .. } => lamps.to_vec(),
        LampFault::Mistaken { like, .. } => match like.first() {
            Some(Mistake::Exchanged(a, b)) => vec![*a, *b],
            Some(Mistake::Odd(lamp)) => vec![*lamp],
            _ => Vec::new(),
        },
        LampFault::Unexplained { .. } | LampFault::NoSurface { .. } => Vec::new(),
    }
}

/// The kind of what a file says of itself, in one word for programs.
fn file_kind(warning: &ImageWarning) -> &'static str {
    match warning {
        ImageWarning::EightBit { .. } => "eight-bit",
        ImageWarning::ProbablySrgb { .. } => "probably-srgb",
        ImageWarning::WrongExtension { .. } => "wrong-extension",
        ImageWarning::BadValues { .. } => "bad-values",
        ImageWarning::MaskManyValues { .. } | ImageWarning::MaskWhole { .. } => "mask",
        ImageWarning::CurveUndone { .. } => "curve-undone",
        ImageWarning::CurveUnknown { .. } => "curve-unknown",
        ImageWarning::CurveContradicted { .. } => "curve-contradicted",
        ImageWarning::ExposureFilledIn { .. } => "exposure-filled-in",
        ImageWarning::ExposureContradicted { .. } => "exposure-contradicted",
        ImageWarning::OtherSensitivity { .. } => "other-sensitivity",
        ImageWarning::OtherAperture { .. } => "other-aperture",
    }
}

/// Roughly the degrees by which normals are off: a curve that is taken for linear bends them by eleven.
fn file_badness(warning: &ImageWarning) -> f64 {
    match warning {
        ImageWarning::ExposureContradicted { stated, measured, .. } => 30.0 * (stated / measured).ln().abs().min(1.0),
        ImageWarning::ProbablySrgb { .. }
        | ImageWarning::CurveUnknown { .. }
        | ImageWarning::CurveContradicted { .. } => 11.0,
        ImageWarning::OtherAperture { .. } => 3.0,
        ImageWarning::OtherSensitivity { .. } | ImageWarning::MaskWhole { .. } => 2.0,
        ImageWarning::EightBit { .. } | ImageWarning::BadValues { .. } | ImageWarning::MaskManyValues { .. } => 1.0,
        ImageWarning::CurveUndone { .. } | ImageWarning::ExposureFilledIn { .. } => 0.5,
        ImageWarning::WrongExtension { .. } => 0.1,
    }
}
