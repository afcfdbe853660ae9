//! How well each photo is exposed: what the captures table shows and `firstbounce info` prints.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use firstbounce_core::image::photo::{CLIPPED, DARK};
use firstbounce_core::{Mask, Photo, Plane};
use indexmap::IndexMap;
use rayon::prelude::*;

use super::memory::{MemoryOptions, Work, check_group, check_memory, free_memory_bytes};
use super::{
    Calibrated, CaptureCheck, CaptureReport, CheckOptions, PhotoStore, PipelineError, PipelineWatch, Preference,
    calibrate_with,
};
use crate::image_file::LinearLight;
use crate::set::{CaptureSet, Shot, Subject};

/// How well a photo is exposed. Of the object's photos the mask's pixels count, of a ball's those in its circle; all
/// where neither is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposed {
    /// `(width, height)` of the photo in pixels.
    pub size: (usize, usize),
    /// Pixels that count.
    pub pixels: usize,
    /// Share of them at the white level, 0 to 1.
    pub clipped: f64,
    /// Share of them within the noise of no light, 0 to 1.
    pub dark: f64,
    /// Their mean linear light; the white level at exposure 1 is 1.
    pub mean: f64,
}

impl Exposed {
    /// Of a photo's pixels within `region`, or of all where there is none or it has another size.
    pub fn of(photo: &Photo, region: Option<&Mask>) -> Self {
        let size = photo.linear.size();
        let region = region.filter(|region| region.size() == size).map(Mask::data);
        let pixels = photo.linear.data().par_iter().zip(photo.marks.data()).enumerate();
        let sum = pixels
            .filter(|(index, _)| region.is_none_or(|inside| inside[*index]))
            .map(|(_, (light, mark))| {
                (1, usize::from(mark & CLIPPED != 0), usize::from(mark & DARK != 0), f64::from(*light))
            })
            .reduce(|| (0, 0, 0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1, a.2 + b.2, a.3 + b.3));
        let count = sum.0.max(1) as f64;
        Self { size, pixels: sum.0, clipped: sum.1 as f64 / count, dark: sum.2 as f64 / count, mean: sum.3 / count }
    }
}

/// The pixels of a shot of this size that matter: the object's mask, or the disc of a ball; `None` for all.
pub fn region_of(set: &CaptureSet, shot: &Shot, mask: Option<&Mask>, size: (usize, usize)) -> Option<Mask> {
    match shot.subject.sphere_kind() {
        Some(kind) => {
            let circle = set.circle(shot.subject, kind)?;
            Some(Mask::stroke(size, &[circle.centre], circle.radius)).filter(|disc| disc.count() > 0)
        }
        None => mask.filter(|mask| shot.subject == Subject::Object && mask.size() == size && mask.count() > 0).cloned(),
    }
}

/// What a look at every photo showed.
#[derive(Clone, Debug, PartialEq)]
pub struct Surveyed {
    /// By shot, in the order of the set: how well it is exposed, or why it cannot be read.
    pub shots: Vec<Result<Exposed, String>>,
    /// What is wrong with the captures.
    pub captures: CaptureReport,
}

/// Looks at every photo, each file once, and checks them, with the rig where the set's file or its balls say enough of it. One line says why a photo cannot be read, and the others are looked at all
/// the same. A photo for which memory lacks is not decoded.
///
/// # Errors
/// [`PipelineError::Cancelled`] alone.
pub fn survey(set: &CaptureSet, watch: &dyn PipelineWatch) -> Result<Surveyed, PipelineError> {
    let options = CheckOptions::default();
    let check = CaptureCheck::new(set, &options).map_err(PipelineError::CheckOption)?;
    let store = PhotoStore::default();
    // First, for it keeps the photos of the balls.
    let rig = rig_of(set, &store, watch)?;
    // Shots of the same files, as an RGB photo's three colours are, are made of one reading.
    let mut groups: IndexMap<&[String], Vec<usize>> = IndexMap::new();
    set.shots.iter().enumerate().for_each(|(index, shot)| groups.entry(&shot.files).or_default().push(index));
    let available_bytes = free_memory_bytes();
    let groups: Vec<_> = groups.into_iter().collect();
    let lacking = groups.par_iter().flat_map_iter(|(files, shots)| {
        let shortage = check_group(set, files, shots.len(), available_bytes).err();
        shots.iter().filter_map(move |&index| Some((index, shortage.as_ref()?.to_string())))
    });
    let lacking: HashMap<usize, String> = lacking.collect();
    let fits: Vec<usize> = (0..set.shots.len()).filter(|index| !lacking.contains_key(index)).collect();
    let shots: Vec<&Shot> = fits.iter().map(|&index| &set.shots[index]).collect();
    let seen: Vec<_> = (0..set.shots.len()).map(|index| Mutex::new(lacking.get(&index).cloned().map(Err))).collect();
    store.visit(set, &shots, watch, &|index, light| {
        let exposed = |light: &Arc<LinearLight>| {
            let region = region_of(set, shots[index], check.mask(), light.photo.linear.size());
            Exposed::of(&light.photo, region.as_ref())
        };
        check.look_at(fits[index], light);
        let outcome = light.as_ref().map(exposed).map_err(ToString::to_string);
        *seen[fits[index]].lock().unwrap_or_else(PoisonError::into_inner) = Some(outcome);
    })?;
    let checked = check.finish(watch)?;
    let captures = rig.map_or_else(|| checked.report.clone(), |rig| checked.with_rig(set, &rig, &options, watch));
    let shots = seen.into_iter().filter_map(|seen| seen.into_inner().unwrap_or_else(PoisonError::into_inner)).collect();
    Ok(Surveyed { shots, captures })
}

/// The rig, as far as it is known and memory allows to look at its balls: a set that is not complete yet has none.
fn rig_of(
    set: &CaptureSet,
    store: &PhotoStore,
    watch: &dyn PipelineWatch,
) -> Result<Option<Calibrated>, PipelineError> {
    if check_memory(set, Work::Calibrate, &MemoryOptions::default()).is_err() {
        return Ok(None);
    }
    match calibrate_with(set, Preference::File, store, watch) {
        Err(PipelineError::Cancelled) => Err(PipelineError::Cancelled),
        rig => Ok(rig.ok()),
    }
}

/// A small copy of a picture whose longer side is at most `longest_px`: each pixel is the mean of those it stands for.
pub fn thumbnail(plane: &Plane, longest_px: usize) -> Plane {
    let (width, height) = plane.size();
    let longest = width.max(height);
    if longest <= longest_px || longest_px == 0 {
        return plane.clone();
    }
    let reduced = |side: usize| (side * longest_px / longest).max(1);
    let (columns, rows) = (reduced(width), reduced(height));
    let span =
        |index: usize, of: usize, side: usize| index * side / of..((index + 1) * side / of).max(index * side / of + 1);
    let data: Vec<f32> = (0..rows)
        .into_par_iter()
        .flat_map_iter(|row| {
            (0..columns).map(move |column| {
                let (ys, xs) = (span(row, rows, height), span(column, columns, width));
                let count = (ys.len() * xs.len()) as f32;
                ys.map(|y| plane.row(y)[xs.clone()].iter().sum::<f32>()).sum::<f32>() / count
            })
        })
        .collect();
    Plane::from_vec(columns, rows, data).unwrap_or_else(|| plane.clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_region_counts() {
        let mut photo = Photo::unmarked(Plane::from_fn(4, 2, |x, _| x as f32));
        photo.marks.data_mut()[3] = CLIPPED;
        photo.marks.data_mut()[4] = DARK;
        let right = Mask::from_fn(4, 2, |x, _| x >= 2);
        let all = Exposed::of(&photo, None);
        assert_eq!((all.pixels, all.clipped, all.dark, all.mean), (8, 0.125, 0.125, 1.5));
        let part = Exposed::of(&photo, Some(&right));
        assert_eq!((part.pixels, part.clipped, part.dark, part.mean), (4, 0.25, 0.0, 2.5));
        assert_eq!(Exposed::of(&photo, Some(&Mask::filled(9, 9, true))), all, "a mask of another photo");
    }

    #[test]
    fn a_thumbnail_keeps_the_light_and_the_shape() {
        let plane = Plane::from_fn(200, 100, |x, y| (x + y) as f32);
        let small = thumbnail(&plane, 50);
        assert_eq!(small.size(), (50, 25));
        let mean = |plane: &Plane| plane.data().iter().sum::<f32>() / plane.data().len() as f32;
        assert!((mean(&small) - mean(&plane)).abs() < 1e-2);
        assert_eq!(thumbnail(&small, 96), small);
        assert_eq!(thumbnail(&Plane::filled(1000, 1, 0.5), 10).size(), (10, 1));
    }

    #[test]
    fn a_file_that_is_gone_spoils_its_own_shot_alone() {
        let shot = |file: &str, light: &str| Shot {
            light: Some(light.into()),
            colour: Some("blue".into()),
            files: vec![file.into()],
            ..Shot::default()
        };
        let folder = std::env::temp_dir();
        let picture = tempfile::Builder::new().suffix(".png").tempfile_in(&folder).unwrap();
        let grey = crate::image_file::grey16_png(&Plane::filled(3, 3, 0.25), 1.0).unwrap();
        std::fs::write(picture.path(), grey).unwrap();
        let there = picture.path().to_string_lossy();
        let set = CaptureSet {
            folder,
            shots: vec![shot("gone.png", "left"), shot(&there, "right")],
            ..CaptureSet::default()
        };
        let seen = survey(&set, &super::super::Unattended).unwrap().shots;
        assert!(seen[0].as_ref().unwrap_err().contains("gone.png"));
        assert!((seen[1].as_ref().unwrap().mean - 0.25).abs() < 1e-4);
    }
}
