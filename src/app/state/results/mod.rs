//! What is computed from the document: stage by stage, off the UI thread, the last good result kept until the new one is
//! there.

mod depends;
mod finished;
mod live;
mod nayar;
mod outcome;
mod pictures;
mod run;
mod stage;

use std::cell::RefCell;
use std::sync::Arc;
use std::time::{Duration, Instant};

use firstbounce_capture::pipeline::{Calibrated, Preference, Separated};
use firstbounce_core::Mesh;

use crate::app::base::jobs::{Jobs, Task, drop_aside};
use crate::app::state::document::Document;
use crate::app::state::log::Level;

pub use finished::Finished;
pub use live::Rig;
pub use nayar::ByNayar;
pub use pictures::{MarksName, Pictures, PlaneName, ShotName, Stored, When};
pub use run::{Loaded, LoadedShot, Shapes};
pub use stage::{StageState, Step};

use depends::Keys;
use outcome::Outcome;
use pictures::Batch;
use stage::Slot;

/// Work starts when the document has been left alone for so long: a drag would otherwise start it anew every frame.
const SETTLE: Duration = Duration::from_millis(150);
/// What every step of a set says that is still empty.
pub const NO_PHOTOS: &str = "no photos yet: drop files on this window, or choose them in Captures";
const CANCELLED: &str = "cancelled; \"Compute again what failed\" (F9) starts it anew";

/// A calibration and the names it counts by.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// Names of the lights.
    pub lights: Vec<String>,
    /// Names of the colours.
    pub colours: Vec<String>,
    /// The values.
    pub calibrated: Calibrated,
    /// What the file gave when they were measured.
    given: Given,
}

/// What a set's file gives of a rig.
#[derive(Clone, Debug, Default, PartialEq)]
struct Given {
    values: firstbounce_capture::set::Calibration,
    lights: Vec<firstbounce_capture::set::Light>,
}

/// Before and after as triangles.
#[derive(Clone, Debug)]
pub struct Meshes {
    /// From bounce 1.
    pub after: Mesh,
    /// From the photos as they are.
    pub before: Mesh,
}

/// Every stage.
#[derive(Default)]
pub struct Results {
    load: Slot<depends::LoadKey, Loaded>,
    measure: Slot<depends::MeasureKey, Calibration>,
    calibrate: Slot<depends::CalibrateKey, Calibration>,
    separate: Slot<depends::SeparateKey, Separated>,
    shape: Slot<depends::ShapeKey, Shapes>,
    mesh: Slot<depends::MeshKey, Meshes>,
    nayar: Slot<depends::NayarKey, ByNayar>,
    running: Option<Running>,
    pictures: Pictures,
    /// Counts the requests to read every file anew.
    reloads: u64,
    settling: Option<(Arc<Document>, Instant)>,
    /// The keys that were asked for last: every panel asks for them in every frame.
    keys: RefCell<Option<(Document, Arc<Keys>)>>,
}

struct Running {
    step: Step,
    keys: Arc<Keys>,
    task: Task<Outcome>,
    /// Whether an edit cancelled it, and not a person.
    superseded: bool,
}

/// What a frame of the engine asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// Nothing to do until something changes.
    Rest,
    /// Call again after this time.
    Again(Duration),
}

impl Results {
    /// The photos, once they were read.
    pub fn loaded(&self) -> Option<Arc<Loaded>> {
        self.load.last.clone()
    }

    /// The rig in force: what the file gives, and what the balls say where it gives nothing.
    pub fn calibration(&self) -> Option<Arc<Calibration>> {
        self.calibrate.last.clone()
    }

    /// What the balls alone say, whatever the file gives.
    pub fn measured(&self) -> Option<Arc<Calibration>> {
        self.measure.last.clone()
    }

    /// The bounces, as they would be saved.
    pub fn separated(&self) -> Option<Arc<Separated>> {
        self.separate.last.clone()
    }

    /// Normals and depth, before and after.
    pub fn shapes(&self) -> Option<Arc<Shapes>> {
        self.shape.last.clone()
    }

    /// Triangles, before and after.
    pub fn meshes(&self) -> Option<Arc<Meshes>> {
        self.mesh.last.clone()
    }

    /// The same, where they are those of the document.
    pub fn current_meshes(&self, document: &Document) -> Option<Arc<Meshes>> {
        self.meshes().filter(|_| self.state(Step::Mesh, document) == StageState::Ready)
    }

    /// What Nayar's method found, where it was asked for.
    pub fn by_nayar(&self) -> Option<Arc<ByNayar>> {
        self.nayar.last.clone()
    }

    /// Every plane that can be shown.
    pub fn pictures(&self) -> &Pictures {
        &self.pictures
    }

    /// How a stage stands with respect to this document.
    pub fn state(&self, step: Step, document: &Document) -> StageState {
        let keys = self.keys(document);
        if let Some(running) = self.running.as_ref().filter(|running| running.step == step && running.keys == keys) {
            return StageState::Running { fraction: running.task.job().fraction() };
        }
        let own = match step {
            Step::Load => self.load.state(Some(&keys.load)),
            Step::Measure => self.measure.state(keys.measure.as_ref()),
            Step::Calibrate => self.calibrate.state(keys.calibrate.as_ref()),
            Step::Separate => self.separate.state(keys.separate.as_ref()),
            Step::Shape => self.shape.state(keys.shape.as_ref()),
            Step::Mesh => self.mesh.state(keys.mesh.as_ref()),
            Step::Nayar => self.nayar.state(keys.nayar.as_ref()),
        };
        match (own, step.needs()) {
            (StageState::Blocked { .. }, Some(before)) => match self.state(before, document) {
                StageState::Failed { line } => StageState::Blocked { line: format!("{before} failed: {line}") },
                StageState::Blocked { line } => StageState::Blocked { line },
                StageState::Running { .. } | StageState::Stale => StageState::Stale,
                StageState::Ready => StageState::Blocked { line: self.why_blocked(step, document) },
            },
            (state, _) => state,
        }
    }

    /// Reads every file anew.
    pub fn reload(&mut self) {
        self.reloads += 1;
        self.keys.take();
    }

    /// Tries again what failed or was cancelled.
    pub fn retry(&mut self) {
        self.load.retry();
        self.measure.retry();
        self.calibrate.retry();
        self.separate.retry();
        self.shape.retry();
        self.mesh.retry();
        self.nayar.retry();
        self.keys.take();
    }

    /// Forgets everything: another set was opened.
    pub fn clear(&mut self) {
        if let Some(running) = &self.running {
            running.task.job().cancel();
        }
        let reloads = self.reloads + 1;
        drop_aside(std::mem::replace(self, Self { reloads, ..Self::default() }));
    }

    /// Takes what is finished and starts what is stale. Once a frame; `log` is told of every stage that ended.
    pub fn update(&mut self, document: &Arc<Document>, jobs: &mut Jobs, log: &mut dyn FnMut(Level, String)) -> Next {
        self.take_finished(log);
        let keys = self.keys(document);
        if let Some(running) = &mut self.running {
            if running.keys.upto(running.step) != keys.upto(running.step) {
                running.superseded = true;
                running.task.job().cancel();
            }
            return Next::Rest;
        }
        let Some(step) = self.first_stale(&keys) else {
            self.settling = None;
            return Next::Rest;
        };
        match &self.settling {
            Some((known, since)) if Arc::ptr_eq(known, document) => {
                if let Some(left) = SETTLE.checked_sub(since.elapsed()).filter(|left| !left.is_zero()) {
                    return Next::Again(left);
                }
            }
            Some(_) => {
                self.settling = Some((document.clone(), Instant::now()));
                return Next::Again(SETTLE);
            }
            // The first stale stage after a rest waits too, unless nothing was ever computed.
            None => {
                self.settling = Some((document.clone(), Instant::now()));
                if self.load.last.is_some() {
                    return Next::Again(SETTLE);
                }
            }
        }
        if let Some(task) = self.start(step, &keys, document, jobs) {
            self.running = Some(Running { step, keys, task, superseded: false });
        }
        Next::Rest
    }

    /// Whether every stage that can be computed is.
    pub fn is_at_rest(&self, document: &Document) -> bool {
        self.running.is_none() && self.first_stale(&self.keys(document)).is_none()
    }

    fn keys(&self, document: &Document) -> Arc<Keys> {
        let mut known = self.keys.borrow_mut();
        match &*known {
            Some((of, keys)) if of == document => keys.clone(),
            _ => {
                let keys = Arc::new(Keys::of(document, self));
                *known = Some((document.clone(), keys.clone()));
                keys
            }
        }
    }

    fn first_stale(&self, keys: &Keys) -> Option<Step> {
        let stale = |step: Step| match step {
            Step::Load => self.load.is_stale(Some(&keys.load)),
            Step::Measure => self.measure.is_stale(keys.measure.as_ref()),
            Step::Calibrate => self.calibrate.is_stale(keys.calibrate.as_ref()),
            Step::Separate => self.separate.is_stale(keys.separate.as_ref()),
            Step::Shape => self.shape.is_stale(keys.shape.as_ref()),
            Step::Mesh => self.mesh.is_stale(keys.mesh.as_ref()),
            Step::Nayar => self.nayar.is_stale(keys.nayar.as_ref()),
        };
        Step::ALL.into_iter().find(|&step| stale(step))
    }

    fn start(&self, step: Step, keys: &Keys, document: &Arc<Document>, jobs: &mut Jobs) -> Option<Task<Outcome>> {
        let document = document.clone();
        let name = step.job_name();
        Some(match step {
            Step::Load => {
                let key = keys.load.clone();
                jobs.start(name, move |job| {
                    let loaded = run::load(&document.set, job);
                    Ok(Outcome::Load(key, loaded.map(|loaded| with_batch(loaded, Batch::of_loaded))))
                })
            }
            Step::Measure => {
                let (key, loaded) = (keys.measure.clone()?, self.loaded()?);
                jobs.start(name, move |job| {
                    let measured = run::calibration(&key.set, Preference::Balls, &loaded, job);
                    Ok(Outcome::Measure(key, measured))
                })
            }
            Step::Calibrate => {
                let (key, loaded) = (keys.calibrate.clone()?, self.loaded()?);
                jobs.start(name, move |job| {
                    let calibrated = run::calibration(&key.set, Preference::File, &loaded, job);
                    Ok(Outcome::Calibrate(key, calibrated))
                })
            }
            Step::Separate => {
                let (key, loaded, calibration) = (keys.separate.clone()?, self.loaded()?, self.calibration()?);
                jobs.start(name, move |job| {
                    let separated = run::separate(&document.set, &loaded, &calibration, key.bounces, job);
                    let batch = |separated: &Separated| Batch::of_separated(&key.lights, separated);
                    let separated = separated.map(|separated| with_batch(separated, batch));
                    Ok(Outcome::Separate(key, separated))
                })
            }
            Step::Shape => {
                let key = keys.shape.clone()?;
                let (loaded, calibration, separated) = (self.loaded()?, self.calibration()?, self.separated()?);
                jobs.start(name, move |job| {
                    let shapes = run::shape(&document, &loaded, &calibration, &separated, job);
                    let batch = |shapes: &Shapes| Batch::of_shapes(&key.lights, shapes);
                    let shapes = shapes.map(|shapes| Box::new(with_batch(shapes, batch)));
                    Ok(Outcome::Shape(key, shapes))
                })
            }
            Step::Mesh => {
                let (key, shapes) = (keys.mesh.clone()?, self.shapes()?);
                jobs.start(name, move |_| Ok(Outcome::Mesh(key, run::meshes(&document.set, &shapes))))
            }
            Step::Nayar => {
                let key = keys.nayar.clone()?;
                let (loaded, calibration, shapes) = (self.loaded()?, self.calibration()?, self.shapes()?);
                jobs.start(name, move |job| {
                    let found = nayar::run(&document, &loaded, &calibration, &shapes, job);
                    let found = found.map(|found| Box::new(with_batch(found, Batch::of_nayar)));
                    Ok(Outcome::Nayar(key, found))
                })
            }
        })
    }

    fn take_finished(&mut self, log: &mut dyn FnMut(Level, String)) {
        let Some(running) = &self.running else { return };
        let Some(outcome) = running.task.poll() else { return };
        let cancelled = running.task.job().is_cancelled();
        let Some(Running { step, keys, superseded, .. }) = self.running.take() else { return };
        self.keys.take();
        if superseded {
            drop_aside(outcome);
            return;
        }
        let outcome = match outcome {
            _ if cancelled => Outcome::lost(step, &keys, CANCELLED.into()),
            Ok(outcome) => outcome,
            Err(line) => Outcome::lost(step, &keys, line),
        };
        if let Some(line) = outcome.error() {
            log(Level::Error, format!("{step}: {line}"));
        }
        outcome.warnings().iter().for_each(|warning| log(Level::Warning, warning.clone()));
        let pictures = &mut self.pictures;
        match outcome {
            Outcome::Load(key, result) => self.load.finish(key, result.map(|pair| pictures.take_from(pair))),
            Outcome::Measure(key, result) => self.measure.finish(key, result),
            Outcome::Calibrate(key, result) => self.calibrate.finish(key, result),
            Outcome::Separate(key, result) => self.separate.finish(key, result.map(|pair| pictures.take_from(pair))),
            Outcome::Shape(key, result) => self.shape.finish(key, result.map(|pair| pictures.take_from(*pair))),
            Outcome::Mesh(key, result) => self.mesh.finish(key, result),
            Outcome::Nayar(key, result) => self.nayar.finish(key, result.map(|pair| pictures.take_from(*pair))),
        }
    }

    /// Why a stage cannot start though the one before it is ready.
    fn why_blocked(&self, step: Step, document: &Document) -> String {
        if document.set.shots.is_empty() {
            return NO_PHOTOS.into();
        }
        let problems = document.set.check();
        if let Some(first) = problems.first() {
            return format!("{first}");
        }
        match (step, self.load.last.as_ref().map(|loaded| &loaded.object)) {
            (Step::Separate, Some(Err(line))) => line.clone(),
            (Step::Separate, _) => {
                self.rig(document).missing().unwrap_or_else(|| "alpha and beta are not known yet: see Calibrate".into())
            }
            (Step::Nayar, _) if !document.settings.nayar.compute => {
                "tick \"Also solve by Nayar's method\" in Shape to see this".into()
            }
            _ => "the step before is not done yet".into(),
        }
    }
}

fn with_batch<T>(result: T, batch: impl FnOnce(&T) -> Batch) -> (T, Batch) {
    let batch = batch(&result);
    (result, batch)
}
