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
mod interchange;
mod kept;
mod left_out;
mod links;
mod operations;
mod other_poses;
mod pages;
mod progress;
mod public_api;
mod same_bytes;
mod schemas;
mod shards;
mod starters;
mod study_effects;
mod whole_results;
mod words;
