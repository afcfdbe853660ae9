//! The bounded opener: every file that is read whole is read through it.
//!
//! A folder that was downloaded may hold anything under any name: a pipe, which would wait for ever, a device or a file
//! without an end, which would fill the memory. Links to files are followed; only reading goes through here.

use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use sha2::{Digest, Sha256};
use thiserror::Error;

/// The longest text that the program keeps or is given: a capture.toml of a hundred thousand shots fits; a picture given by
/// mistake is refused before it fills the memory.
pub const MAX_TEXT_BYTES: u64 = 32 << 20;

/// Why a file is not read. The path is the caller's to name.
#[derive(Debug, Error)]
pub enum OpenError {
    /// The system refused.
    #[error("{0}")]
    System(#[from] io::Error),
    /// A folder, a pipe, a socket or a device.
    #[error("it is not a file")]
    NotAFile,
    /// More than is read of a file of its kind.
    #[error("it is longer than {} MiB", max_bytes >> 20)]
    TooLong {
        /// The most that is read.
        max_bytes: u64,
    },
    /// Bytes that are no UTF-8.
    #[error("it is not UTF-8 text")]
    NotText,
}

impl OpenError {
    /// Whether there is nothing of that name.
    pub fn is_not_found(&self) -> bool {
        matches!(self, Self::System(error) if error.kind() == io::ErrorKind::NotFound)
    }
}

/// Files of a folder are compared with one that is missing, up to this number.
const MAX_COMPARED: usize = 10_000;

/// A name may differ by so many letters from the one that was meant.
const MAX_DIFFERENT_LETTERS: usize = 2;

/// Why the file at `path` is not read, with the name of one that is there and was probably meant.
pub fn refusal(path: &Path, error: &OpenError) -> String {
    match near(path).filter(|_| error.is_not_found()) {
        Some(other) => format!("{error}; there is {other:?}"),
        None => error.to_string(),
    }
}

/// A file in the folder of `path` whose name is nearly the same: with another extension or a few other letters.
pub fn near(path: &Path) -> Option<String> {
    let wanted = path.file_name()?.to_string_lossy().to_lowercase();
    let stem = |name: &str| Path::new(name).file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let distance = |name: &String| {
        let name = name.to_lowercase();
        if stem(&name) == stem(&wanted) { 0 } else { strsim::damerau_levenshtein(&name, &wanted) }
    };
    let entries = path.parent()?.read_dir().ok()?.flatten().take(MAX_COMPARED);
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let near = names.map(|name| (distance(&name), name)).filter(|(distance, _)| *distance <= MAX_DIFFERENT_LETTERS);
    near.min().map(|(_, name)| name)
}

impl From<OpenError> for io::Error {
    fn from(error: OpenError) -> Self {
        match error {
            OpenError::System(error) => error,
            error => Self::other(error),
        }
    }
}

/// Opens the file at `path`, and tells its length; neither waits for a pipe nor takes more than `max_bytes`.
///
/// # Errors
/// [`OpenError::NotAFile`], [`OpenError::TooLong`], or what the system says.
pub fn open_file(path: &Path, max_bytes: u64) -> Result<(File, u64), OpenError> {
    // Asked before it is opened: opening a pipe waits for its writer, opening a device may do something.
    let facts = fs::metadata(path)?;
    if !facts.is_file() {
        return Err(OpenError::NotAFile);
    }
    if facts.len() > max_bytes {
        return Err(OpenError::TooLong { max_bytes });
    }
    Ok((File::open(path)?, facts.len()))
}

/// Reads the file at `path` whole, of at most `max_bytes`.
///
/// # Errors
/// As [`open_file`].
pub fn read_file(path: &Path, max_bytes: u64) -> Result<Vec<u8>, OpenError> {
    let (file, length) = open_file(path, max_bytes)?;
    let mut bytes = Vec::with_capacity(length as usize);
    // The stated length is no promise: some files of the system state none and never end.
    file.take(max_bytes + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > max_bytes { Err(OpenError::TooLong { max_bytes }) } else { Ok(bytes) }
}

/// Reads the text at `path` whole, of at most [`MAX_TEXT_BYTES`].
///
/// # Errors
/// As [`open_file`], and [`OpenError::NotText`].
pub fn read_text(path: &Path) -> Result<String, OpenError> {
    String::from_utf8(read_file(path, MAX_TEXT_BYTES)?).map_err(|_| OpenError::NotText)
}

/// SHA-256 of the content of the file at `path`, in hexadecimal digits, and its length.
///
/// # Errors
/// As [`open_file`].
pub fn hash_file(path: &Path) -> Result<(String, u64), OpenError> {
    let (mut file, _) = open_file(path, u64::MAX)?;
    let (mut hash, mut bytes) = (Sha256::new(), 0);
    let mut block = vec![0; 1 << 16];
    loop {
        let count = file.read(&mut block)?;
        if count == 0 {
            return Ok((digits(&hash.finalize()), bytes));
        }
        hash.update(&block[..count]);
        bytes += count as u64;
    }
}

/// Bytes of a sample of a file.
const SAMPLE_BYTES: u64 = 1 << 14;

/// SHA-256 of three samples of the content of the file at `path`, a quarter, half and three quarters into it, in hexadecimal digits:
/// files of one length that differ there are not equal, and need not be read whole to know it. Pictures begin alike.
///
/// # Errors
/// As [`open_file`].
pub fn hash_samples(path: &Path) -> Result<String, OpenError> {
    let (mut file, length) = open_file(path, u64::MAX)?;
    let (mut hash, mut sample) = (Sha256::new(), Vec::new());
    for quarter in 1..4 {
        file.seek(SeekFrom::Start(length / 4 * quarter))?;
        sample.clear();
        file.by_ref().take(SAMPLE_BYTES).read_to_end(&mut sample)?;
        hash.update(&sample);
    }
    Ok(digits(&hash.finalize()))
}

fn digits(hash: &[u8]) -> String {
    hash.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_of_a_file_tell_contents_apart_and_equal_ones_are_equal() {
        let folder = tempfile::tempdir().unwrap();
        let samples = |bytes: &[u8]| {
            let path = folder.path().join("file");
            fs::write(&path, bytes).unwrap();
            hash_samples(&path).unwrap()
        };
        let long = vec![7; 1 << 18];
        let mut other = long.clone();
        other[3 << 16] = 8;
        assert_eq!(samples(&long), samples(&long));
        assert_ne!(samples(&long), samples(&other));
        assert_ne!(samples(b"light"), samples(b"lighs"));
        assert_eq!(samples(b""), samples(b""));
        assert!(hash_samples(folder.path()).is_err());
    }

    #[test]
    fn a_file_is_read_up_to_its_bound_and_not_beyond() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        fs::write(&path, b"light").unwrap();
        assert_eq!(read_file(&path, 5).unwrap(), b"light");
        assert!(matches!(read_file(&path, 4), Err(OpenError::TooLong { max_bytes: 4 })));
        assert!(read_file(&folder.path().join("none"), 4).unwrap_err().is_not_found());
        assert!(matches!(read_file(folder.path(), 4), Err(OpenError::NotAFile)));
        fs::write(&path, b"\xff").unwrap();
        assert!(matches!(read_text(&path), Err(OpenError::NotText)));
    }

    #[test]
    fn a_file_that_is_missing_is_refused_with_the_one_that_is_there() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["left-blue.tif", "top-blue.png", "notes.txt"] {
            fs::write(folder.path().join(name), b"x").unwrap();
        }
        let refused = |name: &str| {
            let path = folder.path().join(name);
            refusal(&path, &read_file(&path, 4).unwrap_err())
        };
        assert!(refused("left-blue.png").ends_with("; there is \"left-blue.tif\""), "{}", refused("left-blue.png"));
        assert!(refused("tpo-blue.png").ends_with("; there is \"top-blue.png\""));
        assert!(!refused("right-green.png").contains("there is"));
    }

    /// Files that open folders, to lock them and to make renames last.
    const OTHER_OPENERS: [&str; 2] = ["capture/atomic/file.rs", "capture/atomic/lock.rs"];

    /// What opens a file without a bound.
    const UNBOUNDED: [&str; 6] =
        ["fs::read(", "fs::read_to_string(", "File::open(", "image::open(", "ImageReader::open(", ".read_file("];

    fn sources(folder: &Path, found: &mut Vec<std::path::PathBuf>) {
        for entry in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            let is_of_tests = ["tests", "benches", "testing"].iter().any(|folder| entry.ends_with(folder));
            if entry.is_dir() && !is_of_tests {
                sources(&entry, found);
            } else if entry.extension().is_some_and(|end| end == "rs") && !entry.ends_with("tests.rs") {
                found.push(entry);
            }
        }
    }

    #[test]
    fn every_file_that_is_read_is_opened_here() {
        let all = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let mut files = Vec::new();
        sources(all, &mut files);
        assert!(files.len() > 100, "{} has few sources", all.display());
        let may_open =
            |file: &Path| file.ends_with("capture/open.rs") || OTHER_OPENERS.iter().any(|other| file.ends_with(other));
        for file in files.iter().filter(|file| !may_open(file)) {
            let text = fs::read_to_string(file).unwrap();
            let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
            for call in UNBOUNDED {
                assert!(!code.contains(call), "{}: {call} goes round capture/open.rs", file.display());
            }
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_device_or_a_file_without_an_end_is_refused_at_once() {
        assert!(matches!(read_file(Path::new("/dev/zero"), 4), Err(OpenError::NotAFile)));
        let folder = tempfile::tempdir().unwrap();
        let endless = folder.path().join("sparse");
        File::create(&endless).unwrap().set_len(1 << 42).unwrap();
        assert!(matches!(read_file(&endless, 1 << 20), Err(OpenError::TooLong { .. })));
    }
}
