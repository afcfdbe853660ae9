//! The calibration of a set in the words of the capture file, for `--json`, the table and the reports.

use firstbounce_core::calibrate::PixelCounts;
use indexmap::IndexMap;
use serde::Serialize;

use crate::pipeline::{Calibrated, Known, ScaleSource};
use crate::set::CaptureSet;

/// Values by the words of the capture file; lights whose values nothing tells are left out.
#[derive(Clone, Debug, Serialize)]
pub struct CalibrationRecord {
    /// By light, per colour.
    pub alpha: IndexMap<String, Vec<f64>>,
    /// Per colour; empty where nothing tells.
    pub beta: Vec<f64>,
    /// By light.
    pub intensity: IndexMap<String, f64>,
    /// By light.
    pub direction: IndexMap<String, [f64; 3]>,
    /// By channel, then lamp: the crosstalk that was undone; empty where nothing tells.
    pub crosstalk: Vec<Vec<f64>>,
    /// The scale at the object's z = 0; absent where lengths are in pixels.
    pub mm_per_pixel: Option<ScaleRecord>,
    /// By light, of those that several mirror balls, or one in two places, place.
    pub position_mm: IndexMap<String, PositionRecord>,
    /// The same shape with the ends of the 95 % intervals; typed values have none.
    pub interval: IntervalRecord,
    /// The same shape with where each value comes from.
    pub source: SourceRecord,
    /// By subject, or for balls in the object's scene by kind.
    pub circle: IndexMap<String, CircleRecord>,
    /// By quantity and light, pixels used and refused by reason.
    pub pixels: IndexMap<String, PixelCounts>,
    /// What the user should know.
    pub warnings: Vec<String>,
    #[serde(skip)]
    rows: Vec<Row>,
}

/// Ends of the 95 % intervals.
#[derive(Clone, Debug, Serialize)]
pub struct IntervalRecord {
    /// By light, per colour.
    pub alpha: IndexMap<String, Vec<Option<[f64; 2]>>>,
    /// Per colour.
    pub beta: Vec<Option<[f64; 2]>>,
    /// By light.
    pub intensity: IndexMap<String, Option<[f64; 2]>>,
    /// By light, for x, y and z.
    pub direction: IndexMap<String, Option<[[f64; 2]; 3]>>,
    /// By channel, then lamp.
    pub crosstalk: Vec<Vec<Option<[f64; 2]>>>,
}

/// Where each value comes from.
#[derive(Clone, Debug, Serialize)]
pub struct SourceRecord {
    /// By light, per colour.
    pub alpha: IndexMap<String, Vec<&'static str>>,
    /// Per colour.
    pub beta: Vec<&'static str>,
    /// By light.
    pub intensity: IndexMap<String, &'static str>,
    /// By light.
    pub direction: IndexMap<String, &'static str>,
    /// By channel, then lamp.
    pub crosstalk: Vec<Vec<&'static str>>,
}

/// Where a lamp is, in mm.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PositionRecord {
    /// x, y and z.
    pub value: [f64; 3],
    /// 95 % intervals of x, y and z.
    pub interval: Option<[[f64; 2]; 3]>,
}

/// mm that a pixel spans.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ScaleRecord {
    /// In force.
    pub value: f64,
    /// What balls of known diameter say; absent where there is none.
    pub by_balls: Option<f64>,
    /// Where the value in force comes from.
    pub source: &'static str,
}

/// A ball's outline in pixels.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct CircleRecord {
    /// Centre.
    pub centre: [f64; 2],
    /// Radius.
    pub radius: f64,
    /// Standard deviation of centre and radius; absent for a circle that the file gives.
    pub sd: Option<f64>,
    /// Share of the rim on which the edge was seen; absent for a circle that the file gives.
    pub rim_seen: Option<f64>,
}

/// A line of the table that people read.
#[derive(Clone, Debug)]
pub struct Row {
    /// "alpha, left, green"
    pub quantity: String,
    /// The value.
    pub value: String,
    /// Its 95 % interval.
    pub interval: String,
    /// Where it comes from.
    pub source: &'static str,
    /// Pixels used.
    pub used: String,
    /// Pixels refused, by reason.
    pub refused: String,
}

impl CalibrationRecord {
    /// Of a set's calibration.
    pub fn of(set: &CaptureSet, calibrated: &Calibrated) -> Self {
        let lights = || set.lights.iter().map(|light| light.name.clone());
        let alpha = || lights().zip(&calibrated.alpha).filter_map(|(light, known)| Some((light, known.as_ref()?)));
        let beta = calibrated.beta.as_deref().unwrap_or_default();
        let intensity = || lights().zip(&calibrated.intensity);
        let direction =
            || lights().zip(&calibrated.direction).filter_map(|(light, known)| Some((light, known.as_ref()?)));
        let rows = rows(set, calibrated);
        let pixels = rows.iter().filter_map(|(row, counts)| Some((row.quantity.clone(), (*counts)?)));
        Self {
            alpha: alpha().map(|(light, known)| (light, known.iter().map(|known| known.value).collect())).collect(),
            beta: beta.iter().map(|known| known.value).collect(),
            intensity: intensity().map(|(light, known)| (light, known.value)).collect(),
            direction: direction().map(|(light, known)| (light, known.value)).collect(),
            crosstalk: by_channel(calibrated, |known| known.value),
            mm_per_pixel: scale(set),
            position_mm: calibrated
                .positions_mm(set)
                .map(|(light, known)| {
                    (light.to_owned(), PositionRecord { value: known.value, interval: by_axis(known) })
                })
                .collect(),
            interval: IntervalRecord {
                alpha: alpha().map(|(l, known)| (l, known.iter().map(|known| known.interval).collect())).collect(),
                beta: beta.iter().map(|known| known.interval).collect(),
                intensity: intensity().map(|(light, known)| (light, known.interval)).collect(),
                direction: direction().map(|(light, known)| (light, by_axis(known))).collect(),
                crosstalk: by_channel(calibrated, |known| known.interval),
            },
            source: SourceRecord {
                alpha: alpha()
                    .map(|(l, known)| (l, known.iter().map(|known| known.source.words()).collect()))
                    .collect(),
                beta: beta.iter().map(|known| known.source.words()).collect(),
                intensity: intensity().map(|(light, known)| (light, known.source.words())).collect(),
                direction: direction().map(|(light, known)| (light, known.source.words())).collect(),
                crosstalk: by_channel(calibrated, |known| known.source.words()),
            },
            circle: circles(calibrated),
            pixels: pixels.collect(),
            warnings: calibrated.warnings.clone(),
            rows: rows.into_iter().map(|(row, _)| row).collect(),
        }
    }

    /// The table that people read.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }
}

fn scale(set: &CaptureSet) -> Option<ScaleRecord> {
    let source = ScaleSource::of(set).words();
    Some(ScaleRecord { value: set.mm_per_pixel()?, by_balls: set.mm_per_pixel_of_balls(), source })
}

fn by_channel<T>(calibrated: &Calibrated, value: impl Fn(&Known<f64>) -> T) -> Vec<Vec<T>> {
    calibrated.crosstalk.iter().map(|row| row.iter().map(&value).collect()).collect()
}

fn by_axis(known: &Known<[f64; 3]>) -> Option<[[f64; 2]; 3]> {
    let [low, high] = known.interval?;
    Some(std::array::from_fn(|axis| [low[axis], high[axis]]))
}

fn circles(calibrated: &Calibrated) -> IndexMap<String, CircleRecord> {
    let words = calibrated.circles.iter().map(|ball| {
        let own = ball.sphere.subject.sphere_kind() == Some(ball.sphere.kind);
        let name = if own { ball.sphere.subject.to_string() } else { format!("{} ball", ball.sphere.kind) };
        let words = CircleRecord {
            centre: ball.sphere.circle.centre,
            radius: ball.sphere.circle.radius,
            sd: ball.found.as_ref().map(|found| found.sd_px),
            rim_seen: ball.found.as_ref().map(|found| found.rim_seen),
        };
        (name, words)
    });
    words.collect()
}

fn rows(set: &CaptureSet, calibrated: &Calibrated) -> Vec<(Row, Option<PixelCounts>)> {
    let mut rows: Vec<_> = scale(set).into_iter().filter_map(scale_row).collect();
    for (channel, of_channel) in set.colours.iter().zip(&calibrated.crosstalk) {
        for (lamp, known) in set.colours.iter().zip(of_channel).filter(|(lamp, _)| lamp.name != channel.name) {
            rows.push(row(format!("crosstalk, {} lamp in channel of {}", lamp.name, channel.name), known));
        }
    }
    for (light, alpha) in set.lights.iter().zip(&calibrated.alpha) {
        for (colour, known) in set.colours.iter().zip(alpha.iter().flatten()).skip(1) {
            rows.push(row(format!("alpha, {}, {}", light.name, colour.name), known));
        }
    }
    for (colour, known) in set.colours.iter().zip(calibrated.beta.iter().flatten()).skip(1) {
        rows.push(row(format!("beta, {}", colour.name), known));
    }
    for (light, known) in set.lights.iter().zip(&calibrated.intensity) {
        rows.push(row(format!("intensity, {}", light.name), known));
    }
    for (light, known) in set.lights.iter().zip(&calibrated.direction) {
        if let Some(known) = known {
            rows.push(row(format!("direction, {}", light.name), known));
        }
    }
    rows.extend(calibrated.positions_mm(set).map(|(light, known)| row(format!("position in mm, {light}"), known)));
    rows
}

/// Where a ball says something of the scale.
fn scale_row(scale: ScaleRecord) -> Option<(Row, Option<PixelCounts>)> {
    let by_balls = scale.by_balls?;
    let beside =
        if scale.source == ScaleSource::Balls.words() { String::new() } else { format!(" (balls: {by_balls:.5})") };
    let row = Row {
        quantity: "mm per pixel".into(),
        value: format!("{:.5}{beside}", scale.value),
        interval: String::new(),
        source: scale.source,
        used: String::new(),
        refused: String::new(),
    };
    Some((row, None))
}

fn row<T: Shown>(quantity: String, known: &Known<T>) -> (Row, Option<PixelCounts>) {
    let counts = known.pixels.as_ref().map(|pixels| pixels.counts());
    let row = Row {
        quantity,
        value: known.value.value(),
        interval: known.interval.as_ref().map_or_else(String::new, |[low, high]| T::half_width(low, high)),
        source: known.source.words(),
        used: counts.map_or_else(String::new, |counts| counts.used.to_string()),
        refused: counts.map_or_else(String::new, refused),
    };
    (row, counts)
}

/// A value as the table shows it.
trait Shown {
    fn value(&self) -> String;
    fn half_width(low: &Self, high: &Self) -> String;
}

impl Shown for f64 {
    fn value(&self) -> String {
        format!("{self:.4}")
    }

    fn half_width(low: &Self, high: &Self) -> String {
        format!("\u{b1} {:.4}", (high - low) / 2.0)
    }
}

impl Shown for [f64; 3] {
    fn value(&self) -> String {
        self.map(|x| format!("{x:.4}")).join(", ")
    }

    fn half_width(low: &Self, high: &Self) -> String {
        let each: [String; 3] = std::array::from_fn(|axis| format!("{:.4}", (high[axis] - low[axis]) / 2.0));
        format!("\u{b1} {}", each.join(", "))
    }
}

/// The reasons that refused any pixel.
fn refused(counts: PixelCounts) -> String {
    let reasons = [
        ("near the rim", counts.near_rim),
        ("near the terminator", counts.near_terminator),
        ("clipped", counts.clipped),
        ("dark", counts.dark),
        ("highlight", counts.highlight),
        ("outlier", counts.outlier),
    ];
    let named = reasons.into_iter().filter(|(_, count)| *count > 0);
    named.map(|(reason, count)| format!("{count} {reason}")).collect::<Vec<_>>().join(", ")
}
