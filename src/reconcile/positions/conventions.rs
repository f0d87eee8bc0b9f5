//! Tests whether positions that no calibration fits were written by another convention: in another unit, in a frame
//! whose axes are swapped or left-handed, or with joint angles of another sign or zero.
//!
//! The search is greedy. It starts from the file as it is, read in the unit in which its positions spread as widely as
//! those of the nominal arm. Every single change of convention, or every pair of changes, is tried by a quick fit of
//! the placement alone. The best change is kept as long as the errors fall. The geometry is then calibrated in full
//! with the convention that was found. The convention is reported if the errors that remain are several times smaller
//! than with the file as it is. The file is used unchanged, because only the user knows which convention is right.

use super::align::nearest_motion;
use super::analysis::{Positions, samples};
use super::fit::fit;
use super::fitted::{Fitted, Sample};
use super::kinematics::{Geometry, Number, Pose, number_groups};
use super::points::points;
use crate::reconcile::readings::campaign::{Campaign, PositionsSpec};
use crate::report::number::significant;
use nalgebra::Vector3;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

/// Other conventions are tested if the scale of the position errors after calibration exceeds the declared standard
/// deviation by this factor.
const FAR: f64 = 5.0;
/// A convention is reported if the errors after calibration with it are smaller than with the file as it is by at
/// least this factor.
const TELLING: f64 = 5.0;
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
/// Units other than the millimetre, each with its length \[mm\].
const UNITS: [(&str, f64); 4] =
    [("metres", 1e3), ("micrometres", 1e-3), ("centimetres", 10.0), ("inches", 25.4)];

/// One way in which the convention of a file can differ.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Change {
    /// Positions are in another unit, given by its index in [`UNITS`].
    Unit(usize),
    /// For each axis of the frame, the index of the coordinate of the file that lies along it, and whether its sign
    /// is reversed.
    Axes([(usize, bool); 3]),
    /// One axis of the instrument's frame points the other way, so that the frame is left-handed.
    LeftHanded,
    /// The angles of the joint with this index have the other sign.
    Sign(usize),
    /// The zero of the joint with this index is elsewhere: this angle \[rad\] is added to the joint's angles.
    Zero(usize, f64),
}

const COORDINATES: [&str; 3] = ["x_mm", "y_mm", "z_mm"];

impl Change {
    /// Whether this change and `other` concern the same unit, axes or joint, so that one replaces the other.
    fn replaces(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Unit(_), Self::Unit(_)) | (Self::Axes(_), Self::Axes(_)) => true,
            (Self::Zero(a, _), Self::Zero(b, _)) => a == b,
            (a, b) => a == b,
        }
    }

    /// The sample (a measured position), converted on the assumption that the file was written by this convention.
    fn applied(&self, mut sample: Sample) -> Sample {
        let turned = |sample: &mut Sample, j: usize, of: &dyn Fn(f64) -> f64| {
            let mut angles_rad = sample.pose.angles_rad.clone();
            angles_rad[j] = of(angles_rad[j]);
            sample.pose = Arc::new(Pose::new(angles_rad));
        };
        match *self {
            Self::Unit(unit) => sample.measured_m *= UNITS[unit].1,
            Self::Axes(axes) => {
                let sign = |(_, is_other): (usize, bool)| if is_other { -1.0 } else { 1.0 };
                let (at_m, precision) = (sample.measured_m, sample.precision);
                sample.measured_m = Vector3::from(axes.map(|axis| sign(axis) * at_m[axis.0]));
                sample.precision = Vector3::from(axes.map(|axis| precision[axis.0]));
            }
            Self::LeftHanded => sample.measured_m.z *= -1.0,
            Self::Sign(j) => turned(&mut sample, j, &|angle| -angle),
            Self::Zero(j, by) => turned(&mut sample, j, &|angle| angle + by),
        }
        sample
    }

    fn words(&self, driven: &[String]) -> String {
        match *self {
            Self::Unit(unit) => format!("the positions are in {}", UNITS[unit].0),
            Self::Axes(axes) => {
                let axis = |(c, is_other): (usize, bool)| {
                    format!("{}{}", if is_other { "-" } else { "" }, COORDINATES[c])
                };
                format!("the frame's x, y, z are {} of the file", axes.map(axis).join(", "))
            }
            Self::LeftHanded => {
                "the instrument's frame is left-handed (two axes are swapped, or one has the other sign)"
                    .into()
            }
            Self::Sign(j) => format!("the angles of {} have the other sign", driven[j]),
            Self::Zero(j, by) => {
                format!("{:.0} degrees are added to the angles of {}", by.to_degrees(), driven[j])
            }
        }
    }
}

/// The changes of convention that are tried, for an arm with `joints` driven joints. If the base placement is free, the
/// fit itself turns the frame, so only a left-handed frame is tried.
fn changes(spec: &PositionsSpec, joints: usize) -> Vec<Change> {
    let mut out: Vec<Change> = (0..UNITS.len()).map(Change::Unit).collect();
    match spec.base_placement {
        true => out.push(Change::LeftHanded),
        false => out.extend(other_axes()),
    }
    out.extend((0..joints).map(Change::Sign));
    out.extend((0..joints).flat_map(|j| [FRAC_PI_2, -FRAC_PI_2, PI].map(|by| Change::Zero(j, by))));
    out
}

/// All pairs of the changes `all` that concern the angles of two different joints.
fn pairs(all: &[Change]) -> Vec<Vec<Change>> {
    let joint = |change: &Change| match change {
        Change::Sign(j) | Change::Zero(j, _) => Some(*j),
        Change::Unit(_) | Change::Axes(_) | Change::LeftHanded => None,
    };
    let of_two = |a: &Change, b: &Change| joint(a).zip(joint(b)).is_some_and(|(a, b)| a < b);
    let with = |a: &Change| all.iter().filter(|b| of_two(a, b)).map(|b| vec![*a, *b]).collect::<Vec<_>>();
    all.iter().flat_map(with).collect()
}

/// The 47 ways to permute and reverse the axes of a frame, other than leaving it as it is.
fn other_axes() -> Vec<Change> {
    const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    let signed = ORDERS.iter().flat_map(|order| {
        (0..8).map(move |signs| Change::Axes([0, 1, 2].map(|c| (order[c], (signs >> c) & 1 == 1))))
    });
    signed.skip(1).collect()
}

/// Fits the positions of a file as if they had been written by another convention.
struct Asked<'a> {
    spec: &'a PositionsSpec,
    samples: Vec<Sample>,
    nominal: Geometry,
    groups: Vec<Vec<Number>>,
}

impl Asked<'_> {
    /// Scale of the position errors after a fit with the `changes` of convention made \[m\]. The numbers of the
    /// geometry in the first `groups` lists of `self.groups` are fitted, and about `most` samples (measured positions)
    /// are used.
    fn scale_m(&self, changes: &[Change], groups: usize, most: usize) -> f64 {
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
            fitted = fit(&own, &numbers, &[], &fitted);
        }
        fitted.scale_m
    }

    fn quick_m(&self, changes: &[Change]) -> f64 {
        self.scale_m(changes, 1, QUICK)
    }

    fn full_m(&self, changes: &[Change]) -> f64 {
        self.scale_m(changes, self.groups.len(), usize::MAX)
    }

    /// Greedy search: adds to the changes `made` those of `all` that lower the errors of the quick fit, and returns
    /// the set. If no single change helps and the fit is still far off, pairs are tried. Pairs are needed where two
    /// parallel joints both turn the other way, because either change alone is no better.
    fn search(&self, all: &[Change], mut made: Vec<Change>) -> Vec<Change> {
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
        }
        self.pruned(made)
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

    /// The unit in which the positions spread about as much as those of the nominal arm; `None` for millimetres. The
    /// spread shows the unit even if the file differs in other conventions too. The unit must be known first, because
    /// no other change can be judged in a wrong unit.
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

    /// Sets of changes in which one change of `made` is replaced by one of `all`, and with which the errors are about
    /// as small as with `made`. `scale_m` is the scale of the errors with `made` \[m\].
    fn equals(&self, all: &[Change], made: &[Change], scale_m: f64) -> Vec<Vec<Change>> {
        let quick_m = self.quick_m(made);
        let others = || all.iter().filter(|change| !made.iter().any(|m| m.replaces(change)));
        let with = |at: usize| {
            others().map(move |change| {
                let mut out = made.to_vec();
                out[at] = *change;
                out
            })
        };
        let tried: Vec<Vec<Change>> = (0..made.len()).flat_map(with).collect();
        let is_near = |changes: &Vec<Change>| self.quick_m(changes) < 2.0 * quick_m;
        let is_equal = |changes: &Vec<Change>| self.full_m(changes) < TIE * scale_m;
        tried.into_par_iter().filter(is_near).filter(is_equal).collect()
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
    /// Sentence on a convention by which the positions of the file would fit far better. `None` if calibration fits
    /// the positions well enough, if a mounting is unknown (too many combinations), or if no convention is found.
    pub(super) fn other_convention(&self, campaign: &Campaign) -> Option<String> {
        let spec = &campaign.statement.positions;
        let declared_mm: f64 = campaign.positions.iter().map(|row| row.sigma_mm()).sum();
        let declared_m = 1e-3 * declared_mm / campaign.positions.len().max(1) as f64;
        // each attitude of an unknown mounting would have to be tried with each convention
        if self.rigid.scale_m < FAR * declared_m || !spec.mounts.is_empty() {
            return None;
        }
        let points = points(campaign);
        let nominal = Geometry::nominal(&self.tree, points.len());
        let samples = samples(campaign, &self.tree, &nominal, &[], &points);
        let groups = number_groups(&self.tree, spec, points.len()).into_iter().map(|(_, group)| group);
        let asked = Asked { spec, samples, nominal, groups: groups.collect() };
        let all = changes(spec, self.tree.driven.len());
        let is_far_off = self.rigid.scale_m > FAR_OFF * asked.spread_m(&[]);
        let by_size: Vec<Change> = asked.unit_by_size().into_iter().collect();
        let mut starts = vec![by_size.clone()];
        if spec.base_placement && is_far_off {
            starts.push([by_size, vec![Change::LeftHanded]].concat());
        }
        let found = starts.into_iter().map(|start| asked.search(&all, start)).filter(|made| !made.is_empty());
        let judged = found.map(|made| (asked.full_m(&made), made));
        // if two cannot be told apart, the one with fewer changes is better
        let is_better = |a: &(f64, Vec<Change>), b: &(f64, Vec<Change>)| {
            a.0 < b.0 / TIE || (a.0 < TIE * b.0 && a.1.len() < b.1.len())
        };
        let (scale_m, made) =
            judged.reduce(|best, next| if is_better(&next, &best) { next } else { best })?;
        let ratio = self.rigid.scale_m / scale_m;
        // a convention that is far off too is not the right one
        if ratio < TELLING || scale_m > FAR_OFF * asked.spread_m(&made) {
            return None;
        }
        let words = |changes: &[Change]| {
            let each = changes.iter().map(|change| change.words(&self.tree.driven));
            each.collect::<Vec<_>>().join(" and ")
        };
        let mut told = words(&made);
        for equal in asked.equals(&all, &made, scale_m).iter().take(MOST_EQUALS) {
            told.push_str(&format!(", or just as well if {}", words(equal)));
        }
        Some(format!(
            "the positions fit {} times better if {told} (calibration leaves errors of {} mm, and {} mm as the file is): \
             correct the file if that is so; it was taken as it is",
            significant(ratio, 2),
            significant(1e3 * scale_m, 3),
            significant(1e3 * self.rigid.scale_m, 3)
        ))
    }
}
