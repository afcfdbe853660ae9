//! Which numbers a canvas shows.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use firstbounce_core::{Marks, Mask, Plane};
use thiserror::Error;

/// Planes that one picture may be computed from: eight photos and a few to compare with. With marks, mask and colour
/// table they stay within the 16 textures that every graphics card lets a shader read.
pub const MAX_PLANES: usize = 12;

/// Names what a texture holds: the same key, the same numbers. A new version replaces the old one on the card.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PlaneKey {
    /// Which picture this is, for as long as the program runs.
    pub id: u64,
    /// Counts the changes of the picture's numbers.
    pub version: u64,
}

impl PlaneKey {
    /// A unique key.
    pub fn fresh() -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        Self { id: NEXT.fetch_add(1, Ordering::Relaxed), version: 0 }
    }

    /// The key for new numbers in the same picture: the old ones stay on screen until the new ones are on the card.
    pub fn next_version(self) -> Self {
        Self { version: self.version + 1, ..self }
    }
}

/// A plane that can be shown.
#[derive(Clone, Debug)]
pub struct CanvasPlane {
    /// Whether the card already has these numbers.
    pub key: PlaneKey,
    /// The numbers.
    pub plane: Arc<Plane>,
}

impl CanvasPlane {
    /// A plane that was never shown before.
    pub fn new(plane: Arc<Plane>) -> Self {
        Self { key: PlaneKey::fresh(), plane }
    }
}

/// A byte for each pixel: bits that say why it must not be used, or whether it is inside a mask.
#[derive(Clone, Debug)]
pub struct CanvasMarks {
    /// Whether the card already has these bytes.
    pub key: PlaneKey,
    pub(super) marks: Marks,
}

impl CanvasMarks {
    /// Marks that were never shown before.
    pub fn new(marks: Marks) -> Self {
        Self { key: PlaneKey::fresh(), marks }
    }

    /// 1 inside the mask, 0 outside.
    pub fn of_mask(mask: &Mask) -> Self {
        Self::new(mask.map(u8::from))
    }

    /// The byte at column `x`, row `y`, 0 outside.
    pub fn at(&self, x: usize, y: usize) -> u8 {
        let (width, height) = self.marks.size();
        if x < width && y < height { self.marks.at(x, y) } else { 0 }
    }
}

/// Why planes cannot be shown together.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum SourceError {
    /// A combination of nothing.
    #[error("there is no plane to show; choose at least one")]
    NoPlane,
    /// More planes than a shader may read.
    #[error("{planes} planes are needed to draw this picture and {MAX_PLANES} are possible; compare fewer colours")]
    TooManyPlanes {
        /// How many different planes the picture needs.
        planes: usize,
    },
    /// Planes of different sizes.
    #[error("{}x{} and {}x{} pixels cannot be shown in one picture; choose planes of one size", .0.0, .0.1, .1.0, .1.1)]
    SizesDiffer((usize, usize), (usize, usize)),
    /// Not one weight for each plane.
    #[error("{planes} planes need as many weights and have {weights}")]
    WeightsDiffer {
        /// How many planes there are.
        planes: usize,
        /// How many weights there are.
        weights: usize,
    },
}

/// One number for each pixel: a weighted sum of planes. A plane itself is the sum of one; bounce k of a light is the sum
/// of its photos weighted by row k of the bounce operator divided by alpha.
#[derive(Clone, Debug)]
pub struct Layer {
    terms: Vec<(CanvasPlane, f32)>,
}

impl From<CanvasPlane> for Layer {
    fn from(plane: CanvasPlane) -> Self {
        Self { terms: vec![(plane, 1.0)] }
    }
}

impl Layer {
    /// `sum_c weights[c] planes[c]`. A weight for every plane, all of one size, at most [`MAX_PLANES`].
    pub fn combination(planes: &[CanvasPlane], weights: &[f32]) -> Result<Self, SourceError> {
        if planes.len() != weights.len() {
            return Err(SourceError::WeightsDiffer { planes: planes.len(), weights: weights.len() });
        }
        same_size(planes)?;
        if planes.len() > MAX_PLANES {
            return Err(SourceError::TooManyPlanes { planes: planes.len() });
        }
        Ok(Self { terms: planes.iter().cloned().zip(weights.iter().copied()).collect() })
    }

    /// The same layer times `gain`.
    pub fn amplified(mut self, gain: f32) -> Self {
        self.terms.iter_mut().for_each(|(_, weight)| *weight *= gain);
        self
    }

    /// The planes and their weights.
    pub fn terms(&self) -> &[(CanvasPlane, f32)] {
        &self.terms
    }

    /// `(width, height)` in pixels.
    pub fn size(&self) -> (usize, usize) {
        self.terms.first().map_or((0, 0), |(plane, _)| plane.plane.size())
    }
}

/// What the shader makes of its three sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// The first sum through the colour map.
    Value = 0,
    /// The three sums as red, green and blue.
    Colour = 1,
    /// The three sums as a unit vector, shown as `0.5 n + 0.5`.
    Normal = 2,
    /// The first sum minus the second, through the colour map.
    Difference = 3,
    /// The first sum divided by the second, through the colour map.
    Ratio = 4,
}

/// The numbers of a picture: up to three layers over shared planes, and what to make of them.
#[derive(Clone, Debug)]
pub struct Source {
    pub(super) planes: Vec<CanvasPlane>,
    /// For each plane of `planes`, its weight in the three sums.
    pub(super) weights: Vec<[f32; 3]>,
    pub(super) kind: Kind,
    pub(super) marks: Option<CanvasMarks>,
    pub(super) mask: Option<CanvasMarks>,
}

impl Source {
    /// One plane through the colour map.
    pub fn plane(plane: CanvasPlane) -> Self {
        Self { planes: vec![plane], weights: vec![[1.0, 0.0, 0.0]], kind: Kind::Value, marks: None, mask: None }
    }

    /// A layer through the colour map: a bounce computed while it is drawn, for instance.
    pub fn value(layer: Layer) -> Result<Self, SourceError> {
        Self::of(Kind::Value, &[layer])
    }

    /// Three layers as red, green and blue light.
    pub fn colour(rgb: [Layer; 3]) -> Result<Self, SourceError> {
        Self::of(Kind::Colour, &rgb)
    }

    /// The components x, y, z of unit normals, shown as colours.
    pub fn normals(xyz: [CanvasPlane; 3]) -> Result<Self, SourceError> {
        Self::of(Kind::Normal, &xyz.map(Layer::from))
    }

    /// Bounce 1 in red, and bounce 2 times `gain` in cyan (Liao, Huang, Yang, CVPR 2011, Figure 1).
    pub fn figure_one(first: Layer, second: Layer, gain: f32) -> Result<Self, SourceError> {
        let second = second.amplified(gain);
        Self::of(Kind::Colour, &[first, second.clone(), second])
    }

    /// `a - b`.
    pub fn difference(a: Layer, b: Layer) -> Result<Self, SourceError> {
        Self::of(Kind::Difference, &[a, b])
    }

    /// `a / b`; no value where `b` is 0.
    pub fn ratio(a: Layer, b: Layer) -> Result<Self, SourceError> {
        Self::of(Kind::Ratio, &[a, b])
    }

    /// Tints the pixels that carry marks as the display's table says. Marks of another size are an error.
    pub fn with_marks(mut self, marks: CanvasMarks) -> Result<Self, SourceError> {
        self.check_size(&marks)?;
        self.marks = Some(marks);
        Ok(self)
    }

    /// Dims the pixels whose byte is 0. A mask of another size is an error.
    pub fn with_mask(mut self, mask: CanvasMarks) -> Result<Self, SourceError> {
        self.check_size(&mask)?;
        self.mask = Some(mask);
        Ok(self)
    }

    /// `(width, height)` in pixels.
    pub fn size(&self) -> (usize, usize) {
        self.planes.first().map_or((0, 0), |plane| plane.plane.size())
    }

    /// Whether some pixels may lie outside what matters.
    pub fn has_mask(&self) -> bool {
        self.mask.is_some()
    }

    /// What the sums mean.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// The numbers shown at column `x`, row `y`: three for colours and normals, one otherwise. Empty outside the picture and
    /// where there is no value.
    pub fn values_at(&self, x: usize, y: usize) -> Vec<f32> {
        let (width, height) = self.size();
        if x >= width || y >= height {
            return Vec::new();
        }
        let Some(values) = self.values(|plane| plane.plane.at(x, y)) else { return Vec::new() };
        match self.kind {
            Kind::Colour | Kind::Normal => values.to_vec(),
            Kind::Value | Kind::Difference | Kind::Ratio => vec![values[0]],
        }
    }

    /// The numbers to show, when each plane has the value `sample(plane)`. `None` if one of them is not finite.
    pub(super) fn values(&self, mut sample: impl FnMut(&CanvasPlane) -> f32) -> Option<[f32; 3]> {
        let mut sums = [0.0; 3];
        for (plane, weights) in self.planes.iter().zip(&self.weights) {
            let value = sample(plane);
            if !value.is_finite() {
                return None;
            }
            sums.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += weight * value);
        }
        match self.kind {
            Kind::Value | Kind::Colour | Kind::Normal => Some(sums),
            Kind::Difference => Some([sums[0] - sums[1], 0.0, 0.0]),
            Kind::Ratio => (sums[1] != 0.0).then(|| [sums[0] / sums[1], 0.0, 0.0]),
        }
    }

    /// Gathers the planes of up to three layers, each plane once.
    fn of(kind: Kind, layers: &[Layer]) -> Result<Self, SourceError> {
        let mut planes: Vec<CanvasPlane> = Vec::new();
        let mut weights: Vec<[f32; 3]> = Vec::new();
        for (row, layer) in layers.iter().enumerate() {
            for (plane, weight) in &layer.terms {
                let slot = planes.iter().position(|known| known.key == plane.key).unwrap_or_else(|| {
                    planes.push(plane.clone());
                    weights.push([0.0; 3]);
                    planes.len() - 1
                });
                weights[slot][row] += weight;
            }
        }
        same_size(&planes)?;
        if planes.len() > MAX_PLANES {
            return Err(SourceError::TooManyPlanes { planes: planes.len() });
        }
        Ok(Self { planes, weights, kind, marks: None, mask: None })
    }

    fn check_size(&self, marks: &CanvasMarks) -> Result<(), SourceError> {
        let found = marks.marks.size();
        if found == self.size() { Ok(()) } else { Err(SourceError::SizesDiffer(self.size(), found)) }
    }
}

fn same_size(planes: &[CanvasPlane]) -> Result<(), SourceError> {
    let first = planes.first().ok_or(SourceError::NoPlane)?.plane.size();
    match planes.iter().map(|plane| plane.plane.size()).find(|&size| size != first) {
        Some(other) => Err(SourceError::SizesDiffer(first, other)),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(width: usize, value: f32) -> CanvasPlane {
        CanvasPlane::new(Arc::new(Plane::filled(width, 2, value)))
    }

    #[test]
    fn two_bounces_of_the_same_photos_share_their_planes() {
        let photos = [plane(3, 2.0), plane(3, 5.0)];
        let first = Layer::combination(&photos, &[1.0, -0.5]).unwrap();
        let second = Layer::combination(&photos, &[0.5, 1.0]).unwrap();
        let source = Source::figure_one(first, second, 10.0).unwrap();
        assert_eq!(source.planes.len(), 2);
        assert_eq!(source.values_at(2, 1), vec![2.0 - 2.5, 60.0, 60.0]);
    }

    #[test]
    fn what_cannot_be_drawn_is_refused_with_its_numbers() {
        let many: Vec<_> = (0..13).map(|_| plane(3, 0.0)).collect();
        assert_eq!(Layer::combination(&many, &[1.0; 13]).unwrap_err(), SourceError::TooManyPlanes { planes: 13 });
        assert_eq!(Layer::combination(&[], &[]).unwrap_err(), SourceError::NoPlane);
        let unequal = Source::difference(plane(3, 0.0).into(), plane(4, 0.0).into()).unwrap_err();
        assert_eq!(unequal.to_string(), "3x2 and 4x2 pixels cannot be shown in one picture; choose planes of one size");
        assert!(Layer::combination(&[plane(3, 0.0)], &[1.0, 2.0]).is_err());
        let marks = CanvasMarks::new(Marks::filled(2, 2, 0));
        assert!(Source::plane(plane(3, 0.0)).with_marks(marks).is_err());
    }

    #[test]
    fn a_pixel_without_a_number_has_no_value() {
        assert!(Source::plane(plane(3, f32::NAN)).values_at(0, 0).is_empty());
        assert!(Source::plane(plane(3, 1.0)).values_at(3, 0).is_empty());
        let ratio = Source::ratio(plane(3, 1.0).into(), plane(3, 0.0).into()).unwrap();
        assert!(ratio.values_at(0, 0).is_empty());
    }
}
