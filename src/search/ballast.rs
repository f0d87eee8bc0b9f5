//! Ballast: parts that a design has only for their weight.
//!
//! The torsion curve of a gear becomes steeper with torque. Weight outboard loads the gear past a break point of its
//! curve. Its tangent stiffness then rises, and the lowest mode with it. A design can be on a front for that reason alone.
//!
//! The sign of ballast is this: with a lighter part that is at least as stiff in every way, the design would weigh less
//! and deflect no more. Only its lowest mode would fall, because a gear inboard would get into a softer segment, or
//! because the play of a joint would open.

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

/// Relative difference below which two objectives count as equal.
const ROUNDING: f64 = 1e-9;

/// A part that a design has for its weight.
#[derive(Debug, Clone, PartialEq)]
pub struct Ballast {
    /// Number of the part's piece, base to tip.
    pub piece: usize,
    /// Number of the design with a lighter part in its place.
    pub lighter: u128,
    /// Number of the joint's piece (base to tip) that is softer in the lighter design.
    pub pressed: usize,
    /// Whether the gear of this joint gets into a softer segment; if not, the play of the joint opens.
    pub by_segment: bool,
    /// The case in which this happens.
    pub case: usize,
}

/// A joint that becomes softer when the torque on it falls.
struct Relieved {
    slot: usize,
    case: usize,
    by_segment: bool,
}

/// The design that is examined.
struct Weighed<'p, 'c> {
    problem: &'p ArmProblem<'c>,
    options: Vec<u32>,
    arm: Partial,
    objectives: Objectives,
    /// Torque on every joint \[N m\], by slot and case.
    torques_nm: Vec<Vec<f64>>,
}

impl ArmProblem<'_> {
    /// The ballast of a design, if it has any. Of several parts it is the one whose replacement gives the lightest design.
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

    /// Replacements for the part of one level that show this part to be ballast, each with the mass of its design \[kg\].
    fn at(&self, level: usize) -> Vec<(f64, Ballast)> {
        let slot = self.problem.level_slots()[level];
        let now = self.options[level];
        let size = self.problem.level_sizes()[level];
        let better =
            (0..size).filter(|&option| option != now && self.lighter_and_as_stiff(slot, option, now));
        better.filter_map(|option| self.without_weight(level, slot, option)).collect()
    }

    /// Whether an option weighs less than the present one and is at least as stiff in every way.
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

    /// The design with a lighter part, with its mass \[kg\], if only its lowest mode is worse and a softer joint inboard
    /// is the reason.
    fn without_weight(&self, level: usize, slot: usize, option: u32) -> Option<(f64, Ballast)> {
        let relieved = self.relieved(slot, option)?;
        let mut options = self.options.clone();
        options[level] = option;
        let lighter = self.problem.walk(&options, |_, _| {}).ok()?;
        // less weight outboard may let first fit choose another drive inboard; then the part alone is not the reason
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

    /// The first joint inboard, with its case, that becomes softer when the weight of a part changes.
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
            // the curve without effects tells a segment from play
            let softer = |of: &dyn Fn(f64) -> f64| of(then) > of(now);
            let by_segment = softer(&|t| law.curve.tangent_compliance_rad_per_nm(t));
            let is_softer = by_segment || softer(&|t| law.tangent_compliance_rad_per_nm(t));
            is_softer.then_some(Relieved { slot: joint, case, by_segment })
        })
    }

    /// Law of a joint in this design.
    fn law(&self, slot: usize) -> Option<&JointLaw> {
        self.problem.slots()[slot].law(self.arm.options[slot] as usize)
    }

    /// Change of weight if another option is taken, as a wrench.
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

    /// Whether the lighter design would have as high a lowest mode if no joint inboard had become softer.
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
