//! The file formats that are read: one row for each.

use std::fmt;
use std::path::Path;

use super::head::{Head, Stated};
use super::read::{Decoded, Source};
use super::{ImageError, Metadata, exr_in, pfm, raster, raw, tiff_in};

/// The file formats that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Camera raw: NEF, CR2, CR3, ARW, RAF, DNG, ORF, RW2 and what else the feature `raw` reads.
    Raw,
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
    /// Windows bitmap, 8 bits.
    Bmp,
    /// Portable grey map, pixel map or bitmap, 1 to 16 bits.
    Pnm,
}

/// Decodes the bytes of a file, of the layer of this name where files have layers.
type ReadBytes = fn(&Source<'_>, &[u8], Option<&str>) -> Result<Decoded, ImageError>;

/// All that is asked of a format.
struct Row {
    name: &'static str,
    /// The usual one first.
    extensions: &'static [&'static str],
    /// What its files begin with.
    magic: &'static [&'static [u8]],
    /// Whether its values follow the sRGB curve unless care was taken that they do not.
    usually_srgb: bool,
    /// What the head says, before the file is read whole.
    stated: fn(&Source<'_>, Head<'_>) -> Result<Stated, ImageError>,
    read: ReadBytes,
    /// What the head says beside the size, as far as it can be read.
    metadata: fn(&Source<'_>, Head<'_>) -> Metadata,
}

impl Format {
    /// Every format.
    pub const ALL: [Self; 9] =
        [Self::Raw, Self::Png, Self::Tiff, Self::Exr, Self::Jpeg, Self::Hdr, Self::Pfm, Self::Bmp, Self::Pnm];

    fn row(self) -> Row {
        match self {
            Self::Raw => Row {
                name: "camera raw",
                extensions: &["dng", "nef", "cr2", "cr3", "arw", "raf", "orf", "rw2"],
                // The others begin as any TIFF: see `raw::is_camera_raw`.
                magic: &[
                    b"II*\0\x10\0\0\0CR",
                    b"\0\0\0\x18ftypcrx ",
                    b"FUJIFILMCCD-RAW",
                    b"IIRO",
                    b"IIRS",
                    b"MMOR",
                    b"IIU\0",
                ],
                usually_srgb: false,
                stated: |source, head| {
                    let size = raw::facts(source, &source.rest_of(head)?)?.size;
                    Ok(Stated { size, bounded: false })
                },
                read: |source, bytes, _| raw::read(source, bytes),
                metadata: |source, head| {
                    let facts = source.rest_of(head).and_then(|bytes| raw::facts(source, &bytes));
                    facts.map(|facts| facts.metadata).unwrap_or_default()
                },
            },
            Self::Png => Row {
                name: "PNG",
                extensions: &["png"],
                magic: &[b"\x89PNG\r\n\x1a\n"],
                usually_srgb: false,
                stated: |source, head| raster::stated(source, Self::Png, head),
                read: |source, bytes, _| raster::read(source, Self::Png, bytes),
                metadata: |source, head| raster::png_metadata(source, head),
            },
            Self::Tiff => Row {
                name: "TIFF",
                extensions: &["tif", "tiff"],
                magic: &[b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"],
                usually_srgb: false,
                stated: |source, head| tiff_in::stated(source, head),
                read: |source, bytes, _| tiff_in::read(source, bytes),
                metadata: |source, head| tiff_in::metadata(source, head),
            },
            Self::Exr => Row {
                name: "EXR",
                extensions: &["exr"],
                magic: &[b"\x76\x2f\x31\x01"],
                usually_srgb: false,
                stated: |source, head| exr_in::stated(source, head),
                read: exr_in::read,
                metadata: |_, _| Metadata::default(),
            },
            Self::Jpeg => Row {
                name: "JPEG",
                extensions: &["jpg", "jpeg", "jpe"],
                magic: &[b"\xff\xd8\xff"],
                usually_srgb: true,
                stated: |source, head| raster::stated(source, Self::Jpeg, head),
                read: |source, bytes, _| raster::read(source, Self::Jpeg, bytes),
                metadata: |source, head| raster::jpeg_metadata(source, head),
            },
            Self::Hdr => Row {
                name: "HDR",
                extensions: &["hdr", "pic", "rgbe"],
                magic: &[b"#?RADIANCE", b"#?RGBE"],
                usually_srgb: false,
                stated: |source, head| raster::stated(source, Self::Hdr, head),
                read: |source, bytes, _| raster::read(source, Self::Hdr, bytes),
                metadata: |_, _| Metadata::default(),
            },
            Self::Pfm => Row {
                name: "PFM",
                extensions: &["pfm"],
                magic: &[b"PF\n", b"PF\r", b"PF ", b"PF\t", b"Pf\n", b"Pf\r", b"Pf ", b"Pf\t"],
                usually_srgb: false,
                stated: |source, head| pfm::stated(source, head),
                read: |source, bytes, _| pfm::read(source, bytes),
                metadata: |_, _| Metadata::default(),
            },
            Self::Bmp => Row {
                name: "BMP",
                extensions: &["bmp", "dib"],
                magic: &[b"BM"],
                usually_srgb: false,
                stated: |source, head| raster::stated(source, Self::Bmp, head),
                read: |source, bytes, _| raster::read(source, Self::Bmp, bytes),
                metadata: |_, _| Metadata::default(),
            },
            Self::Pnm => Row {
                name: "PNM",
                extensions: &["pgm", "ppm", "pnm", "pbm", "pam"],
                magic: &[b"P1", b"P2", b"P3", b"P4", b"P5", b"P6", b"P7"],
                usually_srgb: false,
                stated: |source, head| raster::stated(source, Self::Pnm, head),
                read: |source, bytes, _| raster::read(source, Self::Pnm, bytes),
                metadata: |_, _| Metadata::default(),
            },
        }
    }

    /// The extensions of its files, the usual one first.
    pub fn extensions(self) -> &'static [&'static str] {
        self.row().extensions
    }

    /// The format of files with such a name, which their content may contradict.
    pub fn of_name(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_string_lossy().to_lowercase();
        Self::ALL.into_iter().find(|format| format.extensions().contains(&extension.as_str()))
    }

    /// The format of a file that begins with these bytes.
    pub(super) fn of_content(bytes: &[u8]) -> Option<Self> {
        Self::ALL.into_iter().find(|format| format.row().magic.iter().any(|magic| bytes.starts_with(magic)))
    }

    pub(super) fn usually_srgb(self) -> bool {
        self.row().usually_srgb
    }

    pub(super) fn stated(self, source: &Source<'_>, head: Head<'_>) -> Result<Stated, ImageError> {
        (self.row().stated)(source, head)
    }

    /// Never fails: damage shows when the pixels are read.
    pub(super) fn metadata(self, source: &Source<'_>, head: Head<'_>) -> Metadata {
        let read = source.guarded(self, || Ok((self.row().metadata)(source, head)));
        read.unwrap_or_default()
    }

    pub(super) fn read(self, source: &Source<'_>, bytes: &[u8], layer: Option<&str>) -> Result<Decoded, ImageError> {
        (self.row().read)(source, bytes, layer)
    }

    /// The names of all: "PNG, TIFF, EXR".
    pub fn names() -> String {
        Self::ALL.map(|format| format.row().name).join(", ")
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.row().name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_extension_and_a_beginning_belong_to_one_format() {
        for format in Format::ALL {
            for extension in format.extensions() {
                assert_eq!(Format::of_name(Path::new(&format!("A.{}", extension.to_uppercase()))), Some(format));
            }
            for magic in format.row().magic {
                assert_eq!(Format::of_content(magic), Some(format));
            }
        }
    }
}
