//! Long work beside Python: on a thread of its own, without the interpreter's lock, told of Ctrl-C, and with its progress told.

use crate::errors;
use armwright::exact::WORKER_STACK_BYTES;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Time between two looks at signals.
const LOOK_EVERY: Duration = Duration::from_millis(50);
/// Time between two calls of a progress function.
const TELL_EVERY: Duration = Duration::from_millis(200);

/// Workers for one call, with the stack that an exact search needs; 0 is one a core. A pool that outlived its call would be lost
/// in a process that Python forks.
pub(crate) fn workers(threads: usize) -> PyResult<ThreadPool> {
    let pool = ThreadPoolBuilder::new().num_threads(threads).stack_size(WORKER_STACK_BYTES);
    pool.build().map_err(errors::usage)
}

/// Does short work without the interpreter's lock, on workers of its own: the workers that the library would else share by all
/// calls are missing in a process that Python forks, and the work would wait for them without end.
pub(crate) fn pooled<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let pool = workers(0)?;
    Ok(py.detach(|| pool.install(work)))
}

/// Does the work on another thread while this one answers signals every 50 ms and calls `tell` every 200 ms and at the end.
/// An exception of either sets the flag that the work gets, and is returned with what the work then had.
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
                // dropped when the work ends, even by a panic
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
