//! Facts of a run, in addition to its fronts.

use super::caveats::Caveats;
use super::number::{shortest, significant};
use crate::space::constraint::Constraints;
use std::collections::BTreeMap;

/// Facts of a run that its reports print in addition to its fronts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SummaryFacts {
    /// Name of the study.
    pub study: String,
    /// The question of the study in a sentence.
    pub question: String,
    /// How the search ended: `complete`, `certified`, `partial`, `infeasible` or `interrupted`.
    pub status: String,
    /// Number of designs in the space.
    pub designs_total: u128,
    /// Number of designs whose three objectives were computed.
    pub designs_evaluated: u128,
    /// Number of designs excluded because a drive, a link or a limit rules them out.
    pub designs_excluded: u128,
    /// Gap of an exact search: for every design of the study, some listed design is worse by at most this fraction in
    /// each objective. 0 means that the front is whole. `None` for an exhaustive search, or if no gap was proved.
    pub gap: Option<f64>,
    /// Duration of the search \[s\].
    pub elapsed_s: f64,
    /// Number of worker threads; 0 if it is not known.
    pub threads: usize,
    /// Version of the program.
    pub tool_version: String,
    /// Constraints in words; see [`constraint_words`].
    pub constraints: Vec<String>,
    /// Names of the cases. For each objective the worst of them counts.
    pub cases: Vec<String>,
    /// Ranges of the joint angles, in words; joints with the same range share a line.
    pub ranges: Vec<String>,
    /// Parts and options that were left out because a rating is unknown, in words.
    pub not_checked: Vec<String>,
    /// Remarks about the study that a reader of the result should know, in sentences.
    pub remarks: Vec<String>,
    /// For each material that only some of the open links offer, the names of the links that do not offer it.
    pub materials_of_some_links: BTreeMap<String, Vec<String>>,
    /// Parts whose ratings were not read from a document.
    pub caveats: Caveats,
    /// Path of the result folder, as the user typed it.
    pub results: String,
}

impl SummaryFacts {
    /// Whether the search was stopped before its end.
    pub fn is_stopped(&self) -> bool {
        ["partial", "interrupted"].contains(&self.status.as_str())
    }

    /// Whether the front is complete: the search was not stopped and its gap is zero.
    pub fn is_whole(&self) -> bool {
        !self.is_stopped() && self.gap.is_none_or(|gap| gap == 0.0)
    }
}

/// Constraints in words, one per entry; empty if there are none.
pub fn constraint_words(constraints: &Constraints) -> Vec<String> {
    let c = constraints;
    let plain = shortest;
    [
        c.tip_deflection_max_m.map(|v| format!("tip deflection at most {} mm", significant(v * 1e3, 4))),
        c.mass_max_kg.map(|v| format!("mass at most {} kg", plain(v))),
        c.lowest_mode_min_hz.map(|v| format!("lowest mode at least {} Hz", plain(v))),
        c.servo.map(|s| {
            let (bandwidth, ratio) = (plain(s.bandwidth_hz), plain(s.ratio));
            format!("lowest mode at least {ratio} times the servo bandwidth of {bandwidth} Hz")
        }),
        c.stress_safety_factor_min
            .map(|v| format!("strength at least {} times the stress at peak load", plain(v))),
        c.wall_slenderness_max
            .map(|v| format!("flat width at most {} times the wall (local buckling)", plain(v))),
        c.material_cost_max_eur.map(|v| format!("links' material at most {} EUR", plain(v))),
    ]
    .into_iter()
    .flatten()
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constraints_are_said_in_words() {
        let constraints = Constraints {
            tip_deflection_max_m: Some(0.002),
            stress_safety_factor_min: Some(2.0),
            ..Constraints::default()
        };
        assert_eq!(
            constraint_words(&constraints),
            ["tip deflection at most 2.000 mm", "strength at least 2 times the stress at peak load"]
        );
        assert!(constraint_words(&Constraints::default()).is_empty());
    }
}
