//! The sweep: every design of a space is evaluated, in parallel.
//!
//! - [`sweep`] visits every design and keeps the designs that no other design dominates. A *row* is the set of
//!   designs that differ in one level alone; the sweep evaluates the designs of a row eight at a time (`finish`).
//! - [`near`] finds the near designs: designs that are not on the front, but worse than some design of it by at most a
//!   stated percentage.
//! - [`resume`] saves the state of a sweep, so that another process can continue it.
//! - [`scatter`] computes designs whose parts differ a little from the catalog.
//! - `ballast` finds designs that are on a front only because extra weight loads a gear into a stiffer part of its
//!   torsion curve.
//! - `same_drives` takes a design and finds a lighter arm with the same drives at the joints sized by first fit.

pub(crate) mod arms;
pub(crate) mod ballast;
pub(crate) mod finish;
pub mod near;
pub mod resume;
pub(crate) mod row;
pub(crate) mod row_bearing;
pub(crate) mod row_begun;
pub(crate) mod row_case;
pub(crate) mod row_chunk;
pub(crate) mod row_drives;
pub(crate) mod row_lanes;
pub(crate) mod row_modes;
pub(crate) mod row_room;
pub(crate) mod same_drives;
pub mod scatter;
pub mod sweep;
pub(crate) mod visit;

pub use finish::FinishRows;
pub use resume::{KeepState, Resume};
pub use sweep::{Status, Sweep, SweepOutcome, SweepState};
