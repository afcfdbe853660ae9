//! What a run leaves for users and programs to read: records as JSON, and pages of them.

pub mod page;
mod record;

pub use page::{Picture, Pictures, html, overview};
pub use record::*;
