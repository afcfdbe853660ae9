//! What every floor stands on: work off the UI thread, and the system's file dialogs.

pub mod dialogs;
pub mod jobs;
