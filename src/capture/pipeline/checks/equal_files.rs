//! Files of equal content where two photos should be: one photo under two lamps, a photo copied under another name.

use std::hash::Hash;

use indexmap::IndexMap;
use rayon::prelude::*;

use super::CaptureWarning;
use crate::open::{hash_file, hash_samples};
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

/// A name for the content of each file of the set. Only files of one length are looked at, and only those that agree in samples of
/// their content are read whole: the report hashes all of them once more.
fn contents(set: &CaptureSet) -> IndexMap<String, Option<String>> {
    let files: Vec<&str> = set.distinct_files().into_keys().collect();
    let all = files.iter().map(|file| (*file, set.resolve(file)));
    let all = all.filter_map(|(file, path)| Some((file, path.metadata().ok()?.len())));
    let of_one_length = shared(all.collect());
    let sampled = of_one_length.par_iter().filter_map(|file| Some((*file, hash_samples(&set.resolve(file)).ok()?)));
    let alike = shared(sampled.collect());
    let hashed = alike.par_iter().filter_map(|file| Some((*file, hash_file(&set.resolve(file)).ok()?.0)));
    let mut hashed: IndexMap<&str, String> = hashed.collect::<Vec<_>>().into_iter().collect();
    files.into_iter().map(|file| (file.to_owned(), hashed.swap_remove(file))).collect()
}

/// The files that have something in common with another.
fn shared<K: Eq + Hash>(files: Vec<(&str, K)>) -> Vec<&str> {
    let mut by_key: IndexMap<K, Vec<&str>> = IndexMap::new();
    files.into_iter().for_each(|(file, key)| by_key.entry(key).or_default().push(file));
    by_key.into_values().filter(|files| files.len() > 1).flatten().collect()
}
