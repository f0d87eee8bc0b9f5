//! What every reader of a campaign judges alike, be it of displacements, positions or records: which verdict prevails, what
//! becomes of the effects under it, and what keeps an effect from being named.

use super::outcome::Verdict;
use crate::reconcile::model::estimate::Finding;

/// An effect is named only if at most this many alternatives would fit as well.
const MOST_ALTERNATIVES: usize = 3;

impl Verdict {
    /// The verdict on readings of several kinds that were judged each by itself: the least favourable one.
    pub(crate) fn on_all(said: &[Verdict]) -> Verdict {
        let order = [Verdict::Unexplained, Verdict::InsufficientData, Verdict::Explained];
        order.into_iter().find(|verdict| said.contains(verdict)).unwrap_or(Verdict::NoGap)
    }

    /// Whether the readings are understood.
    pub(crate) fn is_settled(self) -> bool {
        matches!(self, Verdict::Explained | Verdict::NoGap)
    }

    /// The effects that are named and those that are only suspected. Nothing is said of effects where nothing explains the
    /// readings.
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

/// Says that too many alternatives fit as well as an effect, if they do.
pub(crate) fn too_many_alternatives(label: &str, count: usize) -> Option<String> {
    (count > MOST_ALTERNATIVES).then(|| format!("{count} other effects fit as well as {label}"))
}

/// Says that a model is worse than calibration at poses that it was not fitted to.
pub(crate) fn does_not_predict(label: &str, after: &str, before: &str) -> String {
    format!("{label} does not predict poses it was not fitted to ({after} after, {before} before)")
}
