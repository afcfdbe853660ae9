//! Runs that end at any of their moves, and the runs after them.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::super::output::{OutputFolder, OutputRules};
use super::super::rename::{Move, rename};

const RULES: OutputRules = OutputRules { guarded: None, is_output: |name| !name.contains("mine") };
const OLD: [&str; 4] = ["a.exr", "inner/b.exr", "mesh.stl", "report.json"];
const NEW: [&str; 5] = ["a.exr", "inner/b.exr", "new/c.exr", "report.html", "report.json"];
const RETIRED: [&str; 1] = ["mesh.stl"];

/// What the process that is killed is told: the folder, and at which of its moves it ends or fails.
const TARGET: &str = "FIRSTBOUNCE_TEST_TARGET";
const ENDS_AT: &str = "FIRSTBOUNCE_TEST_ENDS_AT";
const FAILS_AT: &str = "FIRSTBOUNCE_TEST_FAILS_AT";
const COMMITS: &str = "FIRSTBOUNCE_TEST_COMMITS";
const KILLED: i32 = 77;

fn counted(from: &Path, to: &Path, how: Move) -> io::Result<()> {
    static MOVES: AtomicUsize = AtomicUsize::new(0);
    let number = MOVES.fetch_add(1, Ordering::Relaxed) + 1;
    let is_now = |name| std::env::var(name).is_ok_and(|value| value.parse() == Ok(number));
    if is_now(ENDS_AT) {
        // Nothing is put in order, as when the system kills it.
        std::process::exit(KILLED);
    }
    if is_now(FAILS_AT) { Err(io::ErrorKind::StorageFull.into()) } else { rename(from, to, how) }
}

fn commit(output: OutputFolder) -> Result<(), super::WriteError> {
    for name in NEW {
        fs::write(output.file(name).unwrap(), format!("new {name}")).unwrap();
    }
    output.commit_after(|_| Ok(RETIRED.map(str::to_owned).to_vec()))
}

/// Does nothing by itself: the other tests run it as the process that is killed.
#[test]
fn a_process_that_is_killed() {
    let Ok(target) = std::env::var(TARGET) else { return };
    let output = OutputFolder::stage_moving(Path::new(&target), RULES, counted).unwrap();
    if std::env::var(COMMITS).is_ok() {
        commit(output).unwrap();
    }
}

/// Runs the process; whether it was killed. `moves` says at which it ends, and at which it fails.
fn killed(target: &Path, commits: bool, moves: &[(&str, usize)]) -> bool {
    let mut process = Command::new(std::env::current_exe().unwrap());
    process.args(["--exact", "atomic::tests::killed::a_process_that_is_killed"]).env(TARGET, target);
    if commits {
        process.env(COMMITS, "");
    }
    process.envs(moves.iter().map(|(name, number)| (name, number.to_string())));
    process.output().unwrap().status.code() == Some(KILLED)
}

type Contents = BTreeMap<String, String>;

fn of(names: &[&str], prefix: &str) -> Contents {
    names.iter().map(|name| ((*name).to_owned(), format!("{prefix} {name}"))).collect()
}

/// Every file that is not hidden.
fn seen_in(folder: &Path) -> Contents {
    let mut seen = Contents::new();
    let mut pending = vec![folder.to_owned()];
    while let Some(place) = pending.pop() {
        for entry in fs::read_dir(place).unwrap().map(Result::unwrap) {
            let path = entry.path();
            if entry.file_name().to_string_lossy().starts_with('.') {
                continue;
            }
            if path.is_dir() {
                pending.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().to_str().unwrap().replace('\\', "/");
                seen.insert(name, fs::read_to_string(path).unwrap());
            }
        }
    }
    seen
}

fn put(folder: &Path, contents: &Contents) {
    for (name, text) in contents {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
}

fn is_clean(folder: &Path) -> bool {
    fs::read_dir(folder).unwrap().all(|entry| !entry.unwrap().file_name().to_string_lossy().starts_with('.'))
}

/// Asserts that the next run finds the old files or the new ones, all of them, leaves no litter, and can write.
fn assert_next_run_works(place: &Path, mine: &Contents) {
    let target = place.join("out");
    drop(OutputFolder::stage_with(&target, RULES).unwrap());
    let whole = |names: &[&str], prefix: &str| of(names, prefix).into_iter().chain(mine.clone()).collect::<Contents>();
    let seen = seen_in(&target);
    assert!(seen == whole(&OLD, "old") || seen == whole(&NEW, "new"), "a mixture: {seen:#?}");
    assert!(is_clean(&target) && is_clean(place), "litter");
    commit(OutputFolder::stage_with(&target, RULES).unwrap()).unwrap();
    assert_eq!(seen_in(&target), whole(&NEW, "new"));
    assert!(is_clean(&target) && is_clean(place), "litter");
}

fn prepared(mine: &Contents) -> tempfile::TempDir {
    let place = tempfile::tempdir().unwrap();
    put(&place.path().join("out"), &of(&OLD, "old"));
    put(&place.path().join("out"), mine);
    place
}

fn of_the_user() -> Contents {
    [("notes.mine", "notes"), ("inner/more.mine", "more")].map(|(name, text)| (name.into(), text.into())).into()
}

#[test]
fn a_folder_of_results_alone_is_the_old_or_the_new_one_whenever_the_run_is_killed() {
    for number in 1.. {
        let place = prepared(&Contents::new());
        let target = place.path().join("out");
        let was_killed = killed(&target, true, &[(ENDS_AT, number)]);
        let seen = seen_in(&target);
        if !was_killed {
            assert!(number > 2 && seen == of(&NEW, "new"));
            return;
        }
        if cfg!(any(target_os = "linux", target_os = "macos")) {
            assert!(seen == of(&OLD, "old") || seen == of(&NEW, "new"), "a mixture: {seen:#?}");
        }
        assert_next_run_works(place.path(), &Contents::new());
    }
}

#[test]
fn beside_files_of_the_user_the_next_run_finishes_what_a_killed_one_began() {
    let mine = of_the_user();
    for number in 1.. {
        let place = prepared(&mine);
        let was_killed = killed(&place.path().join("out"), true, &[(ENDS_AT, number)]);
        assert_next_run_works(place.path(), &mine);
        if !was_killed {
            assert!(number > 5);
            return;
        }
    }
}

#[test]
fn a_run_that_is_killed_while_it_finishes_another_is_finished_by_the_one_after() {
    let mine = of_the_user();
    for (number, again) in (2..8).flat_map(|number| (1..4).map(move |again| (number, again))) {
        let place = prepared(&mine);
        let target = place.path().join("out");
        assert!(killed(&target, true, &[(ENDS_AT, number)]));
        killed(&target, false, &[(ENDS_AT, again)]);
        assert_next_run_works(place.path(), &mine);
    }
}

#[test]
fn a_run_that_is_killed_while_it_puts_old_files_back_leaves_that_to_the_next() {
    let mine = of_the_user();
    for (fails, ends) in (2..8).flat_map(|fails| (fails + 1..fails + 9).map(move |ends| (fails, ends))) {
        let place = prepared(&mine);
        killed(&place.path().join("out"), true, &[(FAILS_AT, fails), (ENDS_AT, ends)]);
        assert_next_run_works(place.path(), &mine);
    }
}

/// Whether strace is here and may trace.
#[cfg(target_os = "linux")]
fn can_trace() -> bool {
    Command::new("strace").args(["-f", "-qq", "-o", "/dev/null", "true"]).status().is_ok_and(|status| status.success())
}

/// Runs the process that commits, and has the system kill it at a call; whether it was killed.
#[cfg(target_os = "linux")]
fn killed_at(call: &str, number: usize, target: &Path) -> bool {
    let mut process = Command::new("strace");
    process.args(["-f", "-qq", "-o", "/dev/null", "-e", &format!("trace={call}")]);
    process.args(["-e", &format!("inject={call}:signal=SIGKILL:when={number}")]).arg(std::env::current_exe().unwrap());
    process.args(["--exact", "atomic::tests::killed::a_process_that_is_killed"]).env(TARGET, target).env(COMMITS, "");
    !process.output().unwrap().status.success()
}

#[cfg(target_os = "linux")]
#[test]
fn killed_at_any_change_of_the_disk_a_run_leaves_the_old_files_or_the_new_ones() {
    if !can_trace() {
        return eprintln!("skipped: strace is not here or may not trace");
    }
    let calls = ["rename", "renameat2", "linkat", "unlink", "unlinkat", "rmdir", "mkdir", "fsync", "flock"];
    for (mine, call) in [Contents::new(), of_the_user()].iter().flat_map(|mine| calls.map(|call| (mine, call))) {
        for number in 1.. {
            let place = prepared(mine);
            let was_killed = killed_at(call, number, &place.path().join("out"));
            assert_next_run_works(place.path(), mine);
            if !was_killed {
                break;
            }
        }
    }
}

#[test]
fn a_new_folder_is_there_whole_or_not_at_all() {
    for number in 1.. {
        let place = tempfile::tempdir().unwrap();
        let target = place.path().join("inner/out");
        let was_killed = killed(&target, true, &[(ENDS_AT, number)]);
        assert_eq!(target.exists(), !was_killed);
        commit(OutputFolder::stage_with(&target, RULES).unwrap()).unwrap();
        assert_eq!(seen_in(&target), of(&NEW, "new"));
        assert!(is_clean(place.path()) && is_clean(target.parent().unwrap()));
        if !was_killed {
            return;
        }
    }
}

#[test]
fn a_move_that_fails_at_any_place_leaves_the_old_files() {
    for number in 1.. {
        let place = prepared(&of_the_user());
        let target = place.path().join("out");
        let mut process = Command::new(std::env::current_exe().unwrap());
        process.args(["--exact", "atomic::tests::killed::a_process_that_is_killed"]);
        process.env(TARGET, &target).env(COMMITS, "").env(FAILS_AT, number.to_string());
        let succeeded = process.output().unwrap().status.success();
        let (names, prefix) = if succeeded { (&NEW[..], "new") } else { (&OLD[..], "old") };
        assert_eq!(seen_in(&target), of(names, prefix).into_iter().chain(of_the_user()).collect::<Contents>());
        assert!(is_clean(&target) && is_clean(place.path()));
        if succeeded {
            assert!(number > 5);
            return;
        }
    }
}
