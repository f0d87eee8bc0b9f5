//! A second, independent proof that a front lacks no design.
//!
//! This folder shares no code with the searches, so that a mistake in a search shows up here. It is given the
//! [`Question`] as plain data, and computes the rest by itself from catalog rows, the arm and its mechanics. It
//! shares with the searches only the reader of studies and catalogs, `arm`, and the full model of `mechanics`,
//! which judges single designs.
//!
//! A box is, for each level, a node of a binary tree over the level's options (`tree`). The members of a
//! box are bounded by
//!
//! - *mass*: the sum of the least masses;
//! - *demand on joints*: torques by lever arms, loads on bearings by couplings of two motions (`bearing_loads`). Every
//!   weight and every inertia is an interval that enters each sum once (`span`, `pose`). A box is discarded if none of
//!   its drives meets the least demand. The first drive that fits meets the least demand. It does not come after the
//!   first drive that meets the greatest demand (`drives`);
//! - *deflection*: the method of the unit load along a fixed direction. A displacement is at least as long
//!   as its component along any direction (`bound`);
//! - *lowest mode*: the lowest mode of an ideal arm, which has every stiffness of the box at its greatest and every
//!   inertia at its least. It has fewer coordinates than the full model, so its lowest mode is no lower (`pencil`,
//!   `layout`).
//!
//! A box is discarded if no member meets its checks and limits, or if a design of the front dominates every member. To
//! dominate a member is to be no worse in all three objectives and better in at least one (`front_index`). Otherwise
//! one level of the box is halved (`search`), until single designs are left. The full model judges these single designs
//! (`judge`). A design belongs on the front if it meets all limits and no design of the front dominates it. So every
//! design of the question is accounted for. Either it was judged by itself, or it was in a discarded box and is
//! dominated or fails.
//!
//! Very large spaces are searched region by region (`region`).

pub(crate) mod bearing;
pub(crate) mod bearing_loads;
pub(crate) mod bound;
pub(crate) mod boxes;
pub(crate) mod branch_score;
pub(crate) mod carriers;
pub(crate) mod courses;
pub(crate) mod demand;
pub(crate) mod drive_range;
pub(crate) mod drives;
pub(crate) mod duty;
pub(crate) mod fit;
pub(crate) mod front_index;
pub(crate) mod halt;
pub(crate) mod heat;
pub(crate) mod judge;
pub(crate) mod layout;
pub(crate) mod ledger;
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
pub use ledger::{Keep, Ledger};
pub use missing::{Looked, conditions};
pub use parts_box::PartsBox;
pub use question::{
    AllowedParts, AskedDrive, AskedDutyPhase, AskedJoint, AskedLink, AskedMotion, AskedPhase, AskedPhaseKind,
    AskedPiece, AskedRail, AskedTube, Limits, LinearTorque, Question,
};
pub use settings::Settings;
