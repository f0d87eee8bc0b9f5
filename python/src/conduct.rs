//! Runs the work of the library for a call from Python. Meanwhile the interpreter is free for other Python threads (its
//! lock is released). Long work runs on a thread of its own. It can be stopped by Ctrl-C, and it reports its progress.

use crate::errors;
use armwright::exact::WORKER_STACK_BYTES;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Time between two checks whether Python received a signal, such as Ctrl-C.
const LOOK_EVERY: Duration = Duration::from_millis(50);
/// Time between two calls of the progress function of the caller.
const TELL_EVERY: Duration = Duration::from_millis(200);

/// Creates the worker threads for one call, with the stack size that an exact search needs. `threads` is their number;
/// 0 means one for each core.
///
/// Every call has workers of its own. If a process forks, the child has none of the parent's threads, so workers that
/// stay after a call would be missing there.
pub(crate) fn workers(threads: usize) -> PyResult<ThreadPool> {
    let pool = ThreadPoolBuilder::new().num_threads(threads).stack_size(WORKER_STACK_BYTES);
    pool.build().map_err(errors::usage)
}

/// Runs short work on worker threads of its own, one for each core, while the interpreter's lock is released.
///
/// The workers that the library shares by default are not used. They would be missing in a process that Python forks,
/// and the work would then wait for them without end.
pub(crate) fn pooled<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let pool = workers(0)?;
    Ok(py.detach(|| pool.install(work)))
}

/// Runs `work` on another thread. Meanwhile this thread handles signals every 50 ms and calls `tell` with the elapsed
/// time, every 200 ms and at the end.
///
/// If a signal or `tell` raises an exception, the flag that `work` gets is set, which asks it to stop. Returns the
/// result of the work, complete or not, and the exception; `None` if there was none.
pub(crate) fn conduct<T: Send>(
    py: Python<'_>,
    tell: impl Fn(Python<'_>, Duration) -> PyResult<()> + Send + Sync,
    work: impl FnOnce(&AtomicBool) -> T + Send,
) -> (T, Option<PyErr>) {
    let stop = AtomicBool::new(false);
    let started = Instant::now();
    let look = |is_told: bool| {
        Python::attach(|py| {
            py.check_signals()?;
            if is_told { tell(py, started.elapsed()) } else { Ok(()) }
        })
    };
    py.detach(|| {
        std::thread::scope(|scope| {
            let (working, ended) = channel::<()>();
            let stop = &stop;
            let worker = scope.spawn(move || {
                // this end of the channel is closed when the work ends, even by a panic, and so ends the loop below
                let _working = working;
                work(stop)
            });
            let (mut raised, mut next) = (None, TELL_EVERY);
            while ended.recv_timeout(LOOK_EVERY) == Err(RecvTimeoutError::Timeout) {
                let is_due = started.elapsed() >= next;
                if is_due {
                    next = started.elapsed() + TELL_EVERY;
                }
                if raised.is_none() {
                    raised = look(is_due).err();
                }
                if raised.is_some() {
                    stop.store(true, Ordering::Relaxed);
                }
            }
            let done = worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            let raised = raised.or_else(|| look(true).err());
            (done, raised)
        })
    })
}
