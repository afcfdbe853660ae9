//! OpenEXR, by the `exr` crate. Layers are the parts of a file, or prefixes of channel names ("diffuse.R"), or both.

use std::io::{Cursor, Read};
use std::path::Path;

use exr::error::Error as ExrError;
use exr::image::FlatSamples;
use exr::meta::header::Header;
use exr::prelude::{MetaData, ReadChannels, ReadLayers, read as reader};
use firstbounce_core::Plane;
use rayon::prelude::*;

use super::head::{Head, PictureSize};
use super::read::{Decoded, Source};
use super::{Channel, Format, ImageError, StoredRange};

/// The names of the layers of an EXR, in the order of the file; a layer without a name is "".
///
/// # Errors
/// As [`read_image`](super::read_image), and [`ImageError::Unsupported`] for a file of another format.
pub fn layer_names(path: &Path) -> Result<Vec<String>, ImageError> {
    let mut head = Head::open(path)?;
    let bytes = head.bytes()?;
    let Head { source, format, .. } = head;
    match format {
        Format::Exr => source.guarded(Format::Exr, || {
            Ok(layers(&headers(&source, bytes.as_slice())?).into_iter().map(|l| l.name).collect())
        }),
        other => Err(source.unsupported(other, "no layers")),
    }
}

/// A layer, and where its channels lie in the file.
struct Layer {
    name: String,
    part: usize,
    /// Name without the layer's prefix, and index in the part.
    channels: Vec<(String, usize)>,
}

/// The pixels of all layers are decoded together.
pub(super) fn size(source: &Source, file: impl Read) -> Result<PictureSize, ImageError> {
    let mut samples = 0_usize;
    let mut size = PictureSize { width: 0, height: 0, channels: 0 };
    for header in headers(source, file)? {
        let (width, height) = (header.layer_size.width(), header.layer_size.height());
        samples = samples.saturating_add(width.saturating_mul(height).saturating_mul(header.channels.list.len()));
        if width.saturating_mul(height) > size.width.saturating_mul(size.height) {
            (size.width, size.height) = (width, height);
        }
    }
    size.channels = samples.div_ceil(size.width.saturating_mul(size.height).max(1));
    Ok(size)
}

pub(super) fn read(source: &Source, bytes: &[u8], wanted: Option<&str>) -> Result<Decoded, ImageError> {
    let headers = headers(source, bytes)?;
    let layers = layers(&headers);
    let layer = choose(source, &layers, wanted)?;
    let picked = pick_channels(source, layer)?;
    let header = &headers[layer.part];
    if header.shared_attributes.display_window != header.data_window() {
        return Err(source.unsupported(Format::Exr, "a data window that is not its display window"));
    }

    let image = reader()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(|error| failed(source, error))?;
    let missing = || source.damaged(Format::Exr, "a channel of its header is missing");
    let part = image.layer_data.into_iter().nth(layer.part).ok_or_else(missing)?;
    let mut stored = part.channel_data.list.into_iter().map(|channel| Some(channel.sample_data)).collect::<Vec<_>>();
    let channels = picked.into_iter().map(|(name, index)| {
        let samples = stored.get_mut(index).and_then(Option::take).ok_or_else(missing)?;
        let plane = Plane::from_vec(part.size.width(), part.size.height(), floats(samples)).ok_or_else(missing)?;
        Ok((name, plane))
    });
    Ok(Decoded { channels: channels.collect::<Result<_, ImageError>>()?, stored: StoredRange { maximum: None } })
}

fn floats(samples: FlatSamples) -> Vec<f32> {
    match samples {
        FlatSamples::F32(values) => values,
        FlatSamples::F16(values) => values.into_par_iter().map(|value| value.to_f32()).collect(),
        FlatSamples::U32(values) => values.into_par_iter().map(|value| value as f32).collect(),
    }
}

fn failed(source: &Source, error: ExrError) -> ImageError {
    match error {
        ExrError::NotSupported(what) => source.unsupported(Format::Exr, what),
        error => source.damaged(Format::Exr, error),
    }
}

fn headers(source: &Source, file: impl Read) -> Result<Vec<Header>, ImageError> {
    let meta = MetaData::read_from_buffered(file, false).map_err(|error| failed(source, error))?;
    for header in &meta.headers {
        if header.deep {
            return Err(source.unsupported(Format::Exr, "deep pixels"));
        }
        if header.channels.list.iter().any(|channel| channel.sampling.0 != 1 || channel.sampling.1 != 1) {
            return Err(source.unsupported(Format::Exr, "channels of half the size"));
        }
    }
    Ok(meta.headers.into_vec())
}

fn layers(headers: &[Header]) -> Vec<Layer> {
    let mut layers: Vec<Layer> = Vec::new();
    for (part, header) in headers.iter().enumerate() {
        let part_name = header.own_attributes.layer_name.as_ref().map_or(String::new(), ToString::to_string);
        for (index, channel) in header.channels.list.iter().enumerate() {
            let full = channel.name.to_string();
            let (prefix, name) = full.rsplit_once('.').unwrap_or(("", &full));
            let layer_name = match (part_name.as_str(), prefix) {
                (part_name, "") => part_name.to_string(),
                ("", prefix) => prefix.to_string(),
                (part_name, prefix) if part_name == prefix => prefix.to_string(),
                (part_name, prefix) => format!("{part_name}.{prefix}"),
            };
            match layers.iter_mut().find(|layer| layer.part == part && layer.name == layer_name) {
                Some(layer) => layer.channels.push((name.to_string(), index)),
                None => layers.push(Layer { name: layer_name, part, channels: vec![(name.to_string(), index)] }),
            }
        }
    }
    layers
}

fn choose<'a>(source: &Source, layers: &'a [Layer], wanted: Option<&str>) -> Result<&'a Layer, ImageError> {
    let chosen = match (wanted, layers) {
        (None, [only]) => Some(only),
        (None, _) => None,
        (Some(name), _) => layers.iter().find(|layer| layer.name == name),
    };
    chosen.ok_or_else(|| ImageError::NoLayer {
        path: source.path.to_path_buf(),
        wanted: wanted.map(str::to_string),
        present: layers.iter().map(|layer| format!("\"{}\"", layer.name)).collect(),
    })
}

/// Red, green and blue (or x, y and z of a vector), else luminance, else the only channel that is not alpha.
fn pick_channels(source: &Source, layer: &Layer) -> Result<Vec<(Channel, usize)>, ImageError> {
    let find =
        |wanted: &str| layer.channels.iter().find(|(name, _)| name.eq_ignore_ascii_case(wanted)).map(|found| found.1);
    for names in [["R", "G", "B"], ["X", "Y", "Z"]] {
        if let [Some(red), Some(green), Some(blue)] = names.map(find) {
            return Ok(vec![(Channel::R, red), (Channel::G, green), (Channel::B, blue)]);
        }
    }
    let others: Vec<_> = layer.channels.iter().filter(|(name, _)| !name.eq_ignore_ascii_case("A")).collect();
    match (find("Y"), others.as_slice()) {
        (Some(luminance), _) if find("X").is_none() => Ok(vec![(Channel::Grey, luminance)]),
        (_, [(_, only)]) => Ok(vec![(Channel::Grey, *only)]),
        _ => {
            let names = layer.channels.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(", ");
            Err(source.unsupported(Format::Exr, format_args!("neither R, G, B nor Y nor one channel, but {names}")))
        }
    }
}
