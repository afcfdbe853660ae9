//! From a camera's dump to a set with a scale, as a technician does it.

use std::fs;
use std::path::PathBuf;

use eframe::egui::accesskit::Role;
use egui_kittest::kittest::Queryable;
use firstbounce::app::state::results::Step;
use firstbounce::app::state::session::{Open, Session};
use firstbounce_capture::set::Projection;

use crate::harness::Hands;

/// The clicks of a person's hand: on a button, a box, a heading, or into a field before typing.
struct Clicks<'h> {
    hands: &'h mut Hands,
    count: usize,
}

impl Clicks<'_> {
    fn on(&mut self, role: Role, label: &str) {
        self.count += 1;
        self.hands.harness.get_by_role_and_label(role, label).click_accesskit();
        self.hands.steps();
    }

    fn unfold(&mut self, label: &str) {
        self.count += 1;
        self.hands.unfold(label);
    }

    fn type_into(&mut self, label: &str, text: &str) {
        self.count += 1;
        self.hands.type_into(label, text);
    }
}

/// The demo's 21 photos under the names of a camera, subject after subject.
fn dump(hands: &Hands) -> PathBuf {
    let demo = hands.demo();
    let folder = hands.folder.path().join("DCIM");
    fs::create_dir(&folder).unwrap();
    let lights = ["left", "right", "top"];
    let coloured = |subject: &'static str| {
        lights.iter().flat_map(move |light| ["blue", "green"].map(|colour| format!("{subject}/{light}-{colour}.png")))
    };
    let mirror = lights.iter().map(|light| format!("mirror-sphere/{light}.png"));
    let photos = ["object", "grey-sphere", "material-sphere"].into_iter().flat_map(coloured).chain(mirror);
    for (count, photo) in (1..).zip(photos) {
        fs::copy(demo.join(photo), folder.join(format!("IMG_{count:04}.png"))).unwrap();
    }
    folder
}

#[test]
fn a_camera_dump_of_21_files_is_a_solved_set_in_12_clicks_and_no_typing_but_names() {
    let mut hands = Hands::new();
    let folder = dump(&hands);
    hands.drop_files(&[folder]);
    let mut clicks = Clicks { hands: &mut hands, count: 0 };
    clicks.unfold("By the order in which they were taken");
    for subject in ["Grey ball", "Ball of the paint", "Mirror ball"] {
        clicks.on(Role::CheckBox, subject);
    }
    clicks.type_into("Lights in order", "left, right, top");
    clicks.type_into("Colours in order", "blue, green");
    clicks.on(Role::Button, "Assign these 21 files in order");
    clicks.on(Role::Button, "Add 21 files");
    let count = clicks.count;
    hands.rest();
    let document = hands.session().document();
    assert!(hands.session().results.current_meshes(&document).is_some(), "no surface: {:?}", {
        let results = &hands.session().results;
        [Step::Load, Step::Calibrate, Step::Separate, Step::Shape].map(|step| results.state(step, &document))
    });
    assert!(count <= 12, "{count} clicks");
}

#[test]
fn a_line_of_known_length_gives_the_scale_and_of_a_near_camera_the_distance() {
    let mut hands = Hands::with_demo();
    hands.rest();
    hands.session().edit("Forget the scale", |document| {
        document.set.camera.projection = Projection::Orthographic { mm_per_pixel: None };
    });
    hands.rest();
    hands.unfold("Camera and scale");
    hands.click_button("Draw a line of known length");
    let size = {
        let loaded = hands.session().results.loaded().unwrap();
        loaded.shots[0].photo.as_ref().unwrap().linear.size()
    };
    hands.drag_on_picture("Photo, left, blue", size, [[40.0, 50.0], [120.0, 110.0]]);
    assert!(hands.sees("The line is 100.0 px long."));
    hands.type_number("Its length in mm", "25");
    hands.click_button("Use 0.250000 mm per pixel");
    let scale = |hands: &mut Hands| hands.session().document().set.camera.projection;
    let Projection::Orthographic { mm_per_pixel: Some(scale_mm) } = scale(&mut hands) else { panic!("no scale") };
    assert!((scale_mm - 0.25).abs() < 0.0025, "{scale_mm}");

    hands.session().edit("A near camera", |document| {
        document.set.camera.projection =
            Projection::Perspective { focal_length_px: 2000.0, principal_point: None, working_distance_mm: 100.0 };
    });
    hands.steps();
    hands.click_button("Draw a line of known length");
    hands.drag_on_picture("Photo, left, blue", size, [[40.0, 50.0], [120.0, 110.0]]);
    hands.click_button("Use 0.250000 mm per pixel");
    let Projection::Perspective { working_distance_mm, .. } = scale(&mut hands) else { panic!("another camera") };
    assert!((working_distance_mm - 500.0).abs() < 5.0, "{working_distance_mm}");
}

#[test]
fn photos_that_arrive_in_a_watched_folder_join_the_set_when_their_light_is_complete() {
    let mut hands = Hands::new();
    let demo = hands.demo();
    let folder = hands.folder.path().join("tethered");
    fs::create_dir(&folder).unwrap();
    hands.open(Open::New(folder.clone()));
    hands.harness.get_by_role_and_label(Role::CheckBox, "Watch this folder").click_accesskit();
    hands.steps();
    let arrives = |name: &str| {
        fs::copy(demo.join("object").join(name), folder.join(name)).unwrap();
    };
    let lights = |session: &mut Session| {
        session.document().set.lights.iter().map(|light| light.name.clone()).collect::<Vec<_>>()
    };
    for name in ["left-blue.png", "left-green.png", "top-blue.png", "top-green.png"] {
        arrives(name);
    }
    hands.wait_until("two lights", |session| lights(session) == ["left", "top"]);
    arrives("right-blue.png");
    hands.wait_to_see("right-blue.png: Object right blue");
    assert_eq!(lights(hands.session()), ["left", "top"], "a light with one of two colours waits");
    arrives("right-green.png");
    hands.wait_until("the third light", |session| lights(session) == ["left", "top", "right"]);
    let set = hands.session().document().set.clone();
    assert!(set.check().is_empty(), "{:?}", set.check());
}
