//! A watched folder that is followed from a thread of its own.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use std::time::Duration;

use super::{WatchFolder, WatchFolderError, WatchFolderOptions};

/// How long the thread waits for photos before it looks whether it is still wanted.
const PATIENCE: Duration = Duration::from_millis(100);

/// What happened in a folder.
#[derive(Clone, Debug, PartialEq)]
pub enum WatchEvent {
    /// The system reports no changes there: the folder is looked through at [`WatchFolderOptions::poll`].
    Polled {
        /// The system's words.
        reason: String,
    },
    /// Pictures that arrived, or changed, and are complete; sorted. The first are those that lay there.
    Arrived(Vec<PathBuf>),
    /// The folder is watched no longer; nothing comes after.
    Ended(WatchFolderError),
}

/// A folder that is followed until this is dropped.
#[derive(Debug)]
pub struct Following {
    events: Receiver<WatchEvent>,
    is_over: Arc<AtomicBool>,
}

impl Following {
    /// Begins to follow a folder; `wake` is called after each event, from the thread that follows.
    ///
    /// # Errors
    /// [`WatchFolderError`]: no folder, or an option out of its range.
    pub fn start(
        folder: &Path,
        options: WatchFolderOptions,
        wake: impl Fn() + Send + 'static,
    ) -> Result<Self, WatchFolderError> {
        let watch = WatchFolder::start(folder, options)?;
        let (sender, events) = channel();
        let is_over = Arc::new(AtomicBool::new(false));
        let over = Arc::clone(&is_over);
        thread::spawn(move || follow(watch, &sender, &over, &wake));
        Ok(Self { events, is_over })
    }

    /// The next event where there is one; waits for none. `None` too once it has ended.
    pub fn try_next(&self) -> Option<WatchEvent> {
        self.events.try_recv().ok()
    }

    /// The next event; waits for it, but no longer than `patience`.
    pub fn next(&self, patience: Duration) -> Option<WatchEvent> {
        self.events.recv_timeout(patience).ok()
    }
}

impl Drop for Following {
    fn drop(&mut self) {
        // The thread ends by itself within its patience: a window does not wait for it.
        self.is_over.store(true, Ordering::Relaxed);
    }
}

fn follow(mut watch: WatchFolder, sender: &Sender<WatchEvent>, is_over: &AtomicBool, wake: &dyn Fn()) {
    let tell = |event| {
        let is_heard = sender.send(event).is_ok();
        wake();
        is_heard
    };
    if let Some(reason) = watch.polled_because()
        && !tell(WatchEvent::Polled { reason: reason.to_owned() })
    {
        return;
    }
    while !is_over.load(Ordering::Relaxed) {
        match watch.next(PATIENCE) {
            Ok(files) if files.is_empty() => {}
            Ok(files) => {
                if !tell(WatchEvent::Arrived(files)) {
                    return;
                }
            }
            Err(error) => {
                tell(WatchEvent::Ended(error));
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::sync::atomic::AtomicUsize;
    use std::time::Instant;

    use super::*;

    const LONG: Duration = Duration::from_secs(20);

    #[test]
    fn photos_come_over_a_channel_and_wake_who_waits() {
        let folder = tempfile::tempdir().unwrap();
        let woken = Arc::new(AtomicUsize::new(0));
        let count = Arc::clone(&woken);
        let wake = move || {
            count.fetch_add(1, Ordering::SeqCst);
        };
        let following = Following::start(folder.path(), WatchFolderOptions::default(), wake).unwrap();
        assert_eq!(following.try_next(), None);
        let file = folder.path().join("left-blue.png");
        let start = Instant::now();
        fs::write(&file, "a picture").unwrap();
        assert_eq!(following.next(LONG), Some(WatchEvent::Arrived(vec![file])));
        if cfg!(target_os = "linux") {
            assert!(start.elapsed() < Duration::from_millis(500), "{:?}", start.elapsed());
        }
        // It is woken right after the event is there.
        while woken.load(Ordering::SeqCst) == 0 && start.elapsed() < LONG {
            thread::sleep(Duration::from_millis(1));
        }
        assert_eq!(woken.load(Ordering::SeqCst), 1);
    }

    #[test]
    fn a_folder_that_vanishes_ends_it_and_one_that_is_dropped_is_followed_no_longer() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().to_owned();
        let options = WatchFolderOptions { poll: Duration::from_millis(50), ..WatchFolderOptions::default() };
        let following = Following::start(&path, options, || ()).unwrap();
        drop(folder);
        let ended = WatchEvent::Ended(WatchFolderError::NoFolder { folder: path.clone() });
        assert_eq!(following.next(LONG), Some(ended));
        assert_eq!((following.next(LONG), following.try_next()), (None, None));
        assert!(Following::start(&path, options, || ()).is_err());

        let folder = tempfile::tempdir().unwrap();
        let wanted = Arc::new(());
        let kept = Arc::clone(&wanted);
        drop(Following::start(folder.path(), options, move || drop(Arc::clone(&kept))).unwrap());
        let start = Instant::now();
        while Arc::strong_count(&wanted) > 1 && start.elapsed() < LONG {
            thread::sleep(Duration::from_millis(5));
        }
        assert_eq!(Arc::strong_count(&wanted), 1, "the thread has ended");
    }
}
