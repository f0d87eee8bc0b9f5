//! From the model of an arm to the front of its designs, each against a closed form, another program, or a slow
//! calculation from the definition.

mod bearing_loads;
mod beside_the_front;
mod bodies;
mod brute;
mod brute_bearings;
mod brute_force;
mod brute_studies;
mod budget;
mod closed_forms;
mod dice;
mod exact_anytime;
mod exact_bearings;
mod exact_front;
mod exact_support;
mod exact_threads;
mod exact_ties;
mod fits;
mod frozen_designs;
mod given_drives;
mod link_strength;
mod loads_and_linkages;
mod lowest_mode;
mod mechanics_reference;
mod motor_heat;
mod paper;
mod paper_support;
mod pieces;
mod prismatic;
mod rails;
mod reference_arms;
mod relaxation;
mod search_fast_vs_full;
mod springs;
mod study_rerun;
mod transmissions;
mod whole_arms;
#[path = "../witness/mod.rs"]
mod witness;
mod witness_bearings;
mod witness_drives;
mod witness_effects;
mod witness_front;
mod witness_regions;
mod worst_pose;
