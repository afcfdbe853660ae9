//! Every number of the format, with the ends of its range.
//!
//! The ends lie far beyond what a camera, a lamp or a paint can be, and near enough that whatever is computed from any
//! numbers within them is a number too, also in single precision.

use std::ops::RangeInclusive;

/// A number of the format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Number {
    /// `mm_per_pixel` of an orthographic camera.
    MmPerPixel,
    /// `focal_length_px` of a perspective camera.
    FocalLengthPx,
    /// A coordinate of `principal_point`.
    PrincipalPoint,
    /// `working_distance_mm` of a perspective camera.
    WorkingDistanceMm,
    /// `gamma` of an encoding.
    Gamma,
    /// `black_level`.
    BlackLevel,
    /// `white_level`.
    WhiteLevel,
    /// `full_well_electrons`.
    FullWellElectrons,
    /// `read_noise_electrons`.
    ReadNoiseElectrons,
    /// A coefficient of `distortion`.
    Distortion,
    /// A number of `crosstalk`.
    Crosstalk,
    /// A component of a direction.
    Direction,
    /// A coordinate of `position_mm`.
    PositionMm,
    /// `exposure` of a shot.
    Exposure,
    /// A coordinate of a circle's centre.
    Centre,
    /// The radius of a circle.
    Radius,
    /// `diameter_mm` of a ball.
    DiameterMm,
    /// A ratio of albedos.
    Beta,
    /// A ratio of a lamp's intensities in two colours.
    Alpha,
    /// A ratio of two lamps' intensities.
    Intensity,
    /// `grey_albedo`.
    GreyAlbedo,
    /// `white_light`.
    WhiteLight,
    /// `bounces`, a whole number.
    Bounces,
    /// `shadow_share` of `[shape]`.
    ShadowShare,
    /// `misfit_share` of `[shape]`.
    MisfitShare,
    /// `rounds` of `[shape]`, a whole number.
    Rounds,
    /// `indirect_window_px` of `[shape]`, a whole number.
    IndirectWindowPx,
}

impl Number {
    /// Every number of the format.
    pub const ALL: [Self; 27] = [
        Self::MmPerPixel,
        Self::FocalLengthPx,
        Self::PrincipalPoint,
        Self::WorkingDistanceMm,
        Self::Gamma,
        Self::BlackLevel,
        Self::WhiteLevel,
        Self::FullWellElectrons,
        Self::ReadNoiseElectrons,
        Self::Distortion,
        Self::Crosstalk,
        Self::Direction,
        Self::PositionMm,
        Self::Exposure,
        Self::Centre,
        Self::Radius,
        Self::DiameterMm,
        Self::Beta,
        Self::Alpha,
        Self::Intensity,
        Self::GreyAlbedo,
        Self::WhiteLight,
        Self::Bounces,
        Self::ShadowShare,
        Self::MisfitShare,
        Self::Rounds,
        Self::IndirectWindowPx,
    ];

    /// The smallest and the largest value that it may have.
    pub const fn range(self) -> RangeInclusive<f64> {
        match self {
            Self::MmPerPixel => 1e-9..=1e6,
            Self::FocalLengthPx => 1.0..=1e7,
            Self::PrincipalPoint => -1e6..=1e6,
            Self::WorkingDistanceMm => 1e-3..=1e9,
            Self::Gamma => 0.1..=10.0,
            Self::BlackLevel => -1e9..=1e9,
            Self::WhiteLevel => 1e-9..=1e9,
            Self::FullWellElectrons => 1.0..=1e20,
            Self::ReadNoiseElectrons => 0.0..=1e6,
            Self::Distortion => -100.0..=100.0,
            Self::Crosstalk => -1.0..=1.0,
            Self::Direction => -1e6..=1e6,
            Self::PositionMm => -1e7..=1e7,
            Self::Exposure => 1e-9..=1e9,
            Self::Centre => -1e6..=1e6,
            Self::Radius => 1e-3..=1e6,
            Self::DiameterMm => 1e-2..=1e5,
            Self::Beta | Self::Alpha | Self::Intensity => 1e-4..=1e4,
            Self::GreyAlbedo => 1e-4..=1.0,
            Self::WhiteLight => 1e-9..=1e9,
            Self::Bounces => 1.0..=16.0,
            Self::ShadowShare | Self::MisfitShare => 0.0..=0.99,
            Self::Rounds => 1.0..=100.0,
            Self::IndirectWindowPx => 0.0..=64.0,
        }
    }

    /// The same for a whole number that is not negative.
    pub fn whole_range(self) -> RangeInclusive<usize> {
        let (low, high) = self.range().into_inner();
        low as usize..=high as usize
    }

    /// Whether it may have this value.
    pub fn allows(self, value: f64) -> bool {
        self.range().contains(&value)
    }

    /// What it must be, for the end of "expected ..".
    pub(super) fn words(self) -> String {
        let (low, high) = self.range().into_inner();
        let is_whole = matches!(self, Self::Bounces | Self::Rounds | Self::IndirectWindowPx);
        let what = if is_whole { "a whole number" } else { "a number" };
        format!("{what} from {} to {}", short(low), short(high))
    }
}

/// The shortest text that means exactly this number: `0.5`, `3`, `1e300`.
pub(super) fn short(number: f64) -> String {
    let text = format!("{number:?}");
    text.strip_suffix(".0").map(str::to_owned).unwrap_or(text)
}

/// A direction or position shorter than this points nowhere.
const MIN_LENGTH: f64 = 1e-6;

/// What a vector of these components must be.
pub fn vector_words(component: Number) -> String {
    let (low, high) = component.range().into_inner();
    format!("three numbers [x, y, z] from {} to {}, not all zero", short(low), short(high))
}

/// Whether `vector` points anywhere, and its components are what `component` may be.
pub fn is_vector(component: Number, vector: &[f64; 3]) -> bool {
    vector.iter().all(|x| component.allows(*x)) && length(vector) >= MIN_LENGTH
}

pub(super) fn length(vector: &[f64; 3]) -> f64 {
    vector.iter().fold(0.0, |length: f64, x| length.hypot(*x))
}
