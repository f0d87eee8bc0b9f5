//! The torques that a drive must hold, and the loads on its output bearing.

use super::bearing::BearingDemand;
use super::fit::Widths;
use super::heat::HeatDemand;

/// A torque on the output side of a gear that a drive must hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    /// While standing in the worst pose (Eq 7) \[N m\].
    Static,
    /// While accelerating (Eqs 7, 8) \[N m\].
    Peak,
    /// In an emergency stop \[N m\].
    Stop,
    /// Cube of the cubic mean over the duty cycle \[(N m)³\]. Cubes are compared, so that no root has to be taken.
    MeanCubed,
}

/// Number of quantities.
pub(super) const QUANTITIES: usize = 4;

/// What a drive must hold: a torque for each [`Quantity`], the loads on its output bearing, and the heat of its motor over
/// the cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Demand {
    pub torques: [f64; QUANTITIES],
    pub bearing: BearingDemand,
    pub heat: HeatDemand,
    /// The room that the link leaves.
    pub room: Widths,
}
