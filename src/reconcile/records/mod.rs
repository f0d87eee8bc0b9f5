//! Records against time: angles on both sides of each gear and the motor's torque. Robots with a second encoder at the
//! output of each gear write them.
//!
//! - The rows come from [`readings::record`](super::readings::record).
//! - `smooth` computes slopes and curvatures. `signals` gathers the rows of one joint and divides them into blocks of
//!   time, and `known` says at which rows torque and friction are known. `wave` removes a transmission error within a turn
//!   of the motor before signals are differentiated.
//! - `blocks` fits columns to rows, with intervals and held-out errors by blocks.
//! - `twist` chooses the terms of the twist, `friction` balances the torques, and `curve` looks for torsion laws beyond
//!   a single compliance.
//! - `other_cause` looks for causes that are no effect of the library, and `ringing` for free vibration.
//! - `judge` says of each effect whether it is found, and `compliance` says this of the compliance. Both use `intervals`.
//! - `outcome` reaches the verdict. [`joint_record`](super::verdict::joint_record) defines what it says of each joint.

pub(crate) mod blocks;
pub(crate) mod compliance;
pub(crate) mod curve;
pub(crate) mod friction;
pub(crate) mod intervals;
pub(crate) mod judge;
pub(crate) mod known;
pub(crate) mod other_cause;
pub(crate) mod outcome;
pub(crate) mod ringing;
pub(crate) mod signals;
pub(crate) mod smooth;
pub(crate) mod twist;
pub(crate) mod wave;
