//! Tests of `reconcile`, the comparison of a model with measurements: with campaigns of an independent model, of other
//! simulators and of real machines.

mod bad_data;
mod bearings;
mod campaigns;
mod conventions;
mod coverage;
#[path = "scoring/detectability.rs"]
mod detectability;
mod few_rows;
mod forward;
mod gauge;
mod generated;
mod generator;
mod honest_verdicts;
mod long_campaigns;
#[path = "../../examples/measured/mod.rs"]
mod measured;
mod moved;
mod nominal_positions;
mod other_simulator;
mod positions;
mod positions_laws;
mod positions_long;
mod positions_maker;
mod positions_other_simulator;
mod prismatic;
mod record_simulator;
mod records;
mod records_known_rows;
mod records_prescribed;
mod scoring;
mod together;
mod unusual;
mod without_a_name;
#[path = "../witness/mod.rs"]
mod witness;
mod yielding_arm;
