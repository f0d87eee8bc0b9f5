//! From a gap to a better model: where an arm and its model disagree, which piece of physics is
//! missing, how sure that is, and what it changes.
//!
//! [`campaign`] reads the readings; [`forward`] predicts them fast, [`exact`] by mechanics directly; [`model`] says
//! what is free, [`candidates`] what is looked for and [`expected`] how large it may be; [`fit`] fits; [`select`]
//! finds the effects; [`noise`] finds gross errors and wrongly declared deviations, [`units`] columns whose deviations
//! are in another unit, and [`settle`] finds effects and all this, for they depend on each other;
//! [`lack_of_fit`] asks whether structure is left and [`unnamed`] whether one of the [`laws`] that no effect has does
//! better; [`few_rows`] says what a handful of readings can; [`kept_out`] confirms on poses kept out; [`interval`]
//! gives the intervals; [`analysis`] draws the conclusion and [`verdict`] is its form, [`page`] its page for a
//! browser; [`correct`] writes the arm and [`next_test`] says what to measure; [`positions`] does all of it for
//! absolute ones and [`together`] for both.

pub mod analysis;
pub mod fit;
pub mod forward;
pub mod model;
pub mod positions;
pub mod predict;
pub mod readings;
pub mod select;
pub mod together;
pub mod verdict;

pub use readings::campaign::Campaign;
pub use together::reconcile;
pub use verdict::outcome::{Outcome, Verdict};
