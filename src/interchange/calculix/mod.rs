//! Export to CalculiX: links become solids of quadratic bricks, joints become hinges with springs. Links without
//! compliance, and links whose section cannot be meshed, become rigid bodies.
//!
//! - [`mesh`] divides a link into bricks.
//! - [`model`] builds the whole arm in the pose of a case: rigid regions, hinges, point masses, loads.
//! - [`deck`] writes the input deck, once for deflections and once for frequencies.

pub(crate) mod deck;
pub(crate) mod mesh;
pub(crate) mod model;
