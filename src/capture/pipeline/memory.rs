//! How much memory work on a set will take, from the heads of its pictures, before any of them is decoded.
//!
//! A photo in linear light takes 5 bytes a pixel, one of them marks. Decoding takes the file, its samples and its planes, on
//! every core at once. What the stages take was measured: the peak memory of `solve`, `calibrate` and the window on simulated
//! sets of 1 and 4 megapixels with 3 to 8 lights, 2 and 3 colours, 1 and 2 bounces. It is linear in the pixels: `solve` takes
//! 339 bytes a pixel for 3 lights, 2 colours and 2 bounces, the window 425; `calibrate` 193 bytes a pixel of the balls' photos
//! for 3 lights, 297 for 6; `compare` 500 with a truth on either side. Nothing is subtracted for what lies outside the mask.

use indexmap::IndexMap;
use rayon::prelude::*;
use sysinfo::{MemoryRefreshKind, ProcessRefreshKind, ProcessesToUpdate, RefreshKind, System, get_current_pid};
use thiserror::Error;

use super::Preference;
use super::calibrate::needed_subjects;
use crate::image_file::picture_size;
use crate::set::{CaptureSet, Method, Subject};

/// The program itself, with the window's fonts and shaders.
const PROGRAM_BYTES: u64 = 60 << 20;
const WINDOW_BYTES: u64 = 200 << 20;
/// Of a photo in linear light, a pixel: its light and its marks.
const PHOTO_BYTES: u64 = 5;
/// Of a photo that the window shows, a pixel: its copies for the shot, the picture and the graphics card.
const SHOWN_BYTES: u64 = 10;
/// Of a picture that is decoded, a sample of a pixel: as it is stored, and as a number.
const SAMPLE_BYTES: u64 = 8;
/// Of a picture that becomes a photo, a pixel: mean, spread and marks of its repeats, dark frame and flat field.
const AVERAGE_BYTES: u64 = 19;

/// What is done with a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// Balls to alpha, beta, intensity and direction.
    Calibrate,
    /// All stages, once.
    Solve,
    /// All stages, and the truth beside them.
    Evaluate,
    /// All stages, and everything that the window shows of them.
    Window,
    /// The true surface, compared with another.
    Truth,
}

/// How much memory may be taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MemoryOptions {
    /// `None` for what is free.
    pub limit_bytes: Option<u64>,
}

/// What work on a set will take, in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MemoryEstimate {
    /// The program, the photos and whatever else is kept from the first stage to the last.
    pub kept_bytes: u64,
    /// Pictures that are decoded at the same time.
    pub decoding_bytes: u64,
    /// The balls' photos, and what is measured in them.
    pub calibration_bytes: u64,
    /// What is made of the object's photos.
    pub stages_bytes: u64,
}

/// A run that would take more than there is.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error(
    "{title} needs about {} of memory, {} are {}",
    gigabytes(*needed_bytes),
    gigabytes(*available_bytes),
    if *is_limited { "allowed" } else { "free" }
)]
pub struct MemoryShortage {
    /// The set's.
    pub title: String,
    /// What the run would take.
    pub needed_bytes: u64,
    /// What it may take.
    pub available_bytes: u64,
    /// Whether a limit was given; else all is counted that is free.
    pub is_limited: bool,
}

impl MemoryEstimate {
    /// The most at any time: the object's stages follow the calibration, and that follows the decoding.
    pub fn peak_bytes(&self) -> u64 {
        self.kept_bytes + self.decoding_bytes.max(self.calibration_bytes).max(self.stages_bytes)
    }
}

/// Refuses work on a set for which there is not enough memory.
///
/// # Errors
/// [`MemoryShortage`] with what would be needed and what there is.
pub fn check_memory(set: &CaptureSet, work: Work, options: &MemoryOptions) -> Result<MemoryEstimate, MemoryShortage> {
    let estimate = estimate_memory(set, work);
    let needed_bytes = estimate.peak_bytes();
    match options.limit_bytes.or_else(free_memory_bytes) {
        Some(available_bytes) if needed_bytes > available_bytes => Err(MemoryShortage {
            title: set.title(),
            needed_bytes,
            available_bytes,
            is_limited: options.limit_bytes.is_some(),
        }),
        _ => Ok(estimate),
    }
}

/// What work on a set will take. Pictures that cannot be read count nothing: what is wrong with them is told when they are
/// read.
pub fn estimate_memory(set: &CaptureSet, work: Work) -> MemoryEstimate {
    let ball_subjects = match work {
        Work::Solve | Work::Evaluate => needed_subjects(set, Preference::File),
        Work::Calibrate | Work::Window => needed_subjects(set, Preference::Balls),
        Work::Truth => Vec::new(),
    };
    let balls = Pictures::of_subjects(set, &ball_subjects);
    let mut object = match work {
        Work::Solve | Work::Evaluate | Work::Window => Pictures::of_subjects(set, &[Subject::Object]),
        Work::Calibrate | Work::Truth => Pictures::default(),
    };
    match work {
        Work::Solve | Work::Window => object.add_files(set, set.mask.as_slice()),
        Work::Evaluate => object.add_files(set, &[set.mask.as_slice(), &truth_files(set)].concat()),
        Work::Truth => object.add_files(set, &truth_files(set)),
        Work::Calibrate => {}
    }
    let corrections = Pictures::of_subjects(set, &[Subject::Dark, Subject::FlatField]);
    let (lights, bounces) = (set.lights.len() as u64, set.bounces() as u64);

    let mut decoding: Vec<u64> =
        [&balls, &object, &corrections].into_iter().flat_map(Pictures::decoding_bytes).collect();
    decoding.sort_unstable_by(|a, b| b.cmp(a));
    // Photos whose crosstalk is undone lie beside those that were read.
    let photo_bytes = if set.has_crosstalk() { 2 * PHOTO_BYTES } else { PHOTO_BYTES };
    let mut estimate = MemoryEstimate {
        kept_bytes: PROGRAM_BYTES + photo_bytes * object.photo_pixels(),
        decoding_bytes: decoding.iter().take(rayon::current_num_threads()).sum(),
        calibration_bytes: photo_bytes * balls.photo_pixels() + (100 + 10 * lights) * balls.pixels(),
        stages_bytes: match work {
            Work::Truth => 500 * object.pixels(),
            _ => (215 + (20 + 8 * bounces) * lights) * object.pixels(),
        },
    };
    if work == Work::Window {
        let photo_pixels = balls.photo_pixels() + object.photo_pixels() + corrections.photo_pixels();
        // Indirect light, its colour ratios and its amount, which only one method finds.
        let maps = if set.method() == Method::ColoursAndShape { set.colours.len() as u64 + 1 } else { 0 };
        let shown_bytes = SHOWN_BYTES * photo_pixels + (20 + 8 * lights + 4 * lights * maps) * object.pixels();
        estimate.kept_bytes += WINDOW_BYTES + shown_bytes + std::mem::take(&mut estimate.calibration_bytes);
    }
    estimate
}

/// Refuses the shots of one group of files where as many of them as there are cores would need more than `available_bytes`.
pub(super) fn check_group(
    set: &CaptureSet,
    files: &[String],
    shots: usize,
    available_bytes: Option<u64>,
) -> Result<(), MemoryShortage> {
    let group = Group::of(set, files, shots as u64);
    let one = group.decoding_bytes + group.photos * group.pixels * PHOTO_BYTES;
    let needed_bytes = one * rayon::current_num_threads() as u64;
    match available_bytes.filter(|available_bytes| needed_bytes > *available_bytes) {
        Some(available_bytes) => Err(MemoryShortage {
            title: files.first().cloned().unwrap_or_default(),
            needed_bytes,
            available_bytes,
            is_limited: false,
        }),
        None => Ok(()),
    }
}

/// Normals, depth and direct light.
fn truth_files(set: &CaptureSet) -> Vec<String> {
    let direct = set.lights.iter().map(|light| set.truth_bounce(1, &light.name));
    let files = [set.truth_normals(), set.truth_depth()].into_iter().chain(direct);
    files.map(|file| set.written(&file)).collect()
}

/// Pictures that are read, by the files that are read together.
#[derive(Default)]
struct Pictures(Vec<Group>);

impl Pictures {
    fn of_subjects(set: &CaptureSet, subjects: &[Subject]) -> Self {
        let mut shots: IndexMap<(Subject, &[String]), u64> = IndexMap::new();
        for shot in set.shots.iter().filter(|shot| subjects.contains(&shot.subject)) {
            *shots.entry((shot.subject, &shot.files)).or_default() += 1;
        }
        let shots: Vec<_> = shots.into_iter().collect();
        Self(shots.into_par_iter().map(|((_, files), photos)| Group::of(set, files, photos)).collect())
    }

    /// Files of one picture each.
    fn add_files(&mut self, set: &CaptureSet, files: &[String]) {
        self.0.extend(files.iter().map(|file| Group::of(set, std::slice::from_ref(file), 1)));
    }

    fn decoding_bytes(&self) -> impl Iterator<Item = u64> {
        self.0.iter().map(|group| group.decoding_bytes)
    }

    /// Of all photos together.
    fn photo_pixels(&self) -> u64 {
        self.0.iter().map(|group| group.photos * group.pixels).sum()
    }

    /// Of the largest photo.
    fn pixels(&self) -> u64 {
        self.0.iter().map(|group| group.pixels).max().unwrap_or(0)
    }
}

/// Files that are read together.
struct Group {
    /// Photos that are made of them.
    photos: u64,
    /// Of one photo.
    pixels: u64,
    /// While they are made.
    decoding_bytes: u64,
}

impl Group {
    fn of(set: &CaptureSet, files: &[String], photos: u64) -> Self {
        let sizes = files.iter().filter_map(|file| {
            let path = set.resolve(file);
            let size = picture_size(&path).ok()?;
            let pixels = (size.width as u64).saturating_mul(size.height as u64);
            let samples = pixels.saturating_mul(size.channels as u64);
            let file_bytes = path.metadata().map_or(0, |facts| facts.len());
            Some((pixels, samples.saturating_mul(SAMPLE_BYTES).saturating_add(file_bytes)))
        });
        let sizes: Vec<_> = sizes.collect();
        let pixels = sizes.iter().map(|(pixels, _)| *pixels).max().unwrap_or(0);
        // Files of several photos are kept until all of these are made; those of one are read one after the other.
        let files_bytes = sizes.iter().map(|(_, bytes)| *bytes);
        let files_bytes = if photos > 1 { files_bytes.sum() } else { files_bytes.max().unwrap_or(0) };
        let decoding_bytes = files_bytes + photos * pixels * AVERAGE_BYTES;
        Self { photos, pixels, decoding_bytes }
    }
}

/// Memory that this process may take: what the system has free, or what the limits of its control groups leave; with what it
/// holds already, for results of before give way to new ones. `None` where the system does not tell.
pub fn free_memory_bytes() -> Option<u64> {
    let memory = RefreshKind::nothing().with_memory(MemoryRefreshKind::nothing().with_ram());
    let mut system = System::new_with_specifics(memory).ok()?;
    let free = Some(system.available_memory()).filter(|free| *free > 0)?;
    let Ok(id) = get_current_pid() else { return Some(free) };
    let of_process = ProcessRefreshKind::nothing().with_memory();
    system.refresh_processes_specifics(ProcessesToUpdate::Some(&[id]), false, of_process);
    let Some(own) = system.process(id) else { return Some(free) };
    // Files that the system keeps count as used in a group, and are given back.
    let left = own.cgroup_limits().map(|limits| limits.total_memory.saturating_sub(limits.rss));
    Some(free.min(left.unwrap_or(free)) + own.memory())
}

/// "21.4 GB"
fn gigabytes(bytes: u64) -> String {
    format!("{:.1} GB", bytes as f64 / 1e9)
}

#[cfg(test)]
mod tests {
    use firstbounce_core::Plane;

    use super::*;
    use crate::image_file::grey16_png;
    use crate::set::{Colour, Light, Shot};

    /// A set with one photo of 100 x 50 pixels, and its folder.
    fn set() -> (tempfile::TempDir, CaptureSet) {
        let folder = tempfile::tempdir().unwrap();
        let picture = grey16_png(&Plane::filled(100, 50, 0.25), 1.0).unwrap();
        std::fs::write(folder.path().join("photo.png"), picture).unwrap();
        let set = CaptureSet {
            folder: folder.path().to_owned(),
            name: "Vase".into(),
            lights: vec![Light { name: "left".into(), ..Light::default() }],
            colours: vec![Colour { name: "blue".into(), ..Colour::default() }],
            shots: vec![Shot {
                light: Some("left".into()),
                colour: Some("blue".into()),
                files: vec!["photo.png".into()],
                ..Shot::default()
            }],
            ..CaptureSet::default()
        };
        (folder, set)
    }

    #[test]
    fn memory_grows_with_the_pixels_that_the_pictures_state() {
        let (_folder, set) = set();
        let solve = estimate_memory(&set, Work::Solve);
        assert_eq!(solve.kept_bytes, PROGRAM_BYTES + 5 * 5000);
        assert_eq!(solve.stages_bytes, (215 + 28) * 5000);
        assert!(solve.decoding_bytes > (8 + 19) * 5000);
        assert!(estimate_memory(&set, Work::Window).peak_bytes() > solve.peak_bytes());
        assert_eq!(estimate_memory(&set, Work::Calibrate).peak_bytes(), PROGRAM_BYTES, "it has no ball");
        let gone = CaptureSet { folder: "nowhere".into(), ..set };
        assert_eq!(estimate_memory(&gone, Work::Solve).peak_bytes(), PROGRAM_BYTES);
    }

    #[test]
    fn work_that_takes_more_than_its_limit_is_refused_in_numbers() {
        let (_folder, set) = set();
        let refused = check_memory(&set, Work::Solve, &MemoryOptions { limit_bytes: Some(40_000_000) }).unwrap_err();
        assert_eq!(refused.to_string(), "Vase needs about 0.1 GB of memory, 0.0 GB are allowed");
        assert!(check_memory(&set, Work::Solve, &MemoryOptions { limit_bytes: Some(80_000_000) }).is_ok());
    }

    #[test]
    fn this_system_tells_what_is_free() {
        if cfg!(any(target_os = "linux", target_os = "macos", windows)) {
            assert!(free_memory_bytes().unwrap() > 1 << 20);
        }
    }
}
