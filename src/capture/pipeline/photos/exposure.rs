//! The relative exposure of each shot: stated in the capture file, or else by what its files say.

use std::collections::HashMap;
use std::path::Path;

use crate::image_file::{ImageWarning, Metadata};
use crate::set::{CaptureSet, Shot, Subject};

use super::ShotNotes;

/// Exposures that differ by less are one: cameras round what they write.
const SAME_WITHIN: f64 = 0.01;
/// The exposure of a shot of which nothing states one.
const UNSTATED: f64 = 1.0;

/// The relative exposures of the shots of a set.
///
/// A shot of which the capture file states none has what its files say: time x ISO / f-number^2, relative to the exposure
/// that most files of the set have. Where the capture file states some, theirs is the scale. A value that not all files
/// state, or that is the same for all, counts for none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Exposures {
    /// By the files of a shot, where they state one.
    of_files: HashMap<Vec<String>, f64>,
    /// By the files of a shot that were exposed differently, by file.
    of_brackets: HashMap<Vec<String>, Vec<f64>>,
}

impl Exposures {
    /// Of a set, by what its files say of themselves.
    pub fn of(set: &CaptureSet, metadata: impl Fn(&Path) -> Option<Metadata>) -> Self {
        let files: HashMap<&str, Metadata> =
            set.distinct_files().keys().filter_map(|file| Some((*file, metadata(&set.resolve(file))?))).collect();
        let timed = || files.values().filter(|metadata| metadata.exposure_s.is_some());
        let all_have = |value: fn(&Metadata) -> Option<f64>| timed().all(|metadata| value(metadata).is_some());
        let (has_iso, has_f_number) = (all_have(|file| file.iso), all_have(|file| file.f_number));
        let light = |file: &String| {
            let metadata = files.get(file.as_str())?;
            let iso = metadata.iso.filter(|_| has_iso).unwrap_or(1.0);
            let f_number = metadata.f_number.filter(|_| has_f_number).unwrap_or(1.0);
            Some(metadata.exposure_s? * iso / f_number.powi(2))
        };
        let of_shot = |shot: &Shot| {
            let lights = shot.files.iter().map(light).collect::<Option<Vec<f64>>>();
            lights.filter(|lights| !lights.is_empty())
        };
        let is_one = |lights: &[f64]| lights.iter().all(|light| is_same(*light, lights[0]));
        let all: Vec<(&Shot, Vec<f64>)> = set.shots.iter().filter_map(|shot| Some((shot, of_shot(shot)?))).collect();
        let known: Vec<(&Shot, f64)> =
            all.iter().filter(|(_, lights)| is_one(lights)).map(|(shot, lights)| (*shot, lights[0])).collect();
        let lights: Vec<f64> = all.iter().flat_map(|(_, lights)| lights.iter().copied()).collect();
        let Some(usual) = most_frequent(&lights) else { return Self::default() };
        if lights.iter().all(|light| is_same(*light, usual)) {
            return Self::default();
        }
        let of_stated = known.iter().find_map(|(shot, light)| Some(light / shot.exposure?));
        let unit = of_stated.unwrap_or(usual);
        let relative = |lights: &[f64]| lights.iter().map(|light| rounded(light / unit)).collect();
        let brackets = all.iter().filter(|(_, lights)| !is_one(lights));
        Self {
            of_files: known.iter().map(|(shot, light)| (shot.files.clone(), rounded(light / unit))).collect(),
            of_brackets: brackets.map(|(shot, lights)| (shot.files.clone(), relative(lights))).collect(),
        }
    }

    /// The exposure of a shot.
    pub fn exposure(&self, shot: &Shot) -> f64 {
        shot.exposure.or(self.filled_in(shot)).unwrap_or(UNSTATED)
    }

    /// Where the files of a shot are a bracket, their exposures: stated, or else by what they say of themselves.
    pub(super) fn bracket<'a>(&'a self, shot: &'a Shot) -> Option<&'a [f64]> {
        // Dark frames and flat fields are averaged.
        if matches!(shot.subject, Subject::Dark | Subject::FlatField) {
            return None;
        }
        let stated =
            Some(&*shot.exposures).filter(|exposures| exposures.len() == shot.files.len() && exposures.len() > 1);
        let of_files = || self.of_brackets.get(&shot.files).filter(|_| shot.exposure.is_none()).map(Vec::as_slice);
        stated.or_else(of_files)
    }

    /// What was filled in for a shot of which the capture file states none.
    pub fn filled_in(&self, shot: &Shot) -> Option<f64> {
        self.of_files.get(&shot.files).copied().filter(|_| shot.exposure.is_none())
    }
}

/// What the user should know of the exposures of shots that are to be compared with each other.
pub(super) fn warnings(shots: &[(&Shot, &ShotNotes)]) -> Vec<ImageWarning> {
    let files: Vec<_> = shots.iter().flat_map(|(_, light)| &light.files).collect();
    let filled_in =
        shots.iter().filter(|(shot, light)| shot.exposure.is_none() && !is_same(f64::from(light.exposure), UNSTATED));
    let filled_in = filled_in.filter_map(|(_, light)| {
        let (path, _) = light.files.first()?;
        Some(ImageWarning::ExposureFilledIn { path: path.clone(), exposure: f64::from(light.exposure) })
    });
    let others = |value: fn(&Metadata) -> Option<f64>| {
        let values: Vec<f64> = files.iter().filter_map(|(_, metadata)| value(metadata)).collect();
        let usual = most_frequent(&values);
        let other = move |metadata: &Metadata| {
            let (value, usual) = (value(metadata)?, usual?);
            (!is_same(value, usual)).then_some((value, usual))
        };
        files.iter().filter_map(move |(path, metadata)| Some((path.clone(), other(metadata)?)))
    };
    let iso = others(|metadata| metadata.iso).map(|(path, (iso, usual_iso))| ImageWarning::OtherSensitivity {
        path,
        iso,
        usual_iso,
    });
    let aperture = others(|metadata| metadata.f_number)
        .map(|(path, (f_number, usual_f_number))| ImageWarning::OtherAperture { path, f_number, usual_f_number });
    filled_in.chain(iso).chain(aperture).collect()
}

fn is_same(a: f64, b: f64) -> bool {
    (a / b).ln().abs() <= SAME_WITHIN
}

/// The value that most of them have; the largest of several.
fn most_frequent(values: &[f64]) -> Option<f64> {
    let count = |value: &f64| values.iter().filter(|other| is_same(**other, *value)).count();
    values.iter().copied().max_by(|a, b| count(a).cmp(&count(b)).then(a.total_cmp(b)))
}

/// To six digits, so that a table reads 0.5 and not 0.49999999999999994.
fn rounded(exposure: f64) -> f64 {
    format!("{exposure:.5e}").parse().unwrap_or(exposure)
}
