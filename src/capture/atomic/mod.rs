//! Files and folders that appear whole or not at all, and never outside the place that they are meant for.
//!
//! A folder that was downloaded may hold links under every name that the program writes. What the user names is written
//! where it leads ([`write_file`]); what the program keeps beside a set ([`write_kept_file`], [`write_new_file`]) and what
//! lies in a folder of results ([`OutputFolder`]) is never written, moved or deleted through a link.

mod error;
mod file;
mod journal;
mod links;
mod lock;
mod output;
mod rename;
mod staging;
#[cfg(test)]
mod tests;

pub use error::WriteError;
pub use file::{kept_file_is_there, write_file, write_kept_file, write_new_file};
pub use links::{FILE_NAME, is_plain_file, refuse_links};
pub use output::{OutputFolder, OutputRules};
