//! Pictures in and out: what a camera or a renderer wrote becomes planes of f32, planes become files that others read.
//!
//! Reading keeps the values as they are stored ([`read_image`]); [`linearise()`] turns them into linear light and marks
//! the pixels that must not be used. What a file is, its first bytes decide, never its name.
//!
//! A picture may come from anywhere, so it must not be able to end the program, or to take more memory and time than
//! its size explains. Every size that it states is checked before room is made for it, and its decoder is guarded
//! ([`guard`](crate::guard)). Decoders that state sizes of their own deep in the pixels (EXR with PIZ or DWA, TIFF with
//! JPEG or fax) run in a process of their own with a limit of memory and time, see [`decode_in`]; all others (PNG, JPEG,
//! HDR, PFM, TIFF without compression or with LZW, deflate or PackBits, EXR with anything else) are bounded by what was
//! checked, and stay in this one.

mod correction;
mod depth_png;
mod error;
mod exr_blocks;
mod exr_in;
mod exr_out;
mod find;
mod head;
mod linearise;
mod pfm;
mod png_out;
mod raster;
mod read;
mod repeats;
mod samples;
mod subprocess;
mod texture;
mod tiff_in;
mod tiff_tags;

use std::fmt;
use std::path::PathBuf;

use firstbounce_core::Plane;

use crate::set::{Channel, Encoding};

pub use correction::{Corrections, DarkFrame, FlatField, dark_frame, flat_field};
pub use depth_png::{DepthScale, depth_png};
pub use error::ImageError;
pub use exr_in::layer_names;
pub use exr_out::{ExrLayer, write_exr};
pub use find::{MAX_LOOKED_AT, MAX_PICTURES, PicturesFound, pictures_in};
pub use head::{PictureSize, picture_size};
pub use linearise::{LinearLight, LinearOptions, linearise, linearise_files};
pub use png_out::{GreenAxis, GreyBits, grey8_png, grey16_png, mask_png, normals_png, preview_png};
pub use read::{Content, ReadOptions, read_image, read_image_as, read_mask};
pub use repeats::{NoiseBin, RepeatNoise};
pub use subprocess::{DECODE_COMMAND, DecodeLimits, decode_for_parent, decode_in};
pub use texture::texture_png;

/// The file formats that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Portable Network Graphics, 1 to 16 bits.
    Png,
    /// Tagged Image File Format: 1 to 32 bit integers, 16 to 64 bit floats.
    Tiff,
    /// OpenEXR, flat scan lines or tiles.
    Exr,
    /// JPEG, 8 bits.
    Jpeg,
    /// Radiance RGBE.
    Hdr,
    /// Portable float map.
    Pfm,
}

impl Format {
    /// Every format.
    pub const ALL: [Self; 6] = [Self::Png, Self::Tiff, Self::Exr, Self::Jpeg, Self::Hdr, Self::Pfm];

    /// The names that files of this format end in, the usual one first.
    pub fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Png => &["png"],
            Self::Tiff => &["tif", "tiff"],
            Self::Exr => &["exr"],
            Self::Jpeg => &["jpg", "jpeg", "jpe"],
            Self::Hdr => &["hdr", "pic", "rgbe"],
            Self::Pfm => &["pfm"],
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Png => "PNG",
            Self::Tiff => "TIFF",
            Self::Exr => "EXR",
            Self::Jpeg => "JPEG",
            Self::Hdr => "HDR",
            Self::Pfm => "PFM",
        })
    }
}

/// What values a file can hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StoredRange {
    /// The largest value that the file's integers hold (255, 65535, 4294967295); `None` for floats, which have no end.
    pub maximum: Option<f32>,
}

/// A picture as it is stored: the values are neither decoded nor scaled, alpha is dropped.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageFile {
    /// Where it was read.
    pub path: PathBuf,
    /// What it is.
    pub format: Format,
    /// Either grey alone, or red, green, blue; all of one size, none of it zero.
    pub channels: Vec<(Channel, Plane)>,
    /// The range of the stored values.
    pub stored: StoredRange,
    /// What a person should know before trusting the values.
    pub warnings: Vec<ImageWarning>,
}

impl ImageFile {
    /// `(width, height)` in pixels.
    pub fn size(&self) -> (usize, usize) {
        self.channels.first().map_or((0, 0), |(_, plane)| plane.size())
    }

    /// The planes that make up `wanted`: one of them, or all for grey, whose mean is meant.
    ///
    /// # Errors
    /// [`ImageError::NoChannel`] if the file has no such channel.
    pub fn pick(&self, wanted: Channel) -> Result<Vec<&Plane>, ImageError> {
        let planes: Vec<&Plane> = self
            .channels
            .iter()
            .filter(|(name, _)| wanted == Channel::Grey || *name == wanted)
            .map(|(_, plane)| plane)
            .collect();
        if planes.is_empty() {
            let present = self.channels.iter().map(|(name, _)| *name).collect();
            return Err(ImageError::NoChannel { path: self.path.clone(), wanted, present });
        }
        Ok(planes)
    }
}

/// What a person should know before trusting a file's values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ImageWarning {
    /// Only 256 levels.
    EightBit {
        /// The file.
        path: PathBuf,
    },
    /// The format holds sRGB unless somebody took care that it does not.
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
}

impl fmt::Display for ImageWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::EightBit { path } => {
                write!(
                    f,
                    "{}: 8 bits a pixel, too coarse for dim bounces; shoot raw and export 16 bits",
                    path.display()
                )
            }
            Self::ProbablySrgb { path } => write!(
                f,
                "{}: a JPEG is nearly always sRGB; set encoding = \"srgb\", or \"linear\" if you know that it is",
                path.display()
            ),
            Self::WrongExtension { path, format } => write!(
                f,
                "{}: the content is {format} in spite of the name; rename it to .{}",
                path.display(),
                format.extensions()[0]
            ),
        }
    }
}
