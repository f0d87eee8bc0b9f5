//! The exact front of spaces far too large to visit: branch and bound over boxes of parts.
//!
//! Every level of the design space is a binary tree over its options; a box is a node of each tree. A
//! `bound.rs` says how good the best member of a box could be, by the same mechanics with every number an
//! interval. A box is cut when no member can hold, or when a design already found is better than any member
//! could be; otherwise it is halved. Of a very large space the options are narrowed first, for one part at a time of what
//! the designs found leave open (`regions.rs`). What is left at the end is judged by the full model. Nothing is
//! assumed about the poses, the order of the parts or the shape of torsion curves: see `docs/exact.md` for
//! the proof and its conditions.

pub(crate) mod archive;
pub(crate) mod bound;
pub(crate) mod boxes;
pub(crate) mod branch;
pub(crate) mod budget;
pub(crate) mod by_curve;
pub(crate) mod check;
pub(crate) mod compile;
pub(crate) mod compile_pose;
pub(crate) mod corners;
pub(crate) mod evolve;
pub(crate) mod forces;
pub(crate) mod game;
pub(crate) mod gap;
pub(crate) mod grid;
pub(crate) mod held;
pub(crate) mod interval;
pub(crate) mod judge;
pub(crate) mod kinds;
pub(crate) mod known;
pub(crate) mod left;
pub(crate) mod narrow;
pub(crate) mod near;
pub(crate) mod parting;
pub(crate) mod parts;
pub(crate) mod play;
pub(crate) mod pointless;
pub(crate) mod pose;
pub(crate) mod price;
pub(crate) mod probe;
pub(crate) mod problem;
pub(crate) mod reach;
pub(crate) mod regions;
pub(crate) mod rounds;
pub(crate) mod run;
pub(crate) mod shape;
pub(crate) mod ties;
pub(crate) mod tip;
pub(crate) mod torsion;
pub(crate) mod tradeoff;
pub(crate) mod tree;

pub use reach::Reach;
pub use run::{Exact, ExactOutcome, VAST};
