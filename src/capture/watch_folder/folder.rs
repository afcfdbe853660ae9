//! Pictures that rest in a watched folder.
//!
//! The system's events (crate notify) wake it at once. Shares often send none, so the folder is also looked through now and then.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant, SystemTime};

use firstbounce_core::Unwatched;
use firstbounce_core::options::{OptionError, check_range};
use notify::event::{AccessKind, AccessMode};
use notify::{Event, EventKind, RecommendedWatcher, RecursiveMode, Watcher};
use thiserror::Error;

use crate::image_file::{Format, pictures_in};

/// How a folder is watched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WatchFolderOptions {
    /// A file that does not change for so long is complete; one whose writer has closed it is at once.
    pub rest: Duration,
    /// Where the system sends no events the folder is looked through as often.
    pub poll: Duration,
}

impl Default for WatchFolderOptions {
    fn default() -> Self {
        Self { rest: Duration::from_millis(300), poll: Duration::from_secs(2) }
    }
}

impl WatchFolderOptions {
    /// Whether every option is in its range.
    pub fn check(&self) -> Result<(), OptionError> {
        let seconds = self.rest.as_secs_f64();
        check_range("rest", seconds, (0.01..=60.0).contains(&seconds), "from 0.01 to 60 seconds")?;
        let seconds = self.poll.as_secs_f64();
        check_range("poll", seconds, (0.05..=3600.0).contains(&seconds), "from 0.05 to 3600 seconds")
    }
}

/// Why a folder is watched no longer.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum WatchFolderError {
    /// It is not there, or a file.
    #[error("{}: not a folder; name one that is there, and watch it again when it is back", folder.display())]
    NoFolder {
        /// The folder.
        folder: PathBuf,
    },
    /// An option out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
}

/// When a file was written last, and how long it is.
type Stamp = (SystemTime, u64);

/// A folder that is being watched, with the folders in it.
pub struct WatchFolder {
    folder: PathBuf,
    options: WatchFolderOptions,
    /// Kept, for it stops when it is dropped; `None` where the system cannot watch.
    _watcher: Option<RecommendedWatcher>,
    /// Why there is none.
    unwatched: Option<String>,
    events: Receiver<Event>,
    looked: Option<Instant>,
    /// As they were reported.
    reported: HashMap<PathBuf, Stamp>,
    /// Changed and not at rest yet: since when they are as they are.
    changing: HashMap<PathBuf, (Stamp, Instant)>,
}

impl WatchFolder {
    /// Begins to watch; what lies there already is reported first.
    ///
    /// # Errors
    /// [`WatchFolderError`]: no folder, or an option out of its range.
    pub fn start(folder: &Path, options: WatchFolderOptions) -> Result<Self, WatchFolderError> {
        options.check()?;
        if !folder.is_dir() {
            return Err(WatchFolderError::NoFolder { folder: folder.to_owned() });
        }
        let (sender, events) = channel();
        let on_event = move |event: notify::Result<Event>| {
            // A lost event is made good by looking through the folder, a receiver that is gone wants none.
            let _ = event.map(|event| sender.send(event));
        };
        let watcher = notify::recommended_watcher(on_event).and_then(|mut watcher| {
            watcher.watch(folder, RecursiveMode::Recursive)?;
            Ok(watcher)
        });
        let unwatched = watcher.as_ref().err().map(ToString::to_string);
        Ok(Self {
            folder: folder.to_owned(),
            options,
            _watcher: watcher.ok(),
            unwatched,
            events,
            looked: None,
            reported: HashMap::new(),
            changing: HashMap::new(),
        })
    }

    /// Why the system does not report changes, so that the folder is only looked through; `None` where it does.
    pub fn polled_because(&self) -> Option<&str> {
        self.unwatched.as_deref()
    }

    /// Pictures that arrived or changed since they were reported and are at rest now; waits for them, but no longer than `patience`.
    ///
    /// # Errors
    /// [`WatchFolderError::NoFolder`] when the folder vanished.
    pub fn next(&mut self, patience: Duration) -> Result<Vec<PathBuf>, WatchFolderError> {
        let until = Instant::now() + patience;
        loop {
            if self.looked.is_none_or(|looked| looked.elapsed() >= self.options.poll) {
                self.look_through()?;
            }
            let resting = self.take_resting();
            let left = until.saturating_duration_since(Instant::now());
            if !resting.is_empty() || left.is_zero() {
                return Ok(resting);
            }
            // Often enough to see that a file came to rest.
            match self.events.recv_timeout(left.min(self.options.rest / 3)) {
                Ok(event) => self.take(&event),
                // Without a watcher there is no sender.
                Err(RecvTimeoutError::Disconnected) => std::thread::sleep(left.min(self.options.rest / 3)),
                Err(RecvTimeoutError::Timeout) => {}
            }
        }
    }

    fn look_through(&mut self) -> Result<(), WatchFolderError> {
        if !self.folder.is_dir() {
            return Err(WatchFolderError::NoFolder { folder: self.folder.clone() });
        }
        self.looked = Some(Instant::now());
        let found = pictures_in(&[&self.folder], &Unwatched).unwrap_or_default();
        found.files.into_iter().for_each(|file| self.note(file));
        Ok(())
    }

    fn take(&mut self, event: &Event) {
        let is_closed = matches!(event.kind, EventKind::Access(AccessKind::Close(AccessMode::Write)));
        for path in event.paths.iter().filter(|path| Format::of_name(path).is_some()) {
            self.note(path.clone());
            if let (true, Some((_, since))) = (is_closed, self.changing.get_mut(path)) {
                *since = since.checked_sub(self.options.rest).unwrap_or(*since);
            }
        }
    }

    /// Notes a file as it is now, where it is not as it was reported.
    fn note(&mut self, file: PathBuf) {
        let stamp = std::fs::metadata(&file).ok().filter(std::fs::Metadata::is_file);
        let stamp = stamp.and_then(|facts| Some((facts.modified().ok()?, facts.len())));
        match stamp {
            None => {
                self.changing.remove(&file);
                self.reported.remove(&file);
            }
            Some(stamp) if self.reported.get(&file) == Some(&stamp) => {}
            Some(stamp) => {
                let (known, since) = self.changing.entry(file).or_insert((stamp, Instant::now()));
                if *known != stamp {
                    (*known, *since) = (stamp, Instant::now());
                }
            }
        }
    }

    /// Files that rest, sorted. Empty ones are still to be written.
    fn take_resting(&mut self) -> Vec<PathBuf> {
        let at_rest = |(_, since): &(Stamp, Instant)| since.elapsed() >= self.options.rest;
        let mut resting: Vec<PathBuf> =
            self.changing.iter().filter(|(_, changing)| at_rest(changing)).map(|(file, _)| file.clone()).collect();
        resting.sort();
        // As they are now: a share may have gone on without an event.
        resting.iter().for_each(|file| self.note(file.clone()));
        resting.retain(|file| {
            self.changing
                .get(file)
                .is_some_and(|changing| changing.1.elapsed() >= self.options.rest && changing.0.1 > 0)
        });
        for file in &resting {
            if let Some((stamp, _)) = self.changing.remove(file) {
                self.reported.insert(file.clone(), stamp);
            }
        }
        resting
    }
}

#[cfg(test)]
mod tests {
    use std::fs::{self, File};
    use std::io::Write;

    use super::*;

    fn watched(poll_ms: u64) -> (tempfile::TempDir, WatchFolder) {
        let folder = tempfile::tempdir().unwrap();
        let options = WatchFolderOptions { poll: Duration::from_millis(poll_ms), ..WatchFolderOptions::default() };
        let watch = WatchFolder::start(folder.path(), options).unwrap();
        (folder, watch)
    }

    fn names(files: &[PathBuf]) -> Vec<String> {
        files.iter().map(|file| file.file_name().unwrap().to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn a_photo_is_reported_once_within_half_a_second_after_it_was_closed() {
        let (folder, mut watch) = watched(3_600_000);
        assert!(watch.next(Duration::ZERO).unwrap().is_empty());
        fs::write(folder.path().join("notes.txt"), "no picture").unwrap();
        let start = Instant::now();
        fs::write(folder.path().join("left-blue.png"), "a picture").unwrap();
        assert_eq!(names(&watch.next(Duration::from_secs(20)).unwrap()), ["left-blue.png"]);
        if cfg!(target_os = "linux") {
            assert!(start.elapsed() < Duration::from_millis(500), "{:?}", start.elapsed());
        }
        assert!(watch.next(Duration::from_millis(400)).unwrap().is_empty());
        fs::write(folder.path().join("left-blue.png"), "another picture").unwrap();
        assert_eq!(names(&watch.next(Duration::from_secs(20)).unwrap()), ["left-blue.png"], "it was taken again");
    }

    #[test]
    fn a_half_written_photo_waits_until_it_rests() {
        let (folder, mut watch) = watched(3_600_000);
        let mut file = File::create(folder.path().join("top-red.tif")).unwrap();
        for _ in 0..8 {
            file.write_all(&[0; 1000]).unwrap();
            assert!(watch.next(Duration::from_millis(60)).unwrap().is_empty());
        }
        drop(file);
        assert_eq!(names(&watch.next(Duration::from_secs(20)).unwrap()), ["top-red.tif"]);
    }

    /// What events do not tell is found by looking: here none is listened to.
    #[test]
    fn a_share_without_events_is_looked_through_and_a_photo_is_there_within_two_polls() {
        let poll = Duration::from_secs(1);
        let (folder, mut watch) = watched(poll.as_millis() as u64);
        watch._watcher = None;
        watch.next(Duration::ZERO).unwrap();
        fs::create_dir(folder.path().join("object")).unwrap();
        for name in ["left.png", "top.png"] {
            fs::write(folder.path().join("object").join(name), "a picture").unwrap();
            let start = Instant::now();
            assert_eq!(names(&watch.next(Duration::from_secs(20)).unwrap()), [name]);
            println!("{name}: {:?}", start.elapsed());
            assert!(start.elapsed() <= 2 * poll, "{name}: {:?}", start.elapsed());
        }
    }

    #[test]
    fn a_folder_that_vanishes_is_an_error_that_names_it() {
        let (folder, mut watch) = watched(50);
        let path = folder.path().to_owned();
        drop(folder);
        std::thread::sleep(Duration::from_millis(60));
        let error = watch.next(Duration::from_secs(1)).unwrap_err();
        assert_eq!(error, WatchFolderError::NoFolder { folder: path.clone() });
        assert!(WatchFolder::start(&path, WatchFolderOptions::default()).is_err());
        let refused = WatchFolderOptions { poll: Duration::ZERO, ..WatchFolderOptions::default() }.check().unwrap_err();
        assert_eq!(refused.to_string(), "poll is 0; it must be from 0.05 to 3600 seconds");
    }
}
