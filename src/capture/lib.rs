//! Files on disk, and the pipeline that turns a capture set into a mesh, stage by stage.
//!
//! The demo set, from its photos to a mesh:
//!
//! ```
//! use firstbounce_capture::export::{OutputOptions, write_solved};
//! use firstbounce_capture::pipeline::{SolveOptions, Unattended, solve};
//! use firstbounce_capture::{CaptureSet, OutputFolder};
//!
//! let set = CaptureSet::open(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/demo"))?;
//! let results = tempfile::tempdir()?;
//!
//! let solved = solve(&set, &SolveOptions::default(), &Unattended)?;
//! let output = OutputFolder::stage(results.path())?;
//! let report = write_solved(&set, &solved, output, &OutputOptions::default(), &Unattended)?;
//!
//! assert!(results.path().join("mesh.ply").is_file());
//! assert!(report.shape.is_some_and(|shape| shape.mesh.triangles > 100_000));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod atomic;
pub mod camera_file;
pub mod export;
pub mod guard;
#[doc = include_str!("FORMAT.md")]
pub mod format {}
pub mod image_file;
pub mod light_file;
pub mod mesh_file;
pub mod open;
pub mod pipeline;
pub mod report;
pub mod set;
pub mod watch_folder;

pub use atomic::{OutputFolder, WriteError};
pub use set::CaptureSet;
