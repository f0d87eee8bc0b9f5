//! The torques that a drive must provide, and the loads on its output bearing.

use super::bearing::BearingDemand;
use super::fit::Widths;
use super::heat::HeatDemand;

/// The four torques, taken on the output side of the gear, that are compared with ratings of the drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    /// Torque at rest in the worst pose (Eq 7 of docs/model.md) \[N m\].
    Static,
    /// Torque during acceleration (Eqs 7 and 8 of docs/model.md) \[N m\].
    Peak,
    /// Torque in an emergency stop \[N m\].
    Stop,
    /// Cube of the cubic mean torque over the duty cycle \[(N m)³\]. Cubes are compared, so that no root has to be
    /// taken.
    MeanCubed,
}

/// Number of torque quantities.
pub(super) const QUANTITIES: usize = 4;

/// The demand on one drive: a torque for each [`Quantity`], the loads on the output bearing, and the heat of the
/// motor over the cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Demand {
    pub torques: [f64; QUANTITIES],
    pub bearing: BearingDemand,
    pub heat: HeatDemand,
    /// The largest widths of gear and motor that the link leaves room for \[m\].
    pub room: Widths,
}
