//! Samples of any type, in the order of the file, become planes of f32.

use firstbounce_core::Plane;
use rayon::prelude::*;

use super::Channel;

/// How a file orders its samples; the top row is first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    pub width: usize,
    pub height: usize,
    /// 1 for grey, 3 for red, green and blue: the first samples of a pixel.
    pub colours: usize,
    /// Alpha included.
    pub samples_per_pixel: usize,
    /// All of red before all of green, not pixel after pixel.
    pub planar: bool,
}

/// Splits `samples` into grey, or red, green and blue, and drops the further samples of a pixel (alpha).
/// `None` if there are too few samples.
pub(super) fn split<T: Copy + Sync>(
    layout: Layout,
    samples: &[T],
    stored: impl Fn(T) -> f32 + Sync,
) -> Option<Vec<(Channel, Plane)>> {
    let Layout { width, height, colours, samples_per_pixel, planar } = layout;
    let samples = samples.get(..width * height * samples_per_pixel)?;
    let names: &[Channel] = if colours == 1 { &[Channel::Grey] } else { &[Channel::R, Channel::G, Channel::B] };
    if planar {
        return names
            .iter()
            .zip(samples.chunks_exact(width * height))
            .map(|(&name, values)| {
                let values = values.par_iter().map(|&value| stored(value)).collect();
                Some((name, Plane::from_vec(width, height, values)?))
            })
            .collect();
    }
    if names.len() == 1 {
        let grey = samples.par_chunks_exact(samples_per_pixel).map(|pixel| stored(pixel[0])).collect();
        return Some(vec![(Channel::Grey, Plane::from_vec(width, height, grey)?)]);
    }
    let mut planes = [(); 3].map(|()| Plane::filled(width, height, 0.0));
    let [red, green, blue] = &mut planes;
    samples
        .par_chunks_exact(width * samples_per_pixel)
        .zip(red.data_mut().par_chunks_exact_mut(width))
        .zip(green.data_mut().par_chunks_exact_mut(width))
        .zip(blue.data_mut().par_chunks_exact_mut(width))
        .for_each(|(((row, red), green), blue)| {
            for (x, pixel) in row.chunks_exact(samples_per_pixel).enumerate() {
                (red[x], green[x], blue[x]) = (stored(pixel[0]), stored(pixel[1]), stored(pixel[2]));
            }
        });
    Some(names.iter().copied().zip(planes).collect())
}

/// The sample after the colours of each pixel, where there is one more than colours; `None` if there are too few.
pub(super) fn alpha<T: Copy + Sync>(layout: Layout, samples: &[T], stored: impl Fn(T) -> f32 + Sync) -> Option<Plane> {
    let Layout { width, height, colours, samples_per_pixel, planar } = layout;
    let pixels = width * height;
    let samples = samples.get(..pixels * samples_per_pixel).filter(|_| samples_per_pixel == colours + 1)?;
    let values = match planar {
        true => samples[pixels * colours..].par_iter().map(|&value| stored(value)).collect(),
        false => samples.par_chunks_exact(samples_per_pixel).map(|pixel| stored(pixel[colours])).collect(),
    };
    Plane::from_vec(width, height, values)
}
