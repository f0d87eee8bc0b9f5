//! The program as a user meets it: its commands, its messages, the files and pages that it writes, the documents; and the
//! house that the source stands in.

mod architecture;
mod bad_input;
mod bearings;
mod browser;
mod capacity;
mod catalog;
mod catalog_cli;
mod cli;
mod compare;
mod docs;
mod duty_cycles;
mod front_check;
mod imports;
mod left_out;
mod links;
mod other_poses;
mod pages;
mod progress;
mod same_bytes;
mod study_effects;
mod words;
