//! The torques that a drive must hold.

use super::heat::HeatDemand;

/// A torque on the output side that a drive must hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    /// While standing in the worst pose (Eq 7) \[N m\].
    Static,
    /// While accelerating (Eqs 7, 8) \[N m\].
    Peak,
    /// In an emergency stop \[N m\].
    Stop,
    /// Cube of the cubic mean over the duty cycle \[(N m)³\]: a cube root is not needed to compare.
    MeanCubed,
}

/// Number of quantities.
pub(super) const QUANTITIES: usize = 4;

/// What is asked for of each quantity, and of the motor over the cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Demand {
    pub torques: [f64; QUANTITIES],
    pub heat: HeatDemand,
}
