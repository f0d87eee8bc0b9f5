//! From a gap to a better model: where an arm and its model disagree, which piece of physics is missing, how
//! sure that is, and what it changes.
//!
//! The rooms below, from bottom to top:
//! - [`readings`] reads the campaign and says where arm and points stand.
//! - [`forward`] predicts all readings fast, from what is prepared once.
//! - [`model`] says what is calibrated, which effects are candidates and how large they may be.
//! - [`fit`] fits a model, gives intervals, judges the noise, and predicts held-out poses.
//! - `select` finds the effects that are missing, and the laws without a name that do better.
//! - [`verdict`] holds the outcome, its files and its page, and says what to measure next.
//! - `positions` does all of it for absolute positions, and [`records`] for records against time.
//! - `analysis` draws the conclusion from displacements, frequencies and bench readings, `together` from
//!   these and positions. [`predict`] writes the model's values next to readings, [`predict_files`] reads the files for it.

pub(crate) mod analysis;
pub mod fit;
pub mod forward;
pub mod model;
pub(crate) mod positions;
pub mod predict;
pub mod predict_files;
pub mod readings;
pub mod records;
pub(crate) mod select;
pub(crate) mod starter;
pub(crate) mod together;
pub mod verdict;

pub use readings::campaign::Campaign;
pub use readings::keys::CAMPAIGN_FILE;
pub use together::reconcile;
pub use verdict::outcome::{Outcome, Verdict};
