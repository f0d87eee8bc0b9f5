//! Tests whether positions that no calibration fits, or that only a geometry far from the arm file's fits, were written
//! by another convention ([`Change`]).
//!
//! The search is greedy. It starts from the file as it is, read in the unit in which its positions spread as widely as
//! those of the nominal arm. In each step, every single change of convention is tried by a quick fit of the placement
//! alone; pairs of changes are tried if no single one helps. The best change is kept as long as the errors fall. A
//! quick fit has the errors of the nominal geometry, so that a change may help it by chance. The geometry is therefore
//! calibrated in full after every step. Of the sets of changes that then fit about equally well, the smallest is used.
//! Each of its changes that the fit does not need is dropped.
//!
//! The convention is reported if the errors that remain are several times smaller than with the file as it is, or if
//! no link or axis has to move further than its prior expects. The file is used unchanged, because only the user knows
//! which convention is right.

use super::align::nearest_motion;
use super::analysis::{Positions, samples};
use super::convention_changes::{Change, UNITS, changes, pairs};
use super::fit::likeliest;
use super::fitted::{Fitted, Sample, readings};
use super::kinematics::{Geometry, Number, number_groups};
use super::points::points;
use super::screening::LONG;
use crate::reconcile::readings::campaign::{Campaign, PositionsSpec};
use crate::report::number::significant;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Other conventions are tested if the scale of the position errors after calibration is at least this multiple of the
/// declared standard deviation.
const SUSPECT_RATIO: f64 = 5.0;
/// A convention is reported if the errors after calibration with it are smaller than with the file as it is by at
/// least this factor.
const TELLING: f64 = 5.0;
/// Limit for a file that fits only with a geometry far from nominal. A convention with which no link or axis moves far
/// is then reported, unless its errors, relative to the spread of the positions, are larger by more than this factor.
const AS_GOOD: f64 = 2.0;
/// A change of convention is kept in the search if it lowers the errors of the quick fit to less than this fraction
/// of those without it.
const HELPS: f64 = 0.9;
/// Two conventions cannot be told apart if the errors after calibration with them differ by less than this factor.
const TIE: f64 = 1.2;
/// Largest number of conventions that are reported in addition to the best one.
const MOST_EQUALS: usize = 3;
/// A fit is far off if the scale of its errors is larger than this fraction of the positions' root mean square
/// distance from their centre.
const FAR_OFF: f64 = 0.01;
/// Largest number of changes of convention that are made together.
const MOST_CHANGES: usize = 8;
/// Largest number of positions that a quick fit uses.
const QUICK: usize = 60;
/// Scale of the position errors with which each fit starts \[m\]: about the errors that a wrong convention causes.
const ROUGH_M: f64 = 0.3;
/// Fits the positions of a file as if they had been written by another convention.
struct Asked<'a> {
    spec: &'a PositionsSpec,
    samples: Vec<Sample>,
    nominal: Geometry,
    groups: Vec<Vec<Number>>,
}

/// A set of changes of convention with which the geometry was calibrated in full.
#[derive(Clone)]
struct Tried {
    made: Vec<Change>,
    /// Scale of the position errors \[m\].
    scale_m: f64,
    /// The number by which sets of changes are compared: the smaller, the better. It is the scale of the errors divided
    /// by the spread of the positions, so it does not depend on the unit. The number is larger for a calibration with a
    /// low prior probability. It is also larger, by the factor [`AS_GOOD`], for a geometry far from nominal.
    judged: f64,
    /// Whether a link or an axis moved further than its prior expects.
    is_far: bool,
}

impl Tried {
    /// Whether the positions fit about as well as with `best`, or better.
    fn ties_with(&self, best: &Self) -> bool {
        self.judged < TIE * best.judged
    }
}

impl Asked<'_> {
    /// A fit of the positions with the `changes` of convention made, and the numbers of the geometry that were fitted:
    /// those in the first `groups` lists of `self.groups`. At most `most` samples (measured positions) are used.
    fn fitted(&self, changes: &[Change], groups: usize, most: usize) -> (Fitted, Vec<Number>) {
        let step = self.samples.len().div_ceil(most).max(1);
        let written = self.samples.iter().step_by(step).cloned();
        let own: Vec<Sample> = written
            .map(|sample| changes.iter().fold(sample, |sample, change| change.applied(sample)))
            .collect();
        let own: Vec<&Sample> = own.iter().collect();
        let mut geometry = self.nominal.clone();
        if self.spec.base_placement {
            nearest_motion(&own, &mut geometry);
        }
        let mut fitted = Fitted::rigid(geometry, ROUGH_M);
        let mut numbers = Vec::new();
        for group in &self.groups[..groups] {
            numbers.extend(group.iter().cloned());
            fitted = likeliest(&own, &numbers, &[], &fitted);
        }
        (fitted, numbers)
    }

    fn quick_m(&self, changes: &[Change]) -> f64 {
        self.fitted(changes, 1, QUICK).0.scale_m
    }

    fn full(&self, made: Vec<Change>) -> Tried {
        let (fitted, numbers) = self.fitted(&made, self.groups.len(), LONG);
        // for each reading, the logarithm of the likelihood rises by one if the scale falls by the factor e
        let part = fitted.improbability(&numbers) / readings(&self.samples).max(1) as f64;
        let is_far = fitted.is_far_from_nominal(&numbers);
        let far = if is_far { AS_GOOD } else { 1.0 };
        let judged = far * fitted.scale_m / self.spread_m(&made) * libm::exp(part);
        Tried { made, scale_m: fitted.scale_m, judged, is_far }
    }

    /// Greedy search: in each step, adds to the changes `made` the change of `all` that lowers the errors of the quick
    /// fit most. Returns the set after every step, and last the final set without unnecessary changes. If no single
    /// change helps and the fit is still far off, pairs are tried. Pairs are needed where two parallel joints both turn
    /// the other way, because either change alone is no better.
    fn search(&self, all: &[Change], mut made: Vec<Change>) -> Vec<Vec<Change>> {
        let mut steps = vec![made.clone()];
        let singles: Vec<Vec<Change>> = all.iter().map(|change| vec![*change]).collect();
        let pairs = pairs(all);
        let mut here_m = self.quick_m(&made);
        while made.len() < MOST_CHANGES {
            let better =
                |added: &[Vec<Change>]| self.best_with(&made, added).filter(|b| b.0 < HELPS * here_m);
            let found = better(&singles)
                .or_else(|| (here_m > FAR_OFF * self.spread_m(&made)).then(|| better(&pairs)).flatten());
            let Some(found) = found else { break };
            (here_m, made) = found;
            steps.push(made.clone());
        }
        steps.push(self.pruned(made));
        steps
    }

    /// The smallest of those sets of changes in `found` that fit about as well as the best. Changes that it does not
    /// need are removed. `None` if `found` is empty.
    fn simplest(&self, found: Vec<Vec<Change>>) -> Option<Tried> {
        let tried: Vec<Tried> = found.into_par_iter().map(|made| self.full(made)).collect();
        let best = tried.iter().min_by(|a, b| a.judged.total_cmp(&b.judged))?;
        let equals = tried.iter().filter(|t| t.ties_with(best));
        let mut out = equals.min_by_key(|t| t.made.len())?.clone();
        loop {
            let without = |at: usize| {
                let mut rest = out.made.clone();
                rest.remove(at);
                self.full(rest)
            };
            let fewer: Vec<Tried> = (0..out.made.len()).into_par_iter().map(without).collect();
            let needless = fewer.into_iter().filter(|t| t.ties_with(&out));
            let Some(next) = needless.min_by(|a, b| a.judged.total_cmp(&b.judged)) else {
                return Some(out);
            };
            out = next;
        }
    }

    /// Joins `made` with each entry of `added` in turn, and returns the best set of changes with the scale of the
    /// errors of its quick fit \[m\]. `None` if there is nothing to add.
    fn best_with(&self, made: &[Change], added: &[Vec<Change>]) -> Option<(f64, Vec<Change>)> {
        let with = |new: &Vec<Change>| {
            let is_kept = |old: &&Change| !new.iter().any(|change| change.replaces(old));
            let changes: Vec<Change> = made.iter().filter(is_kept).chain(new).copied().collect();
            (self.quick_m(&changes), changes)
        };
        let open: Vec<&Vec<Change>> =
            added.iter().filter(|new| !new.iter().all(|c| made.contains(c))).collect();
        let tried: Vec<(f64, Vec<Change>)> = open.into_par_iter().map(with).collect();
        tried.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// The unit in which the spread of the positions is about the same as for the nominal arm; `None` for millimetres.
    /// The spread shows the unit even if the file differs in other conventions too. The unit must be known first,
    /// because no other change can be judged in a wrong unit.
    fn unit_by_size(&self) -> Option<Change> {
        let nominal = Fitted::rigid(self.nominal.clone(), ROUGH_M);
        // a coordinate that was not measured is zero in both
        let measured = |at_m: Vector3<f64>, sample: &Sample| {
            at_m.zip_map(&sample.precision, |x, p| if p > 0.0 { x } else { 0.0 })
        };
        let expected_m =
            spread_m(self.samples.iter().map(|sample| measured(nominal.predicted_m(sample), sample)));
        let ratio = expected_m / self.spread_m(&[]);
        let off = |unit_mm: f64| libm::log(ratio / unit_mm).abs();
        let nearest = (0..UNITS.len()).min_by(|a, b| off(UNITS[*a].1).total_cmp(&off(UNITS[*b].1)))?;
        (off(UNITS[nearest].1) < off(1.0)).then_some(Change::Unit(nearest))
    }

    /// Root mean square distance of the positions from their centre, with the `changes` of convention made \[m\].
    fn spread_m(&self, changes: &[Change]) -> f64 {
        spread_m(self.samples.iter().map(|sample| {
            changes.iter().fold(sample.clone(), |sample, change| change.applied(sample)).measured_m
        }))
    }

    /// The changes `made` without those that another change has made unnecessary: the quick fit is about as good
    /// without them.
    fn pruned(&self, mut made: Vec<Change>) -> Vec<Change> {
        let mut at = 0;
        while at < made.len() {
            let mut rest = made.clone();
            rest.remove(at);
            match self.quick_m(&rest) < self.quick_m(&made) / HELPS {
                true => made = rest,
                false => at += 1,
            }
        }
        made
    }

    /// The set `known`, and sets of changes that cannot be told from it: one of its changes is replaced by one of
    /// `all`, and the positions fit about as well. The set with the smallest errors comes first.
    fn equals(&self, all: &[Change], known: Tried) -> Vec<Tried> {
        let quick_m = self.quick_m(&known.made);
        let others = || all.iter().filter(|change| !known.made.iter().any(|m| m.replaces(change)));
        let with = |at: usize| {
            let made = &known.made;
            others().map(move |change| {
                let mut out = made.clone();
                out[at] = *change;
                out
            })
        };
        let tried: Vec<Vec<Change>> = (0..known.made.len()).flat_map(with).collect();
        let is_near = |changes: &Vec<Change>| self.quick_m(changes) < 2.0 * quick_m;
        let near = tried.into_par_iter().filter(is_near).map(|changes| self.full(changes));
        let mut out: Vec<Tried> = near.filter(|t| t.ties_with(&known)).collect();
        out.push(known);
        out.sort_by(|a, b| a.judged.total_cmp(&b.judged));
        out
    }
}

/// Root mean square distance of points from their centre \[m\].
fn spread_m(points_m: impl Iterator<Item = Vector3<f64>>) -> f64 {
    let all: Vec<Vector3<f64>> = points_m.collect();
    let count = all.len().max(1) as f64;
    let centre = all.iter().sum::<Vector3<f64>>() / count;
    (all.iter().map(|at| (at - centre).norm_squared()).sum::<f64>() / count).sqrt()
}

impl Positions {
    /// Sentence on a convention with which the positions of the file would fit far better, or would fit with a geometry
    /// near that in the arm file. `None` if calibration fits the positions well enough, if a mounting is unknown (too
    /// many combinations), or if no convention is found.
    pub(super) fn other_convention(&self, campaign: &Campaign) -> Option<String> {
        let spec = &campaign.statement.positions;
        let declared_mm: f64 = campaign.positions.iter().map(|row| row.sigma_mm()).sum();
        let declared_m = 1e-3 * declared_mm / campaign.positions.len().max(1) as f64;
        let is_off = self.rigid.scale_m >= SUSPECT_RATIO * declared_m || self.has_far_geometry();
        // each attitude of an unknown mounting would have to be tried with each convention
        if !is_off || !spec.mounts.is_empty() {
            return None;
        }
        let points = points(campaign);
        let nominal = Geometry::nominal(&self.tree, points.len());
        let samples = samples(campaign, &self.tree, &nominal, &[], &points);
        let groups = number_groups(&self.tree, spec, points.len()).into_iter().map(|(_, group)| group);
        let asked = Asked { spec, samples, nominal, groups: groups.collect() };
        let all = changes(spec, &self.tree);
        let is_far_off = self.rigid.scale_m > FAR_OFF * asked.spread_m(&[]);
        let by_size: Vec<Change> = asked.unit_by_size().into_iter().collect();
        let mut starts = vec![by_size.clone()];
        if spec.base_placement && is_far_off {
            starts.push([by_size, vec![Change::LeftHanded]].concat());
        }
        let found =
            asked.simplest(starts.into_iter().flat_map(|start| asked.search(&all, start)).collect())?;
        if found.made.is_empty() {
            return None;
        }
        let equals = asked.equals(&all, found);
        self.told(&asked, &equals)
    }

    /// The sentence on the conventions `equals`, which fit about equally well, the best first. `None` if the positions
    /// do not fit far better with the best one, or are far off with this one too.
    fn told(&self, asked: &Asked, equals: &[Tried]) -> Option<String> {
        let best = equals.first()?;
        let ratio = self.rigid.scale_m / best.scale_m;
        let spread_m = asked.spread_m(&best.made);
        let as_good = best.scale_m / spread_m < AS_GOOD * self.rigid.scale_m / asked.spread_m(&[]);
        let is_nearer = self.has_far_geometry() && !best.is_far && as_good;
        // a convention that is far off too is not the right one
        if !(ratio >= TELLING || is_nearer) || best.scale_m > FAR_OFF * spread_m {
            return None;
        }
        let words = |tried: &Tried| {
            let each = tried.made.iter().map(|change| change.words(&self.tree.driven));
            each.collect::<Vec<_>>().join(" and ")
        };
        let told: Vec<String> = equals.iter().take(1 + MOST_EQUALS).map(words).collect();
        let told = told.join(", or just as well if ");
        let [with_mm, without_mm] = [best.scale_m, self.rigid.scale_m].map(|m| significant(1e3 * m, 3));
        let fits = match ratio >= TELLING {
            true => format!(
                "the positions fit {} times better if {told} (calibration leaves errors of {with_mm} mm, and {without_mm} mm \
                 as the file is)",
                significant(ratio, 2)
            ),
            false => format!(
                "no link and no axis moves further than its prior expects if {told} (calibration then leaves errors of \
                 {with_mm} mm)"
            ),
        };
        Some(format!("{fits}: correct the file if that is so; it was taken as it is"))
    }
}
