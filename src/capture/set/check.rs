//! Checks of each part of a set by itself, for a file and for a set that the user edits in memory.

use firstbounce_core::denoise::MAX_RADIUS_PX;

use super::model::*;
use super::problem::{Location, Problem};
use super::rule::{MAX_ROUNDS, ROUNDS, Rule, VECTOR, WINDOW, is_vector, unusable_name};
use super::word::Word;

impl CaptureSet {
    /// Everything that keeps the set from being solved, part by part and then between the parts. Positions are absent:
    /// a set in memory has no lines.
    pub fn check(&self) -> Vec<Problem> {
        let mut problems = self.check_parts();
        problems.extend(self.check_consistency());
        problems
    }

    /// What is unusual but may be meant.
    pub fn warnings(&self) -> Vec<Problem> {
        let behind = |direction: &[f64; 3]| {
            (direction[2] <= 0.0).then(|| {
                format!(
                    "{direction:?} comes from behind the object; a direction points from the object to the light, and \
                     z to the camera"
                )
            })
        };
        let mut warnings = Vec::new();
        for (index, light) in self.lights.iter().enumerate() {
            let typed = light.direction.as_ref().and_then(behind);
            let near = light.position_mm.as_ref().and_then(behind);
            warnings.extend(typed.map(|message| Problem::of_key(Location::Light(index), "direction", message)));
            warnings.extend(near.map(|message| Problem::of_key(Location::Light(index), "position_mm", message)));
        }
        for (light, direction) in &self.calibration.direction {
            let key = format!("direction.{light}");
            warnings.extend(behind(direction).map(|message| Problem::of_key(Location::Calibration, key, message)));
        }
        warnings
    }

    /// The problems of each part by itself.
    pub(super) fn check_parts(&self) -> Vec<Problem> {
        let mut found = Found(Vec::new());
        if self.mask.as_ref().is_some_and(String::is_empty) {
            found.add(Location::Set, "mask", "expected a file path, found \"\"");
        }
        found.camera(&self.camera);
        for (index, colour) in self.colours.iter().enumerate() {
            found.name(Location::Colour(index), &colour.name);
        }
        for (index, light) in self.lights.iter().enumerate() {
            found.light(Location::Light(index), light);
        }
        for (index, shot) in self.shots.iter().enumerate() {
            found.shot(Location::Shot(index), shot);
        }
        for (index, sphere) in self.spheres.iter().enumerate() {
            found.sphere(Location::Sphere(index), sphere);
        }
        found.calibration(&self.calibration);
        if self.separation.bounces == Some(0) {
            found.add(Location::Separation, "bounces", "expected a whole number from 1, found 0");
        }
        found.shape(&self.shape);
        found.truth(&self.truth);
        found.0
    }
}

struct Found(Vec<Problem>);

impl Found {
    fn add(&mut self, location: Location, key: &str, message: impl Into<String>) {
        self.0.push(Problem::of_key(location, key, message));
    }

    fn number(&mut self, location: Location, key: &str, rule: Rule, number: f64) {
        if !rule.holds(number) {
            self.add(location, key, format!("expected {}, found {number}", rule.words()));
        }
    }

    fn maybe_number(&mut self, location: Location, key: &str, rule: Rule, number: Option<f64>) {
        if let Some(number) = number {
            self.number(location, key, rule, number);
        }
    }

    fn vector(&mut self, location: Location, key: &str, vector: &[f64; 3]) {
        if !is_vector(vector) {
            self.add(location, key, format!("expected {VECTOR}, found {vector:?}"));
        }
    }

    fn name(&mut self, location: Location, name: &str) {
        if let Some(reason) = unusable_name(name) {
            self.add(location, "name", reason);
        }
    }

    fn camera(&mut self, camera: &Camera) {
        let at = Location::Camera;
        match camera.projection {
            Projection::Orthographic { mm_per_pixel } => {
                self.maybe_number(at, "mm_per_pixel", Rule::Positive, mm_per_pixel);
            }
            Projection::Perspective { focal_length_px, principal_point, working_distance_mm } => {
                self.number(at, "focal_length_px", Rule::Positive, focal_length_px);
                for coordinate in principal_point.into_iter().flatten() {
                    self.number(at, "principal_point", Rule::Finite, coordinate);
                }
                self.number(at, "working_distance_mm", Rule::Positive, working_distance_mm);
            }
        }
        self.encoding(at, camera.encoding);
        let black = camera.black_level;
        self.number(at, "black_level", Rule::Finite, black);
        self.maybe_number(at, "white_level", Rule::Finite, camera.white_level);
        if let Some(white) = camera.white_level.filter(|white| *white <= black) {
            self.add(at, "white_level", format!("expected more than black_level {black}, found {white}"));
        }
        self.maybe_number(at, "full_well_electrons", Rule::Positive, camera.full_well_electrons);
        self.maybe_number(at, "read_noise_electrons", Rule::NotNegative, camera.read_noise_electrons);
        if camera.read_noise_electrons.is_some() && camera.full_well_electrons.is_none() {
            self.add(
                at,
                "read_noise_electrons",
                "needs full_well_electrons beside it, which scales electrons to light",
            );
        }
    }

    fn encoding(&mut self, location: Location, encoding: Encoding) {
        if let Encoding::Gamma(gamma) = encoding {
            self.number(location, "encoding", Rule::Positive, gamma);
        }
    }

    fn light(&mut self, location: Location, light: &Light) {
        self.name(location, &light.name);
        for (key, vector) in [("direction", &light.direction), ("position_mm", &light.position_mm)] {
            if let Some(vector) = vector {
                self.vector(location, key, vector);
            }
        }
        if light.direction.is_some() && light.position_mm.is_some() {
            self.add(location, "direction", "given beside position_mm, which already implies it; keep one of the two");
        }
    }

    fn shot(&mut self, location: Location, shot: &Shot) {
        let subject = shot.subject;
        for (key, naming, value) in
            [("light", subject.light(), &shot.light), ("colour", subject.colour(), &shot.colour)]
        {
            self.naming(location, subject, (key, naming), value.as_deref());
        }
        if shot.files.is_empty() {
            self.add(location, "files", "expected at least one file path, found none");
        }
        if shot.files.iter().any(String::is_empty) {
            self.add(location, "files", "expected file paths, found \"\"");
        }
        self.number(location, "exposure", Rule::Positive, shot.exposure);
        if let Some(encoding) = shot.encoding {
            self.encoding(location, encoding);
        }
    }

    fn naming(&mut self, at: Location, subject: Subject, (key, naming): (&str, Naming), value: Option<&str>) {
        let subject = subject.word();
        match (naming, value) {
            (Naming::Required, None) => self.add(at, key, format!("missing; a shot of {subject:?} needs one")),
            (Naming::Refused, Some(value)) => {
                self.add(at, key, format!("a shot of {subject:?} is taken without one; leave out {value:?}"));
            }
            _ => {}
        }
    }

    fn sphere(&mut self, location: Location, sphere: &Sphere) {
        match sphere.subject.sphere_kind() {
            Some(kind) if kind != sphere.kind => {
                let (subject, kind, found) = (sphere.subject.word(), kind.word(), sphere.kind.word());
                self.add(location, "kind", format!("expected {kind:?} in shots of {subject:?}, found {found:?}"));
            }
            None if sphere.subject != Subject::Object => {
                let found = sphere.subject.word();
                self.add(location, "subject", format!("expected shots that show a ball, found {found:?}"));
            }
            _ => {}
        }
        for coordinate in sphere.circle.centre {
            self.number(location, "centre", Rule::Finite, coordinate);
        }
        self.number(location, "radius", Rule::Positive, sphere.circle.radius);
    }

    fn calibration(&mut self, calibration: &Calibration) {
        let at = Location::Calibration;
        for beta in calibration.beta.iter().flatten() {
            self.number(at, "beta", Rule::Positive, *beta);
        }
        for (light, alphas) in &calibration.alpha {
            for alpha in alphas {
                self.number(at, &format!("alpha.{light}"), Rule::Positive, *alpha);
            }
        }
        for (light, direction) in &calibration.direction {
            self.vector(at, &format!("direction.{light}"), direction);
        }
        for (light, intensity) in &calibration.intensity {
            self.number(at, &format!("intensity.{light}"), Rule::Positive, *intensity);
        }
        self.maybe_number(at, "grey_albedo", Rule::Albedo, calibration.grey_albedo);
        self.maybe_number(at, "white_light", Rule::Positive, calibration.white_light);
    }

    fn shape(&mut self, shape: &ShapeSettings) {
        let at = Location::Shape;
        self.number(at, "shadow_share", Rule::Share, shape.shadow_share);
        self.number(at, "misfit_share", Rule::Share, shape.misfit_share);
        if !(1..=MAX_ROUNDS).contains(&shape.rounds) {
            self.add(at, "rounds", format!("expected {ROUNDS}, found {}", shape.rounds));
        }
        if shape.indirect_window_px > MAX_RADIUS_PX {
            self.add(at, "indirect_window_px", format!("expected {WINDOW}, found {}", shape.indirect_window_px));
        }
    }

    fn truth(&mut self, truth: &Truth) {
        for (key, path) in [("normals", &truth.normals), ("depth", &truth.depth)] {
            if path.is_empty() {
                self.add(Location::Truth, key, "expected a file path, found \"\"");
            }
        }
        if !truth.bounce.contains("{k}") {
            let found = &truth.bounce;
            self.add(
                Location::Truth,
                "bounce",
                format!("expected a file path with {{k}} for the bounce, found {found:?}"),
            );
        }
    }
}
