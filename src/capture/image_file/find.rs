//! The pictures among files and folders that the user points at.

use std::path::{Path, PathBuf};

use super::Format;

/// Folders within folders that are looked into: a link to a parent must not go on for ever.
const DEEPEST: usize = 8;

/// The files named, and all pictures in the folders named and in theirs, each once, sorted naturally: 2 before 10.
/// What is hidden, or cannot be read, is left out.
pub fn pictures_in<P: AsRef<Path>>(paths: &[P]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for path in paths {
        let path = path.as_ref();
        if path.is_dir() {
            look_into(path, DEEPEST, &mut found);
        } else {
            found.push(path.to_owned());
        }
    }
    found.sort_by_cached_key(|path| natural_key(&path.to_string_lossy()));
    found.dedup();
    found
}

fn look_into(folder: &Path, deeper: usize, found: &mut Vec<PathBuf>) {
    let Ok(entries) = folder.read_dir() else { return };
    for entry in entries.flatten() {
        let path = entry.path();
        if entry.file_name().to_string_lossy().starts_with('.') {
            continue;
        }
        if path.is_dir() {
            if deeper > 0 {
                look_into(&path, deeper - 1, found);
            }
        } else if Format::of_name(&path).is_some() {
            found.push(path);
        }
    }
}

/// Digits by their value, all else by its letters.
fn natural_key(text: &str) -> Vec<(String, u64)> {
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

    use super::*;

    #[test]
    fn a_folder_gives_its_pictures_in_natural_order() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir_all(folder.path().join("object")).unwrap();
        for name in ["object/10.png", "object/2.PNG", "notes.txt", ".hidden.png", "dark.tiff"] {
            fs::write(folder.path().join(name), []).unwrap();
        }
        let named = folder.path().join("notes.txt");
        let found = pictures_in(&[folder.path(), &named, folder.path()]);
        let names: Vec<_> = found.iter().map(|p| p.strip_prefix(folder.path()).unwrap().to_string_lossy()).collect();
        assert_eq!(names, ["dark.tiff", "notes.txt", "object/2.PNG", "object/10.png"]);
    }
}
