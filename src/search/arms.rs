//! Eight arms side by side as they grow inward.

use crate::mechanics::lanes::{Eight, LANES};
use crate::pareto::objectives::Objectives;
use crate::space::problem::ArmProblem;

/// Most pieces from the innermost level to the base that a row handles; beyond, designs are finished
/// one by one.
pub(crate) const MOST_SLOTS: usize = 12;

/// Eight arms as they grow inward. What is loaded as eight numbers must be stored as eight: a processor waits where it
/// finds parts of them on the way to memory.
pub(crate) struct EightArms {
    /// Bits of those that hold so far.
    pub held: u8,
    pub mass_kg: Eight,
    /// Mass of the drive in each inner slot; those of given drives stand from the beginning.
    pub masses_kg: [Eight; MOST_SLOTS],
    /// The largest of what single joints add to Dunkerley's sums: no lowest eigenvalue is above one over that.
    pub largest_s2: Eight,
    pub cases: Vec<CaseArms>,
    /// What they come to, once finished.
    pub tip_deflection_m: Eight,
    pub lowest_mode_hz: Eight,
}

/// Eight arms in one case.
#[derive(Clone)]
pub(crate) struct CaseArms {
    pub tip_m: [Eight; 3],
    /// Torque on each inner joint that is turned, and inertia about it.
    pub torque_at: [Eight; MOST_SLOTS],
    pub inertia_at: [Eight; MOST_SLOTS],
    pub compliance: [Eight; MOST_SLOTS],
    /// Dunkerley's sum of each block.
    pub trace_s2: [Eight; 2],
}

impl EightArms {
    /// Room for eight arms.
    pub fn new(problem: &ArmProblem) -> Self {
        let zeros = [0.0; LANES];
        let nothing = CaseArms {
            tip_m: [zeros; 3],
            torque_at: [zeros; MOST_SLOTS],
            inertia_at: [zeros; MOST_SLOTS],
            compliance: [zeros; MOST_SLOTS],
            trace_s2: [zeros; 2],
        };
        let inner = &problem.slots()[problem.level_slots().last().copied().unwrap_or(0)..];
        let mut masses_kg = [zeros; MOST_SLOTS];
        for (mass_kg, slot) in masses_kg.iter_mut().zip(inner) {
            *mass_kg = [slot.fixed_kg().unwrap_or(0.0); LANES];
        }
        Self {
            held: 0,
            mass_kg: zeros,
            masses_kg,
            largest_s2: zeros,
            cases: vec![nothing; problem.stations().len()],
            tip_deflection_m: zeros,
            lowest_mode_hz: zeros,
        }
    }

    /// Objectives of one of the eight.
    pub fn objectives(&self, lane: usize) -> Objectives {
        Objectives {
            tip_deflection_m: self.tip_deflection_m[lane],
            mass_kg: self.mass_kg[lane],
            lowest_mode_hz: self.lowest_mode_hz[lane],
        }
    }
}
