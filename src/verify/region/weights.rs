//! Weighted sums of a subproblem's rows (surrogate constraints).
//!
//! A subproblem has the options that designs below an upper bound (a mass, a deflection and a frequency) may have; its
//! members are the designs that these options make. The rows are linear inequalities ([`rows`](super::rows)).
//!
//! With non-negative weights, a weighted sum of the rows is at most zero for every member below the upper bound. The
//! least value of this sum over all members is found part by part. If it is positive, no member lies below the upper
//! bound. Otherwise the distance of this least value from zero tells which options are too expensive for any member
//! (reduced costs).

use super::matrix_game::{Minimax, solve};
use super::price::{Prices, affordable, cheapest};
use super::rows::Rows;
use super::subproblem::Subproblem;
use std::ops::Range;

/// Largest number of weightings that are tried for a subproblem.
const MOST_SURROGATES: usize = 24;
/// Largest number of times that rows of new trial shapes (motions that bound the lowest mode) are added.
const MOST_SHAPES: usize = 3;
/// Number of further weightings after it is clear that no weighting refutes the subproblem. They are worth the time
/// because better weights exclude more options.
const TO_NARROW: usize = 4;
/// The search for weights ends if no weighting can raise the least weighted sum by more than this. Rows are scaled, so
/// it has no unit.
const WEIGHT_CONVERGENCE: f64 = 5e-4;
/// Values of rows are limited to this magnitude, so that a row far from its limit does not outweigh the others.
const LARGEST_ROW: f64 = 10.0;
/// Margin for rounding in sums whose terms are about one.
pub(super) const ROUNDING: f64 = 1e-9;
/// Number of weightings that are used to exclude options: the weightings with the greatest least sums.
const WEIGHTINGS_USED: usize = 12;
/// Approximate number of nodes into which the tubes of a link are divided when options are excluded.
const NODES_PER_LINK: usize = 128;

/// A weighting of the rows: the weights, the least value of the weighted sum over all members (`least`), and the amount
/// that each part adds to it.
struct Surrogate {
    weights: Vec<f64>,
    least: f64,
    parts: Vec<f64>,
}

/// The cheapest member under a weighting, as the numbers of its parts. It need not be a design, because the twist of a
/// gear may belong to another torque than the masses cause.
pub(super) struct Member {
    pub numbers: Vec<f64>,
    /// Index of the drive of each joint.
    pub drives: Vec<u32>,
}

/// The result of reducing a subproblem below an upper bound.
pub(super) struct Reduced {
    /// For each joint, the drives that a member below the upper bound may have. `tubes` has the same for each link,
    /// as nodes of the link's tree.
    pub joints: Vec<Vec<u32>>,
    pub tubes: Vec<Vec<u32>>,
    /// The cheapest members, each with its fraction of the mixture that no weights refute.
    pub mixed: Vec<(f64, Member)>,
    /// The weights of the rows that come nearest to a proof that no member is below the upper bound.
    pub weights: Vec<f64>,
}

impl Rows<'_> {
    /// Price of each number of a part: its coefficient in the sum of the rows with these weights.
    fn prices(&self, weights: &[f64]) -> Vec<f64> {
        let mut prices = vec![0.0; self.columns.len()];
        for (row, weight) in self.rows.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            prices.iter_mut().zip(&row.per_number).for_each(|(price, per)| *price += weight * per);
        }
        prices
    }

    /// Price of each torsion curve of a joint, with the bearing that belongs to it. Infinite if no drive of the
    /// subproblem has the curve.
    fn curve_prices(&self, joint: usize, prices: &[f64]) -> Vec<f64> {
        let first = self.columns.mass(joint) + 1;
        let price = |numbers: &Vec<f64>| numbers.iter().zip(&prices[first..]).map(|(a, b)| a * b).sum();
        self.curves[joint].iter().map(|numbers| numbers.as_ref().map_or(f64::INFINITY, price)).collect()
    }

    /// Minimizes the weighted sum of the rows over the members of a subproblem. Returns the least sum, and a member
    /// that attains it.
    fn least(&self, subproblem: &Subproblem, weights: Vec<f64>) -> (Surrogate, Member) {
        let prices = self.prices(&weights);
        let mut numbers = vec![0.0; self.columns.len()];
        let (mut parts, mut drives) = (Vec::new(), Vec::new());
        for (joint, kept) in subproblem.joints.iter().enumerate() {
            let (table, first) = (&self.table.joints[joint], self.columns.mass(joint));
            let (per_kg, curves) = (prices[first], self.curve_prices(joint, &prices));
            let price = |drive: u32| {
                per_kg * table.masses_kg[drive as usize] + curves[table.curve[drive as usize] as usize]
            };
            let mut best = (f64::INFINITY, kept[0]);
            for &drive in kept {
                let price = price(drive);
                if price < best.0 {
                    best = (price, drive);
                }
            }
            numbers[first] = table.masses_kg[best.1 as usize];
            if let Some(curve) = &self.curves[joint][table.curve[best.1 as usize] as usize] {
                numbers[first + 1..=first + curve.len()].copy_from_slice(curve);
            }
            drives.push(best.1);
            parts.push(best.0);
        }
        for (tube, kept) in subproblem.tubes.iter().enumerate() {
            let (table, columns) =
                (&self.table.tubes[tube], self.columns.of_part(self.columns.joints + tube));
            let prices = Prices::new(&prices[columns.clone()]);
            let (price, node) = cheapest(table, kept, &prices);
            numbers[columns].copy_from_slice(&prices.numbers(table.bounds(node)));
            parts.push(price);
        }
        let fixed: f64 = self.rows.iter().zip(&weights).map(|(row, weight)| weight * row.fixed).sum();
        let least = fixed + parts.iter().sum::<f64>();
        (Surrogate { weights, least, parts }, Member { numbers, drives })
    }

    /// The weights with which the search of a subproblem starts: the weights with which its parent ended, or equal
    /// weights if it has no parent.
    fn inherited(&self, subproblem: &Subproblem) -> Vec<f64> {
        let mut weights = subproblem.weights.clone();
        weights.resize(self.first_mode, 0.0);
        weights.extend(subproblem.shapes.iter().map(|shape| shape.weight));
        let counted = (0..weights.len()).filter(|row| !self.conditions().contains(row));
        let sum: f64 = counted.map(|row| weights[row]).sum();
        let fits = weights.len() == self.rows.len() && sum > 0.0;
        let even = vec![1.0 / self.rows.len() as f64; self.rows.len()];
        if fits { weights.iter().map(|weight| weight / sum).collect() } else { even }
    }

    /// Reduces the options of a subproblem below the upper bound for which these rows were made. `None` if some
    /// weighting proves that no member lies below it.
    pub(super) fn reduce(&mut self, subproblem: &Subproblem) -> Option<Reduced> {
        let (mut surrogates, mut members, mut values) = (Vec::new(), Vec::new(), Vec::<Vec<f64>>::new());
        let (mut shapes, mut to_narrow, mut nearest) = (0, 0, f64::NEG_INFINITY);
        let mut weights = self.inherited(subproblem);
        let minimax = loop {
            let (surrogate, member) = self.least(subproblem, weights);
            if surrogate.least > ROUNDING {
                return None;
            }
            nearest = f64::max(nearest, surrogate.least);
            surrogates.push(surrogate);
            values.push(self.values(&member));
            members.push(member);
            let mut minimax = solve(&values, self.conditions());
            if minimax.most <= ROUNDING && shapes < MOST_SHAPES {
                shapes += 1;
                if self.add_shapes(&members, &minimax) {
                    values = members.iter().map(|member| self.values(member)).collect();
                    minimax = solve(&values, self.conditions());
                }
            }
            to_narrow += usize::from(minimax.most <= ROUNDING);
            if surrogates.len() >= MOST_SURROGATES
                || to_narrow > TO_NARROW
                || minimax.most <= nearest + WEIGHT_CONVERGENCE
            {
                break minimax;
            }
            weights = minimax.weights;
        };
        // Each row is tried by itself, with weight 1. The rows of mass and tip displacement are left out for a
        // subproblem with a parent, because they were tried for the parent already.
        let first = if subproblem.weights.is_empty() { 0 } else { self.first_interval };
        let singles = (first..self.first_mode).map(|row| {
            let mut weights = vec![0.0; self.rows.len()];
            weights[row] = 1.0;
            weights
        });
        for weights in singles {
            let (surrogate, _) = self.least(subproblem, weights);
            if surrogate.least > ROUNDING {
                return None;
            }
            surrogates.push(surrogate);
        }
        let [joints, tubes] = self.affordable(subproblem, surrogates)?;
        Some(Reduced {
            joints,
            tubes,
            mixed: minimax.shares.into_iter().zip(members).collect(),
            weights: minimax.weights,
        })
    }

    /// Indices of the rows of torque intervals. These rows come in pairs of opposite sign, so the weights of these
    /// rows are not counted in the sum of the weights, which is one.
    fn conditions(&self) -> Range<usize> {
        self.first_interval..self.first_mode
    }

    fn values(&self, member: &Member) -> Vec<f64> {
        self.rows.iter().map(|row| row.value(&member.numbers).clamp(-LARGEST_ROW, LARGEST_ROW)).collect()
    }

    /// Adds the row of a mode in every case in which a mixture has a mode below the upper bound's frequency. The
    /// mixture consists of `members`, each with its fraction in `minimax`. Returns whether a row was added.
    fn add_shapes(&mut self, members: &[Member], minimax: &Minimax) -> bool {
        let mut between = vec![0.0; self.columns.len()];
        for (member, share) in members.iter().zip(&minimax.shares) {
            between.iter_mut().zip(&member.numbers).for_each(|(sum, number)| *sum += share * number);
        }
        let before = self.rows.len();
        for case in 0..self.columns.cases {
            let pencil = self.pencil(case, &between);
            if let Some(shape) = pencil.slower_motion(self.upper.eigenvalue()) {
                self.add_mode(case, shape);
            }
        }
        self.rows.len() > before
    }

    /// The options of each joint and of each link that none of the weightings `surrogates` excludes; `None` if a joint
    /// or link has no option left.
    fn affordable(
        &self,
        subproblem: &Subproblem,
        mut surrogates: Vec<Surrogate>,
    ) -> Option<[Vec<Vec<u32>>; 2]> {
        surrogates.sort_by(|a, b| b.least.total_cmp(&a.least));
        surrogates.truncate(WEIGHTINGS_USED);
        let rooms: Vec<(Vec<f64>, f64, Surrogate)> = surrogates
            .into_iter()
            .map(|mut surrogate| {
                surrogate.weights.resize(self.rows.len(), 0.0);
                (self.prices(&surrogate.weights), ROUNDING - surrogate.least, surrogate)
            })
            .collect();
        let joints = subproblem.joints.iter().enumerate().map(|(joint, kept)| {
            let table = &self.table.joints[joint];
            let mut kept = kept.clone();
            for (prices, room, surrogate) in &rooms {
                let (per_kg, most) = (prices[self.columns.mass(joint)], surrogate.parts[joint] + room);
                let curves = self.curve_prices(joint, prices);
                kept.retain(|&drive| {
                    let curve = curves[table.curve[drive as usize] as usize];
                    per_kg * table.masses_kg[drive as usize] + curve <= most
                });
            }
            (!kept.is_empty()).then_some(kept)
        });
        let tubes = subproblem.tubes.iter().enumerate().map(|(tube, kept)| {
            let part = self.columns.joints + tube;
            let limit = |(prices, room, surrogate): &(Vec<f64>, f64, Surrogate)| {
                (Prices::new(&prices[self.columns.of_part(part)]), surrogate.parts[part] + room)
            };
            let limits: Vec<(Prices, f64)> = rooms.iter().map(limit).collect();
            let kept = affordable(&self.table.tubes[tube], kept, &limits, NODES_PER_LINK);
            (!kept.is_empty()).then_some(kept)
        });
        Some([joints.collect::<Option<_>>()?, tubes.collect::<Option<_>>()?])
    }
}
