//! The report's pictures: small PNGs of planes, as data addresses that need no other file.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use firstbounce_core::{Mask, NormalMap, Plane};
use rayon::prelude::*;

use crate::image_file::{ImageError, preview_png};

/// Pictures are made no wider or higher than this many pixels, so that a report can be mailed.
const LARGEST_SIDE: usize = 420;
/// The brightest share of pixels may be clipped in a picture.
const CLIPPED_SHARE: f64 = 0.002;

/// A small picture for people: linear grey, or red, green and blue, 0 to 1.
#[derive(Clone, Debug)]
pub struct Picture {
    channels: Vec<Plane>,
}

impl Picture {
    fn grey(plane: &Plane, exposure: f32) -> Self {
        Self { channels: vec![shrunk(plane, exposure)] }
    }

    /// Red, green or blue.
    fn channel(&self, c: usize) -> &Plane {
        self.channels.get(c).unwrap_or(&self.channels[0])
    }

    /// An 8-bit PNG.
    pub fn png(&self) -> Result<Vec<u8>, ImageError> {
        preview_png(&self.channels.iter().collect::<Vec<_>>(), 1.0)
    }

    /// The PNG as an address that a page can hold.
    pub fn data_address(&self) -> Result<String, ImageError> {
        Ok(format!("data:image/png;base64,{}", STANDARD.encode(self.png()?)))
    }

    /// Pictures of one height side by side, a few dark pixels between.
    pub fn row(pictures: &[Self]) -> Self {
        const GAP: usize = 6;
        let height = pictures.iter().map(|picture| picture.channels[0].height()).max().unwrap_or(0);
        let width = pictures.iter().map(|picture| picture.channels[0].width() + GAP).sum::<usize>().saturating_sub(GAP);
        let channel = |c: usize| {
            let mut row = Plane::filled(width, height, 0.0);
            let mut left = 0;
            for plane in pictures.iter().map(|picture| picture.channel(c)) {
                for y in 0..plane.height() {
                    let start = y * width + left;
                    row.data_mut()[start..start + plane.width()].copy_from_slice(plane.row(y));
                }
                left += plane.width() + GAP;
            }
            row
        };
        Self { channels: (0..3).map(channel).collect() }
    }
}

/// Makes pictures of planes of one object.
#[derive(Clone, Copy, Debug)]
pub struct Pictures<'a> {
    mask: &'a Mask,
}

impl<'a> Pictures<'a> {
    /// Brightness is judged inside `mask`.
    pub fn of(mask: &'a Mask) -> Self {
        Self { mask }
    }

    /// Linear light, brightened so that the object fills the range.
    pub fn light(&self, plane: &Plane) -> Picture {
        self.light_with_white(plane, self.white(plane))
    }

    /// Linear light at a given white, so that several pictures compare.
    pub fn light_with_white(&self, plane: &Plane, white: f32) -> Picture {
        Picture::grey(plane, 1.0 / white)
    }

    /// Figure 1 of the paper: bounce 1 in red, the indirect light in cyan; and how many times brighter the cyan is shown, so
    /// that it fills the range too (the paper takes 10 times).
    pub fn composite(&self, direct: &Plane, indirect: &Plane) -> (Picture, f32) {
        let amplification = (self.white(direct) / self.white(indirect)).clamp(0.1, 10.0);
        let exposure = 1.0 / self.white(direct);
        let cyan = shrunk(indirect, exposure * amplification);
        (Picture { channels: vec![shrunk(direct, exposure), cyan.clone(), cyan] }, amplification)
    }

    /// Normals as colours, (n + 1) / 2; black where there is none.
    pub fn normals(&self, map: &NormalMap) -> Picture {
        // Undo the curve that a picture of light gets: a normal's colour is no light.
        let encode = |plane: &Plane| {
            let data = plane
                .data()
                .par_iter()
                .enumerate()
                .map(|(pixel, &n)| if map.at_index(pixel).is_some() { (n * 0.5 + 0.5).powf(2.2) } else { 0.0 });
            let encoded = Plane::from_vec(plane.width(), plane.height(), data.collect());
            shrunk(encoded.as_ref().unwrap_or(plane), 1.0)
        };
        Picture { channels: vec![encode(map.x()), encode(map.y()), encode(map.z())] }
    }

    /// Depth from far (dark) to near (bright); black outside `mask`.
    pub fn depth(&self, depth: &Plane, mask: &Mask) -> Picture {
        let inside = || depth.data().iter().zip(mask.data()).filter(|(_, inside)| **inside).map(|(z, _)| *z);
        let (low, high) = inside().fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), z| (a.min(z), b.max(z)));
        let range = (high - low).max(f32::MIN_POSITIVE);
        let shade = |(z, inside): (&f32, &bool)| if *inside { 0.03 + 0.97 * (z - low) / range } else { 0.0 };
        let data = depth.data().iter().zip(mask.data()).map(shade).collect();
        let shaded = Plane::from_vec(depth.width(), depth.height(), data);
        Picture::grey(shaded.as_ref().unwrap_or(depth), 1.0)
    }

    /// The light that all but the brightest pixels of the object stay below.
    pub fn white(&self, plane: &Plane) -> f32 {
        let inside = plane.data().iter().zip(self.mask.data()).filter(|(_, inside)| **inside);
        let mut values: Vec<f32> = inside.map(|(light, _)| *light).filter(|light| light.is_finite()).collect();
        if values.is_empty() {
            return 1.0;
        }
        let at = ((values.len() - 1) as f64 * (1.0 - CLIPPED_SHARE)) as usize;
        let (_, white, _) = values.select_nth_unstable_by(at, f32::total_cmp);
        white.max(f32::MIN_POSITIVE)
    }
}

/// The mean of whole blocks of pixels times `exposure`, clipped to 0..1, so that the larger side is at most `LARGEST_SIDE`.
fn shrunk(plane: &Plane, exposure: f32) -> Plane {
    let block = plane.width().max(plane.height()).div_ceil(LARGEST_SIDE).max(1);
    let (width, height) = ((plane.width() / block).max(1), (plane.height() / block).max(1));
    Plane::from_fn(width, height, |x, y| {
        let rows = y * block..((y + 1) * block).min(plane.height());
        let columns = x * block..((x + 1) * block).min(plane.width());
        let count = (rows.len() * columns.len()).max(1);
        let sum: f32 = rows.flat_map(|row| plane.row(row)[columns.clone()].iter()).sum();
        (sum / count as f32 * exposure).clamp(0.0, 1.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_picture_is_made_small_enough_to_mail() {
        let mask = Mask::filled(3000, 2000, true);
        let ramp = Plane::from_fn(3000, 2000, |x, y| (x + y) as f32 / 5000.0);
        let address = Pictures::of(&mask).light(&ramp).data_address().unwrap();
        let png = STANDARD.decode(address.strip_prefix("data:image/png;base64,").unwrap()).unwrap();
        let picture = image::load_from_memory(&png).unwrap();
        assert!(picture.width() <= 420 && picture.width() > 300);
        assert!((f64::from(picture.width()) / f64::from(picture.height()) - 1.5).abs() < 0.01);
    }

    #[test]
    fn the_brightest_speck_does_not_set_the_white() {
        let mask = Mask::filled(100, 100, true);
        let plane = Plane::from_fn(100, 100, |x, y| if (x, y) == (3, 3) { 50.0 } else { 0.4 });
        assert!((Pictures::of(&mask).white(&plane) - 0.4).abs() < 1e-6);
    }
}
