//! Camera channels that see more than their own colour.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::LabError;
use firstbounce_core::Plane;
use firstbounce_core::options::check_range;

const MAX_SHARE: f64 = 100.0;

/// What each channel (row) sees of each lamp colour (column) when all colours flash at once.
#[derive(Clone, Debug, PartialEq)]
pub struct Crosstalk(DMatrix<f64>);

impl Crosstalk {
    /// A square matrix of numbers up to 100: what is seen of a lamp is about as strong as the lamp.
    pub fn new(matrix: DMatrix<f64>) -> Result<Self, LabError> {
        if !matrix.is_square() {
            let (rows, columns) = matrix.shape();
            return Err(LabError::CrosstalkShape { rows, columns, colours: rows });
        }
        for &entry in &matrix {
            check_range("crosstalk", entry, (-MAX_SHARE..=MAX_SHARE).contains(&entry), "from -100 to 100")?;
        }
        Ok(Self(matrix))
    }

    /// Every channel sees its own colour wholly and the fraction `leak` of each other one.
    pub fn even(colours: usize, leak: f64) -> Result<Self, LabError> {
        Self::new(DMatrix::from_fn(colours, colours, |channel, colour| if channel == colour { 1.0 } else { leak }))
    }

    /// The light each channel sees, of the light of each colour.
    pub fn mix(&self, colours: &[Plane]) -> Result<Vec<Plane>, LabError> {
        let (rows, columns) = self.0.shape();
        if columns != colours.len() {
            return Err(LabError::CrosstalkShape { rows, columns, colours: colours.len() });
        }
        let channel = |channel: usize| {
            let mut sum = Plane::filled(colours[channel].width(), colours[channel].height(), 0.0);
            for (share, colour) in self.0.row(channel).iter().map(|share| *share as f32).zip(colours) {
                sum.data_mut().par_iter_mut().zip(colour.data()).for_each(|(sum, light)| *sum += share * light);
            }
            sum
        };
        Ok((0..rows).map(channel).collect())
    }
}
