//! Calibration of lamps and paint from balls: alpha, beta, intensities and directions, each with its 95 %
//! interval, the pixels it was measured on, and the pixels refused, by reason.
//!
//! The intervals take in the scatter between regions of the ball (see [`crate::interval`]) and the error of the circle.

mod agreement;
mod crosstalk;
mod direction;
mod error;
mod highlight;
mod intensity;
mod pixels;
mod position;
mod ratio;

pub use agreement::{CombinedDirection, DirectionSource, Disagreement, SourcedDirection, combine_directions};
pub use crosstalk::{CrosstalkOptions, CrosstalkReport, measure_crosstalk, pool_shares};
pub use direction::{DirectionEstimate, ShadingOptions, ShadingReport, direction_from_shading};
pub use error::CalibrateError;
pub use highlight::{Highlight, HighlightOptions, HighlightReport, find_highlights};
pub use intensity::{IntensityOptions, Lamp, StrengthReport, measure_strength, relative_intensities};
pub use pixels::{BallPixels, PixelCounts, PixelOptions, PixelUse};
pub use position::{PositionEstimate, Sighting, lamp_position};
pub use ratio::{RatioOptions, RatioReport, measure_ratio, pool_beta};
