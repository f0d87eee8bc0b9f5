//! CalculiX: links as solids of quadratic bricks, joints as hinges with springs.
//!
//! - [`mesh`] cuts a link into bricks.
//! - [`model`] makes the whole arm in the pose of a case: rigid regions, hinges, point masses, loads.
//! - [`deck`] writes it, once for deflections and once for frequencies.

pub(crate) mod deck;
pub(crate) mod mesh;
pub(crate) mod model;
