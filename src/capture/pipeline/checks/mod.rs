//! Capture checks: whether photos and rig are as a capture should be, before anyone trusts a normal. What is wrong is a list of
//! capture warnings, the worst first: the same in `info`, `calibrate`, `solve`, the reports and the window.
//!
//! [`CaptureCheck`] is shown the photos one by one and needs no solution; [`CheckedPhotos::with_rig`] holds the rig against them, and
//! [`check_surface`] looks at the surface that was found.

mod equal_files;
mod facts;
mod files;
mod fringe;
mod lamps;
mod moved;
mod rig;
mod surface;
#[cfg(test)]
mod tests;
mod warning;
mod words;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Mutex, OnceLock, PoisonError};

use firstbounce_core::Mask;
use firstbounce_core::capture_checks::{
    EdgeSpectrum, EdgeWindow, FringeOptions, FringeSpectrum, FringeWindow, LampOptions, ShiftOptions, SmallPhoto,
};
use firstbounce_core::options::{OptionError, check_range};

use super::watch::Part;
use super::{Calibrated, Exposed, PhotoStore, PipelineError, PipelineWatch, ShotLight, ShotNotes, Stage};
use crate::image_file::{FileFacts, read_mask};
use crate::set::{CaptureSet, Shot, Subject};

pub(super) use rig::of_rig;
pub use surface::check_surface;
pub use warning::{CaptureWarning, FilesOf};

/// What the capture checks warn of.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct CheckOptions {
    /// Photos that lie beside the others.
    pub shift: ShiftOptions,
    /// Lamps and photos that do not belong together.
    pub lamps: LampOptions,
    /// Edges of one colour that lie beside those of another.
    pub fringe: FringeOptions,
    /// More of the object's pixels than this may not be clipped in a photo: they are left out, and holes are seen from here on.
    pub max_clipped_share: f64,
    /// Repeats that differ by more than this share of their light, but for noise. Lamps flicker by a percent or two.
    pub max_repeat_change: f64,
    /// An island of fewer pixels is none: a speck of the mask.
    pub min_island_px: usize,
    /// Neither is one of a smaller share of the object: a crumb of a shadow.
    pub min_island_share: f64,
}

impl Default for CheckOptions {
    fn default() -> Self {
        let (shift, lamps) = (ShiftOptions::default(), LampOptions::default());
        let fringe = FringeOptions::default();
        Self {
            shift,
            lamps,
            fringe,
            max_clipped_share: 0.01,
            max_repeat_change: 0.05,
            min_island_px: 25,
            min_island_share: 0.001,
        }
    }
}

impl CheckOptions {
    /// Whether every option is in its range.
    pub fn check(&self) -> Result<(), OptionError> {
        self.shift.check()?;
        self.lamps.check()?;
        self.fringe.check()?;
        let clipped = self.max_clipped_share;
        check_range("max_clipped_share", clipped, (0.0..=1.0).contains(&clipped), "from 0 to 1")?;
        let change = self.max_repeat_change;
        check_range("max_repeat_change", change, change > 0.0 && change.is_finite(), "a positive number")?;
        let share = self.min_island_share;
        check_range("min_island_share", share, (0.0..1.0).contains(&share), "from 0 to below 1")
    }
}

/// What the capture checks found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CaptureReport {
    /// The worst first.
    pub warnings: Vec<CaptureWarning>,
}

impl CaptureReport {
    /// Of warnings in any order.
    pub fn of(mut warnings: Vec<CaptureWarning>) -> Self {
        warnings.sort_by(|one, other| other.badness().total_cmp(&one.badness()));
        Self { warnings }
    }

    /// With those of another check.
    pub fn with(&self, other: Vec<CaptureWarning>) -> Self {
        Self::of(self.warnings.iter().cloned().chain(other).collect())
    }

    /// What other lines say that no capture warning says, each once.
    pub fn others<'l>(&self, lines: impl IntoIterator<Item = &'l String>) -> Vec<String> {
        let mut said = self.lines();
        let known = said.len();
        for line in lines {
            if !said.contains(line) {
                said.push(line.clone());
            }
        }
        said.split_off(known)
    }

    /// A line for each.
    pub fn lines(&self) -> Vec<String> {
        self.warnings.iter().map(ToString::to_string).collect()
    }
}

/// The checks that need no solution, while the photos are shown to them one by one.
pub struct CaptureCheck<'a> {
    set: &'a CaptureSet,
    options: CheckOptions,
    mask: Option<Mask>,
    /// Where edges are looked for, once the size of the object's photos is known.
    window: OnceLock<Option<EdgeWindow>>,
    fringe_window: OnceLock<Option<FringeWindow>>,
    seen: Mutex<BTreeMap<usize, Seen>>,
}

/// What is kept of a photo.
struct Seen {
    files: Vec<FileFacts>,
    /// What the files say of themselves.
    notes: ShotNotes,
    /// Of the object's photos, the share of its pixels that is clipped.
    clipped: f64,
    /// Of the object's photos, where there are several colours.
    fringe: Option<FringeSpectrum>,
    /// Of the object's photos.
    edges: Option<EdgeSpectrum>,
    /// Of the object's photos in the reference colour.
    small: Option<SmallPhoto>,
}

/// What the photos alone show, and what is kept of them to judge the rig by.
#[derive(Clone, Debug, Default)]
pub struct CheckedPhotos {
    /// What is wrong with them.
    pub report: CaptureReport,
    /// By light.
    small: Vec<Option<SmallPhoto>>,
}

impl CheckedPhotos {
    /// What is wrong with photos and rig, once it is known.
    pub fn with_rig(
        &self,
        set: &CaptureSet,
        calibrated: &Calibrated,
        options: &CheckOptions,
        watch: &dyn PipelineWatch,
    ) -> CaptureReport {
        let part = Part::of(watch, Stage::Check, 1, 2);
        let mut of_lamps = rig::of_rig(set, calibrated);
        of_lamps.extend(lamps::lamps(set, &self.small, calibrated, options, &part));
        // That two photos are one file is said already.
        let are_equal = self.report.warnings.iter().any(|warning| matches!(warning, CaptureWarning::EqualFiles { .. }));
        of_lamps.retain(|warning| !(are_equal && warning.kind() == warning::ONE_LAMP_TWICE));
        self.report.with(of_lamps)
    }
}

impl<'a> CaptureCheck<'a> {
    /// Of a set that is about to be looked at.
    ///
    /// # Errors
    /// An option out of its range.
    pub fn new(set: &'a CaptureSet, options: &CheckOptions) -> Result<Self, OptionError> {
        options.check()?;
        let mask = set.mask.as_ref().and_then(|written| read_mask(&set.resolve(written)).ok());
        let mask = mask.map(|file| file.mask);
        Ok(Self {
            set,
            options: *options,
            mask,
            window: OnceLock::new(),
            fringe_window: OnceLock::new(),
            seen: Mutex::default(),
        })
    }

    /// The object, where a mask says so and can be read.
    pub fn mask(&self) -> Option<&Mask> {
        self.mask.as_ref()
    }

    /// Looks at the photo of a shot, by its place in the set.
    pub fn look_at(&self, shot: usize, light: &ShotLight) {
        let (Ok(light), Some(of)) = (light, self.set.shots.get(shot)) else { return };
        let is_object = of.subject == Subject::Object;
        let photo = &light.photo.linear;
        let window = || self.window.get_or_init(|| EdgeWindow::new(photo.size(), self.mask.as_ref())).as_ref();
        let edges = is_object.then(|| window()?.spectrum(photo)).flatten();
        let is_reference = is_object && of.colour.as_ref() == self.set.colours.first().map(|colour| &colour.name);
        let small = is_reference.then(|| SmallPhoto::of(&light.photo, self.mask.as_ref())).flatten();
        let in_parts =
            || self.fringe_window.get_or_init(|| FringeWindow::new(photo.size(), self.mask.as_ref())).as_ref();
        let has_colours = is_object && self.set.colours.len() > 1;
        let fringe = has_colours.then(|| in_parts()?.spectrum(photo)).flatten();
        let clipped = if is_object { Exposed::of(&light.photo, self.mask.as_ref()).clipped } else { 0.0 };
        let (files, notes) = (light.facts.clone(), ShotNotes::from(&**light));
        let seen = Seen { files, notes, clipped, fringe, edges, small };
        self.seen.lock().unwrap_or_else(PoisonError::into_inner).insert(shot, seen);
    }

    /// What was seen.
    ///
    /// # Errors
    /// [`PipelineError::Cancelled`] alone.
    pub fn finish(self, watch: &dyn PipelineWatch) -> Result<CheckedPhotos, PipelineError> {
        let mut seen = self.seen.into_inner().unwrap_or_else(PoisonError::into_inner);
        let part = Part::of(watch, Stage::Check, 0, 2);
        let mut under = |light: &str| {
            let mut of_light =
                seen.iter_mut().filter(|(shot, _)| self.set.shots[**shot].light.as_deref() == Some(light));
            of_light.find_map(|(_, seen)| seen.small.take())
        };
        let small = self.set.lights.iter().map(|light| under(&light.name)).collect();
        let mut warnings = equal_files::equal_files(self.set);
        warnings.extend(facts::facts(self.set, &self.options, &seen));
        warnings.extend(files::clipped(self.set, &self.options, &seen));
        warnings.extend(files::files(self.set, &seen));
        let window = self.fringe_window.into_inner().flatten();
        let fringes = fringe::fringes(self.set, &self.options, window.as_ref(), &seen);
        let moved = moved::moved(self.set, &self.options, seen, &part);
        // Photos that were moved between the colours are shifted alike in all parts of the picture, which is said already.
        let is_said = |fringe: &CaptureWarning| {
            !moved.is_empty() && matches!(fringe, CaptureWarning::ColourFringe { is_uniform: true, .. })
        };
        warnings.extend(fringes.into_iter().filter(|fringe| !is_said(fringe)));
        warnings.extend(moved);
        watch.progress(Stage::Check, 0.5);
        if watch.cancelled() {
            return Err(PipelineError::Cancelled);
        }
        Ok(CheckedPhotos { report: CaptureReport::of(warnings), small })
    }
}

/// The checks of some shots that need no solution, each photo read once and none kept.
///
/// # Errors
/// [`PipelineError::Cancelled`], or an option out of its range.
pub fn check_captures(
    set: &CaptureSet,
    shots: impl Fn(&Shot) -> bool,
    store: &PhotoStore,
    options: &CheckOptions,
    watch: &dyn PipelineWatch,
) -> Result<CheckedPhotos, PipelineError> {
    let check = CaptureCheck::new(set, options).map_err(PipelineError::CheckOption)?;
    let indices: Vec<usize> = (0..set.shots.len()).filter(|index| shots(&set.shots[*index])).collect();
    let looked_at: Vec<&Shot> = indices.iter().map(|index| &set.shots[*index]).collect();
    store.visit(set, &looked_at, watch, &|index, light| check.look_at(indices[index], light))?;
    check.finish(watch)
}

/// A file as the capture file writes it.
fn written(set: &CaptureSet, path: &Path) -> String {
    set.written(path)
}
