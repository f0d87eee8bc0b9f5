//! Keys that joints and links have in common: name and axis.

use super::load::vector;
use crate::input::json::{Node, Object};
use nalgebra::{Unit, Vector3};

/// Reads the name of an element. Returns `None` after recording a fault.
pub(crate) fn read_name(object: &Object) -> Option<String> {
    let node = object.required("name")?;
    match node.string()? {
        "" => node.fault("is empty", "give every element a name"),
        name => Some(name.to_string()),
    }
}

/// Reads the direction of an axis. The length of the vector does not matter. Returns `None` after recording a fault.
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

/// Reads the drivers of a passive joint, each with its factor. Returns `None` after recording a fault.
pub(crate) fn read_coupling(node: &Node) -> Option<Vec<(String, f64)>> {
    let read: Vec<_> =
        node.entries()?.iter().map(|(name, n)| n.number().map(|f| (name.to_string(), f))).collect();
    read.into_iter().collect()
}
