//! Absolute positions: placement, tool offsets, joint zeros, geometry and the direction of gravity are calibrated.
//! Compliances are then found effect by effect. Each stage is judged on poses held out of the fit.
//!
//! - `tree` joins the arms that stand on one trunk; `points` lists the points on their tools.
//! - [`kinematics`] computes where a point is, `eight_places` where eight points are, and [`loads`] how gravity moves
//!   a point.
//! - `align` finds a first placement of the arm. [`fit`](mod@fit) fits a model (`fitted`). `rows` sums up its normal
//!   equations (`normal`), and `springs` keeps the compliances physically possible.
//! - [`analysis`] is the whole analysis.
//! - `sessions` finds sessions, and `boundary` judges each boundary between two of them (`moved`). `drift` finds a drift
//!   in the place of sessions. `standing` finds where the arm stands in each session.
//! - `search` finds compliances, and `transmission` finds joints with a transmission error. `nominal` finds stiffnesses,
//!   moduli and masses other than stated (`dependence`).
//! - `shape` says how the displacement by a candidate that is no spring depends on its torque, and `shaped` lists these
//!   candidates. `threshold` refines torque scales and preloads. `waves` finds stiffnesses that vary with the angle.
//! - `second_order` computes the difference between the true and the linear displacement.
//! - `law` lists physics that is no effect, and `laws` lets it compete with effects. `angle_laws` does so for errors of a
//!   joint's angle.
//! - `screening` chooses the rows of a long campaign on which effects are screened.
//! - `setups` brings the positions of several campaigns into one frame.
//! - `conventions` tests whether the file was written by another convention (`convention_changes`). `far_geometry` tests
//!   whether calibration went further than its prior expects, and `structure` tests the errors that are left.
//! - `declared_sigma` compares the standard deviations of the file with the scatter.
//! - `posterior` says what the readings leave open about the numbers of the model, if compliances that are not in it
//!   (`unnamed_springs`) are possible too; none is negative (`non_negative`). `geometry_slopes` completes the derivatives for
//!   this, and `intervals` states the intervals.
//! - `next_test` proposes what to measure, and [`outcome`] reaches the verdict.
//! - [`predict`] predicts positions of several arms whose weights load each other's trunk.

pub(crate) mod adjusted;
pub(crate) mod align;
pub(crate) mod analysis;
mod angle_laws;
pub(crate) mod boundary;
pub(crate) mod convention_changes;
pub(crate) mod conventions;
mod declared_sigma;
pub(crate) mod dependence;
mod drift;
pub(crate) mod eight_places;
pub(crate) mod far_geometry;
pub(crate) mod fit;
pub(crate) mod fitted;
mod geometry_slopes;
mod intervals;
pub(crate) mod kinematics;
mod law;
mod laws;
pub(crate) mod loads;
pub(crate) mod moved;
pub(crate) mod next_test;
pub(crate) mod nominal;
mod non_negative;
pub(crate) mod normal;
pub(crate) mod outcome;
pub(crate) mod points;
mod posterior;
pub(crate) mod predict;
pub(crate) mod rows;
mod screening;
pub(crate) mod search;
pub(crate) mod second_order;
pub(crate) mod sessions;
pub(crate) mod setups;
pub(crate) mod shape;
mod shaped;
pub(crate) mod springs;
pub(crate) mod standing;
pub(crate) mod structure;
pub(crate) mod threshold;
pub(crate) mod transmission;
pub(crate) mod tree;
pub(crate) mod unnamed_springs;
pub(crate) mod waves;
