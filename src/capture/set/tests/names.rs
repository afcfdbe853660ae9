//! Questions that the rest of the program asks of a set.

use std::path::Path;

use super::{FULL, parse};
use crate::set::{Channel, Circle, Encoding, Sphere, SphereKind, Subject, Word};

#[test]
fn paths_start_from_the_folder_of_the_file() {
    let set = parse(FULL);
    assert_eq!(set.folder, Path::new("set"));
    assert_eq!(set.resolve("object/left-1.png"), Path::new("set/object/left-1.png"));
    assert_eq!(set.resolve("/elsewhere/top.png"), Path::new("/elsewhere/top.png"));
    assert_eq!(set.truth_normals(), Path::new("set/truth/normals.exr"));
    assert_eq!(set.truth_depth(), Path::new("set/truth/depth.exr"));
    assert_eq!(set.truth_bounce(2, "top right"), Path::new("set/true/top right/2.exr"));
}

#[test]
fn shots_are_found_by_subject_light_and_colour() {
    let set = parse(FULL);
    let shot = set.shot(Subject::Object, Some("top right"), Some("green")).unwrap();
    assert_eq!(shot.files, ["../top.png"]);
    assert_eq!((set.encoding_of(shot), set.channel_of(shot)), (Some(Encoding::Srgb), Channel::G));
    let mirror = set.shot(Subject::MirrorSphere, Some("left"), None).unwrap();
    assert_eq!((set.encoding_of(mirror), set.channel_of(mirror)), (Some(Encoding::Gamma(2.2)), Channel::Grey));
    assert!(set.shot(Subject::MaterialSphere, Some("left"), Some("blue")).is_none());
    use Subject::{Dark, FlatField, GreySphere, MirrorSphere, Object};
    assert_eq!(set.subjects(), [Object, GreySphere, MirrorSphere, Dark, FlatField]);
    assert_eq!(
        (set.light_index("top right"), set.colour_index("green"), set.light_index("low")),
        (Some(1), Some(1), None)
    );
}

#[test]
fn a_file_that_several_shots_name_is_listed_once() {
    let set = parse(FULL);
    let files = set.distinct_files();
    assert_eq!(files["object/left-1.png"], [0, 1]);
    assert_eq!(files["object/left-2.png"], [0]);
    assert_eq!(files.len(), 9);
}

#[test]
fn balls_in_the_scene_are_told_from_balls_by_themselves() {
    let mut set = parse(FULL);
    let scene: Vec<SphereKind> = set.spheres_in(Subject::Object).map(|sphere| sphere.kind).collect();
    assert_eq!(scene, [SphereKind::Mirror]);
    assert_eq!(set.circle(Subject::GreySphere, SphereKind::Grey).unwrap().radius, 83.3);
    assert_eq!(set.circle(Subject::Object, SphereKind::Grey), None);
    let circle = Circle { centre: [1.0, 2.0], radius: 3.0 };
    set.put_sphere(Sphere { subject: Subject::GreySphere, kind: SphereKind::Grey, circle, diameter_mm: None });
    assert_eq!((set.circle(Subject::GreySphere, SphereKind::Grey), set.spheres.len()), (Some(circle), 2));
}

#[test]
fn the_direction_typed_at_the_light_wins_and_is_a_unit_vector() {
    let mut set = parse(FULL);
    let unit = |d: [f64; 3]| (d.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-12;
    let direction = set.given_direction("left").unwrap();
    assert!(unit(direction) && (direction[0] / direction[2] - -0.27 / 0.96).abs() < 1e-12);
    set.lights[0].direction = None;
    let direction = set.given_direction("left").unwrap();
    assert!(unit(direction) && (direction[0] / direction[2] - -0.269 / 0.961).abs() < 1e-12);
    assert_eq!(set.given_direction("top right"), None);
}

#[test]
fn the_order_is_two_bounces_where_the_file_leaves_it_open_and_the_colours_allow() {
    let mut set = parse(FULL);
    set.separation.bounces = None;
    assert_eq!(set.bounces(), 2);
    set.colours.truncate(1);
    assert_eq!(set.bounces(), 1);
}

#[test]
fn a_new_name_reaches_everything_that_used_the_old_one() {
    let mut set = parse(FULL);
    set.rename_light(0, "west");
    set.rename_colour(1, "teal");
    assert!(set.check().is_empty(), "{:?}", set.check());
    assert!(set.shot(Subject::Object, Some("west"), Some("teal")).is_some());
    assert_eq!(set.calibration.alpha["west"], [1.0, 3.2]);
}

#[test]
fn every_word_is_read_back_as_what_it_names() {
    fn read_back<W: Word + PartialEq + std::fmt::Debug>() {
        for choice in W::ALL {
            assert_eq!(W::from_word(choice.word()), Some(*choice));
        }
    }
    read_back::<Subject>();
    read_back::<SphereKind>();
    read_back::<Channel>();
}
