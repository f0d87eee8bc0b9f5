//! Pareto fronts of three objectives, and the hypervolume that compares them.
//!
//! All objectives are minimized: mass, tip deflection, and the negative of the lowest mode.
//!
//! - [`front`] finds the points that no other point dominates.
//! - [`hypervolume`] measures how good a front is.
//! - `archive` rejects dominated designs quickly while a search runs.

pub(crate) mod archive;
pub mod front;
pub mod hypervolume;
pub(crate) mod objectives;
pub(crate) mod ranking;
pub(crate) mod sieve;
pub(crate) mod staircase;

pub use objectives::Objectives;
