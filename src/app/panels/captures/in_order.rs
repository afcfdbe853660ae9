//! Files whose names have no pattern: assigned by the order in which they were taken.

use std::collections::{HashMap, VecDeque};
use std::path::{Path, PathBuf};

use eframe::egui::{Button, RichText, TextEdit, Ui};
use firstbounce_capture::CaptureSet;
use firstbounce_capture::image_file::TimeTaken;
use firstbounce_capture::set::{Naming, Subject, Word, named_subjects, order_taken};

/// The order that the user gives.
pub struct InOrder {
    /// What these files show, one subject after the other.
    subjects: Vec<Subject>,
    lights: String,
    colours: String,
    /// Whether all colours of one light come before the next light.
    colours_first: bool,
    /// Whether names count although times say another order.
    by_name: bool,
}

/// What a photo shows, by its place in the order; empty names where there is none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InPlace {
    pub subject: Subject,
    pub light: String,
    pub colour: String,
}

impl InOrder {
    /// Begins with the lights and colours that the set has, and with the subjects that files name.
    pub fn new(set: &CaptureSet, files: &[PathBuf]) -> Self {
        let list = |names: Vec<&str>| names.join(", ");
        let mut subjects: Vec<Subject> = Vec::new();
        for subject in named_subjects(files).into_iter().flatten() {
            if !subjects.contains(&subject) {
                subjects.push(subject);
            }
        }
        if subjects.is_empty() {
            subjects.push(Subject::Object);
        }
        Self {
            subjects,
            lights: list(set.lights.iter().map(|light| light.name.as_str()).collect()),
            colours: list(set.colours.iter().map(|colour| colour.name.as_str()).collect()),
            colours_first: true,
            by_name: false,
        }
    }

    /// Asks for the order of these files; what each shows, once the user confirms.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        files: &[PathBuf],
        times: &HashMap<PathBuf, TimeTaken>,
    ) -> Option<Vec<(PathBuf, InPlace)>> {
        let files = self.sorted(ui, files, times);
        ui.label("They show, in this order");
        ui.horizontal_wrapped(|ui| {
            for &subject in Subject::ALL {
                let place = self.subjects.iter().position(|other| *other == subject);
                if let Some(place) = place {
                    ui.label(format!("{}.", place + 1));
                }
                if ui.checkbox(&mut place.is_some(), subject.title()).clicked() {
                    match place {
                        Some(place) => drop(self.subjects.remove(place)),
                        None => self.subjects.push(subject),
                    }
                }
            }
        });
        for (title, text) in [("Lights in order", &mut self.lights), ("Colours in order", &mut self.colours)] {
            let label = ui.label(title);
            let hint = "names, with commas between them";
            ui.add(TextEdit::singleline(text).hint_text(hint).desired_width(f32::INFINITY)).labelled_by(label.id);
        }
        ui.radio_value(&mut self.colours_first, true, "All colours of a light, then the next light");
        ui.radio_value(&mut self.colours_first, false, "All lights of a colour, then the next colour");
        let (lights, colours) = (names(&self.lights), names(&self.colours));
        let pairs = |coloured: bool| order(&lights, if coloured { &colours } else { &[] }, self.colours_first);
        let assigned = assigned(&self.subjects, &named_subjects(&files), pairs);
        let count = files.len();
        let button = Button::new(format!("Assign these {count} files in order"));
        let pressed = ui.add_enabled(assigned.is_ok(), button).clicked();
        match assigned {
            Ok(places) => pressed.then(|| files.into_iter().zip(places).collect()),
            Err(named) => {
                let words = format!("This names {named} photos, for {count} files.");
                ui.label(RichText::new(words).small().color(ui.visuals().warn_fg_color));
                None
            }
        }
    }

    /// The files in the order in which they were taken, which is said.
    fn sorted(&mut self, ui: &mut Ui, files: &[PathBuf], times: &HashMap<PathBuf, TimeTaken>) -> Vec<PathBuf> {
        let taken = order_taken(files, |file| times.get(file).copied());
        if taken.disagrees() {
            let words = "The times of these files and the numbers in their names say different orders.";
            ui.label(RichText::new(words).color(ui.visuals().warn_fg_color));
            ui.checkbox(&mut self.by_name, "By the numbers in their names");
        }
        let by_name = taken.by_time.is_none() || self.by_name;
        let order = if by_name { &taken.by_name } else { taken.order() };
        let files: Vec<PathBuf> = order.iter().map(|&index| files[index].clone()).collect();
        if let (Some(first), Some(last)) = (files.first(), files.last()) {
            let name = |file: &Path| file.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let by = if by_name { "By their names" } else { "By the time they were taken" };
            ui.label(RichText::new(format!("{by}, from {} to {}", name(first), name(last))).small().weak());
        }
        files
    }
}

fn names(text: &str) -> Vec<String> {
    text.split(',').map(str::trim).filter(|name| !name.is_empty()).map(str::to_owned).collect()
}

/// Every light with every colour; without a colour, as for a mirror ball, every light once.
fn order(lights: &[String], colours: &[String], colours_first: bool) -> Vec<(String, String)> {
    let none = [String::new()];
    let colours = if colours.is_empty() { &none } else { colours };
    let pair = |light: &String, colour: &String| (light.clone(), colour.clone());
    if colours_first {
        lights.iter().flat_map(|light| colours.iter().map(move |colour| pair(light, colour))).collect()
    } else {
        colours.iter().flat_map(|colour| lights.iter().map(move |light| pair(light, colour))).collect()
    }
}

/// What each file shows: one subject after the other, or the one that its name says. A subject that needs no colour was
/// photographed without, or else in all of them, whichever fits; one without a light takes what is left.
///
/// # Errors
/// How many photos are named, where these are not the files.
fn assigned(
    subjects: &[Subject],
    named: &[Option<Subject>],
    pairs: impl Fn(bool) -> Vec<(String, String)>,
) -> Result<Vec<InPlace>, usize> {
    fit(subjects, named, |subject| pairs(subject.colour() == Naming::Required))
        .or_else(|count| fit(subjects, named, |_| pairs(true)).map_err(|_| count))
}

fn fit(
    subjects: &[Subject],
    named: &[Option<Subject>],
    pairs: impl Fn(Subject) -> Vec<(String, String)>,
) -> Result<Vec<InPlace>, usize> {
    let has_light = |subject: &Subject| subject.light() == Naming::Required;
    let is_own = |subject: &Subject| named.contains(&Some(*subject));
    let count = |counts: &dyn Fn(&Subject) -> bool| -> usize {
        let lit = subjects.iter().filter(|subject| has_light(subject) && counts(subject));
        lit.map(|subject| pairs(*subject).len()).sum()
    };
    let (counted, counted_free) = (count(&|_| true), count(&|subject| !is_own(subject)));
    let mut free: VecDeque<usize> = (0..named.len()).filter(|&index| named[index].is_none()).collect();
    let mut places: Vec<Option<InPlace>> = vec![None; named.len()];
    // What is left of the files without a name shows the first subject that has no light.
    let mut uncounted = free.len().saturating_sub(counted_free);
    for &subject in subjects {
        let nameless = |count: usize| vec![(String::new(), String::new()); count];
        let own: Vec<usize> = (0..named.len()).filter(|&index| named[index] == Some(subject)).collect();
        let wanted = match (has_light(&subject), own.is_empty()) {
            (true, _) => pairs(subject),
            (false, false) => nameless(own.len()),
            (false, true) => nameless(std::mem::take(&mut uncounted)),
        };
        let files = if own.is_empty() { free.drain(..wanted.len().min(free.len())).collect() } else { own };
        if files.len() != wanted.len() {
            return Err(counted);
        }
        for (file, (light, colour)) in files.into_iter().zip(wanted) {
            places[file] = Some(InPlace { subject, light, colour });
        }
    }
    places.into_iter().collect::<Option<Vec<_>>>().filter(|places| !places.is_empty()).ok_or(counted)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_counted_light_by_light_or_colour_by_colour() {
        let (lights, colours) = (names("left, top"), names(" blue,green ,"));
        let said = |colours_first| {
            let pairs = order(&lights, &colours, colours_first).into_iter();
            pairs.map(|(light, colour)| format!("{light} {colour}")).collect::<Vec<_>>()
        };
        assert_eq!(said(true), ["left blue", "left green", "top blue", "top green"]);
        assert_eq!(said(false), ["left blue", "top blue", "left green", "top green"]);
        assert_eq!(order(&lights, &[], true).len(), 2);
    }

    fn subjects_of(subjects: &[Subject], named: &[Option<Subject>]) -> Result<Vec<Subject>, usize> {
        let (lights, colours) = (names("left, top, right"), names("blue, green"));
        let places = assigned(subjects, named, |coloured| order(&lights, if coloured { &colours } else { &[] }, true))?;
        Ok(places.into_iter().map(|place| place.subject).collect())
    }

    #[test]
    fn a_dump_of_a_camera_is_object_balls_and_dark_frames_one_after_the_other() {
        use Subject::{Dark, GreySphere, MirrorSphere, Object};
        let all = [Object, GreySphere, MirrorSphere, Dark];
        let of = |counts: [usize; 4]| all.iter().zip(counts).flat_map(|(s, n)| vec![*s; n]).collect::<Vec<_>>();
        assert_eq!(subjects_of(&all[..3], &[None; 15]), Ok(of([6, 6, 3, 0])));
        assert_eq!(subjects_of(&all[..3], &[None; 18]), Ok(of([6, 6, 6, 0])), "the mirror ball in every colour");
        assert_eq!(subjects_of(&all, &[None; 17]), Ok(of([6, 6, 3, 2])));
        assert_eq!(subjects_of(&all[..3], &[None; 16]), Err(15));
        assert_eq!(subjects_of(&[Object], &[]), Err(6));
    }

    #[test]
    fn files_whose_folder_names_their_subject_are_counted_apart() {
        use Subject::{GreySphere, Object};
        let mixed: Vec<_> = (0..12).map(|index| Some(if index % 2 == 0 { Object } else { GreySphere })).collect();
        let expected: Vec<_> = mixed.iter().copied().flatten().collect();
        assert_eq!(subjects_of(&[GreySphere, Object], &mixed), Ok(expected));
        assert_eq!(subjects_of(&[Object], &mixed), Err(6), "the ball's are left over");
    }
}
