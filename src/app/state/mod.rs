//! The state of the window, without a widget: the open set, its document, its results, and what is kept between runs.

pub mod document;
mod file;
pub mod layout;
pub mod log;
pub mod panel;
pub mod preferences;
pub mod reference;
pub mod results;
pub mod session;
pub mod surfaces;
pub mod words;
