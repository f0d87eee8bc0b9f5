//! Fronts: what no other design beats, and how fronts are compared.
//!
//! All objectives are made small: mass, tip deflection, and the lowest mode with its sign turned.

pub(crate) mod archive;
pub mod front;
pub mod hypervolume;
pub(crate) mod objectives;
pub(crate) mod ranking;
pub(crate) mod sieve;
pub(crate) mod staircase;

pub use objectives::Objectives;
