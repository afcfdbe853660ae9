//! Planes to PNG, into memory: normals and grey of 16 bits for other programs, previews of 8 bits for the eye.

use firstbounce_core::{Mask, Plane};
use image::ExtendedColorType::{L8, L16, Rgb8, Rgb16};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{Encoding, ImageError};

/// Where the green channel of a normal map points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum GreenAxis {
    /// OpenGL: green is y up.
    #[default]
    Up,
    /// DirectX: green is y down.
    Down,
}

/// A normal map as a 16-bit RGB PNG: each of x, y and z is stored as (n / 2 + 1 / 2) 65535, rounded.
/// Where there is no normal (the zero vector, or NaN) all three are 0, which no unit normal comes to.
///
/// # Errors
/// [`ImageError::UnequalPlanes`] unless the three planes are of one size.
pub fn normals_png(normals: [&Plane; 3], green: GreenAxis) -> Result<Vec<u8>, ImageError> {
    let y_sign = if green == GreenAxis::Up { 1.0 } else { -1.0 };
    let store = |n: f32| ((n * 0.5 + 0.5) * 65535.0).round() as u16;
    encode_rows("normals", &normals, Rgb16, |[x, y, z]: [f32; 3]| {
        let there = x * x + y * y + z * z > 0.0;
        (if there { [store(x), store(y_sign * y), store(z)] } else { [0; 3] }).map(u16::to_ne_bytes)
    })
}

/// A grey 16-bit PNG: 0 is stored as 0, `white` as 65535, values beyond are clipped.
///
/// # Errors
/// [`ImageError::UnequalPlanes`] for a plane without pixels.
pub fn grey16_png(plane: &Plane, white: f32) -> Result<Vec<u8>, ImageError> {
    let store = |value: f32| (value / white * 65535.0).round() as u16;
    encode_rows("grey", &[plane], L16, |[value]| [store(value).to_ne_bytes()])
}

/// How finely a grey picture is stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum GreyBits {
    /// 256 levels.
    #[default]
    Eight,
    /// 65536 levels.
    Sixteen,
}

/// A plane of linear light, 1 as white, and what it is.
pub(super) struct Grey<'a> {
    pub plane: &'a Plane,
    pub what: &'a str,
}

/// A grey sRGB PNG.
pub(super) fn srgb_png(Grey { plane, what }: Grey, bits: GreyBits) -> Result<Vec<u8>, ImageError> {
    let encode = |light: f32| Encoding::Srgb.encode(light.clamp(0.0, 1.0));
    match bits {
        GreyBits::Eight => encode_rows(what, &[plane], L8, |[light]| [[(encode(light) * 255.0).round() as u8]]),
        GreyBits::Sixteen => {
            encode_rows(what, &[plane], L16, |[light]| [((encode(light) * 65535.0).round() as u16).to_ne_bytes()])
        }
    }
}

/// A grey 8-bit PNG: 0 is stored as 0, `white` as 255, values beyond are clipped.
///
/// # Errors
/// [`ImageError::UnequalPlanes`] for a plane without pixels.
pub fn grey8_png(plane: &Plane, white: f32) -> Result<Vec<u8>, ImageError> {
    let store = |value: f32| (value / white * 255.0).round() as u8;
    encode_rows("grey", &[plane], L8, |[value]| [[store(value)]])
}

/// A colour 16-bit PNG of red, green and blue: 0 is stored as 0, `white` as 65535, values beyond are clipped.
///
/// # Errors
/// [`ImageError::UnequalPlanes`] unless the three planes are of one size.
pub fn rgb16_png(planes: [&Plane; 3], white: f32) -> Result<Vec<u8>, ImageError> {
    let store = |value: f32| ((value / white * 65535.0).round() as u16).to_ne_bytes();
    encode_rows("colour", &planes, Rgb16, |values: [f32; 3]| values.map(store))
}

/// A colour 8-bit PNG: 0 is stored as 0, `white` as 255, values beyond are clipped.
///
/// # Errors
/// As [`rgb16_png`].
pub fn rgb8_png(planes: [&Plane; 3], white: f32) -> Result<Vec<u8>, ImageError> {
    let store = |value: f32| [(value / white * 255.0).round() as u8];
    encode_rows("colour", &planes, Rgb8, |values: [f32; 3]| values.map(store))
}

/// A mask as an 8-bit grey PNG: 255 inside, 0 outside.
///
/// # Errors
/// [`ImageError::UnequalPlanes`] for a mask without pixels.
pub fn mask_png(mask: &Mask) -> Result<Vec<u8>, ImageError> {
    let (width, height) = mask.size();
    let data = mask.data().iter().map(|&inside| f32::from(u8::from(inside))).collect();
    let plane = Plane::from_vec(width, height, data).unwrap_or_else(|| Plane::filled(0, 0, 0.0));
    encode_rows("mask", &[&plane], L8, |[inside]| [[(inside * 255.0) as u8]])
}

/// A picture for the eye: an 8-bit sRGB PNG of linear light times `exposure`, from one plane (grey) or three.
///
/// # Errors
/// [`ImageError::UnequalPlanes`] unless there are one or three planes of one size.
pub fn preview_png(planes: &[&Plane], exposure: f32) -> Result<Vec<u8>, ImageError> {
    let store = |light: f32| [(Encoding::Srgb.encode((light * exposure).clamp(0.0, 1.0)) * 255.0).round() as u8];
    match planes {
        [grey] => encode_rows("preview", &[*grey], L8, |light: [f32; 1]| light.map(store)),
        [red, green, blue] => encode_rows("preview", &[*red, *green, *blue], Rgb8, |light: [f32; 3]| light.map(store)),
        _ => Err(ImageError::UnequalPlanes { what: "preview".into() }),
    }
}

/// `N` planes to one PNG whose samples have `B` bytes each, in the machine's byte order.
fn encode_rows<const N: usize, const B: usize>(
    what: &str,
    planes: &[&Plane; N],
    colour: ExtendedColorType,
    store: impl Fn([f32; N]) -> [[u8; B]; N] + Sync,
) -> Result<Vec<u8>, ImageError> {
    let unequal = || ImageError::UnequalPlanes { what: what.to_string() };
    let (width, height) = planes[0].size();
    if width * height == 0 || planes.iter().any(|plane| plane.size() != (width, height)) {
        return Err(unequal());
    }
    let mut samples = vec![0; width * height * N * B];
    samples.par_chunks_exact_mut(width * N * B).enumerate().for_each(|(y, row)| {
        for (x, pixel) in row.chunks_exact_mut(N * B).enumerate() {
            pixel.copy_from_slice(store(planes.map(|plane| plane.row(y)[x])).as_flattened());
        }
    });
    let mut png = Vec::new();
    let size = (u32::try_from(width), u32::try_from(height));
    let (Ok(width), Ok(height)) = size else { return Err(unequal()) };
    PngEncoder::new_with_quality(&mut png, CompressionType::Fast, FilterType::Adaptive)
        .write_image(&samples, width, height, colour)
        .map_err(|_| unequal())?;
    Ok(png)
}
