//! Keys of joints and links that arm files and studies have in common.

use super::keys::{
    BEARING_VALUE, COUPLING, GEAR_MASS, JOINT_BODIES, LINK_BODIES, PIECES, POSITIVE_OR_NULL, SECTION, VECTOR,
    WINDUP,
};
use crate::input::key::{Key, Kind, optional, required};

/// The key for the name of an element.
pub(crate) const NAME: Key = required("name", Kind::Name, "-", "Name, unique in the chain.");

/// The key `type` of a joint.
pub(crate) const IS_JOINT: Key = required("type", Kind::Word(&["joint"]), "-", "Says that this is a joint.");

/// The key `type` of a link.
pub(crate) const IS_LINK: Key = required("type", Kind::Word(&["link"]), "-", "Says that this is a link.");

/// The key for the axis of a joint.
pub(crate) const AXIS: Key = required(
    "axis",
    VECTOR,
    "-",
    "Direction in the frame moved by the joints before it; its length does not matter.",
);

/// The key for the torsional stiffness of a joint that has the same stiffness at every torque.
pub(crate) const STIFFNESS: Key = optional(
    "stiffness_nm_per_rad",
    POSITIVE_OR_NULL,
    "N m/rad",
    "the gear's",
    "One stiffness; null is rigid.",
);

/// The key for the torsion curve of a joint.
pub(crate) const TORSION_CURVE: Key =
    optional("windup", Kind::Object(&WINDUP), "-", "the gear's", "The three-segment torsion curve.");

/// The key for the gear of a joint.
pub(crate) const GEAR: Key = optional(
    "gear",
    Kind::Text,
    "-",
    "none",
    "A gear of the catalog; gives curve and mass where they are not written.",
);

/// The key for the motor of a joint.
pub(crate) const MOTOR: Key =
    optional("motor", Kind::Text, "-", "none", "A motor of the catalog; gives its mass.");

/// The key that says which mass of the gear of a joint counts.
pub(crate) const WHICH_GEAR_MASS: Key =
    optional("gear_mass", GEAR_MASS, "-", "\"housed_unit\"", "Which mass of the gear counts.");

/// The key for the output bearing of a joint.
pub(crate) const OUTPUT_BEARING: Key = optional(
    "bearing",
    BEARING_VALUE,
    "-",
    "the gear's, if it is a housed unit",
    "The output bearing: its numbers, the name of a housed gear, or null for a rigid one.",
);

/// The key for the rigid bodies of a joint.
pub(crate) const BODIES_OF_JOINT: Key =
    optional("bodies", JOINT_BODIES, "-", "[]", "Rigid parts with centre and inertia.");

/// The key of a passive joint for the joints that turn it.
pub(crate) const COUPLED: Key = optional(
    "coupled",
    COUPLING,
    "-",
    "none",
    "A passive joint of a linkage: the factors of the driven joints that turn it.",
);

/// The key for the vector of a link from its root to its end.
pub(crate) const LINK_VECTOR: Key =
    required("vector_m", VECTOR, "m", "From root to end, in the frame moved by the joints before it.");

/// The key for the cross-section of a link that is not chosen by a search.
pub(crate) const LINK_SECTION: Key =
    optional("section", SECTION, "-", "none", "The cross-section; without it the link is a rigid offset.");

/// The key for the mass of a rigid offset.
pub(crate) const LINK_MASS: Key =
    optional("mass_kg", Kind::NonNegative, "kg", "0", "Point mass at mid-length of a rigid offset.");

/// The key for the rigid bodies of a link.
pub(crate) const BODIES_OF_LINK: Key =
    optional("bodies", LINK_BODIES, "-", "[]", "Rigid parts with centre and inertia.");

/// The key for the pieces of a link.
pub(crate) const LINK_PIECES: Key =
    optional("pieces", PIECES, "-", "none", "Steps and tapers, instead of a section.");
