//! What a file says of itself beside its pixels: how it was exposed, when, and on what curve its values are stored.
//!
//! A camera writes what it likes: times of zero, exposures of 0/0. What cannot be true counts as not stated.

use std::fmt;

use exif::{Context, Error, Exif, In, Reader, Tag, Value};

use serde::{Deserialize, Serialize};

use super::Encoding;

/// The longest exposure that is believed, and the shortest as a part of a second.
const EXPOSURE_RANGE_S: std::ops::RangeInclusive<f64> = 1e-7..=1e5;
const F_NUMBER_RANGE: std::ops::RangeInclusive<f64> = 0.1..=1000.0;
const ISO_RANGE: std::ops::RangeInclusive<f64> = 1.0..=1e7;
const FOCAL_LENGTH_RANGE_MM: std::ops::RangeInclusive<f64> = 0.1..=1e5;
/// EXIF's way to say that the sensitivity does not fit into 16 bits.
const ISO_DOES_NOT_FIT: f64 = 65535.0;

/// What a file says of itself; `None` where it says nothing that can be true.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Metadata {
    /// Exposure time in seconds.
    pub exposure_s: Option<f64>,
    /// Focal length over the aperture's diameter.
    pub f_number: Option<f64>,
    /// Sensitivity.
    pub iso: Option<f64>,
    /// Focal length in mm.
    pub focal_length_mm: Option<f64>,
    /// When the photo was taken, by the camera's clock.
    pub taken: Option<TakenAt>,
    /// EXIF orientation, 1 to 8. Pixels are left as they are stored.
    pub orientation: Option<u8>,
    /// On what curve the values are stored.
    #[serde(skip)]
    pub curve: StatedCurve,
}

impl fmt::Display for Metadata {
    /// "1/50 s, f/8, ISO 100, 50 mm, 2026-05-31T14:02:59"; empty where the file says nothing.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let time = self.exposure_s.map(|seconds| match seconds {
            short if short < 0.3 => format!("1/{:.0} s", 1.0 / short),
            long => format!("{long} s"),
        });
        let parts = [
            time,
            self.f_number.map(|f_number| format!("f/{f_number}")),
            self.iso.map(|iso| format!("ISO {iso}")),
            self.focal_length_mm.map(|length| format!("{length} mm")),
            self.taken.map(|taken| taken.to_string()),
        ];
        f.write_str(&parts.into_iter().flatten().collect::<Vec<_>>().join(", "))
    }
}

/// What a file says of the curve between light and its values.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum StatedCurve {
    /// Nothing.
    #[default]
    Unstated,
    /// A curve that can be undone.
    Known(Encoding),
    /// A curve that cannot be undone, by the name that the file gives it.
    Unknown(String),
}

impl fmt::Display for StatedCurve {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unstated => f.write_str("not stated"),
            Self::Known(encoding) => encoding.fmt(f),
            Self::Unknown(name) => f.write_str(name),
        }
    }
}

impl StatedCurve {
    /// The curve, where it can be undone.
    pub fn known(&self) -> Option<Encoding> {
        match self {
            Self::Known(encoding) => Some(*encoding),
            Self::Unstated | Self::Unknown(_) => None,
        }
    }
}

/// A moment by a camera's clock, whose time zone it does not say.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct TakenAt {
    /// Year, month and day.
    pub date: [u16; 3],
    /// Hour, minute and second.
    pub time: [u8; 3],
    /// Milliseconds after the second; 0 where they are not stated.
    pub millisecond: u16,
}

impl TakenAt {
    /// Reads "2026:05:31 14:02:59" and the digits after the second.
    fn of_exif(text: &str, fraction: Option<&str>) -> Option<Self> {
        let numbers: Vec<u16> = text.trim().split([':', ' ']).map(str::parse).collect::<Result<_, _>>().ok()?;
        let [year, month, day, hour, minute, second] = numbers[..] else { return None };
        let is_moment = year > 0
            && (1..=12).contains(&month)
            && (1..=31).contains(&day)
            && hour < 24
            && minute < 60
            && second <= 60;
        let digits: String = fraction.unwrap_or_default().trim().chars().chain("000".chars()).take(3).collect();
        is_moment.then_some(Self {
            date: [year, month, day],
            time: [hour as u8, minute as u8, second as u8],
            millisecond: digits.parse().unwrap_or_default(),
        })
    }
}

impl fmt::Display for TakenAt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { date: [year, month, day], time: [hour, minute, second], millisecond } = self;
        write!(f, "{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}")?;
        if *millisecond > 0 { write!(f, ".{millisecond:03}") } else { Ok(()) }
    }
}

/// The value of an EXIF tag.
pub(super) enum TagValue {
    Number(f64),
    Text(String),
}

/// The tags of EXIF that are read.
pub(super) mod tag {
    pub const ORIENTATION: u16 = 0x0112;
    pub const EXPOSURE_TIME: u16 = 0x829a;
    pub const F_NUMBER: u16 = 0x829d;
    pub const ISO: u16 = 0x8827;
    pub const TAKEN: u16 = 0x9003;
    pub const DIGITISED: u16 = 0x9004;
    pub const SHUTTER_SPEED_APEX: u16 = 0x9201;
    pub const APERTURE_APEX: u16 = 0x9202;
    pub const FOCAL_LENGTH: u16 = 0x920a;
    pub const TAKEN_FRACTION: u16 = 0x9291;
    pub const COLOUR_SPACE: u16 = 0xa001;
}

impl Metadata {
    /// Of EXIF tags, as `find` gives them.
    pub(super) fn of_tags(mut find: impl FnMut(u16) -> Option<TagValue>) -> Self {
        let mut number = |tag: u16| match find(tag) {
            Some(TagValue::Number(number)) => Some(number),
            _ => None,
        };
        let shutter = number(tag::EXPOSURE_TIME).filter(|seconds| EXPOSURE_RANGE_S.contains(seconds));
        let of_apex = number(tag::SHUTTER_SPEED_APEX).map(|stops| (-stops).exp2());
        let f_number = number(tag::F_NUMBER).filter(|f_number| F_NUMBER_RANGE.contains(f_number));
        let f_of_apex = number(tag::APERTURE_APEX).map(|stops| (stops / 2.0).exp2());
        let metadata = Self {
            exposure_s: shutter.or(of_apex).filter(|seconds| EXPOSURE_RANGE_S.contains(seconds)),
            f_number: f_number.or(f_of_apex.filter(|f_number| *f_number > 1.0 && F_NUMBER_RANGE.contains(f_number))),
            iso: number(tag::ISO).filter(|iso| ISO_RANGE.contains(iso) && *iso != ISO_DOES_NOT_FIT),
            focal_length_mm: number(tag::FOCAL_LENGTH).filter(|length| FOCAL_LENGTH_RANGE_MM.contains(length)),
            orientation: number(tag::ORIENTATION).filter(|turn| (1.0..=8.0).contains(turn)).map(|turn| turn as u8),
            taken: None,
            curve: StatedCurve::Unstated,
        };
        let mut text = |tag: u16| match find(tag) {
            Some(TagValue::Text(text)) => Some(text),
            _ => None,
        };
        let fraction = text(tag::TAKEN_FRACTION);
        let mut moment = |tag: u16| text(tag).and_then(|text| TakenAt::of_exif(&text, fraction.as_deref()));
        let taken = moment(tag::TAKEN).or_else(|| moment(tag::DIGITISED));
        Self { taken, ..metadata }
    }

    /// Of a block of EXIF, as PNG and JPEG hold it, and whether it says that the colours are sRGB. Damaged entries are
    /// passed over.
    pub(super) fn of_exif(block: Vec<u8>) -> (Self, bool) {
        let Some(exif) = tolerant(block) else { return (Self::default(), false) };
        let find = |tag: u16| value(&exif, tag);
        (Self::of_tags(find), matches!(find(tag::COLOUR_SPACE), Some(TagValue::Number(1.0))))
    }
}

fn tolerant(block: Vec<u8>) -> Option<Exif> {
    let read = Reader::new().continue_on_error(true).read_raw(block);
    read.or_else(|error: Error| error.distill_partial_result(|_| ())).ok()
}

fn value(exif: &Exif, tag: u16) -> Option<TagValue> {
    let context = if tag == tag::ORIENTATION { Context::Tiff } else { Context::Exif };
    let field = exif.get_field(Tag(context, tag), In::PRIMARY)?;
    match &field.value {
        Value::Rational(fractions) => Some(TagValue::Number(fractions.first()?.to_f64())),
        Value::SRational(fractions) => Some(TagValue::Number(fractions.first()?.to_f64())),
        Value::Ascii(texts) => Some(TagValue::Text(String::from_utf8_lossy(texts.first()?).into_owned())),
        other => other.get_uint(0).map(|number| TagValue::Number(f64::from(number))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(tags: &[(u16, f64)], texts: &[(u16, &str)]) -> Metadata {
        Metadata::of_tags(|tag| {
            let number = tags.iter().find(|(known, _)| *known == tag).map(|(_, number)| TagValue::Number(*number));
            let text = || texts.iter().find(|(known, _)| *known == tag).map(|(_, text)| TagValue::Text((*text).into()));
            number.or_else(text)
        })
    }

    #[test]
    fn what_a_camera_cannot_have_done_counts_as_not_stated() {
        let lies = [(tag::EXPOSURE_TIME, 0.0), (tag::F_NUMBER, f64::INFINITY), (tag::ISO, 65535.0)];
        let more = [(tag::FOCAL_LENGTH, f64::NAN), (tag::ORIENTATION, 0.0), (tag::APERTURE_APEX, 0.0)];
        let texts = [(tag::TAKEN, "0000:00:00 00:00:00"), (tag::DIGITISED, "yesterday")];
        assert_eq!(of(&[lies, more].concat(), &texts), Metadata::default());
    }

    #[test]
    fn an_exposure_is_read_from_the_apex_values_where_there_is_no_other() {
        let metadata = of(&[(tag::SHUTTER_SPEED_APEX, 6.0), (tag::APERTURE_APEX, 6.0), (tag::ISO, 200.0)], &[]);
        assert_eq!((metadata.exposure_s, metadata.f_number, metadata.iso), (Some(1.0 / 64.0), Some(8.0), Some(200.0)));
    }

    #[test]
    fn moments_sort_by_time_to_the_millisecond() {
        let at = |text: &str, fraction: &str| of(&[], &[(tag::TAKEN, text), (tag::TAKEN_FRACTION, fraction)]).taken;
        let (first, second) = (at("2026:05:31 14:02:59", "05"), at("2026:05:31 14:02:59", "250"));
        assert!(first < second && at("2026:05:31 14:03:00", "") > second);
        assert_eq!(first.map(|moment| moment.to_string()).as_deref(), Some("2026-05-31T14:02:59.050"));
    }
}
