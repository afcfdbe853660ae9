//! Which line of a light file is which light of a set.

use std::path::Path;

use super::{LightFile, LightFileError, LightFileProblem, LightLine};
use crate::set::CaptureSet;

/// Lines of one light may differ by this much before the user is warned.
const SAME_LIGHT_DEG: f64 = 0.5;

/// What was taken over from a light file, and what was not.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CarriedLights {
    /// Lights whose direction was taken over.
    pub lights: Vec<String>,
    /// Whether no name fitted and the order told which is which.
    pub by_order: bool,
    /// Lights of the set that the file does not know.
    pub missing: Vec<String>,
    /// Lights whose position in space is known, which is more than a direction: left as they are.
    pub near: Vec<String>,
    /// Lights whose lines differ, and by how many degrees; the first line counts.
    pub differing: Vec<(String, f64)>,
    /// Files that are no photo of the set.
    pub strangers: Vec<String>,
}

impl CarriedLights {
    /// Lines for the user; the first says what was done.
    pub fn lines(&self) -> Vec<String> {
        let how = if self.by_order { "in the order of the file, for no name fits" } else { "by file name" };
        let mut lines = vec![match self.lights.as_slice() {
            [] => "no direction was taken over".to_owned(),
            lights => format!("directions of {} taken over {how}", lights.join(", ")),
        }];
        lines.extend(self.warnings());
        lines
    }

    /// What was not as one would expect, a line each.
    pub fn warnings(&self) -> Vec<String> {
        let mut lines = Vec::new();
        let mut report = |names: &[String], what: &str| {
            if !names.is_empty() {
                lines.push(format!("{}: {what}", names.join(", ")));
            }
        };
        report(&self.missing, "not in the light file; the direction stays as it was");
        report(&self.near, "has a position, which says more than a direction; the light file's was left out");
        report(&self.strangers, "in the light file, and no photo of this set");
        for (light, degrees) in &self.differing {
            lines.push(format!("{light}: its lines differ by {degrees:.1} degrees; the first one counts"));
        }
        lines
    }
}

impl LightFile {
    /// Puts the directions in force as typed values of `set`. A line belongs to the light whose photo it names, by as much
    /// of the path as both have and whatever the extension; where no name fits at all, and there are as many lines as
    /// lights, the order decides. `path` is for the error.
    ///
    /// # Errors
    /// `Strange` where neither names nor the count fit; the set is then as it was.
    pub fn put_into(&self, set: &mut CaptureSet, path: &Path) -> Result<CarriedLights, LightFileError> {
        let photos = Photos::of(set);
        let mut owners: Vec<Option<usize>> = self.lines.iter().map(|line| photos.owner(&line.file)).collect();
        let mut carried = CarriedLights::default();
        if owners.iter().all(Option::is_none) {
            let (found, lights) = (self.lines.len(), set.lights.len());
            if found != lights {
                let first = self.lines.first().map(|line| line.file.clone()).unwrap_or_default();
                let problem = LightFileProblem::Strange { first, found, lights };
                return Err(LightFileError { path: path.to_owned(), line: None, problem });
            }
            owners = (0..lights).map(Some).collect();
            carried.by_order = true;
        }
        for (line, owner) in self.lines.iter().zip(&owners) {
            if owner.is_none() {
                carried.strangers.push(line.file.clone());
            }
        }
        for l in 0..set.lights.len() {
            let lines: Vec<&LightLine> =
                self.lines.iter().zip(&owners).filter(|(_, owner)| **owner == Some(l)).map(|(line, _)| line).collect();
            let name = set.lights[l].name.clone();
            let Some((first, others)) = lines.split_first() else {
                carried.missing.push(name);
                continue;
            };
            let angle = |other: &&LightLine| first.direction_to_light.angle(&other.direction_to_light).to_degrees();
            let differ_deg = others.iter().map(angle).fold(0.0, f64::max);
            if differ_deg > SAME_LIGHT_DEG {
                carried.differing.push((name.clone(), differ_deg));
            }
            if set.lights[l].position_mm.is_some() {
                carried.near.push(name);
                continue;
            }
            set.put_direction(&name, first.direction_to_light.into());
            carried.lights.push(name);
        }
        Ok(carried)
    }
}

/// The photos of a set, each by the parts of its path from the last to the first, and its light.
struct Photos(Vec<(Vec<String>, usize)>);

impl Photos {
    fn of(set: &CaptureSet) -> Self {
        let of_shot = |shot: &crate::set::Shot| {
            let light = set.light_index(shot.light.as_deref()?)?;
            Some(shot.files.iter().map(move |file| (parts(file), light)).collect::<Vec<_>>())
        };
        Self(set.shots.iter().filter_map(of_shot).flatten().collect())
    }

    /// The light whose photos share the most of the path's end with `file`; none where two lights share as much.
    fn owner(&self, file: &str) -> Option<usize> {
        let wanted = parts(file);
        let shared = |parts: &[String]| parts.iter().zip(&wanted).take_while(|(one, other)| one == other).count();
        let most = self.0.iter().map(|(parts, _)| shared(parts)).max().filter(|most| *most > 0)?;
        let mut lights = self.0.iter().filter(|(parts, _)| shared(parts) == most).map(|(_, light)| *light);
        let light = lights.next()?;
        lights.all(|other| other == light).then_some(light)
    }
}

/// The parts of a path, the last first and without its extension: tools that read light files convert pictures.
fn parts(path: &str) -> Vec<String> {
    let path = path.replace('\\', "/").to_lowercase();
    let mut parts: Vec<String> =
        path.split('/').filter(|part| !part.is_empty() && *part != ".").map(Into::into).collect();
    if let Some(name) = parts.last_mut()
        && let Some((stem, _)) = name.rsplit_once('.')
        && !stem.is_empty()
    {
        *name = stem.to_owned();
    }
    parts.reverse();
    parts
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::set::{Light, Shot};

    fn set(photos: &[(&str, &str)]) -> CaptureSet {
        let mut lights: Vec<Light> = Vec::new();
        for (light, _) in photos {
            if !lights.iter().any(|known| known.name == *light) {
                lights.push(Light { name: (*light).into(), ..Light::default() });
            }
        }
        let shot = |(light, file): &(&str, &str)| Shot {
            light: Some((*light).into()),
            files: vec![(*file).into()],
            ..Shot::default()
        };
        CaptureSet { lights, shots: photos.iter().map(shot).collect(), ..CaptureSet::default() }
    }

    fn file(lines: &[(&str, [f64; 3])]) -> LightFile {
        let line = |(file, d): &(&str, [f64; 3])| LightLine {
            file: (*file).into(),
            direction_to_light: Vector3::from(*d).normalize(),
        };
        LightFile { lines: lines.iter().map(line).collect() }
    }

    fn put(lines: &[(&str, [f64; 3])], set: &mut CaptureSet) -> Result<CarriedLights, LightFileError> {
        file(lines).put_into(set, Path::new("lights.lp"))
    }

    #[test]
    fn names_tell_whatever_folder_order_and_extension() {
        let mut set =
            set(&[("left", "object/left-blue.png"), ("left", "object/left-green.png"), ("top", "object/top.png")]);
        set.lights[0].direction = Some([1.0, 0.0, 0.0]);
        let lines = [("D:\\rti\\TOP.jpg", [0.0, 1.0, 1.0]), ("left-green.tif", [-1.0, 0.0, 1.0])];
        let carried = put(&lines, &mut set).unwrap();
        assert_eq!(
            (carried.lights.as_slice(), carried.by_order),
            (["left".to_owned(), "top".into()].as_slice(), false)
        );
        assert_eq!(carried.lines().len(), 1);
        let half = 0.5_f64.sqrt();
        let found = |light: &str| Vector3::from(set.given_direction(light).unwrap());
        assert!((found("left") - Vector3::new(-half, 0.0, half)).norm() < 1e-12, "in place of the typed one");
        assert!((found("top") - Vector3::new(0.0, half, half)).norm() < 1e-12);
    }

    #[test]
    fn folders_tell_photos_of_one_name_apart() {
        let mut set = set(&[("a", "lamp1/photo.png"), ("b", "lamp2/photo.png")]);
        put(&[("x/lamp2/photo.jpg", [0.0, 1.0, 1.0]), ("lamp1/photo.png", [1.0, 0.0, 1.0])], &mut set).unwrap();
        assert!(set.given_direction("a").unwrap()[0] > 0.7 && set.given_direction("b").unwrap()[1] > 0.7);
        // A name that could be either is neither.
        let carried = put(&[("photo.png", [0.0, 0.0, 1.0]), ("lamp1/photo.png", [1.0, 0.0, 1.0])], &mut set).unwrap();
        assert_eq!(
            (carried.strangers.as_slice(), carried.missing.as_slice()),
            (["photo.png".to_owned()].as_slice(), ["b".to_owned()].as_slice())
        );
        assert_eq!(carried.warnings().len(), 2);
    }

    #[test]
    fn where_no_name_fits_the_order_tells_and_where_that_cannot_be_nothing_changes() {
        let mut set = set(&[("a", "one.png"), ("b", "two.png")]);
        let carried = put(&[("img_01", [1.0, 0.0, 1.0]), ("img_02", [0.0, 1.0, 1.0])], &mut set).unwrap();
        assert!(carried.by_order && carried.lines()[0].contains("order"));
        assert!(set.given_direction("b").unwrap()[1] > 0.7);
        let before = set.clone();
        let refused = put(&[("img_01", [1.0, 0.0, 1.0])], &mut set).unwrap_err().to_string();
        assert!(refused.starts_with("lights.lp: none of its file names") && refused.contains("img_01"), "{refused}");
        assert_eq!(set, before);
    }

    #[test]
    fn a_known_position_stays_and_lines_that_differ_are_told() {
        let mut set = set(&[("a", "a.png"), ("b", "b.png"), ("b", "b2.png")]);
        set.lights[0].position_mm = Some([1.0, 2.0, 300.0]);
        let lines = [("a.png", [1.0, 0.0, 1.0]), ("b.png", [0.0, 1.0, 1.0]), ("b2.png", [0.0, 1.1, 1.0])];
        let carried = put(&lines, &mut set).unwrap();
        assert_eq!(
            (carried.near.as_slice(), carried.lights.as_slice()),
            (["a".to_owned()].as_slice(), ["b".to_owned()].as_slice())
        );
        assert!(set.given_direction("a").is_none());
        assert!((carried.differing[0].1 - 2.7).abs() < 0.1, "{:?}", carried.differing);
    }
}
