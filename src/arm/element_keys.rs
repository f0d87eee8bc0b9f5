//! Keys of joints and links that arm files and studies have in common, and the readers of name, axis and coupling.

use super::keys::{
    BEARING_VALUE, COUPLING, GEAR_MASS, JOINT_BODIES, LINK_BODIES, PIECES, POSITIVE_OR_NULL, SECTION, VECTOR,
    WINDUP,
};
use super::load::vector;
use crate::input::json::{Node, Object};
use crate::input::key::{Key, Kind, optional, required};
use nalgebra::{Unit, Vector3};

/// Name of an element.
pub(crate) const NAME: Key = required("name", Kind::Name, "-", "Name, unique in the chain.");

/// The word that makes an element a joint.
pub(crate) const IS_JOINT: Key = required("type", Kind::Word(&["joint"]), "-", "Says that this is a joint.");

/// The word that makes an element a link.
pub(crate) const IS_LINK: Key = required("type", Kind::Word(&["link"]), "-", "Says that this is a link.");

/// Axis of a joint.
pub(crate) const AXIS: Key = required(
    "axis",
    VECTOR,
    "-",
    "Direction in the frame moved by the joints before it; its length does not matter.",
);

/// One stiffness of a joint.
pub(crate) const STIFFNESS: Key = optional(
    "stiffness_nm_per_rad",
    POSITIVE_OR_NULL,
    "N m/rad",
    "the gear's",
    "One stiffness; null is rigid.",
);

/// Torsion curve of a joint.
pub(crate) const TORSION_CURVE: Key =
    optional("windup", Kind::Object(&WINDUP), "-", "the gear's", "The three-segment torsion curve.");

/// Gear of a joint.
pub(crate) const GEAR: Key = optional(
    "gear",
    Kind::Text,
    "-",
    "none",
    "A gear of the catalog; gives curve and mass where they are not written.",
);

/// Motor of a joint.
pub(crate) const MOTOR: Key =
    optional("motor", Kind::Text, "-", "none", "A motor of the catalog; gives its mass.");

/// Which mass of the gear of a joint counts.
pub(crate) const WHICH_GEAR_MASS: Key =
    optional("gear_mass", GEAR_MASS, "-", "\"housed_unit\"", "Which mass of the gear counts.");

/// Output bearing of a joint.
pub(crate) const OUTPUT_BEARING: Key = optional(
    "bearing",
    BEARING_VALUE,
    "-",
    "the gear's, if it is a housed unit",
    "The output bearing: its numbers, the name of a housed gear, or null for a rigid one.",
);

/// Rigid parts of a joint.
pub(crate) const BODIES_OF_JOINT: Key =
    optional("bodies", JOINT_BODIES, "-", "[]", "Rigid parts with centre and inertia.");

/// How the joints of a linkage turn a passive one.
pub(crate) const COUPLED: Key = optional(
    "coupled",
    COUPLING,
    "-",
    "none",
    "A passive joint of a linkage: the factors of the driven joints that turn it.",
);

/// A link from its root to its end.
pub(crate) const LINK_VECTOR: Key =
    required("vector_m", VECTOR, "m", "From root to end, in the frame moved by the joints before it.");

/// Cross-section of a link that is not chosen by a search.
pub(crate) const LINK_SECTION: Key =
    optional("section", SECTION, "-", "none", "The cross-section; without it the link is a rigid offset.");

/// Mass of a rigid offset.
pub(crate) const LINK_MASS: Key =
    optional("mass_kg", Kind::NonNegative, "kg", "0", "Point mass at mid-length of a rigid offset.");

/// Rigid parts of a link.
pub(crate) const BODIES_OF_LINK: Key =
    optional("bodies", LINK_BODIES, "-", "[]", "Rigid parts with centre and inertia.");

/// Pieces of a link.
pub(crate) const LINK_PIECES: Key =
    optional("pieces", PIECES, "-", "none", "Steps and tapers, instead of a section.");

/// Reads the name of an element.
pub(crate) fn read_name(object: &Object) -> Option<String> {
    let node = object.required("name")?;
    match node.string()? {
        "" => node.fault("is empty", "give every element a name"),
        name => Some(name.to_string()),
    }
}

/// Reads the direction of an axis. The length of the vector does not matter.
pub(crate) fn read_axis(node: &Node) -> Option<Unit<Vector3<f64>>> {
    let axis = vector(node)?;
    if (axis.norm_squared() - 1.0).abs() <= 4.0 * f64::EPSILON {
        // a vector of unit length is kept unchanged to the last bit, so that an arm that is written and read again is
        // the same
        return Some(Unit::new_unchecked(axis));
    }
    // divided by its largest entry first, because very long and very short vectors have a direction too
    let largest = axis.amax();
    let direction = if largest > 0.0 { Unit::try_new(axis / largest, 0.5) } else { None };
    direction.or_else(|| {
        node.fault("has no direction", "give a vector such as [0, 1, 0]; its length does not matter")
    })
}

/// Reads the drivers of a passive joint, each with its factor.
pub(crate) fn read_coupling(node: &Node) -> Option<Vec<(String, f64)>> {
    let read: Vec<_> =
        node.entries()?.iter().map(|(name, n)| n.number().map(|f| (name.to_string(), f))).collect();
    read.into_iter().collect()
}
