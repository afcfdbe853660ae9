//! The method in force: chosen in Separate, kept in capture.toml, shown while it computes, and what the command line computes.

use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};
use firstbounce::app::state::document::VIEW_FILE;
use firstbounce::app::state::layout::Shown;
use firstbounce::app::state::panel::PanelName;
use firstbounce::app::state::results::{Of, Plain, StageState, Step, SurfaceName};
use firstbounce::app::state::session::Open;
use firstbounce::app::views::picture;
use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::{
    Method, PhotoStore, Preference, SolveOptions, Source, Unattended, calibrate_also_on_object, solve,
};
use firstbounce_capture::set::Subject;
use firstbounce_core::stereo::normals::Paint;
use firstbounce_testing::write_tiny_set;

use crate::harness::Hands;

const PREVIEW: &str = "preview: one colour ratio a light";

fn at(mut hands: Hands, panel: PanelName) -> Hands {
    hands.rest();
    hands.session().panel = panel;
    hands.steps();
    hands
}

fn choose(hands: &mut Hands, radio: &str) {
    hands.harness.get_by_role_and_label(Role::RadioButton, radio).click_accesskit();
    hands.steps();
}

fn is_disabled(hands: &Hands, radio: &str) -> bool {
    hands.harness.get_by_role_and_label(Role::RadioButton, radio).accesskit_node().is_disabled()
}

fn saved(hands: &mut Hands) -> String {
    hands.press(Modifiers::COMMAND, Key::S);
    let file = hands.session().document().set.file_path();
    std::fs::read_to_string(file).expect("the set was saved")
}

/// What the picture in view says of itself.
fn description(hands: &Hands, picture: &str) -> String {
    let canvas = hands.harness.get_by_role_and_label(Role::Image, picture);
    canvas.accesskit_node().description().unwrap_or_default()
}

#[test]
fn a_method_that_is_chosen_is_previewed_computed_saved_and_undone() {
    let mut hands = at(Hands::with_demo_by_colours(), PanelName::Separate);
    hands.click_button("Show direct light, left");
    let by_colours = hands.session().results.method_light().unwrap();
    assert!(
        hands.sees("Separated by the paper's method") && !description(&hands, "Direct light, left").contains("preview")
    );

    choose(&mut hands, "Colours and shape");
    assert_eq!(hands.session().document().method(), Method::ColoursAndShape);
    assert!(hands.sees("Separating by colours and shape"));
    assert_eq!(description(&hands, "Direct light, left"), PREVIEW);
    hands.rest();
    assert!(hands.sees("Separated by colours and shape"));
    assert!(!description(&hands, "Direct light, left").contains("preview"));

    // The preview is a plain fit; what is computed has less noise, and more to show.
    for shown in ["indirect light, left", "ratio of indirect light, left, green", "amount of indirect light, left"] {
        hands.click_button(&format!("Show {shown}"));
    }
    assert!(hands.sees("Picture: Amount of indirect light, left"));
    assert!(saved(&mut hands).contains("method = \"colours-and-shape\""));
    hands.press(Modifiers::COMMAND, Key::Z);
    assert_eq!(hands.session().document().method(), Method::Colours);
    hands.rest();
    assert_eq!(hands.session().results.method_light().unwrap().direct[0].light, by_colours.direct[0].light);
}

#[test]
fn every_method_in_force_gives_what_the_command_line_gives() {
    let mut hands = Hands::with_demo();
    hands.session().edit("Make it quick", |document| {
        (document.settings.nayar.patches, document.settings.nayar.max_iterations) = (150, 2);
        document.set.calibration.grey_albedo = Some(0.6);
    });
    for method in Method::ALL {
        hands.choose_method(method);
        hands.rest();
        let document = hands.session().document();
        let results = &hands.session().results;
        assert_eq!(results.state(Step::Mesh, &document), StageState::Ready, "{method}");
        let finished = results.finished(SurfaceName::After, &document).expect("it is finished");
        let options = SolveOptions { nayar: document.settings.nayar.options(), ..SolveOptions::of(&document.set) };
        let solved = solve(&document.set, &options, &Unattended).unwrap();
        assert_eq!((&finished.set, &finished.options), (&solved.set, &solved.options));
        assert_eq!(finished.calibrated.beta, solved.calibrated.beta);
        assert_eq!(finished.separated.lights, solved.separated.lights);
        assert_eq!((&finished.indirect, &finished.report), (&solved.indirect, &solved.report));
        assert_eq!(finished.trust, solved.trust);
        let light = |direct: &firstbounce_capture::pipeline::Direct| direct.light.clone();
        assert!(finished.direct.iter().map(light).eq(solved.direct.iter().map(light)), "{method}");
        let normals =
            |solved: &firstbounce_capture::pipeline::Solved| solved.after.as_ref().unwrap().shape.normals.clone();
        assert!(normals(&finished) == normals(&solved), "{method}");
        assert_eq!(finished.before.as_ref().unwrap().shape.normals, solved.before.as_ref().unwrap().shape.normals);
        assert_eq!(results.surfaces(&document), [SurfaceName::After]);
    }
}

#[test]
fn every_other_method_is_compared_with_the_one_in_force() {
    let mut hands = Hands::with_demo();
    hands.session().edit("Compare them all", |document| {
        (document.settings.nayar.patches, document.settings.nayar.max_iterations) = (150, 2);
        document.set.calibration.grey_albedo = Some(0.6);
        Method::ALL.into_iter().for_each(|method| document.settings.compare(method, true));
    });
    for in_force in Method::ALL {
        hands.choose_method(in_force);
        hands.rest();
        let document = hands.session().document();
        let results = &hands.session().results;
        let others = Method::ALL.into_iter().filter(|method| *method != in_force).map(SurfaceName::By);
        let expected: Vec<_> = [SurfaceName::After].into_iter().chain(others).collect();
        assert_eq!(results.surfaces(&document), expected);
        // A method finds the same whether it is in force or compared.
        let normals = results.shape(SurfaceName::After).unwrap().normals.clone();
        let elsewhere = Method::ALL.into_iter().find(|method| *method != in_force).unwrap();
        hands.choose_method(elsewhere);
        hands.rest();
        assert!(hands.session().results.shape(SurfaceName::By(in_force)).unwrap().normals == normals, "{in_force}");
    }
}

#[test]
fn the_paint_is_chosen_saved_and_told() {
    let mut hands = at(Hands::with_demo(), PanelName::Shape);
    assert!(hands.sees("One paint: albedo"));
    hands.unfold("Lights and thresholds");
    choose(&mut hands, "Any paint");
    assert_eq!(hands.session().document().set.shape.paint, Paint::Any);
    hands.rest();
    assert!(hands.sees("Each pixel has its own albedo, as chosen."));
    assert!(saved(&mut hands).contains("paint = \"any\""));
    hands.press(Modifiers::COMMAND, Key::Z);
    assert_eq!(hands.session().document().set.shape.paint, Paint::Auto);
    hands.choose_method(Method::Colours);
    hands.rest();
    assert!(hands.sees("the paper's method looks for one paint only where \"One paint\" is chosen"));
}

#[test]
fn beta_without_a_ball_of_the_paint_is_measured_on_the_object() {
    let mut hands = Hands::with_demo();
    hands.rest();
    hands.session().edit("Leave the ball of the paint out", |document| {
        document.set.shots.retain(|shot| shot.subject != Subject::MaterialSphere);
    });
    let mut hands = at(hands, PanelName::Calibrate);
    let set = hands.session().document().set.clone();
    let by_command = calibrate_also_on_object(&set, Preference::File, &PhotoStore::default(), &Unattended).unwrap();
    let on_object = hands.session().results.calibration().unwrap();
    assert_eq!(on_object.calibrated.beta_values().unwrap(), by_command.beta_values().unwrap());
    let source = on_object.calibrated.beta.as_ref().map(|beta| beta[1].source);
    assert_eq!(source, Some(Source::Object));
    assert!(hands.session().results.method_light().is_some(), "the object is solved with it");
    assert!(hands.sees("measured on the object"), "Calibrate names where beta comes from");
}

#[test]
fn a_set_of_one_colour_offers_the_shape_alone_and_says_why() {
    let mut hands = Hands::new();
    let folder = hands.folder.path().join("set");
    write_tiny_set(&folder);
    CaptureSet::open(&folder).unwrap().in_one_colour().save().unwrap();
    hands.open(Open::Set(folder));
    let mut hands = at(hands, PanelName::Separate);
    assert!(is_disabled(&hands, "Colours and shape") && is_disabled(&hands, "Colours (the paper's bounces)"));
    assert!(hands.sees("It needs photos in two lamp colours or more"));
    choose(&mut hands, "Shape (Nayar, one colour)");
    assert_eq!(hands.session().document().method(), Method::Shape);
    assert!(hands.sees("Albedo of the grey ball") && !hands.sees("beta of"));
    choose(&mut hands, "None: all light counts as direct");
    assert_eq!(hands.session().document().set.separation.method, None);
    hands.rest();
    let (document, shown) = (hands.session().document(), Shown::from(Plain::Indirect.of(Of::light("light1"))));
    let why = picture(&shown, &document, &hands.session().results).unwrap_err().to_string();
    assert!(why.contains("colours and shape"), "{why}");
}

#[test]
fn the_method_in_force_is_not_compared_with_itself_and_old_settings_still_compare_nayars() {
    let mut hands = Hands::new();
    let set = hands.demo();
    std::fs::write(set.join(VIEW_FILE), r#"{ "settings": { "compared": ["nayar"] } }"#).unwrap();
    hands.open(Open::Set(set));
    let mut hands = at(hands, PanelName::Shape);
    let tick = |name: &str| format!("Also solve by {name}");
    assert!(hands.sees(&tick("Nayar's method")) && hands.sees(&tick("the paper's method")));
    assert!(!hands.sees(&tick("colours and shape")));
    assert_eq!(hands.session().document().compared().collect::<Vec<_>>(), [Method::Shape]);

    hands.choose_method(Method::Shape);
    assert!(!hands.sees(&tick("Nayar's method")) && hands.sees(&tick("colours and shape")));
    assert_eq!(hands.session().document().compared().count(), 0);
    let (document, shown) = (hands.session().document(), Shown::Normals(SurfaceName::By(Method::Shape)));
    let why = picture(&shown, &document, &hands.session().results).unwrap_err().to_string();
    assert!(why.contains("is the method in force"), "{why}");
}
