//! Fits a model to readings: its most probable parameters, their intervals, the noise of the readings, and
//! the prediction of held-out poses.

pub(crate) mod curve_interval;
pub mod descent;
pub(crate) mod held_out;
pub(crate) mod interval;
pub(crate) mod load_units;
pub mod noise;
pub mod normal;
pub(crate) mod stats;
pub(crate) mod steps;
pub(crate) mod units;
pub mod weights;
