//! From a gap to a better model: where an arm and its model disagree, which piece of physics is
//! missing, how sure that is, and what it changes.

pub mod campaign;
pub mod exact;
pub mod fit;
pub mod forward;
pub mod lack_of_fit;
pub mod model;
pub mod noise;
pub mod readings;
pub mod select;
pub mod stats;
pub mod table;
