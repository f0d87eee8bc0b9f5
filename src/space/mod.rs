//! The design space, compiled for speed.
//!
//! A design is one option at each level of a tree. The levels go from the tip to the base, because a joint can be sized
//! only when everything outboard of it is known.
//!
//! - [`design_space`] says what there is to choose.
//! - `problem` puts the arm behind the trait [`levels::OutwardIn`]. The trait extends a partial arm by an option, finds
//!   that no design with this beginning can hold, and evaluates a complete arm.
//! - `station` compiles one case: everything about a pose that does not depend on the design.
//! - [`design`] judges one design by the full model.

pub(crate) mod attributes;
pub(crate) mod bearing_demand;
pub(crate) mod bearing_loads;
pub mod constraint;
pub mod design;
pub mod design_space;
pub(crate) mod effects;
pub(crate) mod excerpt;
pub(crate) mod fit;
pub(crate) mod fixed;
pub(crate) mod full_model;
pub(crate) mod group;
pub(crate) mod joints;
pub(crate) mod levels;
pub(crate) mod posed;
pub mod prismatic;
pub(crate) mod problem;
pub(crate) mod slot;
pub(crate) mod state;
pub(crate) mod station;

pub use design::{Evaluated, evaluate};
pub use design_space::DesignSpace;
pub use levels::{DesignRow, Finished, Keep, OutwardIn};
pub use problem::ArmProblem;
