//! The rows of subjects and balls agree with each other.

use crate::set::{Naming, SphereKind, Subject, Word};

#[test]
fn a_ball_and_the_shots_that_it_fills_name_each_other() {
    for &kind in SphereKind::ALL {
        assert_eq!(kind.subject().sphere_kind(), Some(kind));
    }
    let moved = |subject: &&Subject| subject.sphere_kind().is_some_and(|kind| kind.subject() != **subject);
    assert_eq!(Subject::ALL.iter().filter(moved).collect::<Vec<_>>(), [&Subject::MirrorSphereMoved]);
}

#[test]
fn what_is_photographed_in_every_colour_names_light_and_colour() {
    for subject in Subject::ALL.iter().filter(|subject| subject.is_matte()) {
        assert_eq!((subject.light(), subject.colour()), (Naming::Required, Naming::Required), "{subject}");
    }
}

#[test]
fn one_word_in_a_file_name_means_one_subject() {
    let names: Vec<&str> = Subject::ALL.iter().flat_map(|subject| subject.names()).copied().collect();
    let once = |name: &&str| names.iter().filter(|other| other == &name).count() == 1;
    assert!(names.iter().all(once), "{names:?}");
    let made_of: Vec<&str> = SphereKind::ALL.iter().flat_map(|kind| kind.made_of()).copied().collect();
    let once = |name: &&str| made_of.iter().filter(|other| other == &name).count() == 1;
    assert!(made_of.iter().all(once), "{made_of:?}");
}
