//! Runs that are killed while they write, and runs that write into one folder at the same time.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::run::firstbounce;
use crate::tiny_set;

const PROGRAM: &str = env!("CARGO_BIN_EXE_firstbounce");

type Files = BTreeMap<String, Vec<u8>>;

/// Every file that is not hidden.
fn files_in(folder: &Path) -> Files {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    let named = entries.map(|entry| (entry.file_name().into_string().unwrap(), entry.path()));
    named.filter(|(name, _)| !name.starts_with('.')).map(|(name, path)| (name, fs::read(path).unwrap())).collect()
}

fn hidden_in(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    entries.filter(|name| name.starts_with('.')).collect()
}

/// Without the pages that hold the time that each step took.
fn untimed(files: &Files) -> Files {
    let timed = ["report.json", "report.html"];
    files.iter().filter(|(name, _)| !timed.contains(&name.as_str())).map(|(a, b)| (a.clone(), b.clone())).collect()
}

/// The folder as it is, is a whole result of one of these runs.
fn is_one_of(files: &Files, results: [&Files; 2]) -> bool {
    let report: serde_json::Value = serde_json::from_slice(&files["report.json"]).unwrap();
    let listed: Vec<_> = report["files"].as_object().unwrap().keys().cloned().collect();
    let mut names: Vec<_> = files.keys().cloned().collect();
    names.retain(|name| name != "notes.txt");
    let is_listed = listed.len() == names.len() && listed.iter().all(|name| names.contains(name));
    let mut without_notes = untimed(files);
    without_notes.remove("notes.txt");
    is_listed && results.iter().any(|result| untimed(result) == without_notes)
}

const OLD: [&str; 4] = ["--formats", "obj", "--out", "out"];
const NEW: [&str; 5] = ["--formats", "stl", "--directx", "--out", "out"];

fn solved(place: &Path, flags: &[&str]) -> Files {
    let ran = firstbounce(place, [&["solve", "tiny"], flags].concat());
    assert_eq!(ran.code, 0, "{}", ran.err);
    files_in(&place.join("out"))
}

#[cfg(target_os = "linux")]
fn can_trace() -> bool {
    Command::new("strace").args(["-f", "-qq", "-o", "/dev/null", "true"]).status().is_ok_and(|status| status.success())
}

#[cfg(target_os = "linux")]
fn killed_at_rename(place: &Path, call: &str, number: usize) -> bool {
    let mut process = Command::new("strace");
    process.args(["-f", "-qq", "-o", "/dev/null", "-e", &format!("trace={call}")]);
    process.args(["-e", &format!("inject={call}:signal=SIGKILL:when={number}"), PROGRAM, "solve", "tiny"]).args(NEW);
    !process.current_dir(place).output().unwrap().status.success()
}

#[cfg(target_os = "linux")]
#[test]
fn a_program_that_is_killed_at_any_rename_leaves_the_old_results_or_the_new_ones() {
    if !can_trace() {
        return eprintln!("skipped: strace is not here or may not trace");
    }
    let place = tempfile::tempdir().unwrap();
    tiny_set::write(place.path());
    let (place, out) = (place.path(), place.path().join("out"));
    let old = solved(place, &OLD);
    let new = solved(place, &NEW);
    assert!(new.contains_key("mesh.stl") && !new.contains_key("mesh.obj"), "the old mesh is taken away");
    for has_notes in [false, true] {
        for (call, number) in ["rename", "renameat2"].iter().flat_map(|call| (1..=4).map(move |number| (call, number)))
        {
            fs::remove_dir_all(&out).unwrap();
            solved(place, &OLD);
            if has_notes {
                fs::write(out.join("notes.txt"), "mine").unwrap();
            }
            let was_killed = killed_at_rename(place, call, number);
            assert!(has_notes || is_one_of(&files_in(&out), [&old, &new]), "{call} {number}");
            solved(place, if number % 2 == 0 { &OLD } else { &NEW });
            assert!(is_one_of(&files_in(&out), [&old, &new]), "{call} {number}: the next run works");
            assert_eq!((hidden_in(&out), hidden_in(place)), (vec![], vec![]), "{call} {number}");
            assert!(!has_notes || fs::read(out.join("notes.txt")).unwrap() == b"mine");
            if !was_killed {
                break;
            }
        }
    }
}

#[test]
fn of_two_programs_that_write_at_once_the_folder_is_the_result_of_one() {
    let place = tempfile::tempdir().unwrap();
    tiny_set::write(place.path());
    let (place, out) = (place.path(), place.path().join("out"));
    let (old, new) = (solved(place, &OLD), solved(place, &NEW));
    for round in 0..6 {
        match round % 3 {
            0 => fs::remove_dir_all(&out).unwrap(),
            1 => fs::write(out.join("notes.txt"), "mine").unwrap(),
            _ => {}
        }
        let start = |flags: &[&str]| {
            let mut process = Command::new(PROGRAM);
            process.args(["solve", "tiny"]).args(flags).current_dir(place).stdout(Stdio::null()).stderr(Stdio::null());
            process.spawn().unwrap()
        };
        for mut run in [start(&OLD), start(&NEW)] {
            assert!(run.wait().unwrap().success(), "round {round}");
        }
        assert!(is_one_of(&files_in(&out), [&old, &new]), "round {round}");
        assert_eq!((hidden_in(&out), hidden_in(place)), (vec![], vec![]));
    }
}
