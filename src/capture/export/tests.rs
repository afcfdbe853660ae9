//! Results in folders that came from elsewhere: nothing outside is written, moved or deleted.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use firstbounce_testing::{There, everything_in};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use super::*;

/// Leads out of the folder, or is none of the program's files.
const FOREIGN: [&str; 8] =
    ["d/thesis.tex", "../thesis.tex", "thesis.tex", "/etc/x", "d/../../thesis.tex", "bounces-a/b.exr", "", ".."];
/// What results may find in the place of one of theirs.
const IN_FOLDER: [&str; 7] =
    ["report.json", "report.html", "mesh.obj", "mesh-raw.stl", "bounces-..exr", "d", ".firstbounce-abc.partial"];

/// A report of an earlier run that names these files, too.
fn report(files: &[&str]) -> String {
    let files: BTreeMap<_, _> = files.iter().map(|name| (*name, "a file")).collect();
    serde_json::json!({ "program": "Firstbounce 0.1.0", "files": files }).to_string()
}

fn report_of_everything() -> String {
    report(&[&FOREIGN[..], &IN_FOLDER[..]].concat())
}

/// Mostly `usual`: where everything is a link, the first is refused and the others are never come to.
fn mostly(usual: There) -> impl Strategy<Value = There> {
    let any = prop::sample::select(There::ALL.to_vec());
    prop_oneof![4 => Just(usual), 1 => any]
}

/// One of [`IN_FOLDER`] each.
fn any_contents() -> impl Strategy<Value = Vec<There>> {
    Vec::from(IN_FOLDER.map(|name| mostly(if name == "d" { There::LinkToFolder } else { There::File })))
}

/// What a set brings that looks like a killed run's staging folder.
#[derive(Clone, Copy, Debug)]
enum Planted {
    Nothing,
    /// Moves that this program would make.
    Right,
    /// Moves to and from where it makes none.
    ForeignNames,
    /// As `Right`, one of its parts a link to the folder outside.
    Linked(&'static str),
}

fn any_planted() -> impl Strategy<Value = Planted> {
    let parts = ["new", "replaced", "lock", "journal.json"].map(Planted::Linked);
    let others = [Planted::Nothing, Planted::Nothing, Planted::Right, Planted::ForeignNames];
    prop::sample::select([parts, others].concat())
}

/// A folder with something of every name that results have, as the user's own files would be.
fn outside(place: &Path) -> PathBuf {
    let outside = place.join("outside");
    for folder in ["new/d", "d"] {
        fs::create_dir_all(outside.join(folder)).unwrap();
    }
    for name in
        ["thesis.tex", "d/thesis.tex", "mesh.obj", "mesh-raw.stl", "report.html", "bounces-..exr", "new/mesh.obj"]
    {
        fs::write(outside.join(name), "mine").unwrap();
    }
    fs::write(outside.join("report.json"), report_of_everything()).unwrap();
    outside
}

#[cfg(unix)]
fn link(to: &Path, at: &Path) {
    std::os::unix::fs::symlink(to, at).unwrap();
}

#[cfg(unix)]
fn put(there: There, at: &Path, outside: &Path) {
    let name = at.file_name().unwrap().to_str().unwrap();
    let text = if name == "report.json" { report_of_everything() } else { "of the set".to_owned() };
    let elsewhere = if name == "report.json" { name } else { "thesis.tex" };
    there.put(at, &text, &outside.join(elsewhere));
}

#[cfg(unix)]
fn plant(planted: Planted, folder: &Path, outside: &Path) {
    let staging = folder.join(".firstbounce-planted.partial");
    let names: &[&str] = match planted {
        Planted::Nothing => return,
        Planted::ForeignNames => &FOREIGN,
        Planted::Right | Planted::Linked(_) => &["mesh.obj", "report.json"],
    };
    fs::create_dir_all(staging.join("new")).unwrap();
    fs::create_dir(staging.join("replaced")).unwrap();
    fs::write(staging.join("lock"), "").unwrap();
    fs::write(staging.join("new/mesh.obj"), "planted").unwrap();
    let journal = serde_json::json!({ "undo": false, "staged": names, "retired": ["mesh-raw.stl"] });
    fs::write(staging.join("journal.json"), journal.to_string()).unwrap();
    if let Planted::Linked(part) = planted {
        let path = staging.join(part);
        if path.is_dir() {
            fs::remove_dir_all(&path).unwrap();
            link(outside, &path);
        } else {
            fs::rename(&path, outside.join(part)).unwrap();
            link(&outside.join(part), &path);
        }
    }
}

/// Writes results as a run does.
fn write_results_into(set: &CaptureSet, target: &Path, names: &[&str]) -> Result<(), WriteError> {
    let folder = stage_results(set, target)?;
    for name in names {
        let text = if *name == "report.json" { report(names) } else { "a result".to_owned() };
        fs::write(folder.file(name)?, text).map_err(|reason| WriteError::Refused { path: name.into(), reason })?;
    }
    let names: Vec<_> = names.iter().map(|name| (*name).to_owned()).collect();
    commit_results(set, folder, names.iter())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[cfg(unix)]
    #[test]
    fn no_tree_of_links_in_a_set_leads_its_results_out_of_it(
        out in mostly(There::Folder),
        inside in any_contents(),
        planted in any_planted(),
        target in prop::sample::select(vec!["out", "out", "out/d", "out/d/../../out", "."]),
        has_capture_file in any::<bool>(),
    ) {
        let place = tempfile::tempdir().unwrap();
        let outside = outside(place.path());
        let folder = place.path().join("set");
        fs::create_dir(&folder).unwrap();
        if has_capture_file {
            fs::write(folder.join("capture.toml"), "").unwrap();
        }
        put(out, &folder.join("out"), &outside);
        if out == There::Folder {
            for (name, there) in IN_FOLDER.into_iter().zip(inside) {
                put(there, &folder.join("out").join(name), &outside);
            }
            plant(planted, &folder.join("out"), &outside);
        }
        let before = everything_in(&outside);
        let set = CaptureSet { folder: folder.clone(), ..CaptureSet::default() };
        for names in [&["report.json", "report.html", "mesh.obj"][..], &["report.json", "bounces-..exr"][..]] {
            // Whether they are refused is another question.
            let _ = write_results_into(&set, &folder.join(target), names);
            prop_assert_eq!(&everything_in(&outside), &before);
        }
    }
}

#[test]
fn a_report_from_elsewhere_takes_no_file_away_that_is_none_of_the_programs() {
    let place = tempfile::tempdir().unwrap();
    let out = place.path().join("out");
    fs::create_dir_all(out.join("d")).unwrap();
    for name in ["thesis.tex", "d/thesis.tex", "mesh-raw.stl", "bounces-..exr"] {
        fs::write(out.join(name), "there").unwrap();
    }
    fs::write(place.path().join("thesis.tex"), "there").unwrap();
    fs::write(out.join("report.json"), report_of_everything()).unwrap();
    let set = CaptureSet { folder: place.path().to_owned(), ..CaptureSet::default() };
    write_results_into(&set, &out, &["report.json", "mesh.obj"]).unwrap();
    for kept in ["thesis.tex", "d/thesis.tex", "../thesis.tex"] {
        assert_eq!(fs::read(out.join(kept)).unwrap(), b"there", "{kept}");
    }
    assert!(!out.join("mesh-raw.stl").exists() && !out.join("bounces-..exr").exists(), "those it could have written");
}

#[cfg(unix)]
#[test]
fn a_link_in_place_of_a_result_or_of_the_folder_is_refused_by_its_name() {
    let place = tempfile::tempdir().unwrap();
    let outside = outside(place.path());
    let set = CaptureSet { folder: place.path().join("set"), ..CaptureSet::default() };
    let out = set.folder.join("out");
    fs::create_dir_all(&out).unwrap();
    link(&outside.join("mesh.obj"), &out.join("mesh.obj"));
    let refused = write_results_into(&set, &out, &["report.json", "mesh.obj"]).unwrap_err();
    assert!(matches!(&refused, WriteError::Link { path } if path.ends_with("out/mesh.obj")), "{refused}");
    assert!(!out.join("report.json").exists(), "refused before anything is moved");

    link(&outside, &set.folder.join("results"));
    let refused = write_results_into(&set, &set.folder.join("results/inner"), &["report.json"]).unwrap_err();
    assert!(matches!(&refused, WriteError::Link { path } if path.ends_with("set/results")), "{refused}");
}

#[cfg(unix)]
#[test]
fn a_link_that_the_user_named_outside_any_set_is_followed() {
    let place = tempfile::tempdir().unwrap();
    let disk = place.path().join("disk");
    fs::create_dir(&disk).unwrap();
    link(&disk, &place.path().join("results"));
    let set = CaptureSet { folder: place.path().join("set"), ..CaptureSet::default() };
    write_results_into(&set, &place.path().join("results/vase"), &["report.json"]).unwrap();
    assert!(disk.join("vase/report.json").is_file() && place.path().join("results").is_symlink());
}
