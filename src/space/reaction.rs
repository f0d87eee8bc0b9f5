//! What a joint that stands still must hold while another joint ramps or stops.
//!
//! The couplings are the entries of the arm's mass matrix: `M_ij` is the inertia between the motions of the joints i
//! and j. While joint j accelerates by `α_j` and all others stand still, the drive of joint i must hold `M_ij α_j` in
//! in addition to its static torque. Drives are sized for the acceleration of their own joint
//! ([`demand`](crate::sizing::demand)), because the vendors' procedures size one axis at a time. The torque due to
//! another joint is therefore not part of the demand.

use super::bearing_loads::Mover;
use super::problem::ArmProblem;
use super::station::{StationJoint, StationSlot};

/// The largest torque that a joint must hold while another joint moves. For a prismatic joint it is the largest force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reaction {
    /// Piece of the joint that stands still, counted from the base.
    pub piece: usize,
    /// Piece of the joint whose ramp (acceleration in normal operation) gives the largest torque in a ramp.
    pub ramps: usize,
    /// Piece of the joint whose emergency stop gives the largest torque in a stop.
    pub stops: usize,
    /// Static torque plus the torque due to the other joint's ramp \[N m\]. For a prismatic joint, these are forces
    /// \[N\].
    pub in_ramp_nm: f64,
    /// Static torque plus the torque due to the other joint's emergency stop \[N m\]. For a prismatic joint, these are
    /// forces \[N\].
    pub in_stop_nm: f64,
}

impl ArmProblem<'_> {
    /// The largest torque that each driven joint of a design must hold while another joint moves, over the sizing
    /// cases; tip first. `options` are the options of the design, one for each level, tip first. `None` if the design
    /// breaks a limit.
    pub(crate) fn reactions(&self, options: &[u32]) -> Option<Vec<Reaction>> {
        let movers = &self.bearing_loads().movers;
        let cases = &self.space().sizing_cases;
        let mut static_nm = vec![vec![0.0; cases.len()]; movers.len()];
        let mut inertia_kgm2 = vec![vec![vec![0.0; cases.len()]; movers.len()]; movers.len()];
        self.walk(options, |slot, partial| {
            let Some(here) = movers.iter().position(|mover| mover.slot == slot) else { return };
            for (at, &case) in cases.iter().enumerate() {
                let (Some(joint), state) = (self.posed_joint(case, slot), &partial.stations[case]) else {
                    continue;
                };
                static_nm[here][at] = state.torque_nm(joint).abs();
                for (other, mover) in movers.iter().enumerate().skip(here + 1) {
                    let Some(moving) = self.posed_joint(case, mover.slot) else { continue };
                    let coupling_kgm2 = state.inertia_between(slot, joint, moving).abs();
                    inertia_kgm2[here][other][at] = coupling_kgm2;
                    inertia_kgm2[other][here][at] = coupling_kgm2;
                }
            }
        })
        .ok()?;
        let largest = |here: usize| {
            // The largest torque that joint `here` holds if accelerations are `times` as large as in ramps, with the
            // piece of the joint that moves.
            let with_mover = |times: fn(&Mover) -> f64| {
                let held = |other: usize| {
                    let acceleration = times(&movers[other]) * movers[other].acceleration_rad_s2;
                    let held_nm =
                        |at: usize| static_nm[here][at] + inertia_kgm2[here][other][at] * acceleration;
                    (0..cases.len()).map(held_nm).fold(0.0, f64::max)
                };
                let others = (0..movers.len()).filter(|other| *other != here);
                let all = others.map(|other| (held(other), self.piece_of_slot(movers[other].slot)));
                all.max_by(|a, b| a.0.total_cmp(&b.0))
            };
            let ((in_ramp_nm, ramps), (in_stop_nm, stops)) =
                (with_mover(|_| 1.0)?, with_mover(|mover| mover.stop_factor)?);
            Some(Reaction {
                piece: self.piece_of_slot(movers[here].slot),
                ramps,
                stops,
                in_ramp_nm,
                in_stop_nm,
            })
        };
        Some((0..movers.len()).filter_map(largest).collect())
    }

    fn posed_joint(&self, case: usize, slot: usize) -> Option<&StationJoint> {
        match &self.stations()[case].slots[slot] {
            StationSlot::Joint(joint) => Some(joint),
            _ => None,
        }
    }
}
