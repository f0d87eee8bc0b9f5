//! What a run knows besides its fronts.

use super::caveats::Caveats;
use super::number::{shortest, significant};
use crate::space::constraint::Constraints;

/// What a run knows besides its fronts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SummaryFacts {
    /// Name of the study.
    pub study: String,
    /// Its question in a sentence.
    pub question: String,
    /// How the search ended: `complete`, `certified`, `partial`, `infeasible` or `interrupted`.
    pub status: String,
    /// Designs in the space.
    pub designs_total: u128,
    /// Designs whose three objectives were computed.
    pub designs_evaluated: u128,
    /// Designs left out because a limit cannot be met.
    pub designs_excluded: u128,
    /// For a search that was stopped or asked for a gap: for every design of the study some listed one is worse by at
    /// most this fraction in each objective.
    pub gap: Option<f64>,
    /// Duration of the search \[s\].
    pub elapsed_s: f64,
    /// Worker threads; 0 = not known.
    pub threads: usize,
    /// Version of the program.
    pub tool_version: String,
    /// Constraints in words; see [`constraint_words`].
    pub constraints: Vec<String>,
    /// Names of the cases, the worst of which counts.
    pub cases: Vec<String>,
    /// How far the joints turn, in words; joints of the same range share a line.
    pub ranges: Vec<String>,
    /// Parts and options left out because a rating is unknown, in words.
    pub not_checked: Vec<String>,
    /// What a reader of the result should know of the question, in sentences.
    pub remarks: Vec<String>,
    /// Parts whose figures no document was seen for.
    pub caveats: Caveats,
    /// Result folder as it is typed.
    pub results: String,
}

impl SummaryFacts {
    /// Whether the search was stopped before its end.
    pub fn is_stopped(&self) -> bool {
        ["partial", "interrupted"].contains(&self.status.as_str())
    }

    /// Whether no design is missing.
    pub fn is_whole(&self) -> bool {
        !self.is_stopped() && self.gap.is_none_or(|gap| gap == 0.0)
    }
}

/// Constraints in words, one a line; empty if there are none.
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
