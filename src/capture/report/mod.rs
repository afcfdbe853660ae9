//! What a run leaves for people and programs to read: `report.json` and `report.html`.

mod calibration;
mod export;
mod html;
mod nayar;
pub mod page;
mod pictures;
mod trust;
mod words;

pub use calibration::{CalibrationWords, Row};
pub(crate) use export::unit_word;
pub use export::{DecimationWords, ExportWords, MeshFormatWords};
pub use html::{html, overview};
pub use nayar::NayarWords;
pub use pictures::{Picture, Pictures};
pub use trust::{ReasonWords, TrustWords};
pub use words::{Conventions, DepthWords, MeshWords, Report, SetWords, ShapeWords};
