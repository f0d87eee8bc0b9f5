//! A second proof that a front lacks no design.
//!
//! This module shares no code with the exact search (`search::exact`), so that a mistake in one shows in the
//! other. What it knows are the pieces of a space, the tables of drives and sections, and the full model,
//! which judges single designs.
//!
//! A box is, for each level, a node of a binary tree over the level's options (`tree.rs`). The members of a
//! box are bounded by
//!
//! - *mass*: the sum of the least masses;
//! - *demand on joints*: torques by lever arms, every weight an interval that enters once (`span.rs`,
//!   `pose.rs`). A box none of whose drives holds the least demand is cut; the drive that fits first is one
//!   that holds the least demand and none that comes after the fit of the greatest (`drives.rs`);
//! - *deflection*: the method of the unit load along a fixed direction; a displacement is at least as long
//!   as its component along any direction (`bound.rs`);
//! - *lowest mode*: that of an arm as stiff as the stiffest and as light as the lightest number of the box
//!   allows, which has fewer ways to move than the full model (`pencil.rs`, `layout.rs`).
//!
//! A box is cut if no member holds or if a row of the front is no worse in all three objectives and better
//! in one (`staircase.rs`). Otherwise one of its levels is halved (`search.rs`). What is left are single
//! designs, which the full model judges: those that hold and that no row beats belong on the front. So every
//! design of the space is either in a box that was cut, and then beaten by a row, or among those judged.

pub(crate) mod bound;
pub(crate) mod boxes;
pub(crate) mod branch_score;
pub(crate) mod drive_range;
pub(crate) mod drives;
pub(crate) mod duty;
pub(crate) mod front_index;
pub(crate) mod halt;
pub(crate) mod judge;
pub(crate) mod layout;
pub(crate) mod missing;
pub(crate) mod modes;
pub(crate) mod offers;
pub(crate) mod parts_box;
pub(crate) mod pencil;
pub(crate) mod pose;
pub(crate) mod question;
pub(crate) mod ratings;
pub(crate) mod region;
pub(crate) mod search;
pub(crate) mod settings;
pub(crate) mod skeleton;
pub(crate) mod span;
pub(crate) mod tree;
pub(crate) mod tubes;
pub(crate) mod upper_bound;

pub use boxes::Boxes;
pub use judge::{Judge, Judged, Pick};
pub use missing::{Looked, conditions};
pub use parts_box::PartsBox;
pub use question::{
    AllowedParts, AskedDrive, AskedJoint, AskedLink, AskedMotion, AskedPhase, AskedPhaseKind, AskedPiece,
    AskedTube, Limits, LinearTorque, Question,
};
pub use settings::Settings;
