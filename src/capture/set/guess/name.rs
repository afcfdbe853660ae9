//! The names of some files, and what words in them say whatever the pattern.

use std::path::Path;

use super::super::subject::Subject;
use super::exposure::{exposure_in, pairs_are_exposures};
use super::pattern::{Guess, Pattern, parts};
use super::words::{Named, SEPARATORS, subject_of_word, subject_within, without};

/// The name of a file.
pub(super) struct Name {
    /// Folders and the name without its extension, without an exposure.
    parts: Vec<String>,
    /// The same without words for a subject.
    rest: Vec<String>,
    /// The subject that words in the name mean, or in that of its nearest folder that has any.
    pub named: Named,
    /// The exposure that the name states.
    pub exposure: Option<String>,
    /// Whether it is a dark frame or flat field that follows no pattern.
    pub correction: Option<Subject>,
}

/// The names of files that belong together. Only their own folders are looked at, not those in which all of them lie.
pub(super) fn names_of<P: AsRef<Path>>(files: &[P]) -> Vec<Option<Name>> {
    let parts: Vec<_> = files.iter().map(|file| parts(file.as_ref())).collect();
    let pairs = pairs_are_exposures(parts.iter().flatten().filter_map(|parts| parts.last()).map(String::as_str));
    // The folder in which all lie counts: it may be that of the grey ball alone.
    let common = common_folders(&parts.iter().flatten().collect::<Vec<_>>());
    parts.into_iter().map(|parts| Some(Name::of(parts?, common, pairs))).collect()
}

/// How many folders all paths have in common.
fn common_folders(paths: &[&Vec<String>]) -> usize {
    let Some((first, others)) = paths.split_first() else { return 0 };
    let folders = first.len().saturating_sub(1);
    let shared = |other: &&Vec<String>| {
        let folders = &other[..other.len().saturating_sub(1)];
        first.iter().zip(folders).take_while(|(one, other)| one == other).count()
    };
    others.iter().map(shared).fold(folders, usize::min)
}

impl Name {
    fn of(mut parts: Vec<String>, common: usize, pairs: bool) -> Self {
        let correction = correction_of(&parts);
        let mut exposure = None;
        if let Some(stem) = parts.last_mut()
            && let Some((written, rest)) = exposure_in(stem, pairs)
        {
            exposure = Some(written);
            *stem = rest;
        }
        let from = common.saturating_sub(1);
        let mut rest = parts[..from].to_vec();
        let mut named = Named::Nothing;
        for (index, part) in parts.iter().enumerate().skip(from) {
            let (found, place) = subject_within(part);
            // A folder above all files that speaks of a ball says nothing of its kind: the object may be a ball.
            let says_nothing = found == Named::Nothing || (found == Named::SomeBall && index < common);
            let left = if says_nothing { part.clone() } else { without(part, &place) };
            if !left.is_empty() {
                rest.push(left);
            }
            named = match (named, found) {
                (named, _) if says_nothing => named,
                // "grey/ball_left_blue.png"
                (Named::Subject(ball), Named::SomeBall) if ball.sphere_kind().is_some() => Named::Subject(ball),
                (_, found) => found,
            };
        }
        Self { parts, rest, named, exposure, correction }
    }

    /// What the name says by a pattern, with a word for a colour in its place; by its words where the pattern has no
    /// subject.
    pub fn read_strictly(&self, pattern: &Pattern) -> Option<Guess> {
        self.read_by(pattern, Pattern::read_strictly)
    }

    /// The same, with any word in the place of the colour where there is none for one.
    pub fn read(&self, pattern: &Pattern) -> Option<Guess> {
        self.read_strictly(pattern).or_else(|| self.read_by(pattern, Pattern::read_loosely))
    }

    fn read_by(&self, pattern: &Pattern, read: fn(&Pattern, &[String]) -> Option<Guess>) -> Option<Guess> {
        if pattern.names_subject() {
            return read(pattern, &self.parts);
        }
        Some(Guess { subject: self.subject(), ..read(pattern, &self.rest)? })
    }

    /// The subject that its words mean.
    pub fn subject(&self) -> Option<Subject> {
        match self.named {
            Named::Subject(subject) => Some(subject),
            Named::Nothing | Named::SomeBall | Named::Several => None,
        }
    }
}

/// Dark frames and flat fields lie beside the photos, or in a folder of their own, and follow no pattern of theirs:
/// "dark.png", "flat-03.tif", "darks/DSC_0001.tif". A lamp may well be called black or white.
fn correction_of(parts: &[String]) -> Option<Subject> {
    let is_correction = |subject: &Subject| matches!(subject, Subject::Dark | Subject::FlatField);
    let of_word = |part: &String| {
        let word = part.trim_end_matches(|c: char| c.is_ascii_digit() || SEPARATORS.contains(&c));
        let word = word.to_lowercase();
        subject_of_word(&word).filter(is_correction).filter(|_| !matches!(word.as_str(), "black" | "white"))
    };
    parts.iter().rev().take(2).find_map(of_word)
}
