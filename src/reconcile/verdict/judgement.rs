//! Rules that are the same for displacements, positions and records: which verdict applies to several kinds of
//! readings, which effects are named with a verdict, and what prevents an effect from being named.

use super::outcome::Verdict;
use crate::reconcile::model::estimate::Finding;

/// Limit of the residuals that the best model would leave on held-out poses even if it were right \[standard
/// deviations\]. Above it, only the poses of one fold show some effect, so held-out poses cannot confirm it.
pub(crate) const SHOWN_BY_ONE_FOLD: f64 = 1.5;
/// An effect is only suspected if it raises the natural logarithm of the evidence by less than this. Such evidence is
/// not yet strong (Kass and Raftery 1995, table of Bayes factors).
pub(crate) const WEAK_EVIDENCE: f64 = 3.0;
/// Reason that is written for the verdict `no_gap`.
pub(crate) const NOTHING_MISSING: &str = "noise and calibration within tolerance explain every reading";
/// Reason that is written for the verdict `no_gap` if a calibrated factor is outside its tolerance.
pub(crate) const BEYOND_TOLERANCE: &str =
    "noise and calibration explain every reading, but not within tolerance";
/// An effect is named only if at most this many alternatives would fit as well.
const MOST_ALTERNATIVES: usize = 3;
/// If the root mean square residual with all effects exceeds this many standard deviations, something else is missing,
/// whatever effects are named. The right effects leave at most 1.3 in campaigns of several simulators.
pub(crate) const TOO_FAR_OFF: f64 = 1.8;

impl Verdict {
    /// The common verdict on several kinds of readings, each of which was judged by itself: the least favourable of
    /// the verdicts `said`.
    pub(crate) fn on_all(said: &[Verdict]) -> Verdict {
        let order = [Verdict::Unexplained, Verdict::InsufficientData, Verdict::Explained];
        order.into_iter().find(|verdict| said.contains(verdict)).unwrap_or(Verdict::NoGap)
    }

    /// Whether the readings are explained, with or without effects.
    pub(crate) fn is_settled(self) -> bool {
        matches!(self, Verdict::Explained | Verdict::NoGap)
    }

    /// Divides the effects `found` into those that are named (first) and those that are only suspected (second), as the
    /// verdict demands. `suspects` are effects that were only suspected before the verdict. No effects are stated if
    /// the verdict is `unexplained`.
    pub(crate) fn named_and_suspected(
        self,
        found: Vec<Finding>,
        suspects: Vec<Finding>,
    ) -> (Vec<Finding>, Vec<Finding>) {
        match self {
            Verdict::Explained => (found, Vec::new()),
            Verdict::InsufficientData | Verdict::NoGap => (Vec::new(), [found, suspects].concat()),
            Verdict::Unexplained => (Vec::new(), Vec::new()),
        }
    }
}

/// Sentence that held-out poses cannot confirm the effects with this label, because few poses show them.
pub(crate) fn shows_in_few_poses(label: &str) -> String {
    format!(
        "{label} shows in few poses only, so that poses held out of the fit cannot confirm it: repeat the tests that show it \
         in other poses"
    )
}

/// Sentence that `count` alternatives fit as well as the effect `label`; `None` if there are few enough to name it.
pub(crate) fn too_many_alternatives(label: &str, count: usize) -> Option<String> {
    (count > MOST_ALTERNATIVES).then(|| format!("{count} other effects fit as well as {label}"))
}

/// Sentence that the model `label` predicts held-out poses worse than calibration alone. `after` and `before` are the
/// errors with and without the effects, in words.
pub(crate) fn does_not_predict(label: &str, after: &str, before: &str) -> String {
    format!("{label} does not predict poses it was not fitted to ({after} after, {before} before)")
}
