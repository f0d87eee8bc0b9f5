//! Eight partial arms, whose numbers stand next to each other in memory, while slots (places of a part) are added from
//! the row level to the base.
//!
//! A row is the set of designs that differ in the choice of one part alone; this choice is the row level. A hinge is
//! one elastic coordinate: the rotation of a joint or of a bearing spring, or one motion of a given tube's end. A block
//! of the eigenvalue problem is a set of motions that do not couple with the other motions.

use super::row_case::hinge_numbers;
use crate::mechanics::lanes::{Eight, LANES};
use crate::pareto::objectives::Objectives;
use crate::space::problem::ArmProblem;

/// Eight partial arms, to which the inner slots (places of a part, from the row level to the base) are added one after
/// another.
///
/// Eight numbers that are loaded together must also be stored together. Partial stores would defeat store-to-load
/// forwarding: the processor would wait until they have reached the cache.
pub(crate) struct EightArms {
    /// Bit mask, one bit per arm: the arms that have met every limit checked so far.
    pub held: u8,
    /// Number of drives chosen by the search inboard of the row level that had been added when the last arm failed. The
    /// number has a meaning only if no arm is left in `held`. A row with the same arm outboard and the same drives up
    /// to this number fails too, so the sweep skips it.
    pub failed_with: usize,
    /// Mass of each arm, summed over the slots added so far \[kg\].
    pub mass_kg: Eight,
    /// Mass \[kg\] of the drive in each inner slot (the slots from the row level to the base). The masses of given
    /// drives are set from the beginning.
    pub masses_kg: Vec<Eight>,
    /// The largest term that a single joint or tube coordinate adds to a Dunkerley sum \[s²\]. Dunkerley's sum of a
    /// block is the sum of `1/λ` over the block's eigenvalues `λ`. The lowest eigenvalue is at most the reciprocal of
    /// this largest term.
    pub largest_s2: Eight,
    /// The numbers of the eight arms that differ from case to case.
    pub cases: Vec<CaseArms>,
    /// Tip deflection of the complete arms \[m\], the largest over the judged cases, which count for deflection and
    /// lowest mode.
    pub tip_deflection_m: Eight,
    /// Lowest mode of the complete arms \[Hz\].
    pub lowest_mode_hz: Eight,
}

/// Eight arms in one case (a pose with its loads): the numbers that change as slots are added.
#[derive(Clone)]
pub(crate) struct CaseArms {
    /// Displacement of the tip \[m\] in x, y and z, caused by the slots added so far.
    pub tip_m: [Eight; 3],
    /// Torque \[N m\] on each hinge; the index is the number of the hinge. It stays zero at hinges that no load turns.
    pub torque_at: Vec<Eight>,
    /// Inertia \[kg m²\] of everything outboard of each hinge, about the axis of this hinge.
    pub inertia_at: Vec<Eight>,
    /// Tangent compliance of the joint or bearing spring in each inner slot (the slots from the row level to the base)
    /// \[rad/(N m)\].
    pub compliance: Vec<Eight>,
    /// Dunkerley's sum of each block of the eigenvalue problem \[s²\]: the sum of `1/λ` over its eigenvalues. A planar
    /// pose has two blocks, a spatial pose only one.
    pub trace_s2: [Eight; 2],
}

impl EightArms {
    /// Allocates memory for eight arms of a problem. All numbers are zero, except for the masses of given drives.
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

    /// Objectives of the complete arm in one lane (0 to 7).
    pub(crate) fn objectives(&self, lane: usize) -> Objectives {
        Objectives {
            tip_deflection_m: self.tip_deflection_m[lane],
            mass_kg: self.mass_kg[lane],
            lowest_mode_hz: self.lowest_mode_hz[lane],
        }
    }
}
