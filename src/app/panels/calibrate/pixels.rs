//! The pixels of a ball, tinted by what became of them.

use std::sync::Arc;

use eframe::egui::{Color32, ColorImage, Rect, RichText, Sense, TextureHandle, TextureOptions, Ui, pos2, vec2};
use firstbounce_capture::pipeline::Calibrated;
use firstbounce_capture::set::{CaptureSet, SphereKind};
use firstbounce_core::calibrate::{BallPixels, PixelCounts, PixelUse};

use crate::app::state::results::{Calibration, ShotName};
use crate::app::state::session::Session;
use crate::app::views::Over;

/// The longest side of a tint's texture; larger balls are shown coarser.
const MAX_SIDE: usize = 2048;
const STRENGTH: u8 = 110;

/// What is tinted, and the tints that were made of the last calibration.
pub struct PixelTints {
    on: bool,
    made: Vec<Made>,
}

struct Made {
    /// The calibration is held: another one cannot come to lie in its place.
    of: Arc<Calibration>,
    ball: (ShotName, SphereKind),
    /// Whether a view shows it: the legend names those.
    is_seen: bool,
    texture: TextureHandle,
    /// Of the square of the photo: left, top, width, height in pixels.
    square_px: [usize; 4],
    counts: PixelCounts,
    title: String,
}

impl Default for PixelTints {
    fn default() -> Self {
        Self { on: true, made: Vec::new() }
    }
}

impl PixelTints {
    /// Tints the ball's pixels in the photo that is shown.
    pub fn paint(&mut self, ui: &mut Ui, over: &Over<'_>, session: &Session, shot: &ShotName, kind: SphereKind) {
        let document = session.document();
        let Some(measured) = session.results.measured().filter(|_| self.on) else { return };
        self.made.retain(|made| Arc::ptr_eq(&made.of, &measured));
        let ball = (shot.clone(), kind);
        if !self.made.iter().any(|made| made.ball == ball) {
            let pixels = pixels_of(&document.set, &measured.calibrated, shot, kind);
            let title = over.shown.title();
            self.made.extend(pixels.and_then(|pixels| make(ui, measured.clone(), ball.clone(), pixels, title)));
        }
        let Some(made) = self.made.iter_mut().find(|made| made.ball == ball) else { return };
        made.is_seen = true;
        let [x, y, width, height] = made.square_px.map(|px| px as f64);
        let transform = &over.canvas.transform;
        let place = Rect::from_min_max(transform.to_screen([x, y]), transform.to_screen([x + width, y + height]));
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        let painter = ui.painter().with_clip_rect(transform.rect.intersect(ui.clip_rect()));
        painter.image(made.texture.id(), place, whole, Color32::WHITE);
    }

    /// What the tints mean, and how many pixels have each.
    pub fn legend(&mut self, ui: &mut Ui) {
        ui.checkbox(&mut self.on, "Tint the balls' pixels by their use");
        for made in self.made.iter_mut().filter(|made| made.is_seen) {
            made.is_seen = false;
            ui.label(RichText::new(&made.title).small());
            ui.horizontal_wrapped(|ui| {
                for (pixel, words) in USES {
                    let count = count_of(&made.counts, pixel);
                    if count == 0 {
                        continue;
                    }
                    let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
                    ui.painter().rect_filled(rect, 2.0, colour_of(pixel).to_opaque());
                    ui.label(RichText::new(format!("{words}: {count}")).small());
                }
            });
        }
        ui.separator();
    }
}

const USES: [(PixelUse, &str); 7] = [
    (PixelUse::Used, "used"),
    (PixelUse::Clipped, "clipped"),
    (PixelUse::Dark, "dark"),
    (PixelUse::NearRim, "near the rim"),
    (PixelUse::NearTerminator, "near the terminator"),
    (PixelUse::Highlight, "highlight"),
    (PixelUse::Outlier, "outlier"),
];

fn colour_of(pixel: PixelUse) -> Color32 {
    let [red, green, blue] = match pixel {
        PixelUse::Outside => return Color32::TRANSPARENT,
        PixelUse::Used => [46, 180, 80],
        PixelUse::Clipped => [229, 57, 140],
        PixelUse::Dark => [57, 120, 229],
        PixelUse::NearRim => [150, 150, 150],
        PixelUse::NearTerminator => [224, 168, 32],
        PixelUse::Highlight => [60, 220, 230],
        PixelUse::Outlier => [225, 60, 40],
    };
    Color32::from_rgba_unmultiplied(red, green, blue, STRENGTH)
}

fn count_of(counts: &PixelCounts, pixel: PixelUse) -> usize {
    match pixel {
        PixelUse::Outside => 0,
        PixelUse::Used => counts.used,
        PixelUse::Clipped => counts.clipped,
        PixelUse::Dark => counts.dark,
        PixelUse::NearRim => counts.near_rim,
        PixelUse::NearTerminator => counts.near_terminator,
        PixelUse::Highlight => counts.highlight,
        PixelUse::Outlier => counts.outlier,
    }
}

/// The pixels that a photo of a ball was measured on: those of its ratio, or of the light's strength.
fn pixels_of<'a>(
    set: &CaptureSet,
    calibrated: &'a Calibrated,
    shot: &ShotName,
    kind: SphereKind,
) -> Option<&'a BallPixels> {
    let light = set.light_index(shot.light.as_deref()?)?;
    let colour = set.colour_index(shot.colour.as_deref()?)?;
    let ratio = |colour: usize| calibrated.evidence(kind, light, colour).map(|evidence| &evidence.report.pixels);
    let strength = || calibrated.intensity.get(light).and_then(|known| known.pixels.as_ref());
    match (kind, colour) {
        (SphereKind::Grey, 0) => strength().or_else(|| ratio(1)),
        (_, 0) => ratio(1),
        (_, colour) => ratio(colour),
    }
}

fn make(
    ui: &Ui,
    of: Arc<Calibration>,
    ball: (ShotName, SphereKind),
    pixels: &BallPixels,
    title: String,
) -> Option<Made> {
    let (width, height) = (pixels.width, pixels.uses.len().checked_div(pixels.width)?);
    let stride = width.max(height).div_ceil(MAX_SIDE).max(1);
    let (columns, rows) = (width.div_ceil(stride), height.div_ceil(stride));
    let colours = (0..rows)
        .flat_map(|y| (0..columns).map(move |x| y * stride * width + x * stride))
        .map(|index| pixels.uses.get(index).map_or(Color32::TRANSPARENT, |pixel| colour_of(*pixel)))
        .collect();
    let image = ColorImage::new([columns, rows], colours);
    let texture = ui.ctx().load_texture("pixels of a ball", image, TextureOptions::NEAREST);
    let (x, y) = pixels.origin;
    let square_px = [x, y, columns * stride, rows * stride];
    Some(Made { of, ball, is_seen: false, texture, square_px, counts: pixels.counts(), title })
}
