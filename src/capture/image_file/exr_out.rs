//! Planes to OpenEXR, 32-bit float, compressed without loss.

use std::collections::HashSet;
use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};
use std::path::Path;

use exr::block::lines::LineRefMut;
use exr::error::Error as ExrError;
use exr::image::write::samples::{SamplesWriter, WritableSamples};
use exr::math::RoundingMode;
use exr::meta::attribute::{LevelMode, SampleType};
use exr::meta::header::Header;
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, Image, ImageAttributes, IntegerBounds, Layer, LayerAttributes, Vec2,
    WritableImage,
};
use firstbounce_core::Plane;

use super::ImageError;

/// One layer to be written: its channels are all of one size.
#[derive(Clone, Debug)]
pub struct ExrLayer<'a> {
    /// Not empty, and of this layer only.
    pub name: &'a str,
    /// "Y" for grey; "R", "G" and "B" for colours or for x, y and z. Each name once.
    pub channels: Vec<(&'a str, &'a Plane)>,
}

/// Writes layers of one size into the file `path`: 32-bit float, ZIP, so that reading returns equal values.
///
/// # Errors
/// [`ImageError::UnequalPlanes`] for layers that make no picture, [`ImageError::Unwritable`] with the system's reason.
pub fn write_exr(path: &Path, layers: &[ExrLayer]) -> Result<(), ImageError> {
    let unwritable = |error: io::Error| ImageError::Unwritable { path: path.to_path_buf(), reason: error.to_string() };
    let size = common_size(layers)?;
    let mut out = BufWriter::new(File::create(path).map_err(unwritable)?);
    encode(&mut out, size, layers).map_err(unwritable)?;
    out.flush().map_err(unwritable)
}

fn common_size(layers: &[ExrLayer]) -> Result<(usize, usize), ImageError> {
    let unequal = |what: &str| ImageError::UnequalPlanes { what: format!("layer \"{what}\"") };
    let first = layers.first().and_then(|layer| layer.channels.first()).ok_or_else(|| unequal(""))?.1.size();
    let mut layer_names = HashSet::new();
    for layer in layers {
        let mut channel_names = HashSet::new();
        let sound = layer.channels.iter().all(|(name, plane)| {
            !name.is_empty() && channel_names.insert(name) && plane.size() == first && !plane.data().is_empty()
        });
        if !sound || layer.channels.is_empty() || layer.name.is_empty() || !layer_names.insert(layer.name) {
            return Err(unequal(layer.name));
        }
    }
    Ok(first)
}

fn encode(out: impl Write + Seek, (width, height): (usize, usize), layers: &[ExrLayer]) -> io::Result<()> {
    let size = Vec2(width, height);
    let layers = layers.iter().map(|layer| {
        let channels = layer.channels.iter().map(|&(name, plane)| AnyChannel::new(name, Borrowed(plane))).collect();
        let attributes = LayerAttributes::named(layer.name);
        Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels))
    });
    let attributes = ImageAttributes::new(IntegerBounds::from_dimensions(size));
    let image = Image::from_layers(attributes, layers.collect::<Vec<_>>());
    image.write().to_buffered(out).map_err(|error| match error {
        ExrError::Io(error) => error,
        other => io::Error::other(other.to_string()),
    })
}

/// Lets the encoder take rows from a plane without a copy of it.
struct Borrowed<'a>(&'a Plane);

impl<'rows> WritableSamples<'rows> for Borrowed<'_> {
    type Writer = Rows<'rows>;

    fn sample_type(&self) -> SampleType {
        SampleType::F32
    }

    fn infer_level_modes(&self) -> (LevelMode, RoundingMode) {
        (LevelMode::Singular, RoundingMode::Down)
    }

    fn create_samples_writer(&'rows self, _header: &Header) -> Rows<'rows> {
        Rows(self.0)
    }
}

struct Rows<'a>(&'a Plane);

impl SamplesWriter for Rows<'_> {
    fn extract_line(&self, line: LineRefMut<'_>) {
        let start = line.location.position.x();
        let row = &self.0.row(line.location.position.y())[start..start + line.location.sample_count];
        // The line is as long as the row piece, which is all that this can fail for.
        let written = line.write_samples_from_slice(row);
        debug_assert!(written.is_ok());
    }
}
