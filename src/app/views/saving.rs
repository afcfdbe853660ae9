//! A tile as a picture: on the clipboard, or as a PNG beside the set.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use eframe::egui::{ColorImage, Context, Pos2, Rect, vec2};
use firstbounce_capture::atomic::WriteError;
use firstbounce_capture::image_file::{ImageError, rgb8_png};
use firstbounce_core::Plane;
use thiserror::Error;

use crate::app::base::beside::write_png;

/// The folder of pictures in that of the set.
const FOLDER: &str = "pictures";

/// What is done with a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Take {
    /// It is copied.
    Copy,
    /// It is written.
    Save,
}

/// Why a picture was not saved.
#[derive(Debug, Error)]
pub enum SavingError {
    /// It has no pixels.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// It could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// What became of a picture: copied, written there, or not.
pub type Taken = Result<Option<PathBuf>, SavingError>;

/// Pictures of tiles on their way.
pub struct Saving {
    sender: Sender<Taken>,
    taken: Receiver<Taken>,
}

impl Default for Saving {
    fn default() -> Self {
        let (sender, taken) = channel();
        Self { sender, taken }
    }
}

impl Saving {
    /// Takes the picture of what lies in `rect` once the next frame is drawn.
    pub fn start(&self, context: &Context, rect: Rect, take: Take, folder: &Path, title: &str) {
        let (sender, wake) = (self.sender.clone(), context.clone());
        let (folder, name) = (folder.join(FOLDER), file_name(title));
        let density = context.pixels_per_point();
        context.request_screenshot(move |window: Arc<ColorImage>| {
            let picture = window.region(&inside(rect, &window, density), Some(density));
            if take == Take::Copy {
                wake.copy_image(picture);
                let _ = sender.send(Ok(None));
                return wake.request_repaint();
            }
            // The window goes on while it is packed and written.
            std::thread::spawn(move || {
                let _ = sender.send(save(&picture, &folder, &name).map(Some));
                wake.request_repaint();
            });
        });
    }

    /// What became of a picture since this was asked last.
    pub fn taken(&self) -> Option<Taken> {
        self.taken.try_recv().ok()
    }
}

/// The part of the rectangle that is in the window.
fn inside(rect: Rect, window: &ColorImage, density: f32) -> Rect {
    let size = vec2(window.width() as f32, window.height() as f32) / density;
    rect.intersect(Rect::from_min_size(Pos2::ZERO, size))
}

fn save(picture: &ColorImage, folder: &Path, name: &str) -> Result<PathBuf, SavingError> {
    let channel = |of: usize| {
        Plane::from_fn(picture.width(), picture.height(), |x, y| f32::from(picture[(x, y)].to_array()[of]) / 255.0)
    };
    let png = rgb8_png([&channel(0), &channel(1), &channel(2)], 1.0)?;
    if folder.is_symlink() {
        return Err(WriteError::Link { path: folder.to_owned() }.into());
    }
    let refused = |reason| WriteError::Refused { path: folder.to_owned(), reason };
    std::fs::create_dir_all(folder).map_err(refused)?;
    Ok(write_png(folder, name, &png)?)
}

/// A title as the name of a file, on every system.
fn file_name(title: &str) -> String {
    let kept = |letter: char| if letter.is_alphanumeric() { letter } else { '-' };
    let name: String = title.to_lowercase().chars().map(kept).collect();
    name.split('-').filter(|part| !part.is_empty()).collect::<Vec<_>>().join("-").chars().take(100).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_title_becomes_a_name_that_every_system_takes() {
        assert_eq!(file_name("Photo, left, blue"), "photo-left-blue");
        assert_eq!(file_name("a/b: c\\d*?"), "a-b-c-d");
    }

    #[test]
    fn a_picture_never_takes_the_place_of_another() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().join(FOLDER);
        let picture = ColorImage::filled([3, 2], eframe::egui::Color32::from_rgb(10, 20, 30));
        let names = [(); 2].map(|()| save(&picture, &folder, "normals").unwrap().file_name().unwrap().to_owned());
        assert_eq!(names, ["normals.png", "normals-2.png"]);
        let read = firstbounce_capture::image_file::read_image(&folder.join("normals.png")).unwrap();
        assert_eq!(read.size(), (3, 2));
    }
}
