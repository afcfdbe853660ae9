//! What each of some files becomes, by its own name and by those of the others.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use indexmap::IndexMap;

use super::super::model::CaptureSet;
use super::super::subject::{Naming, Subject};
use super::GuessOptions;
use super::doubt::Doubt;
use super::exposure::numbers_are_exposures;
use super::name::{Name, names_of};
use super::words::{Named, is_colour};
use crate::image_file::Format;

/// What a file shows.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Place {
    /// The subject.
    pub subject: Subject,
    /// The light's name.
    pub light: Option<String>,
    /// The colour's name; `None` with `rgb` for the colours of the set.
    pub colour: Option<String>,
    /// Whether it holds all colours.
    pub rgb: bool,
}

/// A file by what its name says.
struct File<'f> {
    path: &'f Path,
    place: Place,
    repeat: Option<u64>,
    exposure: Option<String>,
    /// Whether the user or the name says the subject.
    subject_is_named: bool,
}

/// The subjects that words in the names of files, or of their folders, mean; `None` where there is none, or several.
pub fn named_subjects<P: AsRef<Path>>(files: &[P]) -> Vec<Option<Subject>> {
    names_of(files)
        .iter()
        .map(|name| name.as_ref().and_then(|name| name.correction.or_else(|| name.subject())))
        .collect()
}

/// What each file is to become, or why that is in doubt. Files of several folders, or of several exposures, are never
/// repeats of each other.
pub fn plan<P: AsRef<Path>>(set: &CaptureSet, files: &[P], options: &GuessOptions) -> Vec<Result<Place, Doubt>> {
    let mut read: Vec<Result<File<'_>, Doubt>> = files
        .iter()
        .zip(names_of(files))
        .map(|(file, name)| read_file(set, file.as_ref(), name.as_ref(), options))
        .collect();
    spell_alike(set, &mut read);
    let doubts = doubts_among(set, &read);
    let each = read.into_iter().zip(doubts);
    each.map(|(file, doubt)| doubt.map_or_else(|| file.map(|file| file.place), Err)).collect()
}

fn read_file<'f>(
    set: &CaptureSet,
    path: &'f Path,
    name: Option<&Name>,
    options: &GuessOptions,
) -> Result<File<'f>, Doubt> {
    let no_pattern = || Doubt::NoPattern { pattern: options.pattern.to_string() };
    let name = name.ok_or_else(no_pattern)?;
    let guess = name.read(&options.pattern);
    let by_user = path.parent().and_then(|folder| options.folders.get(folder)).copied();
    let by_pattern = guess.as_ref().filter(|_| options.pattern.names_subject()).and_then(|guess| guess.subject);
    let correction = name.correction.filter(|_| by_user.is_none() && by_pattern.is_none());
    if let Some(subject) = correction {
        let place = Place { subject, light: None, colour: None, rgb: false };
        return Ok(File { path, place, repeat: None, exposure: None, subject_is_named: true });
    }
    let guess = guess.ok_or_else(no_pattern)?;
    let named = by_user.or(guess.subject);
    match (&name.named, named) {
        (Named::SomeBall, None) if options.subject.sphere_kind().is_none() => return Err(Doubt::SomeBall),
        (Named::Several, None) => return Err(Doubt::SeveralSubjects),
        _ => {}
    }
    let subject = named.unwrap_or(options.subject);
    let light = guess.light.filter(|_| subject.light() != Naming::Refused);
    let colour = guess.colour.filter(|_| subject.colour() != Naming::Refused);
    if light.is_none() && subject.light() == Naming::Required {
        return Err(Doubt::NoLight(subject));
    }
    let is_known = |colour: &String| options.any_colour || is_colour(colour) || set.colour_index(colour).is_some();
    if let Some(word) = colour.as_ref().filter(|colour| !is_known(colour)) {
        return Err(Doubt::NoColourWord(word.clone()));
    }
    let rgb = colour.is_none() && subject.colour() == Naming::Required;
    if rgb && !options.rgb {
        return Err(Doubt::NoColour(subject));
    }
    let place = Place { subject, light, colour, rgb };
    Ok(File { path, place, repeat: guess.repeat, exposure: name.exposure.clone(), subject_is_named: named.is_some() })
}

/// Gives lights and colours that differ by capitals alone the spelling of the first.
fn spell_alike(set: &CaptureSet, read: &mut [Result<File<'_>, Doubt>]) {
    let mut lights: Vec<String> = set.lights.iter().map(|light| light.name.clone()).collect();
    let mut colours: Vec<String> = set.colours.iter().map(|colour| colour.name.clone()).collect();
    for file in read.iter_mut().flatten() {
        for (name, known) in [(&mut file.place.light, &mut lights), (&mut file.place.colour, &mut colours)] {
            let Some(name) = name else { continue };
            match known.iter().find(|known| known.to_lowercase() == name.to_lowercase()) {
                Some(first) => name.clone_from(first),
                None => known.push(name.clone()),
            }
        }
    }
}

/// Doubts that arise between files: with those of the same photo, in this list or in the set.
fn doubts_among(set: &CaptureSet, read: &[Result<File<'_>, Doubt>]) -> Vec<Option<Doubt>> {
    let mut photos: IndexMap<&Place, Vec<usize>> = IndexMap::new();
    for (index, file) in read.iter().enumerate() {
        if let Ok(file) = file
            && file.place.subject.light() != Naming::Refused
        {
            photos.entry(&file.place).or_default().push(index);
        }
    }
    let mut doubts: Vec<Option<Doubt>> = vec![None; read.len()];
    let mut clashes: Vec<Vec<PathBuf>> = Vec::new();
    for (place, indices) in &photos {
        let files: Vec<&File<'_>> = indices.iter().filter_map(|&index| read[index].as_ref().ok()).collect();
        let earlier = earlier_files(set, place, &files);
        let folders = folders_of(&files, &earlier);
        if let Some(exposures) = exposures_of(&files) {
            indices.iter().for_each(|&index| doubts[index] = Some(Doubt::Exposures { exposures: exposures.clone() }));
        } else if folders.len() > 1 && !are_numbered(&files, &earlier) {
            indices.iter().for_each(|&index| doubts[index] = Some(Doubt::SameNames { folders: folders.clone() }));
            clashes.push(folders);
        } else {
            for (&index, other) in indices.iter().zip(taken_by(&files, &earlier)) {
                doubts[index] = other.map(|other| Doubt::SamePhoto { other });
            }
        }
    }
    // A folder in doubt is so as a whole: another file of it would become the object's without a question.
    for (doubt, file) in doubts.iter_mut().zip(read) {
        if let (None, Ok(file)) = (&doubt, file)
            && !file.subject_is_named
            && let Some(folder) = file.path.parent()
            && let Some(folders) = clashes.iter().find(|folders| folders.iter().any(|other| other == folder))
        {
            *doubt = Some(Doubt::SameNames { folders: folders.clone() });
        }
    }
    doubts
}

/// The files that the set already has in the same shot, without those that are added again.
fn earlier_files(set: &CaptureSet, place: &Place, files: &[&File<'_>]) -> Vec<PathBuf> {
    let colour =
        if place.rgb { set.colours.first().map(|colour| colour.name.as_str()) } else { place.colour.as_deref() };
    let shot = set.shot(place.subject, place.light.as_deref(), colour);
    let earlier = shot.into_iter().flat_map(|shot| &shot.files).map(|written| set.resolve(written));
    earlier.filter(|earlier| files.iter().all(|file| file.path != earlier)).collect()
}

fn folders_of(files: &[&File<'_>], earlier: &[PathBuf]) -> Vec<PathBuf> {
    let all = earlier.iter().map(PathBuf::as_path).chain(files.iter().map(|file| file.path));
    let mut folders: Vec<PathBuf> = all.filter_map(|path| path.parent().map(Path::to_owned)).collect();
    folders.sort();
    folders.dedup();
    folders
}

/// Whether each has a number of its own: repeats may be sorted into folders.
fn are_numbered(files: &[&File<'_>], earlier: &[PathBuf]) -> bool {
    let numbers: HashSet<u64> = files.iter().filter_map(|file| file.repeat).collect();
    let is_new = |file: &&File<'_>| earlier.iter().all(|earlier| earlier.file_stem() != file.path.file_stem());
    numbers.len() == files.len() && files.iter().all(is_new)
}

/// The exposures at which one photo was taken, if there are several.
fn exposures_of(files: &[&File<'_>]) -> Option<Vec<String>> {
    let numbers: Vec<u64> = files.iter().filter_map(|file| file.repeat).collect();
    let mut exposures: Vec<String> = files.iter().filter_map(|file| file.exposure.clone()).collect();
    let some_have_none = !exposures.is_empty() && exposures.len() < files.len();
    if exposures.is_empty() && numbers_are_exposures(numbers.clone()) {
        exposures = numbers.iter().map(ToString::to_string).collect();
    }
    exposures.sort_unstable();
    exposures.dedup();
    (exposures.len() > 1 || some_have_none).then_some(exposures)
}

/// For each file the other of its folder that is the same photo by its name: repeats have numbers of their own. Of one
/// photo in two formats the one that lost nothing is taken.
fn taken_by(files: &[&File<'_>], earlier: &[PathBuf]) -> Vec<Option<String>> {
    let file_name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let is_lossy = |path: &Path| Format::of_name(path).is_some_and(|format| format == Format::Jpeg);
    let first = |file: &File<'_>| {
        let same = files.iter().filter(|other| other.repeat == file.repeat).map(|other| other.path);
        same.min_by_key(|path| is_lossy(path)).filter(|path| *path != file.path).map(file_name)
    };
    let of_set = earlier.first().map(|path| file_name(path));
    files.iter().map(|file| of_set.clone().filter(|_| file.repeat.is_none()).or_else(|| first(file))).collect()
}
