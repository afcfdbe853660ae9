//! Masks that the user draws over a picture: a lasso, a brush, a threshold.

use rayon::prelude::*;

use super::Mask;
use crate::Plane;

/// What a drawn shape does to a mask.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Combine {
    /// The shape's pixels become the object's.
    #[default]
    Add,
    /// The shape's pixels are the object's no longer.
    Remove,
}

impl Mask {
    /// The pixels whose centres lie inside a polygon, by the even-odd rule: where a lasso crosses itself, what is
    /// encircled twice is outside. Corners in pixels, anywhere; the last is joined to the first.
    pub fn polygon((width, height): (usize, usize), corners_px: &[[f64; 2]]) -> Self {
        let edges: Vec<_> = corners_px.iter().zip(corners_px.iter().cycle().skip(1)).collect();
        Self::from_rows(width, height, |y, row| {
            let line = y as f64 + 0.5;
            let mut crossings: Vec<f64> = edges
                .iter()
                .filter(|(a, b)| (a[1] <= line) != (b[1] <= line))
                .map(|(a, b)| a[0] + (line - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
                .collect();
            crossings.sort_by(f64::total_cmp);
            for pair in crossings.chunks_exact(2) {
                fill_span(row, pair[0], pair[1]);
            }
        })
    }

    /// The pixels whose centres lie within `radius_px` of a path: what a round brush paints. One point paints a disc.
    pub fn stroke((width, height): (usize, usize), path_px: &[[f64; 2]], radius_px: f64) -> Self {
        let first = path_px.first().into_iter().map(|point| (*point, *point));
        let pieces: Vec<_> = first.chain(path_px.windows(2).map(|pair| (pair[0], pair[1]))).collect();
        Self::from_rows(width, height, |y, row| {
            let line = y as f64 + 0.5;
            for &(a, b) in &pieces {
                if line < a[1].min(b[1]) - radius_px || line > a[1].max(b[1]) + radius_px {
                    continue;
                }
                let (low, high) = (a[0].min(b[0]) - radius_px, a[0].max(b[0]) + radius_px);
                let columns = column_from(low, width)..column_from(high, width);
                for (x, inside) in columns.clone().zip(&mut row[columns]) {
                    *inside |= distance_px([x as f64 + 0.5, line], a, b) <= radius_px;
                }
            }
        })
    }

    /// The pixels brighter than `threshold`, in the picture's own unit.
    pub fn brighter_than(picture: &Plane, threshold: f32) -> Self {
        picture.map(|value| value > threshold)
    }

    /// Adds or removes the pixels of `shape`; false, and nothing done, if the two differ in size.
    pub fn combine(&mut self, shape: &Self, how: Combine) -> bool {
        if self.size() != shape.size() {
            return false;
        }
        self.data_mut().par_iter_mut().zip(shape.data()).for_each(|(inside, drawn)| match how {
            Combine::Add => *inside |= drawn,
            Combine::Remove => *inside &= !drawn,
        });
        true
    }

    fn from_rows(width: usize, height: usize, fill: impl Fn(usize, &mut [bool]) + Sync) -> Self {
        let mut mask = Self::filled(width, height, false);
        if width > 0 {
            mask.data_mut().par_chunks_exact_mut(width).enumerate().for_each(|(y, row)| fill(y, row));
        }
        mask
    }
}

/// The first column whose pixel centre lies at `x_px` or right of it.
fn column_from(x_px: f64, width: usize) -> usize {
    ((x_px - 0.5).ceil().max(0.0) as usize).min(width)
}

fn fill_span(row: &mut [bool], from_px: f64, to_px: f64) {
    let columns = column_from(from_px, row.len())..column_from(to_px, row.len());
    row[columns].fill(true);
}

/// From a point to the nearest point of a straight piece.
fn distance_px(point: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let length_squared = along[0].powi(2) + along[1].powi(2);
    let share = ((point[0] - a[0]) * along[0] + (point[1] - a[1]) * along[1]) / length_squared.max(f64::MIN_POSITIVE);
    let share = share.clamp(0.0, 1.0);
    (point[0] - a[0] - share * along[0]).hypot(point[1] - a[1] - share * along[1])
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_square_lasso_holds_the_pixels_whose_centres_it_holds() {
        let square = [[2.0, 1.0], [6.0, 1.0], [6.0, 4.0], [2.0, 4.0]];
        let expected = Mask::from_fn(8, 6, |x, y| (2..6).contains(&x) && (1..4).contains(&y));
        assert_eq!(Mask::polygon((8, 6), &square), expected);
    }

    #[test]
    fn a_lasso_may_leave_the_picture_and_a_line_holds_nothing() {
        let around = [[-9.0, -9.0], [30.0, -9.0], [30.0, 30.0], [-9.0, 30.0]];
        assert_eq!(Mask::polygon((8, 6), &around).count(), 48);
        assert_eq!(Mask::polygon((8, 6), &around[..2]).count(), 0);
        assert_eq!(Mask::polygon((0, 0), &around).count(), 0);
    }

    #[test]
    fn what_a_lasso_encircles_twice_is_outside() {
        let star: Vec<[f64; 2]> = (0..5)
            .map(|k| f64::from(k) * 2.0 * std::f64::consts::TAU / 5.0)
            .map(|angle| [50.0 + 40.0 * angle.sin(), 50.0 - 40.0 * angle.cos()])
            .collect();
        let mask = Mask::polygon((100, 100), &star);
        assert!(!mask.at(50, 50), "the star's heart");
        assert!(mask.at(50, 20), "its upper arm");
    }

    #[test]
    fn a_dab_of_the_brush_is_a_disc() {
        let mask = Mask::stroke((40, 40), &[[20.0, 20.0]], 10.0);
        let disc = Mask::from_fn(40, 40, |x, y| (x as f64 - 19.5).hypot(y as f64 - 19.5) <= 10.0);
        assert_eq!(mask, disc);
    }

    #[test]
    fn erasing_a_stroke_leaves_what_it_did_not_touch() {
        let path = [[5.0, 20.0], [35.0, 25.0]];
        let mut mask = Mask::filled(40, 40, true);
        let stroke = Mask::stroke((40, 40), &path, 3.0);
        assert!(mask.combine(&stroke, Combine::Remove));
        assert_eq!(mask.count() + stroke.count(), 1600);
        assert!(mask.combine(&stroke, Combine::Add));
        assert_eq!(mask.count(), 1600);
        assert!(!mask.combine(&Mask::filled(3, 3, true), Combine::Add));
    }

    #[test]
    fn a_threshold_parts_a_ramp() {
        let ramp = Plane::from_fn(10, 2, |x, _| x as f32);
        assert_eq!(Mask::brighter_than(&ramp, 6.5), Mask::from_fn(10, 2, |x, _| x >= 7));
    }

    proptest! {
        /// A stroke of the brush covers twice its radius times its length and a disc, to the raster's roughness.
        #[test]
        fn a_stroke_has_the_area_of_its_sausage(
            a in (30.0..70.0, 30.0..70.0), b in (30.0..70.0, 30.0..70.0), radius in 4.0..20.0,
        ) {
            let length = f64::hypot(b.0 - a.0, b.1 - a.1);
            let area = 2.0 * radius * length + std::f64::consts::PI * radius * radius;
            let rim = 2.0 * length + std::f64::consts::TAU * radius;
            let mask = Mask::stroke((100, 100), &[[a.0, a.1], [b.0, b.1]], radius);
            prop_assert!((mask.count() as f64 - area).abs() < 0.25 * rim + 3.0, "{} {area}", mask.count());
        }

        /// A triangle drawn in either direction holds half the cross product of its sides.
        #[test]
        fn a_triangle_has_its_area(corners in prop::array::uniform3((5.0..95.0, 5.0..95.0))) {
            let [a, b, c] = corners.map(|(x, y): (f64, f64)| [x, y]);
            let area = ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])).abs() / 2.0;
            let rim: f64 = [(a, b), (b, c), (c, a)].iter().map(|(p, q)| (p[0] - q[0]).hypot(p[1] - q[1])).sum();
            let mask = Mask::polygon((100, 100), &[a, b, c]);
            prop_assert!((mask.count() as f64 - area).abs() < 0.25 * rim + 3.0);
            prop_assert_eq!(mask, Mask::polygon((100, 100), &[c, b, a]));
        }
    }
}
