//! What a part costs when every number of it has a price, and the cheapest part below a node of a tree.

use super::parts::{CurveBox, INERTIAS, LinkBox, STIFFNESSES, inertia, segments};
use super::play::Play;
use super::tree::{Bounds, Tree};
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

/// The states of a gear that are worth a price: twist is linear in the torque within a segment, so the ends of the
/// segments are enough. Of a box of gears no member has a lower price in any. Twists are without the play, slopes with it.
pub(super) struct States {
    ends: [End; 12],
    count: usize,
}

/// One end of a segment: torque, least and greatest twist, slope that modes see.
#[derive(Clone, Copy, Default)]
struct End {
    torque_nm: f64,
    twist_rad: [f64; 2],
    slope: f64,
}

impl States {
    /// The states of a gear between two torques \[N m\].
    #[inline]
    pub fn of(curve: &CurveBox, play: Option<&Play>, [low_nm, high_nm]: [f64; 2]) -> Self {
        let mut states = Self { ends: [End::default(); 12], count: 0 };
        if high_nm >= 0.0 {
            states.add_sign(curve, play, 1.0, low_nm.max(0.0), high_nm);
        }
        if low_nm < 0.0 {
            states.add_sign(curve, play, -1.0, (-high_nm).max(0.0), -low_nm);
        }
        states
    }

    /// Those among torques of one sign and of sizes between two.
    #[inline]
    fn add_sign(&mut self, curve: &CurveBox, play: Option<&Play>, sign: f64, low: f64, high: f64) {
        let w = &curve.stiff;
        let mut first = 0.0;
        for (slope, start, end) in segments(w) {
            let (from, to) = (low.max(start), high.min(end));
            // a break point belongs to the segment below it
            if from <= to && (to > start || start == 0.0) {
                let seen = if curve.k1_in_modes { w.k1_nm_per_rad } else { slope };
                let seen = play.map_or(seen, |play| play.in_series(seen, to));
                let most = sign * curve.soft.angle_rad(to);
                for torque in [from, to].into_iter().take(if from < to { 2 } else { 1 }) {
                    let least = sign * (first + (torque - start) / slope);
                    self.ends[self.count] =
                        End { torque_nm: sign * torque, twist_rad: [least, most], slope: seen };
                    self.count += 1;
                }
            }
            if high <= end {
                return;
            }
            first += (end - start) / slope;
        }
    }
}

impl JointPrice {
    /// The cheapest state of a joint, and its price; of a box of joints no more than that of any.
    #[inline]
    pub fn best(&self, states: Option<&States>) -> (f64, JointState) {
        let Some(states) = states else { return self.rigid() };
        let mut best = (f64::INFINITY, JointState::default());
        for end in &states.ends[..states.count] {
            let [least, most] = end.twist_rad.map(|twist| self.twist * twist);
            let price = least.min(most) + self.torque * end.torque_nm - self.slope * end.slope;
            if price < best.0 {
                let twist_rad = end.twist_rad[usize::from(most < least)];
                best = (price, JointState { torque_nm: end.torque_nm, twist_rad, slope: end.slope });
            }
        }
        best
    }

    /// The same of a joint with this curve.
    #[inline]
    pub fn best_of(&self, curve: Option<&CurveBox>) -> (f64, JointState) {
        self.best(curve.map(|curve| self.states(curve)).as_ref())
    }

    /// The states of a joint with this curve.
    #[inline]
    pub fn states(&self, curve: &CurveBox) -> States {
        States::of(curve, self.play.as_ref(), self.torques_nm)
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

/// What prices see of a tube, or of a box of tubes.
pub(super) struct TubeNumbers {
    inertia: [[f64; INERTIAS]; 2],
    compliance: [[f64; STIFFNESSES]; 2],
    stiffness: [f64; STIFFNESSES],
}

impl TubeNumbers {
    #[inline]
    pub fn of(links: &LinkBox) -> Self {
        Self {
            inertia: [links.low.inertias, links.high.inertias],
            compliance: [&links.high, &links.low].map(|line| line.stiffnesses.map(f64::recip)),
            stiffness: links.high.stiffnesses,
        }
    }
}

impl Price {
    /// Of a joint's drive; of a box of drives, no more than that of any.
    pub fn of_joint(&self, mass_kg: [f64; 2], curve: Option<&CurveBox>) -> f64 {
        self.of_mass(mass_kg) + self.joint.iter().map(|price| price.best_of(curve).0).sum::<f64>()
    }

    /// Of what a drive weighs.
    #[inline]
    pub fn of_mass(&self, mass_kg: [f64; 2]) -> f64 {
        let per_kg = self.inertia[inertia::MASS];
        per_kg * if per_kg >= 0.0 { mass_kg[0] } else { mass_kg[1] }
    }

    /// Of a tube; of a box of tubes, no more than that of any.
    #[inline]
    pub fn of_tube(&self, tube: &TubeNumbers) -> f64 {
        let least = |price: f64, [a, b]: [f64; 2]| price * if price >= 0.0 { a } else { b };
        let mut sum = 0.0;
        for (i, &price) in self.inertia.iter().enumerate() {
            sum += least(price, [tube.inertia[0][i], tube.inertia[1][i]]);
        }
        for k in 0..STIFFNESSES {
            sum += least(self.compliance[k], [tube.compliance[0][k], tube.compliance[1][k]]);
            if self.stiffness[k] > 0.0 {
                sum -= self.stiffness[k] * tube.stiffness[k];
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
