//! The sweep: every design of a space, in parallel.
//!
//! [`sweep`] visits every design and keeps what nothing dominates; a *row* is all designs that differ in the innermost
//! level alone, and is finished eight designs at a time ([`finish`]). [`near`] finds designs that are nearly on a
//! front, [`scatter`] what becomes of designs whose parts differ from the catalog, [`ballast`] designs that are
//! on a front only because weight loads a gear into a stiffer segment.

pub(crate) mod arms;
pub mod ballast;
pub mod finish;
pub mod near;
pub(crate) mod row;
pub(crate) mod row_lanes;
pub(crate) mod row_modes;
pub mod scatter;
pub mod sweep;
pub(crate) mod visit;

pub use finish::FinishRows;
pub use sweep::{Status, Sweep, SweepOutcome};
