//! What is fitted: calibrated parameters, candidate effects and their expected sizes. Also the prediction of
//! readings by mechanics directly.

pub mod candidates;
pub mod estimate;
pub mod exact;
pub mod expected;
pub mod parameters;
