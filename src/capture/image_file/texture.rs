//! Albedo as a texture.

use firstbounce_core::{Mask, Plane};

use super::png_out::{Grey, srgb_png};
use super::{GreyBits, ImageError};

/// How far the object's colour goes on beyond its edge, in pixels: renderers blend neighbouring texels, and smaller
/// versions of the texture do so over several.
const BLEED_PX: usize = 8;

/// A grey sRGB PNG of `albedo`, 1 as white, whose colours inside `mask` go on for some pixels beyond its edge.
///
/// # Errors
/// [`ImageError::UnequalPlanes`] for an albedo without pixels, or of another size than the mask.
pub fn texture_png(albedo: &Plane, mask: &Mask, bits: GreyBits) -> Result<Vec<u8>, ImageError> {
    if albedo.size() != mask.size() {
        return Err(ImageError::UnequalPlanes { what: "texture".into() });
    }
    srgb_png(Grey { plane: &bled(albedo, mask), what: "texture" }, bits)
}

/// Each pixel beside the known ones takes the mean of those it touches, ring by ring.
fn bled(albedo: &Plane, mask: &Mask) -> Plane {
    let (width, height) = albedo.size();
    let mut known = mask.data().to_vec();
    let mut values = albedo.data().to_vec();
    for (value, known) in values.iter_mut().zip(&mut known) {
        *known &= value.is_finite();
        *value = if *known { *value } else { 0.0 };
    }
    let mut ring: Vec<usize> = (0..values.len()).filter(|&pixel| known[pixel]).collect();
    for _ in 0..BLEED_PX {
        let mut sums = std::collections::HashMap::new();
        for &pixel in &ring {
            let (x, y) = (pixel % width, pixel / width);
            for (x, y) in (y.saturating_sub(1)..(y + 2).min(height))
                .flat_map(|y| (x.saturating_sub(1)..(x + 2).min(width)).map(move |x| (x, y)))
            {
                let beside = y * width + x;
                if !known[beside] {
                    let (sum, count) = sums.entry(beside).or_insert((0.0, 0.0));
                    (*sum, *count) = (*sum + values[pixel], *count + 1.0);
                }
            }
        }
        ring = sums.keys().copied().collect();
        // In one order, whatever the map's: sums of floats depend on it.
        ring.sort_unstable();
        for (pixel, (sum, count)) in sums {
            values[pixel] = sum / count;
            known[pixel] = true;
        }
    }
    Plane::from_vec(width, height, values).unwrap_or_else(|| albedo.clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_object_keeps_its_albedo_and_lends_it_to_the_pixels_around_it() {
        let albedo = Plane::from_fn(30, 20, |x, _| if x < 15 { 0.25 } else { 1.0 });
        let mask = Mask::from_fn(30, 20, |x, y| (10..20).contains(&x) && (8..12).contains(&y));
        let bled = bled(&albedo, &mask);
        assert!((0..30).all(|x| !(10..20).contains(&x) || bled.at(x, 9) == albedo.at(x, 9)));
        assert_eq!((bled.at(2, 9), bled.at(27, 0)), (0.25, 1.0), "eight pixels on");
        assert_eq!((bled.at(1, 9), bled.at(29, 9)), (0.0, 0.0), "and no farther");
    }

    #[test]
    fn both_depths_hold_the_srgb_curve() {
        let albedo = Plane::from_fn(8, 1, |x, _| x as f32 / 7.0);
        let mask = Mask::filled(8, 1, true);
        for (bits, white) in [(GreyBits::Eight, 255.0), (GreyBits::Sixteen, 65535.0)] {
            let picture = image::load_from_memory(&texture_png(&albedo, &mask, bits).unwrap()).unwrap();
            assert_eq!(picture.color() == image::ColorType::L16, bits == GreyBits::Sixteen);
            let stored = picture.to_luma32f();
            for x in 0..8 {
                let linear = crate::image_file::Encoding::Srgb.encode(x as f32 / 7.0);
                assert!((stored.get_pixel(x, 0).0[0] - linear).abs() <= 0.51 / white, "{bits:?} {x}");
            }
        }
    }
}
