//! The head of a picture: what it is and how large it says it is, before it is read whole.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use crate::open::{open_file, refusal};

use super::raw::Facts;
use super::read::{BYTE_LIMIT, Source};
use super::{Format, ImageError, Metadata, subprocess};

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
    Ok(Opened::open(path)?.stated()?.size)
}

/// What a picture says of itself beside its size: exposure, time, the curve of its values; from its head alone.
///
/// # Errors
/// Where it cannot be opened, or is no picture.
pub fn picture_metadata(path: &Path) -> Result<Metadata, ImageError> {
    Opened::open(path)?.metadata()
}

/// What the head of a picture says.
pub(super) struct Stated {
    pub size: PictureSize,
    /// Whether its decoder takes no more memory and time than the size explains, whatever the file holds.
    pub bounded: bool,
}

/// A file that begins like a picture.
pub(super) struct Opened<'a> {
    pub source: Source<'a>,
    pub format: Format,
    file: File,
}

impl<'a> Opened<'a> {
    /// Reads the first bytes and no more.
    pub fn open(path: &'a Path) -> Result<Self, ImageError> {
        let unreadable = |reason: String| ImageError::Unreadable { path: path.to_path_buf(), reason };
        let (file, length) = open_file(path, BYTE_LIMIT as u64).map_err(|error| unreadable(refusal(path, &error)))?;
        let source = Source { path, length: length as usize };
        Ok(Self { format: source.format(BufReader::new(&file))?, source, file })
    }

    /// Reads what the picture says of itself, and refuses what cannot be true.
    pub fn stated(&mut self) -> Result<Stated, ImageError> {
        let (source, format) = (self.source, self.format);
        let stated = match self.raw_facts() {
            Some(facts) => Stated { size: facts?.size, bounded: false },
            None => format.stated(&source, self.head()?)?,
        };
        source.check_size(stated.size)?;
        Ok(stated)
    }

    /// Reads what the picture says of its values and how it was taken.
    pub fn metadata(&mut self) -> Result<Metadata, ImageError> {
        let (source, format) = (self.source, self.format);
        match self.raw_facts() {
            Some(facts) => Ok(facts.map(|facts| facts.metadata).unwrap_or_default()),
            None => Ok(format.metadata(&source, self.head()?)),
        }
    }

    /// Of a camera raw file, where another process can be asked for what its decoder says.
    fn raw_facts(&mut self) -> Option<Result<Facts, ImageError>> {
        let program = subprocess::program().filter(|_| self.format == Format::Raw)?;
        Some(subprocess::facts(program, self))
    }

    /// The file from its start, which ends early.
    pub fn head(&mut self) -> Result<Head<'_>, ImageError> {
        let left = self.max_head_bytes();
        Ok(BufReader::new(Bounded { file: self.rewound()?, left }))
    }

    /// A raw file's decoder knows no head.
    fn max_head_bytes(&self) -> u64 {
        if self.format == Format::Raw { BYTE_LIMIT as u64 } else { MAX_HEAD_BYTES }
    }

    /// The file from its start.
    pub fn rewound(&mut self) -> Result<&File, ImageError> {
        self.file.rewind().map_err(|error| self.source.unreadable(error))?;
        Ok(&self.file)
    }

    /// The whole file.
    pub fn bytes(&mut self) -> Result<Vec<u8>, ImageError> {
        let source = self.source;
        let mut bytes = Vec::with_capacity(source.length);
        let file = self.rewound()?;
        file.take(source.length as u64).read_to_end(&mut bytes).map_err(|error| source.unreadable(error))?;
        Ok(bytes)
    }
}

/// The part of a file that tells what it is.
pub(super) type Head<'a> = BufReader<Bounded<'a>>;

/// A file that ends once so many bytes of it were read, wherever they lie.
pub(super) struct Bounded<'a> {
    file: &'a File,
    left: u64,
}

impl Read for Bounded<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.file.take(self.left).read(buffer)?;
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
