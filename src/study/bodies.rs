//! The remark of a study on rigid bodies with an inertia that no solid can have.

use crate::arm::body::RigidBody;
use crate::report::words::and;
use crate::space::design_space::{DesignSpace, SpacePiece};

/// Names the pieces with a body whose inertia no solid can have, in a sentence; `None` if there is none.
pub(super) fn impossible_bodies_remark(space: &DesignSpace) -> Option<String> {
    let is_impossible = |piece: &&SpacePiece| match piece {
        SpacePiece::Joint(joint) => joint.bodies.iter().any(RigidBody::is_impossible),
        SpacePiece::Prismatic(slide) => slide.joint.bodies.iter().any(RigidBody::is_impossible),
        SpacePiece::Link(link) => link.bodies.iter().any(RigidBody::is_impossible),
        SpacePiece::Choice(choice) => choice.bodies.iter().any(RigidBody::is_impossible),
    };
    let names: Vec<&str> = space.pieces.iter().filter(is_impossible).map(SpacePiece::name).collect();
    (!names.is_empty()).then(|| {
        format!(
            "No solid has the inertia of a body of {}: one principal moment exceeds the sum of the others. It is computed as it \
             stands.",
            and(&names)
        )
    })
}
