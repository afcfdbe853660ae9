//! A folder that photos arrive in, from a tethered camera or a share.
//!
//! [`WatchFolder`] reports each picture once it rests, to who asks; [`Following`] does so from a thread of its own, over a channel.
//! What the photos show is found by [`take_arrivals`](crate::set::take_arrivals).

mod folder;
mod following;

pub use folder::{WatchFolder, WatchFolderError, WatchFolderOptions};
pub use following::{Following, WatchEvent};
