//! Where to branch a subproblem below a single upper bound: at the options of a level, or at a torque.
//!
//! An upper bound is a mass, a deflection and a frequency; a design is below it if it is no heavier, deflects no
//! further and has no lower mode. A subproblem has the options that such a design may have. The rows are linear
//! inequalities that every such design satisfies. Weights of the rows *refute* the subproblem if they prove that it has
//! no design below the upper bound.
//!
//! When no weights refute the subproblem, a mixture (a weighted mean) of the designs that are cheapest under some
//! weights satisfies all rows, although no single design need do so. The search branches where this mixture differs
//! most from a design. This may be a level whose mixed options differ in what they add to the rows. It may also be the
//! torque on a joint: the gears of the mixture may twist less, or be stiffer, than under the torque that the mixture's
//! own weights cause.

use super::super::bound::{Members, compliances};
use super::super::pose::Pose;
use super::super::span::{Linear, LinearVector, Span};
use super::parts_table::{Numbers, PartsTable, place};
use super::rows::Rows;
use super::subproblem::{Subproblem, TorqueInterval};
use super::weights::{Member, Reduced};

/// Smallest score for which a level or torque is branched. Each row is divided by about the value that the upper bound
/// allows, so the score is a fraction of this value. If no score is larger, the level with the most options is
/// branched.
const WORTH_IT: f64 = 1e-4;
/// If a row's value for the mixture is within this distance of zero (its limit), [`EXTRA_WEIGHT`] is added to the
/// weight of the row in the score.
const NEAR_LIMIT: f64 = 0.2;
const EXTRA_WEIGHT: f64 = 0.1;
/// A member with a smaller weight in the mixture than this has no influence on the torque at which an interval is
/// divided.
const LEAST_MIXTURE_WEIGHT: f64 = 1e-3;
/// A torque is not branched if its interval is narrower than this fraction of the torque's greatest magnitude.
const KNOWN_TORQUE_WIDTH: f64 = 2e-3;
/// If the torque of the mixture is nearer to an end of the interval than this fraction of the interval's width, the
/// interval is divided elsewhere.
const EDGE_SHARE: f64 = 0.1;

/// One way to divide a subproblem in two.
pub(super) enum Branching {
    /// Divides the options of a part (joints are numbered before tubes) by a value: the sum of an option's numbers
    /// times `per_number`. Options with a value of at most `at` make the first half, the remaining options the second.
    /// Without `at` the halves have equal numbers of options.
    Options {
        part: usize,
        per_number: Vec<f64>,
        at: Option<f64>,
    },
    Torque {
        case: usize,
        joint: usize,
        at_nm: f64,
    },
}

/// Ways to divide a subproblem, the most promising first. `curves` has the twists and slopes of the torsion curves.
/// They are needed to divide drives by a weighted sum of their numbers.
#[derive(Default)]
pub(super) struct Branchings {
    pub branchings: Vec<Branching>,
    pub curves: Vec<Numbers>,
}

/// A force and a compliance whose product displaces the tip.
struct Product<'p> {
    /// Position of the compliance in the list of numbers.
    number: usize,
    work: &'p LinearVector,
    compliance: Span,
}

impl Rows<'_> {
    /// Ways to divide a subproblem, the most promising first. `left` is the subproblem after its options were reduced,
    /// with the mixture that no weights refute.
    pub(super) fn branchings(&self, members: &Members, left: &Reduced) -> Vec<Branching> {
        let between = self.between(left);
        let mut found = Vec::new();
        // A joint with the first-fit rule (it takes the lightest drive that meets the demand) has no options to branch.
        let is_choice = |part: &usize| self.table.joints.get(*part).is_none_or(|j| j.drives.level.is_some());
        for part in (0..self.columns.joints + self.table.tubes.len()).filter(is_choice) {
            found.push(self.by_options(part, &between, members, left));
        }
        for case in 0..self.columns.cases {
            found.extend(self.by_torques(case, &between, left));
        }
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        found.into_iter().map(|(_, branching)| branching).collect()
    }

    /// The numbers of all parts of the mixture in `left`: the means of its members' numbers, weighted with their
    /// fractions.
    fn between(&self, left: &Reduced) -> Vec<f64> {
        let mut between = vec![0.0; self.columns.len()];
        for (share, member) in &left.mixed {
            between.iter_mut().zip(&member.numbers).for_each(|(sum, number)| *sum += share * number);
        }
        between
    }

    /// The branching that divides the options of `part`, with its score. The score says how much the members of the
    /// mixture differ in what the part adds to the rows. The options are divided by what they add to one row: the row
    /// in which the members differ most. `between` are the numbers of the mixture.
    fn by_options(
        &self,
        part: usize,
        between: &[f64],
        members: &Members,
        left: &Reduced,
    ) -> (f64, Branching) {
        let columns = self.columns.of_part(part);
        let adds = |row: usize, numbers: &[f64]| -> f64 {
            let per = &self.rows[row].per_number[columns.clone()];
            per.iter().zip(&numbers[columns.clone()]).map(|(a, b)| a * b).sum()
        };
        let spread = |row: usize| {
            let mean = adds(row, between);
            let apart =
                left.mixed.iter().map(|(share, member)| share * (adds(row, &member.numbers) - mean).abs());
            self.says(row, between, left) * apart.sum::<f64>()
        };
        let spreads: Vec<f64> = (0..self.rows.len()).map(spread).collect();
        let row = (0..spreads.len()).max_by(|&a, &b| spreads[a].total_cmp(&spreads[b])).unwrap_or(0);
        let mut score: f64 = spreads.iter().sum();
        let at = (score > WORTH_IT).then(|| adds(row, between));
        score += self.left_out_of(part, between, members, &left.weights);
        let per_number = self.rows[row].per_number[columns.clone()].to_vec();
        if score <= WORTH_IT {
            score = WORTH_IT * (1.0 - 1.0 / self.options(left, part) as f64);
        }
        (score, Branching::Options { part, per_number, at })
    }

    fn options(&self, left: &Reduced, part: usize) -> usize {
        match part.checked_sub(self.columns.joints) {
            None => left.joints[part].len(),
            Some(tube) => self.table.tubes[tube].count(&left.tubes[tube]),
        }
    }

    /// Weight of a row in the score of a branching: its multiplier, and [`EXTRA_WEIGHT`] more if the mixture, with
    /// the numbers `between`, is close to the row's limit. Rows of torque intervals have weight zero.
    fn says(&self, row: usize, between: &[f64], left: &Reduced) -> f64 {
        let near = self.rows[row].value(between) > -NEAR_LIMIT;
        match (self.first_interval..self.first_mode).contains(&row) {
            true => 0.0,
            false => left.weights[row] + if near { EXTRA_WEIGHT } else { 0.0 },
        }
    }

    /// By how much the linear (McCormick) bound of force times compliance is too low for the mixture with the numbers
    /// `between`. It is the error in the tip displacement by one tube or bearing, in units of the weighted rows.
    fn left_out_of(&self, part: usize, between: &[f64], members: &Members, weights: &[f64]) -> f64 {
        let of_tip = |&(row, case, direction): &(usize, usize, nalgebra::Vector3<f64>)| {
            let pose = self.pose(case);
            let loads = &members.loads[pose.water];
            let left_out =
                self.products(part, pose, members).into_iter().map(|Product { number, work, compliance }| {
                    let forces = work.along(&direction, loads);
                    let per_load = work.per_load.iter().enumerate();
                    let force = work.fixed.dot(&direction)
                        + per_load
                            .map(|(load, per)| {
                                between[self.columns.load(load, pose.water)] * per.dot(&direction)
                            })
                            .sum::<f64>();
                    (force - forces.least) * (between[number] - compliance.least)
                });
            weights[row] * left_out.sum::<f64>() / self.upper.tip_m
        };
        self.tips.iter().map(of_tip).sum()
    }

    /// Every product of force and compliance by which a part displaces the tip in a case.
    fn products<'p>(&self, part: usize, pose: &'p Pose, members: &Members) -> Vec<Product<'p>> {
        let Some(tube) = part.checked_sub(self.columns.joints) else {
            let compliance = members.drives[part].tilt_rad_per_nm;
            return vec![Product { number: self.columns.tilt(part), work: &pose.by_tilts[part], compliance }];
        };
        let works = pose.works[tube].iter().zip(compliances(members.tubes[tube])).enumerate();
        let number = |which| self.columns.tubes[tube] + place::compliance(self.skeleton.waters.len(), which);
        works.map(|(which, (work, compliance))| Product { number: number(which), work, compliance }).collect()
    }

    /// Ways to divide a subproblem at the torques of a judged case, each with its score. A judged case counts for
    /// deflection and lowest mode. The score is positive if the gears of the mixture twist less, or are stiffer, than
    /// they are under the torques that the mixture's own masses cause. `between` are the numbers of the mixture.
    fn by_torques(&self, case: usize, between: &[f64], left: &Reduced) -> Vec<(f64, Branching)> {
        let pose = self.pose(case);
        let own_nm = |torque: &Linear| {
            let per_load = torque.per_load.iter().enumerate();
            let own = per_load.map(|(load, per)| between[self.columns.load(load, pose.water)] * per);
            torque.fixed + own.sum::<f64>()
        };
        let spans = self.torques[case].iter();
        let own = pose.torques.iter().zip(spans).map(|(t, span)| own_nm(t).clamp(span.least, span.most));
        let own_nm: Vec<f64> = own.collect();
        let mut there = between.to_vec();
        for (joint, torque_nm) in own_nm.iter().enumerate() {
            let slope = |(share, member): &(f64, Member)| {
                let range = self.table.joints[joint].range(member.drives[joint]);
                share * range.largest_slope(torque_nm.abs())
            };
            let slope: f64 = left.mixed.iter().map(slope).sum();
            there[self.columns.slope(joint, case)] = if slope.is_finite() { slope } else { 0.0 };
        }
        let eigenvalue = self.upper.eigenvalue();
        let motion = self.pencil(case, &there).slower_motion(eigenvalue);
        let branchings = own_nm.iter().enumerate().filter_map(|(joint, &torque_nm)| {
            let slope = self.columns.slope(joint, case);
            let stiffer = between[slope] - there[slope];
            let of_mode = motion.as_ref().map_or(0.0, |x| stiffer * x[joint] * x[joint] / eigenvalue);
            let gain = of_mode + self.less_twisted(case, joint, torque_nm, left);
            (gain > WORTH_IT).then_some(())?;
            Some((
                gain,
                Branching::Torque { case, joint, at_nm: self.branching_nm(case, joint, torque_nm, left)? },
            ))
        });
        branchings.collect()
    }

    /// What the rows of the case `case` miss of the twist of the gear of `joint`: the least twist that the mixed gears
    /// have under `torque_nm` (the torque that the mixture's own masses cause), less the twist that the rows count, as a
    /// mean over the mixture. It is stated as what it would add to the weighted sum of rows: times the coefficient of the
    /// twist in the row of the tip displacement, times the weight of this row. It has no unit. 0 if the case has no such
    /// row.
    fn less_twisted(&self, case: usize, joint: usize, torque_nm: f64, left: &Reduced) -> f64 {
        let Some(&(row, _, direction)) = self.tips.iter().find(|tip| tip.1 == case) else { return 0.0 };
        let sense = 1.0f64.copysign(self.pose(case).tip_m_per_rad[joint].dot(&direction));
        let at = Span { least: torque_nm, most: torque_nm }.times(sense);
        let from = self.torques[case][joint].times(sense);
        let twist = self.columns.twist(joint, case);
        let less = |(share, member): &(f64, Member)| {
            let counted = member.numbers[twist] + self.per_torque[case][joint] * (at.least - from.least);
            let range = self.table.joints[joint].range(member.drives[joint]);
            share * (range.least_angle_rad(at) - counted)
        };
        let less: f64 = left.mixed.iter().map(less).sum();
        left.weights[row] * self.rows[row].per_number[twist] * less
    }

    /// Torque at which the interval of a joint's torque is divided. `torque_nm` is the torque that the mixture's own
    /// masses cause. The interval is divided at the next break point (T1, T2) of a gear of the mixture beyond this
    /// torque. If there is none, it is divided at this torque, or in the middle if this torque is too near an end.
    /// `None` if the interval is narrow enough already.
    fn branching_nm(&self, case: usize, joint: usize, torque_nm: f64, left: &Reduced) -> Option<f64> {
        let Span { least, most } = self.torques[case][joint];
        let edge = EDGE_SHARE * (most - least);
        (most - least > KNOWN_TORQUE_WIDTH * most.abs().max(least.abs())).then_some(())?;
        let breaks =
            left.mixed.iter().filter(|(share, _)| *share > LEAST_MIXTURE_WEIGHT).flat_map(|(_, member)| {
                let stiff = self.table.joints[joint].range(member.drives[joint]).stiff;
                [stiff.t1_nm, stiff.t2_nm, -stiff.t1_nm, -stiff.t2_nm]
            });
        let beyond = breaks.filter(|at_nm| at_nm.abs() >= torque_nm.abs() && *at_nm > least && *at_nm < most);
        let nearest = beyond.min_by(|a, b| (a - torque_nm).abs().total_cmp(&(b - torque_nm).abs()));
        let inside = Some(torque_nm).filter(|nm| *nm > least + edge && *nm < most - edge);
        Some(nearest.or(inside).unwrap_or(0.5 * (least + most)))
    }
}

impl Branchings {
    /// The two halves of a subproblem; `None` if no way to branch divides it.
    pub(super) fn halves(&self, table: &PartsTable, subproblem: &Subproblem) -> Option<[Subproblem; 2]> {
        self.branchings.iter().find_map(|branching| subproblem.branched(table, branching, &self.curves))
    }
}

impl Subproblem {
    fn branched(&self, table: &PartsTable, branching: &Branching, curves: &[Numbers]) -> Option<[Self; 2]> {
        match branching {
            Branching::Torque { case, joint, at_nm } => Some(self.branched_by_torque(*case, *joint, *at_nm)),
            Branching::Options { part, per_number, at } => match part.checked_sub(self.joints.len()) {
                None => {
                    let joint = &table.joints[*part];
                    let value = |&drive: &u32| {
                        let curve = joint.curve[drive as usize] as usize;
                        let rest = curves[*part][curve].iter().flatten();
                        let numbers = std::iter::once(&joint.masses_kg[drive as usize]).chain(rest);
                        numbers.zip(per_number).map(|(a, b)| a * b).sum()
                    };
                    let halves = halved(&self.joints[*part], value, *at)?;
                    Some(halves.map(|half| {
                        let mut subproblem = self.clone();
                        subproblem.joints[*part] = half;
                        subproblem
                    }))
                }
                Some(tube) => {
                    let value = |&node: &u32| {
                        let [least, most] = table.tubes[tube].bounds(node);
                        let ends = least.iter().zip(most);
                        ends.zip(per_number).map(|((a, b), per)| 0.5 * (a + b) * per).sum()
                    };
                    let nodes = &self.tubes[tube];
                    let halves = match nodes[..] {
                        [node] => table.tubes[tube].tree.halves(node)?.map(|half| vec![half]),
                        _ => halved(nodes, value, *at)?,
                    };
                    Some(halves.map(|half| {
                        let mut subproblem = self.clone();
                        subproblem.tubes[tube] = half;
                        subproblem
                    }))
                }
            },
        }
    }

    fn branched_by_torque(&self, case: usize, joint: usize, at_nm: f64) -> [Self; 2] {
        let below = Span { least: f64::NEG_INFINITY, most: at_nm };
        let above = Span { least: at_nm, most: f64::INFINITY };
        [below, above].map(|between| {
            let mut subproblem = self.clone();
            subproblem.keep_torque(TorqueInterval { case, joint, between });
            subproblem
        })
    }
}

/// Divides `options` into two lists: the options whose `value` is at most `at`, and the remaining options. If one list
/// would be empty, the options are sorted by their value and divided into equal halves. `None` if there is only one
/// option.
fn halved(options: &[u32], value: impl Fn(&u32) -> f64, at: Option<f64>) -> Option<[Vec<u32>; 2]> {
    let (mut low, mut high): (Vec<u32>, Vec<u32>) =
        options.iter().partition(|option| at.is_some_and(|at| value(option) <= at));
    if low.is_empty() || high.is_empty() {
        let mut all = options.to_vec();
        all.sort_by(|a, b| value(a).total_cmp(&value(b)));
        high = all.split_off(all.len() / 2);
        low = all;
        low.sort_unstable();
        high.sort_unstable();
    }
    (!low.is_empty()).then_some([low, high])
}
