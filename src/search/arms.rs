//! Eight arms side by side, as pieces are added from the row level to the base.

use super::row::hinge_numbers;
use crate::mechanics::lanes::{Eight, LANES};
use crate::pareto::objectives::Objectives;
use crate::space::problem::ArmProblem;

/// Eight arms as they grow inward.
///
/// Eight numbers that are loaded together must also be stored together. Partial stores would defeat store-to-load
/// forwarding: the processor would wait until they have reached the cache.
pub(crate) struct EightArms {
    /// One bit for each arm that holds so far.
    pub held: u8,
    /// If none holds: how many of the drives chosen inboard of the row level were added before that showed.
    pub failed_with: usize,
    pub mass_kg: Eight,
    /// Mass of the drive in each inner slot. The masses of given drives are set from the beginning.
    pub masses_kg: Vec<Eight>,
    /// Largest part of Dunkerley's sums that a single joint adds \[s²\]. The lowest eigenvalue is at most its reciprocal.
    pub largest_s2: Eight,
    pub cases: Vec<CaseArms>,
    /// Objectives of the finished arms.
    pub tip_deflection_m: Eight,
    pub lowest_mode_hz: Eight,
}

/// Eight arms in one case.
#[derive(Clone)]
pub(crate) struct CaseArms {
    pub tip_m: [Eight; 3],
    /// Torque \[N m\] on each hinge that some load turns, and outboard inertia \[kg m²\] about it.
    pub torque_at: Vec<Eight>,
    pub inertia_at: Vec<Eight>,
    /// Tangent compliance of each inner joint \[rad/(N m)\].
    pub compliance: Vec<Eight>,
    /// Dunkerley's sum of each block \[s²\].
    pub trace_s2: [Eight; 2],
}

impl EightArms {
    /// Working space for eight arms of a problem.
    pub(crate) fn new(problem: &ArmProblem) -> Self {
        let zeros = [0.0; LANES];
        let inner = &problem.slots()[problem.row_slot().unwrap_or(0)..];
        let numbers = hinge_numbers(inner);
        let nothing = CaseArms {
            tip_m: [zeros; 3],
            torque_at: vec![zeros; numbers],
            inertia_at: vec![zeros; numbers],
            compliance: vec![zeros; inner.len()],
            trace_s2: [zeros; 2],
        };
        Self {
            held: 0,
            failed_with: 0,
            mass_kg: zeros,
            masses_kg: inner.iter().map(|slot| [slot.fixed_kg().unwrap_or(0.0); LANES]).collect(),
            largest_s2: zeros,
            cases: vec![nothing; problem.stations().len()],
            tip_deflection_m: zeros,
            lowest_mode_hz: zeros,
        }
    }

    /// Objectives of one of the eight.
    pub(crate) fn objectives(&self, lane: usize) -> Objectives {
        Objectives {
            tip_deflection_m: self.tip_deflection_m[lane],
            mass_kg: self.mass_kg[lane],
            lowest_mode_hz: self.lowest_mode_hz[lane],
        }
    }
}
