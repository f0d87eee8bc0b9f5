//! The boundaries between sessions: how far the measured points jump there, what else changes at the same row, and
//! whether the session is still worth its price once the effects are in the model.

use super::analysis::Positions;
use super::fit::fit;
use super::fitted::{Fitted, Sample};
use super::kinematics::Placing;
use super::moved::{Boundary, Kind, Moved};
use super::sessions::telling_part;
use crate::reconcile::fit::stats::median;
use crate::reconcile::readings::campaign::Campaign;
use rayon::prelude::*;

/// A jump of the measured points of at least this size is larger than a reflector that is taken off and put back causes
/// \[mm\].
const LARGE_MM: f64 = 1.0;
/// The evidence for a session is strong if its gain exceeds its price by at least this much \[ln of the likelihood\].
const STRONG: f64 = 10.0;
/// Number of rows on each side of a session boundary that are compared to find what else changes at the boundary.
const BESIDE: usize = 15;
/// Smallest number of rows on each side of a session boundary from which it is judged what else changes at the
/// boundary. With fewer rows, it is assumed that nothing else changes.
const FEWEST_BESIDE: usize = 4;

impl Positions {
    /// Boundaries between sessions: the declared ones if `declared` is true, otherwise those that were found. Each is
    /// a pair: what was moved, and the first row of the later session, counted from 0.
    pub(crate) fn boundaries(&self, declared: bool) -> Vec<(Kind, usize)> {
        self.sessions.iter().filter(|b| b.declared == declared).map(|b| (b.kind, b.first)).collect()
    }

    /// Sum of the prices of all undeclared sessions \[ln of the likelihood\]. The price is the rise of the logarithm
    /// of the likelihood that a session must bring to be kept.
    pub(super) fn sessions_price(&self) -> f64 {
        let kinds = self.kinds(true, true).len();
        let undeclared = self.sessions.iter().filter(|b| !b.declared);
        undeclared.map(|b| self.session_price(b.earlier.numbers().len(), kinds)).sum()
    }

    /// One sentence for each session boundary, in the order of the rows. It states how far the measured points jump at
    /// this boundary according to the final model.
    pub(crate) fn session_sentences(&self, campaign: &Campaign) -> Vec<String> {
        let mut in_order: Vec<&Boundary> = self.sessions.iter().collect();
        in_order.sort_by_key(|b| b.first);
        in_order.into_iter().map(|b| self.sentence(campaign, b)).collect()
    }

    fn sentence(&self, campaign: &Campaign, boundary: &Boundary) -> String {
        let row = boundary.first + 1;
        let geometry = &self.fitted.geometry;
        let mm = self.jump_mm(boundary);
        let what = match (self.labels(boundary), boundary.kind) {
            (Some((Moved::Point(before), Moved::Point(_))), _) => {
                format!("{} sat {mm:.2} mm away on the tool before row {row}", self.points[before].name)
            }
            (Some((Moved::Station(before), Moved::Station(after))), _) => {
                let ((turn, _), (own_turn, _)) = (&geometry.stations[before], &geometry.stations[after]);
                let mrad = 1e3 * turn.angle_to(own_turn);
                format!(
                    "before row {row} the instrument or the base stood elsewhere, turned by {mrad:.2} mrad: the measured \
                     points jump by {mm:.2} mm"
                )
            }
            _ => format!("something jumps before row {row}"),
        };
        let is_weak = || self.session_gain(boundary).0 < STRONG;
        match (boundary.declared, self.changes_at(campaign, boundary)) {
            (true, _) => format!("{what} (as declared)"),
            (false, None) if is_weak() => {
                format!("it looks as if {what} (a session of its own, for which the evidence is not strong)")
            }
            (false, None) => format!("{what}: a session of its own"),
            (false, Some(change)) => format!(
                "{what}, or something depends on {change}: these readings cannot tell a session from that, because both \
                 change at the same row"
            ),
        }
    }

    /// Labels of the sessions before and after a boundary, by the rows nearest to it; `None` if one side has no row.
    fn labels(&self, boundary: &Boundary) -> Option<(Moved, Moved)> {
        let (before, after) = self.samples.split_at(boundary.first);
        let is_own = |s: &&Sample| self.is_of(s, boundary.kind);
        let before = before.iter().rev().find(is_own)?;
        let after = after.iter().find(is_own)?;
        Some((boundary.kind.label(before), boundary.kind.label(after)))
    }

    /// Median distance by which the measured points jump at a session boundary, according to the fitted geometry
    /// \[mm\].
    fn jump_mm(&self, boundary: &Boundary) -> f64 {
        let Some((before, after)) = self.labels(boundary) else { return 0.0 };
        let mut placer = self.fitted.geometry.placer();
        let mut at_m = |sample: &Sample, label: Moved| {
            let own = sample.placing();
            placer.place_m(match label {
                Moved::Point(point) => Placing { point, ..own },
                Moved::Station(station) => Placing { station, ..own },
            })
        };
        let own = self.samples.iter().filter(|s| before.has(s) || after.has(s));
        median(own.map(|s| 1e3 * (at_m(s, before) - at_m(s, after)).norm()).collect())
    }

    /// A phrase (distance and row) for each undeclared session at which the measured points jump by [`LARGE_MM`] or
    /// more.
    pub(crate) fn large_jumps(&self) -> Vec<String> {
        let large = self.sessions.iter().filter(|b| !b.declared).map(|b| (b.first + 1, self.jump_mm(b)));
        large.filter(|(_, mm)| *mm >= LARGE_MM).map(|(row, mm)| format!("{mm:.2} mm at row {row}")).collect()
    }

    /// Names what else changes where a session begins: a joint's angle, the payload or the measured arm. A quantity is
    /// taken as changed if all its values in the rows before the boundary are below all values in the rows after it, or
    /// all above. `None` if nothing else changes.
    fn changes_at(&self, campaign: &Campaign, boundary: &Boundary) -> Option<String> {
        let own =
            |range: std::ops::Range<usize>| range.filter(|&i| self.is_of(&self.samples[i], boundary.kind));
        let before: Vec<usize> = own(0..boundary.first).rev().take(BESIDE).collect();
        let after: Vec<usize> = own(boundary.first..self.samples.len()).take(BESIDE).collect();
        if before.len().min(after.len()) < FEWEST_BESIDE {
            return None;
        }
        let rows = &campaign.positions;
        let angles = self.tree.driven.iter().enumerate().map(|(j, name)| {
            let of = |i: usize| rows[i].pose_deg[j];
            (
                format!("the angle of {name}"),
                [&before, &after].map(|side| side.iter().map(|&i| of(i)).collect()),
            )
        });
        let sides = |of: &dyn Fn(usize) -> f64| -> [Vec<f64>; 2] {
            [&before, &after].map(|side| side.iter().map(|&i| of(i)).collect())
        };
        let payload = ("the payload".to_string(), sides(&|i| rows[i].payload.mass_kg));
        let centre =
            (0..3).map(|c| ("the payload's centre".to_string(), sides(&|i| rows[i].payload.cg_m[c])));
        let arm = ("the arm that is measured".to_string(), sides(&|i| rows[i].arm as f64));
        let all: Vec<(String, [Vec<f64>; 2])> = angles.chain([payload, arm]).chain(centre).collect();
        let apart: Vec<String> =
            all.into_iter().filter(|(_, [a, b])| are_apart(a, b)).map(|(name, _)| name).collect();
        (!apart.is_empty()).then(|| apart.join(", "))
    }

    /// Whether some undeclared session begins at a row where something else changes, according to `changes_at`.
    pub(crate) fn has_doubtful_session(&self, campaign: &Campaign) -> bool {
        self.sessions.iter().any(|b| !b.declared && self.changes_at(campaign, b).is_some())
    }

    /// Drops a drift and undeclared sessions that are no longer worth their price (in ln of the likelihood) once effects are in
    /// the model, the least useful first. Returns whether any was dropped.
    pub(crate) fn drop_needless_sessions(&mut self) -> bool {
        let before = self.sessions.len();
        loop {
            let tried = self.sessions.iter().filter(|b| !b.declared).map(|b| self.session_gain(b));
            let needless = tried.filter(|(gain, _)| *gain < 0.0);
            let Some((_, without)) = needless.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            *self = without;
        }
        let steady = self.drop_needless_drift();
        steady || self.sessions.len() < before
    }

    /// The model without all sessions that were found, fitted again.
    pub(super) fn without_found_sessions(&self) -> Self {
        let mut out = self.clone();
        while let Some(boundary) = out.sessions.iter().find(|b| !b.declared) {
            out = out.without_session(boundary);
        }
        out
    }

    /// The gain of a session: the rise of the logarithm of the likelihood that it brings, as far as the rise is not due
    /// to chance, minus the price of the session. Also returns the model without its boundary.
    fn session_gain(&self, boundary: &Boundary) -> (f64, Self) {
        let without = self.without_session(boundary);
        let own = boundary.earlier;
        let price = self.session_price(own.numbers().len(), self.kinds(true, true).len());
        let rise = self.fitted.ln_likelihood - without.fitted.ln_likelihood;
        (
            telling_part(&self.fitted, &self.numbers, &self.samples, own.numbers().len()) * rise - price,
            without,
        )
    }

    /// The model without the session boundary `boundary`, fitted again: the rows on both sides of it are one session.
    fn without_session(&self, boundary: &Boundary) -> Self {
        let gone = boundary.earlier.numbers();
        let is_gone = |other: &Boundary| other.earlier == boundary.earlier;
        let Some((_, after)) = self.labels(boundary) else {
            let mut out = self.clone();
            out.sessions.retain(|other| !is_gone(other));
            return out;
        };
        let mut out = self.without_numbers(|number| gone.contains(number));
        out.sessions.retain(|other| !is_gone(other));
        let all = out.samples.len();
        boundary.earlier.relabel(&mut out.samples, all, after);
        let samples: Vec<&Sample> = out.samples.iter().collect();
        out.fitted = fit(&samples, &out.numbers, &out.fitted.effects, &out.fitted);
        out
    }

    /// Whether an undeclared session would fit as well as an effect of the model does. `fitted` is the fit without this
    /// effect. If so, returns the row, counted from 1, at which this session would begin; otherwise `None`. Two fits are
    /// taken as equally good if the logarithms of their likelihoods differ by at most `tie`.
    pub(crate) fn session_instead(&self, campaign: &Campaign, fitted: &Fitted, tie: f64) -> Option<usize> {
        let spec = &campaign.statement.positions;
        let kinds = self.kinds(spec.tool_offset, spec.base_placement);
        let without = Self { fitted: fitted.clone(), ..self.clone() };
        let missing = self.fitted.ln_likelihood - tie - without.fitted.ln_likelihood;
        let whole = without.whole()?;
        let firsts: Vec<_> = kinds.par_iter().map(|&moved| without.best_first(moved, &whole)).collect();
        let best = kinds.iter().zip(firsts).filter_map(|(&moved, first)| {
            let (first, gain) = first?;
            // a robust fit raises the likelihood by at most a few times the rise that the linearized model expects
            (3.0 * gain > missing).then(|| without.split(moved, first, kinds.len()))
        });
        let as_good = best.filter(|s| s.fitted.ln_likelihood > self.fitted.ln_likelihood - tie);
        as_good.max_by(|a, b| a.fitted.ln_likelihood.total_cmp(&b.fitted.ln_likelihood)).map(|s| s.first + 1)
    }
}

/// Whether all numbers of `a` are below all numbers of `b`, or all above.
fn are_apart(a: &[f64], b: &[f64]) -> bool {
    let ends = |list: &[f64]| {
        list.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)))
    };
    let ((a_low, a_high), (b_low, b_high)) = (ends(a), ends(b));
    a_high < b_low || b_high < a_low
}
