//! The model that is fitted: calibrated parameters, candidate effects and their expected sizes. Also predicts readings
//! by direct mechanics, without prepared quantities.

pub mod calibration;
pub mod candidates;
pub mod direct;
pub(crate) mod estimate;
pub(crate) mod expected;
pub(crate) mod fitted_parameters;
pub mod parameters;
