//! The design space, compiled for speed.
//!
//! A design is one option at each level of a tree; levels go from the tip inward, because the outward
//! pass of the mechanics is also the order in which joints are sized. [`design_space`] says what there is to
//! choose, [`problem`] puts the arm behind the trait [`levels::OutwardIn`]: extend a partial arm by an option, or
//! find that no design beyond it can hold; evaluate a complete one. [`design`] judges one design by the full model.

pub mod constraint;
pub mod design;
pub mod design_space;
pub(crate) mod effects;
pub(crate) mod excerpt;
pub(crate) mod figures;
pub mod fixed;
pub mod levels;
pub mod problem;
pub(crate) mod slot;
pub mod station;

pub use design::{Evaluated, evaluate};
pub use design_space::DesignSpace;
pub use levels::{Finished, Keep, OutwardIn};
pub use problem::ArmProblem;
