//! Consistency of the parts of a set with each other.

use std::collections::{HashMap, HashSet};

use firstbounce_core::image::mixing::Mixing;
use firstbounce_core::separate::MIN_BETA_DISTANCE;

use super::method::Method;
use super::model::*;
use super::number::{Number, short};
use super::problem::{Location, Problem};
use super::rule::did_you_mean;
use super::word::Word;

/// More lamp colours than any rig has. The parts of a set are few enough that comparing each with each takes no time that
/// is felt.
pub const MAX_COLOURS: usize = 32;

/// More lamp positions than any rig has.
pub const MAX_LIGHTS: usize = 1000;

const MAX_SHOTS: usize = 100_000;
const MAX_FILES_OF_SHOT: usize = 1000;

/// For so many unknown names the one that was meant is looked for.
const MAX_SUGGESTIONS: usize = 10;

/// Room for the rounding of typed decimals: 0.52 and 0.5 are 0.02 apart.
const ROUNDING: f64 = 1e-9;

impl CaptureSet {
    /// The problems between parts of the set.
    pub(super) fn check_consistency(&self) -> Vec<Problem> {
        let mut problems = self.check_counts();
        if !problems.is_empty() {
            return problems;
        }
        self.check_presence(&mut problems);
        let colours = self.colours.iter().map(|colour| colour.name.as_str());
        let lights = self.lights.iter().map(|light| light.name.as_str());
        check_distinct(colours, Location::Colour, &mut problems);
        check_distinct(lights, Location::Light, &mut problems);
        self.check_shots(&mut problems);
        // A misspelt name is one problem, not also a missing shot.
        if problems.is_empty() {
            self.check_missing_shots(&mut problems);
        }
        self.check_crosstalk(&mut problems);
        self.check_spheres(&mut problems);
        self.check_calibration(&mut problems);
        self.check_bounces(&mut problems);
        self.check_left_out(&mut problems);
        if self.lights.len() > 1 && !self.truth.bounce.contains("{light}") {
            let message = format!("expected a file path with {{light}} for the light, found {:?}", self.truth.bounce);
            problems.push(Problem::of_key(Location::Truth, "bounce", message));
        }
        problems
    }

    fn check_counts(&self) -> Vec<Problem> {
        let most_files = self.shots.iter().enumerate().max_by_key(|(_, shot)| shot.files.len());
        let files =
            most_files.map(|(index, shot)| (Location::Shot(index), "files", shot.files.len(), MAX_FILES_OF_SHOT));
        let parts = [
            (Location::Set, "[[colour]]", self.colours.len(), MAX_COLOURS),
            (Location::Set, "[[light]]", self.lights.len(), MAX_LIGHTS),
            (Location::Set, "[[shot]]", self.shots.len(), MAX_SHOTS),
        ];
        let counts = parts.into_iter().chain(files);
        let too_many = counts.filter(|(.., found, most)| found > most);
        let problem =
            |(at, key, found, most)| Problem::of_key(at, key, format!("at most {most} can be used, found {found}"));
        too_many.map(problem).collect()
    }

    fn check_presence(&self, problems: &mut Vec<Problem>) {
        let mut need = |there: bool, message: &str| {
            if !there {
                problems.push(Problem::of_part(Location::Set, message));
            }
        };
        need(!self.colours.is_empty(), "no [[colour]]; at least one is needed, and the first is the reference colour");
        need(!self.lights.is_empty(), "no [[light]]; at least one is needed");
        let any_object = self.shots.iter().any(|shot| shot.subject == Subject::Object);
        need(any_object, "no [[shot]] with subject = \"object\"; there is nothing to solve");
    }

    fn check_shots(&self, problems: &mut Vec<Problem>) {
        let colours: Vec<&str> = self.colours.iter().map(|colour| colour.name.as_str()).collect();
        let lights: Vec<&str> = self.lights.iter().map(|light| light.name.as_str()).collect();
        let mut seen = HashMap::new();
        for (index, shot) in self.shots.iter().enumerate() {
            let at = Location::Shot(index);
            for (what, name, known) in [("light", &shot.light, &lights), ("colour", &shot.colour, &colours)] {
                if let Some(name) = name {
                    check_known(at, what, what, name, known, problems);
                }
            }
            if let Some(first) = seen.insert((shot.subject, &shot.light, &shot.colour), index) {
                let message = format!(
                    "a second shot of {}, as number {}; list repeats in one shot's files",
                    shot.described(),
                    first + 1
                );
                problems.push(Problem::of_part(at, message));
            }
        }
    }

    /// Under each light a matte subject is seen in every colour, or (a ball) not at all.
    fn check_missing_shots(&self, problems: &mut Vec<Problem>) {
        let taken: HashSet<(Subject, &str, &str)> = self
            .shots
            .iter()
            .filter_map(|shot| Some((shot.subject, shot.light.as_deref()?, shot.colour.as_deref()?)))
            .collect();
        let lit: HashSet<(Subject, &str)> = taken.iter().map(|(subject, light, _)| (*subject, *light)).collect();
        for (index, light) in self.lights.iter().enumerate() {
            let name = light.name.as_str();
            for &subject in Subject::ALL.iter().filter(|subject| subject.is_matte()) {
                let word = subject.word();
                if !lit.contains(&(subject, name)) {
                    if subject == Subject::Object {
                        let message = format!("{name:?} has no {word} shot");
                        problems.push(Problem::of_part(Location::Light(index), message));
                    }
                    continue;
                }
                let missing = self.colours.iter().filter(|colour| !taken.contains(&(subject, name, &colour.name)));
                problems.extend(missing.map(|colour| {
                    let message = format!("{name:?} has no {:?} {word} shot", colour.name);
                    Problem::of_part(Location::Light(index), message)
                }));
            }
        }
    }

    /// A typed matrix can be undone, and shots that measure one show every lamp colour in channels of their own.
    fn check_crosstalk(&self, problems: &mut Vec<Problem>) {
        if let Some(rows) = &self.camera.crosstalk
            && let Err(reason) = Mixing::new(rows, self.colours.len())
        {
            problems.push(Problem::of_key(Location::Camera, "crosstalk", reason.to_string()));
        }
        let mut shots = self.shots.iter().enumerate().filter(|(_, shot)| shot.subject == Subject::Crosstalk);
        let Some((first, _)) = shots.next() else { return };
        let channels: HashSet<_> = self.colours.iter().map(|colour| colour.channel.word()).collect();
        if channels.len() < self.colours.len() || self.colours.iter().any(|colour| colour.channel == Channel::Grey) {
            let message =
                "crosstalk is between the channels of one photo: give each [[colour]] a channel of its own, r, g or b";
            problems.push(Problem::of_part(Location::Shot(first), message));
        }
        let lit: HashSet<&str> = self.shots_of(Subject::Crosstalk).filter_map(|shot| shot.colour.as_deref()).collect();
        if let Some(colour) = self.colours.iter().find(|colour| !lit.contains(colour.name.as_str())) {
            let message = format!(
                "no crosstalk shot under {:?} alone; photograph the grey ball under each lamp colour alone",
                colour.name
            );
            problems.push(Problem::of_part(Location::Shot(first), message));
        }
    }

    fn check_spheres(&self, problems: &mut Vec<Problem>) {
        let moved = self.shots.iter().position(|shot| shot.subject == Subject::MirrorSphereMoved);
        if let (Some(moved), None) = (moved, self.subject_with(SphereKind::Mirror)) {
            let message = format!(
                "the mirror ball in its second place says something only beside the first: give that as shots of {:?}",
                Subject::MirrorSphere.word()
            );
            problems.push(Problem::of_part(Location::Shot(moved), message));
        }
        let scale =
            |sphere: &Sphere| self.mm_per_pixel_of(sphere).filter(|_| Number::Radius.allows(sphere.circle.radius));
        for (index, sphere) in self.spheres.iter().enumerate() {
            if let Some(scale) = scale(sphere).filter(|scale| !Number::MmPerPixel.allows(*scale)) {
                let message =
                    format!("says that a pixel spans {} mm; expected {}", short(scale), Number::MmPerPixel.words());
                problems.push(Problem::of_key(Location::Sphere(index), "diameter_mm", message));
            }
        }
        let mut seen = HashSet::new();
        for (index, sphere) in self.spheres.iter().enumerate() {
            // Several mirror balls in one picture say where near lamps are.
            if !seen.insert((sphere.subject, sphere.kind)) && sphere.kind != SphereKind::Mirror {
                let message =
                    format!("a second circle for the {} ball in shots of {:?}", sphere.kind, sphere.subject.word());
                problems.push(Problem::of_part(Location::Sphere(index), message));
            }
        }
    }

    fn check_calibration(&self, problems: &mut Vec<Problem>) {
        let at = Location::Calibration;
        let calibration = &self.calibration;
        if let Some(beta) = &calibration.beta {
            problems.extend(self.check_ratios("beta", beta));
            problems.extend(self.check_beta_distances(beta));
        }
        for (light, alpha) in &calibration.alpha {
            problems.extend(self.check_ratios(&format!("alpha.{light}"), alpha));
        }
        let tables = [
            ("alpha", calibration.alpha.keys().collect::<Vec<_>>()),
            ("direction", calibration.direction.keys().collect()),
            ("intensity", calibration.intensity.keys().collect()),
        ];
        let lights: Vec<&str> = self.lights.iter().map(|light| light.name.as_str()).collect();
        for (table, names) in tables {
            for name in names {
                check_known(at, &format!("{table}.{name}"), "light", name, &lights, problems);
            }
        }
    }

    /// One ratio per colour, the reference colour's being 1.
    fn check_ratios(&self, key: &str, ratios: &[f64]) -> Option<Problem> {
        let colours = self.colours.len();
        let message = match ratios.first() {
            _ if ratios.len() != colours => {
                format!("expected {colours} numbers, one per colour, found {}", ratios.len())
            }
            Some(first) if (first - 1.0).abs() > ROUNDING => {
                format!("expected 1 for the reference colour, which is first, found {first}")
            }
            _ => return None,
        };
        Some(Problem::of_key(Location::Calibration, key, message))
    }

    /// The pairs of colours, the first of both first, whose `beta` lies within [`MIN_BETA_DISTANCE`] of each other.
    pub fn colours_alike(&self, beta: &[f64]) -> Vec<[usize; 2]> {
        let colours = self.colours.len().min(beta.len());
        let pairs = (0..colours).flat_map(|one| (one + 1..colours).map(move |other| [one, other]));
        pairs.filter(|&[one, other]| (beta[one] - beta[other]).abs() <= MIN_BETA_DISTANCE + ROUNDING).collect()
    }

    /// A problem for each pair of colours whose `beta`, typed or measured, is too alike.
    pub fn check_beta_distances(&self, beta: &[f64]) -> Vec<Problem> {
        let problem = |[one, other]: [usize; 2]| {
            let message = format!(
                "{:?} ({}) is within {MIN_BETA_DISTANCE} of {:?} ({}), too alike to tell bounces apart; take lamp colours \
                 that the paint reflects more differently",
                self.colours[other].name, beta[other], self.colours[one].name, beta[one]
            );
            Problem::of_key(Location::Calibration, "beta", message)
        };
        self.colours_alike(beta).into_iter().map(problem).collect()
    }

    /// Lights that surfaces are recovered without.
    fn check_left_out(&self, problems: &mut Vec<Problem>) {
        let lights: Vec<&str> = self.lights.iter().map(|light| light.name.as_str()).collect();
        for name in &self.shape.leave_out {
            check_known(Location::Shape, "leave_out", "light", name, &lights, problems);
        }
    }

    fn check_bounces(&self, problems: &mut Vec<Problem>) {
        let colours = self.colours.len();
        if let Some(bounces) = self.separation.bounces.filter(|bounces| *bounces > colours) {
            let message = format!("{bounces} bounces need {bounces} colours; this set has {colours}");
            problems.push(Problem::of_key(Location::Separation, "bounces", message));
        }
        if self.separation.method == Some(Method::ColoursAndShape) && colours == 1 {
            let message =
                format!("{} needs two colours; this set has 1: choose \"{}\"", Method::ColoursAndShape, Method::Shape);
            problems.push(Problem::of_key(Location::Separation, "method", message));
        }
    }
}

/// Names differ even where a file system takes capitals for small letters.
fn check_distinct<'n>(
    names: impl Iterator<Item = &'n str>,
    location: impl Fn(usize) -> Location,
    problems: &mut Vec<Problem>,
) {
    let mut seen = HashMap::new();
    for (index, name) in names.enumerate() {
        if let Some(first) = seen.insert(name.to_lowercase(), name) {
            let message = if first == name {
                format!("{name:?} is already the name of another")
            } else {
                format!("{name:?} differs from {first:?} by capitals alone; output files could not be told apart")
            };
            problems.push(Problem::of_key(location(index), "name", message));
        }
    }
}

/// Adds that there is no `what` of this name, with the one that was probably meant.
fn check_known(location: Location, key: &str, what: &str, name: &str, known: &[&str], problems: &mut Vec<Problem>) {
    if known.contains(&name) {
        return;
    }
    let suggestion = match problems.len() {
        ..MAX_SUGGESTIONS => did_you_mean(name, known.iter().copied()),
        _ => String::new(),
    };
    problems.push(Problem::of_key(location, key, format!("unknown {what} {name:?}{suggestion}")));
}
