//! Errors of pictures, each with its remedy.

use std::path::PathBuf;

use firstbounce_core::image::bracket::BracketError;
use firstbounce_core::image::distortion::DistortionError;

use super::{Channel, Format};

/// Why a picture could not be read, linearised or written. Every message is one line that names the file.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// The file is missing, a folder, or the system refuses it.
    #[error("{}: cannot be read: {reason}; check the name and the permissions", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// The exposures of a bracket do not fit together.
    #[error("{}: the exposures of its shot cannot be combined: {reason}", path.display())]
    Bracket {
        /// The first file of the bracket.
        path: PathBuf,
        /// Why.
        reason: BracketError,
    },
    /// The distortion of the lens cannot be undone.
    #[error("{}: {reason}", path.display())]
    Distortion {
        /// The photo.
        path: PathBuf,
        /// Why.
        reason: DistortionError,
    },
    /// Zero bytes.
    #[error("{}: the file is empty; copy or export it again", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// The first bytes are of no format that is read.
    #[error("{}: not an image Firstbounce reads ({}): first bytes {first_bytes}; export it again", path.display(), Format::names())]
    NotAnImage {
        /// The file.
        path: PathBuf,
        /// Its first bytes in hexadecimal.
        first_bytes: String,
    },
    /// A kind of picture that is known and not read.
    #[error("{}: a {name}, which Firstbounce does not read; export it as 16-bit TIFF or PNG with linear values", path.display())]
    OtherFormat {
        /// The file.
        path: PathBuf,
        /// What it is.
        name: &'static str,
    },
    /// It begins like an image and does not go on like one.
    #[error("{}: a truncated or damaged {format} ({reason}); copy or export it again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What it begins as.
        format: Format,
        /// What the decoder said.
        reason: String,
    },
    /// A sound file of a kind that is not read.
    #[error("{}: a {format} with {what}, which Firstbounce does not read; export it as 16-bit PNG or float EXR", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// Its format.
        format: Format,
        /// What is not read.
        what: String,
    },
    /// It claims more pixels than it can hold or than fit.
    #[error("{}: claims {width} x {height} pixels in {bytes} bytes, too many to be true or to fit; export it again or cut it", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The width it claims.
        width: usize,
        /// The height it claims.
        height: usize,
        /// Its length.
        bytes: usize,
    },
    /// Values that no light has.
    #[error("{}: {count} pixels are {kind}, the first at x {x}, y {y}; export it again without them", path.display())]
    BadPixels {
        /// The file.
        path: PathBuf,
        /// "NaN", "infinite" or "negative": what the first is.
        kind: &'static str,
        /// How many values are NaN, infinite or (in a photo) negative.
        count: usize,
        /// Column of the first, 0 at the left.
        x: usize,
        /// Row of the first, 0 at the top.
        y: usize,
    },
    /// A layered EXR has no layer of the wanted name, or several where none was named.
    #[error("{}: {}; set layer in capture.toml to one of {}", path.display(), wanted.as_ref().map_or("several layers and none was chosen".into(), |name| format!("no layer \"{name}\"")), present.join(", "))]
    NoLayer {
        /// The file.
        path: PathBuf,
        /// The wanted layer.
        wanted: Option<String>,
        /// The layers that it has.
        present: Vec<String>,
    },
    /// A channel was asked for that the file lacks.
    #[error("{}: has no channel \"{wanted}\", only {}; set channel to one of these or to \"grey\"", path.display(), names(present))]
    NoChannel {
        /// The file.
        path: PathBuf,
        /// The wanted channel.
        wanted: Channel,
        /// The channels that it has.
        present: Vec<Channel>,
    },
    /// Two pictures that belong together differ in size.
    #[error("{}: {} x {} pixels, but {expected_by} has {} x {}; all pictures of a set must be of one size", path.display(), size.0, size.1, expected.0, expected.1)]
    SizeMismatch {
        /// The file.
        path: PathBuf,
        /// Its `(width, height)` in pixels.
        size: (usize, usize),
        /// What it must agree with.
        expected_by: String,
        /// The size of that.
        expected: (usize, usize),
    },
    /// An average of no files at all.
    #[error("no files to average; name at least one")]
    NoFiles,
    /// A flat field that is lit almost nowhere.
    #[error("{}: {percent:.0} % of the flat field is clipped or dark; shoot it so that most of it is well exposed", path.display())]
    UnusableFlat {
        /// The first file of the flat field.
        path: PathBuf,
        /// The share of bad pixels.
        percent: f64,
    },
    /// An option outside its range.
    #[error("{name} is {value}, expected {expected}")]
    Option {
        /// The option's name in the capture file.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        expected: &'static str,
    },
    /// Levels between which a file's encoding leaves no light.
    #[error(
        "{}: between black_level {black} and white_level {white} its encoding leaves no light that can be computed; \
         correct them under [camera], or the encoding", path.display()
    )]
    Levels {
        /// The file.
        path: PathBuf,
        /// The stored value at no light.
        black: f32,
        /// The stored value where it clips.
        white: f32,
    },
    /// Planes for one picture differ in size, or there are none.
    #[error("{what}: its channels are of different sizes, or it has none")]
    UnequalPlanes {
        /// The picture or the layer.
        what: String,
    },
    /// The file could not be written whole.
    #[error("{}: cannot be written: {reason}; check the space on the disk and the permissions", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
}

fn names(channels: &[Channel]) -> String {
    channels.iter().map(|channel| format!("\"{channel}\"")).collect::<Vec<_>>().join(", ")
}
