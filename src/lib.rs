//! Armwright sizes high-precision robot arms.
//!
//! It finds the Pareto-optimal arms of a design space on tip deflection, mass and lowest mode; it proves fronts complete
//! and verifies them independently; and it finds what a model lacks that disagrees with measurements of a built arm.
//!
//! The modules, from the ground up. Each uses only those before it:
//!
//! - [`input`]: JSON documents and tables, read such that every fault is found at once.
//! - [`pareto`]: Pareto fronts of three objectives, and their hypervolume.
//! - [`catalog`]: gears, motors, materials and profiles that one can buy.
//! - [`arm`]: what an arm is: chain, sections, load cases, effects, and the arm file.
//! - [`mechanics`]: how an arm behaves: link (Eqs 1-6), statics (7, 13-15), modes (16-18).
//! - [`sizing`]: which drive each joint needs (Eqs 7-12).
//! - [`space`]: what may be chosen, and single designs by the full model.
//! - [`interchange`]: robots of URDF files as arms, and arms as files of other programs.
//! - [`search`]: the sweep over every design of a space.
//! - [`exact`]: the same front without visiting every design.
//! - [`verify`]: an independent check of a finished front.
//! - [`relax`]: lower bounds on mass.
//! - [`report`]: numbers, tables, pictures and pages.
//! - [`reconcile`]: where an arm and its measurements disagree, and which effect is missing.
//! - [`paper`]: the numbers of the paper, computed.
//! - [`study`]: named questions: read, run, evaluate.
//! - `command_line`: the program itself: parse, run, print (feature `cli`, on by default).
//!
//! `docs/library.md` says what to start with; `docs/architecture.md` says where in the source everything is.
//!
//! Equation numbers are those of the paper from which the program grew, *Mechanical analysis of high precision
//! manipulator*. All quantities are SI and have their units in their names. Other units appear only where files are read
//! or written.
#![doc = ""]
#![doc = include_str!("../docs/model.md")]
#![deny(unreachable_pub)]
// what only the program uses is not dead, only far away
#![cfg_attr(not(feature = "cli"), allow(dead_code, unused_imports))]
// in tests any sine is good enough
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

/// The command line, for a program that is one: parse, run, print. It needs the feature `cli`, which is on by default.
#[cfg(feature = "cli")]
pub mod command_line {
    pub use crate::cli::{Answer, Cli, Exit, Failure, Log, print, printed, run};
}
