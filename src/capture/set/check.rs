//! Checks of each part of a set by itself, for a file and for a set that the user edits in memory.

use super::model::*;
use super::number::{Number, is_vector, short, vector_words};
use super::problem::{Location, Problem};
use super::rule::unusable_name;
use super::word::Word;

/// How far the levels of a camera lie apart at least, as a share of the larger one: light is computed from their
/// difference in single precision.
const MIN_LEVELS_APART: f64 = 1e-4;

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
        found.maybe_number(Location::Separation, "bounces", Number::Bounces, self.separation.bounces.map(|m| m as f64));
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

    fn number(&mut self, location: Location, key: &str, number: Number, value: f64) {
        if !number.allows(value) {
            self.add(location, key, format!("expected {}, found {}", number.words(), short(value)));
        }
    }

    fn maybe_number(&mut self, location: Location, key: &str, number: Number, value: Option<f64>) {
        if let Some(value) = value {
            self.number(location, key, number, value);
        }
    }

    fn vector(&mut self, location: Location, key: &str, component: Number, vector: &[f64; 3]) {
        if !is_vector(component, vector) {
            self.add(location, key, format!("expected {}, found {vector:?}", vector_words(component)));
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
                self.maybe_number(at, "mm_per_pixel", Number::MmPerPixel, mm_per_pixel);
            }
            Projection::Perspective { focal_length_px, principal_point, working_distance_mm } => {
                self.number(at, "focal_length_px", Number::FocalLengthPx, focal_length_px);
                for coordinate in principal_point.into_iter().flatten() {
                    self.number(at, "principal_point", Number::PrincipalPoint, coordinate);
                }
                self.number(at, "working_distance_mm", Number::WorkingDistanceMm, working_distance_mm);
            }
        }
        for coefficient in camera.distortion.into_iter().flatten() {
            self.number(at, "distortion", Number::Distortion, coefficient);
        }
        self.encoding(at, camera.encoding);
        let black = camera.black_level;
        self.number(at, "black_level", Number::BlackLevel, black);
        self.maybe_number(at, "white_level", Number::WhiteLevel, camera.white_level);
        if let Some(white) = camera.white_level {
            self.levels(black, white);
        }
        self.maybe_number(at, "full_well_electrons", Number::FullWellElectrons, camera.full_well_electrons);
        self.maybe_number(at, "read_noise_electrons", Number::ReadNoiseElectrons, camera.read_noise_electrons);
        for share in camera.crosstalk.iter().flatten().flatten() {
            self.number(at, "crosstalk", Number::Crosstalk, *share);
        }
        match (camera.read_noise_electrons, camera.full_well_electrons) {
            (Some(_), None) => {
                let message = "needs full_well_electrons beside it, which scales electrons to light";
                self.add(at, "read_noise_electrons", message);
            }
            (Some(read), Some(full)) if read >= full => {
                let message = format!("expected less than full_well_electrons {}, found {}", short(full), short(read));
                self.add(at, "read_noise_electrons", message);
            }
            _ => {}
        }
    }

    fn levels(&mut self, black: f64, white: f64) {
        let message = if white <= black {
            format!("expected more than black_level {}, found {}", short(black), short(white))
        } else if white - black < MIN_LEVELS_APART * white.abs().max(black.abs()) {
            format!("{} is too near to black_level {} to tell light from none", short(white), short(black))
        } else {
            return;
        };
        self.add(Location::Camera, "white_level", message);
    }

    fn encoding(&mut self, location: Location, encoding: Option<Encoding>) {
        if let Some(Encoding::Gamma(gamma)) = encoding {
            self.number(location, "encoding", Number::Gamma, gamma);
        }
    }

    fn light(&mut self, location: Location, light: &Light) {
        self.name(location, &light.name);
        if let Some(direction) = &light.direction {
            self.vector(location, "direction", Number::Direction, direction);
        }
        if let Some(position) = &light.position_mm {
            self.vector(location, "position_mm", Number::PositionMm, position);
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
        self.maybe_number(location, "exposure", Number::Exposure, shot.exposure);
        self.exposures(location, shot);
        self.encoding(location, shot.encoding);
    }

    fn exposures(&mut self, location: Location, shot: &Shot) {
        let (found, files) = (shot.exposures.len(), shot.files.len());
        if found > 0 && found != files {
            let words = format!("expected one exposure for each of the {files} files, found {found}");
            self.add(location, "exposures", words);
        }
        if found > 0 && shot.exposure.is_some() {
            self.add(location, "exposures", "a shot has one exposure or exposures by file: leave one of the two out");
        }
        for exposure in &shot.exposures {
            self.number(location, "exposures", Number::Exposure, *exposure);
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
            self.number(location, "centre", Number::Centre, coordinate);
        }
        self.number(location, "radius", Number::Radius, sphere.circle.radius);
        self.maybe_number(location, "diameter_mm", Number::DiameterMm, sphere.diameter_mm);
    }

    fn calibration(&mut self, calibration: &Calibration) {
        let at = Location::Calibration;
        for beta in calibration.beta.iter().flatten() {
            self.number(at, "beta", Number::Beta, *beta);
        }
        for (light, alphas) in &calibration.alpha {
            for alpha in alphas {
                self.number(at, &format!("alpha.{light}"), Number::Alpha, *alpha);
            }
        }
        for (light, direction) in &calibration.direction {
            self.vector(at, &format!("direction.{light}"), Number::Direction, direction);
        }
        for (light, intensity) in &calibration.intensity {
            self.number(at, &format!("intensity.{light}"), Number::Intensity, *intensity);
        }
        self.maybe_number(at, "grey_albedo", Number::GreyAlbedo, calibration.grey_albedo);
        self.maybe_number(at, "white_light", Number::WhiteLight, calibration.white_light);
    }

    fn shape(&mut self, shape: &ShapeSettings) {
        let at = Location::Shape;
        self.number(at, "shadow_share", Number::ShadowShare, shape.shadow_share);
        self.number(at, "misfit_share", Number::MisfitShare, shape.misfit_share);
        self.number(at, "rounds", Number::Rounds, shape.rounds as f64);
        self.number(at, "indirect_window_px", Number::IndirectWindowPx, shape.indirect_window_px as f64);
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
