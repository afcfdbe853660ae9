//! Files and folders of output, whole or not at all.

use std::fs;
#[cfg(unix)]
use std::fs::Permissions;
use std::path::Path;

use super::*;

mod killed;
mod together;

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_written_file_takes_the_place_of_the_old_one_and_leaves_nothing_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("capture.toml");
    write_file(&path, b"one").unwrap();
    write_file(&path, b"two").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"two");
    assert_eq!(names(folder.path()), ["capture.toml"]);
}

#[cfg(unix)]
#[test]
fn others_may_read_a_new_file_and_an_old_one_keeps_its_permissions() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let (path, plain) = (folder.path().join("saved"), folder.path().join("plain"));
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
    write_file(&path, b"one").unwrap();
    fs::write(&plain, b"one").unwrap();
    assert_eq!(mode(&path), mode(&plain));
    fs::set_permissions(&path, Permissions::from_mode(0o640)).unwrap();
    write_file(&path, b"two").unwrap();
    assert_eq!(mode(&path), 0o640);
}

#[cfg(unix)]
#[test]
fn writing_through_a_link_keeps_the_link() {
    let folder = tempfile::tempdir().unwrap();
    let (path, link) = (folder.path().join("file"), folder.path().join("link"));
    fs::write(&path, b"one").unwrap();
    std::os::unix::fs::symlink(&path, &link).unwrap();
    write_file(&link, b"two").unwrap();
    assert!(link.is_symlink());
    assert_eq!(fs::read(&path).unwrap(), b"two");
}

#[test]
fn a_file_that_cannot_be_written_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, b"old").unwrap();
    let message = write_file(&file.join("capture.toml"), b"new").unwrap_err().to_string();
    assert!(message.starts_with(&format!("cannot write {}", file.join("capture.toml").display())), "{message}");
    assert!(matches!(write_file(folder.path(), b"new"), Err(WriteError::FolderInTheWay { .. })));
    assert_eq!(fs::read(&file).unwrap(), b"old");
    assert_eq!(names(folder.path()), ["file"]);
}

#[test]
fn dropped_output_leaves_no_trace() {
    let folder = tempfile::tempdir().unwrap();
    for target in [folder.path().join("a/b/out"), folder.path().to_owned()] {
        let output = OutputFolder::stage(target).unwrap();
        fs::write(output.file("mesh/object.obj").unwrap(), b"v").unwrap();
        drop(output);
        assert!(names(folder.path()).is_empty());
    }
}

#[test]
fn committed_output_is_all_there_and_open_to_others() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("a/out");
    let output = OutputFolder::stage(&target).unwrap();
    fs::write(output.file("report.json").unwrap(), b"{}").unwrap();
    fs::write(output.file("mesh/object.obj").unwrap(), b"v").unwrap();
    assert!(!target.exists());
    output.commit().unwrap();
    assert_eq!(names(folder.path()), ["a"]);
    assert_eq!(names(&target), ["mesh", "report.json"]);
    assert_eq!(fs::read(target.join("mesh/object.obj")).unwrap(), b"v");
    let plain = folder.path().join("plain");
    fs::create_dir(&plain).unwrap();
    assert_eq!(fs::metadata(&target).unwrap().permissions(), fs::metadata(&plain).unwrap().permissions());
}

#[test]
fn commit_replaces_its_own_files_and_no_others() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("notes.txt"), b"mine").unwrap();
    fs::write(folder.path().join("report.json"), b"old").unwrap();
    let output = OutputFolder::stage(folder.path()).unwrap();
    fs::write(output.file("report.json").unwrap(), b"new").unwrap();
    fs::write(output.file("mesh/object.obj").unwrap(), b"v").unwrap();
    assert_eq!(fs::read(folder.path().join("report.json")).unwrap(), b"old");
    output.commit().unwrap();
    assert_eq!(names(folder.path()), ["mesh", "notes.txt", "report.json"]);
    assert_eq!(fs::read(folder.path().join("report.json")).unwrap(), b"new");
    assert_eq!(fs::read(folder.path().join("notes.txt")).unwrap(), b"mine");
}

#[test]
fn a_retired_file_goes_with_the_commit_and_stays_without_it() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("mesh.stl"), b"old").unwrap();
    fs::write(folder.path().join("mesh.obj"), b"old").unwrap();
    let staged = || {
        let output = OutputFolder::stage(folder.path()).unwrap();
        fs::write(output.file("mesh.obj").unwrap(), b"new").unwrap();
        output
    };
    let retired = ["mesh.stl", "mesh.obj", "never.ply"].map(str::to_owned).to_vec();
    drop(staged());
    assert_eq!(names(folder.path()), ["mesh.obj", "mesh.stl"]);
    staged().commit_after(|_| Ok::<_, WriteError>(retired.clone())).unwrap();
    assert_eq!(names(folder.path()), ["mesh.obj"]);
    assert_eq!(fs::read(folder.path().join("mesh.obj")).unwrap(), b"new");
}

#[cfg(unix)]
#[test]
fn a_folder_that_is_exchanged_keeps_its_permissions() {
    use std::os::unix::fs::{MetadataExt, PermissionsExt};
    let place = tempfile::tempdir().unwrap();
    let target = place.path().join("out");
    let write = |text: &str| {
        let output = OutputFolder::stage(&target).unwrap();
        for name in ["a.exr", "inner/b.exr"] {
            fs::write(output.file(name).unwrap(), text).unwrap();
        }
        output.commit().unwrap();
    };
    write("old");
    let folders = [target.clone(), target.join("inner")];
    folders.iter().for_each(|folder| fs::set_permissions(folder, Permissions::from_mode(0o750)).unwrap());
    let before = fs::metadata(&target).unwrap().ino();
    write("new");
    for folder in &folders {
        assert_eq!(fs::metadata(folder).unwrap().mode() & 0o777, 0o750);
    }
    assert_eq!(fs::read(target.join("inner/b.exr")).unwrap(), b"new");
    assert_eq!(before != fs::metadata(&target).unwrap().ino(), cfg!(any(target_os = "linux", target_vendor = "apple")));
}

#[test]
fn a_commit_that_fails_midway_puts_the_old_files_back() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.exr"), b"old").unwrap();
    // A file where a folder is needed stops the second move, not the first.
    fs::write(folder.path().join("mesh"), b"mine").unwrap();
    let output = OutputFolder::stage(folder.path()).unwrap();
    fs::write(output.file("a.exr").unwrap(), b"new").unwrap();
    fs::write(output.file("b.exr").unwrap(), b"new").unwrap();
    fs::write(output.file("mesh/object.obj").unwrap(), b"v").unwrap();
    let message = output.commit().unwrap_err().to_string();
    assert!(message.contains("object.obj"), "{message}");
    assert_eq!(names(folder.path()), ["a.exr", "mesh"]);
    assert_eq!(fs::read(folder.path().join("a.exr")).unwrap(), b"old");
}

#[test]
fn a_file_in_place_of_the_folder_is_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("out");
    fs::write(&file, b"mine").unwrap();
    for target in [file.clone(), file.join("inner")] {
        let message = OutputFolder::stage(target).unwrap_err().to_string();
        assert!(message.contains("it is a file"), "{message}");
    }
    assert_eq!(fs::read(&file).unwrap(), b"mine");
}
