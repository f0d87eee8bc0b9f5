//! Fitting a model to readings: the most probable parameters, their intervals, the noise, and what held-out poses say.

pub mod curve_interval;
pub mod descent;
pub mod interval;
pub mod kept_out;
pub mod noise;
pub mod stats;
pub mod units;
