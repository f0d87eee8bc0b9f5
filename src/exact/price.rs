//! What a part costs when every number of it has a price, and the cheapest part below a node of a tree.

use super::parts::{INERTIAS, LinkBox, STIFFNESSES, inertia};
use super::play::Play;
use super::torsion::CurveBox;
use super::tree::{Bounds, Tree};
use crate::arm::joint_law::Segment;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Boxes of parts to look into for the cheapest: with too few its price is that of a box, and the last corners are
/// never refuted.
const MOST_LOOKS: usize = 200;
/// Rounding of a torque.
const ROUNDING: f64 = 1e-12;

/// A gear in a judged case.
pub(super) struct Gear {
    pub piece: usize,
    pub judged: usize,
    /// Torques between which it is \[N m\].
    pub torques_nm: [f64; 2],
    /// The row that says that its torque is not more than what the weights make of it, followed by one that
    /// says that it is not less. None where its slope is the same under all the torques: it is then taken at the
    /// torque `torques_nm[0]`, and twists from there by the weights.
    pub row: Option<usize>,
    /// Twist per torque that no gear of the box falls short of \[rad/(N m)\].
    pub least_compliance: f64,
}

impl Gear {
    /// The gear of a joint whose torque may press it into another segment; its rows are the next.
    pub fn free(
        piece: usize,
        judged: usize,
        [low, high]: [f64; 2],
        next: usize,
        least_compliance: f64,
    ) -> Self {
        let room = ROUNDING * low.abs().max(high.abs());
        let torques_nm = [low - room, high + room];
        Self { piece, judged, torques_nm, row: Some(next), least_compliance }
    }

    /// The gear of a joint that is in one segment.
    pub fn at(piece: usize, judged: usize, torque_nm: f64) -> Self {
        let torques_nm = [torque_nm; 2];
        Self { piece, judged, torques_nm, row: None, least_compliance: 0.0 }
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
    pub play: Option<Play>,
}

/// A gear's state.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct JointState {
    pub torque_nm: f64,
    pub twist_rad: f64,
    pub slope: f64,
}

/// A state of a gear that is worth a price: twist is linear in the torque within a segment, so the ends of the segments
/// are enough. Of a box of gears the least and the greatest twist, without the play, and the greatest slope, with it.
#[derive(Clone, Copy, Default)]
pub(super) struct End {
    pub torque_nm: f64,
    pub twist_rad: [f64; 2],
    pub slope: f64,
}

/// The ends of a gear: two of each of three segments under torques of either sign, at the most.
#[derive(Default)]
pub(super) struct Ends {
    all: [End; 12],
    count: usize,
}

impl Ends {
    #[inline]
    pub fn as_slice(&self) -> &[End] {
        &self.all[..self.count]
    }
}

/// Shows the ends of a curve between two torques \[N m\].
#[inline(always)]
fn each_end(curve: &CurveBox, play: Option<&Play>, [low_nm, high_nm]: [f64; 2], see: &mut impl FnMut(End)) {
    if high_nm >= 0.0 {
        each_end_of_sign(curve, play, 1.0, [low_nm.max(0.0), high_nm], see);
    }
    if low_nm < 0.0 {
        each_end_of_sign(curve, play, -1.0, [(-high_nm).max(0.0), -low_nm], see);
    }
}

/// The same of torques of one sign, by their sizes.
#[inline(always)]
fn each_end_of_sign(
    curve: &CurveBox,
    play: Option<&Play>,
    sign: f64,
    [low, high]: [f64; 2],
    see: &mut impl FnMut(End),
) {
    let w = &curve.stiff.windup;
    for (segment, part) in w.segments().into_iter().enumerate() {
        let Segment { from_nm: start, to_nm: end, stiffness_nm_per_rad: slope } = part;
        let (from, to) = (low.max(start), high.min(end));
        // a break point belongs to the segment below it
        if from <= to && (to > start || start == 0.0) {
            let seen = if curve.k1_in_modes { w.k1_nm_per_rad } else { slope };
            let slope = play.map_or(seen, |play| play.in_series(seen, to));
            let most = sign * curve.soft.angle_rad(to);
            for torque in [from, to].into_iter().take(if from < to { 2 } else { 1 }) {
                let least = sign * curve.stiff.angle_in(segment, torque);
                see(End { torque_nm: sign * torque, twist_rad: [least, most], slope });
            }
        }
        if high <= end {
            return;
        }
    }
}

impl JointPrice {
    /// The cheapest state of a joint with this curve, and its price; of a box of joints no more than that of any.
    pub fn best_of(&self, curve: Option<&CurveBox>) -> (f64, JointState) {
        let Some(curve) = curve else { return self.rigid() };
        let mut best = (f64::INFINITY, JointState::default());
        each_end(curve, self.play.as_ref(), self.torques_nm, &mut |end| {
            let price = self.of_end(&end);
            if price < best.0 {
                let [least, most] = end.twist_rad;
                let twist_rad = if self.twist * most < self.twist * least { most } else { least };
                best = (price, JointState { torque_nm: end.torque_nm, twist_rad, slope: end.slope });
            }
        });
        best
    }

    /// Its price alone.
    #[inline]
    pub fn least_of(&self, curve: Option<&CurveBox>) -> f64 {
        let Some(curve) = curve else { return self.rigid().0 };
        let mut least = f64::INFINITY;
        each_end(curve, self.play.as_ref(), self.torques_nm, &mut |end| {
            least = least.min(self.of_end(&end));
        });
        least
    }

    #[inline]
    fn of_end(&self, end: &End) -> f64 {
        let [least, most] = end.twist_rad.map(|twist| self.twist * twist);
        least.min(most) + self.torque * end.torque_nm - self.slope * end.slope
    }

    /// The states of a joint with this curve that are worth a price.
    #[inline]
    pub fn ends(&self, curve: &CurveBox, ends: &mut Ends) {
        ends.count = 0;
        each_end(curve, self.play.as_ref(), self.torques_nm, &mut |end| {
            ends.all[ends.count] = end;
            ends.count += 1;
        });
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
        self.of_mass(mass_kg) + self.joint.iter().map(|price| price.least_of(curve)).sum::<f64>()
    }

    /// Of what a drive weighs.
    #[inline]
    pub fn of_mass(&self, mass_kg: [f64; 2]) -> f64 {
        let per_kg = self.inertia[inertia::MASS];
        per_kg * if per_kg >= 0.0 { mass_kg[0] } else { mass_kg[1] }
    }

    /// Of a tube; of a box of tubes, no more than that of any.
    #[inline]
    pub fn of_tube(&self, tube: &LinkBox) -> f64 {
        let least = |price: f64, [a, b]: [f64; 2]| price * if price >= 0.0 { a } else { b };
        let mut sum = 0.0;
        for (i, &price) in self.inertia.iter().enumerate() {
            sum += least(price, [tube.low.inertias[i], tube.high.inertias[i]]);
        }
        for k in 0..STIFFNESSES {
            sum += least(self.compliance[k], [tube.compliances[0][k], tube.compliances[1][k]]);
            if self.stiffness[k] > 0.0 {
                sum -= self.stiffness[k] * tube.high.stiffnesses[k];
            }
        }
        sum
    }
}

/// The option of the least price below a node, and that price; a box of a few and less if it takes too long.
pub(super) fn cheapest<B: Bounds>(tree: &Tree<B>, node: u32, price: impl Fn(&B) -> f64) -> (f64, u32) {
    let offer = |node: u32| Offer { price: price(&tree.node(node).bounds), node };
    let mut open = BinaryHeap::with_capacity(2 + MOST_LOOKS / 2);
    let (mut cheapest, mut looks) = (offer(node), 0);
    while let Some(halves) = tree.children(cheapest.node).filter(|_| looks < MOST_LOOKS) {
        looks += 2;
        let [cheaper, dearer] = order(halves.map(offer));
        open.push(dearer);
        // most often the cheapest of all is in the box that was opened
        cheapest = match open.peek_mut() {
            Some(mut first) if *first > cheaper => std::mem::replace(&mut *first, cheaper),
            _ => cheaper,
        };
    }
    (cheapest.price, cheapest.node)
}

/// The cheaper of two first.
fn order([a, b]: [Offer; 2]) -> [Offer; 2] {
    if a > b { [a, b] } else { [b, a] }
}

/// A box of parts, and that none of them is cheaper.
#[derive(Clone, Copy)]
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
