//! Work off the UI thread, with a name, progress and cancel.

use std::convert::Infallible;
use std::error::Error;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{self, TryRecvError};
use std::sync::{Arc, Weak};

use firstbounce_capture::pipeline::{PipelineWatch, Stage};
use firstbounce_core::Watch;
use thiserror::Error as ThisError;

/// Asks for a repaint, from any thread.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// Steps of progress that are worth a repaint.
const STEPS: f32 = 100.0;
/// Of threads that compute: a frame of the window comes first, and alone they get all of the machine.
#[cfg(target_os = "linux")]
const NICENESS: i32 = 10;

/// One piece of work: what it is called, how far it is, whether it should stop.
pub struct Job {
    name: String,
    permille: AtomicU32,
    cancelled: AtomicBool,
    wake: Wake,
}

impl Job {
    /// What the user sees.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// 0 to 1.
    pub fn fraction(&self) -> f32 {
        self.permille.load(Ordering::Relaxed) as f32 / STEPS
    }

    /// Asks the work to stop at its next step.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether it was asked to stop.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}

impl Watch for Job {
    fn progress(&self, fraction: f32) {
        let step = (fraction.clamp(0.0, 1.0) * STEPS) as u32;
        if self.permille.swap(step, Ordering::Relaxed) != step {
            (self.wake)();
        }
    }

    fn cancelled(&self) -> bool {
        self.is_cancelled()
    }
}

impl PipelineWatch for Job {
    fn progress(&self, _: Stage, fraction: f32) {
        Watch::progress(self, fraction);
    }

    fn cancelled(&self) -> bool {
        self.is_cancelled()
    }
}

/// Why a job gave no result, in one line for the user.
#[derive(Clone, Debug, ThisError)]
pub enum JobError {
    /// The work failed.
    #[error("{}", .0.to_string().replace('\n', " "))]
    Failed(Arc<dyn Error + Send + Sync>),
    /// It ended without an outcome.
    #[error("{name} stopped unexpectedly")]
    Lost {
        /// The job.
        name: String,
    },
}

/// Work that was started and will give a `T`.
pub struct Task<T> {
    job: Arc<Job>,
    outcome: mpsc::Receiver<Result<T, JobError>>,
}

impl<T> Task<T> {
    /// Its name, progress and cancel.
    pub fn job(&self) -> &Job {
        &self.job
    }

    /// What came out, once; `None` while the work goes on.
    pub fn poll(&self) -> Option<Result<T, JobError>> {
        match self.outcome.try_recv() {
            Ok(outcome) => Some(outcome),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(JobError::Lost { name: self.job.name.clone() })),
        }
    }
}

/// Drops what may be large on a thread of its own: giving back the memory of a few photos takes longer than a frame.
pub fn drop_aside<T: Send + 'static>(large: T) {
    // Where no thread can be had it is dropped here.
    let _ = std::thread::Builder::new().name("drop".into()).spawn(move || drop(large));
}

/// Lowers the priority of the threads that compute below that of the one that draws, on systems that rank threads. Once, before
/// anything is computed; work that has begun keeps its threads as they are.
pub fn lower_priority_of_workers() {
    let pool = rayon::ThreadPoolBuilder::new().start_handler(|_| lower_priority());
    // A pool that is there already only computes more eagerly.
    let _ = pool.build_global();
}

/// Where it is refused the thread goes on as it was.
fn lower_priority() {
    #[cfg(target_os = "linux")]
    let _ = rustix::process::setpriority_process(None, NICENESS);
}

/// Every job that runs.
pub struct Jobs {
    running: Vec<Weak<Job>>,
    wake: Wake,
}

impl Jobs {
    /// No jobs; `wake` is called whenever one has news.
    pub fn new(wake: Wake) -> Self {
        Self { running: Vec::new(), wake }
    }

    /// Runs `work` on its own thread under a name: "Export report".
    pub fn start<T: Send + 'static, E: Error + Send + Sync + 'static>(
        &mut self,
        name: impl Into<String>,
        work: impl FnOnce(&Job) -> Result<T, E> + Send + 'static,
    ) -> Task<T> {
        let job = Arc::new(Job {
            name: name.into(),
            permille: AtomicU32::new(0),
            cancelled: AtomicBool::new(false),
            wake: self.wake.clone(),
        });
        self.running.retain(|job| job.strong_count() > 0);
        self.running.push(Arc::downgrade(&job));
        let (sender, outcome) = mpsc::channel();
        let at_work = job.clone();
        std::thread::spawn(move || {
            lower_priority();
            // Dropped last, also when the work panics: whoever wakes finds the outcome there and the job gone.
            let _wake = WakeOnDrop(at_work.wake.clone());
            let (sender, at_work) = (sender, at_work);
            let result = work(&at_work).map_err(|error| JobError::Failed(Arc::new(error)));
            drop(at_work);
            // The receiver may be gone.
            let _ = sender.send(result);
        });
        Task { job, outcome }
    }

    /// The same for work that cannot fail.
    pub fn compute<T: Send + 'static>(
        &mut self,
        name: impl Into<String>,
        work: impl FnOnce(&Job) -> T + Send + 'static,
    ) -> Task<T> {
        self.start(name, |job| Ok::<_, Infallible>(work(job)))
    }

    /// The jobs that are running, the oldest first.
    pub fn running(&self) -> Vec<Arc<Job>> {
        // A task that waits to be polled holds its job too: two owners are at work, one is done.
        self.running.iter().filter(|job| job.strong_count() > 1).filter_map(Weak::upgrade).collect()
    }

    /// Asks for a repaint from any thread.
    pub fn wake(&self) -> Wake {
        self.wake.clone()
    }
}

struct WakeOnDrop(Wake);

impl Drop for WakeOnDrop {
    fn drop(&mut self) {
        (self.0)();
    }
}
