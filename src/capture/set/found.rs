//! Files that are there under another name than the one that is written, as Windows finds them: with `\` between folders
//! and other capitals.

use std::path::{Path, PathBuf};

/// The file that is meant by `path`: itself where it is there, else the one whose name differs by capitals alone.
pub(super) fn as_windows_finds(path: PathBuf) -> PathBuf {
    if path.symlink_metadata().is_ok() {
        return path;
    }
    let text = path.to_string_lossy();
    let slashed = if text.contains('\\') { PathBuf::from(text.replace('\\', "/")) } else { path };
    with_other_capitals(&slashed).unwrap_or(slashed)
}

/// The one entry at `path` when capitals count as small letters; `None` where there is none, or more than one.
fn with_other_capitals(path: &Path) -> Option<PathBuf> {
    if path.exists() {
        return Some(path.to_owned());
    }
    let name = path.file_name()?;
    let wanted = name.to_string_lossy().to_lowercase();
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = with_other_capitals(parent)?;
    if folder.join(name).exists() {
        return Some(folder.join(name));
    }
    let entries = folder.read_dir().ok()?.flatten();
    let mut same = entries.filter(|entry| entry.file_name().to_string_lossy().to_lowercase() == wanted);
    let found = same.next()?;
    same.next().is_none().then(|| folder.join(found.file_name()))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::super::CaptureSet;

    #[cfg(unix)]
    #[test]
    fn paths_that_windows_wrote_find_their_files() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("Object")).unwrap();
        for name in ["Left-Blue.PNG", "a.png", "A.png"] {
            fs::write(folder.path().join("Object").join(name), []).unwrap();
        }
        let set = CaptureSet { folder: folder.path().to_owned(), ..CaptureSet::default() };
        let there = folder.path().join("Object/Left-Blue.PNG");
        for written in
            ["Object/Left-Blue.PNG", "Object\\Left-Blue.PNG", "object/left-blue.png", "OBJECT\\left-blue.png"]
        {
            assert_eq!(set.resolve(written), there, "{written}");
        }
        assert_eq!(set.resolve("object/A.png"), folder.path().join("Object/A.png"));
        assert!(!set.resolve("Object/a.PNG").exists(), "two files could be meant");
        assert_eq!(set.resolve("gone\\x.png"), folder.path().join("gone/x.png"));
    }
}
