//! Armwright sizes high-precision robot arms.
//!
//! It finds the Pareto-optimal arms of a design space for tip deflection, mass and lowest mode. It proves fronts
//! complete and verifies them independently. And if a model disagrees with measurements of a built arm, it finds
//! which physical effect the model lacks.
//!
//! The modules are listed from the ground up. Each uses only those before it:
//!
//! - [`input`]: JSON documents and tables, read such that every fault is found at once.
//! - [`pareto`]: Pareto fronts of three objectives, and their hypervolume.
//! - [`catalog`]: gears, motors, materials and profiles that can be bought.
//! - [`arm`]: the description of an arm: chain, sections, load cases, effects, and the arm file.
//! - [`mechanics`]: how an arm behaves: link (Eqs 1-6), statics (7, 13-15), modes (16-18).
//! - [`sizing`]: which drive each joint needs (Eqs 7-12).
//! - [`space`]: the design space with its open choices, and single designs by the full model.
//! - [`interchange`]: robots of URDF files as arms, and arms as files of other programs.
//! - [`search`]: the sweep over every design of a space.
//! - [`exact`]: an exact search that finds the same front without evaluating every design.
//! - [`verify`]: an independent check of a finished front.
//! - [`relax`]: lower bounds on mass.
//! - [`report`]: numbers, tables, pictures and pages.
//! - [`reconcile`]: where an arm and its measurements disagree, and which effect the model lacks.
//! - [`paper`]: the numbers of the paper, recomputed.
//! - [`study`]: named studies: reading, running and evaluating them.
//! - `command_line`: the program itself: parse, run, print (feature `cli`, on by default).
//!
//! `docs/library.md` says where to start. `docs/architecture.md` describes the source tree.
//!
//! Equation numbers are those of the paper from which the program grew, *Mechanical analysis of high precision
//! manipulator*. All quantities are SI and have their units in their names. Other units appear only where files are
//! read or written.
#![doc = ""]
#![doc = include_str!("../docs/model.md")]
#![deny(unreachable_pub)]
// without the feature `cli`, items that only the program uses have no caller; they are no dead code
#![cfg_attr(not(feature = "cli"), allow(dead_code, unused_imports))]
// tests may use the functions of the C library, because their results need not be equal to the last bit
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod arm;
pub mod catalog;
#[cfg(feature = "cli")]
pub(crate) mod cli;
pub mod exact;
pub mod input;
pub mod interchange;
pub mod mechanics;
pub mod paper;
pub mod pareto;
pub mod reconcile;
pub mod relax;
pub mod report;
pub mod search;
pub mod sizing;
pub mod space;
pub mod study;
pub mod verify;

/// The command line of the program: parse, run, print. It needs the feature `cli`, which is on by default.
#[cfg(feature = "cli")]
pub mod command_line {
    pub use crate::cli::{Answer, Cli, Exit, Failure, Log, print, printed, run};
}
