//! The light x colour tables, with a thumbnail and the exposure of every photo.

use std::sync::Arc;

use eframe::egui::{
    Align, Button, Color32, ColorImage, Image, ImageSource, Label, Layout, Rect, RichText, Role, TextureHandle,
    TextureOptions, Ui, Vec2, WidgetInfo, load::SizedTexture, vec2,
};
use firstbounce_capture::pipeline::{Exposed, region_of, thumbnail};
use firstbounce_capture::set::{CaptureSet, Encoding, Shot, ShotCell, ShotTable, Sphere};
use thiserror::Error;

use crate::app::base::jobs::Job;
use crate::app::base::keyed::Keyed;
use crate::app::state::layout::Shown;
use crate::app::state::log::Level;
use crate::app::state::results::{Loaded, ShotName};
use crate::app::state::session::Session;
use crate::app::widgets::theme::Weight;

const THUMBNAIL_PX: usize = 96;
const THUMBNAIL_POINTS: f32 = 64.0;
/// Of a light's name, and of a photo with what is said of it, in points.
const NAME: f32 = 72.0;
const CELL: Vec2 = vec2(124.0, 100.0);
/// Of a longer table only the rows in sight are laid out.
const MANY: usize = 40;
/// Shares above which a cell says that a photo is badly exposed.
const TOO_MUCH_CLIPPED: f64 = 0.02;
const TOO_MUCH_DARK: f64 = 0.5;

/// What is known of every photo.
#[derive(Default)]
pub struct Table {
    looks: Keyed<Key, Vec<Look>>,
    /// The last looks, with their pictures on the card.
    seen: Vec<(ShotName, Option<Exposed>, Option<TextureHandle>)>,
}

/// What the look at the photos depends on.
#[derive(Clone)]
struct Key {
    loaded: Arc<Loaded>,
    spheres: Vec<Sphere>,
}

impl PartialEq for Key {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.loaded, &other.loaded) && self.spheres == other.spheres
    }
}

/// One photo, looked at.
struct Look {
    name: ShotName,
    exposed: Option<Exposed>,
    small: Option<ColorImage>,
}

impl Table {
    pub fn ui(&mut self, ui: &mut Ui, session: &mut Session, selected: &mut Option<ShotName>) {
        self.look(ui, session);
        let document = session.document();
        for table in document.set.tables(session.problems()) {
            let title = table.subject.title();
            ui.label(RichText::new(title).semi_bold());
            self.grid(ui, session, &document.set, &table, selected);
            ui.add_space(6.0);
        }
    }

    fn grid(
        &self,
        ui: &mut Ui,
        session: &mut Session,
        set: &CaptureSet,
        table: &ShotTable,
        selected: &mut Option<ShotName>,
    ) {
        let width = NAME + CELL.x * table.columns.len() as f32;
        let within = |ui: &mut Ui, size: Vec2, content: &mut dyn FnMut(&mut Ui)| {
            ui.allocate_ui_with_layout(size, Layout::top_down(Align::Min), |ui| {
                ui.set_min_size(size);
                ui.set_max_width(size.x);
                content(ui);
            });
        };
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing.x = 0.0;
            within(ui, vec2(NAME, 0.0), &mut |_| {});
            for column in &table.columns {
                let channel = column.as_ref().and_then(|name| Some(set.colours.get(set.colour_index(name)?)?.channel));
                let text = column.as_deref().unwrap_or("any colour");
                let text = match channel {
                    Some(channel) => format!("{text} (channel {channel})"),
                    None => text.to_owned(),
                };
                within(ui, vec2(CELL.x, 0.0), &mut |ui| {
                    drop(ui.add(Label::new(&text).truncate()).on_hover_text(&text))
                });
            }
        });
        for row in &table.rows {
            let is_seen = ui.is_rect_visible(Rect::from_min_size(ui.cursor().min, vec2(width, CELL.y)));
            if table.rows.len() > MANY && !is_seen {
                ui.allocate_space(vec2(width, CELL.y));
                continue;
            }
            ui.horizontal_top(|ui| {
                ui.spacing_mut().item_spacing.x = 0.0;
                let light = row.light.as_deref().unwrap_or("no light");
                within(ui, vec2(NAME, CELL.y), &mut |ui| {
                    drop(ui.add(Label::new(light).truncate()).on_hover_text(light))
                });
                for (cell, colour) in row.cells.iter().zip(&table.columns) {
                    let name = ShotName { subject: table.subject, light: row.light.clone(), colour: colour.clone() };
                    within(ui, CELL, &mut |ui| self.cell(ui, session, set, &name, cell, selected));
                }
            });
        }
    }

    fn cell(
        &self,
        ui: &mut Ui,
        session: &mut Session,
        set: &CaptureSet,
        name: &ShotName,
        cell: &ShotCell,
        selected: &mut Option<ShotName>,
    ) {
        let Some(shot) = cell.shots.first().and_then(|&index| set.shots.get(index)) else {
            let text = if cell.problems.is_empty() { "none" } else { "missing" };
            let colour =
                if cell.problems.is_empty() { ui.visuals().weak_text_color() } else { ui.visuals().error_fg_color };
            ui.label(RichText::new(text).color(colour)).on_hover_text(cell.problems.join("\n"));
            return;
        };
        let loaded = session.results.loaded();
        let failed =
            loaded.as_ref().and_then(|loaded| loaded.shot(name)?.photo.as_ref().err()).map(ToString::to_string);
        let seen = self.seen.iter().find(|(known, ..)| known == name);
        let texture = seen.and_then(|(_, _, texture)| texture.as_ref());
        let wrong: Vec<&String> = cell.problems.iter().chain(&failed).collect();

        let title = Shown::Photo(name.clone()).title();
        let is_selected = selected.as_ref() == Some(name);
        let mut button = match texture {
            Some(texture) => {
                let size = texture.size_vec2();
                let points = size * (THUMBNAIL_POINTS / size.max_elem());
                Button::image(Image::new(ImageSource::Texture(SizedTexture::new(texture.id(), points))))
            }
            None => Button::new("no picture").min_size(vec2(THUMBNAIL_POINTS, THUMBNAIL_POINTS)),
        };
        button = button.selected(is_selected);
        if !wrong.is_empty() {
            button = button.fill(ui.visuals().error_fg_color.gamma_multiply(0.4));
        }
        let response = ui.add(button);
        response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_selected, format!("Select {title}")));
        let exposed = seen.and_then(|(_, exposed, _)| *exposed);
        let told = details(shot, exposed);
        ui.ctx().accesskit_node_builder(response.id, |node| node.set_description(told.clone()));
        if response.on_hover_text(told).clicked() {
            *selected = Some(name.clone());
            session.views.show(Shown::Photo(name.clone()));
        }
        let exposure = loaded.as_ref().and_then(|loaded| Some(loaded.shot(name)?.exposure));
        numbers(ui, shot, exposure, exposed);
        for line in wrong {
            ui.label(RichText::new(line).small().color(ui.visuals().error_fg_color));
        }
    }

    /// Looks at the photos again where they or the balls' circles have changed, on a worker.
    fn look(&mut self, ui: &Ui, session: &mut Session) {
        match self.looks.poll() {
            Some(Ok(looks)) => {
                let load =
                    |image: &ColorImage| ui.ctx().load_texture("thumbnail", image.clone(), TextureOptions::LINEAR);
                let seen = looks.iter().map(|look| (look.name.clone(), look.exposed, look.small.as_ref().map(load)));
                self.seen = seen.collect();
            }
            Some(Err(error)) => session.log.add(Level::Warning, error.to_string()),
            None => {}
        }
        let Some(loaded) = session.results.loaded() else { return };
        let document = session.document();
        let key = Key { loaded, spheres: document.set.spheres.clone() };
        if self.looks.wants(&key) {
            let of = key.clone();
            let task = session.jobs.start("Look at the photos", move |job| look_at(&document.set, &of.loaded, job));
            self.looks.start(key, task);
        }
    }
}

/// The files of a photo and how it is exposed.
fn details(shot: &Shot, exposed: Option<Exposed>) -> String {
    let files = shot.files.join("\n");
    match exposed {
        Some(Exposed { clipped, dark, mean, .. }) => format!(
            "{files}\nclipped {:.1} %, dark {:.1} %, mean light {mean:.4} of the white level",
            100.0 * clipped,
            100.0 * dark
        ),
        None => files,
    }
}

/// What is out of the ordinary: clipped, dark, another exposure, repeats.
fn numbers(ui: &mut Ui, shot: &Shot, exposure: Option<f64>, exposed: Option<Exposed>) {
    let warn = ui.visuals().warn_fg_color;
    let small = |text: String| RichText::new(text).small();
    if let Some(Exposed { clipped, dark, .. }) = exposed {
        for (what, share, most) in [("clipped", clipped, TOO_MUCH_CLIPPED), ("dark", dark, TOO_MUCH_DARK)] {
            if share > most {
                ui.label(small(format!("{what} {:.1} %", 100.0 * share)).color(warn));
            }
        }
    }
    let exposure = exposure.or(shot.exposure).unwrap_or(1.0);
    if exposure != 1.0 {
        ui.label(small(format!("exposure {exposure}")));
    }
    if shot.files.len() > 1 {
        ui.label(small(format!("{} files", shot.files.len())));
    }
}

/// The user stopped the look at the photos.
#[derive(Clone, Copy, Debug, Error)]
#[error("the look at the photos was cancelled: it comes with the next change")]
struct Cancelled;

fn look_at(set: &CaptureSet, loaded: &Loaded, job: &Job) -> Result<Vec<Look>, Cancelled> {
    let mask = loaded.object.as_ref().ok().map(|object| &object.mask);
    let mut looks = Vec::with_capacity(loaded.shots.len());
    for shot in &loaded.shots {
        if job.is_cancelled() {
            return Err(Cancelled);
        }
        let name = shot.name.clone();
        let Ok(photo) = &shot.photo else {
            looks.push(Look { name, exposed: None, small: None });
            continue;
        };
        let own = set.shots.iter().find(|other| ShotName::of(other) == name);
        let region = own.and_then(|own| region_of(set, own, mask, photo.linear.size()));
        let small = thumbnail(&photo.linear, THUMBNAIL_PX);
        let white = shot.range[1].max(f32::MIN_POSITIVE);
        let grey = |light: &f32| {
            Color32::from_gray((Encoding::Srgb.encode((light / white).clamp(0.0, 1.0)) * 255.0).round() as u8)
        };
        let image = ColorImage::new([small.width(), small.height()], small.data().iter().map(grey).collect());
        looks.push(Look { name, exposed: Some(Exposed::of(photo, region.as_ref())), small: Some(image) });
    }
    Ok(looks)
}
