//! The library at work, and Python beside it: signals are looked for and progress is told by the thread that called.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use photonvdb::render::{ErrorEstimate, Observer, Stage};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::refused;

/// How often signals are looked for and progress is told.
const INTERVAL: Duration = Duration::from_millis(50);

const MOST_THREADS: u64 = 1024;

/// A pool of so many threads; without a number one a core, or what RAYON_NUM_THREADS says.
pub fn thread_pool(threads: Option<u64>) -> PyResult<ThreadPool> {
    let threads = match threads {
        Some(threads) if (1..=MOST_THREADS).contains(&threads) => threads as usize,
        Some(threads) => {
            return Err(refused(format!("threads: {threads} must lie in 1 to {MOST_THREADS}")));
        }
        None => 0,
    };
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|error| PyRuntimeError::new_err(format!("no threads to work with: {error}")))
}

/// What the work tells of itself, and whether it is to end.
pub struct Watch {
    stage: Mutex<&'static str>,
    total: AtomicU64,
    done: AtomicU64,
    is_cancelled: AtomicBool,
    events: Sender<Event>,
}

enum Event {
    Pass(u32, Option<f64>),
    End,
}

impl Watch {
    /// A stage of so many steps begins.
    pub fn begin(&self, stage: &'static str, total: u64) {
        *self.stage.lock().unwrap_or_else(PoisonError::into_inner) = stage;
        self.total.store(total, Ordering::Relaxed);
        self.done.store(0, Ordering::Relaxed);
    }

    fn stage(&self) -> (&'static str, f64) {
        let stage = *self.stage.lock().unwrap_or_else(PoisonError::into_inner);
        let [done, total] = [&self.done, &self.total].map(|count| count.load(Ordering::Relaxed));
        (stage, (done as f64 / total.max(1) as f64).min(1.0))
    }
}

impl Observer for Watch {
    fn stage_started(&self, stage: Stage, total: u64) {
        let name = match stage {
            Stage::Trace => "trace",
            Stage::Build => "build",
            Stage::Gather => "gather",
        };
        self.begin(name, total);
    }

    fn advanced(&self, steps: u64) {
        self.done.fetch_add(steps, Ordering::Relaxed);
    }

    fn stage_finished(&self, _: Stage) {}

    fn pass_finished(&self, passes: u32, error: Option<ErrorEstimate>) {
        // The receiver lives as long as the work.
        let _ = self.events.send(Event::Pass(passes, error.map(|error| error.total())));
    }

    fn cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
    }
}

/// The thread that called: it has the interpreter when it needs it.
struct Caller<'a> {
    watch: &'a Watch,
    progress: Option<&'a Py<PyAny>>,
    passes: u32,
    error: Option<f64>,
    /// What Python raised meanwhile.
    raised: Option<PyErr>,
}

impl Caller<'_> {
    /// Waits for the end of the work.
    fn listen(&mut self, events: &Receiver<Event>, has_ended: impl Fn() -> bool) {
        loop {
            match events.recv_timeout(INTERVAL) {
                Ok(Event::End) => break,
                Ok(Event::Pass(passes, error)) => {
                    (self.passes, self.error) = (passes, error);
                    self.call("pass", 1.0);
                }
                // Work that panics sends nothing.
                Err(_) if has_ended() => break,
                Err(_) => {
                    let (stage, fraction) = self.watch.stage();
                    self.call(stage, fraction);
                }
            }
        }
    }

    /// Looks for signals and tells progress; what Python raises, or the word False, ends the work after the pass in flight.
    fn call(&mut self, stage: &str, fraction: f64) {
        if self.raised.is_some() {
            return;
        }
        let answer = Python::attach(|py| {
            py.check_signals()?;
            let Some(progress) = self.progress.filter(|_| !stage.is_empty()) else {
                return Ok(false);
            };
            let answer = progress.call1(py, (stage, fraction, self.passes, self.error))?;
            PyResult::Ok(answer.extract::<bool>(py).is_ok_and(|goes_on| !goes_on))
        });
        if !matches!(answer, Ok(false)) {
            self.watch.is_cancelled.store(true, Ordering::Relaxed);
        }
        self.raised = answer.err();
    }
}

/// Does the work in the pool, the interpreter released. `progress(stage, fraction, passes, error)` is called as it goes on.
///
/// # Errors
/// KeyboardInterrupt, or what `progress` raised, once the work has ended.
pub fn run<T: Send>(
    py: Python<'_>,
    pool: &ThreadPool,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&Watch) -> T + Send,
) -> PyResult<T> {
    let (events, received) = channel();
    let watch = Watch {
        stage: Mutex::new(""),
        total: AtomicU64::new(0),
        done: AtomicU64::new(0),
        is_cancelled: AtomicBool::new(false),
        events,
    };
    let progress = progress.as_ref();
    let (ended, raised) = py.detach(|| {
        let mut caller = Caller { watch: &watch, progress, passes: 0, error: None, raised: None };
        let ended = thread::scope(|scope| {
            let worker = scope.spawn(|| {
                let made = pool.install(|| work(&watch));
                let _ = watch.events.send(Event::End);
                made
            });
            let received = received;
            caller.listen(&received, || worker.is_finished());
            worker.join()
        });
        (ended, caller.raised)
    });
    let made = ended.unwrap_or_else(|panic| resume_unwind(panic));
    // A signal that came with the last step is not left for whoever runs next.
    raised.map_or_else(|| py.check_signals(), Err)?;
    Ok(made)
}
