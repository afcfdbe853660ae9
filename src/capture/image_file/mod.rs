//! Pictures in and out: what a camera or a renderer wrote becomes planes of f32, planes become files that others read.
//!
//! Reading keeps the values as they are stored ([`read_image`]); [`linearise()`] turns them into linear light and marks
//! the pixels that must not be used. What a file is, its first bytes decide, never its name.
//!
//! A picture may come from anywhere, so it must not be able to end the program, or to take more memory and time than
//! its size explains. Every size that it states is checked before room is made for it, and its decoder is guarded
//! ([`guard`](crate::guard)). Decoders that state sizes of their own deep in the pixels (EXR with PIZ or DWA, TIFF with
//! JPEG or fax, camera raw files) run in a process of their own with a limit of memory and time, see [`decode_in`]; all others (PNG, JPEG,
//! HDR, PFM, BMP, PNM, TIFF without compression or with LZW, deflate or PackBits, EXR with anything else) are bounded by what was
//! checked, and stay in this one.

mod correction;
mod curve;
mod depth_png;
mod encoding;
mod error;
mod exr_blocks;
mod exr_in;
mod exr_out;
mod find;
mod format;
mod head;
mod linearise;
mod mask;
mod metadata;
mod pfm;
mod png_out;
mod raster;
mod raw;
#[cfg(feature = "raw")]
mod raw_in;
mod read;
mod repeats;
mod samples;
mod subprocess;
mod taken;
mod texture;
mod tiff_in;
mod tiff_page;
mod tiff_tags;
mod warning;

use std::path::PathBuf;

use firstbounce_core::Plane;

pub use correction::{Corrections, DarkFrame, FlatField, dark_frame, flat_field};
pub use depth_png::{DepthScale, depth_png};
pub use encoding::{Channel, Encoding};
pub use error::ImageError;
pub use exr_in::layer_names;
pub use exr_out::{ExrLayer, write_exr};
pub(crate) use find::natural_key;
pub use find::{MAX_LOOKED_AT, MAX_PICTURES, PicturesFound, pictures_in};
pub use format::Format;
pub use head::{PictureSize, picture_metadata, picture_size};
pub use linearise::{FileFacts, LinearLight, LinearOptions, linearise, linearise_files};
pub use mask::{MaskFile, read_mask};
pub use metadata::{Metadata, StatedCurve, TakenAt};
pub use png_out::{
    GreenAxis, GreyBits, grey8_png, grey16_png, mask_png, normals_png, preview_png, rgb8_png, rgb16_png,
};
pub use read::{Content, ReadOptions, read_image, read_image_as};
pub use repeats::{NoiseBin, RepeatNoise};
pub use subprocess::{DECODE_COMMAND, DecodeLimits, decode_for_parent, decode_in};
pub use taken::{TimeTaken, time_taken};
pub use texture::texture_png;
pub use warning::ImageWarning;

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
    /// What it says of itself.
    pub metadata: Metadata,
    /// Reasons to take care with the values.
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
