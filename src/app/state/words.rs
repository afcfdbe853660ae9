//! What is wrong with a set, in the words of the window.

use firstbounce_capture::CaptureSet;
use firstbounce_capture::set::{Location, Problem};

use super::layout::Shown;
use super::results::ShotName;

/// A problem of the set without the words of its file: "Light left: direction: expected three numbers".
pub fn problem_words(problem: &Problem, set: &CaptureSet) -> String {
    let named =
        |what: &str, name: Option<&String>| name.map_or_else(|| what.to_owned(), |name| format!("{what} {name}"));
    let place = match problem.location {
        Location::Set => None,
        Location::Camera => Some("Camera".into()),
        Location::Colour(index) => Some(named("Colour", set.colours.get(index).map(|colour| &colour.name))),
        Location::Light(index) => Some(named("Light", set.lights.get(index).map(|light| &light.name))),
        Location::Shot(index) => {
            Some(set.shots.get(index).map_or("Photo".into(), |shot| Shown::Photo(ShotName::of(shot)).title()))
        }
        Location::Sphere(index) => Some(set.spheres.get(index).map_or("Ball".into(), |ball| ball.kind.title().into())),
        Location::Calibration => Some("Calibration".into()),
        Location::Separation => Some("Separation".into()),
        Location::Shape => Some("Shape".into()),
        Location::Truth => Some("Truth".into()),
    };
    let key = problem.key.as_ref().map(|key| key.replace(['_', '.'], " "));
    place.into_iter().chain(key).chain([in_window(&problem.message, set)]).collect::<Vec<_>>().join(": ")
}

/// Names of colours and lights, for the words of a verdict.
pub fn names(set: &CaptureSet) -> (Vec<String>, Vec<String>) {
    let colours = set.colours.iter().map(|colour| colour.name.clone()).collect();
    (colours, set.lights.iter().map(|light| light.name.clone()).collect())
}

/// A line without the path of the set's folder.
pub fn in_window(line: &str, set: &CaptureSet) -> String {
    let folder = set.folder.display().to_string();
    if folder.is_empty() {
        line.to_owned()
    } else {
        line.replace(&format!("{folder}{}", std::path::MAIN_SEPARATOR), "")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_the_window_names_files_without_the_folder_of_the_set() {
        let set = CaptureSet { folder: "/home/a/set".into(), ..CaptureSet::default() };
        let line = "/home/a/set/object/left.png: not there, /home/b/x.png";
        assert_eq!(in_window(line, &set), "object/left.png: not there, /home/b/x.png");
    }
}
