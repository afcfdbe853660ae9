//! One scale for pictures that are compared.

use firstbounce_capture::set::Subject;

use super::picture::{Picture, reference};
use crate::app::state::document::Document;
use crate::app::state::layout::{Scale, Shown, View};
use crate::app::state::results::{Plain, PlainPicture, Quantity, Results};
use crate::gpu::Display;

/// Indirect light is shown brighter by a power of two up to this.
const MAX_FACTOR: f32 = 64.0;
/// Of the brightest light of the photo: what stays below is shown brighter.
const DIM: f32 = 0.25;

/// How a picture is drawn in a view: all light of a lamp on the scale of its photo, unless the view has one of its own. What
/// is a small part of that light is shown brighter by a factor, which is told; never beside another picture in one view.
pub fn scaled(
    shown: &Shown,
    picture: &Picture,
    view: &View,
    is_compared: bool,
    document: &Document,
    results: &Results,
) -> (Display, Option<u32>) {
    let display = view.look.over(&picture.display);
    if view.look.scale == Scale::Own || view.look.range.is_some() {
        return (display, None);
    }
    let Some([_, top]) = common_range(shown, document, results) else { return (display, None) };
    let own = picture.display.range[1];
    let factor =
        if is_compared || !is_part(shown) || own > DIM * top || own <= 0.0 { 1.0 } else { floor_power(top / own) };
    let factor = factor.clamp(1.0, MAX_FACTOR);
    let display = Display { range: [0.0, top / factor], ..display };
    (display, (factor > 1.0).then_some(factor as u32))
}

/// The range of the photo of the same light in the reference colour, for light of the object.
fn common_range(shown: &Shown, document: &Document, results: &Results) -> Option<[f32; 2]> {
    let is_light = shown.quantity(&document.set).difference == Quantity::LIGHT.difference;
    if !is_light || shown.subject() != Subject::Object || matches!(shown, Shown::Difference(..) | Shown::Marks { .. }) {
        return None;
    }
    let range = reference(document, results, shown.light()?)?.range;
    (range[1] > 0.0).then_some([0.0, range[1]])
}

/// Whether it is a small part of the light by nature.
fn is_part(shown: &Shown) -> bool {
    match shown {
        Shown::Bounce { k, .. } => *k > 1,
        Shown::Plain(PlainPicture { plain, .. }) => matches!(plain, Plain::Indirect | Plain::Residual | Plain::Noise),
        _ => false,
    }
}

fn floor_power(ratio: f32) -> f32 {
    ratio.log2().floor().exp2()
}

#[cfg(test)]
mod tests {
    use super::floor_power;

    #[test]
    fn a_factor_is_the_largest_power_of_two_that_fits() {
        assert_eq!([1.0, 3.9, 4.0, 30.0].map(floor_power), [1.0, 2.0, 4.0, 16.0]);
    }
}
