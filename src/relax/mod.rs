//! A lower bound on the mass of every design that deflects at most as far, and has at least as high a lowest mode,
//! as required.
//!
//! *Relaxation* here means a linear program in which the choice of one option per piece is relaxed. Each piece of the
//! arm may be a mixture of its catalog options, with weights that sum to one. Then
//!
//! - mass is linear in the weights;
//! - tip deflection has lower bounds that are linear (`statics`: loads at an end of their range, plus McCormick's
//!   envelope of load times compliance);
//! - the torque that a drive must provide is linear;
//! - a required lowest mode is `K - ω² M ⪰ 0` with `K` and `M` linear, and each trial shape `x` gives one linear
//!   inequality (`shapes`).
//!
//! In a mixture, the two springs of the bearing of a chosen gear have the same weights as the drive. The allowed
//! loads of that bearing are left out. Designs that they would exclude are included, so the bound stays valid and is
//! only lower.
//!
//! The lightest mixture is a linear program, which Clarabel solves (`program`). The result is the Lagrangian bound
//! at the solver's multipliers. It is valid for any multipliers, so it does not depend on the solver's tolerance.
//!
//! A known design meets the requirements. An option is dropped if it cannot belong to any design that also meets the
//! requirements and is no heavier than the known design. This narrows the ranges of the loads and tightens the bound,
//! and is repeated until nothing changes. Every step is proved in `docs/relaxation.md`.

pub(crate) mod drives;
pub(crate) mod parts;
pub(crate) mod program;
pub(crate) mod relaxation;
pub(crate) mod row;
pub(crate) mod shapes;
pub(crate) mod slopes;
pub(crate) mod statics;

pub use relaxation::{MassBound, Relaxation};
