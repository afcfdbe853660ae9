//! Helpers that the tests of several crates share. No crate of the program depends on it.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

#[cfg(feature = "simulated")]
mod simulated;
mod there;

use std::fs;
use std::path::{Path, PathBuf};

#[cfg(feature = "simulated")]
pub use simulated::write_tiny_set;
pub use there::{There, everything_in};

/// The folder of a capture set beside the project, or of all for ""; says that the test skips where it is not there.
pub fn shared_set(name: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").join(name);
    let found = folder.is_dir();
    if !found {
        println!("skipped: no {}", folder.display());
    }
    found.then_some(folder)
}

/// A folder that goes away with the test.
pub struct Folder(tempfile::TempDir);

impl Folder {
    /// An empty one.
    #[allow(clippy::new_without_default, reason = "it makes a folder on the disk")]
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// Where it lies.
    pub fn root(&self) -> &Path {
        self.0.path()
    }

    /// Where a file of this name lies or would lie.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// A file with this content.
    pub fn file(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        fs::write(self.path(name), bytes).unwrap();
        self.path(name)
    }
}

/// Positions and triangles of a height field of `cells` x `cells` squares, centred on the z axis and facing +z; its vertices
/// are shifted by `phase` of a square.
pub fn relief(
    cells: u32,
    pitch_mm: f64,
    phase: f64,
    height_mm: impl Fn(f64, f64) -> f64,
) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let side = cells + 1;
    let position = |index: u32| {
        let [x, y] = [index % side, index / side].map(|k| (f64::from(k) + phase - f64::from(cells) / 2.0) * pitch_mm);
        [x, y, height_mm(x, y)].map(|length| length as f32)
    };
    let triangles = (0..cells * cells).flat_map(|cell| {
        let corner = cell / cells * side + cell % cells;
        [[corner, corner + 1, corner + side + 1], [corner, corner + side + 1, corner + side]]
    });
    ((0..side * side).map(position).collect(), triangles.collect())
}

/// Heights in mm: bumps of several widths that do not repeat within 70 mm.
pub fn bumps(x: f64, y: f64) -> f64 {
    4.0 * (x / 9.0 + 0.3).sin() * (y / 11.0).cos() + 2.0 * (x / 4.1 - y / 5.3).sin() + 0.002 * x * (x + y)
}
