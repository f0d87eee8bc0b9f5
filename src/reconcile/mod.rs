//! Improves the model of an arm by measurements: finds where an arm and its model disagree, which piece of physics is
//! missing, how certain this is, and what it changes.
//!
//! The rooms below, from bottom to top:
//!
//! - [`readings`] reads the files of a campaign, and the placement of arm and points in the frame of the instrument.
//! - [`forward`] predicts all readings fast, from quantities that are computed once.
//! - [`model`] defines what is calibrated, which effects are candidates and how large they may be.
//! - [`fit`] fits a model, gives intervals, judges the noise, and predicts held-out poses.
//! - `select` finds the effects that are missing, and laws without a name that explain the readings better.
//! - [`verdict`] defines the outcome, writes its files and its page, and proposes what to measure next.
//! - `positions` does all of this for absolute positions, and [`records`] for records against time.
//! - `found` finds the effects of a campaign, and `long` those of a long one.
//! - `analysis` reaches the verdict from displacements, frequencies and bench readings. `together` reaches it from all
//!   kinds of readings of a campaign.
//! - [`predict`] writes the model's predictions next to readings, and [`predict_files`] reads the files for it.
//!   `starter` writes the files of a new campaign.

pub(crate) mod analysis;
pub mod fit;
pub mod forward;
mod found;
mod long;
pub mod model;
pub(crate) mod positions;
pub mod predict;
pub mod predict_files;
pub mod readings;
pub mod records;
mod ruling;
pub(crate) mod select;
pub(crate) mod starter;
pub(crate) mod together;
pub mod verdict;

pub use readings::campaign::Campaign;
pub use readings::keys::CAMPAIGN_FILE;
pub use together::reconcile;
pub use verdict::outcome::{Outcome, Verdict};
