//! Small pictures of files that are not in the set yet, read off the UI thread for those in sight.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use eframe::egui::{Color32, ColorImage, TextureHandle, TextureOptions, Ui};
use firstbounce_capture::image_file::{Encoding, ImageError, read_image};
use firstbounce_capture::pipeline::thumbnail;

use crate::app::base::jobs::{Jobs, Task};

const SIDE_PX: usize = 72;

/// By file; `None` for one that cannot be read.
#[derive(Default)]
pub struct Thumbnails {
    known: HashMap<PathBuf, Option<TextureHandle>>,
    reading: Option<(PathBuf, Task<ColorImage>)>,
}

impl Thumbnails {
    /// The small picture, once it was read; one file at a time.
    pub fn of(&mut self, file: &Path, ui: &Ui, jobs: &mut Jobs) -> Option<&TextureHandle> {
        if let Some((path, task)) = &self.reading
            && let Some(outcome) = task.poll()
        {
            let load = |image| ui.ctx().load_texture("incoming", image, TextureOptions::LINEAR);
            self.known.insert(path.clone(), outcome.ok().map(load));
            self.reading = None;
        }
        if self.reading.is_none() && !self.known.contains_key(file) {
            let path = file.to_owned();
            self.reading = Some((path.clone(), jobs.start("Read small pictures", move |_| small(&path))));
        }
        self.known.get(file)?.as_ref()
    }
}

/// As bright as it can be: photos of mirror balls are nearly black.
fn small(path: &Path) -> Result<ColorImage, ImageError> {
    let image = read_image(path)?;
    let planes: Vec<_> = image.channels.iter().take(3).map(|(_, plane)| thumbnail(plane, SIDE_PX)).collect();
    let Some(first) = planes.first() else { return Ok(ColorImage::default()) };
    let brightest = planes.iter().flat_map(|plane| plane.data()).copied().filter(|value| value.is_finite());
    let white = brightest.fold(f32::MIN_POSITIVE, f32::max);
    let byte = |value: f32| (Encoding::Srgb.encode((value / white).clamp(0.0, 1.0)) * 255.0).round() as u8;
    let colour = |pixel: usize| {
        let of = |channel: usize| byte(planes[channel.min(planes.len() - 1)].data()[pixel]);
        Color32::from_rgb(of(0), of(1), of(2))
    };
    Ok(ColorImage::new([first.width(), first.height()], (0..first.data().len()).map(colour).collect()))
}
