//! Camera raw files: which TIFFs are such, and what is known of one before it is decoded.

use std::io::{Read, Seek};

use super::head::PictureSize;
#[cfg(not(feature = "raw"))]
use super::read::{Decoded, Source};
use super::tiff_tags::entries;
use super::{Encoding, Metadata, StatedCurve};
#[cfg(not(feature = "raw"))]
use super::{Format, ImageError};

#[cfg(feature = "raw")]
pub(super) use super::raw_in::{facts, read};

/// The tags of NewSubfileType, of further directories, and of the version of DNG.
const SUBFILE_TYPE: u64 = 254;
const SUB_DIRECTORIES: u64 = 330;
const DNG_VERSION: u64 = 50706;

/// What is known of a raw file before it is decoded.
#[derive(Clone, Debug)]
pub(super) struct Facts {
    pub size: PictureSize,
    pub metadata: Metadata,
}

impl Facts {
    /// A sensor counts light.
    pub fn of(size: PictureSize, metadata: Metadata) -> Self {
        Self { size, metadata: Metadata { curve: StatedCurve::Known(Encoding::Linear), ..metadata } }
    }
}

/// Whether a TIFF is a camera's: a DNG, or a preview with its sensor's values in a directory of their own.
pub(super) fn is_camera_raw(file: impl Read + Seek) -> bool {
    let entries = entries(file).unwrap_or_default();
    let value = |tag: u64| entries.iter().find(|entry| entry.tag == tag).map(|entry| entry.value);
    let is_preview = value(SUBFILE_TYPE).is_some_and(|kind| kind & 1 == 1);
    value(DNG_VERSION).is_some() || (is_preview && value(SUB_DIRECTORIES).is_some())
}

#[cfg(not(feature = "raw"))]
pub(super) fn facts(source: &Source, _: &[u8]) -> Result<Facts, ImageError> {
    Err(not_built_in(source))
}

#[cfg(not(feature = "raw"))]
pub(super) fn read(source: &Source, _: &[u8]) -> Result<Decoded, ImageError> {
    Err(not_built_in(source))
}

#[cfg(not(feature = "raw"))]
fn not_built_in(source: &Source) -> ImageError {
    source.unsupported(Format::Raw, "a sensor's values (this program was built without the feature raw)")
}
