//! From a capture set to a mesh, stage by stage; the command line and the window run the same stages.

mod cost;
mod error;
mod load;
mod watch;

pub use cost::{StageCost, peak_rss_bytes};
pub use error::PipelineError;
pub use load::{ObjectPhotos, SubjectPhotos, load_object, load_subject};
pub use watch::{PipelineWatch, Stage, Unattended};
