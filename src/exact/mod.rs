//! The exact front of design spaces that are far too large to enumerate: branch and bound over boxes of
//! parts.
//!
//! The options of each level of the design space (the tubes of a link, the drives of a joint) form a binary
//! tree. A box is one node of each tree; its members are all designs whose parts lie below those nodes. The
//! bound of a box (`bound.rs`) says how good its best member could be: it is the same mechanics with every
//! number replaced by an interval. A box is pruned if no member meets the constraints, or if a design already
//! found (an incumbent) dominates the bound. Otherwise the box is halved. A box of one design is judged by
//! the full model.
//!
//! A very large space is searched region by region (`regions.rs`). A region consists of the designs that are better
//! than one local upper bound of the incumbents. A Lagrangian bound over the region removes most options of each level
//! before boxes are searched.
//!
//! A space can also be searched in shards (`shard.rs`), one process each.
//!
//! No assumption is made about the poses, the order of the parts or the shape of the torsion curves. The
//! proof and its conditions are in `docs/exact.md`.

pub(crate) mod bearing_rows;
pub(crate) mod bound;
pub(crate) mod box_work;
pub(crate) mod boxes;
pub(crate) mod branch_level;
pub(crate) mod branching;
pub(crate) mod budget;
pub(crate) mod compile;
pub(crate) mod compile_pose;
pub(crate) mod cover;
pub(crate) mod domain_reduction;
pub(crate) mod dominance;
pub(crate) mod drives_by_curve;
pub(crate) mod dual_price;
pub(crate) mod early;
pub(crate) mod evolve;
pub(crate) mod force_bound;
pub(crate) mod forces;
pub(crate) mod gap;
pub(crate) mod grid;
pub(crate) mod incumbents;
pub(crate) mod interval;
pub(crate) mod intervals;
pub(crate) mod joint_play;
pub(crate) mod journal;
pub(crate) mod judge;
pub(crate) mod kinds;
pub(crate) mod lagrangian;
pub(crate) mod live_progress;
pub(crate) mod local_upper_bounds;
pub(crate) mod lowest_eigenvalue;
pub(crate) mod matrix_game;
pub(crate) mod near;
pub(crate) mod outcome;
pub(crate) mod parts;
pub(crate) mod plan;
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
pub(crate) mod shard;
pub(crate) mod ties;
pub(crate) mod tip_row;
pub(crate) mod torsion;
pub(crate) mod tree;

pub use domain_reduction::DomainReduction;
pub use live_progress::Known;
pub use outcome::{ExactOutcome, FoundInShard};
pub use run::{Exact, VAST, WORKER_STACK_BYTES};
pub use shard::refuse_holes;
