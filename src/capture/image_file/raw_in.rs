//! Camera raw files, by the `rawler` crate: what the sensor counted, above its black level.
//!
//! No white balance and no colour matrix is applied, and no colour takes values from another's sites. Each channel is
//! averaged from its own sites around the middle of cells of the colour filter array, 2 x 2 sites (3 x 3 for a pattern of
//! 6 x 6), so the picture has half (a third) of the sensor's columns and rows. Full size would make up half of the pixels
//! or more; the sites of a cell as they lie would leave red and blue half a pixel apart, which reads as bounces at edges.

use firstbounce_core::Plane;
use rawler::CFA;
use rawler::decoders::{Decoder, RawDecodeParams};
use rawler::exif::Exif;
use rawler::formats::tiff::Rational;
use rawler::imgop::Rect;
use rawler::rawimage::{RawImage, RawPhotometricInterpretation};
use rawler::rawsource::RawSource;
use rayon::prelude::*;

use super::head::PictureSize;
use super::metadata::{TagValue, tag};
use super::raw::Facts;
use super::read::{Decoded, Source};
use super::{Channel, Format, ImageError, Metadata, StoredRange};

/// The numbers of red, green and blue in a pattern.
const COLOURS: [Channel; 3] = [Channel::R, Channel::G, Channel::B];

/// The size of the picture that [`read`] makes, and what the file says of itself.
pub(super) fn facts(source: &Source, bytes: &[u8]) -> Result<Facts, ImageError> {
    with_decoder(source, bytes, |decoder, file| {
        let params = RawDecodeParams::default();
        let failed = |error: rawler::RawlerError| source.damaged(Format::Raw, error);
        let image = decoder.raw_image(file, &params, true).map_err(failed)?;
        let area = area(source, &image)?;
        let cell = cell_sites(source, &image)?;
        let size = PictureSize { width: area.d.w / cell, height: area.d.h / cell, channels: channels(&image).len() };
        let exif = decoder.raw_metadata(file, &params).map_or_else(|_| Exif::default(), |metadata| metadata.exif);
        Ok(Facts::of(size, metadata_of(&exif)))
    })
}

pub(super) fn read(source: &Source, bytes: &[u8]) -> Result<Decoded, ImageError> {
    let image = with_decoder(source, bytes, |decoder, file| {
        let image = decoder.raw_image(file, &RawDecodeParams::default(), false);
        image.map_err(|error| source.damaged(Format::Raw, error))
    })?;
    let area = area(source, &image)?;
    let cell = cell_sites(source, &image)?;
    source.check_size(PictureSize { width: area.d.w, height: area.d.h, channels: image.cpp })?;
    let sensor = Sensor::of(source, &image)?;
    let names = channels(&image);
    let planes = names.iter().enumerate().map(|(index, &name)| (name, sensor.plane(index, &area, cell)));
    Ok(Decoded::of(planes.collect(), StoredRange { maximum: Some(sensor.maximum) }))
}

fn with_decoder<T>(
    source: &Source,
    bytes: &[u8],
    work: impl FnOnce(&dyn Decoder, &RawSource) -> Result<T, ImageError>,
) -> Result<T, ImageError> {
    source.guarded(Format::Raw, || {
        let file = RawSource::new_from_slice(bytes);
        let decoder = rawler::get_decoder(&file).map_err(|error| source.unsupported(Format::Raw, error))?;
        work(&*decoder, &file)
    })
}

/// Red, green and blue, or grey of a sensor without colour filters.
fn channels(image: &RawImage) -> &'static [Channel] {
    match image.photometric {
        RawPhotometricInterpretation::BlackIsZero => &[Channel::Grey],
        RawPhotometricInterpretation::LinearRaw if image.cpp < 3 => &[Channel::Grey],
        RawPhotometricInterpretation::LinearRaw | RawPhotometricInterpretation::Cfa(_) => &COLOURS,
    }
}

/// Columns and rows of a cell that makes one pixel.
fn cell_sites(source: &Source, image: &RawImage) -> Result<usize, ImageError> {
    match &image.photometric {
        RawPhotometricInterpretation::Cfa(filters) => match (filters.cfa.width, filters.cfa.height) {
            (2, 2) if filters.cfa.is_rgb() && image.cpp == 1 => Ok(2),
            (6, 6) if filters.cfa.is_rgb() && image.cpp == 1 => Ok(3),
            _ => Err(source.unsupported(Format::Raw, format_args!("the colour filters {}", filters.cfa))),
        },
        RawPhotometricInterpretation::BlackIsZero | RawPhotometricInterpretation::LinearRaw => Ok(1),
    }
}

/// The part of the sensor that sees light, as the maker recommends it.
fn area(source: &Source, image: &RawImage) -> Result<Rect, ImageError> {
    let whole = Rect::new(rawler::imgop::Point::new(0, 0), image.dim());
    let area = image.crop_area.or(image.active_area).unwrap_or(whole);
    let fits = area.p.x + area.d.w <= image.width && area.p.y + area.d.h <= image.height;
    if fits && area.d.w > 0 && area.d.h > 0 {
        Ok(area)
    } else {
        Err(source.damaged(Format::Raw, "its crop lies outside"))
    }
}

/// The sites of a sensor.
struct Sensor<'a> {
    counts: Vec<f32>,
    width: usize,
    /// Samples of a site.
    samples: usize,
    filters: Option<&'a CFA>,
    /// Of a period of sites, row by row.
    black: Vec<f32>,
    black_period: (usize, usize),
    white: f32,
    /// The largest value above black that every site reaches.
    maximum: f32,
}

impl<'a> Sensor<'a> {
    fn of(source: &Source, image: &'a RawImage) -> Result<Self, ImageError> {
        let counts = image.data.as_f32().into_owned();
        let levels = &image.blacklevel;
        let black = levels.as_vec();
        let whites = image.whitelevel.as_vec();
        let white = whites.iter().copied().fold(f32::INFINITY, f32::min);
        let maximum = white - black.iter().copied().fold(0.0, f32::max);
        let has_all = counts.len() == image.width * image.height * image.cpp
            && black.len() == levels.width * levels.height * levels.cpp
            && !black.is_empty();
        if !has_all || !maximum.is_finite() || maximum <= 0.0 {
            return Err(source.damaged(Format::Raw, "its pixels or levels are missing"));
        }
        let filters = match &image.photometric {
            RawPhotometricInterpretation::Cfa(filters) => Some(&filters.cfa),
            _ => None,
        };
        let black_period = (levels.width, levels.height);
        Ok(Self { counts, width: image.width, samples: image.cpp, filters, black, black_period, white, maximum })
    }

    /// The count of a site above its black, and whether it is at the white level.
    fn site(&self, x: usize, y: usize, sample: usize) -> (f32, bool) {
        let count = self.counts[(y * self.width + x) * self.samples + sample];
        let (columns, rows) = self.black_period;
        let samples = self.black.len() / (columns * rows);
        let black = self.black[((y % rows) * columns + x % columns) * samples + sample.min(samples - 1)];
        (count - black, count >= self.white)
    }

    /// One channel, a pixel for each cell of the area.
    fn plane(&self, channel: usize, area: &Rect, cell: usize) -> Plane {
        let (width, height) = (area.d.w / cell, area.d.h / cell);
        let pixel = |index: usize| {
            let (x, y) = (index % width, index / width);
            match self.filters {
                None => self.limited(self.site(area.p.x + x, area.p.y + y, channel)),
                Some(filters) => self.around(filters, channel, (x, y), area, cell),
            }
        };
        let values = (0..width * height).into_par_iter().map(pixel).collect();
        Plane::from_vec(width, height, values).unwrap_or_default()
    }

    /// The mean of a colour's sites around the middle of a cell, nearer ones counting more: linear interpolation.
    fn around(&self, filters: &CFA, colour: usize, (x, y): (usize, usize), area: &Rect, cell: usize) -> f32 {
        let reach = |index: usize, sites: usize| {
            (index * cell).saturating_sub(cell / 2)..((index + 1) * cell + cell / 2).min(sites)
        };
        let middle = |index: usize| (index * cell) as f32 + 0.5 * cell as f32;
        let weight = |site: usize, middle: f32| 1.0 - (site as f32 + 0.5 - middle).abs() / cell as f32;
        let (mut sum, mut weights, mut clipped) = (0.0, 0.0, false);
        for row in reach(y, area.d.h) {
            for column in reach(x, area.d.w) {
                let (site_x, site_y) = (area.p.x + column, area.p.y + row);
                if filters.color_at(site_y, site_x) == colour {
                    let weight = weight(row, middle(y)) * weight(column, middle(x));
                    let (count, is_clipped) = self.site(site_x, site_y, 0);
                    (sum, weights, clipped) = (sum + weight * count, weights + weight, clipped | is_clipped);
                }
            }
        }
        self.limited((sum / weights, clipped))
    }

    /// A pixel in which a site is clipped is clipped.
    fn limited(&self, (value, is_clipped): (f32, bool)) -> f32 {
        if is_clipped { value.max(self.maximum) } else { value.min(self.maximum.next_down()) }
    }
}

fn metadata_of(exif: &Exif) -> Metadata {
    let fraction = |value: &Option<Rational>| value.as_ref().map(|value| f64::from(value.n) / f64::from(value.d));
    let text = |value: &Option<String>| value.clone().map(TagValue::Text);
    Metadata::of_tags(|wanted| match wanted {
        tag::EXPOSURE_TIME => fraction(&exif.exposure_time).map(TagValue::Number),
        tag::F_NUMBER => fraction(&exif.fnumber).map(TagValue::Number),
        tag::FOCAL_LENGTH => fraction(&exif.focal_length).map(TagValue::Number),
        tag::ISO => {
            let iso = exif.iso_speed_ratings.map(u32::from).filter(|iso| *iso != u32::from(u16::MAX));
            iso.or(exif.iso_speed).or(exif.recommended_exposure_index).map(|iso| TagValue::Number(iso.into()))
        }
        tag::ORIENTATION => exif.orientation.map(|turn| TagValue::Number(turn.into())),
        tag::TAKEN => text(&exif.date_time_original),
        tag::DIGITISED => text(&exif.create_date),
        tag::TAKEN_FRACTION => text(&exif.sub_sec_time_original),
        _ => None,
    })
}
