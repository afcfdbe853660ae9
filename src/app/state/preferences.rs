//! The preferences: what the window remembers between runs.

use std::fs;
use std::path::{Path, PathBuf};

use directories::ProjectDirs;
use firstbounce_capture::atomic::write_file;
use firstbounce_capture::open::read_text;
use serde::{Deserialize, Serialize};

/// Sets that are offered again.
const MAX_RECENT: usize = 12;

/// Where the window keeps what belongs to no set.
#[derive(Clone, Debug)]
pub struct Folders {
    /// preferences.json
    pub preferences: PathBuf,
    /// Unsaved documents of runs that crashed.
    pub recovery: PathBuf,
    /// The demo set, to be looked at and changed.
    pub demo: PathBuf,
}

impl Folders {
    /// The system's folders for this user, or the temporary folder where it names none.
    pub fn of_system() -> Self {
        match ProjectDirs::from("", "", "firstbounce") {
            Some(dirs) => Self {
                preferences: dirs.config_dir().to_owned(),
                recovery: dirs.data_local_dir().join("recovery"),
                demo: dirs.data_local_dir().join("demo"),
            },
            None => Self::below(&std::env::temp_dir().join("firstbounce")),
        }
    }

    /// All of them below one folder.
    pub fn below(root: &Path) -> Self {
        Self { preferences: root.to_owned(), recovery: root.join("recovery"), demo: root.join("demo") }
    }
}

/// Dark, light or as the system.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Theme {
    /// As the system says.
    #[default]
    System,
    /// Dark.
    Dark,
    /// Light.
    Light,
}

/// What the window remembers between runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// Folders of sets, the last one opened first.
    pub recent: Vec<PathBuf>,
    /// The set that was open at the end of the last run.
    pub last_open: Option<PathBuf>,
    /// Colours of the window.
    pub theme: Theme,
    /// Size of everything; 1 is the system's own.
    pub ui_scale: f32,
}

impl Default for Preferences {
    fn default() -> Self {
        Self { recent: Vec::new(), last_open: None, theme: Theme::System, ui_scale: 1.0 }
    }
}

impl Preferences {
    /// Reads what was remembered; the defaults where nothing was or it cannot be read.
    pub fn read(folder: &Path) -> Self {
        let text = read_text(&file_in(folder)).unwrap_or_default();
        serde_json::from_str(&text).unwrap_or_default()
    }

    /// Remembers.
    pub fn write(&self, folder: &Path) -> anyhow::Result<()> {
        fs::create_dir_all(folder)?;
        Ok(write_file(&file_in(folder), serde_json::to_string_pretty(self)?.as_bytes())?)
    }

    /// Puts a set's folder first among the recent ones.
    pub fn opened(&mut self, folder: &Path) {
        let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
        self.recent.retain(|known| *known != folder);
        self.recent.insert(0, folder.clone());
        self.recent.truncate(MAX_RECENT);
        self.last_open = Some(folder);
    }
}

fn file_in(folder: &Path) -> PathBuf {
    folder.join("preferences.json")
}
