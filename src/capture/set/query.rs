//! Questions that the rest of the program asks of a capture set.

use std::path::{Path, PathBuf};

use firstbounce_core::image::distortion::Lens;
use indexmap::IndexMap;

use super::found::as_windows_finds;
use super::method::Method;
use super::model::*;
use super::number::length;
use super::word::Word;

impl CaptureSet {
    /// The name, or the folder's where the file gives none.
    pub fn title(&self) -> String {
        if !self.name.is_empty() {
            return self.name.clone();
        }
        self.folder.file_name().map_or_else(|| "Untitled".into(), |name| name.to_string_lossy().into_owned())
    }

    /// Where a path that the file writes lies: relative ones start from the set's folder. Where nothing of that name is
    /// there, the one file that Windows would take for it.
    pub fn resolve(&self, written: &str) -> PathBuf {
        as_windows_finds(self.folder.join(written))
    }

    /// How the file writes a path: from the set's folder where it lies below it, with slashes on every system.
    pub fn written(&self, path: &Path) -> String {
        path.strip_prefix(&self.folder).unwrap_or(path).to_string_lossy().replace('\\', "/")
    }

    /// The index of the light of this name.
    pub fn light_index(&self, name: &str) -> Option<usize> {
        self.lights.iter().position(|light| light.name == name)
    }

    /// The index of the colour of this name; 0 is the reference colour.
    pub fn colour_index(&self, name: &str) -> Option<usize> {
        self.colours.iter().position(|colour| colour.name == name)
    }

    /// How direct light is told from indirect light: what the file says, or colours and shape together where there are two
    /// colours.
    pub fn method(&self) -> Method {
        let default = if self.colours.len() < 2 { Method::Colours } else { Method::ColoursAndShape };
        self.separation.method.unwrap_or(default)
    }

    /// The order m: what the file says, or two bounces where there are two colours: each further order costs
    /// far more noise than the light it accounts for.
    pub fn bounces(&self) -> usize {
        self.separation.bounces.unwrap_or(self.colours.len().min(2))
    }

    /// What the set shows, each subject once, in the order of [`Subject`].
    pub fn subjects(&self) -> Vec<Subject> {
        let mut subjects: Vec<Subject> = self.shots.iter().map(|shot| shot.subject).collect();
        subjects.sort_unstable();
        subjects.dedup();
        subjects
    }

    /// The set without some lights, by their names.
    pub fn without_lights(&self, lights: &[String]) -> Self {
        let stays = |light: &String| !lights.contains(light);
        let mut set = self.clone();
        set.lights.retain(|light| stays(&light.name));
        set.shots.retain(|shot| shot.light.as_ref().is_none_or(stays));
        set.calibration.alpha.retain(|light, _| stays(light));
        set.calibration.direction.retain(|light, _| stays(light));
        set.calibration.intensity.retain(|light, _| stays(light));
        set.shape.leave_out.retain(stays);
        set
    }

    /// The set as far as its photos are on the disk: without shots whose files are missing, and without lights under which the object is
    /// not there in every colour. The missing files, as written, come beside.
    pub fn present(&self) -> (Self, Vec<String>) {
        let is_there = |file: &String| self.resolve(file).is_file();
        let missing = self.distinct_files().into_keys().map(str::to_owned).filter(|file| !is_there(file)).collect();
        let mut set = self.clone();
        set.shots.retain(|shot| shot.files.iter().all(is_there));
        let is_complete = |light: &str| {
            let has = |colour: &Colour| set.shot(Subject::Object, Some(light), Some(&colour.name)).is_some();
            self.colours.iter().all(has)
        };
        let lights = self.lights.iter().map(|light| light.name.clone());
        let incomplete: Vec<String> = lights.filter(|light| !is_complete(light)).collect();
        (set.without_lights(&incomplete), missing)
    }

    /// The set with its reference colour alone.
    pub fn in_one_colour(&self) -> Self {
        let reference = self.colours.first().map(|colour| colour.name.clone());
        let mut set = self.clone();
        set.colours.truncate(1);
        set.shots.retain(|shot| shot.colour.is_none() || shot.colour == reference);
        set.camera.crosstalk = None;
        set.shots.retain(|shot| shot.subject != Subject::Crosstalk);
        set.calibration.beta = None;
        set.calibration.alpha.clear();
        set.separation = Separation::default();
        set
    }

    /// The shot of `subject` under this light in this colour.
    pub fn shot(&self, subject: Subject, light: Option<&str>, colour: Option<&str>) -> Option<&Shot> {
        self.shots_of(subject).find(|shot| shot.light.as_deref() == light && shot.colour.as_deref() == colour)
    }

    /// Every shot of `subject`, in the order of the file.
    pub fn shots_of(&self, subject: Subject) -> impl Iterator<Item = &Shot> {
        self.shots.iter().filter(move |shot| shot.subject == subject)
    }

    /// The encoding that is stated of a shot's files: its own or the camera's.
    pub fn encoding_of(&self, shot: &Shot) -> Option<Encoding> {
        shot.encoding.or(self.camera.encoding)
    }

    /// The layer of a shot's files: its own or the camera's.
    pub fn layer_of<'s>(&'s self, shot: &'s Shot) -> Option<&'s str> {
        shot.layer.as_deref().or(self.camera.layer.as_deref())
    }

    /// Whether light is taken from one channel to another: the file gives crosstalk, or shots show it.
    pub fn has_crosstalk(&self) -> bool {
        self.camera.crosstalk.is_some() || self.shots_of(Subject::Crosstalk).next().is_some()
    }

    /// Whether photos of the object hold several colours, each in a channel.
    pub fn has_rgb_photos(&self) -> bool {
        let of_object = || self.shots_of(Subject::Object);
        let shares = |shot: &Shot| {
            of_object()
                .any(|other| other.files == shot.files && other.light == shot.light && other.colour != shot.colour)
        };
        of_object().next().is_some_and(shares)
    }

    /// The channel of a shot's files that holds its colour; the mean of all where it names none.
    pub fn channel_of(&self, shot: &Shot) -> Channel {
        let colour = shot.colour.as_deref().and_then(|name| self.colours.get(self.colour_index(name)?));
        colour.map_or(Channel::Grey, |colour| colour.channel)
    }

    /// Every file that shots name, once, with the indices of those shots: an RGB photo that is several colour captures
    /// is read once.
    pub fn distinct_files(&self) -> IndexMap<&str, Vec<usize>> {
        let mut files: IndexMap<&str, Vec<usize>> = IndexMap::new();
        for (index, shot) in self.shots.iter().enumerate() {
            for file in &shot.files {
                files.entry(file).or_default().push(index);
            }
        }
        files
    }

    /// The circles in the pictures of `subject`; for [`Subject::Object`] those of balls in the scene.
    pub fn spheres_in(&self, subject: Subject) -> impl Iterator<Item = &Sphere> {
        self.spheres.iter().filter(move |sphere| sphere.subject == subject)
    }

    /// The circle of a ball of this kind in the pictures of `subject`.
    pub fn circle(&self, subject: Subject, kind: SphereKind) -> Option<Circle> {
        self.spheres_in(subject).find(|sphere| sphere.kind == kind).map(|sphere| sphere.circle)
    }

    /// Where a ball of this kind is seen: in shots of its own, or in the object's scene; `None` where the set has none.
    pub fn subject_with(&self, kind: SphereKind) -> Option<Subject> {
        let own = kind.subject();
        let alone = self.shots_of(own).next().map(|_| own);
        alone.or_else(|| self.circle(Subject::Object, kind).map(|_| Subject::Object))
    }

    /// Whether the set shows a ball that gives this value.
    pub fn has_ball_for(&self, value: BallValue) -> bool {
        SphereKind::ALL.iter().any(|kind| kind.gives(value) && self.subject_with(*kind).is_some())
    }

    /// Puts the circle of a ball, in place of one of the same subject and kind if there is one. The ball keeps its diameter.
    pub fn put_sphere(&mut self, sphere: Sphere) {
        match self.spheres.iter_mut().find(|old| (old.subject, old.kind) == (sphere.subject, sphere.kind)) {
            Some(old) => *old = Sphere { diameter_mm: sphere.diameter_mm.or(old.diameter_mm), ..sphere },
            None => self.spheres.push(sphere),
        }
    }

    /// The unit direction to a light that the file gives, typed at the light or else under `[calibration]`.
    pub fn given_direction(&self, light: &str) -> Option<[f64; 3]> {
        let typed = self.lights.get(self.light_index(light)?)?.direction;
        let direction = typed.or_else(|| self.calibration.direction.get(light).copied())?;
        let length = length(&direction);
        (length > 0.0).then(|| direction.map(|x| x / length))
    }

    /// mm that a pixel spans at the object's z = 0: what the camera says, else what balls of known diameter say; `None` where neither
    /// does.
    pub fn mm_per_pixel(&self) -> Option<f64> {
        match self.camera.projection {
            Projection::Orthographic { mm_per_pixel: None } => self.mm_per_pixel_of_balls(),
            Projection::Orthographic { mm_per_pixel } => mm_per_pixel,
            Projection::Perspective { focal_length_px, working_distance_mm, .. } => {
                Some(working_distance_mm / focal_length_px)
            }
        }
    }

    /// The same as all balls of known diameter say together; `None` where there is none.
    pub fn mm_per_pixel_of_balls(&self) -> Option<f64> {
        let scales =
            self.spheres.iter().filter_map(|sphere| Some((self.mm_per_pixel_of(sphere)?, sphere.circle.radius)));
        // The larger a circle, the better it says.
        let (sum, weight) = scales.fold((0.0, 0.0), |(sum, all), (scale, weight)| (sum + weight * scale, all + weight));
        (weight > 0.0).then(|| sum / weight)
    }

    /// The same as one ball says; `None` without its diameter.
    pub fn mm_per_pixel_of(&self, sphere: &Sphere) -> Option<f64> {
        let (diameter_mm, radius_px) = (sphere.diameter_mm?, sphere.circle.radius);
        if radius_px <= 0.0 {
            return None;
        }
        let scale = diameter_mm / (2.0 * radius_px);
        Some(match self.camera.projection {
            Projection::Orthographic { .. } => scale,
            // The outline of a ball at distance d has the radius f R / sqrt(d^2 - R^2).
            Projection::Perspective { focal_length_px, .. } => scale.hypot(diameter_mm / (2.0 * focal_length_px)),
        })
    }

    /// Where the true normals lie.
    pub fn truth_normals(&self) -> PathBuf {
        self.resolve(&self.truth.normals)
    }

    /// Where the true depth lies.
    pub fn truth_depth(&self) -> PathBuf {
        self.resolve(&self.truth.depth)
    }

    /// Where the true light of bounce `k`, counted from 1, lies under the light of this name.
    pub fn truth_bounce(&self, k: usize, light: &str) -> PathBuf {
        self.resolve(&self.truth.bounce.replace("{k}", &k.to_string()).replace("{light}", light))
    }

    /// Adds the light and the colour of these names where the set has none.
    pub fn know_names(&mut self, light: Option<&str>, colour: Option<&str>) {
        if let Some(name) = light.filter(|name| self.light_index(name).is_none()) {
            self.lights.push(Light { name: name.to_owned(), ..Light::default() });
        }
        if let Some(name) = colour.filter(|name| self.colour_index(name).is_none()) {
            self.colours.push(Colour { name: name.to_owned(), channel: Channel::Grey });
        }
    }

    /// Gives a light another name wherever the set uses it.
    pub fn rename_light(&mut self, index: usize, name: &str) {
        let Some(light) = self.lights.get_mut(index) else { return };
        let old = std::mem::replace(&mut light.name, name.to_owned());
        for shot in self.shots.iter_mut().filter(|shot| shot.light.as_ref() == Some(&old)) {
            shot.light = Some(name.to_owned());
        }
        rename_key(&mut self.calibration.alpha, &old, name);
        rename_key(&mut self.calibration.direction, &old, name);
        rename_key(&mut self.calibration.intensity, &old, name);
        self.shape.leave_out.iter_mut().filter(|light| **light == old).for_each(|light| *light = name.to_owned());
    }

    /// Gives a colour another name wherever the set uses it.
    pub fn rename_colour(&mut self, index: usize, name: &str) {
        let Some(colour) = self.colours.get_mut(index) else { return };
        let old = std::mem::replace(&mut colour.name, name.to_owned());
        for shot in self.shots.iter_mut().filter(|shot| shot.colour.as_ref() == Some(&old)) {
            shot.colour = Some(name.to_owned());
        }
    }
}

fn rename_key<T>(table: &mut IndexMap<String, T>, old: &str, new: &str) {
    if let Some(value) = table.shift_remove(old) {
        table.insert(new.to_owned(), value);
    }
}

impl Camera {
    /// The lens whose distortion is undone in pictures of this size; `None` for a pinhole, and for cut-outs that do not hold the
    /// optical axis.
    pub fn lens(&self, (width, height): (usize, usize)) -> Option<Lens> {
        let coefficients = self.distortion.filter(|coefficients| coefficients.iter().any(|k| *k != 0.0))?;
        let Projection::Perspective { focal_length_px, principal_point, .. } = self.projection else { return None };
        let (width, height) = (width as f64, height as f64);
        let [x, y] = principal_point.unwrap_or([width / 2.0, height / 2.0]);
        let holds_axis = (0.0..width).contains(&x) && (0.0..height).contains(&y);
        holds_axis.then_some(Lens { focal_length_px, principal_point_px: (x, y), coefficients })
    }
}

impl Shot {
    /// Which one in a sentence: `"object", light "left", colour "blue"`.
    pub fn described(&self) -> String {
        let mut words = format!("{:?}", self.subject.word());
        for (what, name) in [("light", &self.light), ("colour", &self.colour)] {
            if let Some(name) = name {
                words += &format!(", {what} {name:?}");
            }
        }
        words
    }
}
