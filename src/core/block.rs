//! Sums over short runs of pixels, written so that the compiler works on many pixels at a time.

/// Pixels of one job of a core.
pub const JOB: usize = 1 << 15;
/// Pixels that stay in the first-level cache while all planes of them are worked on.
pub const BLOCK: usize = 512;

/// `out = constant + sum_i weight_i plane_i`.
pub fn combine(out: &mut [f32], constant: f32, weights: &[f32], planes: &[&[f32]]) {
    match (weights, planes) {
        // Two colours and three lights are the common cases: one pass instead of one for each plane.
        ([w0, w1], [p0, p1]) => {
            out.iter_mut().zip(p0.iter().zip(*p1)).for_each(|(out, (p0, p1))| *out = constant + w0 * p0 + w1 * p1);
        }
        ([w0, w1, w2], [p0, p1, p2]) => {
            let planes = p0.iter().zip(*p1).zip(*p2);
            out.iter_mut().zip(planes).for_each(|(out, ((p0, p1), p2))| *out = constant + w0 * p0 + w1 * p1 + w2 * p2);
        }
        _ => {
            out.fill(constant);
            for (weight, plane) in weights.iter().zip(planes) {
                out.iter_mut().zip(*plane).for_each(|(out, value)| *out += weight * value);
            }
        }
    }
}

/// A sum in eight lanes, so that the compiler may add them side by side.
pub fn sum_of(values: &[f32]) -> f32 {
    let (eights, rest) = values.as_chunks::<8>();
    let lanes = eights.iter().fold([0.0; 8], |mut lanes, eight| {
        lanes.iter_mut().zip(eight).for_each(|(lane, value)| *lane += value);
        lanes
    });
    lanes.iter().sum::<f32>() + rest.iter().sum::<f32>()
}

/// Whether every value is true. No early end: a run of pixels is compared at once.
pub fn all_true(values: &[bool]) -> bool {
    values.iter().fold(true, |all, value| all & value)
}

/// Whether every value is false.
pub fn all_false(values: &[bool]) -> bool {
    !values.iter().fold(false, |any, value| any | value)
}

/// Whether no pixel carries a mark.
pub fn all_zero(marks: &[u8]) -> bool {
    marks.iter().fold(0, |all, mark| all | mark) == 0
}
