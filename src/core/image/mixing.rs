//! Crosstalk undone: channels that see more than their own lamp colour, back to the light of each colour.

use nalgebra::DMatrix;
use rayon::prelude::*;
use thiserror::Error;

use super::noise::NoiseModel;
use super::photo::{CLIPPED, DARK};
use crate::linear_algebra;
use crate::{Marks, Photo, Plane};

/// What a channel sees of all other lamps together stays below this share of its own: beyond, noise grows without bound, and the
/// channels are rather exchanged.
pub const MAX_OTHERS: f64 = 0.8;

/// Room for the rounding of typed decimals.
const ROUNDING: f64 = 1e-9;
/// A channel that takes less than this of another is not spoiled where that one clips.
const NO_SHARE: f64 = 1e-6;
/// Pixels that the noise of an unmixed photo is fitted to.
const NOISE_SAMPLES: usize = 4096;

/// Why a matrix is none of crosstalk, or cannot be undone.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MixingError {
    /// Not a row and a column for each colour.
    #[error(
        "expected {colours} rows of {colours} numbers, one for each colour, found {rows} rows, one of {columns} numbers"
    )]
    Shape {
        /// Colours.
        colours: usize,
        /// Rows.
        rows: usize,
        /// Numbers of the first row that is too short or too long, or of the first.
        columns: usize,
    },
    /// A channel that does not see its own lamp as 1.
    #[error("expected 1 for what channel {} sees of its own lamp, found {found:?}", channel + 1)]
    Own {
        /// Index of the channel.
        channel: usize,
        /// Its entry.
        found: f64,
    },
    /// A matrix that is singular or so far from none at all that it cannot be undone.
    #[error(
        "channel {} sees {:.0} % of its own light from the other lamps together, more than the {:.0} % that can be undone: check that \
         each colour has its own channel", channel + 1, 100.0 * others, 100.0 * MAX_OTHERS
    )]
    TooStrong {
        /// Index of the channel.
        channel: usize,
        /// The sum of its other entries.
        others: f64,
    },
    /// Photos of other number or size.
    #[error("crosstalk is undone in the photos of all colours together, of one size")]
    Photos,
}

/// What each channel (row) sees of the lamp of each colour (column), over what that lamp's own channel sees of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Mixing {
    inverse: DMatrix<f64>,
}

impl Mixing {
    /// Of the rows of the matrix, whose diagonal is 1.
    ///
    /// # Errors
    /// Another shape than `colours` rows of as many numbers, another diagonal, and rows whose other entries come to more than
    /// [`MAX_OTHERS`]: the matrix then is singular or far from the identity.
    pub fn new(rows: &[Vec<f64>], colours: usize) -> Result<Self, MixingError> {
        let odd = rows.iter().find(|row| row.len() != colours);
        if let (true, row) | (false, row @ Some(_)) = (rows.len() != colours || colours == 0, odd) {
            let columns = row.or(rows.first()).map_or(0, Vec::len);
            return Err(MixingError::Shape { colours, rows: rows.len(), columns });
        }
        for (channel, row) in rows.iter().enumerate() {
            let found = row[channel];
            if found.is_nan() || (found - 1.0).abs() > ROUNDING {
                return Err(MixingError::Own { channel, found });
            }
            let others = row.iter().map(|share| share.abs()).sum::<f64>() - found;
            if others.is_nan() || others > MAX_OTHERS {
                return Err(MixingError::TooStrong { channel, others });
            }
        }
        let matrix = DMatrix::from_fn(colours, colours, |channel, lamp| rows[channel][lamp]);
        // Rows whose own entry outweighs the others make a regular matrix.
        let inverse = linear_algebra::pseudo_inverse(&matrix);
        let inverse = inverse.ok_or(MixingError::TooStrong { channel: 0, others: f64::INFINITY })?;
        Ok(Self { inverse })
    }

    /// The light of each lamp colour, of the photos in each channel. A pixel is marked clipped where any channel that it takes from
    /// is, and dark where its own was or what is left is below `dark_below`, by colour in linear light.
    ///
    /// # Errors
    /// [`MixingError::Photos`].
    pub fn undo(&self, photos: &[&Photo], dark_below: &[f32]) -> Result<Vec<Photo>, MixingError> {
        let size = self.size_of(photos)?;
        let unmixed = |colour: usize| {
            let shares: Vec<(f32, &Photo)> =
                self.shares(colour).map(|share| share as f32).zip(photos.iter().copied()).collect();
            let threshold = dark_below.get(colour).copied().unwrap_or(f32::NEG_INFINITY);
            let pixel = |pixel: usize| {
                let (mut light, mut mark) = (0.0, photos[colour].marks.data()[pixel]);
                for (share, photo) in &shares {
                    light += share * photo.linear.data()[pixel];
                    if f64::from(share.abs()) > NO_SHARE {
                        mark |= photo.marks.data()[pixel] & CLIPPED;
                    }
                }
                (light, if light < threshold { mark | DARK } else { mark })
            };
            let (light, marks): (Vec<f32>, Vec<u8>) = (0..size.0 * size.1).into_par_iter().map(pixel).unzip();
            let linear = Plane::from_vec(size.0, size.1, light);
            linear.zip(Marks::from_vec(size.0, size.1, marks)).map(|(linear, marks)| Photo { linear, marks })
        };
        (0..photos.len()).map(unmixed).collect::<Option<_>>().ok_or(MixingError::Photos)
    }

    /// The noise of the light of one colour, of the photos in each channel and their noise: each adds its own by the square of what
    /// is taken from it. That the noise of two colours then has a part in common, of a size with the crosstalk, is left out.
    ///
    /// # Errors
    /// [`MixingError::Photos`].
    pub fn noise(&self, colour: usize, photos: &[&Photo], noise: &[NoiseModel]) -> Result<NoiseModel, MixingError> {
        let (width, height) = self.size_of(photos)?;
        if noise.len() != photos.len() || colour >= noise.len() {
            return Err(MixingError::Photos);
        }
        let shares: Vec<f64> = self.shares(colour).collect();
        let step = (width * height).div_ceil(NOISE_SAMPLES).max(1);
        let is_good = |pixel: &usize| photos.iter().all(|photo| photo.marks.data()[*pixel] & CLIPPED == 0);
        let sample = |pixel: usize| {
            let light = |photo: &Photo| f64::from(photo.linear.data()[pixel]);
            let terms = shares.iter().zip(photos).zip(noise);
            terms.fold((0.0, 0.0), |(sum, variance), ((share, photo), noise)| {
                (sum + share * light(photo), variance + share * share * noise.variance(light(photo)))
            })
        };
        let samples: Vec<_> = (0..width * height).step_by(step).filter(is_good).map(sample).collect();
        let own = noise[colour];
        Ok(NoiseModel::fit(&samples, own.source).unwrap_or_else(|| {
            let floor = shares.iter().zip(noise).map(|(share, noise)| share * share * noise.floor).sum();
            NoiseModel { floor, per_signal: own.per_signal * shares[colour], ..own }
        }))
    }

    /// What the light of a colour takes of each channel.
    fn shares(&self, colour: usize) -> impl Iterator<Item = f64> {
        self.inverse.row(colour).iter().copied().collect::<Vec<_>>().into_iter()
    }

    fn size_of(&self, photos: &[&Photo]) -> Result<(usize, usize), MixingError> {
        let size = photos.first().ok_or(MixingError::Photos)?.linear.size();
        let fits = photos.len() == self.inverse.nrows() && photos.iter().all(|photo| photo.linear.size() == size);
        if fits { Ok(size) } else { Err(MixingError::Photos) }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;
    use rand::rngs::StdRng;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    use super::*;

    fn rows(colours: usize, leaks: &[f64]) -> Vec<Vec<f64>> {
        let entry =
            |row: usize, column: usize| if row == column { 1.0 } else { leaks[(3 * row + column) % leaks.len()] };
        (0..colours).map(|row| (0..colours).map(|column| entry(row, column)).collect()).collect()
    }

    fn mixed(rows: &[Vec<f64>], light: &[Plane]) -> Vec<Photo> {
        let sees = |row: &Vec<f64>, pixel: usize| {
            row.iter().zip(light).map(|(share, l)| share * f64::from(l.data()[pixel])).sum::<f64>()
        };
        let (width, height) = light[0].size();
        let channel = |row| Plane::from_fn(width, height, |x, y| sees(row, y * width + x) as f32);
        rows.iter().map(|row| Photo::unmarked(channel(row))).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 48, rng_seed: RngSeed::Fixed(5), ..ProptestConfig::default() })]

        #[test]
        fn what_was_mixed_comes_back(
            colours in 1usize..5, leaks in proptest::collection::vec(-0.1..0.2, 9), light in proptest::collection::vec(0.0..2.0f32, 12),
        ) {
            let rows = rows(colours, &leaks);
            let mixing = Mixing::new(&rows, colours).unwrap();
            let light: Vec<_> = (0..colours).map(|c| Plane::from_fn(3, 2, |x, y| light[(x + 3 * y + 5 * c) % 12])).collect();
            let seen = mixed(&rows, &light);
            let found = mixing.undo(&seen.iter().collect::<Vec<_>>(), &vec![0.0; colours]).unwrap();
            for (found, light) in found.iter().zip(&light) {
                for (found, light) in found.linear.data().iter().zip(light.data()) {
                    prop_assert!((found - light).abs() < 1e-5, "{} for {}", found, light);
                }
            }
        }

        #[test]
        fn any_matrix_is_taken_or_refused(
            rows in proptest::collection::vec(proptest::collection::vec(any::<f64>(), 0..4), 0..4), colours in 0usize..4,
        ) {
            let _ = Mixing::new(&rows, colours);
        }
    }

    #[test]
    fn a_matrix_that_is_singular_or_exchanges_channels_is_refused() {
        let refused =
            |rows: &[[f64; 2]]| Mixing::new(&rows.iter().map(|row| row.to_vec()).collect::<Vec<_>>(), 2).unwrap_err();
        assert!(matches!(refused(&[[1.0, 1.0], [1.0, 1.0]]), MixingError::TooStrong { channel: 0, .. }));
        assert!(matches!(refused(&[[1.0, 0.1], [4.0, 1.0]]), MixingError::TooStrong { channel: 1, .. }));
        assert!(matches!(refused(&[[1.0, 0.1], [0.1, 0.9]]), MixingError::Own { channel: 1, .. }));
        assert!(matches!(refused(&[[1.0, f64::NAN], [0.1, 1.0]]), MixingError::TooStrong { .. }));
        assert!(matches!(refused(&[[1.0, 0.1]]), MixingError::Shape { rows: 1, .. }));
        assert!(matches!(Mixing::new(&[], 0), Err(MixingError::Shape { .. })));
    }

    #[test]
    fn a_pixel_that_clips_in_one_channel_is_clipped_in_every_colour_that_takes_from_it() {
        let mixing = Mixing::new(&[vec![1.0, 0.1, 0.0], vec![0.0, 1.0, 0.0], vec![0.0, 0.0, 1.0]], 3).unwrap();
        let mut clipped = Photo::unmarked(Plane::filled(2, 1, 0.5));
        clipped.marks.set(1, 0, CLIPPED);
        let plain = Photo::unmarked(Plane::filled(2, 1, 0.04));
        let found = mixing.undo(&[&plain, &clipped, &plain], &[0.001; 3]).unwrap();
        let marks: Vec<_> = found.iter().map(|photo| photo.marks.data().to_vec()).collect();
        // All that the first channel shows came from the second lamp.
        assert_eq!(marks, [vec![DARK, CLIPPED | DARK], vec![0, CLIPPED], vec![0, 0]]);
    }

    #[test]
    fn the_noise_of_unmixed_light_is_what_it_scatters_by() {
        let rows = rows(3, &[0.15, 0.05, 0.1, 0.2]);
        let mixing = Mixing::new(&rows, 3).unwrap();
        let light: Vec<_> =
            [0.3, 0.8, 0.5].map(|l| Plane::from_fn(150, 150, |x, _| l * (x as f32 + 20.0) / 170.0)).into();
        let mut seen = mixed(&rows, &light);
        let models = [5_000.0, 2_000.0, 8_000.0].map(|well| NoiseModel::of_camera(well, 8.0, 1, 1.0));
        let mut random = StdRng::seed_from_u64(3);
        for (photo, model) in seen.iter_mut().zip(&models) {
            for value in photo.linear.data_mut() {
                *value += (model.sigma(f64::from(*value)) * random.sample::<f64, _>(StandardNormal)) as f32;
            }
        }
        let seen: Vec<_> = seen.iter().collect();
        let found = mixing.undo(&seen, &[-1.0; 3]).unwrap();
        for colour in 0..3 {
            let noise = mixing.noise(colour, &seen, &models).unwrap();
            let squares = found[colour]
                .linear
                .data()
                .iter()
                .zip(light[colour].data())
                .map(|(found, light)| f64::from(found - light).powi(2) / noise.variance(f64::from(*light)));
            let ratio = (squares.sum::<f64>() / 22_500.0).sqrt();
            assert!((ratio - 1.0).abs() < 0.03, "colour {colour}: {ratio}");
        }
    }
}
