//! Ballast: parts that a design has only for their weight.
//!
//! A gear becomes stiffer with torque: K1, K2 and K3 grow along its torsion curve. Weight outboard may load the gear
//! past a break point of this curve. Its tangent stiffness then rises, and the lowest mode with it. A design can be on
//! a front for that reason alone.
//!
//! A part is reported as ballast if a lighter part that is at least as stiff in every way exists for its place, and if
//! two more conditions hold. First, the design with this lighter part weighs less and deflects no more, so that only
//! its lowest mode is lower. Second, the mode is lower because a joint inboard becomes softer under the smaller torque:
//! its gear gets into a softer segment of the torsion curve, or its play (lost motion) is less closed.

use crate::arm::joint_law::{Curve, JointLaw};
use crate::mechanics::Wrench;
use crate::mechanics::beam::line_stiffnesses;
use crate::pareto::objectives::Objectives;
use crate::space::design::{number, options};
use crate::space::design_space::SpacePiece;
use crate::space::levels::OutwardIn;
use crate::space::problem::{ArmProblem, Partial};
use crate::space::slot::Slot;
use crate::space::state::StationState;
use crate::space::station::{Station, StationSlot};

/// Relative difference up to which two values of an objective count as equal, since both come from rounded
/// arithmetic.
const ROUNDING: f64 = 1e-9;

/// A part that a design has only for its weight, with the lighter design that shows it.
#[derive(Debug, Clone, PartialEq)]
pub struct Ballast {
    /// Number of the piece that is ballast, counted from the base to the tip.
    pub piece: usize,
    /// Number of the design that has a lighter part in this place.
    pub lighter: u128,
    /// Number of the piece (base to tip) of the joint that is softer in the lighter design, because less weight loads
    /// it.
    pub pressed: usize,
    /// `true` if the gear of this joint gets into a softer segment of its torsion curve; `false` if the play of the
    /// joint opens.
    pub by_segment: bool,
    /// Number of the case in which the joint becomes softer.
    pub case: usize,
}

/// A joint that becomes softer when less weight loads it, and the case in which this happens.
struct Relieved {
    slot: usize,
    case: usize,
    by_segment: bool,
}

/// The design that is searched for ballast, with the numbers with which lighter designs are compared.
struct Weighed<'p, 'c> {
    problem: &'p ArmProblem<'c>,
    options: Vec<u32>,
    arm: Partial,
    objectives: Objectives,
    /// Torque on every joint of the design \[N m\]; first index the slot, second the case. A slot is a
    /// piece of the arm, tip first. The torque is 0 for slots that are not joints.
    torques_nm: Vec<Vec<f64>>,
}

impl ArmProblem<'_> {
    /// The ballast of a design; `None` if it has none or if no design has this number. If several parts are ballast,
    /// the result is the part whose replacement gives the lightest design.
    pub fn ballast(&self, design: u128) -> Option<Ballast> {
        let weighed = Weighed::new(self, options(self.level_sizes(), design)?)?;
        let found = (0..weighed.options.len()).flat_map(|level| weighed.at(level));
        found
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.lighter.cmp(&b.1.lighter)))
            .map(|(_, ballast)| ballast)
    }
}

impl<'p, 'c> Weighed<'p, 'c> {
    fn new(problem: &'p ArmProblem<'c>, options: Vec<u32>) -> Option<Self> {
        let mut torques_nm = vec![vec![0.0; problem.stations().len()]; problem.slots().len()];
        let torque = |station: &Station, slot: usize, state: &StationState| match &station.slots[slot] {
            StationSlot::Joint(joint) => state.torque_nm(joint),
            _ => 0.0,
        };
        let arm = problem
            .walk(&options, |slot, outboard| {
                for (case, state) in outboard.stations.iter().enumerate() {
                    torques_nm[slot][case] = torque(&problem.stations()[case], slot, state);
                }
            })
            .ok()?;
        let objectives = problem.objectives(&arm)?;
        Some(Self { problem, options, arm, objectives, torques_nm })
    }

    /// All lighter options for a level that show the present part of this level to be ballast. Each is returned with
    /// the mass of the design that has the option \[kg\].
    fn at(&self, level: usize) -> Vec<(f64, Ballast)> {
        let slot = self.problem.level_slots()[level];
        let now = self.options[level];
        let size = self.problem.level_sizes()[level];
        let better =
            (0..size).filter(|&option| option != now && self.lighter_and_as_stiff(slot, option, now));
        better.filter_map(|option| self.without_weight(level, slot, option)).collect()
    }

    /// Whether `option` weighs less than `now`, the present option of a slot, and is at least as stiff. A drive must be
    /// as stiff at every torque, a tube in every kind of deformation.
    fn lighter_and_as_stiff(&self, slot: usize, option: u32, now: u32) -> bool {
        match (&self.problem.slots()[slot], self.problem.piece_in_slot(slot)) {
            (Slot::Sized(sized), _) => {
                let mass_kg = |option: u32| sized.table.mass_kg(option as usize);
                let curve = |option: u32| sized.laws[option as usize].curve;
                mass_kg(option) < mass_kg(now) && never_softer(&curve(option), &curve(now))
            }
            (_, Some(SpacePiece::Choice(choice))) => {
                let [option, now] = [option, now].map(|o| &choice.options[o as usize]);
                let [own, present] = [option, now].map(|o| line_stiffnesses(&o.beam()));
                option.mass_kg_per_m() < now.mass_kg_per_m() && own.iter().zip(present).all(|(a, b)| *a >= b)
            }
            _ => false,
        }
    }

    /// Replaces the part in `slot` by the lighter `option`. The part is ballast if the lowest mode is the only
    /// objective that gets worse, and if the reason is that a joint inboard became softer. Then the finding is
    /// returned, with the mass of the lighter design \[kg\]. Otherwise `None`.
    fn without_weight(&self, level: usize, slot: usize, option: u32) -> Option<(f64, Ballast)> {
        let relieved = self.relieved(slot, option)?;
        let mut options = self.options.clone();
        options[level] = option;
        let lighter = self.problem.walk(&options, |_, _| {}).ok()?;
        // Less weight outboard may change the lightest drive that fits inboard. Then the exchanged part alone is not
        // the reason.
        let others_stay =
            (0..lighter.options.len()).all(|s| s == slot || lighter.options[s] == self.arm.options[s]);
        let o = self.problem.objectives(&lighter)?;
        let mode_alone_is_worse = o.mass_kg < self.objectives.mass_kg
            && o.tip_deflection_m <= self.objectives.tip_deflection_m * (1.0 + ROUNDING)
            && o.lowest_mode_hz < self.objectives.lowest_mode_hz * (1.0 - ROUNDING);
        let shows = others_stay && mode_alone_is_worse && self.joints_are_why(&lighter, slot);
        let piece = self.problem.piece_of_slot(slot);
        shows.then(|| {
            let lighter = number(self.problem.level_sizes(), &options);
            let Relieved { slot, case, by_segment } = relieved;
            let pressed = self.problem.piece_of_slot(slot);
            (o.mass_kg, Ballast { piece, lighter, pressed, by_segment, case })
        })
    }

    /// The first joint inboard of `slot` whose tangent compliance grows if the weight in this slot becomes the weight
    /// of `option`, with the case in which it grows. `None` if no joint becomes softer.
    fn relieved(&self, slot: usize, option: u32) -> Option<Relieved> {
        let cases = &self.problem.space().judged_cases;
        let inboard = slot + 1..self.problem.slots().len();
        inboard.flat_map(|joint| cases.iter().map(move |&case| (joint, case))).find_map(|(joint, case)| {
            let station = &self.problem.stations()[case];
            let (StationSlot::Joint(place), Some(law)) = (&station.slots[joint], self.law(joint)) else {
                return None;
            };
            let torque_nm = self.torques_nm[joint][case];
            let change_nm = place.twist.dot(&self.change_of_weight(station, slot, option));
            let [now, then] = [torque_nm, torque_nm + change_nm];
            // If the curve without play and friction becomes softer, the gear gets into a softer segment. Otherwise the
            // play opens.
            let softer = |of: &dyn Fn(f64) -> f64| of(then) > of(now);
            let by_segment = softer(&|t| law.curve.tangent_compliance_rad_per_nm(t));
            let is_softer = by_segment || softer(&|t| law.tangent_compliance_rad_per_nm(t));
            is_softer.then_some(Relieved { slot: joint, case, by_segment })
        })
    }

    /// The joint law (angle as a function of torque) of the joint in a slot, with the drive of this design. `None` if
    /// the slot has no joint.
    fn law(&self, slot: usize) -> Option<&JointLaw> {
        self.problem.slots()[slot].law(self.arm.options[slot] as usize)
    }

    /// Change of the wrench of the weight in `slot`, about the world's origin, if the slot takes `option` in place of
    /// its present option.
    fn change_of_weight(&self, station: &Station, slot: usize, option: u32) -> Wrench {
        let now = self.arm.options[slot] as usize;
        match (&station.slots[slot], &self.problem.slots()[slot]) {
            (StationSlot::Joint(joint), Slot::Sized(sized)) => {
                joint.weight_per_kg * (sized.table.mass_kg(option as usize) - sized.table.mass_kg(now))
            }
            (StationSlot::Link { options, .. }, _) => options[option as usize].weight - options[now].weight,
            _ => Wrench::zeros(),
        }
    }

    /// Whether the lighter design would have as high a lowest mode as the present design if no joint inboard had become
    /// softer. Then these joints are the reason for the lower mode.
    fn joints_are_why(&self, lighter: &Partial, slot: usize) -> bool {
        let mut held = lighter.clone();
        for (state, before) in held.stations.iter_mut().zip(&self.arm.stations) {
            for inboard in slot + 1..before.compliances.len() {
                state.compliances[inboard] = state.compliances[inboard].min(before.compliances[inboard]);
            }
        }
        let held = self.problem.objectives(&held);
        held.is_some_and(|o| o.lowest_mode_hz >= self.objectives.lowest_mode_hz * (1.0 - ROUNDING))
    }
}

/// Whether curve `a` is at least as stiff as curve `b` at every torque.
fn never_softer(a: &Curve, b: &Curve) -> bool {
    match (a.as_windup(), b.as_windup()) {
        (None, _) => true,
        (Some(_), None) => false,
        (Some(a), Some(b)) => a.never_softer(&b, f64::INFINITY),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::joint_law::Windup;

    #[test]
    fn a_curve_that_bends_later_is_softer_in_between_though_its_slopes_are_the_same() {
        let curve = |t1_nm: f64| {
            let (k1_nm_per_rad, k2_nm_per_rad, k3_nm_per_rad) = (1e4, 2e4, 3e4);
            Curve::Windup(Windup { k1_nm_per_rad, k2_nm_per_rad, k3_nm_per_rad, t1_nm, t2_nm: 100.0 })
        };
        assert!(never_softer(&curve(10.0), &curve(20.0)));
        assert!(!never_softer(&curve(20.0), &curve(10.0)));
        assert!(never_softer(&curve(10.0), &curve(10.0)));
        assert!(!never_softer(&Curve::Linear(2.5e4), &curve(10.0)), "softer beyond 100 N m");
        assert!(never_softer(&Curve::Rigid, &curve(10.0)));
    }
}
