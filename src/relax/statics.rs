//! Linear lower bounds of the tip deflection and of the loads on joints, in one case.
//!
//! A slot is a piece of the arm with its options. A row is a linear inequality of the program.
//!
//! A piece is loaded by the wrench (force and moment) of everything outboard, `W = W₀ + Σ_j q_j û_j`. Here `û_j` is
//! the wrench of one unit of the load of slot `j`, and `q_j` is the load of its chosen option. The displacement of
//! the tip along a direction `d` is a sum over the pieces. The loads `q` lie between `q⁻` and `q⁺`. At each
//! end (all loads least, or all greatest) every term has a value, and each load adds at least its least slope times its
//! distance from that end. The sum is a lower bound of the term. Each of the two ends gives a row.

use super::parts::{Parts, slot_masses};
use super::row::Row;
use super::slopes::{rising_range, tangent_range};
use crate::arm::joint_law::JointLaw;
use crate::mechanics::Wrench;
use crate::sizing::demand::LinearReading;
use crate::space::problem::ArmProblem;
use crate::space::slot::Slot;
use crate::space::station::{Station, StationJoint, StationSlot};
use nalgebra::{Matrix6, Vector3};

/// The loads of one case, as the linear program uses them: the wrench (force and moment) of each slot's load, and the
/// load of each option.
pub(super) struct CaseLoads {
    case: usize,
    /// For each slot, the wrench (force and moment) per unit of the slot's load.
    unit: Vec<Wrench>,
    /// For each slot, the load of each option: mass \[kg\] for joints, weight \[N\] for links, 1 for bodies.
    amount: Vec<Vec<f64>>,
    /// Inertias about the joints' axes \[kg m²\]; first index the slot of the joint, second a slot outboard of it,
    /// third an option of that slot. Empty for a slot that is not a joint.
    inertia: Vec<Vec<Vec<f64>>>,
}

/// The end of the loads' intervals, with all loads least or all greatest, at which the linear bound equals the exact
/// value.
#[derive(Clone, Copy, PartialEq)]
enum LoadEnd {
    Low,
    High,
}

/// A linear lower bound of the deflection that one piece causes.
struct Term {
    /// For each remaining option of the piece, the tip deflection that it causes if all loads have their values at the
    /// end for which the bound is made \[m\].
    at_end: Vec<f64>,
    /// For each load outboard, the slope with which the linear bound of this tip deflection changes with the load \[m
    /// per unit\].
    slopes: Vec<f64>,
}

impl CaseLoads {
    /// Computes the wrenches and the loads of the case with the index `case`.
    pub(super) fn new(problem: &ArmProblem, case: usize) -> Self {
        let station = &problem.stations()[case];
        let (mut unit, mut amount) = (Vec::new(), Vec::new());
        for (slot, placed) in problem.slots().iter().zip(&station.slots) {
            match placed {
                StationSlot::Joint(joint) => {
                    unit.push(joint.weight_per_kg);
                    amount.push(slot_masses(slot));
                }
                StationSlot::Body { weight, .. } => {
                    unit.push(*weight);
                    amount.push(vec![1.0]);
                }
                StationSlot::Link { options, .. } => {
                    let weights: Vec<f64> = options.iter().map(|o| o.weight_n(&station.down)).collect();
                    // The weights of all options of a link act along the same line, so one option gives the
                    // direction for all.
                    let weighing = options.iter().zip(&weights).find(|(_, w)| **w != 0.0);
                    unit.push(weighing.map_or(Wrench::zeros(), |(o, w)| o.weight / *w));
                    amount.push(weights);
                }
            }
        }
        let inertia = (0..unit.len()).map(|slot| inertias(station, slot, &amount)).collect();
        Self { case, unit, amount, inertia }
    }

    /// Least and greatest load among the remaining options of a slot (mass \[kg\] of a joint, weight \[N\] of a link, 1
    /// for a body).
    fn range(&self, parts: &Parts, slot: usize) -> [f64; 2] {
        let amounts = parts.alive[slot].iter().map(|&o| self.amount[slot][o as usize]);
        amounts.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], q| [low.min(q), high.max(q)])
    }

    fn end_load(&self, parts: &Parts, slot: usize, end: LoadEnd) -> f64 {
        self.range(parts, slot)[usize::from(end == LoadEnd::High)]
    }

    /// The wrench (force and moment) of everything outboard of `slot`, if all loads are at the end `end` of their
    /// intervals.
    fn wrench(&self, problem: &ArmProblem, parts: &Parts, slot: usize, end: LoadEnd) -> Wrench {
        let start = problem.stations()[self.case].start_wrench;
        (0..slot).fold(start, |sum, j| sum + self.unit[j] * self.end_load(parts, j, end))
    }

    fn joint<'p>(&self, problem: &'p ArmProblem, slot: usize) -> Option<&'p StationJoint> {
        match &problem.stations()[self.case].slots[slot] {
            StationSlot::Joint(joint) => Some(joint),
            _ => None,
        }
    }

    /// Least and greatest torque on the joint in `slot` \[N m\] over the remaining options outboard.
    fn torque_range(&self, problem: &ArmProblem, parts: &Parts, slot: usize) -> [f64; 2] {
        let Some(joint) = self.joint(problem, slot) else { return [0.0; 2] };
        let start = joint.twist.dot(&problem.stations()[self.case].start_wrench);
        (0..slot).fold([start; 2], |[low, high], j| {
            let per_unit = joint.twist.dot(&self.unit[j]);
            let ends = self.range(parts, j).map(|q| q * per_unit);
            [low + ends[0].min(ends[1]), high + ends[0].max(ends[1])]
        })
    }

    /// Least and greatest magnitude of the torque on the joint in `slot` \[N m\] over the remaining options outboard.
    pub(super) fn torque_size(&self, problem: &ArmProblem, parts: &Parts, slot: usize) -> [f64; 2] {
        let [low, high] = self.torque_range(problem, parts, slot);
        [low.max(-high).max(0.0), high.max(-low)]
    }

    /// Whether the torque of some joint may be positive with some of the remaining options and negative with others.
    pub(super) fn opposes(&self, problem: &ArmProblem, parts: &Parts) -> bool {
        (0..self.unit.len()).any(|slot| {
            let [low, high] = self.torque_range(problem, parts, slot);
            low < -1e-9 && high > 1e-9
        })
    }

    /// Least and greatest inertia, over the remaining options, of everything outboard of the joint in `slot` about the
    /// joint's axis \[kg m²\].
    pub(super) fn inertia_range(&self, problem: &ArmProblem, parts: &Parts, slot: usize) -> [f64; 2] {
        let Some(joint) = self.joint(problem, slot) else { return [0.0; 2] };
        let start = joint.twist.dot(&(problem.stations()[self.case].start_inertia * joint.twist));
        (0..slot).fold([start; 2], |[low, high], j| {
            let all = parts.alive[j].iter().map(|&o| self.inertia[slot][j][o as usize]);
            let [least, most] = all.fold([f64::INFINITY, 0.0], |[a, b]: [f64; 2], x| [a.min(x), b.max(x)]);
            [low + least, high + most]
        })
    }

    /// Greatest tangent stiffness \[N m/rad\] of each remaining option of every joint under the torques that are
    /// possible; by slot, then by option. Infinite for a rigid joint, empty for a slot that is not a joint.
    pub(super) fn stiffest(&self, problem: &ArmProblem, parts: &Parts) -> Vec<Vec<f64>> {
        let slots = problem.slots().iter().enumerate();
        slots
            .map(|(slot, piece)| {
                if self.joint(problem, slot).is_none() {
                    return Vec::new();
                }
                let torque = self.torque_range(problem, parts, slot);
                let stiffest = |&o: &u32| {
                    piece.law(o as usize).map_or(f64::INFINITY, |law| 1.0 / tangent_range(law, torque)[0])
                };
                parts.alive[slot].iter().map(stiffest).collect()
            })
            .collect()
    }

    /// Two inequalities that every design satisfies whose tip moves at most `limit_m` along `direction`. One is exact
    /// where all loads are least, the other is exact where all loads are greatest.
    pub(super) fn deflection_rows(
        &self,
        problem: &ArmProblem,
        parts: &Parts,
        direction: &Vector3<f64>,
        limit_m: f64,
    ) -> [Row; 2] {
        [LoadEnd::Low, LoadEnd::High].map(|end| {
            let mut coefficients = parts.each(|_, _| 0.0);
            for slot in 0..self.unit.len() {
                let Some(term) = self.term(problem, parts, slot, direction, end) else { continue };
                add(&mut coefficients[slot], &term.at_end);
                for (outboard, slope) in term.slopes.iter().enumerate() {
                    let from = self.end_load(parts, outboard, end);
                    let amounts = parts.alive[outboard].iter().map(|&o| self.amount[outboard][o as usize]);
                    let added: Vec<f64> = amounts.map(|q| slope * (q - from)).collect();
                    add(&mut coefficients[outboard], &added);
                }
            }
            Row { coefficients, limit: limit_m }.ready()
        })
    }

    /// The linear lower bound of the tip deflection along `direction` that one slot causes. It is exact if all loads
    /// are at the end `end` of their intervals. `None` for a body, which does not deform.
    fn term(
        &self,
        problem: &ArmProblem,
        parts: &Parts,
        slot: usize,
        direction: &Vector3<f64>,
        end: LoadEnd,
    ) -> Option<Term> {
        let wrench = self.wrench(problem, parts, slot, end);
        // From the low end the loads can only grow, from the high end only decrease.
        let least = |a: f64, b: f64| if end == LoadEnd::Low { a.min(b) } else { a.max(b) };
        match &problem.stations()[self.case].slots[slot] {
            StationSlot::Joint(joint) => {
                let lever = direction.dot(&joint.tip_m_per_rad);
                let torque = self.torque_range(problem, parts, slot);
                let piece = &problem.slots()[slot];
                let laws: Vec<&JointLaw> =
                    parts.alive[slot].iter().filter_map(|&o| piece.law(o as usize)).collect();
                let at = joint.twist.dot(&wrench);
                let [flattest, steepest] = laws
                    .iter()
                    .map(|law| rising_range(law, torque))
                    .fold([f64::INFINITY, f64::NEG_INFINITY], |[flat, steep]: [f64; 2], [low, high]| {
                        [flat.min(low), steep.max(high)]
                    });
                let slope = |j: usize| {
                    let per_unit = lever * joint.twist.dot(&self.unit[j]);
                    least(per_unit * flattest, per_unit * steepest)
                };
                Some(Term {
                    at_end: laws.iter().map(|law| lever * law.rising_angle_rad(at)).collect(),
                    slopes: (0..slot).map(slope).collect(),
                })
            }
            StationSlot::Link { options, .. } => {
                let left: Vec<_> = parts.alive[slot].iter().map(|&o| &options[o as usize]).collect();
                let arms: Vec<Wrench> = left.iter().map(|o| o.end * o.tip.tr_mul(direction)).collect();
                let sags = left.iter().map(|o| direction.dot(&(o.tip * o.own_weight_end)));
                let slope = |j: usize| {
                    arms.iter().map(|arm| arm.dot(&self.unit[j])).reduce(least).unwrap_or_default()
                };
                Some(Term {
                    at_end: arms.iter().zip(sags).map(|(arm, sag)| arm.dot(&wrench) + sag).collect(),
                    slopes: (0..slot).map(slope).collect(),
                })
            }
            StationSlot::Body { .. } => None,
        }
    }

    /// Inequalities that every design satisfies whose sized joints can take their static, peak and emergency torque in
    /// this case. The heat of a motor is not a sum over the parts, so there is no row for it; this only weakens the
    /// bound.
    pub(super) fn torque_rows(&self, problem: &ArmProblem, parts: &Parts) -> Vec<Row> {
        let mut rows = Vec::new();
        for (slot, piece) in problem.slots().iter().enumerate() {
            let (Slot::Sized(sized), Some(joint)) = (piece, self.joint(problem, slot)) else { continue };
            let motion = sized.table.motion();
            let [low, high] = self.torque_range(problem, parts, slot);
            // The rows limit the torque in the direction in which it can be larger. The other direction is not
            // used, which only weakens the bound.
            let sign = if high >= -low { 1.0 } else { -1.0 };
            let ramp = |factor: f64| match motion.linear_reading {
                LinearReading::Exact => [1.0, factor * motion.acceleration_rad_s2],
                LinearReading::Paper => [1.0 + factor * motion.acceleration_over_gravity, 0.0],
            };
            let limits = |o: u32| sized.table.limits(o as usize);
            let demands: [([f64; 2], Vec<f64>); 3] = [
                ([1.0, 0.0], parts.alive[slot].iter().map(|&o| limits(o).static_torque_nm).collect()),
                (ramp(1.0), parts.alive[slot].iter().map(|&o| limits(o).peak_torque_nm).collect()),
                (
                    ramp(motion.stop.factor),
                    parts.alive[slot].iter().map(|&o| limits(o).stop_torque_nm).collect(),
                ),
            ];
            for ([torque, inertia], allowed) in demands {
                // With a brake the static torque has no limit, so it gives no row.
                if allowed.iter().any(|nm| nm.is_infinite()) {
                    continue;
                }
                let station = &problem.stations()[self.case];
                let own = |wrench: &Wrench| sign * torque * joint.twist.dot(wrench);
                let mut coefficients = parts.each(|j, o| match j < slot {
                    false => 0.0,
                    true => {
                        own(&self.unit[j]) * self.amount[j][o as usize]
                            + if inertia == 0.0 { 0.0 } else { inertia * self.inertia[slot][j][o as usize] }
                    }
                });
                coefficients[slot] = allowed.iter().map(|x| -x).collect();
                let start = own(&station.start_wrench)
                    + inertia * joint.twist.dot(&(station.start_inertia * joint.twist));
                let row = Row { coefficients, limit: -start };
                if row.can_bind() {
                    rows.push(row.ready());
                }
            }
        }
        rows
    }
}

/// Inertia about the axis of the joint in `slot` \[kg m²\] of every option of every slot outboard of it; first index
/// the outboard slot, second its option. `amount` has the load of each option, which is the mass for a joint. Empty if
/// `slot` has no joint.
fn inertias(station: &Station, slot: usize, amount: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let StationSlot::Joint(StationJoint { twist, .. }) = &station.slots[slot] else { return Vec::new() };
    let about = |inertia: &Matrix6<f64>| twist.dot(&(inertia * twist));
    let outboard = station.slots[..slot].iter().zip(amount);
    outboard
        .map(|(placed, amount)| match placed {
            StationSlot::Joint(joint) => {
                let per_kg = about(&joint.inertia_per_kg);
                amount.iter().map(|kg| kg * per_kg).collect()
            }
            StationSlot::Body { inertia, .. } => vec![about(inertia)],
            StationSlot::Link { options, .. } => options.iter().map(|o| about(&o.inertia)).collect(),
        })
        .collect()
}

fn add(to: &mut [f64], what: &[f64]) {
    to.iter_mut().zip(what).for_each(|(a, b)| *a += b);
}
