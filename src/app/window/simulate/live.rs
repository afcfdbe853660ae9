//! Live results: computed again off the UI thread whenever its options have changed and settled; the last outcome is shown
//! meanwhile.

use std::error::Error;
use std::sync::Arc;
use std::time::Duration;

use eframe::egui::Context;
use thiserror::Error as ThisError;

use crate::app::base::jobs::{Job, JobError, Jobs, Task};

/// A drag over a number would start work at every step.
const SETTLE: Duration = Duration::from_millis(300);

/// Why there is no outcome.
#[derive(Clone, Debug, ThisError)]
pub enum LiveError {
    /// The user cancelled.
    #[error("{name}: cancelled; it comes with the next change")]
    Cancelled {
        /// The job.
        name: String,
    },
    /// The work failed.
    #[error(transparent)]
    Failed(JobError),
}

/// The outcome of the options that are wanted, or of those before.
pub struct Live<O, T> {
    /// What has to settle, or waits for its turn, and since when.
    waits: Option<(Arc<O>, f64)>,
    task: Option<Task<T>>,
    /// The options that `outcome` or `task` belong to, or will.
    wanted: Option<Arc<O>>,
    outcome: Option<Arc<T>>,
    error: Option<LiveError>,
    is_stopped: bool,
}

impl<O, T> Default for Live<O, T> {
    fn default() -> Self {
        Self { waits: None, task: None, wanted: None, outcome: None, error: None, is_stopped: false }
    }
}

impl<O: PartialEq + Send + Sync + 'static, T: Send + 'static> Live<O, T> {
    /// Asks for the outcome of these options.
    pub fn want(&mut self, options: O, context: &Context) {
        if self.wanted.as_deref() == Some(&options) {
            return;
        }
        self.stop();
        let options = Arc::new(options);
        self.wanted = Some(options.clone());
        self.waits = Some((options, context.input(|input| input.time)));
        context.request_repaint_after(SETTLE);
    }

    /// Gives up what is at work; it begins again when it is wanted again.
    pub fn stop(&mut self) {
        self.is_stopped = true;
        if let Some(task) = self.task.take() {
            task.job().cancel();
            self.waits = self.wanted.clone().map(|options| (options, f64::NEG_INFINITY));
        }
    }

    /// Takes what is finished, and starts what has settled.
    pub fn update<E: Error + Send + Sync + 'static>(
        &mut self,
        context: &Context,
        jobs: &mut Jobs,
        name: &str,
        work: impl FnOnce(&O, &Job) -> Result<T, E> + Send + 'static,
    ) {
        self.is_stopped = false;
        let polled = self.task.as_ref().and_then(|task| Some((task.poll()?, task.job().is_cancelled())));
        if let Some((outcome, is_cancelled)) = polled {
            self.task = None;
            self.error = None;
            match outcome {
                Ok(outcome) => self.outcome = Some(Arc::new(outcome)),
                Err(_) if is_cancelled => self.error = Some(LiveError::Cancelled { name: name.to_owned() }),
                Err(error) => self.error = Some(LiveError::Failed(error)),
            }
        }
        let Some((options, since)) = &self.waits else { return };
        let left = SETTLE.as_secs_f64() - (context.input(|input| input.time) - since);
        if left > 0.0 {
            context.request_repaint_after(Duration::from_secs_f64(left));
            return;
        }
        let options = options.clone();
        self.waits = None;
        self.error = None;
        self.task = Some(jobs.start(name, move |job| work(&options, job)));
    }

    /// Whether nothing waits or is at work.
    pub fn is_at_rest(&self) -> bool {
        self.waits.is_none() && self.task.is_none()
    }

    /// Whether there will be another outcome without a change.
    pub fn is_busy(&self) -> bool {
        !self.is_at_rest() && !self.is_stopped
    }

    /// The last outcome.
    pub fn outcome(&self) -> Option<&Arc<T>> {
        self.outcome.as_ref()
    }

    /// Why there is none of what is wanted.
    pub fn error(&self) -> Option<&LiveError> {
        self.error.as_ref()
    }
}
