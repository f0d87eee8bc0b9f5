//! Predictions for every reading of a campaign, and their derivatives with respect to every parameter.
//!
//! The poses are fixed. So [`mechanics`](crate::mechanics) computes once everything that depends on them only: the
//! kinematic twists of all coordinates that an arm can have (an absent effect is a compliance of 0), the parts of the
//! mass matrix, and the torques of dead weight. A [`Subject`](crate::arm::effect::subject::Subject) then enters through
//! its [`Coefficients`]: compliances, joint laws and masses. The prepared quantities are linear in all of these except
//! the joint laws.

mod added_mass;
pub(crate) mod bench;
pub(crate) mod coefficients;
pub(crate) mod datum;
mod dead_weight;
pub(crate) mod modal;
pub(crate) mod prepared;
pub(crate) mod statics;
mod tangents;
mod turned;

pub use coefficients::{Coefficients, Layout};
pub use prepared::Forward;
