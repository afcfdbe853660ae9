//! What files say of themselves, by subject and kind, and photos that clip.

use std::collections::BTreeMap;

use super::{CaptureWarning, CheckOptions, FilesOf, Seen};
use crate::image_file::ImageWarning;
use crate::pipeline::photos::{by_kind, image_warnings};
use crate::set::CaptureSet;

/// Warns of what files say of themselves: levels, curves, exposures, values that no light has.
pub(super) fn files(set: &CaptureSet, seen: &BTreeMap<usize, Seen>) -> Vec<CaptureWarning> {
    let of_subject = |subject| {
        // Photos of one subject are compared with each other; its balls may need another exposure.
        let of_it = seen.iter().map(|(shot, seen)| (&set.shots[*shot], &seen.notes));
        let shots: Vec<_> = of_it.filter(|(shot, _)| shot.subject == subject).collect();
        by_kind(image_warnings(&shots)).map(|warnings| {
            let files = FilesOf::of_paths(set, warnings.iter().map(ImageWarning::path));
            CaptureWarning::Files { warnings, files }
        })
    };
    set.subjects().into_iter().flat_map(of_subject).collect()
}

/// Warns of photos in which much of the object is clipped.
pub(super) fn clipped(
    set: &CaptureSet,
    options: &CheckOptions,
    seen: &BTreeMap<usize, Seen>,
) -> Option<CaptureWarning> {
    let mut clipped: Vec<&Seen> = seen.values().filter(|seen| seen.clipped > options.max_clipped_share).collect();
    clipped.sort_by(|one, other| other.clipped.total_cmp(&one.clipped));
    let share = clipped.first()?.clipped;
    let files = FilesOf::of(set, clipped.iter().flat_map(|seen| &seen.files))?;
    Some(CaptureWarning::Clipped { files, share })
}
