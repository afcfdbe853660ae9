//! What the window knows, without a widget: the open set, its document, its results, and what is kept between runs.

pub mod document;
pub mod log;
pub mod preferences;
pub mod reference;
pub mod results;
pub mod session;
