//! The object's mask: a file, a threshold, a brush, a lasso.

use std::path::PathBuf;

use eframe::egui::{
    Color32, ColorImage, ComboBox, Rect, RichText, Shape, Slider, Stroke, TextureHandle, TextureOptions, Ui, pos2,
};
use firstbounce_capture::image_file::{mask_png, read_mask};
use firstbounce_capture::set::Subject;
use firstbounce_core::Mask;
use firstbounce_core::image::mask::Combine;

use crate::app::base::beside::write_png;
use crate::app::base::dialogs::Choose;
use crate::app::base::keyed::Keyed;
use crate::app::state::layout::Shown;
use crate::app::state::results::ShotName;
use crate::app::state::session::Session;
use crate::app::views::Over;
use crate::app::widgets::path_field::PathField;
use crate::app::widgets::theme::Weight;

/// The longest side of the tint that shows the draft; larger masks are shown coarser.
const MAX_SIDE: usize = 1024;
const INSIDE: Color32 = Color32::from_rgba_premultiplied(20, 70, 90, 90);
const LINE: Color32 = Color32::from_rgb(80, 220, 255);
/// Strokes that can be taken back.
const MAX_STROKES: usize = 32;

/// How a mask is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Tool {
    /// Drags move the picture.
    #[default]
    None,
    Brush,
    Lasso,
}

/// The mask part of the panel.
pub struct MaskPart {
    path: PathField,
    /// The mask that was chosen, while it is read.
    reading: Keyed<PathBuf, ()>,
    draft: Option<Draft>,
    tool: Tool,
    combine: Combine,
    radius_px: f64,
    /// Share of the brightest light.
    threshold: f32,
    stroke_px: Vec<[f64; 2]>,
}

/// A mask that is not saved yet.
struct Draft {
    mask: Mask,
    before: Vec<Mask>,
    texture: Option<TextureHandle>,
}

impl Default for MaskPart {
    fn default() -> Self {
        Self {
            path: PathField::default(),
            reading: Keyed::default(),
            draft: None,
            tool: Tool::None,
            combine: Combine::Add,
            radius_px: 8.0,
            threshold: 0.1,
            stroke_px: Vec::new(),
        }
    }
}

impl MaskPart {
    pub fn ui(&mut self, ui: &mut Ui, session: &mut Session) {
        let document = session.document();
        ui.label(RichText::new("Mask: which pixels are the object").semi_bold());
        ui.label(match &document.set.mask {
            Some(file) => file.clone(),
            None => "none: the brighter part of the photos is used".into(),
        });
        if document.set.mask.is_some() && ui.button("Remove the mask").clicked() {
            session.edit("Remove the mask", |document| document.set.mask = None);
        }
        let dialogs = session.dialogs();
        let chosen = self.path.ui(ui, "Mask file", Choose::Pictures, &dialogs, &mut session.jobs);
        if let Some(path) = chosen.into_iter().next() {
            let picture = document.set.resolve(&path.to_string_lossy());
            let task = session.jobs.start("Read the mask", move |_| read_mask(&picture).map(drop));
            self.reading.start(path, task);
        }
        match self.reading.take() {
            Some((path, Ok(_))) => {
                session.edit("Choose mask", |document| document.set.mask = Some(document.set.written(&path)));
            }
            Some((_, Err(error))) => session.error(error.to_string()),
            None => {}
        }
        match &self.draft {
            None if ui.button("Draw a mask").clicked() => self.begin(session),
            None => {}
            Some(_) => self.drawing(ui, session),
        }
    }

    fn begin(&mut self, session: &mut Session) {
        let object = session.results.loaded().and_then(|loaded| loaded.object.as_ref().ok().map(|o| o.mask.clone()));
        let mask = object.or_else(|| size_of_object(session).map(|(width, height)| Mask::filled(width, height, false)));
        let Some(mask) = mask else {
            session.warn("The object's photos are not there yet: a mask is drawn over them");
            return;
        };
        self.draft = Some(Draft { mask, before: Vec::new(), texture: None });
        self.tool = Tool::Lasso;
        if let Some(shot) = session.document().set.shots_of(Subject::Object).next() {
            session.views.show(Shown::Photo(ShotName::of(shot)));
        }
    }

    fn drawing(&mut self, ui: &mut Ui, session: &mut Session) {
        ui.group(|ui| {
            ui.horizontal_wrapped(|ui| {
                ui.selectable_value(&mut self.tool, Tool::Lasso, "Lasso");
                ui.selectable_value(&mut self.tool, Tool::Brush, "Brush");
                ui.selectable_value(&mut self.tool, Tool::None, "Move the picture");
            });
            ComboBox::from_label("What is drawn is")
                .selected_text(match self.combine {
                    Combine::Add => "the object",
                    Combine::Remove => "not the object",
                })
                .show_ui(ui, |ui| {
                    ui.selectable_value(&mut self.combine, Combine::Add, "the object");
                    ui.selectable_value(&mut self.combine, Combine::Remove, "not the object");
                });
            if self.tool == Tool::Brush {
                ui.add(Slider::new(&mut self.radius_px, 0.5..=500.0).logarithmic(true).text("Brush radius, px"));
            }
            ui.add(
                Slider::new(&mut self.threshold, 0.001..=1.0)
                    .logarithmic(true)
                    .text("Threshold, of the brightest light"),
            );
            ui.horizontal_wrapped(|ui| {
                if ui.button("All above the threshold").clicked() {
                    self.by_threshold(session, false);
                }
                if ui.button("The brighter part").on_hover_text("The threshold that parts the photo best").clicked() {
                    self.by_threshold(session, true);
                }
            });
            let Some(draft) = &mut self.draft else { return };
            ui.label(format!("{} pixels are the object", draft.mask.count()));
            let mut done = false;
            ui.horizontal_wrapped(|ui| {
                if ui.add_enabled(!draft.before.is_empty(), eframe::egui::Button::new("Undo stroke")).clicked()
                    && let Some(before) = draft.before.pop()
                {
                    draft.mask = before;
                    draft.texture = None;
                }
                if ui.button("Save mask").clicked() {
                    done = save(session, &draft.mask);
                }
                done |= ui.button("Discard drawing").clicked();
            });
            if done {
                self.draft = None;
                self.tool = Tool::None;
            }
        });
    }

    /// Puts the pixels above a threshold of the brightest photo's light into the draft.
    fn by_threshold(&mut self, session: &mut Session, best: bool) {
        let Some(loaded) = session.results.loaded() else { return };
        let photos = loaded.shots.iter().filter(|shot| shot.name.subject == Subject::Object);
        let planes: Vec<_> = photos.filter_map(|shot| Some(&shot.photo.as_ref().ok()?.linear)).collect();
        let Some((first, others)) = planes.split_first() else { return };
        let mut brightest = (*first).clone();
        for plane in others.iter().filter(|plane| plane.size() == first.size()) {
            brightest.data_mut().iter_mut().zip(plane.data()).for_each(|(most, light)| *most = most.max(*light));
        }
        let white = brightest.data().iter().copied().fold(f32::MIN_POSITIVE, f32::max);
        if best {
            self.threshold = (Mask::best_threshold(&brightest) / white).clamp(0.001, 1.0);
        }
        let shape = Mask::brighter_than(&brightest, self.threshold * white);
        if let Some(draft) = &mut self.draft {
            draft.change(|mask| *mask = shape);
        }
    }

    pub fn wants_drag(&self, shown: &Shown) -> bool {
        self.draft.is_some() && self.tool != Tool::None && shown.subject() == Subject::Object
    }

    /// Draws with the drags over a picture of the object, and shows the draft there.
    pub fn overlay(&mut self, ui: &mut Ui, over: &Over<'_>, _: &mut Session) {
        let transform = &over.canvas.transform;
        if over.shown.subject() != Subject::Object {
            return;
        }
        let Some(draft) = self.draft.as_mut().filter(|draft| draft.mask.size() == over.picture.source.size()) else {
            return;
        };
        let painter = ui.painter().with_clip_rect(transform.rect.intersect(ui.clip_rect()));
        let texture = draft.texture.get_or_insert_with(|| tint(ui, &draft.mask));
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        painter.image(texture.id(), transform.image_rect(), whole, Color32::WHITE);
        if self.tool == Tool::None {
            return;
        }
        if let Some(drag) = over.canvas.dragged {
            if self.stroke_px.is_empty() {
                self.stroke_px.push(drag.from_px);
            }
            if self.stroke_px.last() != Some(&drag.to_px) {
                self.stroke_px.push(drag.to_px);
            }
            let points: Vec<_> = self.stroke_px.iter().map(|point| transform.to_screen(*point)).collect();
            let width =
                if self.tool == Tool::Brush { 2.0 * self.radius_px as f32 * transform.points_per_px() } else { 1.5 };
            let colour = if self.tool == Tool::Brush { LINE.gamma_multiply(0.4) } else { LINE };
            painter.add(Shape::line(points, Stroke::new(width, colour)));
            if drag.finished {
                self.finish();
            }
        } else if let (Tool::Brush, Some(at)) = (self.tool, over.canvas.clicked) {
            self.stroke_px = vec![at];
            self.finish();
        }
    }

    fn finish(&mut self) {
        let path = std::mem::take(&mut self.stroke_px);
        let Some(draft) = &mut self.draft else { return };
        let size = draft.mask.size();
        let shape = match self.tool {
            Tool::None => return,
            Tool::Brush => Mask::stroke(size, &path, self.radius_px),
            Tool::Lasso => Mask::polygon(size, &path),
        };
        let combine = self.combine;
        draft.change(|mask| {
            mask.combine(&shape, combine);
        });
    }
}

impl Draft {
    fn change(&mut self, change: impl FnOnce(&mut Mask)) {
        if self.before.len() == MAX_STROKES {
            self.before.remove(0);
        }
        self.before.push(self.mask.clone());
        change(&mut self.mask);
        self.texture = None;
    }
}

fn size_of_object(session: &Session) -> Option<(usize, usize)> {
    let loaded = session.results.loaded()?;
    let mut photos = loaded.shots.iter().filter(|shot| shot.name.subject == Subject::Object);
    photos.find_map(|shot| Some(shot.photo.as_ref().ok()?.linear.size()))
}

/// Writes the mask into a new file beside the set, so that undo brings the old one back; whether that worked.
fn save(session: &mut Session, mask: &Mask) -> bool {
    let folder = session.document().set.folder.clone();
    let written = mask_png(mask).map_err(|error| error.to_string());
    match written.and_then(|png| write_png(&folder, "mask", &png).map_err(|error| error.to_string())) {
        Ok(path) => {
            session.edit("Draw mask", |document| document.set.mask = Some(document.set.written(&path)));
            session.done(format!("Saved {}", path.display()));
            true
        }
        Err(line) => {
            session.error(line);
            false
        }
    }
}

fn tint(ui: &Ui, mask: &Mask) -> TextureHandle {
    let (width, height) = mask.size();
    let stride = width.max(height).div_ceil(MAX_SIDE).max(1);
    let (columns, rows) = (width.div_ceil(stride), height.div_ceil(stride));
    let pixel = |x: usize, y: usize| if mask.at(x * stride, y * stride) { INSIDE } else { Color32::TRANSPARENT };
    let colours = (0..rows).flat_map(|y| (0..columns).map(move |x| pixel(x, y))).collect();
    ui.ctx().load_texture("mask being drawn", ColorImage::new([columns, rows], colours), TextureOptions::NEAREST)
}
