//! Effects: physics that the nominal model of an arm leaves out. An effect changes the
//! [`Structure`](super::structure::Structure) on which the mechanics works, so statics, modes and search all include
//! it.
//!
//! Each effect has a file here with its [`Kind`]. A kind states the name of the effect, the places where it can be, and
//! its parameters with unit, limits and typical values. It also states how the effect changes a [`Subject`] (an arm
//! under test), and properties for the search for effects. [`KINDS`] lists all kinds; no other module has a list of
//! effects. Effects of the payload or of a measuring channel describe a test and not the product. Only `predict` and
//! `reconcile` use them.

pub(crate) mod base_compliance;
pub(crate) mod base_lift;
pub(crate) mod bearing_tilt;
pub(crate) mod catalogue;
pub(crate) mod channel;
pub(crate) mod connection_compliance;
pub(crate) mod drift;
pub(crate) mod empirical;
pub(crate) mod entry;
pub(crate) mod extra_mass;
pub(crate) mod frame_compliance;
pub(crate) mod guide_tilt;
pub(crate) mod harness_mass;
pub(crate) mod hysteresis;
pub(crate) mod immersion;
pub(crate) mod joint_compliance;
pub(crate) mod joint_torque;
pub mod kind;
pub(crate) mod link_flexibility;
pub(crate) mod lost_motion;
pub(crate) mod modulus_error;
pub(crate) mod outlier;
pub(crate) mod payload_cg_error;
pub(crate) mod payload_mass_error;
pub(crate) mod places;
pub(crate) mod sensor_bias;
pub(crate) mod sensor_gain;
pub(crate) mod servo_compliance;
pub(crate) mod setup;
pub(crate) mod soft_windup;
pub(crate) mod stiffness_waves;
pub(crate) mod subject;
pub(crate) mod test_mass;
pub(crate) mod thermal_modulus;
pub(crate) mod time_shift;
pub(crate) mod transmission_error;
pub(crate) mod travel_compliance;
pub(crate) mod validate;
pub(crate) mod warming;
pub(crate) mod waves;
pub(crate) mod wrong_unit;

pub use catalogue::{KINDS, kind};
pub use channel::{Channel, Reading};
pub use entry::Effect;
pub use kind::{Kind, Parameter, Place, Scale, Scope};
pub use setup::{Event, LoadTwist, Loading, Setup, Slipped, Turned};
pub use subject::Subject;
pub use validate::{EffectFault, fits_nominal};
pub use warming::{Moment, Softening, Warming};
pub use waves::{transmission_rad, transmission_waves};
pub use wrong_unit::{SLIPS as UNIT_SLIPS, UnitColumn, UnitSlip};
