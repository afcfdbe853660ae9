//! The pictures in `screenshots/`, from the demo set:
//!
//! `cargo test --test window screenshots -- --ignored`

use std::path::Path;

use firstbounce::app::state::layout::Shown;
use firstbounce::app::state::panel::PanelName;
use firstbounce::app::state::results::{Of, Plain, ShotName, SurfaceName};
use firstbounce::app::state::session::Open;
use firstbounce::app::state::surfaces::LayerName;
use firstbounce_capture::set::Subject;

use crate::harness::Hands;

#[test]
#[ignore = "writes into screenshots/; run it by the command above"]
fn make_screenshots() {
    let mut hands = Hands::drawing();
    save(&mut hands, "start");

    let set = hands.demo();
    hands.open(Open::Set(set));
    hands.rest();
    step(&mut hands, PanelName::Captures, photo(Subject::Object));
    save(&mut hands, "captures");

    step(&mut hands, PanelName::Calibrate, photo(Subject::GreySphere));
    save(&mut hands, "calibrate");

    step(&mut hands, PanelName::Separate, Plain::Direct.of(Of::light("left")).into());
    // A pixel near the crease, where there is indirect light to take out.
    hands.type_number("Column", "215");
    hands.type_number("Row", "150");
    save(&mut hands, "separate");

    step(&mut hands, PanelName::Shape, Shown::Normals(SurfaceName::After));
    save(&mut hands, "shape");

    step(&mut hands, PanelName::Shape, Shown::Surface);
    hands.wait_until("the surface in 3D", |session| {
        session.surfaces.is_at_rest() && session.surfaces.layer(LayerName::AFTER).is_some()
    });
    save(&mut hands, "surface");
}

fn photo(subject: Subject) -> Shown {
    Shown::Photo(ShotName { subject, light: Some("left".into()), colour: Some("blue".into()) })
}

/// Opens a step with a picture and waits until all of it is there.
fn step(hands: &mut Hands, panel: PanelName, shown: Shown) {
    hands.session().panel = panel;
    hands.session().views.show(shown);
    hands.rest();
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
