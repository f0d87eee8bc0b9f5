//! Tests whether the readings are too few, or too similar to each other, to settle anything.

use crate::arm::effect::channel::Channel;
use crate::reconcile::forward::datum::Datum;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::readings::components::FEWEST_ALIKE;
use crate::reconcile::readings::rows::StaticRow;
use crate::reconcile::select::few_rows;

/// Smallest number of poses with which effects at different places can be told apart.
pub(crate) const FEWEST_POSES: usize = 3;

/// Number of rows of the campaign in the files of displacements, frequencies and bench readings together.
pub(crate) fn rows(campaign: &Campaign) -> usize {
    campaign.statics.len() + campaign.modal.len() + campaign.windup.len()
}

/// Reasons why the readings cannot settle anything, one sentence each; empty if there are none.
pub(crate) fn too_little(campaign: &Campaign, forward: &Forward) -> Vec<String> {
    let mut reasons = Vec::new();
    let rows = rows(campaign);
    if rows < few_rows::FEWEST_ROWS {
        reasons.push(format!("{rows} rows are too few: give at least {}", few_rows::FEWEST_ROWS));
    }
    let mut poses: Vec<&Vec<f64>> = campaign
        .statics
        .iter()
        .map(|r| &r.pose_deg)
        .chain(campaign.modal.iter().map(|r| &r.pose_deg))
        .collect();
    poses.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    poses.dedup();
    if poses.len() < FEWEST_POSES && !(poses.is_empty() && rows >= few_rows::FEWEST_ROWS) {
        reasons.push(format!(
            "{} distinct pose(s): effects at different places look the same; measure at least {FEWEST_POSES}",
            poses.len()
        ));
    }
    let first = campaign.statics.first();
    let same_load = |r: &StaticRow| {
        first.is_some_and(|f| f.payload.mass_kg == r.payload.mass_kg && f.force_n == r.force_n)
    };
    reasons.extend(dead_instruments(forward));
    if first.is_some() && campaign.statics.iter().all(same_load) {
        reasons.push(
            "every static reading has the same load: an effect that grows with load cannot be told from one that does not"
                .into(),
        );
    }
    reasons
}

/// Sentences on channels whose readings are all equal, and a sentence if no reading exceeds the noise.
fn dead_instruments(forward: &Forward) -> Vec<String> {
    let mut out = Vec::new();
    for channel in [Channel::Static, Channel::Modal, Channel::Windup] {
        let data = &forward.data[forward.range(channel)];
        let first = [0, 1, 2].map(|component| data.iter().find(|d| d.component == component));
        let is_first = |d: &Datum| first[d.component].is_some_and(|first| first.value == d.value);
        if data.last().is_some_and(|d| d.row + 1 >= FEWEST_ALIKE) && data.iter().all(is_first) {
            out.push(format!(
                "every {} reading is the same: the instrument did not follow the arm",
                channel.word()
            ));
        }
    }
    if !forward.data.is_empty() && forward.data.iter().all(|d| d.value.abs() < 2.0 * d.sigma) {
        out.push("no reading is twice its standard deviation: there is nothing to compare".into());
    }
    out
}
