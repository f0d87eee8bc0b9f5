//! The model's values for every reading of a campaign, and how they change with every parameter.
//!
//! The poses are fixed, so [`mechanics`](crate::mechanics) prepares once all that depends on them: the twists of
//! all coordinates an arm can have (an absent effect is a compliance of 0), the parts of the mass matrix, the
//! torques of dead weight. A [`Subject`](crate::arm::effect::subject::Subject) then enters through its [`Coefficients`]:
//! compliances, laws of the joints and masses. The prepared model is linear in all of these but the laws.

mod added_mass;
pub(crate) mod bench;
pub(crate) mod coefficients;
pub(crate) mod datum;
pub(crate) mod modal;
pub(crate) mod prepared;
pub(crate) mod statics;

pub use coefficients::{Coefficients, Layout};
pub use prepared::Forward;
