//! The numbers of a picture on the CPU, all at once: for histograms, statistics and profiles.

use firstbounce_core::image::statistics::profile;
use firstbounce_core::{Mask, Plane};
use rayon::prelude::*;

use super::{Kind, Source};

impl Source {
    /// What each number of a pixel is called; one empty name where a pixel has one number.
    pub fn channels(&self) -> &'static [&'static str] {
        match self.kind {
            Kind::Colour => &["red", "green", "blue"],
            Kind::Normal => &["x", "y", "z"],
            Kind::Value | Kind::Difference | Kind::Ratio => &[""],
        }
    }

    /// The numbers shown, a plane for each channel; not a number where there is no value.
    pub fn planes(&self) -> Vec<Plane> {
        let (width, height) = self.size();
        let channel = |channel: usize| {
            let mut out = Plane::filled(width, height, f32::NAN);
            out.data_mut().par_chunks_mut(width.max(1)).enumerate().for_each(|(y, row)| {
                for (x, value) in row.iter_mut().enumerate() {
                    *value = self.values(|plane| plane.plane.at(x, y)).map_or(f32::NAN, |values| values[channel]);
                }
            });
            out
        };
        (0..self.channels().len()).map(channel).collect()
    }

    /// The pixels that are not dimmed; `None` without a mask.
    pub fn inside(&self) -> Option<Mask> {
        let mask = self.mask.as_ref()?;
        Some(mask.marks.map(|inside| inside != 0))
    }

    /// Distances in pixels and, for each channel, the numbers along a line; not a number where there is no value.
    pub fn along(&self, from_px: [f64; 2], to_px: [f64; 2]) -> (Vec<f64>, Vec<Vec<f64>>) {
        let planes: Vec<_> = self.planes.iter().map(|plane| plane.plane.as_ref()).collect();
        let found = profile(&planes, from_px, to_px);
        let at = |sample: usize| {
            let mut values = found.values.iter();
            self.values(|_| values.next().map_or(f32::NAN, |plane| plane[sample] as f32))
        };
        let samples: Vec<_> = (0..found.distance_px.len()).map(at).collect();
        let channel = |channel: usize| {
            samples.iter().map(|values| values.map_or(f64::NAN, |values| f64::from(values[channel]))).collect()
        };
        let channels = (0..self.channels().len()).map(channel).collect();
        (found.distance_px, channels)
    }

    /// Whether both show the same numbers over the same mask.
    pub fn same_numbers(&self, other: &Self) -> bool {
        let keys = |source: &Self| source.planes.iter().map(|plane| plane.key).collect::<Vec<_>>();
        let mask = |source: &Self| source.mask.as_ref().map(|mask| mask.key);
        self.kind == other.kind
            && self.weights == other.weights
            && keys(self) == keys(other)
            && mask(self) == mask(other)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::gpu::{CanvasPlane, Layer};

    #[test]
    fn all_numbers_are_those_of_each_pixel_and_of_a_line() {
        let ramp = CanvasPlane::new(Arc::new(Plane::from_fn(7, 5, |x, y| x as f32 + 10.0 * y as f32)));
        let flat = CanvasPlane::new(Arc::new(Plane::filled(7, 5, 2.0)));
        let layer = Layer::combination(&[ramp, flat], &[3.0, -1.0]).unwrap();
        let source = Source::value(layer).unwrap();
        let planes = source.planes();
        assert_eq!(planes.len(), 1);
        assert_eq!(vec![planes[0].at(4, 3)], source.values_at(4, 3));
        let (distance_px, values) = source.along([0.5, 1.5], [6.5, 1.5]);
        assert_eq!((distance_px[2], values[0][2]), (2.0, 3.0 * 12.0 - 2.0));
    }

    #[test]
    fn pictures_of_other_numbers_are_told_apart() {
        let plane = |value| CanvasPlane::new(Arc::new(Plane::filled(3, 3, value)));
        let (a, b) = (plane(1.0), plane(1.0));
        assert!(Source::plane(a.clone()).same_numbers(&Source::plane(a.clone())));
        assert!(!Source::plane(a.clone()).same_numbers(&Source::plane(b)));
        let twice = Source::value(Layer::from(a.clone()).amplified(2.0)).unwrap();
        assert!(!Source::plane(a).same_numbers(&twice));
    }
}
