//! Errors of light files.

use std::path::PathBuf;

/// A light file that cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}{}: {problem}", path.display(), line.map_or(String::new(), |line| format!(":{line}")))]
pub struct LightFileError {
    /// The file.
    pub path: PathBuf,
    /// The line, counted from 1, where one is to blame.
    pub line: Option<usize>,
    /// Why.
    pub problem: LightFileProblem,
}

/// Why a light file cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LightFileProblem {
    /// The system does not hand it out.
    #[error("cannot be read: {reason}")]
    Unreadable {
        /// What the system says.
        reason: String,
    },
    /// Not text.
    #[error("is no text file; a light file has a line with the count, then lines 'file x y z'")]
    NotText,
    /// No line.
    #[error("holds no light; it should begin with their count, then have a line 'file x y z' for each")]
    Empty,
    /// The first line is no count.
    #[error("expected the count of lights alone on this line, found '{found}'")]
    NoCount {
        /// What is there.
        found: String,
    },
    /// Fewer or more lines than the count says.
    #[error("the count says {promised}, and {found} lights follow: correct it, or the file is cut off")]
    WrongCount {
        /// What the count says.
        promised: usize,
        /// How many follow.
        found: usize,
    },
    /// A line of another form.
    #[error("expected 'file x y z', found '{found}'")]
    NotALight {
        /// What is there.
        found: String,
    },
    /// Three numbers without a file.
    #[error("the file name is missing before '{found}'")]
    NoFile {
        /// What is there.
        found: String,
    },
    /// Four numbers at the end of a line.
    #[error(
        "four numbers in '{found}': which three are the direction? leave the other out, or put the file name in quotes"
    )]
    FourNumbers {
        /// What is there.
        found: String,
    },
    /// A JSON file that is no dome.
    #[error("is no dome: {reason}")]
    NotADome {
        /// Why not.
        reason: String,
    },
    /// Every direction has a negative z.
    #[error(
        "all its directions point away from the camera (z < 0); z points toward the camera and a direction from the object \
         to the light: turn them by changing the sign of z, or of x, y and z where they point from the light to the object"
    )]
    PointAway,
    /// No direction.
    #[error("the direction of {file} is {found}, which points nowhere: three finite numbers, not all zero, are needed")]
    NoDirection {
        /// The photo.
        file: String,
        /// What is there.
        found: String,
    },
    /// Neither names nor the count fit the set.
    #[error(
        "none of its file names is a photo of the set (the first is {first}), and its {found} lights are not the set's \
         {lights}: use the names of the set's photos, or one line for each light in the set's order"
    )]
    Strange {
        /// The first name.
        first: String,
        /// How many lights the file has.
        found: usize,
        /// How many lights the set has.
        lights: usize,
    },
}
