//! What is shown while a search runs: a bar on a terminal, a plain line every ten seconds otherwise.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Shows progress: a bar on a terminal, a plain line every ten seconds otherwise.
pub(super) fn watch(total: u128, visited: &(dyn Fn() -> u64 + Sync), finished: &AtomicBool) {
    if std::io::stderr().is_terminal() {
        bar(total, visited, finished);
    } else {
        lines(total, visited, finished);
    }
}

fn bar(total: u128, visited: &(dyn Fn() -> u64 + Sync), finished: &AtomicBool) {
    let bar = ProgressBar::new(u64::try_from(total).unwrap_or(u64::MAX));
    let style =
        ProgressStyle::with_template("{bar:30} {human_pos}/{human_len} designs, {per_sec}, {eta} left");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    while !finished.load(Ordering::Relaxed) {
        bar.set_position(visited());
        std::thread::sleep(Duration::from_millis(100));
    }
    bar.finish_and_clear();
}

const LINE_EVERY: Duration = Duration::from_secs(10);

fn lines(total: u128, visited: &(dyn Fn() -> u64 + Sync), finished: &AtomicBool) {
    let started = Instant::now();
    let mut next = LINE_EVERY;
    while !finished.load(Ordering::Relaxed) {
        std::thread::sleep(Duration::from_millis(50));
        if started.elapsed() < next {
            continue;
        }
        next += LINE_EVERY;
        let (done, elapsed_s) = (visited() as f64, started.elapsed().as_secs_f64());
        let rate = done / elapsed_s;
        eprintln!(
            "{elapsed_s:.0} s: {done:.3e} of {:.3e} designs ({:.0} %), {rate:.0} designs/s, about {:.0} s left",
            total as f64,
            100.0 * done / total as f64,
            (total as f64 - done) / rate.max(1.0)
        );
    }
}

/// Shows the progress of an exact search.
pub(super) fn watch_boxes(boxes: &(dyn Fn() -> u64 + Sync), finished: &AtomicBool) {
    let started = Instant::now();
    let bar = std::io::stderr().is_terminal().then(ProgressBar::new_spinner);
    let mut next = LINE_EVERY;
    while !finished.load(Ordering::Relaxed) {
        std::thread::sleep(Duration::from_millis(50));
        let line = || format!("{:.0} s: {:.3e} boxes", started.elapsed().as_secs_f64(), boxes() as f64);
        match &bar {
            Some(bar) => bar.set_message(line()),
            None if started.elapsed() >= next => {
                next += LINE_EVERY;
                eprintln!("{}", line());
            }
            None => {}
        }
    }
    bar.iter().for_each(ProgressBar::finish_and_clear);
}
