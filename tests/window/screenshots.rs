//! The pictures in `screenshots/`, from the demo set:
//!
//! `cargo test --test window screenshots -- --ignored`

use std::path::Path;

use firstbounce::app::state::panel::PanelName;
use firstbounce::app::state::session::Open;
use firstbounce::app::state::surfaces::LayerName;
use firstbounce::app::window::commands::CommandId;

use crate::harness::Hands;

#[test]
#[ignore = "writes into screenshots/; run it by the command above"]
fn make_screenshots() {
    let mut hands = Hands::drawing();
    save(&mut hands, "start");

    let set = hands.demo();
    hands.open(Open::Set(set));
    hands.rest();
    step(&mut hands, PanelName::Captures);
    save(&mut hands, "captures");

    step(&mut hands, PanelName::Calibrate);
    save(&mut hands, "calibrate");

    step(&mut hands, PanelName::Separate);
    // A pixel near the crease, where there is indirect light to take out.
    hands.type_number("Column", "215");
    hands.type_number("Row", "150");
    save(&mut hands, "separate");

    step(&mut hands, PanelName::Shape);
    hands.wait_until("the surfaces in 3D", |session| {
        session.surfaces.is_at_rest() && session.surfaces.layer(LayerName::BEFORE).is_some()
    });
    step(&mut hands, PanelName::Shape);
    save(&mut hands, "shape");

    step(&mut hands, PanelName::Export);
    save(&mut hands, "export");

    hands.run(CommandId::ThemeLight);
    step(&mut hands, PanelName::Separate);
    save(&mut hands, "separate-light");
}

/// Opens a step and waits until all of it is there.
fn step(hands: &mut Hands, panel: PanelName) {
    hands.session().panel = panel;
    hands.rest();
    hands.harness.run_steps(4);
    hands.wait_until("all work to be done", |session| session.jobs.running().is_empty());
    // Pictures reach the card a little in each frame, and toasts go.
    for _ in 0..40 {
        hands.harness.run_steps(10);
    }
}

fn save(hands: &mut Hands, name: &str) {
    let picture = hands.harness.render().expect("a graphics adapter");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("screenshots");
    picture.save(folder.join(format!("{name}.png"))).expect("the folder screenshots/ can be written");
}
