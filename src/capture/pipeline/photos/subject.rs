//! The photos of one subject, by light and colour.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use firstbounce_core::Photo;
use indexmap::IndexMap;

use super::super::{PipelineError, PipelineWatch, Preference, with_crosstalk};
use super::unmix::unmix;
use super::{PhotoStore, ShotLight, exposure};
use crate::image_file::{ImageWarning, LinearLight, Metadata};
use crate::set::{CaptureSet, Shot, Subject};

/// The photos of one subject, by light and colour, in linear light.
#[derive(Clone, Debug)]
pub struct SubjectPhotos {
    /// By (light, colour): colour is `None` for a mirror ball's shot that names none.
    pub(super) shots: IndexMap<(usize, Option<usize>), Arc<LinearLight>>,
}

impl SubjectPhotos {
    /// The photo under a light in a colour.
    pub fn photo(&self, light: usize, colour: Option<usize>) -> Option<&Photo> {
        self.shots.get(&(light, colour)).map(|shot| &*shot.photo)
    }

    /// Every photo under a light.
    pub fn under(&self, light: usize) -> impl Iterator<Item = &Photo> {
        self.shots.iter().filter(move |((l, _), _)| *l == light).map(|(_, shot)| &*shot.photo)
    }

    /// Every photo.
    pub fn all(&self) -> impl Iterator<Item = &Photo> {
        self.shots.values().map(|shot| &*shot.photo)
    }

    /// The first file of few levels whose shot does not say by itself how its values are encoded.
    pub fn coarse_file(&self, set: &CaptureSet, subject: Subject) -> Option<&Path> {
        let has_encoding = |&(light, colour): &(usize, Option<usize>)| {
            let light = set.lights.get(light).map(|light| light.name.as_str());
            let colour = colour.and_then(|colour| set.colours.get(colour)).map(|colour| colour.name.as_str());
            set.shot(subject, light, colour).is_some_and(|shot| shot.encoding.is_some())
        };
        let open = self.shots.iter().filter(|(shot, _)| !has_encoding(shot));
        open.flat_map(|(_, light)| &light.warnings).find_map(|warning| match warning {
            ImageWarning::EightBit { path } => Some(path.as_path()),
            _ => None,
        })
    }

    /// Puts shots together that were read; all must be there and have one size. Crosstalk that the set gives is undone.
    pub fn of(set: &CaptureSet, subject: Subject, shots: &[(&Shot, ShotLight)]) -> Result<Self, PipelineError> {
        let mut photos = Self { shots: IndexMap::new() };
        for (shot, light) in shots {
            let linear = light.clone().map_err(PipelineError::Photo)?;
            let light = shot.light.as_deref().and_then(|name| set.light_index(name)).unwrap_or_default();
            let colour = shot.colour.as_deref().and_then(|name| set.colour_index(name));
            photos.shots.insert((light, colour), linear);
        }
        photos.check_sizes(set, subject)?;
        if subject.is_matte() {
            unmix(set, &mut photos.shots).map_err(PipelineError::Crosstalk)?;
        }
        Ok(photos)
    }

    fn check_sizes(&self, set: &CaptureSet, subject: Subject) -> Result<(), PipelineError> {
        let expected = self.all().next().map(|photo| photo.linear.size());
        let Some(expected) = expected else { return Ok(()) };
        for (&(light, colour), shot) in &self.shots {
            let found = shot.photo.linear.size();
            if found != expected {
                let light = set.lights.get(light).map(|light| light.name.as_str());
                let colour = colour.map(|colour| set.colours[colour].name.as_str());
                let file = set.shot(subject, light, colour).and_then(|shot| shot.files.first());
                let path = set.resolve(file.map_or("", String::as_str));
                return Err(PipelineError::PhotoSize { path, found, expected });
            }
        }
        Ok(())
    }
}

/// Reads every photo of a subject. Crosstalk is undone that the set gives, or its shots show.
pub fn load_subject(
    set: &CaptureSet,
    subject: Subject,
    store: &PhotoStore,
    watch: &dyn PipelineWatch,
) -> Result<SubjectPhotos, PipelineError> {
    let with_crosstalk =
        if subject.is_matte() { Some(with_crosstalk(set, Preference::File, store, watch)?.0) } else { None };
    let set = with_crosstalk.as_deref().unwrap_or(set);
    // Shots of the same files side by side, as an RGB photo's three colours are.
    let mut groups: IndexMap<&[String], Vec<&Shot>> = IndexMap::new();
    set.shots_of(subject).for_each(|shot| groups.entry(&shot.files).or_default().push(shot));
    let shots: Vec<&Shot> = groups.into_values().flatten().collect();
    let lights = store.read(set, &shots, watch)?;
    SubjectPhotos::of(set, subject, &shots.into_iter().zip(lights).collect::<Vec<_>>())
}

/// What the files of a shot say of themselves.
#[derive(Clone, Debug)]
pub struct ShotNotes {
    /// What its light was divided by.
    pub exposure: f32,
    /// The files, and what each says of itself.
    pub files: Vec<(PathBuf, Metadata)>,
    /// The warnings of all files.
    pub warnings: Vec<ImageWarning>,
}

impl From<&LinearLight> for ShotNotes {
    fn from(light: &LinearLight) -> Self {
        Self { exposure: light.exposure, files: light.files.clone(), warnings: light.warnings.clone() }
    }
}

/// What the user should know of the files of some shots of one subject, each once.
pub fn image_warnings(shots: &[(&Shot, &ShotNotes)]) -> Vec<ImageWarning> {
    let mut each_once = Vec::new();
    for warning in shots.iter().flat_map(|(_, notes)| notes.warnings.clone()).chain(exposure::warnings(shots)) {
        if !each_once.contains(&warning) {
            each_once.push(warning);
        }
    }
    each_once
}

/// The same by kind.
pub fn by_kind(warnings: Vec<ImageWarning>) -> impl Iterator<Item = Vec<ImageWarning>> {
    let mut kinds: IndexMap<_, Vec<ImageWarning>> = IndexMap::new();
    for warning in warnings {
        kinds.entry(std::mem::discriminant(&warning)).or_default().push(warning);
    }
    kinds.into_values()
}
