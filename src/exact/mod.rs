//! The exact front of spaces far too large to visit: branch and bound over boxes of parts.
//!
//! Every level of the design space is a binary tree over its options; a box is a node of each tree. A
//! `bound.rs` says how good the best member of a box could be, by the same mechanics with every number an
//! interval. A box is cut when no member can hold, or when a design already found is better than any member
//! could be; otherwise it is halved. Of a very large space the options are narrowed first, for one part at a time of what
//! the designs found leave open (`regions.rs`). What is left at the end is judged by the full model. Nothing is
//! assumed about the poses, the order of the parts or the shape of torsion curves: see `docs/exact.md` for
//! the proof and its conditions.

pub(crate) mod bound;
pub(crate) mod boxes;
pub(crate) mod branch_level;
pub(crate) mod branching;
pub(crate) mod budget;
pub(crate) mod compile;
pub(crate) mod compile_pose;
pub(crate) mod domain_reduction;
pub(crate) mod dominance;
pub(crate) mod drives_by_curve;
pub(crate) mod dual_price;
pub(crate) mod evolve;
pub(crate) mod force_bound;
pub(crate) mod forces;
pub(crate) mod gap;
pub(crate) mod grid;
pub(crate) mod incumbents;
pub(crate) mod interval;
pub(crate) mod intervals;
pub(crate) mod joint_play;
pub(crate) mod judge;
pub(crate) mod kinds;
pub(crate) mod lagrangian;
pub(crate) mod local_upper_bounds;
pub(crate) mod lowest_eigenvalue;
pub(crate) mod matrix_game;
pub(crate) mod near;
pub(crate) mod parts;
pub(crate) mod pose;
pub(crate) mod probe;
pub(crate) mod problem;
pub(crate) mod reduced_cost;
pub(crate) mod region_bound;
pub(crate) mod regions;
pub(crate) mod rounds;
pub(crate) mod rows;
pub(crate) mod run;
pub(crate) mod search_state;
pub(crate) mod shape;
pub(crate) mod ties;
pub(crate) mod tip_row;
pub(crate) mod torsion;
pub(crate) mod tree;
pub(crate) mod work;

pub use domain_reduction::DomainReduction;
pub use run::{Exact, ExactOutcome, VAST};
