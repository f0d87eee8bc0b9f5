//! What is shown while a search runs: a bar on a terminal, or else a line of text every ten seconds. Also the file in
//! which `--progress FILE` records the progress.

use super::failure::Failure;
use super::log::Log;
use crate::exact::Known;
use crate::report::number::{large, percent_rounded};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Time between two looks at the state of a search.
const LOOK_EVERY: Duration = Duration::from_millis(50);
/// Time between two lines of text that show the progress.
const LINE_EVERY: Duration = Duration::from_secs(10);
/// Largest number of bytes of a line of the record.
const LONGEST_LINE: u64 = 4096;
/// Time between two lines of the record. A line is added earlier if the optimality gap changes.
const RECORD_EVERY: Duration = Duration::from_secs(1);

/// The state of a search at one moment. A number is `None` if the search does not know it while it runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Progress {
    /// Number of designs visited so far. In an exact search, number of designs evaluated so far.
    pub designs: u64,
    /// Optimality gap proved so far, as a fraction; `None` if it is not known.
    pub gap: Option<f64>,
    /// Number of designs on the front so far; `None` if it is not known.
    pub front_size: Option<u64>,
    /// Number of boxes of an exact search that are not yet decided; `None` if there are none to count.
    pub boxes_open: Option<u64>,
}

impl Progress {
    /// The state of an exhaustive search that has visited `designs` designs. Its front is known only at its end.
    fn visited(designs: u64) -> Self {
        Self { designs, gap: None, front_size: None, boxes_open: None }
    }

    fn known(known: &Known) -> Self {
        Self {
            designs: known.designs,
            gap: known.gap,
            front_size: Some(known.front_size),
            boxes_open: Some(known.boxes_open),
        }
    }
}

impl Progress {
    /// The state of the search as a JSON object, which is one line of the record. `elapsed_s` is the time since the
    /// start of the search \[s\].
    fn to_json(self, elapsed_s: f64) -> Value {
        let Self { designs, gap, front_size, boxes_open } = self;
        json!({
            "elapsed_s": elapsed_s, "designs": designs, "gap": gap, "front_size": front_size, "boxes_open": boxes_open,
        })
    }
}

/// The file in which the progress of a search is recorded, one JSON object in each line.
pub(super) struct Record {
    path: PathBuf,
    file: File,
}

impl Record {
    /// Opens a record. If `goes_on`, lines are added to an earlier record of this name. Otherwise it is replaced.
    ///
    /// # Errors
    /// The file cannot be written, or it is something else than a record.
    pub(super) fn open(path: &Path, goes_on: bool) -> Result<Self, Failure> {
        if !may_be_record(path).map_err(|e| Failure::file(path, "read", &e))? {
            return Err(Failure::Usage(format!(
                "{} is no record of progress and would be overwritten; choose another file for --progress",
                path.display()
            )));
        }
        let file = File::options().create(true).write(true).append(goes_on).truncate(!goes_on).open(path);
        let file = file.map_err(|e| Failure::file(path, "create", &e))?;
        Ok(Self { path: path.to_path_buf(), file })
    }

    /// Adds a line with the state of the search after `elapsed_s` \[s\] to the record.
    ///
    /// # Errors
    /// The file cannot be written.
    pub(super) fn add(&self, elapsed_s: f64, progress: &Progress) -> Result<(), Failure> {
        let line = progress.to_json(elapsed_s);
        // the whole line is written in one call, so that a reader never sees an incomplete line
        (&self.file)
            .write_all(format!("{line}\n").as_bytes())
            .map_err(|e| Failure::file(&self.path, "write", &e))
    }
}

/// Whether a record may be written to a path: nothing is there, or an earlier record, or something that is no regular
/// file, such as a pipe.
fn may_be_record(path: &Path) -> std::io::Result<bool> {
    if !path.is_file() {
        return Ok(true);
    }
    let mut first = String::new();
    let read = BufReader::new(File::open(path)?.take(LONGEST_LINE)).read_line(&mut first);
    let is_line = || {
        let line: Value = serde_json::from_str(&first).unwrap_or_default();
        ["elapsed_s", "designs", "boxes_open"].iter().all(|key| line.get(key).is_some())
    };
    // a first line that is not text is no line of a record
    Ok(read.is_ok() && (first.is_empty() || is_line()))
}

/// Shows and records the progress of a search from its start.
pub(super) struct Watch<'r> {
    started: Instant,
    record: Option<&'r Record>,
    log: Log,
}

impl<'r> Watch<'r> {
    pub(super) fn new(started: Instant, record: Option<&'r Record>, log: Log) -> Self {
        Self { started, record, log }
    }

    /// Observes a search every 50 ms until `finished` is set. Each time it calls `see` with the elapsed time, which
    /// shows the progress. If a line of the record is due, it adds the state that `now` returns.
    fn look(&self, finished: &AtomicBool, now: impl Fn() -> Progress, mut see: impl FnMut(Duration)) {
        let (mut next, mut last_gap) = (Duration::ZERO, None);
        while !finished.load(Ordering::Relaxed) {
            std::thread::sleep(LOOK_EVERY);
            let elapsed = self.started.elapsed();
            if let Some(record) = self.record {
                let progress = now();
                if elapsed >= next || progress.gap != last_gap {
                    (next, last_gap) = (elapsed + RECORD_EVERY, progress.gap);
                    // a disk that is full now may have space later; if it has not, writing the last line fails and is
                    // reported
                    let _ = record.add(elapsed.as_secs_f64(), &progress);
                }
            }
            see(elapsed);
        }
    }

    /// Shows how many of `total` designs have been visited, until `finished` is set.
    pub(super) fn designs(&self, total: u128, visited: &(dyn Fn() -> u64 + Sync), finished: &AtomicBool) {
        let now = || Progress::visited(visited());
        if self.log.draws() {
            let bar = ProgressBar::new(u64::try_from(total).unwrap_or(u64::MAX));
            let style = ProgressStyle::with_template(
                "{bar:30} {human_pos}/{human_len} designs, {per_sec}, {eta} left",
            );
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            self.look(finished, now, |_| bar.set_position(visited()));
            bar.finish_and_clear();
            return;
        }
        let say = |event: &str, elapsed: Duration| {
            let numbers = json!({
                "elapsed_s": elapsed.as_secs_f64(), "designs": visited(), "designs_total": total as f64,
            });
            self.log.progress(event, &visited_line(total, visited(), elapsed), numbers);
        };
        self.look(finished, now, in_lines(|elapsed| say("progress", elapsed)));
        say("searched", self.started.elapsed());
    }

    /// Shows the state of an exact search (gap, front and boxes) until `finished` is set. `known` returns the state.
    pub(super) fn search(&self, known: &(dyn Fn() -> Known + Sync), finished: &AtomicBool) {
        let now = || Progress::known(&known());
        let line = |elapsed: Duration| search_line(&known(), elapsed);
        if self.log.draws() {
            let spinner = ProgressBar::new_spinner();
            self.look(finished, now, |elapsed| spinner.set_message(line(elapsed)));
            spinner.finish_and_clear();
            return;
        }
        let say = |event: &str, elapsed: Duration| {
            self.log.progress(event, &line(elapsed), now().to_json(elapsed.as_secs_f64()));
        };
        self.look(finished, now, in_lines(|elapsed| say("progress", elapsed)));
        say("searched", self.started.elapsed());
    }
}

/// A function that calls `say` at most every ten seconds of elapsed time. The function is itself called with the
/// elapsed time.
fn in_lines(say: impl Fn(Duration)) -> impl FnMut(Duration) {
    let mut next = LINE_EVERY;
    move |elapsed| {
        if elapsed >= next {
            // a continued search starts with a large elapsed time; lines for the time before it must not all be
            // printed at once
            next = elapsed + LINE_EVERY;
            say(elapsed);
        }
    }
}

fn visited_line(all: u128, visited: u64, elapsed: Duration) -> String {
    let (done, total, elapsed_s) = (visited as f64, all as f64, elapsed.as_secs_f64());
    // a shard of a small study may have no designs
    let percent = if total > 0.0 { 100.0 * done / total } else { 100.0 };
    let designs = if all == 1 { "design" } else { "designs" };
    let so_far = format!(
        "{elapsed_s:.0} s: {} of {} {designs} ({percent:.0} %)",
        large(u128::from(visited)),
        large(all)
    );
    if visited == 0 || elapsed_s == 0.0 {
        return so_far;
    }
    let rate = done / elapsed_s;
    format!("{so_far}, {rate:.0} designs/s, about {:.0} s left", (total - done) / rate.max(1.0))
}

fn search_line(known: &Known, elapsed: Duration) -> String {
    let gap = known.gap.map_or("not known yet".into(), |gap| percent_rounded(100.0 * gap, 2));
    format!(
        "{:.0} s: gap {gap}, front of {}, {} boxes, {} open",
        elapsed.as_secs_f64(),
        known.front_size,
        large(u128::from(known.boxes)),
        large(u128::from(known.boxes_open))
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_of_an_exact_search_says_its_gap_and_its_front() {
        let known = Known { boxes: 125_000, boxes_open: 12, designs: 9, front_size: 431, gap: Some(0.123) };
        let line = search_line(&known, Duration::from_secs(20));
        assert_eq!(line, "20 s: gap 12 %, front of 431, 125,000 boxes, 12 open");
        let line = visited_line(1_600_000, 16, Duration::from_secs(8));
        assert!(line.starts_with("8 s: 16 of 1,600,000 designs (0 %)"), "{line}");
        assert!(visited_line(1, 0, Duration::ZERO).ends_with("0 of 1 design (0 %)"));
        let line = search_line(&Known::default(), Duration::from_secs(1));
        assert!(line.contains("gap not known yet"), "{line}");
    }
}
