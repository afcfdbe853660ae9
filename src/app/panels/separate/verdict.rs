//! The verdict in colour, sign and words, why, and what would be better.

use eframe::egui::{Color32, Frame, RichText, Stroke, Ui};
use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::Method;
use firstbounce_core::trust::{Advice, Level, Names, Trust};

use super::choose_order;
use crate::app::state::document::Document;
use crate::app::state::session::Session;
use crate::app::state::words::names;
use crate::app::widgets::advice::sentence;
use crate::app::widgets::theme::{self, Weight};

pub fn ui(ui: &mut Ui, trust: &Trust, document: &Document, session: &mut Session) {
    let set = &document.set;
    let (colours, lights) = names(set);
    let names = Names { colours: &colours, lights: &lights };
    let colour = colour_of(ui, trust.level);
    ui.add_space(4.0);
    Frame::group(ui.style()).stroke(Stroke::new(2.0, colour)).show(ui, |ui| {
        ui.set_width(ui.available_width());
        let verdict = format!("{} {}", sign(trust.level), title(trust.level));
        ui.label(RichText::new(verdict).semi_bold().size(17.0).color(colour));
        if trust.reasons.is_empty() {
            ui.label("Noise, calibration error and truncation bias are small.");
        }
        for (level, reason) in &trust.reasons {
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing.x = 4.0;
                ui.label(RichText::new(sign(*level)).color(colour_of(ui, *level)));
                ui.label(format!("{}.", sentence(&reason.words(&names))));
            });
        }
    });
    // The order m is no choice of the other methods.
    let is_open = |advice: &&Advice| document.method() == Method::Colours || !matches!(advice, Advice::Order { .. });
    let better: Vec<_> = trust.advice.iter().filter(is_open).collect();
    if !better.is_empty() {
        ui.add_space(4.0);
        ui.label(RichText::new("Better").semi_bold());
        for advice in better {
            line(ui, advice, &names, set, session);
        }
    }
    ui.add_space(4.0);
}

fn line(ui: &mut Ui, advice: &Advice, names: &Names, set: &CaptureSet, session: &mut Session) {
    ui.horizontal_wrapped(|ui| {
        ui.label(format!("\u{2022} {}.", sentence(&advice.words(names))));
        match advice {
            Advice::Order { bounces, .. } => {
                if ui.button(format!("Use m = {bounces}")).clicked() {
                    choose_order(session, *bounces);
                }
            }
            Advice::LeaveOut { colour, .. } => {
                let name = set.colours.get(*colour).map_or("", |colour| colour.name.as_str());
                if ui.button(format!("Leave out {name}")).clicked() {
                    session.edit(&format!("Leave out {name}"), |document| leave_out(&mut document.set, *colour));
                }
            }
            Advice::Pair { .. } | Advice::Frames { .. } | Advice::AnotherColour { .. } => {}
        }
    });
}

/// Takes a colour and its shots out of the set; the files stay on the disk.
fn leave_out(set: &mut CaptureSet, colour: usize) {
    let name = set.colours.remove(colour).name;
    set.shots.retain(|shot| shot.colour.as_ref() != Some(&name));
    let given = set.calibration.beta.iter_mut().chain(set.calibration.alpha.values_mut());
    given.filter(|values| colour < values.len()).for_each(|values| {
        values.remove(colour);
    });
    let colours = set.colours.len();
    set.separation.bounces = set.separation.bounces.map(|bounces| bounces.min(colours));
    set.separation.method = set.separation.method.filter(|method| method.impossible_for(set).is_none());
}

fn title(level: Level) -> &'static str {
    match level {
        Level::Fine => "Fine",
        Level::TakeCare => "Take care",
        Level::DoNotTrust => "Do not trust",
    }
}

fn sign(level: Level) -> &'static str {
    match level {
        Level::Fine => "\u{2714}",
        Level::TakeCare => "\u{26a0}",
        Level::DoNotTrust => "\u{2716}",
    }
}

fn colour_of(ui: &Ui, level: Level) -> Color32 {
    match level {
        Level::Fine => theme::fine(ui.visuals()),
        Level::TakeCare => ui.visuals().warn_fg_color,
        Level::DoNotTrust => ui.visuals().error_fg_color,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_colour_goes_with_its_shots_and_values() {
        let mut set = firstbounce_capture::CaptureSet::open(std::path::Path::new("assets/demo")).unwrap();
        set.calibration.beta = Some(vec![1.0, 0.5]);
        set.separation.bounces = Some(2);
        set.separation.method = Some(Method::ColoursAndShape);
        leave_out(&mut set, 1);
        assert_eq!((set.colours.len(), set.bounces()), (1, 1));
        assert!(set.shots.iter().all(|shot| shot.colour.as_deref() != Some("green")));
        assert_eq!(set.calibration.beta, Some(vec![1.0]));
        assert!(set.check().is_empty(), "{:?}", set.check());
    }
}
