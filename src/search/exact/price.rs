//! What a part costs when every number of it has a price, and the cheapest part below a node of a tree.

use super::bound::interval;
use super::parts::{CurveBox, INERTIAS, LinkBox, STIFFNESSES, inertia, segments};
use super::pose::Row;
use super::tree::{Bounds, Tree};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Boxes of parts to look into for the cheapest.
const MOST_LOOKS: usize = 24;
/// Rounding of a torque.
const ROUNDING: f64 = 1e-12;

/// A gear in a judged case.
pub(super) struct Gear<'a> {
    pub piece: usize,
    pub judged: usize,
    /// Torques between which it is \[N m\], and what each weight adds \[m\].
    pub torques_nm: [f64; 2],
    pub per_n: &'a [f64],
    /// The row that says that its torque is not more than what the weights make of it, followed by one that
    /// says that it is not less. None where its slope is the same under all the torques: it is then taken at the
    /// torque `torques_nm[0]`, and twists from there by the weights.
    pub row: Option<usize>,
}

impl<'a> Gear<'a> {
    /// The gear of a joint whose torque may press it into another segment; its rows are the next.
    pub fn free(row: &'a Row, judged: usize, weights: &[[f64; 2]], next: usize) -> Self {
        let [low, high] = interval(row.fixed, &row.per_n, weights);
        let room = ROUNDING * low.abs().max(high.abs());
        let torques_nm = [low - room, high + room];
        Self { piece: row.piece, judged, torques_nm, per_n: &row.per_n, row: Some(next) }
    }

    /// The gear of a joint that is in one segment.
    pub fn at(row: &'a Row, judged: usize, torque_nm: f64) -> Self {
        Self { piece: row.piece, judged, torques_nm: [torque_nm; 2], per_n: &row.per_n, row: None }
    }

    /// What its rows are measured in \[N m\]: not so small that rounding counts.
    pub fn scale_nm(&self) -> f64 {
        let [low, high] = self.torques_nm;
        (high - low).max(1e-3 * low.abs().max(high.abs()))
    }
}

/// The price of a piece: of each of its numbers.
#[derive(Default)]
pub(super) struct Price {
    /// Per line inertia of a tube; per kg of anything else in the first place.
    pub inertia: [f64; INERTIAS],
    /// Per compliance of a tube, and what each stiffness earns.
    pub compliance: [f64; STIFFNESSES],
    pub stiffness: [f64; STIFFNESSES],
    /// Of a joint, by judged case.
    pub joint: Vec<JointPrice>,
}

/// The price of a gear's state in a case.
pub(super) struct JointPrice {
    /// Per twist, per torque, and what the slope earns.
    pub twist: f64,
    pub torque: f64,
    pub slope: f64,
    pub torques_nm: [f64; 2],
}

/// A gear's state.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct JointState {
    pub torque_nm: f64,
    pub twist_rad: f64,
    pub slope: f64,
}

impl JointPrice {
    /// The cheapest state of a gear whose torque is free, and its price; of a box of gears no more than that of
    /// any. Twist is linear in the torque within a segment, so the ends of the segments are enough.
    #[inline]
    pub fn best(&self, curve: Option<&CurveBox>) -> (f64, JointState) {
        let Some(curve) = curve else {
            return self.rigid();
        };
        let mut best = (f64::INFINITY, JointState::default());
        for sign in [1.0, -1.0] {
            let [low, high] =
                if sign > 0.0 { self.torques_nm } else { [-self.torques_nm[1], -self.torques_nm[0]] };
            if high < 0.0 || (high == 0.0 && sign < 0.0) {
                continue;
            }
            self.best_of_sign(curve, sign, low.max(0.0), high, &mut best);
        }
        best
    }

    /// The same among torques of one sign and of sizes between two.
    #[inline]
    fn best_of_sign(&self, curve: &CurveBox, sign: f64, low: f64, high: f64, best: &mut (f64, JointState)) {
        let w = &curve.stiff;
        let twist = self.twist * sign;
        let mut angle = 0.0;
        for (slope, start, end) in segments(w) {
            let (from, to) = (low.max(start), high.min(end));
            let first = angle;
            // a break point belongs to the segment below it
            if from <= to && (to > start || start == 0.0) {
                let seen = if curve.k1_in_modes { w.k1_nm_per_rad } else { slope };
                for torque in if from < to { [from, to] } else { [from, f64::NAN] } {
                    let angle = match twist >= 0.0 {
                        true => first + (torque - start) / slope,
                        false => curve.soft.angle_rad(to),
                    };
                    let price = twist * angle + self.torque * sign * torque - self.slope * seen;
                    if price < best.0 {
                        let state =
                            JointState { torque_nm: sign * torque, twist_rad: sign * angle, slope: seen };
                        *best = (price, state);
                    }
                }
            }
            if high <= end {
                return;
            }
            angle += (end - start) / slope;
        }
    }

    /// Of a rigid joint, or of a box that has one: nothing is known of the others.
    fn rigid(&self) -> (f64, JointState) {
        let [low, high] = self.torques_nm.map(|t| self.torque * t);
        let opposed = self.torques_nm.iter().any(|t| t * self.twist < 0.0);
        match opposed || self.slope > 0.0 {
            true => (f64::NEG_INFINITY, JointState::default()),
            false => (low.min(high), JointState::default()),
        }
    }
}

impl Price {
    /// Of a joint's drive; of a box of drives, no more than that of any.
    pub fn of_joint(&self, mass_kg: [f64; 2], curve: Option<&CurveBox>) -> f64 {
        let per_kg = self.inertia[inertia::MASS];
        let mass = per_kg * if per_kg >= 0.0 { mass_kg[0] } else { mass_kg[1] };
        mass + self.joint.iter().map(|price| price.best(curve).0).sum::<f64>()
    }

    /// Of a tube; of a box of tubes, no more than that of any.
    pub fn of_link(&self, links: &LinkBox) -> f64 {
        let mut sum = 0.0;
        for (i, price) in self.inertia.iter().enumerate() {
            sum += price * if *price >= 0.0 { links.low.inertias[i] } else { links.high.inertias[i] };
        }
        for k in 0..STIFFNESSES {
            let (soft, stiff) = (links.low.stiffnesses[k], links.high.stiffnesses[k]);
            sum += self.compliance[k] / if self.compliance[k] >= 0.0 { stiff } else { soft };
            if self.stiffness[k] > 0.0 {
                sum -= self.stiffness[k] * stiff;
            }
        }
        sum
    }
}

/// The option of the least price below a node, and that price; a box of a few and less if it takes too long.
pub(super) fn cheapest<B: Bounds>(tree: &Tree<B>, node: u32, price: impl Fn(&B) -> f64) -> (f64, u32) {
    let mut open = BinaryHeap::from([Offer { price: price(&tree.node(node).bounds), node }]);
    let mut looks = 0;
    while let Some(Offer { price: least, node }) = open.pop() {
        match tree.children(node) {
            Some(halves) if looks < MOST_LOOKS => {
                looks += 2;
                open.extend(halves.map(|half| Offer { price: price(&tree.node(half).bounds), node: half }));
            }
            _ => return (least, node),
        }
    }
    (f64::INFINITY, node)
}

/// A box of parts, and that none of them is cheaper.
struct Offer {
    price: f64,
    node: u32,
}

impl Ord for Offer {
    /// The cheapest is the greatest; of equals the first.
    fn cmp(&self, other: &Self) -> Ordering {
        other.price.total_cmp(&self.price).then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Offer {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Offer {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Offer {}
