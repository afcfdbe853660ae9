//! No number of the format harms: it is refused in a line, or everything that is computed from it comes to an end.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::path::Path;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::{
    Method, PipelineError, Preference, SolveOptions, Solved, Unattended, calibrate, solve,
};
use firstbounce_capture::set::{Encoding, Number, Projection, Reading};
use firstbounce_core::Plane;
use firstbounce_testing::write_tiny_set;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use tempfile::TempDir;
use toml_edit::{DocumentMut, Item, Table, Value};

/// Longer than any machine needs for pictures of 16 x 16 pixels.
const PATIENCE: Duration = Duration::from_secs(5);

static PLACE: LazyLock<TempDir> = LazyLock::new(|| {
    let place = tempfile::tempdir().unwrap();
    write_tiny_set(&place.path().join("set"));
    place
});

/// What the numbers of a set are for.
#[derive(Clone, Copy, Debug)]
enum Rig {
    /// Parallel rays, distant lamps, all values typed.
    Typed,
    /// A pinhole, near lamps, all values measured on balls.
    Measured,
}

/// A set whose text holds every number that the format knows.
fn text(rig: Rig) -> String {
    let mut set = CaptureSet::open(PLACE.path().join("set")).unwrap();
    let directions = [[-0.3, 0.1, 0.95], [0.3, 0.2, 0.9], [0.05, -0.35, 0.9]];
    set.separation.bounces = Some(2);
    set.calibration.grey_albedo = Some(0.18);
    set.spheres[0].diameter_mm = Some(10.0);
    set.shape.shadow_share = 0.1;
    set.shape.misfit_share = 0.2;
    (set.shape.rounds, set.shape.indirect_window_px) = (2, 7);
    set.camera.encoding = Some(Encoding::Gamma(1.0));
    set.shots.iter_mut().for_each(|shot| shot.encoding = Some(Encoding::Gamma(1.0)));
    match rig {
        Rig::Typed => {
            set.calibration.beta = Some(vec![1.0, 0.5]);
            set.calibration.white_light = Some(0.9);
            set.camera.crosstalk = Some(vec![vec![1.0, 0.02], vec![0.03, 1.0]]);
            for (l, (light, direction)) in set.lights.iter_mut().zip(directions).enumerate() {
                set.calibration.alpha.insert(light.name.clone(), vec![1.0, 2.0]);
                set.calibration.intensity.insert(light.name.clone(), 1.0);
                match l {
                    0 => light.direction = Some(direction),
                    _ => drop(set.calibration.direction.insert(light.name.clone(), direction)),
                }
            }
        }
        Rig::Measured => {
            set.camera.projection = Projection::Perspective {
                focal_length_px: 200.0,
                principal_point: Some([8.0, 8.0]),
                working_distance_mm: 1000.0,
            };
            set.camera.distortion = Some([-0.1, 0.02, 0.001, -0.002]);
            for (light, direction) in set.lights.iter_mut().zip(directions) {
                light.position_mm = Some(direction.map(|x| 800.0 * x));
            }
        }
    }
    assert_eq!(set.check(), []);
    // What has its default is left out; it is a number of the format all the same.
    let mut document: DocumentMut = set.to_toml().parse().unwrap();
    for shot in document["shot"].as_array_of_tables_mut().unwrap().iter_mut() {
        shot.entry("exposure").or_insert(toml_edit::value(1.0));
    }
    document.to_string()
}

/// Every number of a text: the keys and indices that lead to it.
fn numbers_of(text: &str) -> Vec<Vec<String>> {
    let mut document: DocumentMut = text.parse().unwrap();
    let mut paths = Vec::new();
    visit_table(document.as_table_mut(), &mut Vec::new(), &mut |path, _| paths.push(path.to_vec()));
    paths
}

/// The text with the number at a path replaced.
fn with(text: &str, path: &[String], number: &str) -> String {
    let mut document: DocumentMut = text.parse().unwrap();
    visit_table(document.as_table_mut(), &mut Vec::new(), &mut |at, value| {
        if at == path {
            *value = number.parse().unwrap();
        }
    });
    document.to_string()
}

type OnNumber<'f> = dyn FnMut(&[String], &mut Value) + 'f;

fn visit_table(table: &mut Table, path: &mut Vec<String>, on_number: &mut OnNumber) {
    for (key, item) in table.iter_mut() {
        path.push(key.get().to_owned());
        match item {
            Item::Table(table) => visit_table(table, path, on_number),
            Item::ArrayOfTables(tables) => {
                for (index, table) in tables.iter_mut().enumerate() {
                    path.push(index.to_string());
                    visit_table(table, path, on_number);
                    path.pop();
                }
            }
            Item::Value(value) => visit_value(value, path, on_number),
            Item::None => {}
        }
        path.pop();
    }
}

fn visit_value(value: &mut Value, path: &mut Vec<String>, on_number: &mut OnNumber) {
    match value {
        Value::Integer(_) | Value::Float(_) => on_number(path, value),
        Value::Array(items) => {
            for (index, item) in items.iter_mut().enumerate() {
                path.push(index.to_string());
                visit_value(item, path, on_number);
                path.pop();
            }
        }
        Value::InlineTable(table) => {
            for (key, item) in table.iter_mut() {
                path.push(key.get().to_owned());
                visit_value(item, path, on_number);
                path.pop();
            }
        }
        _ => {}
    }
}

/// The row of the table of ranges that a path belongs to; `None` for the schema.
fn number_of(path: &[String]) -> Option<Number> {
    let key = |name: &str| path.iter().any(|part| part == name);
    Some(match () {
        () if key("schema") => return None,
        () if key("gamma") => Number::Gamma,
        () if key("mm_per_pixel") => Number::MmPerPixel,
        () if key("diameter_mm") => Number::DiameterMm,
        () if key("focal_length_px") => Number::FocalLengthPx,
        () if key("principal_point") => Number::PrincipalPoint,
        () if key("working_distance_mm") => Number::WorkingDistanceMm,
        () if key("black_level") => Number::BlackLevel,
        () if key("white_level") => Number::WhiteLevel,
        () if key("full_well_electrons") => Number::FullWellElectrons,
        () if key("read_noise_electrons") => Number::ReadNoiseElectrons,
        () if key("crosstalk") => Number::Crosstalk,
        () if key("distortion") => Number::Distortion,
        () if key("direction") => Number::Direction,
        () if key("position_mm") => Number::PositionMm,
        () if key("exposure") => Number::Exposure,
        () if key("centre") => Number::Centre,
        () if key("radius") => Number::Radius,
        () if key("beta") => Number::Beta,
        () if key("alpha") => Number::Alpha,
        () if key("intensity") => Number::Intensity,
        () if key("grey_albedo") => Number::GreyAlbedo,
        () if key("white_light") => Number::WhiteLight,
        () if key("bounces") => Number::Bounces,
        () if key("shadow_share") => Number::ShadowShare,
        () if key("misfit_share") => Number::MisfitShare,
        () if key("rounds") => Number::Rounds,
        () if key("indirect_window_px") => Number::IndirectWindowPx,
        () => panic!("{path:?} is not in the table of ranges"),
    })
}

/// Paths without those that are like another one: of the many shots, two of each subject will do.
fn distinct(text: &str) -> Vec<Vec<String>> {
    let mut seen = std::collections::HashMap::new();
    let kind = |path: &[String]| {
        let subject = (path[0] == "shot").then(|| {
            let document: DocumentMut = text.parse().unwrap();
            document["shot"].as_array_of_tables().unwrap().get(path[1].parse().unwrap()).unwrap()["subject"].to_string()
        });
        (path.iter().filter(|part| part.parse::<usize>().is_err()).cloned().collect::<Vec<_>>(), subject)
    };
    let mut paths = numbers_of(text);
    paths.retain(|path| {
        let count = seen.entry(kind(path)).or_insert(0);
        *count += 1;
        *count <= 2
    });
    paths
}

fn written(number: f64) -> String {
    match number {
        number if number.is_nan() => "nan".into(),
        number if number.is_infinite() => if number > 0.0 { "inf" } else { "-inf" }.into(),
        number => format!("{number:?}"),
    }
}

/// What a number is replaced by: the extremes of all numbers, and those of its range.
fn values_of(number: Option<Number>) -> Vec<String> {
    let mut floats = vec![
        0.0,
        -0.0,
        f64::from_bits(1),
        f64::MIN_POSITIVE,
        1e-300,
        1e160,
        f64::MAX,
        -f64::MAX,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
    ];
    let Some(number) = number.filter(|number| *number != Number::Bounces) else {
        let whole = ["0", "1", "2", "16", "17", "-1", "9223372036854775807", "-9223372036854775808"];
        return whole.map(str::to_owned).into_iter().chain(floats.into_iter().map(written)).collect();
    };
    let (low, high) = number.range().into_inner();
    floats.extend([low, low.next_down(), low.next_up(), high, high.next_down(), high.next_up()]);
    floats.into_iter().map(written).collect()
}

/// What came of a set: refused by the reader, refused on the way, or solved.
fn outcome(text: &str) -> Result<Solved, String> {
    let since = Instant::now();
    let reading = Reading::of(text, &PLACE.path().join("set/capture.toml"));
    let refused = reading.problems.first().map(|problem| problem.to_string());
    // A window asks these of a set that has problems too.
    let _ = (reading.set.warnings(), reading.set.to_toml(), reading.set.tables(&reading.problems));
    let result = match refused {
        Some(line) => Err(line),
        None => run(&reading.set).map_err(|error| error.to_string()),
    };
    assert!(since.elapsed() < PATIENCE, "{:?}\n{text}", since.elapsed());
    if let Err(line) = &result {
        assert!(line.lines().count() == 1 && line.len() < 400, "{line}");
    }
    result
}

fn run(set: &CaptureSet) -> Result<Solved, PipelineError> {
    calibrate(set, Preference::Balls, &Unattended)?;
    solve(set, &SolveOptions { method: Method::Colours, ..SolveOptions::default() }, &Unattended)
}

fn is_finite(plane: &Plane) -> bool {
    plane.data().iter().all(|value| value.is_finite())
}

fn assert_finite(solved: &Solved, text: &str) {
    for separation in &solved.separated.lights {
        assert!(separation.bounces.iter().all(is_finite), "a bounce is not finite\n{text}");
    }
    let Ok(surfaced) = &solved.after else { return };
    let normals = &surfaced.shape.normals;
    assert!(
        is_finite(&normals.albedo) && [normals.map.x(), normals.map.y(), normals.map.z()].into_iter().all(is_finite),
        "{text}"
    );
    assert!(is_finite(&surfaced.shape.depth.depth_mm), "{text}");
    assert!(surfaced.mesh.positions.iter().all(|position| position.coords.iter().all(|x| x.is_finite())), "{text}");
}

#[test]
fn every_number_of_the_format_has_a_row_in_the_table_of_ranges() {
    let all = [text(Rig::Typed), text(Rig::Measured)].map(|text| numbers_of(&text)).concat();
    let rows: Vec<Number> = all.iter().filter_map(|path| number_of(path)).collect();
    for number in Number::ALL {
        assert!(rows.contains(&number), "no set of this test gives {number:?}");
    }
}

fn one_number_at_its_extremes(rig: Rig) {
    let text = text(rig);
    assert!(outcome(&text).is_ok_and(|solved| solved.after.is_ok()), "{rig:?}: {:?}", outcome(&text).err());
    for path in distinct(&text) {
        let number = number_of(&path);
        for value in values_of(number) {
            let changed = with(&text, &path, &value);
            let outcome = outcome(&changed);
            let place = path.join(".");
            match value.parse::<f64>() {
                // A direction or position may lie at any end, if not everywhere at zero.
                Ok(float) if number.is_some_and(|number| !number.allows(float)) => {
                    let line = outcome.err().unwrap_or_else(|| panic!("{place} = {value} is taken"));
                    assert!(line.contains("expected"), "{place} = {value}: {line}");
                }
                _ => outcome.iter().for_each(|solved| assert_finite(solved, &changed)),
            }
        }
    }
}

#[test]
fn no_number_of_a_typed_rig_panics_or_hangs() {
    one_number_at_its_extremes(Rig::Typed);
}

#[test]
fn no_number_of_a_measured_rig_panics_or_hangs() {
    one_number_at_its_extremes(Rig::Measured);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, rng_seed: RngSeed::Fixed(7), ..ProptestConfig::default() })]

    /// Whatever is computed from numbers within their ranges is a number.
    #[test]
    fn numbers_at_the_ends_of_their_ranges_together_stay_numbers(
        near in any::<bool>(), ends in prop::collection::vec(0..12u8, 200),
    ) {
        let mut text = text(if near { Rig::Measured } else { Rig::Typed });
        for (path, end) in numbers_of(&text).iter().zip(ends) {
            let Some(number) = number_of(path) else { continue };
            let is_reference = ["beta", "alpha"].contains(&path[1].as_str()) && path.last().is_some_and(|last| last == "0");
            let (low, high) = number.range().into_inner();
            match end {
                _ if number == Number::Bounces || is_reference => {}
                0 => text = with(&text, path, &written(low)),
                1 => text = with(&text, path, &written(high)),
                _ => {}
            }
        }
        if let Ok(solved) = outcome(&text) {
            assert_finite(&solved, &text);
        }
    }
}

#[test]
fn the_numbers_that_once_hung_or_panicked_are_refused_in_the_line_where_they_stand() {
    let typed = text(Rig::Typed);
    for (key, path, value, expected) in [
        (
            "beta",
            "calibration.beta.1",
            "1e300",
            "[calibration] beta: expected a number from 0.0001 to 10000, found 1e300",
        ),
        (
            "alpha",
            "calibration.alpha.light1.1",
            "1e-300",
            "alpha.light1: expected a number from 0.0001 to 10000, found 1e-300",
        ),
        (
            "exposure",
            "shot.0.exposure",
            "1e-300",
            "[[shot]] exposure: expected a number from 1e-9 to 1000000000, found 1e-300",
        ),
        ("white_level", "camera.white_level", "1e-300", "white_level: expected a number from 1e-9"),
        (
            "gamma",
            "camera.encoding.gamma",
            "1e-300",
            "[camera] encoding: expected a number from 0.1 to 10, found 1e-300",
        ),
    ] {
        let changed = with(&typed, &path.split('.').map(str::to_owned).collect::<Vec<_>>(), value);
        let line = 1 + changed[..changed.find(value).unwrap()].matches('\n').count();
        let error = CaptureSet::parse(&changed, Path::new("set/capture.toml")).unwrap_err().to_string();
        assert!(error.starts_with(&format!("set/capture.toml:{line}: ")) && error.contains(expected), "{key}: {error}");
    }
    let far = with(&text(Rig::Measured), &["light", "0", "position_mm", "0"].map(str::to_owned), "1e160");
    let error = CaptureSet::parse(&far, Path::new("set/capture.toml")).unwrap_err().to_string();
    assert!(error.contains("position_mm: expected three numbers [x, y, z] from -10000000 to 10000000"), "{error}");
}
