//! What every number of a study leaves out, so that it can be said beside the numbers.

use crate::space::design_space::{DesignSpace, DriveChoice, SpacePiece};

/// What the numbers of a study with gears leave out, in a sentence or two; `None` if no joint has a gear.
pub(super) fn omissions(space: &DesignSpace) -> Option<String> {
    let has_gear = |piece: &SpacePiece| match piece {
        SpacePiece::Joint(joint) => !matches!(joint.drive, DriveChoice::Given { gear: None, .. }),
        _ => false,
    };
    space.pieces.iter().any(has_gear).then(|| {
        "Left out of every number: the output bearings of the gears (rigid, unless an effect says otherwise, and their \
         moments are not checked), the heat of the motors over a cycle (holding and ramp are checked), and what a joint \
         weighs beyond gear and motor (housing, brake, encoders, flange, cables). The effects bearing_tilt and \
         extra_mass bring bearings and masses in."
            .to_string()
    })
}
