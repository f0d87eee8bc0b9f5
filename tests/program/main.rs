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
mod drives;
mod duty_cycles;
mod front_check;
mod growth;
mod hostile_names;
mod imports;
mod infeasible;
mod kept;
mod left_out;
mod links;
mod operations;
mod other_poses;
mod pages;
mod prismatic;
mod progress;
mod same_bytes;
mod shards;
mod study_effects;
mod whole_results;
mod words;
