//! What is around an arm: the environments in which each pose of a study is taken.

use crate::arm::load::Water;
use crate::input::json::Node;

/// What is around the arm.
#[derive(Debug, Clone, Default)]
pub(super) struct Environment {
    /// Appended to the names of poses.
    pub name: String,
    /// The water, if the arm is in some.
    pub water: Option<Water>,
}

pub(super) fn read_environments(node: &Node) -> Option<Vec<Environment>> {
    let items = node.array()?;
    if items.is_empty() {
        return node.fault("is empty", "name what the arm is in, or leave it away for air");
    }
    let read: Vec<_> = items
        .iter()
        .map(|n| {
            let object = n.object(&["name", "water"])?;
            let name = object.required("name").and_then(|n| n.string().map(String::from));
            let water = object.or("water", None, |n| Water::read(n).map(Some));
            Some(Environment { name: name?, water: water? })
        })
        .collect();
    read.into_iter().collect()
}
