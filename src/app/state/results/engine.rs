//! The engine of the stages: which of them are stale, one job at a time, the last good result kept until the new one is
//! there.

use std::any::Any;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::error::StageError;
use super::pictures::Batch;
use super::{Results, Step, stages};
use crate::app::base::jobs::{Job, Jobs, Task, drop_aside};
use crate::app::state::document::Document;
use crate::app::state::log::Level;

/// Work starts when the document has been left alone for so long: a drag would otherwise start it again in every frame.
const SETTLE: Duration = Duration::from_millis(150);

/// One stage: a row of the table in [`stages::all`].
pub trait Stage: Send + Sync {
    /// Which one.
    fn step(&self) -> Step;
    /// The stage whose result it takes.
    fn needs(&self) -> Option<Step>;
    /// What a line about it begins with.
    fn title(&self) -> String;
    /// What its job is called while it runs.
    fn job_name(&self, document: &Document) -> String;
    /// What its result depends on; `None` where it cannot be computed yet.
    fn key(&self, known: &Known) -> Option<AnyKey>;
    /// The work, with what it takes of the results.
    fn work(&self, document: Arc<Document>, results: &Results) -> Option<Work>;
    /// Why it cannot start though the stage before is ready.
    fn why_blocked(&self, _document: &Document, _results: &Results) -> StageError {
        StageError::TooEarly
    }
}

/// What a job runs.
pub type Work = Box<dyn FnOnce(&Job) -> Result<Done, StageError> + Send>;

/// What a stage's job gives.
pub struct Done {
    result: Arc<dyn Any + Send + Sync>,
    pictures: Option<Batch>,
    warnings: Vec<String>,
}

impl Done {
    /// A result without pictures.
    pub fn new<T: Send + Sync + 'static>(result: T) -> Self {
        Self { result: Arc::new(result), pictures: None, warnings: Vec::new() }
    }

    /// With pictures of it.
    pub fn with_pictures(self, pictures: Batch) -> Self {
        Self { pictures: Some(pictures), ..self }
    }

    /// With what the user should know before trusting it.
    pub fn with_warnings(self, warnings: Vec<String>) -> Self {
        Self { warnings, ..self }
    }
}

/// What a stage's result depends on, whatever its type.
#[derive(Clone)]
pub struct AnyKey(Arc<dyn Key>);

impl AnyKey {
    /// Of a stage's own key.
    pub fn new<K: PartialEq + Send + Sync + 'static>(key: K) -> Self {
        Self(Arc::new(key))
    }
}

impl PartialEq for AnyKey {
    fn eq(&self, other: &Self) -> bool {
        self.0.equals(&*other.0)
    }
}

trait Key: Any + Send + Sync {
    fn equals(&self, other: &dyn Key) -> bool;
}

impl<K: PartialEq + Send + Sync + 'static> Key for K {
    fn equals(&self, other: &dyn Key) -> bool {
        let other: &dyn Any = other;
        other.downcast_ref::<K>().is_some_and(|other| self == other)
    }
}

/// The keys of all stages in the order of the table; `None` where a stage cannot be computed yet.
pub type Keys = Vec<Option<AnyKey>>;

/// What a stage's key may follow from: the document, and results that are those of it.
pub struct Known<'a> {
    /// The document.
    pub document: &'a Document,
    /// Every result, also older ones.
    pub results: &'a Results,
    /// The keys of the stages before.
    keys: &'a Keys,
}

impl Known<'_> {
    /// The result of a stage before and the number that it was counted by, where it is that of the document.
    pub fn ready<T: Send + Sync + 'static>(&self, step: Step) -> Option<(Arc<T>, u64)> {
        let index = self.results.index(step)?;
        let slot = &self.results.rows[index].slot;
        if !slot.is_ready(self.keys.get(index)?.as_ref()) {
            return None;
        }
        Some((slot.last.clone()?.downcast().ok()?, slot.generation))
    }
}

/// Of all stages. Each key is asked for once those before it are known.
pub fn keys_of(document: &Document, results: &Results) -> Keys {
    let mut keys = Keys::with_capacity(results.rows.len());
    for row in &results.rows {
        let key = row.stage.key(&Known { document, results, keys: &keys });
        keys.push(key);
    }
    keys
}

/// How a stage stands with respect to the document.
#[derive(Clone, Debug, PartialEq)]
pub enum StageState {
    /// Something that it depends on has changed; it will be computed again.
    Stale,
    /// It is being computed.
    Running {
        /// 0 to 1.
        fraction: f32,
    },
    /// Its result is that of the document.
    Ready,
    /// It failed.
    Failed {
        /// What to do.
        line: String,
    },
    /// The user stopped it.
    Cancelled {
        /// What to do.
        line: String,
    },
    /// It cannot be computed: something before it is missing.
    Blocked {
        /// What to do.
        line: String,
    },
}

/// A stage, the last attempt at it, and its last good result.
pub struct Row {
    pub stage: Box<dyn Stage>,
    pub slot: Slot,
}

/// Every stage without a result.
pub fn rows() -> Vec<Row> {
    stages::all().into_iter().map(|stage| Row { stage, slot: Slot::default() }).collect()
}

/// The last attempt at a stage, and its last good result.
#[derive(Default)]
pub struct Slot {
    /// The last good result.
    pub last: Option<Arc<dyn Any + Send + Sync>>,
    /// Counts the good results: what later stages depend on.
    pub generation: u64,
    tried: Option<AnyKey>,
    error: Option<StageError>,
}

impl Slot {
    /// Of no key: it cannot be tried.
    fn is_stale(&self, wanted: Option<&AnyKey>) -> bool {
        wanted.is_some() && self.tried.as_ref() != wanted
    }

    /// Whether the last good result is that of `wanted`.
    pub fn is_ready(&self, wanted: Option<&AnyKey>) -> bool {
        wanted.is_some() && !self.is_stale(wanted) && self.error.is_none()
    }

    /// Forgets an attempt that failed.
    fn retry(&mut self) {
        if self.error.take().is_some() {
            self.tried = None;
        }
    }

    fn finish(&mut self, key: Option<AnyKey>, result: Result<Arc<dyn Any + Send + Sync>, StageError>) {
        self.tried = key;
        match result {
            Ok(result) => {
                drop_aside(self.last.replace(result));
                self.generation += 1;
                self.error = None;
            }
            Err(error) => self.error = Some(error),
        }
    }
}

/// The job at work.
pub struct Running {
    index: usize,
    keys: Arc<Keys>,
    task: Task<Result<Done, StageError>>,
    /// Whether an edit cancelled it, and not the user.
    superseded: bool,
}

impl Running {
    pub fn cancel(&self) {
        self.task.job().cancel();
    }
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
    /// How a stage stands with respect to this document.
    pub fn state(&self, step: Step, document: &Document) -> StageState {
        let Some(index) = self.index(step) else { return StageState::Stale };
        let keys = self.keys(document);
        if let Some(running) = self.running.as_ref().filter(|running| running.index == index && running.keys == keys) {
            return StageState::Running { fraction: running.task.job().fraction() };
        }
        let slot = &self.rows[index].slot;
        match &keys[index] {
            None => self.blocked(index, document),
            key if slot.is_stale(key.as_ref()) => StageState::Stale,
            Some(_) => match &slot.error {
                Some(error @ StageError::Cancelled) => StageState::Cancelled { line: error.to_string() },
                Some(error) => StageState::Failed { line: error.to_string() },
                None => StageState::Ready,
            },
        }
    }

    /// A stage that cannot be computed yet: for lack of what comes before, or of something of its own.
    fn blocked(&self, index: usize, document: &Document) -> StageState {
        let stage = &self.rows[index].stage;
        let before = stage.needs();
        match before.map(|before| self.state(before, document)) {
            Some(StageState::Failed { .. } | StageState::Cancelled { .. }) => {
                let failed =
                    before.and_then(|before| Some((before, self.rows[self.index(before)?].slot.error.clone()?)));
                let reason = |(step, reason)| StageError::Before { step, reason: Box::new(reason) };
                let error = failed.map_or(StageError::TooEarly, reason);
                StageState::Blocked { line: error.to_string() }
            }
            Some(blocked @ StageState::Blocked { .. }) => blocked,
            Some(StageState::Running { .. } | StageState::Stale) => StageState::Stale,
            Some(StageState::Ready) | None => {
                let own = || stage.why_blocked(document, self);
                StageState::Blocked { line: set_error(document).unwrap_or_else(own).to_string() }
            }
        }
    }

    /// Tries again what failed or was cancelled.
    pub fn retry(&mut self) {
        self.rows.iter_mut().for_each(|row| row.slot.retry());
        self.keys.take();
    }

    /// Takes what is finished and starts what is stale. Once a frame; `log` takes a line of every stage that failed or warns.
    pub fn update(&mut self, document: &Arc<Document>, jobs: &mut Jobs, log: &mut dyn FnMut(Level, String)) -> Next {
        self.take_finished(log);
        let keys = self.keys(document);
        if let Some(running) = &mut self.running {
            // A key later in the table changes nothing for the one at work.
            if running.keys[..=running.index] != keys[..=running.index] {
                running.superseded = true;
                running.cancel();
            }
            return Next::Rest;
        }
        let Some(index) = self.first_stale(&keys) else {
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
                if self.loaded().is_some() {
                    return Next::Again(SETTLE);
                }
            }
        }
        let stage = &self.rows[index].stage;
        if let Some(work) = stage.work(document.clone(), self) {
            let task = jobs.compute(stage.job_name(document), work);
            self.running = Some(Running { index, keys, task, superseded: false });
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
                let keys = Arc::new(keys_of(document, self));
                *known = Some((document.clone(), keys.clone()));
                keys
            }
        }
    }

    fn first_stale(&self, keys: &Keys) -> Option<usize> {
        self.rows.iter().zip(keys).position(|(row, key)| row.slot.is_stale(key.as_ref()))
    }

    fn take_finished(&mut self, log: &mut dyn FnMut(Level, String)) {
        let Some(running) = &self.running else { return };
        let Some(outcome) = running.task.poll() else { return };
        let cancelled = running.task.job().is_cancelled();
        let Some(Running { index, keys, superseded, .. }) = self.running.take() else { return };
        self.keys.take();
        if superseded {
            drop_aside(outcome);
            return;
        }
        let outcome = match outcome {
            _ if cancelled => Err(StageError::Cancelled),
            Ok(outcome) => outcome,
            Err(error) => Err(StageError::Lost(error)),
        };
        let Row { stage, slot } = &mut self.rows[index];
        let result = match outcome {
            Ok(Done { result, pictures, warnings }) => {
                warnings.into_iter().for_each(|warning| log(Level::Warning, warning));
                if let Some(pictures) = pictures {
                    self.pictures.take(pictures);
                }
                Ok(result)
            }
            Err(error) => {
                let level = if matches!(error, StageError::Cancelled) { Level::Done } else { Level::Error };
                log(level, format!("{}: {error}", stage.title()));
                Err(error)
            }
        };
        slot.finish(keys[index].clone(), result);
    }
}

/// What is wrong with the set itself.
fn set_error(document: &Document) -> Option<StageError> {
    if document.set.shots.is_empty() {
        return Some(StageError::NoPhotos);
    }
    document.set.check().into_iter().next().map(StageError::Set)
}
