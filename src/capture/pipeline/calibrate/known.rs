//! A value of a calibration: where it comes from, how well it is known, and what the balls say against it.

use firstbounce_core::calibrate::BallPixels;
use firstbounce_core::interval::{Estimate, Interval};

use crate::set::SphereKind;

/// Where a value comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The reference colour's alpha and beta, the first light's intensity: 1 by definition.
    Definition,
    /// capture.toml, where the user typed it or the program wrote it.
    File,
    /// A light file (.lp).
    LightFile,
    /// The grey ball.
    GreyBall,
    /// The ball of the object's paint.
    MaterialBall,
    /// The object itself: the end of its colour ratios, and the amount of its indirect light.
    Object,
    /// The highlight on the mirror ball.
    MirrorBall,
    /// The grey ball's shading.
    Shading,
    /// Mirror ball and shading, which agree.
    MirrorAndShading,
    /// What a rendered set knows of itself.
    Truth,
    /// Nothing: an assumption, named in a warning.
    Assumed,
}

impl Source {
    /// For people.
    pub fn words(self) -> &'static str {
        match self {
            Self::Definition => "by definition",
            Self::File => "capture.toml",
            Self::LightFile => "light file",
            Self::GreyBall => "grey ball",
            Self::MaterialBall => "ball of the paint",
            Self::Object => "measured on the object",
            Self::MirrorBall => "mirror ball",
            Self::Shading => "grey ball's shading",
            Self::MirrorAndShading => "mirror ball and grey ball's shading",
            Self::Truth => "the set's truth",
            Self::Assumed => "assumed",
        }
    }

    /// Whether a value of this source was measured on a ball of this kind.
    pub(in crate::pipeline) fn uses_ball(self, kind: SphereKind) -> bool {
        match self {
            Self::GreyBall | Self::Shading => kind == SphereKind::Grey,
            Self::MaterialBall => kind == SphereKind::Material,
            Self::MirrorBall => kind == SphereKind::Mirror,
            Self::MirrorAndShading => kind != SphereKind::Material,
            _ => false,
        }
    }
}

/// A calibration value, and how well it is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Known<T> {
    /// The value in force.
    pub value: T,
    /// Ends of the 95 % interval; `None` for what was typed or assumed.
    pub interval: Option<[T; 2]>,
    /// Where it comes from.
    pub source: Source,
    /// The ball's pixels, used and refused by reason; `None` where none were looked at. Of a direction, the grey ball's.
    pub pixels: Option<BallPixels>,
    /// What the balls say, where the file's value is in force and they were looked at.
    pub measured: Option<Measured<T>>,
}

/// What the balls say of a value that is not in force.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured<T> {
    /// The value.
    pub value: T,
    /// Ends of its 95 % interval.
    pub interval: [T; 2],
}

/// A typed value and a measured one that cannot both be right.
pub(in crate::pipeline) struct Contradicted {
    /// What the balls say.
    pub measured: Estimate,
    /// How far the typed value is off it, relative to it.
    pub share: f64,
}

/// A typed value may be off what the balls say by this many half widths of their interval, and by this share: users round.
pub(super) const MAX_HALF_WIDTHS: f64 = 2.0;
const MAX_TYPED_SHARE: f64 = 0.01;

impl<T> Known<T> {
    pub(in crate::pipeline) fn new(value: T, source: Source) -> Self {
        Self { value, interval: None, source, pixels: None, measured: None }
    }

    pub(in crate::pipeline) fn from_file(value: T) -> Self {
        Self::new(value, Source::File)
    }
}

impl<T: Copy> Known<T> {
    /// The file's value, with what the balls say or said of it.
    pub(super) fn beside(mut self, balls: Option<&Self>) -> Self {
        self.measured = balls.and_then(|balls| match (balls.source, balls.interval) {
            (Source::File, _) => balls.measured.clone(),
            (_, interval) => Some(Measured { value: balls.value, interval: interval? }),
        });
        self
    }
}

impl Known<f64> {
    pub(in crate::pipeline) fn by_definition() -> Self {
        Self { interval: Some([1.0; 2]), ..Self::new(1.0, Source::Definition) }
    }

    pub(in crate::pipeline) fn measured(estimate: Estimate, source: Source, pixels: Option<BallPixels>) -> Self {
        let interval = [estimate.interval.low, estimate.interval.high];
        Self { interval: Some(interval), pixels, ..Self::new(estimate.value, source) }
    }

    /// What the balls say instead, where this was typed and is farther off than both can be right.
    pub(in crate::pipeline) fn contradicted(&self) -> Option<Contradicted> {
        let Measured { value, interval: [low, high] } = *self.measured.as_ref()?;
        let measured = Estimate { value, interval: Interval { low, high } };
        let share = (self.value / value - 1.0).abs();
        let allowed = (MAX_HALF_WIDTHS * measured.relative_half_width()).max(MAX_TYPED_SHARE);
        (share > allowed).then_some(Contradicted { measured, share })
    }

    /// As the core's formulas take it; a typed value counts as exact.
    pub(in crate::pipeline) fn estimate(&self) -> Estimate {
        let [low, high] = self.interval.unwrap_or([self.value; 2]);
        Estimate { value: self.value, interval: Interval { low, high } }
    }
}
