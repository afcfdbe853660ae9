//! The set that would be made, small: a photo, its first bounce and the rest.

use std::sync::{Arc, Mutex};

use eframe::egui::{Color32, ColorImage, Image, RichText, TextureHandle, TextureOptions, Ui, vec2};
use firstbounce_capture::set::Encoding;
use firstbounce_core::{Plane, Portion};
use firstbounce_lab::simulate::{PreparedScene, SimulateError, SimulateOptions, Simulated, prepare, simulate_prepared};
use thiserror::Error;

use super::live::Live;
use crate::app::base::jobs::Job;
use crate::app::widgets::advice::advice;
use crate::app::widgets::theme::Weight;

/// Side of the preview's pictures.
const PIXELS: usize = 72;
const PATCHES: usize = 400;
/// Light that bounced more often is too weak to be seen.
const BOUNCES: usize = 8;
/// Side of a picture in the window, in points.
const MAX_POINTS: f32 = 210.0;

/// Why there is no preview.
#[derive(Debug, Error)]
pub enum PreviewError {
    /// The simulation failed.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The set has no photo.
    #[error("nothing was photographed: choose at least one light and one colour")]
    NoPhoto,
}

/// Small pictures, and what is said of them.
pub struct Preview {
    pictures: [(&'static str, ColorImage); 3],
    words: String,
    warnings: Vec<String>,
}

/// The pictures of a preview as textures.
#[derive(Default)]
pub struct Shown {
    of: Option<Arc<Preview>>,
    textures: Vec<(&'static str, TextureHandle)>,
}

/// A surface made ready, and the options it was made for.
type Kept = (SimulateOptions, Arc<PreparedScene>);

/// Keeps the form factors of the last surface: paint, lamps and sensor change without them.
#[derive(Clone, Default)]
pub struct Previewer {
    last: Arc<Mutex<Option<Kept>>>,
}

/// The options of the preview. What it does not show is the same for all.
pub fn small(options: &SimulateOptions) -> SimulateOptions {
    SimulateOptions {
        name: String::new(),
        patches: options.patches.min(PATCHES),
        size_px: options.size_px.min(PIXELS),
        samples_per_pixel_side: 2,
        truth_bounces: BOUNCES,
        balls: None,
        ..options.clone()
    }
}

impl Previewer {
    /// Simulates the preview.
    pub fn preview(&self, options: &SimulateOptions, job: &Job) -> Result<Preview, PreviewError> {
        let kept = self.last.lock().ok().and_then(|last| last.clone());
        let prepared = match kept.filter(|(of, _)| is_same_surface(of, options)) {
            Some((_, prepared)) => prepared,
            None => {
                let prepared = Arc::new(prepare(options, &Portion { watch: job, from: 0.0, to: 0.5 })?);
                if let Ok(mut last) = self.last.lock() {
                    *last = Some((options.clone(), prepared.clone()));
                }
                prepared
            }
        };
        let simulated = simulate_prepared(&prepared, options, &Portion { watch: job, from: 0.5, to: 1.0 });
        preview_of(&simulated?, options)
    }
}

fn is_same_surface(a: &SimulateOptions, b: &SimulateOptions) -> bool {
    (a.patches, a.size_px, a.lens) == (b.patches, b.size_px, b.lens) && a.scene == b.scene
}

fn preview_of(simulated: &Simulated, options: &SimulateOptions) -> Result<Preview, PreviewError> {
    let (Some(photo), Some([direct, later @ ..])) =
        (simulated.photos.first(), simulated.truth.bounces.first().map(Vec::as_slice))
    else {
        return Err(PreviewError::NoPhoto);
    };
    let (black, white) = (options.sensor.black_level, options.sensor.white_level());
    let linear = Plane::from_fn(photo.stored.width(), photo.stored.height(), |x, y| {
        ((f64::from(photo.stored.at(x, y)) - black) / (white - black)) as f32
    });
    let rest = Plane::from_fn(direct.width(), direct.height(), |x, y| later.iter().map(|k| k.at(x, y)).sum());
    let brightest = linear.data().iter().copied().fold(f32::MIN_POSITIVE, f32::max);
    let share = 100.0 * simulated.report.indirect_share;
    let side = photo.stored.width();
    let words = format!("{share:.0} % of the light bounced twice or more ({side} x {side} pixels, all lights).");
    let pictures = [("Photo, light1 in c1", &linear), ("Bounce 1", direct), ("Bounced more often", &rest)];
    Ok(Preview {
        pictures: pictures.map(|(name, plane)| (name, grey(plane, brightest))),
        words,
        warnings: simulated.report.warnings.clone(),
    })
}

fn grey(plane: &Plane, white: f32) -> ColorImage {
    let grey = |light: &f32| {
        Color32::from_gray((Encoding::Srgb.encode((light / white).clamp(0.0, 1.0)) * 255.0).round() as u8)
    };
    ColorImage::new([plane.width(), plane.height()], plane.data().iter().map(grey).collect())
}

/// Shows the preview.
pub fn ui(ui: &mut Ui, live: &Live<SimulateOptions, Preview>, shown: &mut Shown) {
    ui.horizontal(|ui| {
        ui.label(RichText::new("Preview").semi_bold());
        if live.is_busy() {
            ui.label("is being computed...");
        }
    });
    let Some(preview) = live.outcome() else {
        advice(ui, "Small pictures of the set come here, as soon as its values are right.");
        return;
    };
    if !shown.of.as_ref().is_some_and(|of| Arc::ptr_eq(of, preview)) {
        let load = |(name, image): &(&'static str, ColorImage)| {
            (*name, ui.ctx().load_texture(*name, image.clone(), TextureOptions::NEAREST))
        };
        *shown = Shown { of: Some(preview.clone()), textures: preview.pictures.iter().map(load).collect() };
    }
    let side = ((ui.available_width() - 2.0 * ui.spacing().item_spacing.x) / 3.0).clamp(40.0, MAX_POINTS);
    ui.horizontal(|ui| {
        for (name, texture) in &shown.textures {
            ui.vertical(|ui| {
                ui.add(Image::new(texture).fit_to_exact_size(vec2(side, side)).alt_text(*name));
                ui.label(*name);
            });
        }
    });
    ui.label(RichText::new("All three are shown equally bright.").small().weak());
    ui.label(&preview.words);
    for warning in &preview.warnings {
        ui.colored_label(ui.visuals().warn_fg_color, warning);
    }
}
