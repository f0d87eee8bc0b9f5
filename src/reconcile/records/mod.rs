//! Records against time: tables of the angles on both sides of each gear and of the motor's torque, with one row for
//! each time. Robots with a second encoder at the output of each gear write such records.
//!
//! - [`readings::record`](super::readings::record) reads the rows of the files.
//! - `smooth` computes slopes and curvatures of a signal. `signals` gathers the rows of one joint and divides them into
//!   blocks of time. `known` says at which rows torque and friction are known. `wave` removes a transmission error
//!   within a turn of the motor before the signals are differentiated.
//! - `blocks` fits a linear model by least squares. It also gives 95 % intervals, and errors on blocks of time that
//!   were left out of a fit (held-out blocks).
//! - `twist` chooses the terms of the model of the twist, `friction` balances the torques, and `curve` looks for
//!   torsion laws beyond a single compliance.
//! - `other_cause` looks for causes of an error of the angles that are no effect of the library. `ringing` looks for
//!   free vibration.
//! - `compliance` says whether the compliance of a joint is found, and `judge` says the same of every other effect.
//!   Both use `intervals`.
//! - `outcome` reaches the verdict of the campaign. [`joint_record`](super::verdict::joint_record) defines the result
//!   for one joint.

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
