//! What a photo in linear light depends on: its files as they are on the disk, how they become light, what corrects them.

use std::path::PathBuf;
use std::time::SystemTime;

use firstbounce_core::image::distortion::Lens;

use super::Exposures;
use crate::image_file::LinearOptions;
use crate::set::{Camera, CaptureSet, Shot, Subject};

/// A file as it is on the disk.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Stamped {
    pub path: PathBuf,
    /// Which layer is read of it.
    pub layer: Option<String>,
    /// When it was written last and how long it is; `None` where the system does not tell.
    stamp: Option<(SystemTime, u64)>,
}

/// Averaged files.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FrameKey {
    pub files: Vec<Stamped>,
    pub options: LinearOptions,
}

/// A flat field, and the dark frame taken from it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FlatKey {
    pub frame: FrameKey,
    pub dark: Option<FrameKey>,
}

/// A photo, and the frames that correct it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PhotoKey {
    pub frame: FrameKey,
    pub dark: Option<FrameKey>,
    pub flat: Option<FlatKey>,
    pub subject: Subject,
    /// By file, the exposures of a bracket.
    bracket: Option<Vec<f64>>,
    /// How the lens draws, where that is undone.
    pub lens: Option<LensKey>,
}

/// A key by which something is kept.
pub(super) trait Key: PartialEq + Clone {
    /// Whether what is kept by `kept` is what is wanted. A file that is gone has been read as it was.
    fn is_kept_as(&self, kept: &Self) -> bool;
}

impl Key for FrameKey {
    fn is_kept_as(&self, kept: &Self) -> bool {
        let files = || self.files.iter().zip(&kept.files);
        let same = |(file, kept): (&Stamped, &Stamped)| {
            (&file.path, &file.layer) == (&kept.path, &kept.layer) && (file.stamp.is_none() || file.stamp == kept.stamp)
        };
        self.options == kept.options && self.files.len() == kept.files.len() && files().all(same)
    }
}

impl Key for FlatKey {
    fn is_kept_as(&self, kept: &Self) -> bool {
        self.frame.is_kept_as(&kept.frame) && both_are_kept(&self.dark, &kept.dark)
    }
}

impl Key for PhotoKey {
    fn is_kept_as(&self, kept: &Self) -> bool {
        self.subject == kept.subject
            && self.bracket == kept.bracket
            && self.lens == kept.lens
            && self.frame.is_kept_as(&kept.frame)
            && both_are_kept(&self.dark, &kept.dark)
            && both_are_kept(&self.flat, &kept.flat)
    }
}

fn both_are_kept<K: Key>(wanted: &Option<K>, kept: &Option<K>) -> bool {
    match (wanted, kept) {
        (Some(wanted), Some(kept)) => wanted.is_kept_as(kept),
        (wanted, kept) => wanted.is_none() && kept.is_none(),
    }
}

impl PhotoKey {
    /// Of a shot as it is now.
    pub fn of(set: &CaptureSet, shot: &Shot, exposures: &Exposures) -> Self {
        let channel = set.channel_of(shot);
        let frame = |of: &Shot| FrameKey {
            files: of.files.iter().map(|file| Stamped::of(set.resolve(file), set.layer_of(of))).collect(),
            options: LinearOptions { channel, ..linear_options(set, of, exposures) },
        };
        let dark_of = |of: &Shot| best_dark(set, of, exposures).map(frame);
        let flat = best_flat(set, shot).map(|flat| FlatKey { frame: frame(flat), dark: dark_of(flat) });
        let bracket = exposures.bracket(shot).map(<[f64]>::to_vec);
        let is_frame = matches!(shot.subject, Subject::Dark | Subject::FlatField);
        let lens = LensKey::of(set).filter(|_| !is_frame);
        Self { frame: frame(shot), dark: dark_of(shot), flat, subject: shot.subject, bracket, lens }
    }
}

/// What of a camera says how its lens draws.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LensKey(Camera);

impl LensKey {
    fn of(set: &CaptureSet) -> Option<Self> {
        let Camera { projection, distortion, .. } = set.camera;
        distortion.map(|_| Self(Camera { projection, distortion, ..Camera::default() }))
    }

    /// The lens before a picture of this size.
    pub fn lens(&self, size: (usize, usize)) -> Option<Lens> {
        self.0.lens(size)
    }
}

impl Stamped {
    pub fn of(path: PathBuf, layer: Option<&str>) -> Self {
        let facts = path.metadata().ok();
        let stamp = facts.and_then(|facts| Some((facts.modified().ok()?, facts.len())));
        Self { path, layer: layer.map(str::to_owned), stamp }
    }
}

/// How the files of a shot become light.
fn linear_options(set: &CaptureSet, shot: &Shot, exposures: &Exposures) -> LinearOptions {
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
        exposure: exposures.exposure(shot) as f32,
        noise_floor,
        ..LinearOptions::default()
    }
}

/// The dark frame of the exposure nearest to the shot's: what a sensor gathers without light grows with it. Dark frames
/// are looked at as they are.
fn best_dark<'a>(set: &'a CaptureSet, shot: &Shot, exposures: &Exposures) -> Option<&'a Shot> {
    let distance = |dark: &&Shot| (exposures.exposure(dark) / exposures.exposure(shot)).ln().abs();
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
