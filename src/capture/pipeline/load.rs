//! Photos of a subject in linear light, each file read once.

use firstbounce_core::image::noise::{NoiseModel, NoiseSource, estimate_noise};
use firstbounce_core::{Mask, Photo, Plane};
use indexmap::IndexMap;
use rayon::prelude::*;

use super::{PipelineError, PipelineWatch, Stage};
use crate::image_file::{
    Corrections, DarkFrame, FlatField, ImageError, ImageFile, ImageWarning, LinearLight, LinearOptions, dark_frame,
    flat_field, linearise, linearise_files, read_image, read_mask,
};
use crate::set::{CaptureSet, Channel, Shot, Subject};

/// The photos of one subject, by light and colour, in linear light.
#[derive(Clone, Debug)]
pub struct SubjectPhotos {
    /// By (light, colour): colour is `None` for a mirror ball's shot that names none.
    shots: IndexMap<(usize, Option<usize>), LinearLight>,
    /// What a person should know of the files, each once.
    pub warnings: Vec<String>,
}

impl SubjectPhotos {
    /// The photo under a light in a colour.
    pub fn photo(&self, light: usize, colour: Option<usize>) -> Option<&Photo> {
        self.shots.get(&(light, colour)).map(|shot| &shot.photo)
    }

    /// Every photo under a light.
    pub fn under(&self, light: usize) -> impl Iterator<Item = &Photo> {
        self.shots.iter().filter(move |((l, _), _)| *l == light).map(|(_, shot)| &shot.photo)
    }

    /// Every photo.
    pub fn all(&self) -> impl Iterator<Item = &Photo> {
        self.shots.values().map(|shot| &shot.photo)
    }
}

/// The object's photos and mask, and the noise of each photo.
#[derive(Clone, Debug)]
pub struct ObjectPhotos {
    /// By light, then colour.
    pub photos: Vec<Vec<Photo>>,
    /// By light, then colour.
    pub noise: Vec<Vec<NoiseModel>>,
    /// The object.
    pub mask: Mask,
    /// What a person should know of the files, each once.
    pub warnings: Vec<String>,
}

/// Reads the object's photos and its mask. Without a mask file the object is the brighter part of the picture.
pub fn load_object(set: &CaptureSet, watch: &dyn PipelineWatch) -> Result<ObjectPhotos, PipelineError> {
    let SubjectPhotos { mut shots, mut warnings } = load_subject(set, Subject::Object, watch)?;
    let mut taken = Vec::with_capacity(set.lights.len());
    for (l, light) in set.lights.iter().enumerate() {
        let mut row = Vec::with_capacity(set.colours.len());
        for (c, colour) in set.colours.iter().enumerate() {
            let missing = || PipelineError::NoShot { light: light.name.clone(), colour: colour.name.clone() };
            row.push(shots.swap_remove(&(l, Some(c))).ok_or_else(missing)?);
        }
        taken.push(row);
    }
    let first = taken.first().and_then(|row| row.first()).ok_or(PipelineError::NoLights)?;
    let size = first.photo.linear.size();
    let mask = match &set.mask {
        Some(written) => {
            let path = set.resolve(written);
            let mask = read_mask(&path)?;
            if mask.size() != size {
                return Err(PipelineError::MaskSize { path, found: mask.size(), expected: size });
            }
            mask
        }
        None => {
            let mask = Mask::brighter_part(&brightest(taken.iter().map(|row| &row[0].photo)));
            warnings.push(format!(
                "no mask given: the object is taken to be the {} brighter pixels of {}",
                mask.count(),
                size.0 * size.1
            ));
            mask
        }
    };
    if mask.count() == 0 {
        return Err(PipelineError::EmptyMask { path: set.mask.as_ref().map(|written| set.resolve(written)) });
    }

    let noise = taken
        .par_iter()
        .zip(&set.lights)
        .map(|(row, light)| {
            let shot = |c: usize| set.shot(Subject::Object, Some(&light.name), Some(&set.colours[c].name));
            row.iter().enumerate().filter_map(|(c, linear)| Some(noise_of(set, shot(c)?, linear, &mask))).collect()
        })
        .collect();
    let photos = taken.into_iter().map(|row| row.into_iter().map(|shot| shot.photo).collect()).collect();
    Ok(ObjectPhotos { photos, noise, mask, warnings })
}

/// Reads every photo of a subject. Files that several shots name, such as RGB photos, are read once.
pub fn load_subject(
    set: &CaptureSet,
    subject: Subject,
    watch: &dyn PipelineWatch,
) -> Result<SubjectPhotos, PipelineError> {
    let mut groups: IndexMap<&[String], Vec<&Shot>> = IndexMap::new();
    set.shots_of(subject).for_each(|shot| groups.entry(&shot.files).or_default().push(shot));
    let count = groups.len();
    let done = std::sync::atomic::AtomicUsize::new(0);
    let groups: Vec<_> = groups.into_iter().collect();
    let loaded: Vec<Vec<(&Shot, LinearLight)>> = groups
        .into_par_iter()
        .map(|(files, shots)| {
            if watch.cancelled() {
                return Err(PipelineError::Cancelled);
            }
            let loaded = load_group(set, files, &shots)?;
            let finished = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
            watch.progress(Stage::Load, finished as f32 / count as f32);
            Ok(loaded)
        })
        .collect::<Result<_, PipelineError>>()?;

    let mut photos = SubjectPhotos { shots: IndexMap::new(), warnings: Vec::new() };
    let mut file_warnings = Vec::new();
    for (shot, linear) in loaded.into_iter().flatten() {
        // Where the file says what encoding a shot has, nobody needs to guess.
        let asks =
            |warning: &ImageWarning| !matches!(warning, ImageWarning::ProbablySrgb { .. } if shot.encoding.is_some());
        file_warnings.extend(linear.warnings.iter().filter(|warning| asks(warning)).cloned());
        let light = shot.light.as_deref().and_then(|name| set.light_index(name)).unwrap_or_default();
        let colour = shot.colour.as_deref().and_then(|name| set.colour_index(name));
        photos.shots.insert((light, colour), linear);
    }
    photos.warnings = in_few_words(&file_warnings);
    check_sizes(set, subject, &photos)?;
    Ok(photos)
}

/// One line for each kind of warning, with its first file and how many more there are.
fn in_few_words(warnings: &[ImageWarning]) -> Vec<String> {
    let mut kinds: IndexMap<_, Vec<&ImageWarning>> = IndexMap::new();
    for warning in warnings {
        let same = kinds.entry(std::mem::discriminant(warning)).or_default();
        if !same.contains(&warning) {
            same.push(warning);
        }
    }
    let words = kinds.values().map(|same| match same.as_slice() {
        [only] => only.to_string(),
        [first, more @ ..] => format!("{first} (and {} more such files)", more.len()),
        [] => String::new(),
    });
    words.collect()
}

fn check_sizes(set: &CaptureSet, subject: Subject, photos: &SubjectPhotos) -> Result<(), PipelineError> {
    let expected = photos.all().next().map(|photo| photo.linear.size());
    let Some(expected) = expected else { return Ok(()) };
    for (&(light, colour), shot) in &photos.shots {
        let found = shot.photo.linear.size();
        if found != expected {
            let light = Some(set.lights[light].name.as_str());
            let colour = colour.map(|colour| set.colours[colour].name.as_str());
            let file = set.shot(subject, light, colour).and_then(|shot| shot.files.first());
            let path = set.resolve(file.map_or("", String::as_str));
            return Err(PipelineError::PhotoSize { path, found, expected });
        }
    }
    Ok(())
}

/// The shots that share one list of files.
pub(super) fn load_group<'a>(
    set: &CaptureSet,
    files: &[String],
    shots: &[&'a Shot],
) -> Result<Vec<(&'a Shot, LinearLight)>, PipelineError> {
    let paths: Vec<_> = files.iter().map(|file| set.resolve(file)).collect();
    if let [shot] = shots {
        let corrections = OwnCorrections::load(set, shot)?;
        let linear = linearise_files(&paths, &linear_options(set, shot), &corrections.borrow())?;
        return Ok(vec![(shot, linear)]);
    }
    let images = paths.iter().map(|path| read_image(path)).collect::<Result<Vec<_>, _>>()?;
    let linear = |shot: &&'a Shot| {
        let corrections = OwnCorrections::load(set, shot)?;
        let images = images.iter().map(Ok::<&ImageFile, ImageError>);
        Ok((*shot, linearise(images, &linear_options(set, shot), &corrections.borrow())?))
    };
    shots.par_iter().map(linear).collect()
}

/// How the files of a shot become light.
fn linear_options(set: &CaptureSet, shot: &Shot) -> LinearOptions {
    let camera = &set.camera;
    let noise_floor = match (camera.read_noise_electrons, camera.full_well_electrons) {
        (Some(read), Some(full)) => Some((read / full) as f32),
        _ => None,
    };
    LinearOptions {
        channel: set.channel_of(shot),
        encoding: set.encoding_of(shot),
        black_level: camera.black_level as f32,
        white_level: camera.white_level.map(|level| level as f32),
        exposure: shot.exposure as f32,
        noise_floor,
        ..LinearOptions::default()
    }
}

/// The dark frame and flat field that fit a shot.
struct OwnCorrections {
    dark: Option<DarkFrame>,
    flat: Option<FlatField>,
}

impl OwnCorrections {
    fn load(set: &CaptureSet, shot: &Shot) -> Result<Self, PipelineError> {
        let channel = set.channel_of(shot);
        let dark = best_dark(set, shot).map(|dark| load_dark(set, dark, channel)).transpose()?;
        let flat = best_flat(set, shot)
            .map(|flat| {
                let options = LinearOptions { channel, ..linear_options(set, flat) };
                let dark = best_dark(set, flat).map(|dark| load_dark(set, dark, channel)).transpose()?;
                flat_field(images_of(set, flat), &options, dark.as_ref())
            })
            .transpose()?;
        Ok(Self { dark, flat })
    }

    fn borrow(&self) -> Corrections<'_> {
        Corrections { dark: self.dark.as_ref(), flat: self.flat.as_ref() }
    }
}

fn images_of<'a>(set: &'a CaptureSet, shot: &'a Shot) -> impl Iterator<Item = Result<ImageFile, ImageError>> + 'a {
    shot.files.iter().map(|file| read_image(&set.resolve(file)))
}

fn load_dark(set: &CaptureSet, dark: &Shot, channel: Channel) -> Result<DarkFrame, ImageError> {
    dark_frame(images_of(set, dark), &LinearOptions { channel, ..linear_options(set, dark) })
}

/// The dark frame of the exposure nearest to the shot's: what a sensor gathers without light grows with it. Dark frames
/// are looked at as they are.
fn best_dark<'a>(set: &'a CaptureSet, shot: &Shot) -> Option<&'a Shot> {
    let distance = |dark: &&Shot| (dark.exposure / shot.exposure).ln().abs();
    let darks = set.shots_of(Subject::Dark).filter(|_| shot.subject != Subject::Dark);
    darks.min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// The flat field that agrees with the shot in the most of light and colour, and contradicts it in none. Dark frames and
/// flat fields need none.
fn best_flat<'a>(set: &'a CaptureSet, shot: &Shot) -> Option<&'a Shot> {
    let fits = |mine: &Option<String>, its: &Option<String>| its.is_none() || mine == its;
    let agreement = |flat: &&Shot| usize::from(flat.light.is_some()) + usize::from(flat.colour.is_some());
    let corrected = !matches!(shot.subject, Subject::Dark | Subject::FlatField);
    set.shots_of(Subject::FlatField)
        .filter(|flat| corrected && fits(&shot.light, &flat.light) && fits(&shot.colour, &flat.colour))
        .max_by_key(agreement)
}

/// The noise of a shot: from the camera's numbers, else from its repeats, else from its grain.
fn noise_of(set: &CaptureSet, shot: &Shot, linear: &LinearLight, mask: &Mask) -> NoiseModel {
    let exposure = shot.exposure;
    if let (Some(full), Some(read)) = (set.camera.full_well_electrons, set.camera.read_noise_electrons) {
        return NoiseModel::of_camera(full, read, linear.repeats, exposure);
    }
    let of_repeats = linear.noise.as_ref().and_then(|noise| {
        let pairs: Vec<_> = noise.bins.iter().map(|bin| (bin.signal, bin.variance)).collect();
        NoiseModel::fit(&pairs, NoiseSource::Repeats)
    });
    match of_repeats {
        // The fit is that of one frame before it is divided by the exposure.
        Some(frame) => {
            let frames = linear.repeats as f64;
            NoiseModel {
                floor: frame.floor / exposure.powi(2) / frames,
                per_signal: frame.per_signal / exposure / frames,
                ..frame
            }
        }
        None => estimate_noise(&linear.photo, mask, f64::from(linear.quantisation_step)),
    }
}

/// The largest light of each pixel.
fn brightest<'a>(mut photos: impl Iterator<Item = &'a Photo>) -> Plane {
    let Some(first) = photos.next() else { return Plane::filled(0, 0, 0.0) };
    photos.fold(first.linear.clone(), |mut brightest, photo| {
        brightest.data_mut().par_iter_mut().zip(photo.linear.data()).for_each(|(most, light)| *most = most.max(*light));
        brightest
    })
}
