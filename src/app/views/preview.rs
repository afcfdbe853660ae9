//! Direct and indirect light while their stage is at work: drawn from the photos by a matrix that is the same for every pixel.

use firstbounce_capture::pipeline::Method;

use super::picture::{PictureError, combination};
use crate::app::state::document::Document;
use crate::app::state::results::{Plain, PlainPicture, Results, StageError, StageState, Step};
use crate::gpu::Layer;

/// What the picture shows in the place of its stage's result; `None` where it shows that, or there is no preview of it.
pub fn words(name: &PlainPicture, document: &Document, results: &Results) -> Option<&'static str> {
    let row = row(name)?;
    if !matches!(results.state(Step::Separate, document), StageState::Stale | StageState::Running { .. }) {
        return None;
    }
    weights(row, name.light()?, document, results).ok()?;
    match document.method() {
        Method::ColoursAndShape => Some("preview: one colour ratio a light"),
        Method::Colours => Some("preview: bounce 1 with all its noise"),
        Method::Shape => None,
    }
}

/// The preview.
pub fn layer(name: &PlainPicture, document: &Document, results: &Results) -> Result<Layer, PictureError> {
    let (Some(row), Some(light)) = (row(name), name.light()) else { return Err(PictureError::NotInSet) };
    let weights = weights(row, light, document, results)?;
    combination(document, results, light, |c| weights[c])
}

/// Which line of the matrix gives the picture.
fn row(name: &PlainPicture) -> Option<usize> {
    match (name.plain, name.by_method()) {
        (Plain::Direct, None) => Some(0),
        (Plain::Indirect, None) => Some(1),
        _ => None,
    }
}

/// By colour, the weight of its photo.
fn weights(row: usize, light: &str, document: &Document, results: &Results) -> Result<Vec<f64>, StageError> {
    let rig = results.rig(document);
    let operator = match document.method() {
        Method::ColoursAndShape => rig.even_operator(light)?,
        Method::Colours if row == 0 => rig.system(light)?.operator,
        Method::Colours | Method::Shape => return Err(StageError::TooEarly),
    };
    Ok(operator.row(row).iter().copied().collect())
}
