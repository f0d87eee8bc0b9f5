//! Absolute positions: placement, tool offsets, joint zeros, geometry and the direction of gravity are calibrated.
//! What yields is found effect by effect, and each stage is judged on poses held out of the fit.
//!
//! - `tree` joins the arms that stand on one trunk; `points` lists the points on their tools.
//! - [`kinematics`] says where a point is, and [`loads`] how gravity moves it.
//! - `align` places the arm from nothing. [`fit`](mod@fit) fits a model (`fitted`), by the equations in `normal` that
//!   `rows` sums up, with compliances that are `springs`.
//! - [`analysis`] is the whole analysis. `sessions` tells sessions apart, `boundary` judges each boundary
//!   between two of them (`moved`), and `standing` finds where the arm stands in each;
//!   `search` finds what yields and `transmission` what turns unevenly.
//! - `conventions` asks whether the file was written by another convention, `structure` what is left; `next_test` says
//!   what to measure, and [`outcome`] concludes.
//! - [`predict`] gives positions of several arms whose weights load each other's trunk.

pub(crate) mod align;
pub(crate) mod analysis;
pub(crate) mod boundary;
pub(crate) mod conventions;
pub(crate) mod fit;
pub(crate) mod fitted;
pub(crate) mod kinematics;
pub(crate) mod loads;
pub(crate) mod moved;
pub(crate) mod next_test;
pub(crate) mod normal;
pub(crate) mod outcome;
pub(crate) mod play;
pub(crate) mod play_scale;
pub(crate) mod points;
pub(crate) mod predict;
pub(crate) mod rows;
pub(crate) mod search;
pub(crate) mod sessions;
pub(crate) mod springs;
pub(crate) mod standing;
pub(crate) mod structure;
pub(crate) mod transmission;
pub(crate) mod tree;
pub(crate) mod unnamed_springs;
