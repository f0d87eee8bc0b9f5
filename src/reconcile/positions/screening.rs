//! Long campaigns: effects are screened on a part of the rows.
//!
//! The search for effects fits the model hundreds of times. The likelihood ratio of two models grows with the number of
//! rows, so what a part of the rows shows clearly is also shown by all rows. The search of a long campaign therefore
//! first goes through a few thousand rows ([`SCREENED`]). The model that it finds is then fitted to all rows. There it
//! has to be worth its price and to be confirmed by held-out poses. The search then goes on from this model on all
//! rows. Every candidate is tried once more by the linearized model of all rows, so that an effect that only all rows
//! show can be found too. The number of passes over all rows does not grow with the number of rows.
//!
//! The rows are the same in every run. Each combination of session, point, arm and load gets an equal number of these
//! rows, if it has enough rows. The other rows are spread evenly. For each joint, the rows with its smallest and its
//! largest angle are added. A row keeps its fold, so that poses which are held out of a fit to all rows are also held
//! out of the fits of the screening.

use super::align::align;
use super::analysis::Positions;
use super::deflection::Deflection;
use super::fitted::{Fitted, Sample, readings};
use super::kinematics::number_groups;
use super::transmission::EFFECT as TRANSMISSION;
use crate::reconcile::fit::stats::scrambled;
use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::readings::rows::PositionRow;
use nalgebra::Vector3;
use std::sync::Arc;

/// A campaign with more rows than this is long. In a shorter one, effects are searched on all rows.
pub(super) const LONG: usize = 5_000;
/// Number of rows on which the effects of a long campaign are screened, not counting the rows with extreme joint
/// angles.
const SCREENED: usize = 4_000;
/// Largest number of rows that are added for their extreme joint angles.
const ENDS: usize = 400;
/// A robust fit raises the logarithm of the likelihood by at most about this multiple of the rise that the linearized
/// model expects.
const ROBUST: f64 = 2.0;

/// Key of a stratum of rows: arm, point, session of the instrument, and load. Each stratum keeps an equal number of
/// rows.
type Stratum = (usize, usize, usize, [u64; 4]);

fn stratum(sample: &Sample, row: &PositionRow) -> Stratum {
    let [x, y, z] = row.payload.cg_m.into();
    (sample.arm, sample.point, sample.station, [row.payload.mass_kg, x, y, z].map(f64::to_bits))
}

/// Indices of the [`SCREENED`] rows that are kept. `strata` has the stratum of every row. Half of the kept rows are
/// taken in equal numbers from each stratum, the others evenly from the remaining rows.
fn spread(strata: &[Stratum]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..strata.len()).collect();
    order.sort_by_key(|&i| (strata[i], scrambled(i)));
    let groups = || order.chunk_by(|a, b| strata[*a] == strata[*b]);
    let least = SCREENED / 2 / groups().count().max(1);
    let mut kept: Vec<usize> = groups().flat_map(|own| &own[..least.min(own.len())]).copied().collect();
    let rest: Vec<usize> = groups().flat_map(|own| &own[least.min(own.len())..]).copied().collect();
    let more = SCREENED.saturating_sub(kept.len()).min(rest.len());
    kept.extend((0..more).map(|k| rest[k * rest.len() / more]));
    kept
}

/// The indices of the rows with the smallest and the largest angle of each joint.
fn ends(rows: &[PositionRow]) -> Vec<usize> {
    let joints = rows.first().map_or(0, |row| row.pose_deg.len());
    let end = |j: usize, sign: f64| {
        let angle = |i: &usize| sign * rows[*i].pose_deg[j];
        (0..rows.len()).min_by(|a, b| angle(a).total_cmp(&angle(b)))
    };
    (0..joints).flat_map(|j| [end(j, 1.0), end(j, -1.0)]).flatten().take(ENDS).collect()
}

impl Positions {
    /// Whether the campaign is long, so that effects are screened on a part of its rows.
    pub(super) fn is_long(&self) -> bool {
        self.samples.len() > LONG
    }

    /// A subset of the rows of a long campaign, as a campaign, and this model restricted to these rows. `None` if the
    /// campaign is not long.
    pub(super) fn few(&self, campaign: &Campaign) -> Option<(Campaign, Self)> {
        if !self.is_long() {
            return None;
        }
        let rows = &campaign.positions;
        let strata: Vec<Stratum> = self.samples.iter().zip(rows).map(|(s, row)| stratum(s, row)).collect();
        let mut kept = spread(&strata);
        kept.extend(ends(rows));
        kept.sort_unstable();
        kept.dedup();
        let own = kept.iter().map(|&i| rows[i].clone()).collect();
        let few = Campaign::of_positions(&campaign.statement, &campaign.arms(), own).ok()?;
        Some((few, self.of_rows(&kept)))
    }

    /// This model restricted to the rows `kept`, whose indices must be sorted.
    fn of_rows(&self, kept: &[usize]) -> Self {
        let own = kept.iter().enumerate();
        let samples = own.map(|(index, &i)| Sample { index, ..self.samples[i].clone() }).collect();
        let mut sessions = self.sessions.clone();
        sessions.iter_mut().for_each(|b| b.first = kept.partition_point(|&i| i < b.first));
        // field by field, because a clone would copy all samples
        Self {
            samples,
            sessions,
            stages: Vec::new(),
            candidates: self.candidates.clone(),
            considered: self.considered.clone(),
            considers_transmissions: self.considers_transmissions,
            fitted: self.fitted.clone(),
            rigid: self.rigid.clone(),
            gross: Vec::new(),
            numbers: self.numbers.clone(),
            transmissions: self.transmissions.clone(),
            dependences: self.dependences.clone(),
            named_dependences: self.named_dependences.clone(),
            tree: self.tree.clone(),
            points: self.points.clone(),
            held_out: Vec::new(),
            screened: None,
            posterior: None,
        }
    }

    /// Fits of the geometry to a subset of the rows of a long campaign, one after each group of numbers that is freed.
    /// Empty if the campaign is not long.
    pub(super) fn starts(&self, campaign: &Campaign) -> Vec<Fitted> {
        let Some((rows, mut few)) = self.few(campaign) else { return Vec::new() };
        let spec = &campaign.statement.positions;
        align(&few.tree, spec, &few.samples, &mut few.fitted.geometry);
        let groups = number_groups(&few.tree, spec, few.points.len()).into_iter();
        let fits = groups.map(|(_, group)| {
            few.numbers.extend(group);
            few.settle_geometry(&rows);
            few.fitted.clone()
        });
        fits.collect()
    }

    /// Frees the memory of the samples' deflections, if the campaign is long.
    pub(super) fn drop_deflections(&mut self) {
        if self.is_long() {
            let none = Arc::new(Deflection::known(Vector3::zeros()));
            self.samples.iter_mut().for_each(|sample| sample.deflection = Arc::clone(&none));
        }
    }

    /// Computes the deflections again that [`drop_deflections`](Self::drop_deflections) dropped.
    pub(super) fn recompute_deflections(&mut self, campaign: &Campaign) {
        if self.is_long() {
            self.refresh(campaign);
        }
    }

    /// Adds to the model of a long campaign the effects that a subset of the rows shows, if all rows confirm them.
    pub(super) fn take_screened(&mut self, campaign: &Campaign) {
        let Some((rows, mut few)) = self.few(campaign) else { return };
        self.screened = Some(few.samples.len());
        few.refit();
        few.find_effects(&rows);
        let added = few.labels_beyond(self);
        if added.is_empty() {
            return;
        }
        let next = Self {
            fitted: few.fitted,
            numbers: few.numbers,
            candidates: few.candidates,
            transmissions: few.transmissions,
            named_dependences: few.named_dependences,
            ..self.clone()
        };
        // the deflections of all rows need much memory, so those of this model are computed again only if the model
        // stays
        self.drop_deflections();
        if !self.take_if_confirmed(campaign, next, added.join(" + ")) {
            self.recompute_deflections(campaign);
        }
    }

    /// The names of all effects of this model.
    fn effect_labels(&self) -> Vec<String> {
        let springs = self.fitted.effects.iter().map(|e| self.label(*e));
        let dependent = self.named_dependences.iter().map(|k| self.dependence_label(*k));
        let uneven = self.transmissions.iter().map(|j| format!("{TRANSMISSION}@{}", self.tree.driven[*j]));
        springs.chain(dependent).chain(uneven).collect()
    }

    /// The names of all effects of this model that the model `other` does not have.
    fn labels_beyond(&self, other: &Self) -> Vec<String> {
        let [own, known] = [self, other].map(Self::effect_labels);
        own.into_iter().filter(|label| !known.contains(label)).collect()
    }

    /// A sentence that says on how many rows the effects were screened; `None` if all rows were searched.
    pub(super) fn screening_sentence(&self) -> Option<String> {
        self.screened.map(|screened| {
            let all = self.samples.len();
            format!(
                "which effects: screened on {screened} of {all} positions, and once more on all by the linearized model; all \
                 numbers are from all positions"
            )
        })
    }

    /// Whether a full fit may raise the logarithm of the likelihood by `asked`, if the linearized model expects a rise
    /// of `gain`. Always true in a campaign that is not long, because a full fit is cheap there.
    pub(super) fn may_rise(&self, gain: f64, asked: f64) -> bool {
        !self.is_long() || self.keeps_its_promise(gain, asked)
    }

    /// Whether a robust fit may raise the logarithm of the likelihood by `asked`, if the linearized model expects
    /// `gain`.
    pub(super) fn keeps_its_promise(&self, gain: f64, asked: f64) -> bool {
        ROBUST * self.promised(gain) > asked
    }

    /// The rise of the logarithm of the likelihood that follows if half of chi-squared falls by `gain`. The scale of
    /// the errors is fitted, so that chi-squared is the number of readings. A fall of the squares therefore lowers the
    /// scale.
    fn promised(&self, gain: f64) -> f64 {
        let count = readings(&self.samples) as f64;
        -0.5 * count * libm::log((1.0 - 2.0 * gain / count).max(f64::MIN_POSITIVE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROWS: usize = 20_000;

    /// Rows in a regular order of twenty poses: the first seven of a session of their own, ten with a load of their own.
    fn strata() -> Vec<Stratum> {
        let load = |i: usize| if i % 2_000 == 1_999 { 10.0f64 } else { 0.0 };
        (0..ROWS).map(|i| (0, 0, usize::from(i < 7), [load(i).to_bits(), 0, 0, 0])).collect()
    }

    #[test]
    fn rare_loads_and_short_sessions_keep_all_their_rows_and_the_others_are_spread() {
        let kept = spread(&strata());
        assert_eq!(kept.len(), SCREENED);
        let is_rare = |i: usize| i < 7 || i % 2_000 == 1_999;
        assert_eq!(kept.iter().filter(|i| is_rare(**i)).count(), 17);
        let near = |count: usize, of: usize| (count as f64 / of as f64 - 1.0).abs() < 0.25;
        for part in 0..10 {
            let own = kept.iter().filter(|i| *i / 2_000 == part).count();
            assert!(near(own, SCREENED / 10), "tenth {part}: {own}");
        }
        for pose in 0..20 {
            let own = kept.iter().filter(|i| *i % 20 == pose).count();
            assert!(near(own, SCREENED / 20), "pose {pose}: {own}");
        }
    }

    #[test]
    fn more_loads_than_rows_that_are_kept_are_spread_too() {
        let each_its_own: Vec<Stratum> = (0..ROWS).map(|i| (0, 0, 0, [i as u64, 0, 0, 0])).collect();
        let mut kept = spread(&each_its_own);
        kept.sort_unstable();
        assert_eq!(kept.len(), SCREENED);
        assert!(kept.windows(2).all(|pair| pair[1] - pair[0] == ROWS / SCREENED), "evenly");
    }
}
