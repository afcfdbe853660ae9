//! The pictures among files and folders that the user points at.

use std::path::{Path, PathBuf};

use firstbounce_core::Watch;

use super::Format;

/// The most files and folders that one search looks at: a shoot has a few thousand, a whole disk millions.
pub const MAX_LOOKED_AT: usize = 50_000;

/// The most pictures that one search gives.
pub const MAX_PICTURES: usize = 3_000;

/// The pictures that a search found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PicturesFound {
    /// Each once, sorted naturally: 2 before 10.
    pub files: Vec<PathBuf>,
    /// Files and folders that were looked at.
    pub looked_at: usize,
    /// Whether there was more to look at than [`MAX_LOOKED_AT`], or more to give than [`MAX_PICTURES`].
    pub is_cut_off: bool,
}

/// The files named, and all pictures in the folders named and in theirs. What is hidden, or cannot be read, is left out, and
/// so are links to folders within them: they may lead in circles. `None` when it was cancelled.
pub fn pictures_in<P: AsRef<Path>>(paths: &[P], watch: &dyn Watch) -> Option<PicturesFound> {
    let mut found = PicturesFound::default();
    let mut folders = Vec::new();
    for path in paths.iter().map(AsRef::as_ref) {
        let list = if path.is_dir() { &mut folders } else { &mut found.files };
        list.push(path.to_owned());
    }
    while let Some(folder) = folders.pop() {
        watch.progress(found.looked_at as f32 / MAX_LOOKED_AT as f32);
        for entry in folder.read_dir().into_iter().flatten().flatten() {
            if watch.cancelled() {
                return None;
            }
            if found.looked_at == MAX_LOOKED_AT {
                found.is_cut_off = true;
                return Some(found.sorted());
            }
            found.looked_at += 1;
            let path = entry.path();
            let is_hidden = entry.file_name().to_string_lossy().starts_with('.');
            if is_hidden {
                continue;
            }
            if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
                folders.push(path);
            } else if Format::of_name(&path).is_some() && !path.is_dir() {
                found.files.push(path);
            }
        }
    }
    Some(found.sorted())
}

impl PicturesFound {
    fn sorted(mut self) -> Self {
        self.files.sort_by_cached_key(|path| natural_key(&path.to_string_lossy()));
        self.files.dedup();
        self.is_cut_off |= self.files.len() > MAX_PICTURES;
        self.files.truncate(MAX_PICTURES);
        self
    }
}

/// Digits by their value, all else by its letters.
pub(crate) fn natural_key(text: &str) -> Vec<(String, u64)> {
    let mut key = Vec::new();
    let mut rest = text;
    while !rest.is_empty() {
        let letters = rest.find(|c: char| c.is_ascii_digit()).unwrap_or(rest.len());
        let digits = rest[letters..].find(|c: char| !c.is_ascii_digit()).map_or(rest.len(), |end| letters + end);
        key.push((rest[..letters].to_lowercase(), rest[letters..digits].parse().unwrap_or(u64::MAX)));
        rest = &rest[digits..];
    }
    key
}

#[cfg(test)]
mod tests {
    use std::fs;

    use firstbounce_core::Unwatched;

    use super::*;

    #[test]
    fn a_folder_gives_its_pictures_in_natural_order() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir_all(folder.path().join("object")).unwrap();
        for name in ["object/10.png", "object/2.PNG", "notes.txt", ".hidden.png", "dark.tiff"] {
            fs::write(folder.path().join(name), []).unwrap();
        }
        let named = folder.path().join("notes.txt");
        let found = pictures_in(&[folder.path(), &named, folder.path()], &Unwatched).unwrap();
        let names: Vec<_> =
            found.files.iter().map(|p| p.strip_prefix(folder.path()).unwrap().to_string_lossy()).collect();
        assert_eq!(names, ["dark.tiff", "notes.txt", "object/2.PNG", "object/10.png"]);
    }

    #[cfg(unix)]
    #[test]
    fn a_folder_with_links_to_itself_gives_each_picture_once() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("photo.png"), []).unwrap();
        for name in ["a", "b", "c.png", "d"] {
            std::os::unix::fs::symlink(folder.path(), folder.path().join(name)).unwrap();
        }
        std::os::unix::fs::symlink("photo.png", folder.path().join("same.png")).unwrap();
        let found = pictures_in(&[folder.path()], &Unwatched).unwrap();
        assert_eq!(found.files, [folder.path().join("photo.png"), folder.path().join("same.png")]);
        assert_eq!((found.looked_at, found.is_cut_off), (6, false));
    }

    #[test]
    fn of_more_pictures_than_can_be_shown_the_first_are_given() {
        let files: Vec<_> = (0..=MAX_PICTURES).rev().map(|number| PathBuf::from(format!("{number}.png"))).collect();
        let found = pictures_in(&files, &Unwatched).unwrap();
        assert_eq!((found.files.len(), found.is_cut_off), (MAX_PICTURES, true));
        assert_eq!(found.files[..2], [PathBuf::from("0.png"), PathBuf::from("1.png")]);
    }

    #[test]
    fn a_search_is_cancelled_and_ends_at_its_bound() {
        struct Cancelled;
        impl Watch for Cancelled {
            fn progress(&self, _: f32) {}
            fn cancelled(&self) -> bool {
                true
            }
        }
        let folder = tempfile::tempdir().unwrap();
        for number in 0..=MAX_LOOKED_AT {
            fs::write(folder.path().join(format!("{number}.txt")), []).unwrap();
        }
        let found = pictures_in(&[folder.path()], &Unwatched).unwrap();
        assert_eq!((found.looked_at, found.is_cut_off, found.files.len()), (MAX_LOOKED_AT, true, 0));
        assert_eq!(pictures_in(&[folder.path()], &Cancelled), None);
    }
}
