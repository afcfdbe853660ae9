//! From a capture set to a mesh, stage by stage; the command line and the window run the same stages.

mod calibrate;
mod compare;
mod cost;
mod error;
mod evaluate;
mod file_names;
mod load;
mod memory;
mod nayar;
mod output;
pub mod simulate;
mod solve;
mod survey;
mod trust;
mod truth;
mod watch;

pub use calibrate::{
    BallCircle, BallPhotos, Calibrated, Known, Preference, RatioEvidence, Source, Verdict, calibrate, calibrate_for,
    calibrate_on,
};
pub use compare::{Compared, Laying, ReferenceError, alignment_warnings, compare_meshes, read_comparable};
pub use cost::{StageCost, peak_rss_bytes};
pub use error::PipelineError;
pub use evaluate::{Angles, Evaluation, NayarErrors, NayarIteration, NormalErrors, evaluate};
pub use load::{ObjectPhotos, SubjectPhotos, load_object, load_subject};
pub use memory::{
    MemoryEstimate, MemoryOptions, MemoryShortage, Work, check_memory, estimate_memory, free_memory_bytes,
};
pub use nayar::{AlbedoScale, Beginning, Method, NayarSolved, in_one_colour, simulate_away, white_light};
pub use output::{OutputOptions, is_result_name, stage_results, write_solved};
pub use solve::{
    Direct, Separated, SolveOptions, Solved, Surfaced, camera_of, lamps, quiet_lights, raw_lights, recover,
    separate_lights, solve, triangulate,
};
pub use survey::{Exposed, region_of, survey, thumbnail};
pub use trust::{ObjectLevels, judge, rig_of};
pub use truth::truth_mesh;
pub use watch::{PipelineWatch, Stage, Unattended};
