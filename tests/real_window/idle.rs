//! The window answers by accessible name, and rests when nobody asks.

use std::time::Duration;

use crate::desktop::Desktop;
use crate::screen_reader::{IMAGE, steps_with_results};

/// Hundredths of a second of all cores in [`WATCHED`]: 2 % of one core.
const MOST_TICKS: u64 = 10;
const WATCHED: Duration = Duration::from_secs(5);
/// Notices go by themselves before.
const UNTIL_AT_REST: Duration = Duration::from_secs(8);

#[test]
fn the_real_window_opens_the_demo_by_name_and_rests_when_nothing_changes() {
    let test = "the_real_window_opens_the_demo_by_name_and_rests_when_nothing_changes";
    let Some(desktop) = Desktop::new(test) else { return };
    let Some(program) = desktop.start(test, &[]) else { return };
    let reader = &program.reader;
    reader.press("Open the demo");
    reader.wait_for("all five steps to be ready", |widgets| (steps_with_results(widgets) >= 5).then_some(()));
    for name in ["Surface in 3D, Before", "Surface in 3D, After"] {
        reader.wait_for(name, |widgets| {
            widgets.iter().find(|widget| widget.name == name && widget.role == IMAGE).cloned()
        });
    }
    reader.press("3  Separate");
    reader.wait_for("the photo", |widgets| {
        widgets.iter().find(|widget| widget.name == "Photo, left, blue" && widget.role == IMAGE).cloned()
    });
    reader.read("Gain of bounce 1");
    assert!((reader.value("beta of green") - 0.5).abs() < 0.05);

    // It paints only when something changes: a fact about repainting, not about speed.
    std::thread::sleep(UNTIL_AT_REST);
    let before = program.ticks();
    std::thread::sleep(WATCHED);
    let ticks = program.ticks() - before;
    assert!(ticks < MOST_TICKS, "{ticks} hundredths of a second of work in {} s of rest", WATCHED.as_secs());
}
