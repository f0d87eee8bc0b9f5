//! Records against time: angles on both sides of each gear and the motor's torque. Robots with a second encoder at the
//! output of each gear write them.
//!
//! - [`spec`] reads what `campaign.json` says of records, and [`reading`] reads the records.
//! - `smooth` computes slopes and curvatures. `signals` gathers the rows of one joint and divides them into blocks of
//!   time, and `known` says at which rows torque and friction are known. `wave` removes a transmission error within a turn of the motor before signals are differentiated.
//! - `blocks` fits columns to rows, with intervals and held-out errors by blocks.
//! - `twist` chooses the terms of the twist, `friction` balances the torques, `curve` looks for torsion laws beyond a
//!   single compliance, and `ringing` for free vibration.
//! - `judge` says of each effect whether it is found, `compliance` of the compliance, by their `intervals`. [`finding`]
//!   defines the results.
//! - `outcome` reaches the verdict, and `report` writes it in words and pictures.

pub(crate) mod blocks;
pub(crate) mod compliance;
pub(crate) mod curve;
pub mod finding;
pub(crate) mod friction;
pub(crate) mod intervals;
pub(crate) mod judge;
pub(crate) mod known;
pub(crate) mod other_cause;
pub(crate) mod outcome;
pub mod reading;
pub(crate) mod report;
pub(crate) mod ringing;
pub(crate) mod signals;
pub(crate) mod smooth;
pub mod spec;
pub(crate) mod twist;
pub(crate) mod wave;
