//! Parts of the window that know nothing of a set: fields, bars, plates, colours.

pub mod advice;
pub mod bars;
pub mod name_field;
pub mod number_field;
pub mod part;
pub mod path_field;
pub mod plate;
pub mod theme;
