//! The verdict in words, and the files of the result.

use super::files::{CORRECTED_FILE, corrected_files};
use super::outcome::{Outcome, Verdict};
use super::record_report;
use crate::arm::effect::entry::word_of;
use crate::arm::pose::any_slides;
use crate::reconcile::fit::noise::Outlier;
use crate::reconcile::model::estimate::{Estimate, Finding};
use crate::report::pose::pose_words;
use crate::report::whole_file::{create_folder, write_whole};
use std::fmt::Write as _;
use std::path::Path;

/// A factor on the declared standard deviations of a channel is mentioned only above this, because chance produces
/// smaller factors.
const WORTH_SAYING: f64 = 1.05;

impl Outcome {
    /// A short text of the verdict for the terminal.
    pub fn to_text(&self) -> String {
        let mut out = String::new();
        let _ = writeln!(out, "{}: {}", self.campaign, self.headline());
        for reason in &self.reasons {
            let _ = writeln!(out, "  {reason}");
        }
        for finding in self.effects.iter().chain(&self.suspects) {
            out.push_str(&describe(finding, self.verdict));
        }
        if let Some(k) = &self.held_out {
            let _ = writeln!(
                out,
                "  on {} readings of poses held out of the fit: {:.2} sigma before, {:.2} after",
                k.count, k.rms_before, k.rms_after
            );
        }
        self.models_table(&mut out);
        self.stages_table(&mut out);
        out.push_str(&record_report::text(&self.records));
        self.quality(&mut out);
        if let Some(test) = self.next_tests.first() {
            let angles = |p: &Vec<f64>| p.iter().map(|a| format!("{a:.1}")).collect::<Vec<_>>().join(", ");
            let words = |p: &Vec<f64>| match any_slides(&test.joints) {
                true => pose_words(&test.joints, p),
                false => format!("[{}] deg", angles(p)),
            };
            let pose = test.pose_deg.as_ref().map_or(String::new(), |p| format!(" at {}", words(p)));
            let joint = test.joint.as_ref().map_or(String::new(), |j| format!(" of {j}"));
            let expect = match test.expected_sigmas {
                0.0 => String::new(),
                s if s > 100.0 => format!(
                    ": the models differ by more than 100 sigma there, readings needed: {}",
                    test.readings_needed
                ),
                s => format!(
                    ": the models differ by {s:.1} sigma there, readings needed: {}",
                    test.readings_needed
                ),
            };
            let load = match test.kind.as_str() {
                "windup" | "another kind" => String::new(),
                _ => format!(", payload {} kg, force {:?} N", test.payload_kg, test.force_n),
            };
            let _ =
                writeln!(out, "  next test: {} ({}){joint}{pose}{load}{expect}", test.kind, test.description);
        }
        out
    }

    fn headline(&self) -> String {
        let names = |list: &[Finding]| list.iter().map(|f| f.label()).collect::<Vec<_>>().join(" and ");
        match self.verdict {
            Verdict::NoGap => "no gap between model and measurement".into(),
            Verdict::Explained => format!("explained by {}", names(&self.effects)),
            Verdict::Unexplained => {
                "UNEXPLAINED: the model is wrong, and no effect of the library can be named as what is missing".into()
            }
            Verdict::InsufficientData => "the readings are insufficient to tell".into(),
        }
    }

    /// Appends to `out` the table of the models that the corrected arm could have, with their errors on held-out
    /// readings, and the laws in the chosen one.
    fn models_table(&self, out: &mut String) {
        if self.models.is_empty() {
            return;
        }
        out.push_str("  error on held-out readings [sigma]; * is in arm.corrected.json, which predicts better but explains nothing\n");
        for row in &self.models {
            let mark = if row.is_written { '*' } else { ' ' };
            let _ = writeln!(out, "  {mark} {:>8.2}  {}", row.kept_out_rms_sigma, row.model);
        }
        for law in &self.empirical {
            let _ = writeln!(out, "  {}: {}", law.law, law.may_be);
        }
    }

    fn stages_table(&self, out: &mut String) {
        if self.stages.is_empty() {
            return;
        }
        let _ = writeln!(
            out,
            "  {:<41} {:>8} {:>26}",
            "position error [mm], each line adds", "fitted", "held out"
        );
        let _ = writeln!(out, "  {:<41} {:>8} {:>8} {:>8} {:>8}", "", "median", "median", "mean", "largest");
        for s in &self.stages {
            let _ = writeln!(
                out,
                "  {:<41} {:>8.3} {:>8.3} {:>8.3} {:>8.3}",
                s.added, s.fitted_median_mm, s.median_mm, s.mean_mm, s.max_mm
            );
            s.dropped.iter().for_each(|name| out.push_str(&format!("    replaces {name}\n")));
        }
    }

    fn quality(&self, out: &mut String) {
        // where physics is missing, it may have moved these rows
        let what = match self.verdict {
            Verdict::Unexplained => "gross error, or part of what no effect explains",
            _ => "gross error",
        };
        for Outlier { channel, row, sigmas } in &self.noise.outliers {
            let _ = writeln!(
                out,
                "  {what}: {} row {} is {sigmas:.0} sigma off; left out of the fit",
                channel.word(),
                row + 1
            );
        }
        for (word, scale) in ["static", "modal", "windup"].iter().zip(self.noise.scale) {
            if scale > WORTH_SAYING {
                let _ = writeln!(out, "  {word} readings scatter {scale:.2} times as much as declared");
            }
        }
    }

    /// Names and contents of the files of the result: `verdict.json`, `verdict.txt`, `arm.corrected.json`,
    /// `residuals.csv`, and one file for each other corrected arm.
    pub fn files(&self) -> Vec<(String, String)> {
        let json = |value: &serde_json::Value| format!("{value:#}\n");
        let mut out = vec![
            ("verdict.json".to_string(), json(&self.to_json())),
            ("verdict.txt".to_string(), self.to_text()),
            (CORRECTED_FILE.to_string(), json(&self.corrected_json())),
            ("residuals.csv".to_string(), self.residuals_csv()),
        ];
        let others = self.other_corrected.iter().zip(corrected_files(&self.other_corrected));
        out.extend(others.map(|(arm, file)| (file, json(&self.other_json(arm)))));
        out
    }

    /// Writes the [`files`](Self::files) of the result into a folder.
    ///
    /// # Errors
    /// The folder or a file cannot be written.
    pub fn write(&self, folder: &Path) -> std::io::Result<()> {
        create_folder(folder)?;
        self.files().into_iter().try_for_each(|(name, text)| write_whole(&folder.join(name), text.as_bytes()))
    }
}

fn describe(finding: &Finding, verdict: Verdict) -> String {
    let word = if verdict == Verdict::Explained { "" } else { "suspect " };
    let mut out = format!("  {word}{}:", finding.label());
    for (name, estimates) in &finding.parameters {
        let said = |e: &Estimate| match word_of(&finding.effect, name, e.value) {
            Some(word) => word.to_string(),
            None => value(e),
        };
        let values: Vec<String> = estimates.iter().map(said).collect();
        let _ = write!(out, " {name} = {}", values.join("; "));
    }
    out.push('\n');
    if !finding.indistinguishable_from.is_empty() {
        let others: Vec<String> =
            finding.indistinguishable_from.iter().map(|(e, at)| format!("{e}@{at}")).collect();
        let _ = writeln!(out, "    these readings cannot tell it from {}", others.join(", "));
    }
    out
}

fn value(e: &Estimate) -> String {
    let end = |v: Option<f64>| v.map_or("?".to_string(), number);
    format!("{} ({} to {})", number(e.value), end(e.low), end(e.high))
}

/// The number `x` as text with four significant figures.
fn number(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        a if (1e-3..1e5).contains(&a) => {
            let digits = (3 - libm::log10(a).floor() as i32).max(0) as usize;
            format!("{x:.digits$}")
        }
        _ => format!("{x:.3e}"),
    }
}
