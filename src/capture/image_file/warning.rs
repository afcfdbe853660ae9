//! Reasons to take care with a file's values, each with its remedy.

use std::fmt;
use std::path::{Path, PathBuf};

use super::{Encoding, Format};

/// A reason to take care with a file's values.
#[derive(Clone, Debug, PartialEq)]
pub enum ImageWarning {
    /// Only 256 levels.
    EightBit {
        /// The file.
        path: PathBuf,
    },
    /// The format nearly always holds sRGB.
    ProbablySrgb {
        /// The file.
        path: PathBuf,
    },
    /// The name says another format than the content; the content was believed.
    WrongExtension {
        /// The file.
        path: PathBuf,
        /// What the content is.
        format: Format,
    },
    /// Values that no light has, in a file of floats.
    BadValues {
        /// The file.
        path: PathBuf,
        /// "NaN", "infinite" or "negative": what the first is.
        kind: &'static str,
        /// How many values of all channels are NaN, infinite or negative.
        count: usize,
        /// Column of the first, 0 at the left.
        x: usize,
        /// Row of the first, 0 at the top.
        y: usize,
    },
    /// A mask with more than two values.
    MaskManyValues {
        /// The file.
        path: PathBuf,
        /// Share of its pixels that have neither the smallest value nor the largest, 0 to 1.
        between: f64,
    },
    /// A mask without an outside.
    MaskWhole {
        /// The file.
        path: PathBuf,
    },
    /// The file states a curve, which was undone.
    CurveUndone {
        /// The file.
        path: PathBuf,
        /// The curve.
        curve: Encoding,
    },
    /// The file states a curve that cannot be undone, and nothing else says how its values are stored.
    CurveUnknown {
        /// The file.
        path: PathBuf,
        /// What the file calls it.
        curve: String,
    },
    /// The file states another curve than the capture file, which is believed.
    CurveContradicted {
        /// The file.
        path: PathBuf,
        /// What the file states.
        curve: Encoding,
        /// What the capture file states.
        believed: Encoding,
    },
    /// The exposure was taken from the file.
    ExposureFilledIn {
        /// The file.
        path: PathBuf,
        /// Relative to the exposure that most photos of the set have.
        exposure: f64,
    },
    /// The exposures of a bracket and its values disagree.
    ExposureContradicted {
        /// The longer exposure's file.
        path: PathBuf,
        /// Its exposure over that of the next shorter one, as stated.
        stated: f64,
        /// The same by their values.
        measured: f64,
    },
    /// Another sensitivity than that of most photos of the same subject.
    OtherSensitivity {
        /// The file.
        path: PathBuf,
        /// Its ISO value.
        iso: f64,
        /// That of most others.
        usual_iso: f64,
    },
    /// Another aperture than that of most photos of the same subject.
    OtherAperture {
        /// The file.
        path: PathBuf,
        /// Its f-number.
        f_number: f64,
        /// That of most others.
        usual_f_number: f64,
    },
}

impl ImageWarning {
    /// The file.
    pub fn path(&self) -> &Path {
        match self {
            Self::EightBit { path }
            | Self::ProbablySrgb { path }
            | Self::WrongExtension { path, .. }
            | Self::BadValues { path, .. }
            | Self::MaskManyValues { path, .. }
            | Self::MaskWhole { path }
            | Self::CurveUndone { path, .. }
            | Self::CurveUnknown { path, .. }
            | Self::CurveContradicted { path, .. }
            | Self::ExposureFilledIn { path, .. }
            | Self::ExposureContradicted { path, .. }
            | Self::OtherSensitivity { path, .. }
            | Self::OtherAperture { path, .. } => path,
        }
    }
}

impl fmt::Display for ImageWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.path().display())?;
        match self {
            Self::EightBit { .. } => {
                write!(f, "8 bits a pixel, too coarse for dim bounces; shoot raw and export 16 bits")
            }
            Self::ProbablySrgb { .. } => {
                write!(f, "a JPEG is nearly always sRGB; set encoding = \"srgb\", or \"linear\" if you know that it is")
            }
            Self::WrongExtension { format, .. } => {
                write!(f, "the content is {format} in spite of the name; rename it to .{}", format.extensions()[0])
            }
            Self::BadValues { kind, count, x, y, .. } => write!(
                f,
                "{count} values are NaN, infinite or negative, the first ({kind}) at x {x}, y {y}; they count as dark \
                 (infinite: as clipped); export it again if they are more than noise around black"
            ),
            Self::MaskManyValues { between, .. } => write!(
                f,
                "the mask has more than two values, {:.2} % of its pixels between them; what is nearer to the largest \
                 is the object: save it as PNG without soft edges",
                100.0 * between
            ),
            Self::MaskWhole { .. } => write!(
                f,
                "the mask takes in the whole picture; paint what is not the object black, or make it transparent"
            ),
            Self::CurveUndone { curve, .. } => write!(
                f,
                "the file says that its values follow {curve}, which was undone; export linear values, or set encoding \
                 under [camera] if the file is wrong"
            ),
            Self::CurveUnknown { curve, .. } => write!(
                f,
                "the file has {curve}, which cannot be undone, and its values are taken for linear; export them linear, \
                 or set encoding under [camera]"
            ),
            Self::CurveContradicted { curve, believed, .. } => write!(
                f,
                "the file says that its values follow {curve}, but capture.toml says {believed}, which is believed; \
                 remove encoding from capture.toml if the file is right, or export it without its colour profile"
            ),
            Self::ExposureFilledIn { exposure, .. } => write!(
                f,
                "exposure {exposure:.4} of the usual one by EXIF, by which its light is divided; switch automatic \
                 exposure off, or set exposure of its [[shot]] if the file is wrong"
            ),
            Self::ExposureContradicted { stated, measured, .. } => write!(
                f,
                "stated to be exposed {stated:.3} times as long as the next shorter exposure of its bracket, but its values say \
                 {measured:.3}; correct exposures of its [[shot]], and black_level if that does not help"
            ),
            Self::OtherSensitivity { iso, usual_iso, .. } => write!(
                f,
                "taken at ISO {iso}, others at ISO {usual_iso}; noise and levels differ: take all at one sensitivity"
            ),
            Self::OtherAperture { f_number, usual_f_number, .. } => write!(
                f,
                "taken at f/{f_number}, others at f/{usual_f_number}; sharpness and vignetting differ: take all at one \
                 aperture"
            ),
        }
    }
}
