//! Armwright sizes high-precision robot arms.
//!
//! The rooms of the house, from the ground up. Each room knows only the rooms before it; `docs/library.md` says what
//! each is for to a program that uses this library.
//!
//! - [`input`]: what is wrong with an input file, all of it at once, with file, line and field.
//! - [`pareto`]: fronts, and how they are measured.
//! - [`catalog`]: what can be bought: materials, profiles, gears, motors.
//! - [`arm`]: what an arm is: the chain, sections, load cases, effects; the arm file.
//! - [`mechanics`]: how it behaves: link (Eqs 1-6), statics (7, 13-15), modes (16-18).
//! - [`sizing`]: which drive each joint needs, outward in (7-12).
//! - [`space`]: the design space, compiled for speed.
//! - [`search`]: the sweep, which visits every design.
//! - [`exact`], [`verify`], [`relax`]: the front without visiting every design, its independent check, and lower bounds.
//! - [`report`]: numbers and pictures: CSV, JSON, SVG, pages, terminal.
//! - [`reconcile`]: where an arm and its measurements disagree, and which physics is missing.
//! - [`paper`]: the table and the figures of the paper.
//! - [`study`]: named questions: read, resolve, run.
//! - [`command_line`]: the program.
//!
//! Equation numbers are those of the paper the product grew from, *Mechanical analysis of high
//! precision manipulator*. All quantities are SI and carry their unit in their name; conversion
//! happens only where a file is read or written.
#![doc = ""]
#![doc = include_str!("../docs/model.md")]
#![deny(unreachable_pub)]

pub mod arm;
pub mod catalog;
pub(crate) mod cli;
pub mod exact;
pub mod input;
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

/// The command line, for a program that is one: parse, run, print.
pub mod command_line {
    pub use crate::cli::{Cli, Failure, print, run};
}
