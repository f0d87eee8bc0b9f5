//! Fits a model to readings: its most probable parameters, their intervals, the noise of the readings, and
//! the prediction of held-out poses.

pub mod curve_interval;
pub mod descent;
pub mod held_out;
pub mod interval;
pub mod noise;
pub mod stats;
pub mod units;
