//! The window's numbers are the pipeline's.

use firstbounce::app::state::layout::Shown;
use firstbounce::app::state::results::{StageState, Step};
use firstbounce::app::views::picture;
use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::{SolveOptions, Unattended, solve};

use crate::harness::Hands;

#[test]
fn bounces_drawn_from_the_photos_are_those_that_are_saved() {
    let mut hands = Hands::with_demo_by_colours();
    hands.rest();
    let document = hands.session().document();
    let results = &hands.session().results;
    let separated = results.separated().unwrap();
    for (light, separation) in document.set.lights.iter().zip(&separated.lights) {
        for (k, saved) in (1..).zip(&separation.bounces) {
            let drawn = picture(&Shown::Bounce { light: light.name.clone(), k }, &document, results).unwrap();
            for y in (0..saved.height()).step_by(7) {
                for x in (0..saved.width()).step_by(5).filter(|x| separation.marks.at(*x, y) == 0) {
                    let difference = (drawn.source.values_at(x, y)[0] - saved.at(x, y)).abs();
                    assert!(difference < 1e-3, "{} bounce {k} at {x}, {y}: {difference}", light.name);
                }
            }
        }
    }
}

#[test]
fn a_typed_beta_is_in_force_in_the_same_frame() {
    let mut hands = Hands::with_demo();
    hands.rest();
    hands.session().edit("Type beta", |document| document.set.calibration.beta = Some(vec![1.0, 0.97]));
    let document = hands.session().document();
    let rig = hands.session().results.rig(&document);
    assert_eq!(rig.beta, Some(vec![1.0, 0.97]));
    // sqrt(1 + beta^4) / (beta (1 - beta)): the gain of equal noise.
    let expected = (1.0 + 0.97_f64.powi(4)).sqrt() / (0.97 * 0.03);
    assert!((rig.system("left").unwrap().gain[0] / expected - 1.0).abs() < 1e-9);
}

#[test]
fn the_window_computes_what_the_command_line_computes() {
    let mut hands = Hands::with_demo();
    let set = CaptureSet::open(hands.session().document().set.folder.clone()).unwrap();
    let solved = solve(&set, &SolveOptions::default(), &Unattended).unwrap();
    hands.rest();
    let results = &hands.session().results;
    assert_eq!(results.calibration().unwrap().calibrated, solved.calibrated);
    assert_eq!(results.separated().unwrap().lights, solved.separated.lights);
    let after = solved.after.unwrap();
    assert_eq!(results.shapes().unwrap().after.normals, after.shape.normals);
    assert_eq!(results.meshes().unwrap().after, after.mesh);
}

#[test]
fn a_set_with_errors_opens_and_tells_each_where_it_is() {
    let mut hands = Hands::new();
    let set = hands.demo();
    std::fs::write(set.join("object/left-green.png"), "no picture").unwrap();
    let text = std::fs::read_to_string(set.join("capture.toml")).unwrap();
    std::fs::write(
        set.join("capture.toml"),
        format!("{text}\n[[shot]]\nsubject = \"object\"\nlight = \"lfet\"\ncolour = \"blue\"\nfiles = [\"x.png\"]\n"),
    )
    .unwrap();
    hands.open(firstbounce::app::state::session::Open::Set(set));
    assert!(hands.session().is_open());
    assert!(hands.session().problems().iter().any(|problem| problem.message.contains("did you mean \"left\"?")));
    hands.rest();
    let session = hands.session();
    let loaded = session.results.loaded().unwrap();
    let bad: Vec<_> = loaded.shots.iter().filter(|shot| shot.photo.is_err()).collect();
    assert_eq!(bad.len(), 2);
    assert!(loaded.shots.iter().any(|shot| shot.photo.is_ok()));
    let document = session.document();
    assert!(matches!(session.results.state(Step::Separate, &document), StageState::Blocked { .. }));
}

#[test]
fn renaming_a_light_decodes_no_photo_again() {
    let mut hands = Hands::with_demo();
    hands.rest();
    let decoded = hands.session().results.decoded_files();
    let files = hands.session().document().set.distinct_files().len();
    assert_eq!(decoded, files);
    let name = hands.session().document().set.lights[0].name.clone();
    hands.session().edit("Rename light", |document| document.set.rename_light(0, "renamed"));
    hands.rest();
    let loaded = hands.session().results.loaded().unwrap();
    assert!(loaded.shots.iter().all(|shot| shot.name.light.as_ref() != Some(&name)));
    assert_eq!(hands.session().results.decoded_files(), files);
}
