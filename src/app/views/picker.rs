//! The menu from which a view's picture is chosen.

use eframe::egui::Ui;
use firstbounce_capture::pipeline::Method;

use crate::app::state::document::Document;
use crate::app::state::layout::Shown;
use crate::app::state::results::{ShotName, SurfaceName};

/// The menu's entries, by group: what this set has, whether or not it is computed yet.
pub fn entries(document: &Document) -> Vec<(String, Vec<Shown>)> {
    let (set, compared) = (&document.set, &document.settings.compared);
    let mut groups = vec![("Surface".to_owned(), surface(compared))];
    let bounces = set.bounces();
    for light in &set.lights {
        let light = light.name.clone();
        let mut shown: Vec<_> = (1..=bounces).map(|k| Shown::Bounce { light: light.clone(), k }).collect();
        shown.push(Shown::Direct { light: light.clone() });
        shown.extend(compared.iter().map(|&method| Shown::DirectBy { method, light: light.clone() }));
        if bounces > 1 {
            shown.push(Shown::FigureOne { light: light.clone() });
        }
        shown.push(Shown::Sum { light: light.clone() });
        shown.push(Shown::Residual { light: light.clone() });
        shown.push(Shown::Noise { light: light.clone() });
        shown.push(Shown::Marks { light: light.clone() });
        groups.push((format!("Light {light}"), shown));
    }
    for subject in set.subjects() {
        let shots: Vec<_> = set.shots_of(subject).map(|shot| Shown::Photo(ShotName::of(shot))).collect();
        groups.push((format!("Photos, {subject}"), shots));
    }
    groups
}

fn surface(compared: &[Method]) -> Vec<Shown> {
    let others = compared.iter().map(|&method| SurfaceName::After(method));
    let names = [SurfaceName::AFTER, SurfaceName::Before].into_iter().chain(others);
    let each = |shown: fn(SurfaceName) -> Shown| names.clone().map(shown).collect::<Vec<_>>();
    [each(Shown::Normals), each(Shown::Albedo), each(Shown::NormalNoise), each(Shown::Depth)].concat()
}

/// The menu's content; the picture that was chosen in this frame.
pub fn ui(ui: &mut Ui, document: &Document, current: Option<&Shown>) -> Option<Shown> {
    let mut chosen = None;
    for (group, entries) in entries(document) {
        ui.menu_button(group, |ui| {
            for shown in entries {
                if ui.selectable_label(current == Some(&shown), shown.title()).clicked() {
                    chosen = Some(shown);
                    ui.close();
                }
            }
        });
    }
    chosen
}
