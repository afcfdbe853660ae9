//! OpenEXR, by the `exr` crate. Layers are the parts of a file, or prefixes of channel names ("diffuse.R"), or both.

use std::io::{Cursor, Read};
use std::path::Path;

use exr::error::Error as ExrError;
use exr::meta::header::Header;
use exr::prelude::{MetaData, Vec2};

use super::exr_blocks::{Exr, is_bounded};
use super::head::{Opened, PictureSize, Stated};
use super::read::{Decoded, Source};
use super::{Channel, Format, ImageError, StoredRange};

/// The most channels of a file: renderers write some hundred.
const MAX_CHANNELS: usize = 4096;
/// The longest name of a layer, as of a channel.
const MAX_NAME_BYTES: usize = 255;
/// The most names of layers that an error lists.
const MAX_NAMES: usize = 20;

/// The names of the layers of an EXR, in the order of the file; a layer without a name is "".
///
/// # Errors
/// As [`read_image`](super::read_image), and [`ImageError::Unsupported`] for a file of another format.
pub fn layer_names(path: &Path) -> Result<Vec<String>, ImageError> {
    let mut opened = Opened::open(path)?;
    let source = opened.source;
    if opened.format != Format::Exr {
        return Err(source.unsupported(opened.format, "no layers"));
    }
    let meta = meta_data(&source, opened.head()?)?;
    Ok(layers(&meta.headers).into_iter().map(|layer| layer.name).collect())
}

/// A layer, and where its channels lie in the file.
struct Layer {
    name: String,
    part: usize,
    /// Whether its channels have no prefix.
    is_plain: bool,
    /// Name without the layer's prefix, and index in the part.
    channels: Vec<(String, usize)>,
}

/// The largest of its layers, which have three channels unless one alone has fewer.
pub(super) fn stated(source: &Source, file: impl Read) -> Result<Stated, ImageError> {
    let meta = meta_data(source, file)?;
    let layers = layers(&meta.headers);
    let channels = match layers.as_slice() {
        [only] => pick_channels(source, only)?.len(),
        _ => 3,
    };
    let sizes = meta.headers.iter().map(|header| header.layer_size);
    let Vec2(width, height) = sizes.max_by_key(|size| size.0.saturating_mul(size.1)).unwrap_or(Vec2(0, 0));
    let bounded = meta.headers.iter().all(|header| is_bounded(header.compression));
    Ok(Stated { size: PictureSize { width, height, channels }, bounded })
}

pub(super) fn read(source: &Source, bytes: &[u8], wanted: Option<&str>) -> Result<Decoded, ImageError> {
    let mut file = Cursor::new(bytes);
    let meta = meta_data(source, &mut file)?;
    let layers = layers(&meta.headers);
    let layer = choose(source, &layers, wanted)?;
    let picked = pick_channels(source, layer)?;
    let header = &meta.headers[layer.part];
    if header.shared_attributes.display_window != header.data_window() {
        return Err(source.unsupported(Format::Exr, "a data window that is not its display window"));
    }
    let (names, indices): (Vec<_>, Vec<_>) = picked.into_iter().unzip();
    let exr = Exr { source, bytes, meta: &meta, tables: file.position() as usize };
    let planes = exr.planes(layer.part, &indices)?;
    Ok(Decoded::of(names.into_iter().zip(planes).collect(), StoredRange { maximum: None }))
}

pub(super) fn failed(source: &Source, error: ExrError) -> ImageError {
    match error {
        ExrError::NotSupported(what) => source.unsupported(Format::Exr, what),
        error => source.damaged(Format::Exr, error),
    }
}

fn meta_data(source: &Source, file: impl Read) -> Result<MetaData, ImageError> {
    let meta = source
        .guarded(Format::Exr, || MetaData::read_from_buffered(file, false).map_err(|error| failed(source, error)))?;
    if meta.headers.iter().map(|header| header.channels.list.len()).sum::<usize>() > MAX_CHANNELS {
        return Err(source.unsupported(Format::Exr, format_args!("more than {MAX_CHANNELS} channels")));
    }
    for header in &meta.headers {
        if header.own_attributes.layer_name.as_ref().is_some_and(|name| name.as_slice().len() > MAX_NAME_BYTES) {
            return Err(source.unsupported(Format::Exr, "a layer of a very long name"));
        }
        if header.deep {
            return Err(source.unsupported(Format::Exr, "deep pixels"));
        }
        if header.channels.list.iter().any(|channel| channel.sampling.0 != 1 || channel.sampling.1 != 1) {
            return Err(source.unsupported(Format::Exr, "channels of half the size"));
        }
    }
    Ok(meta)
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
                None => {
                    let channels = vec![(name.to_string(), index)];
                    layers.push(Layer { name: layer_name, part, is_plain: prefix.is_empty(), channels });
                }
            }
        }
    }
    layers
}

fn choose<'a>(source: &Source, layers: &'a [Layer], wanted: Option<&str>) -> Result<&'a Layer, ImageError> {
    let chosen = match (wanted, layers) {
        (None, [only]) => Some(only),
        (None, _) => plain_layer(layers),
        (Some(name), _) => layers.iter().find(|layer| layer.name == name),
    };
    chosen.ok_or_else(|| ImageError::NoLayer {
        path: source.path.to_path_buf(),
        wanted: wanted.map(str::to_string),
        present: layers.iter().take(MAX_NAMES).map(|layer| format!("{:?}", layer.name)).collect(),
    })
}

/// Of several layers the picture whose channels have no prefix, which every viewer shows; else the only picture.
fn plain_layer(layers: &[Layer]) -> Option<&Layer> {
    let has = |layer: &Layer, wanted: &str| layer.channels.iter().any(|(name, _)| name.eq_ignore_ascii_case(wanted));
    let is_picture =
        |layer: &&Layer| ["R", "G", "B"].iter().all(|name| has(layer, name)) || (has(layer, "Y") && !has(layer, "X"));
    let pictures: Vec<&Layer> = layers.iter().filter(is_picture).collect();
    let plain: Vec<&Layer> = pictures.iter().copied().filter(|layer| layer.is_plain).collect();
    match (plain.as_slice(), pictures.as_slice()) {
        ([only], _) | (_, [only]) => Some(only),
        _ => plain.into_iter().find(|layer| layer.name.is_empty()),
    }
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
