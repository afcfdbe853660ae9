//! The head of a picture: what it is and how large it says it is, before it is read whole.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use crate::open::open_file;

use super::read::{BYTE_LIMIT, Source};
use super::{Format, ImageError, exr_in, pfm, raster, tiff_in};

/// The most that is read of a file to learn its size; colour profiles and previews may stand before it.
const MAX_HEAD_BYTES: u64 = 16 << 20;

/// What a picture says of itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureSize {
    /// Columns of pixels.
    pub width: usize,
    /// Rows of pixels.
    pub height: usize,
    /// Samples of a pixel that its decoder makes, alpha and all layers of an EXR included.
    pub channels: usize,
}

/// The size that a picture states, from its head alone: nothing is decoded.
///
/// # Errors
/// As [`read_image`](super::read_image), but for what only its pixels show.
pub fn picture_size(path: &Path) -> Result<PictureSize, ImageError> {
    Ok(Head::open(path)?.size)
}

/// An open picture whose stated size may be allocated.
pub(super) struct Head<'a> {
    pub source: Source<'a>,
    pub format: Format,
    pub size: PictureSize,
    file: File,
}

impl<'a> Head<'a> {
    /// Reads the format and the size, and refuses what cannot be a picture.
    pub fn open(path: &'a Path) -> Result<Self, ImageError> {
        let unreadable = |reason: String| ImageError::Unreadable { path: path.to_path_buf(), reason };
        let (mut file, length) = open_file(path, BYTE_LIMIT as u64).map_err(|error| unreadable(error.to_string()))?;
        let source = Source { path, length: length as usize };
        let mut first = Vec::new();
        (&file).take(16).read_to_end(&mut first).map_err(|error| unreadable(error.to_string()))?;
        let format = source.format(&first)?;
        file.rewind().map_err(|error| unreadable(error.to_string()))?;
        let reader = BufReader::new(Bounded { file: &mut file, left: MAX_HEAD_BYTES });
        let size = source.guarded(format, || match format {
            Format::Png | Format::Jpeg | Format::Hdr => raster::size(&source, format, reader),
            Format::Tiff => tiff_in::size(&source, reader),
            Format::Exr => exr_in::size(&source, reader),
            Format::Pfm => pfm::size(&source, reader),
        })?;
        source.check_size(size)?;
        Ok(Self { source, format, size, file })
    }

    /// The whole file.
    pub fn bytes(&mut self) -> Result<Vec<u8>, ImageError> {
        let unreadable = |error: io::Error| ImageError::Unreadable {
            path: self.source.path.to_path_buf(),
            reason: error.to_string(),
        };
        self.file.rewind().map_err(unreadable)?;
        let mut bytes = Vec::with_capacity(self.source.length);
        (&self.file).take(self.source.length as u64).read_to_end(&mut bytes).map_err(unreadable)?;
        Ok(bytes)
    }
}

/// A file that ends once so many bytes of it were read, wherever they lie.
struct Bounded<'a> {
    file: &'a mut File,
    left: u64,
}

impl Read for Bounded<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.file.by_ref().take(self.left).read(buffer)?;
        self.left -= count as u64;
        Ok(count)
    }
}

impl Seek for Bounded<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vast_file_without_a_picture_is_refused_by_its_first_bytes() {
        let folder = tempfile::tempdir().unwrap();
        for magic in [
            b"".as_slice(),
            b"\x89PNG\r\n\x1a\n",
            b"II*\0",
            b"II+\0",
            b"\x76\x2f\x31\x01",
            b"\xff\xd8\xff",
            b"#?RADIANCE",
        ] {
            let path = folder.path().join("vast");
            std::fs::write(&path, magic).unwrap();
            File::options().write(true).open(&path).unwrap().set_len(4 << 30).unwrap();
            let begun = std::time::Instant::now();
            assert!(picture_size(&path).is_err() && super::super::read_image(&path).is_err());
            assert!(begun.elapsed().as_secs() < 2, "{magic:?}");
        }
    }
}
