//! The design space, prepared for fast evaluation of many designs.
//!
//! A design is one option at each level of a tree. The levels go from the tip to the base, because a joint can be sized
//! only when everything outboard of it is known.
//!
//! - [`design_space`] has the description of a space: what is open, in which cases the arm is judged, and the limits.
//! - `problem` presents an arm as the tree of designs of [`levels::OutwardIn`]. The trait adds an option to a partial
//!   arm, finds out whether a design with this beginning can meet the limits, and evaluates a complete arm.
//! - `station` has everything about one case that does not depend on the design.
//! - [`design`] evaluates one design by the full model.

pub(crate) mod attributes;
pub(crate) mod bearing_demand;
pub(crate) mod bearing_loads;
pub(crate) mod beyond_bounds;
pub mod constraint;
pub mod design;
pub mod design_space;
pub(crate) mod effects;
pub(crate) mod excerpt;
pub(crate) mod fit;
pub(crate) mod fixed;
pub(crate) mod full_model;
pub(crate) mod group;
pub(crate) mod guide;
pub(crate) mod joints;
pub(crate) mod levels;
pub(crate) mod link_stress;
pub(crate) mod overload;
pub(crate) mod piece_masses;
pub(crate) mod posed;
pub mod prismatic;
pub(crate) mod problem;
pub(crate) mod reaction;
pub(crate) mod slot;
pub(crate) mod state;
pub(crate) mod stated_bearing;
pub(crate) mod station;

pub use design::{Evaluated, evaluate};
pub use design_space::DesignSpace;
pub use levels::{DesignRow, Finished, Keep, OutwardIn};
pub use problem::ArmProblem;
