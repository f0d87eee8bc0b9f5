//! What happens when the user wants to stop the program by a signal, such as Ctrl-C or SIGTERM.
//!
//! A signal sets a flag ([`stopped_by_signal`]). Verbs with long computations test this flag and stop by themselves.
//! Any other verb that writes ends at once, but never between two files that belong together. Either way the exit code
//! is that of [`Failure::Interrupted`], and a message says what was written.

use super::failure::Failure;
use super::log::Log;
use crate::exact::run::WORKER_STACK_BYTES;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, Once, OnceLock, PoisonError};
use std::time::Duration;

/// Time between two tests of the flag, while a computation runs that does not test the flag itself.
const LOOK_EVERY: Duration = Duration::from_millis(50);

/// Set when the user wants to stop the program.
static STOP: AtomicBool = AtomicBool::new(false);
/// Whether the first signal ends the program, because the verb does not test the flag.
static ENDS_AT_ONCE: AtomicBool = AtomicBool::new(false);
/// Held while files that belong together are written.
static WRITING: Mutex<()> = Mutex::new(());
/// The log for the last message.
static LOG: OnceLock<Log> = OnceLock::new();

/// Reacts to signals from now on. `looks` says whether the verb tests the flag.
pub(super) fn listen(looks: bool, log: Log) {
    let _ = LOG.set(log);
    ENDS_AT_ONCE.store(!looks, Ordering::Relaxed);
    stopped_by_signal();
    stop_if_wanted("begin");
}

/// A flag that is set when the user wants to stop the program. Code that reacts to the flag and continues must clear
/// it, because a second signal while the flag is set ends the program at once.
pub(super) fn stopped_by_signal() -> &'static AtomicBool {
    static HANDLER: Once = Once::new();
    HANDLER.call_once(|| {
        // on systems without signal handling, a signal ends the program
        let _ = ctrlc::set_handler(|| {
            if STOP.swap(true, Ordering::Relaxed) || ENDS_AT_ONCE.load(Ordering::Relaxed) {
                end();
            }
        });
    });
    &STOP
}

/// Ends the program, after the files that are just being written.
fn end() {
    let _nothing_is_half_written = WRITING.lock().unwrap_or_else(PoisonError::into_inner);
    let failure = Failure::Interrupted("stopped by a signal; the same command begins anew".into());
    if ENDS_AT_ONCE.load(Ordering::Relaxed) {
        LOG.get().copied().unwrap_or_default().error(&failure);
    }
    std::process::exit(failure.exit_code().into());
}

/// Whether the user wants to stop the program.
pub(super) fn is_stopped() -> bool {
    stopped_by_signal().load(Ordering::Relaxed)
}

/// Calls `write`. A signal that ends the program at once waits until `write` has returned.
pub(super) fn together<T>(write: impl FnOnce() -> T) -> T {
    let _writing = WRITING.lock().unwrap_or_else(PoisonError::into_inner);
    write()
}

/// Fails if the flag is set. The error says that nothing was written, so it is called before anything is written.
///
/// # Errors
/// The flag is set.
pub(super) fn refuse_if_stopped() -> Result<(), Failure> {
    match is_stopped() {
        true => Err(nothing_written()),
        false => Ok(()),
    }
}

/// Runs `work`, which does not test the flag itself, on another thread, and returns its result. If the user wants to
/// stop the program first, the function fails and leaves `work` running; the caller then ends the process.
///
/// # Errors
/// The user wants to stop the program.
pub(super) fn unless_stopped<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, Failure> {
    let (tell, told) = channel();
    let worker = std::thread::Builder::new()
        .stack_size(WORKER_STACK_BYTES)
        .spawn(move || drop(tell.send(work())))
        .map_err(|e| Failure::Internal(format!("no thread can be started: {e}")))?;
    loop {
        refuse_if_stopped()?;
        match told.recv_timeout(LOOK_EVERY) {
            Ok(result) => return Ok(result),
            Err(RecvTimeoutError::Timeout) => {}
            // the work ended without a result, so it panicked; its message is on standard error already
            Err(RecvTimeoutError::Disconnected) => match worker.join() {
                Err(panic) => std::panic::resume_unwind(panic),
                Ok(()) => return Err(Failure::Internal("a computation has no result".into())),
            },
        }
    }
}

fn nothing_written() -> Failure {
    Failure::Interrupted("stopped; nothing was written, the same command begins anew".into())
}

/// Sets the flag if a test asks for it at this moment: if the environment variable `ARMWRIGHT_FAULT` is `stop:`
/// followed by `moment`, such as `stop:begin`. Only builds with the feature `faults` do so.
#[cfg(feature = "faults")]
pub(super) fn stop_if_wanted(moment: &str) {
    let wanted = std::env::var("ARMWRIGHT_FAULT").unwrap_or_default();
    if wanted.strip_prefix("stop:") == Some(moment) {
        STOP.store(true, Ordering::Relaxed);
    }
}

#[cfg(not(feature = "faults"))]
pub(super) fn stop_if_wanted(_: &str) {}
