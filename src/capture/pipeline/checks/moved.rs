//! Photos of the object that lie beside the others: a bumped camera, a nudged object.

use std::collections::BTreeMap;

use firstbounce_core::Watch;
use firstbounce_core::capture_checks::find_moved;

use super::{CaptureWarning, CheckOptions, FilesOf, Seen};
use crate::image_file::FileFacts;
use crate::set::CaptureSet;

/// Warns of each lamp whose photos, or some of them, moved.
pub(super) fn moved(
    set: &CaptureSet,
    options: &CheckOptions,
    mut seen: BTreeMap<usize, Seen>,
    watch: &dyn Watch,
) -> Vec<CaptureWarning> {
    let spectra: Vec<_> = seen.values_mut().map(|seen| seen.edges.take()).collect();
    let of_object: Vec<_> = seen.iter().zip(spectra).filter(|(_, edges)| edges.is_some()).collect();
    let (photos, spectra): (Vec<_>, Vec<_>) = of_object.into_iter().unzip();
    // The options were checked when the check began.
    let moved = find_moved(&spectra, &options.shift, watch).unwrap_or_default();
    let light_of = |photo: usize| set.shots[*photos[photo].0].light.as_deref().unwrap_or_default();
    let under = |light: &str| {
        let of_light: Vec<_> = moved.iter().filter(|moved| light_of(moved.photo) == light).collect();
        let furthest = of_light.iter().max_by(|a, b| length(a.shift_px).total_cmp(&length(b.shift_px))).copied()?;
        let files: Vec<&FileFacts> = of_light.iter().flat_map(|moved| &photos[moved.photo].1.files).collect();
        let files = FilesOf::of(set, files.into_iter())?;
        Some(CaptureWarning::Moved { light: light.to_owned(), files, shift_px: furthest.shift_px })
    };
    set.lights.iter().filter_map(|light| under(&light.name)).collect()
}

fn length([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}
