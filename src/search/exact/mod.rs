//! The exact front of spaces far too large to visit: branch and bound over boxes of parts.
//!
//! Every level of the design space is a binary tree over its options; a box is a node of each tree. A
//! `bound.rs` says how good the best member of a box could be, by the same mechanics with every number an
//! interval. A box is cut when no member can hold, or when a design already found is better than any member
//! could be; otherwise it is halved. Of a very large space the options are narrowed first, for one part at a time of what
//! the designs found leave open (`regions.rs`). What is left at the end is judged by the full model. Nothing is
//! assumed about the poses, the order of the parts or the shape of torsion curves: see `docs/exact.md` for
//! the proof and its conditions.

mod archive;
mod bound;
mod branch;
mod by_curve;
mod check;
mod corners;
mod evolve;
mod game;
mod gap;
mod grid;
mod held;
mod kinds;
mod known;
mod left;
mod narrow;
mod near;
mod parting;
mod parts;
mod play;
mod pointless;
mod pose;
mod price;
mod probe;
mod problem;
mod reach;
mod regions;
mod rounds;
mod run;
mod shape;
mod tip;
mod torsion;
mod tradeoff;
mod tree;

pub use reach::Reach;
pub use run::{Exact, ExactOutcome, VAST};
