//! The choice of how to divide a region that may still have a member below a local upper bound.
//!
//! A local upper bound is a mass, a deflection and a frequency; a design below it is new to the front. A region is a
//! set of designs, given by the options that remain at each level and by bounds on torques.
//!
//! The Lagrangian bound (`lagrangian.rs`) is a lower bound of a weighted sum of inequalities (rows) over a region. It
//! ends with a mixture: several relaxed designs with weights that sum to one. A relaxed design takes at each level the
//! option that is cheapest in this sum, and the torques of its gears need not agree with its weights. The bound is
//! loose where these designs differ. It is also loose where the product of a force and a compliance, each known as an
//! interval, is replaced by a linear function below it (its McCormick underestimate). There are two ways to branch:
//!
//! - on the options of a level, where the mixed designs differ or a product is underestimated;
//! - on a joint torque. A force is uncertain because of all the weights outboard and not because of one level, so
//!   halving the interval of the torque helps where halving a level does not. It also separates the two states of a
//!   gear that the mixture blends: a soft gear at a small torque and a stiff gear at a large torque.

use super::parts::{STIFFNESSES, inertia};
use super::pose::Row;
use super::problem::{Part, Problem};
use super::rows::{RelaxedDesign, Rows};
use super::tree::Key;

/// The two coordinates of an option's key ([`Key`]) that stand for its mass and for its stiffness: [`DRIVE`] for drives
/// and [`TUBE`] for tubes. Each is given by its index in the key and by the factor with which the key multiplies the
/// logarithm of the number.
const DRIVE: [(usize, f64); 2] = [(3, 1.0), (0, 4.0)];
const TUBE: [(usize, f64); 2] = [(0, 2.0), (1, 1.0)];
/// A division whose expected benefit is below this is not made, because the benefit is due to rounding.
const LEAST_BENEFIT: f64 = 1e-9;
/// A force whose interval is narrower than this fraction of its greatest magnitude is known well enough. It is not
/// branched on.
const KNOWN_FORCE_WIDTH: f64 = 0.1;
/// Least distance of the value at which a region is divided from either end of the interval, as a fraction of the
/// interval's width.
const LEAST_DISTANCE_TO_END: f64 = 1e-3;

/// A way to divide a region into two: the quantity that is divided, and the value at which it is divided.
#[derive(Debug, Clone, Copy)]
pub(super) struct Branching {
    /// Expected benefit of the division. The weighted sum of rows (inequalities of the bound) is too low for two
    /// reasons: McCormick bounds underestimate products, and the mixed designs differ. The benefit is the part of this
    /// error that the division can remove. It has no unit, because each row is divided by its scale.
    gain: f64,
    /// The quantity that is divided.
    by: BranchOn,
    /// Value at which the region is divided. It is a value of the key coordinate by which the tree separates options (a
    /// scaled logarithm), or a force \[N or N m\].
    at: f64,
}

/// The quantity by which a region is divided into two.
#[derive(Debug, Clone, Copy)]
pub(super) enum BranchOn {
    /// The options of a level, by one coordinate of their keys.
    Options { level: usize, axis: usize },
    /// The generalized force of one row of a case, such as the torque on a joint.
    Force { case: usize, row: usize },
}

/// A mixture: relaxed designs, each with its weight. The weights sum to one. The mixture may lie below a local upper
/// bound although no single design does.
type Mixed<'a> = [(&'a RelaxedDesign, f64)];

/// Weighted mean, over the designs of a mixture, of the number that `of` returns for a design.
fn mean(mixed: &Mixed, of: impl Fn(&RelaxedDesign) -> f64) -> f64 {
    mixed.iter().map(|(member, share)| share * of(member)).sum()
}

/// Mean absolute deviation, over the designs of a mixture, of the number that `of` returns for a design. The weights of
/// the mixture apply to it and to the mean from which it is measured.
fn spread(mixed: &Mixed, of: impl Fn(&RelaxedDesign) -> f64) -> f64 {
    let middle = mean(mixed, &of);
    mean(mixed, |member| (of(member) - middle).abs())
}

impl Rows<'_> {
    /// Ways to divide the region, by descending expected benefit; empty if no division is worth while. `mixed` is the
    /// mixture with which the bound ended. `multipliers` are the factors on the rows (inequalities) of the bound.
    pub(super) fn branchings(&self, mixed: &Mixed, multipliers: &[f64]) -> Vec<Branching> {
        let mut branchings = Vec::new();
        let left_out = self.left_out(mixed, multipliers);
        for (level, &piece) in self.problem.level_pieces.iter().enumerate() {
            let key = |member: &RelaxedDesign| self.problem.key(level, member.design_box[level]);
            let rows = multipliers.iter().enumerate().filter(|(_, multiplier)| **multiplier > 0.0);
            let gain = rows.map(|(row, w)| w * spread(mixed, |member| self.added(member, piece, row))).sum();
            let spreads = [0, 1, 2, 3, 4].map(|axis| spread(mixed, |member| key(member)[axis]));
            // The coordinate in which the mixed designs differ most separates them best.
            let axis = (0..spreads.len()).max_by(|&a, &b| spreads[a].total_cmp(&spreads[b])).unwrap_or(0);
            if spreads[axis] > LEAST_BENEFIT {
                let at = mean(mixed, |member| key(member)[axis]);
                branchings.push(Branching { gain, by: BranchOn::Options { level, axis }, at });
            }
            // The options are divided halfway between the best value and the mean of the mixture. One half then
            // excludes the best value, so that its underestimate is smaller.
            for ((axis, best), gain) in self.best_of(piece).into_iter().zip(left_out[piece]) {
                let at = 0.5 * (best + mean(mixed, |member| key(member)[axis]));
                branchings.push(Branching { gain, by: BranchOn::Options { level, axis }, at });
            }
        }
        branchings.extend(self.by_torque(mixed, multipliers));
        branchings.retain(|branching| branching.gain > LEAST_BENEFIT);
        branchings.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        branchings
    }

    /// Two pairs, the first for the mass of a piece and the second for its stiffness. The first number of a pair is the
    /// index of a coordinate in the key of an option: the coordinate that stands for mass or stiffness. The second
    /// number is the best value of this coordinate in the box.
    fn best_of(&self, piece: usize) -> [(usize, f64); 2] {
        let (light, stiff) = (self.work.light[piece][inertia::MASS], self.work.stiff[piece][0]);
        let (places, stiff) = match &self.work.curves[piece] {
            Some(curve) => (DRIVE, curve.stiff.windup.k1_nm_per_rad),
            None => (TUBE, stiff),
        };
        let number =
            |(axis, times): (usize, f64), x: f64| (axis, times * libm::log(x.max(f64::MIN_POSITIVE)));
        [number(places[0], light), number(places[1], stiff)]
    }

    /// For each piece, the amount by which the McCormick bounds of force times compliance make the weighted sum of
    /// scaled rows too low. The first number is due to the uncertain weight of the piece, the second to its uncertain
    /// compliance.
    fn left_out(&self, mixed: &Mixed, multipliers: &[f64]) -> Vec<[f64; 2]> {
        let mut left_out = vec![[0.0; 2]; self.problem.parts.len()];
        for (judged, tip) in self.tips.iter().enumerate() {
            let multiplier = multipliers[1 + judged] / self.scale[1 + judged];
            for row in &self.problem.poses[tip.case].rows {
                let tip_per_unit = self.work.tip_directions[judged].dot(&row.tip_m);
                let heavier = self.heavier(mixed, judged, row, tip_per_unit);
                let more: f64 = heavier.iter().sum();
                let left = multiplier * self.product(mixed, judged, row, more);
                if left > 0.0 {
                    left_out[row.piece][1] += left;
                    let pieces = left_out.iter_mut().zip(&heavier);
                    pieces.for_each(|(piece, heavier)| piece[0] += left * (heavier / more).abs());
                }
            }
        }
        left_out
    }

    /// Ways to divide the region at a joint torque whose interval is wide. The expected benefit of such a division has
    /// two terms. One is the McCormick underestimate in the twist of this joint and in the tubes and bearings up to the
    /// next joint outboard. The other is the spread of the states of the joint's gear over the mixture.
    fn by_torque(&self, mixed: &Mixed, multipliers: &[f64]) -> Vec<Branching> {
        let mut branchings = Vec::new();
        for (judged, tip) in self.tips.iter().enumerate() {
            let (case, multiplier) = (tip.case, multipliers[1 + judged] / self.scale[1 + judged]);
            // The underestimates of the tubes and bearings further inboard are attributed to the torque of the next
            // joint inboard.
            let mut left_out = 0.0;
            for (at, row) in self.problem.poses[case].rows.iter().enumerate() {
                let tip_per_unit = self.work.tip_directions[judged].dot(&row.tip_m);
                let [low, high] = self.work.forces[case][at];
                // The underestimate takes the force at the end of its interval that moves the tip least.
                let least = if tip_per_unit > 0.0 { low } else { high };
                let made = |member: &RelaxedDesign| -> f64 {
                    row.per_n.iter().zip(member.weights_in(judged)).map(|(c, w)| c * w).sum()
                };
                let acting = row.fixed + mean(mixed, made);
                left_out += multiplier * self.product(mixed, judged, row, acting - least);
                if self.work.curve(row).is_none() {
                    continue;
                }
                let apart = self.free_gear(judged, row.piece).map_or(0.0, |next| {
                    (multipliers[next] + multipliers[next + 1]) * spread(mixed, |member| member.values[next])
                });
                let gain = left_out + apart;
                // The mean torque separates two states of a gear best. To shrink a product, the middle between the
                // least torque and the acting torque is best.
                let at_nm = if apart > left_out { acting } else { 0.5 * (least + acting) };
                let margin = LEAST_DISTANCE_TO_END * (high - low);
                if high - low > KNOWN_FORCE_WIDTH * low.abs().max(high.abs())
                    && low + margin < at_nm
                    && at_nm < high - margin
                {
                    branchings.push(Branching { gain, by: BranchOn::Force { case, row: at }, at: at_nm });
                }
                left_out = 0.0;
            }
        }
        branchings
    }

    /// Tip displacement by which the McCormick bound underestimates force times compliance, in one strain coordinate
    /// (one way to deform) of a piece \[m\]. The McCormick bound is a linear function below the product of two numbers
    /// in intervals. The result is the excess `more` of the force over its least value, times the excess of the
    /// compliance over its least value. Both are means over the mixture.
    fn product(&self, mixed: &Mixed, judged: usize, row: &Row, more: f64) -> f64 {
        let tip_per_unit = self.work.tip_directions[judged].dot(&row.tip_m);
        (tip_per_unit * more * self.softer(mixed, judged, row)).abs()
    }

    /// For each piece, the contribution of its weight to the excess of a force over its least value in the box, as a
    /// mean over the mixture \[N or N m\]. The sign of `tip_per_unit` tells in which direction the force moves the tip.
    fn heavier(&self, mixed: &Mixed, judged: usize, row: &Row, tip_per_unit: f64) -> Vec<f64> {
        let multipliers = row.per_n.iter().zip(&self.work.weights[self.tips[judged].case]).enumerate();
        multipliers
            .map(|(piece, (per_n, [light, heavy]))| {
                let least = if tip_per_unit * per_n > 0.0 { light } else { heavy };
                per_n * (mean(mixed, |member| member.weights_in(judged)[piece]) - least)
            })
            .collect()
    }

    /// By how much the compliance of a strain coordinate exceeds its least value in the box, as a mean over the
    /// mixture. A compliance is the displacement of the coordinate per unit of force.
    fn softer(&self, mixed: &Mixed, judged: usize, row: &Row) -> f64 {
        let case = self.tips[judged].case;
        let posed = &self.problem.poses[case].pieces[row.piece];
        let deflection = |stiffness: &[f64; STIFFNESSES]| {
            let stiffness = posed.coordinate_stiffness(row.coordinate, stiffness);
            if stiffness > 0.0 { 1.0 / stiffness } else { 0.0 }
        };
        let mut stiffest = self.work.stiff[row.piece];
        if let Some(curve) = self.work.curve(row) {
            let [least_nm, most_nm] = self.work.torques[case][row.piece];
            stiffest[0] = curve.steepest(least_nm, most_nm);
        }
        mean(mixed, |member| deflection(&member.stiffness_in(judged)[row.piece])) - deflection(&stiffest)
    }
}

impl Problem<'_> {
    /// The key of a node of a level's tree: the coordinates by which the tree separates this node from others. Zeros
    /// for a level without a tree.
    fn key(&self, level: usize, node: u32) -> Key {
        match &self.parts[self.level_pieces[level]] {
            Part::Drives { tree, .. } => tree.node(node).key(),
            Part::Links { tree, .. } => tree.node(node).key(),
            _ => Key::default(),
        }
    }

    /// The two problems into which `branching` divides this problem. `kept` has, for each level, the nodes that remain
    /// of its base tree (the tree over all options of the level). `None` if all options lie on one side.
    pub(super) fn branch(&self, kept: &[Vec<u32>], branching: &Branching) -> Option<[Self; 2]> {
        match branching.by {
            BranchOn::Options { level, axis } => {
                let [low, high] = self.branch_on_options(kept, level, axis, branching.at)?;
                let low = self.restricted_to(&low)?;
                // The other levels are the same, so their trees serve both halves.
                let high = low.restricted_to(&high)?;
                Some([low, high])
            }
            BranchOn::Force { case, row } => {
                let narrower = self.restricted_to(kept)?;
                let halves = [[f64::NEG_INFINITY, branching.at], [branching.at, f64::INFINITY]];
                Some(halves.map(|half| narrower.with_force_bound(case, row, half)))
            }
        }
    }

    /// Divides the options of `level` at the value `at` of the key coordinate `axis`. Returns, for each side and every
    /// level, the nodes that remain of the level's base tree (the tree over all its options). `None` if all options of
    /// the level lie on one side.
    fn branch_on_options(
        &self,
        kept: &[Vec<u32>],
        level: usize,
        axis: usize,
        at: f64,
    ) -> Option<[Vec<Vec<u32>>; 2]> {
        let part = &self.parts[self.level_pieces[level]];
        let is_low = |node: &&u32| {
            let key = match part {
                Part::Drives { tree, .. } => tree.whole_node(**node).key(),
                Part::Links { tree, .. } => tree.whole_node(**node).key(),
                _ => Key::default(),
            };
            key[axis] <= at
        };
        let (low, high): (Vec<u32>, Vec<u32>) = kept[level].iter().partition(is_low);
        (!low.is_empty() && !high.is_empty()).then(|| {
            [low, high].map(|nodes| {
                let mut kept = kept.to_vec();
                kept[level] = nodes;
                kept
            })
        })
    }
}
