//! The paper's Figs 2 to 4: a hollow square cantilever under an end force, in many sections and materials.
//!
//! The figures print neither length nor load nor wall thickness. This program takes a length of 0.8 m, an end force of
//! 500 N without an end torque, a wall of 10 mm, and outer sizes of 7 to 16 cm. What the figures call specific gravity
//! is q of Eq 6, the weight per length \[N/m\]. The deflection is computed by Eq 4, and also by the full link model,
//! which includes shear.

pub(crate) mod beam;
pub mod fig2;
pub mod fig3;
pub mod fig4;
pub(crate) mod figure;

pub use beam::{BeamPoint, FORCE_N, LENGTH_M, SIZES_M, WALL_M, library_deflection_m};
