//! The base of every floor: work off the UI thread, the system's file dialogs, counting.

pub mod bars;
pub mod beside;
pub mod dialogs;
pub mod drops;
pub mod jobs;
pub mod keyed;
