//! Pairs of points that the user picks on the surface and on the reference, one after the other, for a rough alignment.

use nalgebra::Point3;

use crate::app::state::surfaces::LayerName;

/// Three pairs fix a position.
pub const MIN_PAIRS: usize = 3;

/// The points so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pairs {
    /// On the surface after, in the object frame.
    on_surface: Vec<Point3<f64>>,
    /// On the reference, in its own frame.
    on_reference: Vec<Point3<f64>>,
}

impl Pairs {
    /// The surface that the next point belongs on.
    pub fn next(&self) -> LayerName {
        if self.on_surface.len() > self.on_reference.len() { LayerName::Reference } else { LayerName::AFTER }
    }

    /// Takes the next point.
    pub fn add(&mut self, point: Point3<f64>) {
        match self.next() {
            LayerName::Reference => self.on_reference.push(point),
            _ => self.on_surface.push(point),
        }
    }

    /// Takes the last point back.
    pub fn take_back(&mut self) {
        match self.next() {
            LayerName::Reference => self.on_surface.pop(),
            _ => self.on_reference.pop(),
        };
    }

    /// The points on one of the two.
    pub fn on(&self, layer: LayerName) -> &[Point3<f64>] {
        match layer {
            LayerName::Reference => &self.on_reference,
            _ => &self.on_surface,
        }
    }

    /// Whole pairs, as the alignment takes them.
    pub fn pairs(&self) -> Vec<(Point3<f64>, Point3<f64>)> {
        self.on_surface.iter().copied().zip(self.on_reference.iter().copied()).collect()
    }

    /// Whether there are enough.
    pub fn is_enough(&self) -> bool {
        self.on_reference.len() >= MIN_PAIRS
    }

    /// What to do next.
    pub fn words(&self) -> String {
        let number = self.on_reference.len() + 1;
        match self.next() {
            LayerName::Reference => format!("Point {number}: click the same place on the reference."),
            _ if self.is_enough() => {
                format!("{} pairs are picked: align in Shape, or click a further place.", number - 1)
            }
            _ => format!("Point {number} of {MIN_PAIRS}: click a place on the surface that the reference has too."),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_go_to_the_two_surfaces_in_turn() {
        let mut pairs = Pairs::default();
        for step in 0..6 {
            let expected = if step % 2 == 0 { LayerName::AFTER } else { LayerName::Reference };
            assert_eq!((pairs.next(), pairs.is_enough()), (expected, false));
            pairs.add(Point3::new(f64::from(step), 0.0, 0.0));
        }
        assert!(pairs.is_enough());
        assert_eq!(pairs.pairs()[2], (Point3::new(4.0, 0.0, 0.0), Point3::new(5.0, 0.0, 0.0)));
        pairs.take_back();
        assert_eq!((pairs.next(), pairs.on(LayerName::Reference).len()), (LayerName::Reference, 2));
    }
}
