//! Files of equal content where two photos should be: one photo under two lamps, a photo copied under another name.

use indexmap::IndexMap;
use rayon::prelude::*;

use super::CaptureWarning;
use crate::open::hash_file;
use crate::set::{CaptureSet, Shot, Subject};

/// A file that a shot names.
#[derive(Clone, Copy)]
struct Use<'a> {
    shot: &'a Shot,
    file: &'a str,
}

/// Warns of photos that are one and the same file, or copies of it.
pub(super) fn equal_files(set: &CaptureSet) -> Vec<CaptureWarning> {
    let uses: Vec<Use> =
        set.shots.iter().flat_map(|shot| shot.files.iter().map(move |file| Use { shot, file })).collect();
    let mut by_content: IndexMap<String, Vec<Use>> = IndexMap::new();
    let contents = contents(set);
    for one in uses {
        // A file that cannot be read equals itself alone.
        let content = contents.get(one.file).cloned().flatten().unwrap_or_else(|| one.file.to_owned());
        by_content.entry(content).or_default().push(one);
    }
    let conflict = |uses: &Vec<Use>| {
        let pairs = (0..uses.len()).flat_map(|a| (a + 1..uses.len()).map(move |b| (a, b)));
        let (a, b) = pairs.into_iter().find(|(a, b)| contradict(set, uses[*a], uses[*b]))?;
        let in_conflict = uses.iter().filter(|one| {
            [a, b].iter().any(|of| std::ptr::eq(uses[*of].shot, one.shot) && uses[*of].file == one.file)
                || contradict(set, uses[a], **one)
        });
        let (mut files, mut shots) = (Vec::new(), Vec::new());
        for one in in_conflict {
            if !files.contains(&one.file.to_owned()) {
                files.push(one.file.to_owned());
            }
            let shot = one.shot.described();
            if !shots.contains(&shot) {
                shots.push(shot);
            }
        }
        Some(CaptureWarning::EqualFiles { files, shots })
    };
    by_content.values().filter_map(conflict).collect()
}

/// Whether two uses of one content cannot both be meant.
fn contradict(set: &CaptureSet, one: Use, other: Use) -> bool {
    let (a, b) = (one.shot, other.shot);
    if std::ptr::eq(a, b) {
        return true;
    }
    let same_name = one.file == other.file;
    let lights_differ = a.light.is_some() && b.light.is_some() && a.light != b.light;
    let is_frame = |shot: &Shot| matches!(shot.subject, Subject::Dark | Subject::FlatField);
    if a.subject != b.subject {
        // Balls that stand beside the object are seen in its photos.
        return lights_differ || !same_name;
    }
    // Each of these is under one lamp colour alone.
    let is_crosstalk = a.subject == Subject::Crosstalk;
    let one_of_three_channels = !is_crosstalk && a.colour != b.colour && set.channel_of(a) != set.channel_of(b);
    let needs_no_colour = is_frame(a) || a.subject.is_shiny_ball();
    lights_differ && !is_frame(a) || !(one_of_three_channels || needs_no_colour)
}

/// A name for the content of each file of the set; files that cannot be equal go unread.
fn contents(set: &CaptureSet) -> IndexMap<String, Option<String>> {
    let files: Vec<&str> = set.distinct_files().into_keys().collect();
    let lengths: Vec<Option<u64>> = files.iter().map(|file| Some(set.resolve(file).metadata().ok()?.len())).collect();
    let mut of_length: IndexMap<u64, usize> = IndexMap::new();
    lengths.iter().flatten().for_each(|length| *of_length.entry(*length).or_default() += 1);
    let is_alone = |length: &Option<u64>| length.is_none_or(|length| of_length.get(&length).is_none_or(|n| *n < 2));
    let named = files.par_iter().zip(&lengths).map(|(file, length)| {
        let content =
            if is_alone(length) { None } else { hash_file(&set.resolve(file)).ok().map(|(sha256, _)| sha256) };
        ((*file).to_owned(), content)
    });
    named.collect::<Vec<_>>().into_iter().collect()
}
