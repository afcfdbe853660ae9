//! Files of every kind, from outside the crate: one program, so that the decoders are linked once.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

mod codecs;
mod hostile_images;
mod image_errors;
mod image_formats;
mod kinds_of_pixels;
mod linear_light;
mod masks;
mod mesh_files;
mod mesh_variants;
mod pictures;
#[cfg(feature = "raw")]
mod raw_files;
mod rig_and_captures;
mod shared_pictures;
mod stated_by_files;
