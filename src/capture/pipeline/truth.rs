//! What a rendered set knows of its own surface and light.

use std::path::Path;

use firstbounce_core::mesh::{MeshOptions, from_depth};
use firstbounce_core::stereo::depth::DepthOptions;
use firstbounce_core::{Mask, Mesh, NormalMap, Plane};

use super::{MemoryOptions, PipelineError, Work, camera_of, check_memory};
use crate::image_file::{Content, ImageFile, ReadOptions, read_image_as};
use crate::open::read_text;
use crate::set::CaptureSet;

/// The true surface of a set: its true depth, where it also has a true normal, joined as the results are.
///
/// Where one part of the object hides another the true depth steps from pixel to pixel, and nothing was seen between: there
/// the surface is torn, and not joined by a wall that the object does not have. A step is what is steeper than the
/// integration of normals believes, so no result is torn by the same rule.
///
/// # Errors
/// `NoTruth` for a set without true depth and normals, `Memory` for one that takes more than is free; a file that cannot be read, or of another size; no triangle.
pub fn truth_mesh(set: &CaptureSet) -> Result<Mesh, PipelineError> {
    let path = set.truth_depth();
    if !path.is_file() {
        return Err(PipelineError::NoTruth { what: "depth", path });
    }
    check_memory(set, Work::Truth, &MemoryOptions::default())?;
    let depth = plane_of(read_truth(&path)?)?;
    let (width, height) = depth.size();
    let normals = true_normals(&set.truth_normals(), depth.size())?;
    let known = Mask::from_fn(width, height, |x, y| normals.at(x, y).is_some());
    let camera = camera_of(set, depth.size());
    let options = MeshOptions { max_slope: Some(DepthOptions::default().max_slope) };
    Ok(from_depth(&depth, &known, &camera, Some(&normals), None, &options)?.0)
}

/// The light of a white facet that faces the first lamp, as a rendered set was made with; `None` where nothing tells.
pub(super) fn true_white_light(set: &CaptureSet) -> Option<f64> {
    let text = read_text(&set.truth_normals().with_file_name("rig.json")).ok()?;
    let rig: serde_json::Value = serde_json::from_str(&text).ok()?;
    rig.get("radiance_to_linear")?.as_f64().filter(|light| *light > 0.0)
}

/// True normals of pictures of this size.
pub(super) fn true_normals(path: &Path, size: (usize, usize)) -> Result<NormalMap, PipelineError> {
    if !path.is_file() {
        return Err(PipelineError::NoTruth { what: "normals", path: path.to_owned() });
    }
    let image = sized(read_truth(path)?, size)?;
    let planes = image.channels.into_iter().map(|(_, plane)| plane).collect::<Vec<_>>();
    let map = <[Plane; 3]>::try_from(planes).ok().and_then(|[x, y, z]| NormalMap::from_planes(x, y, z));
    map.ok_or_else(|| PipelineError::TruthChannels { path: path.to_owned() })
}

/// True depth, or light of a bounce, of pictures of this size.
pub(super) fn true_plane(path: &Path, size: (usize, usize)) -> Result<Plane, PipelineError> {
    plane_of(sized(read_truth(path)?, size)?)
}

fn plane_of(image: ImageFile) -> Result<Plane, PipelineError> {
    let ImageFile { path, channels, .. } = image;
    channels.into_iter().next().map(|(_, plane)| plane).ok_or(PipelineError::TruthChannels { path })
}

fn sized(image: ImageFile, expected: (usize, usize)) -> Result<ImageFile, PipelineError> {
    let found = image.size();
    if found == expected { Ok(image) } else { Err(PipelineError::PhotoSize { path: image.path, found, expected }) }
}

fn read_truth(path: &Path) -> Result<ImageFile, PipelineError> {
    Ok(read_image_as(path, &ReadOptions { content: Content::Data, ..ReadOptions::default() })?)
}
