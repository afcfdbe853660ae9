//! The store of photos in linear light: by path and stamp, so that each file is decoded once while it stays as it is.

use std::collections::HashMap;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use indexmap::IndexMap;
use rayon::prelude::*;

use super::super::{PipelineError, PipelineWatch, Stage};
use super::Exposures;
use super::bracket::{Gathered, parts_of};
use super::key::{FlatKey, FrameKey, Key, PhotoKey, Stamped};
use super::undistort::undistorted;
use crate::image_file::{
    Content, Corrections, DarkFrame, FlatField, ImageError, ImageFile, LinearLight, Metadata, ReadOptions, dark_frame,
    flat_field, linearise, picture_metadata, read_image_as,
};
use crate::set::{CaptureSet, Shot, Subject};

/// A shot in linear light, or what is wrong with one of its files.
pub type ShotLight = Result<Arc<LinearLight>, Arc<ImageError>>;

type Frame<T> = Result<Arc<T>, Arc<ImageError>>;

/// Keeps photos in linear light for as long as a set has use for them. Renaming a light decodes nothing again, another
/// photo decodes that photo alone, and dark frames and flat fields are averaged once for all shots.
#[derive(Debug, Default)]
pub struct PhotoStore {
    kept: Mutex<Kept>,
    decoded: AtomicUsize,
    /// What files say of themselves; `None` for one that cannot be opened.
    metadata: Mutex<HashMap<Stamped, Option<Metadata>>>,
}

#[derive(Debug, Default)]
struct Kept {
    photos: Vec<(PhotoKey, Arc<LinearLight>)>,
    darks: Vec<(FrameKey, Arc<DarkFrame>)>,
    flats: Vec<(FlatKey, Arc<FlatField>)>,
}

/// What is to be made of a list of files, by its place in the plan.
#[derive(Clone, Copy, Debug)]
enum Use {
    Dark(usize),
    Flat(usize),
    Photo(usize),
}

/// Shown each shot of a reading, by its place there.
type OnShot<'a> = dyn Fn(usize, &ShotLight) + Sync + 'a;

impl PhotoStore {
    /// Files decoded since the store was made.
    pub fn decoded_files(&self) -> usize {
        self.decoded.load(Ordering::Relaxed)
    }

    /// The photos of some shots, each by itself: a file that cannot be read spoils the shots that need it, and no other.
    ///
    /// # Errors
    /// [`PipelineError::Cancelled`] alone.
    pub fn read(
        &self,
        set: &CaptureSet,
        shots: &[&Shot],
        watch: &dyn PipelineWatch,
    ) -> Result<Vec<ShotLight>, PipelineError> {
        let exposures = self.exposures(set);
        let keys: Vec<_> = shots.iter().map(|shot| PhotoKey::of(set, shot, &exposures)).collect();
        let read: Vec<_> = shots.iter().map(|_| Mutex::new(None)).collect();
        self.visit_keyed(set, (shots, &keys), &exposures, watch, &|index, light| {
            *locked(&read[index]) = Some(light.clone())
        })?;
        let lights: Vec<ShotLight> =
            read.into_iter().filter_map(|light| light.into_inner().unwrap_or_else(PoisonError::into_inner)).collect();
        let mut kept = locked(&self.kept);
        for (key, light) in keys.iter().zip(&lights) {
            if let (Ok(light), None) = (light, of(&kept.photos, key)) {
                kept.photos.push((key.clone(), light.clone()));
            }
        }
        Ok(lights)
    }

    /// Shows the photos of some shots one by one and keeps none of them that was not kept before: for looking at more
    /// photos than the memory holds.
    ///
    /// # Errors
    /// [`PipelineError::Cancelled`] alone.
    pub fn visit(
        &self,
        set: &CaptureSet,
        shots: &[&Shot],
        watch: &dyn PipelineWatch,
        on_shot: &OnShot,
    ) -> Result<(), PipelineError> {
        let exposures = self.exposures(set);
        let keys: Vec<_> = shots.iter().map(|shot| PhotoKey::of(set, shot, &exposures)).collect();
        self.visit_keyed(set, (shots, &keys), &exposures, watch, on_shot)
    }

    /// A bracket is read exposure by exposure, and shown as one photo.
    fn visit_keyed(
        &self,
        set: &CaptureSet,
        (shots, keys): (&[&Shot], &[PhotoKey]),
        exposures: &Exposures,
        watch: &dyn PipelineWatch,
        on_shot: &OnShot,
    ) -> Result<(), PipelineError> {
        let (mut parts, mut gathered) = (Vec::new(), Vec::new());
        for (index, (shot, key)) in shots.iter().zip(keys).enumerate() {
            let known = of(&locked(&self.kept).photos, key).cloned();
            let of_shot = if known.is_some() { Vec::new() } else { parts_of(shot, exposures) };
            gathered.push(Gathered::of(of_shot.len()));
            parts.extend(of_shot.into_iter().enumerate().map(|(part, shot)| (index, part, shot)));
            if let Some(light) = known {
                on_shot(index, &Ok(light));
            }
        }
        let shots: Vec<&Shot> = parts.iter().map(|(.., shot)| shot).collect();
        let plan = Plan::of(set, &shots, exposures, &locked(&self.kept));
        self.carry_out(&plan, watch, &|at, light| {
            let (index, part, _) = parts[at];
            if let Some(light) = gathered[index].put(set, part, light) {
                on_shot(index, &light);
            }
        })
    }

    /// What a file says of itself, read from its head once while it stays as it is.
    pub fn metadata(&self, path: &Path) -> Option<Metadata> {
        let file = Stamped::of(path.to_path_buf(), None);
        if let Some(known) = locked(&self.metadata).get(&file) {
            return known.clone();
        }
        let metadata = picture_metadata(path).ok();
        locked(&self.metadata).insert(file, metadata.clone());
        metadata
    }

    /// The exposures of all shots of a set: those that the capture file states, and those that only its files state.
    pub fn exposures(&self, set: &CaptureSet) -> Exposures {
        let paths: Vec<_> = set.distinct_files().keys().map(|file| set.resolve(file)).collect();
        // On all cores, before they are looked up one by one.
        paths.par_iter().for_each(|path| drop(self.metadata(path)));
        Exposures::of(set, |path| self.metadata(path))
    }

    fn carry_out(&self, plan: &Plan, watch: &dyn PipelineWatch, on_shot: &OnShot) -> Result<(), PipelineError> {
        let mut frames = Frames { darks: plan.darks.known(), flats: plan.flats.known() };
        for (index, key) in plan.of_shot.iter().enumerate() {
            if let Some(light) = &plan.photos.0[*key].1 {
                on_shot(index, &Ok(light.clone()));
            }
        }
        let done = AtomicUsize::new(0);
        let count: usize = plan.rounds.iter().map(IndexMap::len).sum();
        // Flat fields need dark frames, photos need both.
        for round in &plan.rounds {
            let made = round.iter().collect::<Vec<_>>().into_par_iter().map(|(files, uses)| {
                if watch.cancelled() {
                    return Err(PipelineError::Cancelled);
                }
                let made = self.make(files, uses, plan, &frames, on_shot);
                let finished = done.fetch_add(1, Ordering::Relaxed) + 1;
                watch.progress(Stage::Load, finished as f32 / count as f32);
                Ok(made)
            });
            let made = made.collect::<Result<Vec<_>, PipelineError>>()?;
            made.into_iter().flatten().for_each(|made| frames.take(made));
        }
        let mut kept = locked(&self.kept);
        keep(&mut kept.darks, &plan.darks, &frames.darks);
        keep(&mut kept.flats, &plan.flats, &frames.flats);
        Ok(())
    }

    /// Lets go of what a set has no use for.
    pub fn keep_only(&self, set: &CaptureSet) {
        let exposures = self.exposures(set);
        let keys: Vec<_> = set.shots.iter().map(|shot| PhotoKey::of(set, shot, &exposures)).collect();
        let mut kept = locked(&self.kept);
        kept.photos.retain(|(key, _)| keys.contains(key));
        kept.flats.retain(|(flat, _)| keys.iter().any(|key| key.flat.as_ref() == Some(flat)));
        let of_flat = |key: &PhotoKey| key.flat.as_ref().and_then(|flat| flat.dark.clone());
        kept.darks.retain(|(dark, _)| {
            keys.iter().any(|key| key.dark.as_ref() == Some(dark) || of_flat(key).as_ref() == Some(dark))
        });
    }

    fn image(&self, file: &Stamped) -> Result<ImageFile, ImageError> {
        self.decoded.fetch_add(1, Ordering::Relaxed);
        read_image_as(&file.path, &ReadOptions { content: Content::Photo, layer: file.layer.clone() })
    }

    /// Decodes files once, and makes of them all that they are used for. One use takes one file after the other into the
    /// memory.
    fn make(&self, files: &[Stamped], uses: &[Use], plan: &Plan, frames: &Frames, on_shot: &OnShot) -> Vec<Made> {
        if let [only] = uses {
            return vec![plan.make(*only, files.iter().map(|file| self.image(file)), frames, on_shot)];
        }
        let images = files.par_iter().map(|file| self.image(file)).collect::<Result<Vec<_>, _>>();
        match images {
            Ok(images) => uses
                .par_iter()
                .map(|one| plan.make(*one, images.iter().map(Ok::<&ImageFile, ImageError>), frames, on_shot))
                .collect(),
            Err(error) => {
                let error = Arc::new(error);
                uses.iter().map(|one| plan.failed(*one, &error, on_shot)).collect()
            }
        }
    }
}

/// What came of a use.
enum Made {
    Dark(usize, Frame<DarkFrame>),
    Flat(usize, Frame<FlatField>),
    Photo,
}

/// The frames that were made so far.
struct Frames {
    darks: Vec<Option<Frame<DarkFrame>>>,
    flats: Vec<Option<Frame<FlatField>>>,
}

impl Frames {
    fn take(&mut self, made: Made) {
        match made {
            Made::Dark(index, dark) => self.darks[index] = Some(dark),
            Made::Flat(index, flat) => self.flats[index] = Some(flat),
            Made::Photo => {}
        }
    }
}

/// Distinct keys, each with what the store keeps for it.
struct Distinct<K, V>(Vec<(K, Option<Arc<V>>)>);

impl<K: Key, V> Distinct<K, V> {
    /// The place of a key, and whether there is something to be made for it.
    fn place(&mut self, key: &K, kept: &[(K, Arc<V>)]) -> (usize, bool) {
        if let Some(index) = self.0.iter().position(|(known, _)| known == key) {
            return (index, false);
        }
        let value = of(kept, key).cloned();
        let missing = value.is_none();
        self.0.push((key.clone(), value));
        (self.0.len() - 1, missing)
    }

    fn known(&self) -> Vec<Option<Frame<V>>> {
        self.0.iter().map(|(_, value)| value.clone().map(Ok)).collect()
    }

    fn find<'f>(&self, key: &K, frames: &'f [Option<Frame<V>>]) -> Option<&'f Frame<V>> {
        frames.get(self.0.iter().position(|(known, _)| known == key)?)?.as_ref()
    }
}

/// What is to be decoded, and what of it is to be made.
struct Plan {
    darks: Distinct<FrameKey, DarkFrame>,
    flats: Distinct<FlatKey, FlatField>,
    photos: Distinct<PhotoKey, LinearLight>,
    /// By shot, the place of its photo.
    of_shot: Vec<usize>,
    /// Dark frames, flat fields, all other photos: by files, what they are used for.
    rounds: [IndexMap<Vec<Stamped>, Vec<Use>>; 3],
}

impl Plan {
    fn of(set: &CaptureSet, shots: &[&Shot], exposures: &Exposures, kept: &Kept) -> Self {
        let (darks, flats, photos) = (Distinct(Vec::new()), Distinct(Vec::new()), Distinct(Vec::new()));
        let mut plan = Self { darks, flats, photos, of_shot: Vec::new(), rounds: Default::default() };
        for shot in shots {
            let key = PhotoKey::of(set, shot, exposures);
            let (index, missing) = plan.photos.place(&key, &kept.photos);
            plan.of_shot.push(index);
            if missing {
                plan.add_frames(&key, kept);
                let round = match key.subject {
                    Subject::Dark => 0,
                    Subject::FlatField => 1,
                    _ => 2,
                };
                plan.add(round, &key.frame, Use::Photo(index));
            }
        }
        plan
    }

    fn add_frames(&mut self, key: &PhotoKey, kept: &Kept) {
        let dark_of_flat = key.flat.as_ref().and_then(|flat| flat.dark.as_ref());
        for dark in key.dark.iter().chain(dark_of_flat) {
            if let (index, true) = self.darks.place(dark, &kept.darks) {
                self.add(0, dark, Use::Dark(index));
            }
        }
        if let Some(flat) = &key.flat
            && let (index, true) = self.flats.place(flat, &kept.flats)
        {
            self.add(1, &flat.frame, Use::Flat(index));
        }
    }

    fn add(&mut self, round: usize, frame: &FrameKey, one: Use) {
        self.rounds[round].entry(frame.files.clone()).or_default().push(one);
    }

    fn make<I: std::borrow::Borrow<ImageFile>>(
        &self,
        one: Use,
        images: impl Iterator<Item = Result<I, ImageError>>,
        frames: &Frames,
        on_shot: &OnShot,
    ) -> Made {
        let dark = |key: &Option<FrameKey>| key.as_ref().and_then(|key| self.darks.find(key, &frames.darks)).cloned();
        match one {
            Use::Dark(index) => {
                let made = dark_frame(images, &self.darks.0[index].0.options);
                Made::Dark(index, made.map(Arc::new).map_err(Arc::new))
            }
            Use::Flat(index) => {
                let key = &self.flats.0[index].0;
                let made = dark(&key.dark).transpose().and_then(|dark| {
                    let made = flat_field(images, &key.frame.options, dark.as_deref());
                    made.map(Arc::new).map_err(Arc::new)
                });
                Made::Flat(index, made)
            }
            Use::Photo(index) => {
                let key = &self.photos.0[index].0;
                let flat = key.flat.as_ref().and_then(|flat| self.flats.find(flat, &frames.flats)).cloned();
                let corrections = dark(&key.dark).transpose().and_then(|dark| Ok((dark, flat.transpose()?)));
                let light = corrections.and_then(|(dark, flat)| {
                    let corrections = Corrections { dark: dark.as_deref(), flat: flat.as_deref() };
                    let light = linearise(images, &key.frame.options, &corrections);
                    let light = light.and_then(|light| undistorted(light, key.lens.as_ref(), &key.frame.options));
                    light.map(Arc::new).map_err(Arc::new)
                });
                self.show(index, &light, on_shot);
                Made::Photo
            }
        }
    }

    fn failed(&self, one: Use, error: &Arc<ImageError>, on_shot: &OnShot) -> Made {
        match one {
            Use::Dark(index) => Made::Dark(index, Err(error.clone())),
            Use::Flat(index) => Made::Flat(index, Err(error.clone())),
            Use::Photo(index) => {
                self.show(index, &Err(error.clone()), on_shot);
                Made::Photo
            }
        }
    }

    /// Shows a photo to every shot that it is of.
    fn show(&self, photo: usize, light: &ShotLight, on_shot: &OnShot) {
        let shots = self.of_shot.iter().enumerate().filter(|(_, of)| **of == photo);
        shots.for_each(|(shot, _)| on_shot(shot, light));
    }
}

fn of<'k, K: Key, V>(kept: &'k [(K, Arc<V>)], key: &K) -> Option<&'k Arc<V>> {
    kept.iter().find(|(known, _)| key.is_kept_as(known)).map(|(_, value)| value)
}

fn keep<K: Key, V>(kept: &mut Vec<(K, Arc<V>)>, keys: &Distinct<K, V>, made: &[Option<Frame<V>>]) {
    for ((key, _), made) in keys.0.iter().zip(made) {
        if let (Some(Ok(value)), None) = (made, of(kept, key)) {
            kept.push((key.clone(), value.clone()));
        }
    }
}

/// What a worker that panicked left is as good as before.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
