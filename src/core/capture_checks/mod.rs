//! What photos show of the way they were taken: where their values end, whether they lie over each other
//! in all colours, whether lamps and photos belong together.

mod fringe;
mod lamps;
#[cfg(test)]
mod lamps_tests;
mod photometric;
mod shift;
#[cfg(test)]
mod shift_tests;
mod slopes;
mod small;
mod value_end;

pub use fringe::{Fringe, FringeOptions, FringeSpectrum, FringeWindow, find_fringe};
pub use lamps::{LampFault, LampOptions, LampPhoto, Mistake, Proof, judge_lamps};
pub use shift::{EdgeSpectrum, EdgeWindow, Moved, PairShift, ShiftOptions, find_moved, pair_shift};
pub use small::SmallPhoto;
pub use value_end::{ValueEnd, find_value_end};
