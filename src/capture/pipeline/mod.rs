//! From a capture set to a mesh, stage by stage; the command line and the window run the same stages.

mod calibrate;
mod checks;
mod compare;
mod cost;
mod crosstalk;
mod error;
mod evaluate;
mod memory;
mod methods;
mod photos;
mod reconstruct;
mod scene;
mod surfaces;
mod survey;
mod trust;
mod truth;
mod watch;

pub use crate::set::Method;
pub use calibrate::{
    BallCircle, BallNotFound, Calibrated, CircleDoubt, DirectionDoubt, Evidence, Known, Measured, Preference,
    RatioEvidence, ScaleSource, Source, Verdict, calibrate, calibrate_also_on_object, calibrate_for, calibrate_with,
    circle_of,
};
pub use checks::{
    CaptureCheck, CaptureReport, CaptureWarning, CheckOptions, CheckedPhotos, FilesOf, check_captures, check_surface,
};
pub use compare::{
    Comparable, Compared, Frame, ReferenceError, Registration, alignment_warnings, compare_meshes, read_comparable,
};
pub use cost::{StageCost, peak_rss_bytes};
pub use crosstalk::{KnownCrosstalk, with_crosstalk};
pub use error::PipelineError;
pub use evaluate::{Angles, Evaluation, MethodErrors, NayarErrors, NayarIteration, NormalErrors, evaluate};
pub use memory::{
    MemoryEstimate, MemoryOptions, MemoryShortage, Work, check_memory, estimate_memory, free_memory_bytes,
};
pub use methods::{
    AlbedoScale, ColoursAndShapeSolved, Found, Input, MethodReport, NayarSolved, Needs, OnShape, add_beta_of_object,
    denoise_lights, separate_lights,
};
pub use photos::{Exposures, ObjectPhotos, PhotoStore, ShotLight, ShotNotes, SubjectPhotos, load_object, load_subject};
pub(crate) use reconstruct::relative_albedo;
pub use reconstruct::{
    Direct, Lit, Separated, SolveOptions, Solved, find_light, raw_lights, reconstruct, recover, solve, triangulate,
};
pub use scene::{Scene, camera_of};
pub use surfaces::{Surface, SurfaceName};
pub use survey::{Exposed, Surveyed, region_of, survey, thumbnail};
pub use trust::{ObjectLevels, judge, judge_method, rig_of};
pub use truth::truth_mesh;
pub(crate) use watch::Part;
pub use watch::{PipelineWatch, Stage, Unattended};
