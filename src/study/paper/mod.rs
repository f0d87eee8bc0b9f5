//! The paper's numbers and figures, computed.

pub mod arm;
pub mod coupled;
pub mod equations;
