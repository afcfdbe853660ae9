//! Records as pages that need no other file, with pictures.

mod colours_and_shape;
mod frame;
mod nayar;
mod pictures;
mod run;

pub use frame::page;
pub use pictures::{Picture, Pictures};
pub use run::{html, overview};
