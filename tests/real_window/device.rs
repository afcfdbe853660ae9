//! A graphics driver that stops takes nothing with it.

use crate::desktop::{Desktop, Program};

fn lose_device(program: &Program) {
    program.reader.press("Help");
    program.reader.press("Lose the graphics device");
}

#[test]
#[cfg_attr(not(debug_assertions), ignore = "only a build for development can lose its device at will")]
fn a_lost_device_costs_neither_the_set_nor_its_unsaved_edits() {
    let test = "a_lost_device_costs_neither_the_set_nor_its_unsaved_edits";
    let Some(desktop) = Desktop::new(test) else { return };
    let Some(program) = desktop.start(test, &[]) else { return };
    program.reader.press("Open the demo");
    program.reader.press("3  Separate");
    program.reader.set("beta of green", 0.6);
    program.reader.read("Use the measured beta");
    // Notices go by themselves; their lines stay in the log.
    program.reader.press("Log");

    lose_device(&program);
    program.reader.read("The window goes on");
    assert!((program.reader.value("beta of green") - 0.6).abs() < 1e-6);
    program.reader.press("Edit");
    program.reader.press("Undo: Type beta of green");
    program.reader.wait_for("the typed beta to be gone", |widgets| {
        widgets.iter().all(|widget| widget.name != "Use the measured beta").then_some(())
    });
}
