//! Photos in linear light: a store that decodes each file once, and what the pipeline takes of it.

mod bracket;
mod exposure;
mod key;
mod object;
mod store;
mod subject;
#[cfg(test)]
mod tests;
mod undistort;
mod unmix;

pub use exposure::Exposures;
pub use object::{ObjectPhotos, load_object};
pub use store::{PhotoStore, ShotLight};
pub use subject::{ShotNotes, SubjectPhotos, load_subject};
pub(super) use subject::{by_kind, image_warnings};
