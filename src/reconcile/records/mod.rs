//! Records against time: angles on both sides of each gear and the motor's torque, as every robot with a second encoder
//! writes them.
//!
//! - [`spec`] reads what `campaign.json` says of records, and [`reading`] reads them.
//! - `smooth` gives slopes and curvatures; `signals` gathers the rows of one joint and cuts them into blocks of time.
//!   `wave` takes an error within a turn of the motor from what is differentiated.
//! - `blocks` fits columns to rows, with intervals and held-out errors by blocks.
//! - `twist` says which columns the twist needs, `friction` balances the torques, `curve` looks for laws beyond a single
//!   compliance, and `ringing` for free swings.
//! - `judge` says of each thing whether it is found; [`finding`] holds that.
//! - `outcome` draws the conclusion, and `report` writes it in words and pictures.

pub(crate) mod blocks;
pub(crate) mod curve;
pub mod finding;
pub(crate) mod friction;
pub(crate) mod judge;
pub(crate) mod outcome;
pub mod reading;
pub(crate) mod report;
pub(crate) mod ringing;
pub(crate) mod signals;
pub(crate) mod smooth;
pub mod spec;
pub(crate) mod twist;
pub(crate) mod wave;
