//! The object's photos with its mask and their noise.

use std::sync::Arc;

use firstbounce_core::image::mask::Combine;
use firstbounce_core::image::noise::{NoiseModel, NoiseSource, estimate_noise};
use firstbounce_core::image::photo::DARK;
use firstbounce_core::{Mask, Photo, Plane};
use rayon::prelude::*;

use super::super::{PipelineError, PipelineWatch};
use super::{PhotoStore, SubjectPhotos, load_subject};
use crate::image_file::{ImageWarning, LinearLight, MaskFile, read_mask};
use crate::set::{CaptureSet, Circle, Subject};

/// An object that fills the picture leaves no more of it dark under every lamp.
const MAX_UNLIT_SHARE: f64 = 0.005;

/// The object's photos and mask, and the noise of each photo.
#[derive(Clone, Debug)]
pub struct ObjectPhotos {
    /// By light, then colour.
    pub photos: Vec<Vec<Arc<Photo>>>,
    /// By light, then colour.
    pub noise: Vec<Vec<NoiseModel>>,
    /// The object.
    pub mask: Mask,
    /// Reasons to look at the mask's file again.
    pub mask_warnings: Vec<ImageWarning>,
    /// What the user should know of the mask; what files say of themselves is among the capture warnings.
    pub warnings: Vec<String>,
}

/// Reads the object's photos and its mask. Without a mask file the object is the brighter part of the picture.
pub fn load_object(
    set: &CaptureSet,
    store: &PhotoStore,
    watch: &dyn PipelineWatch,
) -> Result<ObjectPhotos, PipelineError> {
    ObjectPhotos::of(set, load_subject(set, Subject::Object, store, watch)?)
}

impl ObjectPhotos {
    /// Puts the object's photos together with its mask.
    pub fn of(set: &CaptureSet, photos: SubjectPhotos) -> Result<Self, PipelineError> {
        let SubjectPhotos { mut shots } = photos;
        let mut warnings = Vec::new();
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
        let mut mask_warnings = Vec::new();
        let mask = match &set.mask {
            Some(written) => {
                let path = set.resolve(written);
                let MaskFile { mask, warnings: doubts } = read_mask(&path)?;
                if mask.size() != size {
                    return Err(PipelineError::MaskSize { path, found: mask.size(), expected: size });
                }
                let is_doubtful = |doubt: &ImageWarning| {
                    !matches!(doubt, ImageWarning::MaskWhole { .. }) || unlit_share(&taken) > MAX_UNLIT_SHARE
                };
                mask_warnings.extend(doubts.into_iter().filter(is_doubtful));
                warnings.extend(mask_warnings.iter().map(ToString::to_string));
                mask
            }
            None => {
                let mut mask = Mask::brighter_part(&brightest(taken.iter().map(|row| &*row[0].photo)));
                let balls = leave_out_balls(set, &mut mask);
                let without = if balls > 0 { ", without the balls in the scene" } else { "" };
                warnings.push(format!(
                    "no mask given: the object is taken to be the {} brighter pixels of {}{without}",
                    mask.count(),
                    size.0 * size.1
                ));
                mask
            }
        };
        if mask.count() == 0 {
            return Err(PipelineError::EmptyMask { path: set.mask.as_ref().map(|written| set.resolve(written)) });
        }

        let noise =
            taken.par_iter().map(|row| row.iter().map(|linear| noise_of(set, linear, &mask)).collect()).collect();
        let photos = taken.into_iter().map(|row| row.into_iter().map(|shot| shot.photo.clone()).collect()).collect();
        Ok(Self { photos, noise, mask, mask_warnings, warnings })
    }
}

/// A ball's edge in a photo is blurred beyond its circle.
const BALL_EDGE_PX: f64 = 2.0;

/// Takes the balls that lie beside the object out of an automatic mask; how many there are.
fn leave_out_balls(set: &CaptureSet, mask: &mut Mask) -> usize {
    let balls: Vec<_> = set.spheres_in(Subject::Object).collect();
    for ball in &balls {
        let Circle { centre, radius } = ball.circle;
        mask.combine(&Mask::stroke(mask.size(), &[centre], radius + BALL_EDGE_PX), Combine::Remove);
    }
    balls.len()
}

/// The noise of a shot: what is known of it, else from its grain.
pub(super) fn noise_of(set: &CaptureSet, linear: &LinearLight, mask: &Mask) -> NoiseModel {
    stated_noise(set, linear)
        .unwrap_or_else(|| estimate_noise(&linear.photo, mask, f64::from(linear.quantisation_step)))
}

/// The noise of a shot that is combined of others, of their noise; else from the camera's numbers, else from its repeats.
pub(super) fn stated_noise(set: &CaptureSet, linear: &LinearLight) -> Option<NoiseModel> {
    if linear.combined_noise.is_some() {
        return linear.combined_noise;
    }
    let exposure = f64::from(linear.exposure);
    if let (Some(full), Some(read)) = (set.camera.full_well_electrons, set.camera.read_noise_electrons) {
        return Some(NoiseModel::of_camera(full, read, linear.repeats, exposure).scaled(linear.variance_share));
    }
    let of_repeats = linear.noise.as_ref().and_then(|noise| {
        let pairs: Vec<_> = noise.bins.iter().map(|bin| (bin.signal, bin.variance)).collect();
        NoiseModel::fit(&pairs, NoiseSource::Repeats)
    });
    // The fit is that of one frame before it is divided by the exposure.
    let frames = linear.repeats as f64;
    let of_mean = |frame: NoiseModel| NoiseModel {
        floor: frame.floor / exposure.powi(2) / frames,
        per_signal: frame.per_signal / exposure / frames,
        ..frame
    };
    of_repeats.map(|frame| of_mean(frame).scaled(linear.variance_share))
}

/// The share of pixels that are dark in every photo: not the object, whatever the mask says.
fn unlit_share(taken: &[Vec<Arc<LinearLight>>]) -> f64 {
    let photos: Vec<&[u8]> = taken.iter().flatten().map(|shot| shot.photo.marks.data()).collect();
    let pixels = photos.first().map_or(0, |marks| marks.len());
    let is_unlit = |pixel: &usize| photos.iter().all(|marks| marks[*pixel] & DARK != 0);
    (0..pixels).into_par_iter().filter(is_unlit).count() as f64 / pixels.max(1) as f64
}

/// The largest light of each pixel.
fn brightest<'a>(mut photos: impl Iterator<Item = &'a Photo>) -> Plane {
    let Some(first) = photos.next() else { return Plane::filled(0, 0, 0.0) };
    photos.fold(first.linear.clone(), |mut brightest, photo| {
        brightest.data_mut().par_iter_mut().zip(photo.linear.data()).for_each(|(most, light)| *most = most.max(*light));
        brightest
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::set::{Sphere, SphereKind};

    #[test]
    fn an_automatic_mask_leaves_out_the_balls_that_lie_beside_the_object() {
        let circle = Circle { centre: [20.0, 10.0], radius: 4.0 };
        let beside = Sphere { subject: Subject::Object, kind: SphereKind::Grey, circle, diameter_mm: None };
        let alone = Sphere { subject: Subject::MirrorSphere, kind: SphereKind::Mirror, ..beside };
        let picture = Plane::from_fn(30, 20, |x, y| {
            let in_ball = (x as f64 - 19.5).hypot(y as f64 - 9.5) < 4.0;
            if x < 10 || in_ball { 1.0 } else { 0.0 }
        });
        let mut mask = Mask::brighter_part(&picture);
        let mut set = CaptureSet { spheres: vec![alone], ..CaptureSet::default() };
        assert_eq!(leave_out_balls(&set, &mut mask), 0);
        assert!(mask.count() > 200);
        set.spheres.push(beside);
        assert_eq!(leave_out_balls(&set, &mut mask), 1);
        assert_eq!(mask.count(), 200);
    }
}
