//! FORMAT.md against reports: every key of a report is described, and every key described is in a report.

use std::collections::BTreeSet;
use std::fs;

use serde_json::Value;

use crate::run::firstbounce;
use crate::tiny_set;

const PAGE: &str = include_str!("../../src/capture/FORMAT.md");

/// The keys in the first column of the table of `section`, segment by segment: `*` is any name, `[]` any entry.
fn described(section: &str) -> BTreeSet<Vec<&'static str>> {
    let section = PAGE.split("\n## ").find(|text| text.starts_with(section)).unwrap();
    let cells = section.lines().filter(|line| line.starts_with("| `")).map(|line| line.split(" | ").next().unwrap());
    let keys = cells.flat_map(|cell| cell.split('`').skip(1).step_by(2));
    keys.map(|key| key.split('.').flat_map(|part| part.split_inclusive("[]").flat_map(entry)).collect()).collect()
}

/// `reasons[]` is an entry of `reasons`.
fn entry(part: &'static str) -> Vec<&'static str> {
    part.strip_suffix("[]").map_or(vec![part], |list| vec![list, "[]"])
}

/// The paths of all values, and of what is null or empty.
fn paths(value: &Value, path: &mut Vec<String>, found: &mut Vec<Vec<String>>) {
    let inner: Vec<(String, &Value)> = match value {
        Value::Object(map) => map.iter().map(|(key, value)| (key.clone(), value)).collect(),
        Value::Array(list) => list.iter().filter(|v| v.is_object()).map(|value| ("[]".to_owned(), value)).collect(),
        _ => vec![],
    };
    if inner.is_empty() {
        found.push(path.clone());
    }
    for (key, value) in inner {
        path.push(key);
        paths(value, path, found);
        path.pop();
    }
}

fn fits(key: &[&str], path: &[String]) -> bool {
    key.iter().zip(path).all(|(key, part)| *key == "*" || key == part)
}

#[test]
fn the_page_describes_the_keys_of_a_report_and_no_other() {
    let place = tempfile::tempdir().unwrap();
    let set = tiny_set::write(place.path());
    let text = fs::read_to_string(set.join("capture.toml")).unwrap();
    // One file as two repeats is a capture warning.
    let file = "\"grey-sphere/left-blue.png\"";
    let text = text.replace(file, &format!("{file}, {file}"));
    // Colours that the paint reflects almost alike: the verdict has its reasons.
    fs::write(set.join("capture.toml"), format!("{text}\n[calibration]\nbeta = [1.0, 0.97]\n")).unwrap();
    let export = ["solve", "tiny", "--json", "--triangles", "200", "--depth-png"];
    let nayar = ["--method", "nayar", "--grey-albedo", "0.4", "--patches", "100", "--iterations", "1"];
    let by_nayar = [&export[..], &nayar[..]].concat();
    let [colours, shape] = [&export[..], &by_nayar[..]].map(|run| firstbounce(place.path(), run).json());
    let many = firstbounce(place.path(), ["solve", "tiny", "--rig", "tiny", "--out", "many"]);
    assert_eq!(many.code, 0, "{}", many.err);
    let of_many = fs::read_to_string(place.path().join("many/tiny/report.json")).unwrap();
    let reports = [colours, shape, serde_json::from_str(&of_many).unwrap()];

    let described = described("report.json");
    let mut used = BTreeSet::new();
    for report in &reports {
        let mut found = Vec::new();
        paths(report, &mut Vec::new(), &mut found);
        for mut path in found {
            // Both surfaces have the same keys.
            if path[0] == "before" {
                path[0] = "shape".into();
            }
            // What is null or empty here may hold more elsewhere.
            let fitting: Vec<_> = described.iter().filter(|key| key.len() >= path.len() && fits(key, &path)).collect();
            assert!(!fitting.is_empty(), "{} is not in FORMAT.md", path.join("."));
            used.extend(fitting.into_iter().filter(|key| key.len() == path.len()));
        }
    }
    let whole: BTreeSet<_> = [vec!["shape"], vec!["before"]].into();
    let unused: Vec<_> = described.iter().filter(|key| !used.contains(key) && !whole.contains(*key)).collect();
    assert!(unused.is_empty(), "in FORMAT.md and in no report: {unused:?}");
}
