//! From rendered light to photos: exposure, crosstalk, the sensor, and the calibration balls.

use crate::{BallPicture, LampSpot, Sensor};
use firstbounce_core::light::scene::{LitPlanes, RenderReport, Rendering};
use firstbounce_core::sphere::{Ball, Circle, View};
use firstbounce_core::{Mask, Plane, Projection, Watch};

use super::write::RigRecord;
use super::{
    BallOptions, Exposure, PreparedScene, SimulateError, SimulateOptions, SimulateReport, Simulated, SimulatedTruth,
    StoredPhoto,
};
use firstbounce_capture::set::{self, CaptureSet, Channel, Colour, Light, Shot, Sphere, SphereKind, Subject, Word};

/// Radius of a ball over the side of its picture.
const BALL_RADIUS: f64 = 5.0 / 12.0;
/// Linear light of a lamp in a mirror: it clips.
const MIRRORED_LAMP: f64 = 3.0;
/// Linear light of the room in a mirror.
const MIRRORED_ROOM: f64 = 0.01;
/// Samples along each side of a pixel of a ball.
const BALL_SAMPLES: usize = 4;

/// Photographs the object and the balls.
pub(super) fn photograph(
    prepared: &PreparedScene,
    options: &SimulateOptions,
    rendering: Rendering,
    render: RenderReport,
    watch: &dyn Watch,
) -> Result<Simulated, SimulateError> {
    let studio = Studio::new(prepared, options, &rendering)?;
    let lights = options.lamps.len();
    let colours = options.albedos.len();
    let mut photos = Vec::new();
    let mut circles = Vec::new();
    let steps = (lights * 4) as f32;
    let mut done = 0.0;
    for subject in studio.subjects() {
        for l in 0..lights {
            if watch.cancelled() {
                return Err(SimulateError::Cancelled);
            }
            for (c, light) in studio.light(subject, l, &rendering.lights[l])?.iter().enumerate() {
                let colour = (!subject.is_shiny_ball()).then_some(c);
                let stream = (photos.len() + 1) as u64;
                let stored = studio.levels.stored(&options.sensor.expose(light, stream)?);
                photos.push(StoredPhoto { subject, light: l, colour, alone: None, stored });
            }
            done += 1.0;
            watch.progress(done / steps);
        }
        circles.extend(studio.sphere(subject));
    }

    if options.crosstalk_shots {
        for (lamp, c) in (0..colours).flat_map(|lamp| (0..colours).map(move |c| (lamp, c))) {
            let light = &studio.alone(lamp)?[c];
            let stored = studio.levels.stored(&options.sensor.expose(light, (photos.len() + 1) as u64)?);
            photos.push(StoredPhoto {
                subject: Subject::Crosstalk,
                light: 0,
                colour: Some(c),
                alone: Some(lamp),
                stored,
            });
        }
    }
    let set = capture_set(&studio, &photos, circles);
    if let Some(problem) = set.check().into_iter().next() {
        return Err(SimulateError::Set(problem));
    }
    let (indirect_share, clipped_pixels) =
        (indirect_share(&rendering), clipped_pixels(&photos, &rendering.mask, studio.levels.white));
    let mut warnings = Vec::new();
    if clipped_pixels > 0 {
        warnings.push(format!("up to {clipped_pixels} pixels of the object clip in a photo; lower the exposure"));
    }
    if options.crosstalk.is_some() {
        warnings.push("the truth is that of the lamps' own colours, without crosstalk".into());
    }
    if lights < 3 {
        warnings.push(format!("{lights} lights: bounces can be separated, but normals need three or more"));
    }
    if colours < 2 {
        warnings.push("one colour cannot separate bounces; give two albedos or more".into());
    }
    let report = SimulateReport {
        scene: options.scene.name().to_owned(),
        factors: prepared.report,
        render,
        indirect_share,
        clipped_pixels,
        warnings,
    };
    let scale = studio.scale as f32;
    let scaled_bounces = |light: &LitPlanes| light.bounces.iter().map(|bounce| scaled(bounce, scale)).collect();
    let truth = SimulatedTruth {
        bounces: rendering.lights.iter().map(scaled_bounces).collect(),
        rig: RigRecord::of(options, &studio.alpha, studio.scale),
        mask: rendering.mask,
        normals: rendering.normals,
        depth_mm: rendering.depth_mm,
    };
    Ok(Simulated { set, photos, truth, report })
}

/// What all photos share.
struct Studio<'a> {
    options: &'a SimulateOptions,
    projection: Projection,
    /// By lamp, then colour.
    alpha: Vec<Vec<f64>>,
    /// Linear light per unit of rendered light.
    scale: f64,
    levels: Levels,
}

impl<'a> Studio<'a> {
    fn new(
        prepared: &PreparedScene,
        options: &'a SimulateOptions,
        rendering: &Rendering,
    ) -> Result<Self, SimulateError> {
        let levels = Levels::of(&options.sensor);
        let studio =
            Self { options, projection: prepared.camera.projection, alpha: options.alpha(), scale: 1.0, levels };
        let scale = match options.exposure {
            Exposure::White(light) => light / options.lamps[0].intensity,
            Exposure::Brightest(light) => light / studio.brightest(rendering)?,
        };
        Ok(Self { scale, ..studio })
    }

    /// The brightest pixel of all photos but the mirror ball's, as the channels see it.
    fn brightest(&self, rendering: &Rendering) -> Result<f64, SimulateError> {
        let options = self.options;
        let mut brightest = f64::MIN_POSITIVE;
        for ((lamp, alpha), light) in options.lamps.iter().zip(&self.alpha).zip(&rendering.lights) {
            let object = light.all.iter().zip(alpha).map(|(plane, alpha)| scaled(plane, *alpha as f32)).collect();
            let mut subjects = vec![object];
            if let Some(balls) = options.balls {
                let facing = lamp.intensity * nearness(lamp, radius_mm(&self.projection, balls));
                let spot = |alpha: f64, albedo: f64| Plane::filled(1, 1, (facing * alpha * albedo) as f32);
                subjects.push(alpha.iter().map(|alpha| spot(*alpha, balls.grey_albedo)).collect());
                subjects
                    .push(alpha.iter().zip(&options.albedos).map(|(alpha, albedo)| spot(*alpha, *albedo)).collect());
            }
            for colours in subjects {
                brightest = self.mixed(colours)?.iter().map(largest).fold(brightest, f64::max);
            }
        }
        Ok(brightest)
    }

    /// What the channels see of the light of each colour.
    fn mixed(&self, colours: Vec<Plane>) -> Result<Vec<Plane>, SimulateError> {
        match &self.options.crosstalk {
            Some(crosstalk) => Ok(crosstalk.mix(&colours)?),
            None => Ok(colours),
        }
    }

    fn subjects(&self) -> Vec<Subject> {
        let balls = SphereKind::ALL.iter().filter(|_| self.options.balls.is_some()).map(|kind| kind.subject());
        std::iter::once(Subject::Object).chain(balls).collect()
    }

    /// Linear light of a subject under lamp `l`, in each colour; of a mirror ball in all together.
    fn light(&self, subject: Subject, l: usize, object: &LitPlanes) -> Result<Vec<Plane>, SimulateError> {
        let factors = self.alpha[l].iter().map(|alpha| alpha * self.scale);
        let colours: Vec<Plane> = match (subject, self.options.balls) {
            (Subject::Object, _) | (_, None) => {
                object.all.iter().zip(factors).map(|(plane, factor)| scaled(plane, factor as f32)).collect()
            }
            (_, Some(balls)) if subject.is_shiny_ball() => return Ok(vec![self.mirror_ball(balls, l)]),
            (_, Some(balls)) => {
                let lamp = self.options.lamps[l].lamp();
                let picture = self.ball(balls);
                let facing = picture.matt(&lamp.stereo(), lamp.intensity());
                let albedo = |c: usize| match subject {
                    Subject::MaterialSphere => self.options.albedos[c],
                    _ => balls.grey_albedo,
                };
                factors.enumerate().map(|(c, factor)| scaled(&facing, (factor * albedo(c)) as f32)).collect()
            }
        };
        self.mixed(colours)
    }

    /// The grey ball under the first light's lamp of one colour alone, in each channel.
    fn alone(&self, lamp: usize) -> Result<Vec<Plane>, SimulateError> {
        let Some(balls) = self.options.balls else { return Ok(Vec::new()) };
        let light = self.options.lamps[0].lamp();
        let facing = self.ball(balls).matt(&light.stereo(), light.intensity());
        let factor = |c: usize| if c == lamp { self.alpha[0][c] * self.scale * balls.grey_albedo } else { 0.0 };
        self.mixed((0..self.alpha[0].len()).map(|c| scaled(&facing, factor(c) as f32)).collect())
    }

    fn mirror_ball(&self, balls: BallOptions, l: usize) -> Plane {
        let lamp = &self.options.lamps[l];
        let spot = LampSpot { half_angle_deg: lamp.half_angle_deg(), light: MIRRORED_LAMP, room: MIRRORED_ROOM };
        self.ball(balls).mirror(&lamp.lamp().stereo(), &spot)
    }

    fn ball(&self, balls: BallOptions) -> BallPicture {
        let set::Circle { centre: [x, y], radius } = circle(balls);
        let circle = Circle { centre_px: (x, y), radius_px: radius };
        let size = (balls.size_px, balls.size_px);
        // As calibration will see it: a picture that holds the optical axis is seen along its rays.
        let view = match self.projection {
            Projection::Perspective { focal_length_px, principal_point_px, .. }
                if principal_point_px.0 < size.0 as f64 && principal_point_px.1 < size.1 as f64 =>
            {
                View::Perspective { focal_length_px, principal_point_px }
            }
            _ => View::Orthographic,
        };
        let radius_mm = radius_mm(&self.projection, balls);
        BallPicture { ball: Ball::new(circle, view), radius_mm, size, samples_per_pixel_side: BALL_SAMPLES }
    }

    fn sphere(&self, subject: Subject) -> Option<Sphere> {
        let (kind, balls) = (subject.sphere_kind()?, self.options.balls?);
        Some(Sphere { subject, kind, circle: circle(balls), diameter_mm: None })
    }
}

fn circle(balls: BallOptions) -> set::Circle {
    let side = balls.size_px as f64;
    set::Circle { centre: [side / 2.0; 2], radius: BALL_RADIUS * side }
}

/// The radius of a ball at the object's z = 0.
fn radius_mm(projection: &Projection, balls: BallOptions) -> f64 {
    let mm_per_pixel = match *projection {
        Projection::Orthographic { mm_per_pixel } => mm_per_pixel.unwrap_or(1.0),
        Projection::Perspective { focal_length_px, working_distance_mm, .. } => working_distance_mm / focal_length_px,
    };
    circle(balls).radius * mm_per_pixel
}

/// How much brighter a lamp is on the side of the ball that faces it than in its middle.
fn nearness(lamp: &super::LampOptions, radius_mm: f64) -> f64 {
    let distance_mm = lamp.lamp().position_mm().map(|position| position.coords.norm());
    distance_mm
        .filter(|distance| *distance > radius_mm)
        .map_or(1.0, |distance| (distance / (distance - radius_mm)).powi(2))
}

/// How stored values stand in a file. A mean of frames has finer steps than a frame: it is stored in 16 bits, whatever the
/// sensor has.
#[derive(Clone, Copy, Debug)]
struct Levels {
    factor: f32,
    black: f64,
    white: f64,
}

impl Levels {
    fn of(sensor: &Sensor) -> Self {
        let most = if sensor.frames > 1 { f64::from(u16::MAX) } else { sensor.white_level() };
        let factor = (most / sensor.white_level()).floor();
        Self { factor: factor as f32, black: factor * sensor.black_level, white: factor * sensor.white_level() }
    }

    /// Whole numbers.
    fn stored(self, stored: &Plane) -> Plane {
        let data = stored.data().iter().map(|value| (value * self.factor).round()).collect();
        Plane::from_vec(stored.width(), stored.height(), data).unwrap_or_else(|| stored.clone())
    }
}

fn capture_set(studio: &Studio, photos: &[StoredPhoto], spheres: Vec<Sphere>) -> CaptureSet {
    let options = studio.options;
    let sensor = &options.sensor;
    // A mean of n frames is a photo of n times the electrons.
    let frames = sensor.frames as f64;
    let has_noise = sensor.full_well_electrons.is_finite();
    let camera = set::Camera {
        projection: match studio.projection {
            Projection::Orthographic { mm_per_pixel } => set::Projection::Orthographic { mm_per_pixel },
            Projection::Perspective { focal_length_px, principal_point_px: (x, y), working_distance_mm } => {
                let principal_point = Some([x, y]);
                set::Projection::Perspective { focal_length_px, principal_point, working_distance_mm }
            }
        },
        black_level: studio.levels.black,
        white_level: Some(studio.levels.white),
        full_well_electrons: has_noise.then_some(sensor.full_well_electrons * frames),
        read_noise_electrons: has_noise.then_some(sensor.read_noise_electrons * frames.sqrt()),
        ..set::Camera::default()
    };
    let channels = if options.crosstalk_shots { [Channel::R, Channel::G, Channel::B] } else { [Channel::Grey; 3] };
    let channel = |c: usize| channels.get(c).copied().unwrap_or_default();
    let colour = |(c, name): (usize, &String)| Colour { name: name.clone(), channel: channel(c) };
    let light = |lamp: &super::LampOptions| Light {
        name: lamp.name.clone(),
        direction: None,
        position_mm: lamp.lamp().position_mm().map(|p| [p.x, p.y, p.z]),
    };
    // What alone says how dark the paint is, where the other method needs to know.
    let calibration =
        set::Calibration { grey_albedo: options.balls.map(|balls| balls.grey_albedo), ..set::Calibration::default() };
    let mut set = CaptureSet {
        name: options.name.clone(),
        calibration,
        mask: Some("mask.png".into()),
        camera,
        colours: options.colours.iter().enumerate().map(colour).collect(),
        lights: options.lamps.iter().map(light).collect(),
        spheres,
        ..CaptureSet::default()
    };
    // One shot for all channels of a photo under one lamp colour.
    let taken = photos.iter().filter(|photo| photo.alone.is_none() || photo.colour == Some(0));
    set.shots = taken.map(|photo| shot(&set, photo)).collect();
    set
}

fn shot(set: &CaptureSet, photo: &StoredPhoto) -> Shot {
    let light = set.lights[photo.light].name.clone();
    let colour = photo.colour.map(|c| set.colours[c].name.clone());
    let files = vec![file_name(set, photo)];
    let colour = photo.alone.map(|lamp| set.colours[lamp].name.clone()).or(colour);
    Shot { subject: photo.subject, light: Some(light), colour, files, ..Shot::default() }
}

/// Where the photo lies in the set's folder: colours that are channels of one photo have one file.
pub(super) fn file_name(set: &CaptureSet, photo: &StoredPhoto) -> String {
    let light = &set.lights[photo.light].name;
    let named = |c: usize| format!("-{}", set.colours[c].name);
    let is_channel = |c: &usize| set.colours[*c].channel != Channel::Grey;
    let end = photo.alone.map(named).or_else(|| photo.colour.filter(|c| !is_channel(c)).map(named));
    format!("{}/{light}{}.png", photo.subject, end.unwrap_or_default())
}

fn indirect_share(rendering: &Rendering) -> f64 {
    let sum = |plane: &Plane| plane.data().iter().map(|&value| f64::from(value)).sum::<f64>();
    let (direct, all) = rendering
        .lights
        .iter()
        .fold((0.0, 0.0), |(direct, all), light| (direct + sum(&light.bounces[0]), all + sum(&light.all[0])));
    if all > 0.0 { 1.0 - direct / all } else { 0.0 }
}

fn clipped_pixels(photos: &[StoredPhoto], mask: &Mask, white: f64) -> usize {
    let object = photos.iter().filter(|photo| photo.subject == Subject::Object);
    let clipped = |photo: &StoredPhoto| {
        let pixels = photo.stored.data().iter().zip(mask.data());
        pixels.filter(|&(&value, &inside)| inside && f64::from(value) >= white).count()
    };
    object.map(clipped).max().unwrap_or(0)
}

fn scaled(plane: &Plane, factor: f32) -> Plane {
    let data = plane.data().iter().map(|value| value * factor).collect();
    Plane::from_vec(plane.width(), plane.height(), data).unwrap_or_else(|| plane.clone())
}

fn largest(plane: &Plane) -> f64 {
    plane.data().iter().copied().fold(0.0_f32, f32::max).into()
}
