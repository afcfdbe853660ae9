//! Distances as colours.

use crate::image::colour::linear_from_srgb;

/// Vertices without a counterpart.
const NO_COUNTERPART: [f32; 3] = [0.2, 0.2, 0.2];

/// A linear RGB colour for each distance, for `Mesh::colours`: blue at `-range_mm` and beyond, white at 0, red at
/// `range_mm` and beyond, grey without a distance.
///
/// The colours are ColorBrewer's RdBu (Harrower and Brewer 2003), which colour-blind people can read too.
pub fn colour_by_distance(signed_mm: &[Option<f32>], range_mm: f32) -> Vec<[f32; 3]> {
    let colour = |signed: f32| {
        // RdBu runs from red at 0 to blue at 1. A range of zero still tells the signs apart.
        let along = 0.5 - 0.5 * f64::from(signed / range_mm.max(f32::MIN_POSITIVE));
        let encoded = colorous::RED_BLUE.eval_continuous(along.clamp(0.0, 1.0));
        encoded.as_array().map(|channel| linear_from_srgb(f32::from(channel) / 255.0))
    };
    signed_mm.iter().map(|signed| signed.map_or(NO_COUNTERPART, colour)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outside_is_red_inside_is_blue_and_zero_is_pale() {
        let colours = colour_by_distance(&[Some(1.0), Some(-1.0), Some(0.0), None, Some(9.0)], 1.0);
        assert!(colours[0][0] > 2.0 * colours[0][2]);
        assert!(colours[1][2] > 2.0 * colours[1][0]);
        assert!(colours[2].iter().all(|&channel| channel > 0.8));
        assert_eq!(colours[3], NO_COUNTERPART);
        assert_eq!(colours[4], colours[0], "beyond the range the colour stays");
    }
}
