//! The front under scatter of the catalog ratings: how often a design stays on the front, how often a pick is still
//! picked, and which design replaces it.

use super::number::{percent_short, shortest, significant};
use super::picks::{Design, Objective, PICKS};
use super::section::PageSection;
use super::supplement::Supplement;
use super::table::{Column, Table, csv_line};
use super::words::{TERMINAL, wrap};
use serde_json::{Value, json};

/// Name of the file with the results of every design under scatter.
pub const FILE: &str = "tolerance.csv";
/// Key of the results under scatter in `run.json`.
pub const KEY: &str = "tolerance";

/// The percentiles that are computed for each objective \[%\].
pub const PERCENTILES: [u32; 3] = [5, 50, 95];

/// The results of one design of the front over all samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Fate {
    /// The design, with its objectives by the catalog ratings.
    pub design: Design,
    /// What the design is picked for with the catalog ratings.
    pub picks: Vec<&'static str>,
    /// Number of samples in which the design is on the front.
    pub on_front: u32,
    /// Number of samples in which the design meets the limits on deflection, mass and lowest mode.
    pub keeps_limits: u32,
    /// Number of samples in which the design is picked, for each of [`PICKS`].
    pub picked: [u32; 4],
    /// [`PERCENTILES`] of tip deflection \[mm\], mass \[kg\] and lowest mode \[Hz\]; `None` for a design that is no
    /// pick.
    pub percentiles: Option<[[f64; 3]; 3]>,
}

/// The results of a front under scatter.
#[derive(Debug, Clone, PartialEq)]
pub struct Scattered {
    /// The scatter of each kind of rating, in words: `gear_stiffness 20 %`.
    pub words: Vec<String>,
    /// The scatter of each kind of rating: its name, and the scatter as a fraction.
    pub parts: Vec<(&'static str, f64)>,
    /// Number of samples.
    pub samples: u32,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Number of samples in which no design of the front meets the limits.
    pub without_design: u32,
    /// The results of every design of the front, lightest first.
    pub fates: Vec<Fate>,
}

impl Scattered {
    /// The results of the front under scatter as CSV, one row per design of the front.
    pub fn to_csv(&self) -> String {
        let mut columns = vec![
            "design_id".to_string(),
            "picks".into(),
            "on_front_share".into(),
            "keeps_limits_share".into(),
        ];
        columns.extend(PICKS.iter().map(|p| format!("{}_share", p.replace(' ', "_"))));
        for objective in ["tip_deflection_mm", "mass_kg", "lowest_mode_hz"] {
            columns.extend(PERCENTILES.iter().map(|p| format!("{objective}_p{p:02}")));
        }
        let row = |fate: &Fate| {
            let mut cells = vec![fate.design.design_id.clone(), fate.picks.join("; ")];
            cells.extend([fate.on_front, fate.keeps_limits].map(|n| shortest(self.share(n))));
            cells.extend(fate.picked.map(|n| shortest(self.share(n))));
            match &fate.percentiles {
                Some(values) => cells.extend(values.iter().flatten().map(|&x| shortest(x))),
                None => cells.extend(std::iter::repeat_n(String::new(), 9)),
            }
            csv_line(&cells)
        };
        std::iter::once(csv_line(&columns)).chain(self.fates.iter().map(row)).collect()
    }

    /// A table of the picks: how often each is on the front, how often it is still picked, and the range of its
    /// objectives.
    pub fn table(&self) -> Table {
        let mut table = Table::new(vec![
            Column::left("pick"),
            Column::left("design"),
            Column::right("on front"),
            Column::right("picked"),
            Column::right("tip mm 5-95 %"),
            Column::right("mode Hz 5-95 %"),
        ]);
        for (name, fate) in self.picks() {
            let band = |objective: usize| {
                fate.percentiles.map_or(String::new(), |p| {
                    format!("{} - {}", significant(p[objective][0], 4), significant(p[objective][2], 4))
                })
            };
            table.row([
                PICKS[name].to_string(),
                fate.design.design_id.clone(),
                percent_short(self.share(fate.on_front)),
                percent_short(self.share(fate.picked[name])),
                band(0),
                band(2),
            ]);
        }
        table
    }

    /// The results in sentences: what was sampled, which designs replace a pick, how much of the front stays.
    pub fn sentences(&self) -> Vec<String> {
        let mut out = vec![format!(
            "{} samples (seed {}) of {}; 95 % of the rows' true ratings are taken to lie within that scatter.",
            self.samples,
            self.seed,
            self.words.join(", ")
        )];
        out.extend(self.picks().filter_map(|(name, fate)| self.displaced(name, fate)));
        let mut shares: Vec<f64> = self.fates.iter().map(|f| self.share(f.on_front)).collect();
        shares.sort_unstable_by(f64::total_cmp);
        let firm = shares.iter().filter(|s| **s >= 0.9).count();
        out.push(format!(
            "Of the {} designs of the front, {firm} stay on it in at least 90 % of the samples; the least robust design stays in {}.",
            shares.len(),
            shares.first().map_or_else(String::new, |&s| percent_short(s)),
        ));
        let meets = self.fates.iter().filter(|f| f.keeps_limits < self.samples).count();
        if meets > 0 {
            out.push(format!("{meets} of them break a limit in at least one sample."));
        }
        if self.without_design > 0 {
            let share = percent_short(self.share(self.without_design));
            out.push(format!("In {share} of the samples no design of the front keeps the limits."));
        }
        out
    }

    /// All outputs of these results: file, sections, facts and words for the terminal.
    pub fn supplement(&self) -> Supplement {
        let sentences: String = self.sentences().iter().map(|s| wrap(s, TERMINAL, "")).collect();
        Supplement {
            file: Some((FILE, self.to_csv().into_bytes())),
            markdown: self.to_markdown(),
            section: Some(self.section()),
            run: Some((KEY, self.to_json())),
            terminal: format!("{}\n{sentences}", self.table().to_text()),
        }
    }

    /// The results of the front under scatter, as a section of the page.
    pub fn section(&self) -> PageSection {
        let mut words = self.sentences();
        words.push("Parts are not sized again, and only designs of this front are compared.".into());
        PageSection {
            title: "Under scatter".into(),
            words,
            tables: vec![("Picks under scatter; tolerance.csv has every design".into(), self.table())],
            figures: Vec::new(),
        }
    }

    /// The results of the front under scatter, as a section of `summary.md`.
    pub fn to_markdown(&self) -> String {
        let lines: Vec<String> = self.sentences().iter().map(|s| format!("- {s}\n")).collect();
        format!(
            "\n## Under scatter\n\n{}\n{}- Parts are not sized again, and only designs of this front are compared. Every design: tolerance.csv.\n",
            self.table().to_markdown(),
            lines.concat()
        )
    }

    /// The results of the front under scatter, as an entry of `run.json`.
    pub fn to_json(&self) -> Value {
        let scatter: serde_json::Map<String, Value> =
            self.parts.iter().map(|(name, part)| ((*name).to_string(), json!(part))).collect();
        let picks: Vec<Value> = self
            .picks()
            .map(|(name, fate)| {
                json!({
                    "pick": PICKS[name], "design": fate.design.design_id,
                    "on_front_share": self.share(fate.on_front),
                    "still_picked_share": self.share(fate.picked[name]),
                })
            })
            .collect();
        json!({"scatter": scatter, "samples": self.samples, "seed": self.seed, "picks": picks})
    }

    /// For every pick, its index in [`PICKS`] and the design that is picked with the catalog ratings.
    fn picks(&self) -> impl Iterator<Item = (usize, &Fate)> {
        PICKS.iter().enumerate().filter_map(|(name, word)| {
            Some((name, self.fates.iter().find(|fate| fate.picks.contains(word))?))
        })
    }

    /// A sentence that names the designs that replace the pick with the index `name` in some samples, most often first.
    /// `fate` is the design that is picked with the catalog ratings. `None` if no design replaces it.
    fn displaced(&self, name: usize, fate: &Fate) -> Option<String> {
        let mut others: Vec<&Fate> =
            self.fates.iter().filter(|f| f.picked[name] > 0 && f.design.row != fate.design.row).collect();
        others.sort_by_key(|f| std::cmp::Reverse(f.picked[name]));
        let most: Vec<String> = others
            .iter()
            .take(3)
            .map(|f| format!("{} in {}", f.design.design_id, percent_short(self.share(f.picked[name]))))
            .collect();
        let more = match others.len().saturating_sub(3) {
            0 => String::new(),
            n => format!(" and {n} more"),
        };
        (!most.is_empty()).then(|| {
            format!("{} is displaced as {} by {}{more}.", fate.design.design_id, PICKS[name], most.join(", "))
        })
    }

    fn share(&self, samples: u32) -> f64 {
        f64::from(samples) / f64::from(self.samples)
    }
}

/// The value below which `percent` percent of the values in `sorted` lie. Between two values it is interpolated.
pub fn percentile(sorted: &[f64], percent: u32) -> f64 {
    let place = f64::from(percent) / 100.0 * (sorted.len().saturating_sub(1)) as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

/// [`PERCENTILES`] of tip deflection \[mm\], mass \[kg\] and lowest mode \[Hz\] of a design. `samples` has the
/// objectives of the design in each sample.
pub fn percentiles(samples: &[Design]) -> [[f64; 3]; 3] {
    Objective::ALL.map(|objective| {
        let mut values: Vec<f64> = samples.iter().map(|d| objective.of(d)).collect();
        values.sort_unstable_by(f64::total_cmp);
        PERCENTILES.map(|p| percentile(&values, p))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_percentile_lies_between_its_neighbours() {
        let values = [1.0, 2.0, 3.0, 4.0, 5.0];
        assert_eq!([0, 5, 50, 100].map(|p| percentile(&values, p)), [1.0, 1.2, 3.0, 5.0]);
        assert_eq!(percentile(&[7.0], 95), 7.0);
    }
}
