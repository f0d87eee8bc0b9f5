//! Absolute positions: placement, tool offsets, joint zeros, geometry and the direction of gravity are calibrated.
//! Compliances are then found effect by effect. Each stage is judged on poses held out of the fit.
//!
//! - `tree` joins the arms that stand on one trunk; `points` lists the points on their tools.
//! - [`kinematics`] computes the position of a point in a `pose`, `kinematics_lanes` the positions of eight points at once, and
//!   [`loads`] how gravity moves a point (`deflection`).
//! - `align` finds a first placement of the arm. [`fit`](mod@fit) fits a model (`fitted`). `rows` builds its normal
//!   equations (`normal`), and `springs` solves them with compliances that are physically possible.
//! - [`analysis`] is the whole analysis.
//! - `sessions` finds sessions, and `boundary` judges each boundary between two of them (`moved`). `drift` finds a
//!   drift in the place of sessions. `fitted_placement` finds the placement of the arm in each session.
//! - `search` finds compliances, and `transmission` finds joints with a transmission error. `nominal` finds
//!   stiffnesses, moduli and masses that differ from the arm file (`dependence`).
//! - `shape` says how the displacement by a candidate that is no spring depends on its torque, and `shaped` lists these
//!   candidates. `threshold` refines torque scales and preloads. `waves` finds stiffnesses that vary with the angle.
//! - `second_order` computes the difference between the true and the linear displacement.
//! - `law` lists physics that is no effect, and `laws` lets it compete with effects. `angle_laws` does the same for
//!   errors of a joint's angle.
//! - `screening` chooses the rows of a long campaign on which effects are screened.
//! - `setups` transforms the positions of several campaigns into one frame.
//! - `conventions` tests whether the file was written by another convention (`convention_changes`). `far_geometry`
//!   tests whether calibration moved the geometry further than the priors expect, and `structure` tests the errors of
//!   the best model for structure.
//! - `declared_sigma` compares the declared standard deviations with the scatter of the positions.
//! - `posterior` computes the uncertainty of the numbers of the model. Small compliances outside the model add to it
//!   (`unnamed_springs`); no compliance is negative (`non_negative`). `geometry_slopes` completes the derivatives for
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
pub(crate) mod deflection;
pub(crate) mod dependence;
mod drift;
pub(crate) mod far_geometry;
pub(crate) mod fit;
pub(crate) mod fitted;
pub(crate) mod fitted_placement;
mod geometry_slopes;
mod in_series;
mod intervals;
pub(crate) mod kinematics;
pub(crate) mod kinematics_lanes;
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
pub(crate) mod pose;
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
pub(crate) mod structure;
pub(crate) mod threshold;
pub(crate) mod transmission;
pub(crate) mod tree;
pub(crate) mod unnamed_springs;
pub(crate) mod waves;
