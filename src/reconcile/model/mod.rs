//! What is fitted: calibrated numbers, candidate effects, how large an effect may be; and the readings predicted by mechanics directly.

pub mod candidates;
pub mod estimate;
pub mod exact;
pub mod expected;
pub mod parameters;
