//! Runs that write into one folder at the same time.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::sync::Barrier;

use super::super::output::{OutputFolder, OutputRules};
use super::{WriteError, names};

const RULES: OutputRules = OutputRules { guarded: None, is_output: |name| name != "notes.txt" };

/// Each run has files that the other has not.
fn files_of(run: &str) -> BTreeSet<String> {
    let common = (0..6).map(|number| format!("bounce{number}-left.exr"));
    common.chain([format!("mesh.{run}"), "report.json".to_owned()]).collect()
}

fn write(target: &Path, run: &str, barrier: &Barrier) -> Result<(), WriteError> {
    let output = OutputFolder::stage_with(target, RULES)?;
    for name in files_of(run) {
        fs::write(output.file(name)?, run).unwrap();
    }
    barrier.wait();
    output.commit_after(|target| {
        let others = names(target).into_iter().filter(|name| name != "notes.txt" && !name.starts_with('.'));
        Ok(others.collect())
    })
}

#[test]
fn of_two_runs_at_once_the_folder_is_the_result_of_one() {
    for round in 0..50 {
        let place = tempfile::tempdir().unwrap();
        let target = place.path().join("out");
        let (is_there, has_notes) = (round % 3 > 0, round % 3 == 2);
        if is_there {
            fs::create_dir(&target).unwrap();
        }
        if has_notes {
            fs::write(target.join("notes.txt"), "mine").unwrap();
        }
        let barrier = Barrier::new(2);
        std::thread::scope(|scope| {
            for run in ["obj", "ply"] {
                let (target, barrier) = (&target, &barrier);
                scope.spawn(move || write(target, run, barrier).unwrap());
            }
        });
        let run = fs::read_to_string(target.join("report.json")).unwrap();
        let mut expected = files_of(&run);
        if has_notes {
            expected.insert("notes.txt".into());
        }
        assert_eq!(names(&target).into_iter().collect::<BTreeSet<_>>(), expected, "round {round}");
        for name in files_of(&run) {
            assert_eq!(fs::read_to_string(target.join(name)).unwrap(), run, "round {round}");
        }
        assert_eq!(names(place.path()), ["out"], "no litter");
    }
}
