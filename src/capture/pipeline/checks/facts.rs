//! What single files show: where their values end, a white level that they cannot reach, repeats that differ.

use std::collections::BTreeMap;

use indexmap::IndexMap;

use super::{CaptureWarning, CheckOptions, FilesOf, Seen, written};
use crate::image_file::FileFacts;
use crate::set::CaptureSet;

/// Warns of files whose values end, or cannot reach where they should, and of repeats that differ.
pub(super) fn facts(set: &CaptureSet, options: &CheckOptions, seen: &BTreeMap<usize, Seen>) -> Vec<CaptureWarning> {
    let files = || seen.values().flat_map(|seen| &seen.files);
    let ends = files().filter_map(|file| Some((file, unmarked_end(file)?)));
    // One end for each value: the files of a camera share theirs.
    let mut by_value: IndexMap<u32, Vec<(&FileFacts, f64)>> = IndexMap::new();
    for (file, (value, share)) in ends {
        by_value.entry(value.to_bits()).or_default().push((file, share));
    }
    let of_ends = by_value.into_iter().filter_map(|(value, mut files)| {
        files.sort_by(|one, other| other.1.total_cmp(&one.1));
        let share = files.first()?.1;
        let files = FilesOf::of(set, files.iter().map(|(file, _)| *file))?;
        let white_level = set.camera.white_level;
        Some(CaptureWarning::ValuesEnd { files, value: f32::from_bits(value), share, white_level })
    });
    let beyond = |file: &&FileFacts| file.maximum.zip(file.clips_at).is_some_and(|(maximum, clips)| clips > maximum);
    let mut by_maximum: IndexMap<u32, Vec<&FileFacts>> = IndexMap::new();
    for file in files().filter(beyond) {
        by_maximum.entry(file.maximum.unwrap_or_default().to_bits()).or_default().push(file);
    }
    let of_maxima = by_maximum.into_iter().filter_map(|(maximum, files)| {
        let white_level = set.camera.white_level?;
        let files = FilesOf::of(set, files.into_iter())?;
        Some(CaptureWarning::WhiteLevelOutOfReach { files, white_level, maximum: f32::from_bits(maximum) })
    });
    let of_repeats = seen.values().filter_map(|seen| {
        let largest = |files: &[FileFacts]| {
            let changes = files.iter().enumerate().filter_map(|(index, file)| Some((index, file.change?)));
            changes.max_by(|(_, a), (_, b)| a.total_cmp(b))
        };
        let (index, change) = largest(&seen.files).filter(|(_, change)| *change > options.max_repeat_change)?;
        let before = seen.files[..index].iter().map(|file| written(set, &file.path)).collect();
        Some(CaptureWarning::RepeatsDiffer { file: written(set, &seen.files[index].path), before, change })
    });
    // The three colours of an RGB photo are one file.
    let mut warnings: Vec<CaptureWarning> = of_ends.chain(of_maxima).chain(of_repeats).collect();
    let mut repeats = Vec::new();
    warnings.retain(|warning| match warning {
        CaptureWarning::RepeatsDiffer { file, .. } if repeats.contains(file) => false,
        CaptureWarning::RepeatsDiffer { file, .. } => {
            repeats.push(file.clone());
            true
        }
        _ => true,
    });
    warnings
}

/// Where a file's values end though none of its pixels counts as clipped there, and the share of pixels that do.
fn unmarked_end(file: &FileFacts) -> Option<(f32, f64)> {
    let end = file.end.filter(|end| file.clips_at.is_none_or(|clips_at| end.value < clips_at))?;
    Some((end.value, end.share))
}
