//! From linear light to stored values, with the errors of a camera.

use rand::{RngExt, SeedableRng, rngs::Xoshiro256PlusPlus};
use rand_distr::{Distribution, Poisson, StandardNormal};
use rayon::prelude::*;

use super::LabError;
use firstbounce_core::image::photo::CLIPPED;
use firstbounce_core::options::check_range;
use firstbounce_core::{Photo, Plane};

/// The largest finite full well: its noise is far below a step of 16 bits, and its photons can still be counted out.
const MAX_ELECTRONS: f64 = 1e15;
/// No sensor that shows a picture has more.
const MAX_READ_NOISE: f64 = 1e4;

/// A sensor whose stored values run from 0 to `2^bits - 1`, where it clips.
///
/// Linear light 1 at exposure 1 fills the well and reaches the white level. Photon noise is Poisson, read noise normal
/// (EMVA standard 1288, "Standard for Characterization of Image Sensors and Cameras", section 2). What the sensor
/// stores depends on the light, these numbers and the seed alone, on any number of cores.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// Electrons of a pixel at the white level; infinite for neither photon nor read noise.
    pub full_well_electrons: f64,
    /// Standard deviation of the read noise.
    pub read_noise_electrons: f64,
    /// Bits of a stored value.
    pub bits: u32,
    /// The stored value at no light.
    pub black_level: f64,
    /// Relative exposure: linear light is multiplied by it.
    pub exposure: f64,
    /// How many frames are averaged.
    pub frames: usize,
    /// Photos of one seed and stream are equal.
    pub seed: u64,
}

impl Default for Sensor {
    /// A machine-vision camera.
    fn default() -> Self {
        Self {
            full_well_electrons: 20_000.0,
            read_noise_electrons: 5.0,
            bits: 16,
            black_level: 512.0,
            exposure: 1.0,
            frames: 1,
            seed: 1,
        }
    }
}

impl Sensor {
    /// A sensor that only rounds to `bits` and clips.
    pub fn noiseless(bits: u32) -> Self {
        Self {
            full_well_electrons: f64::INFINITY,
            read_noise_electrons: 0.0,
            bits,
            black_level: 0.0,
            ..Self::default()
        }
    }

    /// Whether every number is in its range.
    pub fn check(&self) -> Result<(), LabError> {
        let (full_well, read_noise) = (self.full_well_electrons, self.read_noise_electrons);
        let in_range = full_well >= 1.0 && (full_well <= MAX_ELECTRONS || full_well.is_infinite());
        check_range("full_well_electrons", full_well, in_range, "from 1 to 1e15, or inf for no noise")?;
        check_range("read_noise_electrons", read_noise, (0.0..=MAX_READ_NOISE).contains(&read_noise), "0 to 10000")?;
        check_range("read_noise_electrons", read_noise, read_noise < full_well, "less than full_well_electrons")?;
        check_range("bits", f64::from(self.bits), (1..=16).contains(&self.bits), "1 to 16")?;
        let in_range = self.black_level >= 0.0 && self.black_level < self.white_level();
        let range = "0 or more and below the white level 2^bits - 1";
        check_range("black_level", self.black_level, in_range, range)?;
        check_range("exposure", self.exposure, (1e-9..=1e9).contains(&self.exposure), "from 1e-9 to 1e9")?;
        Ok(check_range("frames", self.frames as f64, (1..=10_000).contains(&self.frames), "1 to 10000")?)
    }

    /// The stored value where it clips.
    pub fn white_level(&self) -> f64 {
        f64::from(2_u32.pow(self.bits.min(16)) - 1)
    }

    /// Stored values of the mean frame, each frame rounded and clipped by itself. A pixel that clips in any frame is
    /// at the white level, since the mean of what is left would be too low. Photos of different `stream` differ in
    /// their noise.
    pub fn expose(&self, light: &Plane, stream: u64) -> Result<Plane, LabError> {
        self.check()?;
        let mut stored = Plane::filled(light.width(), light.height(), 0.0);
        stored.data_mut().par_chunks_mut(light.width().max(1)).enumerate().for_each(|(y, row)| {
            let mut random = self.random(stream, y as u64);
            for (stored, &light) in row.iter_mut().zip(light.row(y)) {
                *stored = self.mean_frame(f64::from(light) * self.exposure, &mut random) as f32;
            }
        });
        Ok(stored)
    }

    /// The photo as the pipeline sees it: stored values back in linear light, clipped pixels marked.
    pub fn photograph(&self, light: &Plane, stream: u64) -> Result<Photo, LabError> {
        let mut linear = self.expose(light, stream)?;
        let white = self.white_level();
        let marks = linear.map(|stored| if f64::from(stored) >= white { CLIPPED } else { 0 });
        let range = (white - self.black_level) * self.exposure;
        let to_linear = |stored: &mut f32| *stored = ((f64::from(*stored) - self.black_level) / range) as f32;
        linear.data_mut().par_iter_mut().for_each(to_linear);
        Ok(Photo { linear, marks })
    }

    fn mean_frame(&self, exposed: f64, random: &mut Xoshiro256PlusPlus) -> f64 {
        let white = self.white_level();
        let mut sum = 0.0;
        let mut clips = false;
        for _ in 0..self.frames {
            let frame = (self.black_level + self.noisy(exposed, random) * (white - self.black_level)).round();
            clips |= frame >= white;
            sum += frame.max(0.0);
        }
        if clips { white } else { sum / self.frames as f64 }
    }

    /// One frame's light as a fraction of the range from black to white.
    fn noisy(&self, exposed: f64, random: &mut Xoshiro256PlusPlus) -> f64 {
        if self.full_well_electrons.is_infinite() {
            return exposed;
        }
        // No photons are no distribution, and light that clips many times over need not be exact.
        let expected = (exposed * self.full_well_electrons).min(Poisson::<f64>::MAX_LAMBDA);
        let electrons = Poisson::new(expected).map_or(0.0, |photons| photons.sample(random));
        let read: f64 = random.sample(StandardNormal);
        (electrons + self.read_noise_electrons * read) / self.full_well_electrons
    }

    /// Independent numbers for each row of each photo.
    fn random(&self, stream: u64, row: u64) -> Xoshiro256PlusPlus {
        let mixed = [stream, row].into_iter().fold(self.seed, |state, next| {
            (state ^ next).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(31).wrapping_add(1)
        });
        Xoshiro256PlusPlus::seed_from_u64(mixed)
    }
}
