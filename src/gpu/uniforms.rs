//! The numbers that the shader gets with every drawing.

use super::drawing::{Drawing, Sampling};
use super::{Encoding, Kind, MAX_PLANES};

/// Mirrors `struct Canvas` of `canvas.wgsl`, field by field. All lengths are in physical pixels of the target or pixels of the
/// picture; all colours are in gamma space, 0 to 1.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Uniforms {
    /// The picture's top left corner on the target.
    origin_px: [f32; 2],
    /// Target pixels for a pixel of the picture.
    scale: f32,
    /// Pixels of the picture for a texel of the copy that is read.
    texel_size: f32,
    /// Width and height of the picture.
    size: [f32; 2],
    /// Values after exposure at the ends of the colour map.
    range: [f32; 2],
    /// Which mip level of the textures holds that copy.
    mip: u32,
    /// 1 to show texels as squares.
    nearest: u32,
    /// A `ColourMap`: the row of the colour table.
    map: u32,
    /// 1 to stripe values below zero.
    negative_zebra: u32,
    /// Values from here on are striped; the largest float for never.
    clip: f32,
    /// How much of the picture outside the mask gives way to the background.
    mask_dimming: f32,
    /// 0 for the sRGB curve, otherwise the exponent `1 / gamma`.
    exponent: f32,
    /// `2^stops`.
    gain: f32,
    /// The colour around the picture and where it has no value; the fourth is 1.
    background: [f32; 4],
    /// For each bit of the marks a colour, and its strength as the fourth.
    tints: [[f32; 4]; 8],
    /// For each plane its weights in the three sums; the fourth is unused.
    weights: [[f32; 4]; MAX_PLANES],
}

impl Uniforms {
    /// Reads the copy `sampling` from textures whose first mip level is the copy `dropped`.
    pub fn new(drawing: &Drawing<'_>, sampling: Sampling, dropped: u32) -> Self {
        let Drawing { source, display, placement, background: [red, green, blue] } = *drawing;
        let (width, height) = source.size();
        // Stripes warn of light that cannot be trusted; normals, differences and ratios are no light.
        let is_light = matches!(source.kind(), Kind::Value | Kind::Colour);
        let mut weights = [[0.0; 4]; MAX_PLANES];
        for (slot, [a, b, c]) in weights.iter_mut().zip(&source.weights) {
            *slot = [*a, *b, *c, 0.0];
        }
        Self {
            origin_px: placement.origin_px,
            scale: placement.scale,
            texel_size: (sampling.level as f32).exp2(),
            size: [width as f32, height as f32],
            range: display.drawn_range(),
            mip: sampling.level - dropped,
            nearest: u32::from(sampling.nearest),
            map: display.map as u32,
            negative_zebra: u32::from(display.negative_zebra && is_light),
            clip: display.clip.filter(|_| is_light).unwrap_or(f32::MAX),
            mask_dimming: display.mask_dimming,
            exponent: match display.encoding {
                Encoding::Srgb => 0.0,
                Encoding::Gamma(gamma) => 1.0 / gamma,
            },
            gain: display.gain(),
            background: [red, green, blue, 1.0],
            tints: display.tints.map(|tint| {
                let [red, green, blue] = tint.colour.map(|channel| f32::from(channel) / 255.0);
                [red, green, blue, tint.strength]
            }),
            weights,
        }
    }
}
