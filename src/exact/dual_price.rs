//! The price of a part under Lagrange multipliers, and the cheapest part below a node of a tree.
//!
//! A row is an inequality that every design of interest satisfies: on the mass, on the displacement of the tip, on a
//! mode or on a torque ([`rows`](super::rows)). The multipliers are the weights of the rows in a sum. Every number of a
//! part (mass, inertia, compliance, stiffness) has a dual price: the amount per unit of this number that the part adds
//! to the weighted sum. The price of the part is the sum over its numbers.

use super::joint_play::JointPlay;
use super::parts::{INERTIAS, LinkBox, STIFFNESSES, inertia, stiffness_of};
use super::pose::TILT;
use super::torsion::CurveBox;
use super::tree::{Bounds, Tree};
use crate::arm::joint_law::Segment;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Greatest number of boxes that are priced in the search for the cheapest part. With a smaller number, the lower bound
/// of a box would more often be taken for the price of its cheapest part. Some local upper bounds would then never be
/// refuted: it would stay open whether a design lies below them.
const MOST_LOOKS: usize = 200;
/// Relative margin for the rounding of a torque.
const ROUNDING: f64 = 1e-12;

/// The gear of a joint in a judged case, as the rows of a bound treat it. A judged case counts for deflection and
/// lowest mode.
pub(super) struct Gear {
    pub piece: usize,
    /// Index of the case among the judged cases.
    pub judged: usize,
    /// Interval of the gear's torque \[N m\].
    pub torques_nm: [f64; 2],
    /// Index of the first of the gear's two rows (inequalities of the bound), if the slope of the gear may change
    /// within the interval. The two rows, one for each direction, force the torque at which the gear is evaluated to
    /// equal the torque that the weights cause. `None` for a gear with a single slope. Such a gear is evaluated at the
    /// torque `torques_nm[0]`. From this torque on, its twist grows linearly with the weights.
    pub row: Option<usize>,
    /// Least compliance of any gear of the box within the interval of torque \[rad/(N m)\]. It is 0 and unused for a
    /// gear with a single slope.
    pub least_compliance: f64,
}

impl Gear {
    /// A gear whose torque, between `low` and `high` \[N m\], may lie in several segments of its curve. `next` is the
    /// index of the first of its two rows.
    pub(super) fn free(
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

    /// A gear that stays in one segment of its curve. It is evaluated at this torque \[N m\].
    pub(super) fn at(piece: usize, judged: usize, torque_nm: f64) -> Self {
        let torques_nm = [torque_nm; 2];
        Self { piece, judged, torques_nm, row: None, least_compliance: 0.0 }
    }
}

/// The dual prices of a piece, one for each of its numbers.
#[derive(Default)]
pub(super) struct DualPrice {
    /// Price per unit of each line inertia of a tube. For any other piece the first entry is the price per kilogram.
    pub inertia: [f64; INERTIAS],
    /// Price per unit of each compliance of a tube. For a joint, the entry [`TILT`] is the price of its bearing's
    /// compliance.
    pub compliance: [f64; STIFFNESSES],
    /// Amount by which each unit of a stiffness (of a tube, or of a joint's bearing) lowers the weighted sum.
    pub stiffness: [f64; STIFFNESSES],
    /// Prices of a joint, one for each judged case.
    pub joint: Vec<JointPrice>,
}

/// The dual prices of the state of a joint's gear in a judged case.
pub(super) struct JointPrice {
    /// Price per radian of the gear's twist \[1/rad\].
    pub twist: f64,
    /// Price per unit of the torque at which the gear is evaluated \[1/(N m)\].
    pub torque: f64,
    /// Amount by which each N m/rad of the torsion curve's slope lowers the weighted sum \[rad/(N m)\].
    pub slope: f64,
    /// Interval of the gear's torque \[N m\].
    pub torques_nm: [f64; 2],
    /// Lost motion and friction of the joint; `None` if it has none.
    pub play: Option<JointPlay>,
}

/// The state of a gear: its torque \[N m\], its twist \[rad\], and the slope of its torsion curve \[N m/rad\].
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct JointState {
    pub torque_nm: f64,
    pub twist_rad: f64,
    pub slope: f64,
}

/// A state of a gear that may have the least price. The twist is linear in the torque within a segment, so the states
/// at the ends of the segments are enough. For a box of gears, `twist_rad` has the least and the greatest twist
/// (without play), and `slope` is the greatest slope (with play).
#[derive(Clone, Copy, Default)]
pub(super) struct GearState {
    pub torque_nm: f64,
    pub twist_rad: [f64; 2],
    pub slope: f64,
}

/// The candidate states of a gear: at most two ends of each of three segments, for torques of both signs.
#[derive(Default)]
pub(super) struct GearStates {
    all: [GearState; 12],
    count: usize,
}

impl GearStates {
    #[inline]
    pub(super) fn as_slice(&self) -> &[GearState] {
        &self.all[..self.count]
    }
}

/// Collects the candidate states of a curve under torques in an interval \[N m\].
#[inline]
pub(super) fn states_of(
    curve: &CurveBox,
    play: Option<&JointPlay>,
    torques_nm: [f64; 2],
    states: &mut GearStates,
) {
    states.count = 0;
    each_state(curve, play, torques_nm, &mut |state| {
        states.all[states.count] = state;
        states.count += 1;
    });
}

/// Calls `see` for every candidate state of a curve under torques in an interval \[N m\].
#[inline(always)]
fn each_state(
    curve: &CurveBox,
    play: Option<&JointPlay>,
    [low_nm, high_nm]: [f64; 2],
    see: &mut impl FnMut(GearState),
) {
    if high_nm >= 0.0 {
        each_state_of_sign(curve, play, 1.0, [low_nm.max(0.0), high_nm], see);
    }
    if low_nm < 0.0 {
        each_state_of_sign(curve, play, -1.0, [(-high_nm).max(0.0), -low_nm], see);
    }
}

/// Calls `see` for every candidate state of a torsion curve under torques of one sign. `low` and `high` are the
/// magnitudes of the least and the greatest torque \[N m\].
#[inline(always)]
fn each_state_of_sign(
    curve: &CurveBox,
    play: Option<&JointPlay>,
    sign: f64,
    [low, high]: [f64; 2],
    see: &mut impl FnMut(GearState),
) {
    let w = &curve.stiff.windup;
    for (segment, part) in w.segments().into_iter().enumerate() {
        let Segment { from_nm: start, to_nm: end, stiffness_nm_per_rad: slope } = part;
        let (from, to) = (low.max(start), high.min(end));
        // A break point belongs to the segment below it.
        if from <= to && (to > start || start == 0.0) {
            // If the modes use K1, the slope does not depend on the segment of the torque.
            let seen = if curve.k1_in_modes { w.k1_nm_per_rad } else { slope };
            let slope = play.map_or(seen, |play| play.in_series(seen, to));
            // The greatest twist is taken at the end of the segment on the softest curve. It is valid for both ends.
            let most = sign * curve.soft.angle_rad(to);
            for torque in [from, to].into_iter().take(if from < to { 2 } else { 1 }) {
                let least = sign * curve.stiff.angle_in(segment, torque);
                see(GearState { torque_nm: sign * torque, twist_rad: [least, most], slope });
            }
        }
        if high <= end {
            return;
        }
    }
}

impl JointPrice {
    /// The price of the cheapest state of a joint's gear, and this state. For a box of gears the price is a lower bound
    /// over its members. A `curve` of `None` stands for a rigid joint.
    pub(super) fn best_of(&self, curve: Option<&CurveBox>) -> (f64, JointState) {
        let Some(curve) = curve else { return self.rigid() };
        let mut best = (f64::INFINITY, JointState::default());
        each_state(curve, self.play.as_ref(), self.torques_nm, &mut |end| {
            let price = self.of_state(&end);
            if price < best.0 {
                let [least, most] = end.twist_rad;
                let twist_rad = if self.twist * most < self.twist * least { most } else { least };
                best = (price, JointState { torque_nm: end.torque_nm, twist_rad, slope: end.slope });
            }
        });
        best
    }

    /// The price of the cheapest state of a joint's gear, without the state itself.
    #[inline]
    pub(super) fn least_of(&self, curve: Option<&CurveBox>) -> f64 {
        let Some(curve) = curve else { return self.rigid().0 };
        let mut least = f64::INFINITY;
        each_state(curve, self.play.as_ref(), self.torques_nm, &mut |end| {
            least = least.min(self.of_state(&end));
        });
        least
    }

    /// Price of one state. Where the twist is an interval, the end with the lower price is taken.
    #[inline]
    fn of_state(&self, end: &GearState) -> f64 {
        let [least, most] = end.twist_rad.map(|twist| self.twist * twist);
        least.min(most) + self.torque * end.torque_nm - self.slope * end.slope
    }

    /// Writes the candidate states of a joint with this torsion curve into `ends`.
    #[inline]
    pub(super) fn ends(&self, curve: &CurveBox, ends: &mut GearStates) {
        states_of(curve, self.play.as_ref(), self.torques_nm, ends);
    }

    /// Price and state of a rigid joint. A box of drives without a curve contains a rigid drive, but may contain other
    /// drives whose curves are not known. The price is a lower bound for these drives too.
    fn rigid(&self) -> (f64, JointState) {
        let [low, high] = self.torques_nm.map(|t| self.torque * t);
        // Other members of the box may twist by any angle. If some twist lowers the price, no finite lower bound
        // exists.
        let opposed = self.torques_nm.iter().any(|t| t * self.twist < 0.0);
        match opposed || self.slope > 0.0 {
            true => (f64::NEG_INFINITY, JointState::default()),
            false => (low.min(high), JointState::default()),
        }
    }
}

impl DualPrice {
    /// Price of a joint's drive with mass, torsion curve and bearing tilt in these intervals. For a box of drives, it
    /// is a lower bound over its members.
    pub(super) fn of_joint(
        &self,
        mass_kg: [f64; 2],
        curve: Option<&CurveBox>,
        tilt_rad_per_nm: [f64; 2],
    ) -> f64 {
        let torsion: f64 = self.joint.iter().map(|price| price.least_of(curve)).sum();
        self.of_mass(mass_kg) + torsion + self.of_tilt(tilt_rad_per_nm)
    }

    /// Price of the output bearing of a drive. The bearing's tilt per moment lies in the interval `tilt_rad_per_nm`,
    /// and the price is a lower bound over it.
    #[inline]
    fn of_tilt(&self, tilt_rad_per_nm: [f64; 2]) -> f64 {
        least(self.compliance[TILT], tilt_rad_per_nm)
            - self.stiffness[TILT] * stiffness_of(tilt_rad_per_nm[0])
    }

    /// Price of a drive's mass, which lies in the interval `mass_kg`. It is a lower bound over the interval.
    #[inline]
    pub(super) fn of_mass(&self, mass_kg: [f64; 2]) -> f64 {
        let per_kg = self.inertia[inertia::MASS];
        per_kg * if per_kg >= 0.0 { mass_kg[0] } else { mass_kg[1] }
    }

    /// Price of a tube. For a box of tubes: a lower bound over its members.
    #[inline]
    pub(super) fn of_tube(&self, tube: &LinkBox) -> f64 {
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

/// The price of a tube, prepared for the pricing of many tubes. The sign of a number's price tells which end of the
/// number's interval costs less: index 0 for the lower end, 1 for the upper end.
pub(super) struct TubePrice<'a> {
    price: &'a DualPrice,
    inertia_ends: [usize; INERTIAS],
    compliance_ends: [usize; STIFFNESSES],
}

impl<'a> TubePrice<'a> {
    pub(super) fn new(price: &'a DualPrice) -> Self {
        let end = |price: f64| usize::from(price < 0.0);
        Self { price, inertia_ends: price.inertia.map(end), compliance_ends: price.compliance.map(end) }
    }

    /// Price of a tube, as [`DualPrice::of_tube`] but for rounding. The three sums do not depend on each other, so the
    /// processor can compute them at the same time.
    #[inline]
    fn of(&self, tube: &LinkBox) -> f64 {
        let DualPrice { inertia, compliance, stiffness, .. } = self.price;
        let inertias = [&tube.low.inertias, &tube.high.inertias];
        let [mut of_inertia, mut of_compliance, mut earned] = [0.0; 3];
        for k in 0..INERTIAS {
            of_inertia += inertia[k] * inertias[self.inertia_ends[k]][k];
        }
        for k in 0..STIFFNESSES {
            of_compliance += compliance[k] * tube.compliances[self.compliance_ends[k]][k];
            // An infinite stiffness times a zero price must not become NaN.
            if stiffness[k] > 0.0 {
                earned += stiffness[k] * tube.high.stiffnesses[k];
            }
        }
        of_inertia + of_compliance - earned
    }

    /// The least price of a tube below a node, and its node.
    pub(super) fn cheapest(&self, tree: &Tree<LinkBox>, node: u32) -> (f64, u32) {
        cheapest(tree, node, |tube| self.of(tube))
    }
}

/// The least price of a number that lies in an interval: the price per unit times the cheaper end.
#[inline]
fn least(price: f64, [low, high]: [f64; 2]) -> f64 {
    price * if price >= 0.0 { low } else { high }
}

/// The least price of an option below a node, and its node. If the search ends early the node is a box of
/// several options, and the price is a lower bound.
fn cheapest<B: Bounds>(tree: &Tree<B>, node: u32, price: impl Fn(&B) -> f64) -> (f64, u32) {
    let offer = |node: u32| Offer { price: price(&tree.node(node).bounds), node };
    let mut open = BinaryHeap::with_capacity(2 + MOST_LOOKS / 2);
    let (mut cheapest, mut looks) = (offer(node), 0);
    while let Some(halves) = tree.children(cheapest.node).filter(|_| looks < MOST_LOOKS) {
        // Best-first search: the cheapest open box is opened next.
        looks += 2;
        let [cheaper, dearer] = order(halves.map(offer));
        open.push(dearer);
        // Most often the cheapest option is in the box that was just opened. Replacing the top of the heap is
        // cheaper than a push and a pop.
        cheapest = match open.peek_mut() {
            Some(mut first) if *first > cheaper => std::mem::replace(&mut *first, cheaper),
            _ => cheaper,
        };
    }
    (cheapest.price, cheapest.node)
}

/// Orders two boxes by their prices, the cheaper first.
fn order([a, b]: [Offer; 2]) -> [Offer; 2] {
    if a > b { [a, b] } else { [b, a] }
}

/// A box of parts in the search for the cheapest one: its node, and a lower bound of the prices of its parts.
#[derive(Clone, Copy)]
struct Offer {
    price: f64,
    node: u32,
}

impl Ord for Offer {
    /// The cheaper box counts as greater, because [`BinaryHeap`] pops its greatest entry. Of boxes with equal prices
    /// the box with the lower node comes first.
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
