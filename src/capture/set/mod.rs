//! The capture set file `capture.toml`: what was photographed, how, and what is known of the rig.
//!
//! [`CaptureSet`] is plain data. [`CaptureSet::open`] reads it strictly: every problem names its line, its key, what
//! was found and what was expected. [`Reading`] takes what can be read and keeps the problems, for a window that shows
//! them where they are. Texts are changed in place: comments and layout survive.

mod check;
mod consistency;
mod edit;
mod fields;
mod found;
mod guess;
mod method;
mod model;
mod number;
mod problem;
mod query;
mod read;
mod rig;
mod rule;
mod subject;
mod table;
mod word;
mod write;

#[cfg(test)]
mod tests;

pub use crate::atomic::FILE_NAME;
pub use consistency::{MAX_COLOURS, MAX_LIGHTS};
pub use guess::{
    ArrivalOptions, Arrivals, Became, Doubt, Guess, GuessOptions, Pattern, PatternError, Place, Sequence, TakenFor,
    TakenOrder, add_files, assign, is_mask_name, named_subjects, order_taken, plan, propose, put, take_arrivals,
};
pub use method::Method;
pub use model::*;
pub use number::Number;
pub use number::{is_vector, vector_words};
pub use problem::{Location, Problem, SetError, TextPosition};
pub use read::Reading;
pub use rig::CarriedRig;
pub(crate) use rule::is_usable_name;
pub use table::{ShotCell, ShotRow, ShotTable};
pub use word::Word;
pub use write::{update_text, write_calibration, write_crosstalk, write_lens, write_positions};
