//! Records: every number of a run by the words of the capture file, for `--json` and `report.json`.

mod batch;
mod calibration;
mod captures;
mod colours_and_shape;
mod export;
mod inputs;
mod nayar;
mod options;
mod run;
mod trust;

pub use batch::{BatchRecord, RigRecord};
pub use calibration::{CalibrationRecord, CircleRecord, IntervalRecord, Row, ScaleRecord, SourceRecord};
pub use captures::CaptureWarningRecord;
pub use colours_and_shape::{BetaWords, ColoursAndShapeRecord, LightWords};
pub(crate) use export::unit_word;
pub use export::{DecimationRecord, ExportRecord, MeshFormatRecord};
pub use inputs::{InputRecord, input_records};
pub use nayar::NayarRecord;
pub use options::OptionsRecord;
pub use run::{Conventions, DepthRecord, MeshRecord, Report, SCHEMA, SetRecord, ShapeRecord, program};
pub use trust::{ReasonRecord, TrustRecord};
