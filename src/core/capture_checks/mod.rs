//! What photos show of the way they were taken: where their values end, whether they lie over each other,
//! whether lamps and photos belong together.

mod lamps;
mod photometric;
mod shift;
mod slopes;
mod small;
mod value_end;

pub use lamps::{LampFault, LampOptions, LampPhoto, Mistake, Proof, judge_lamps};
pub use shift::{EdgeSpectrum, EdgeWindow, Moved, PairShift, ShiftOptions, find_moved, pair_shift};
pub use small::SmallPhoto;
pub use value_end::{ValueEnd, find_value_end};
