//! Linkages: which driven joints turn a passive joint, and by which factor.

use super::structure::{JointAngle, Piece, Structure};

/// The connection between a passive joint and one of the joints that drive it.
#[derive(Debug, Clone, PartialEq)]
pub struct Linkage {
    /// Name of the driving joint.
    pub driver: String,
    /// Name of the passive joint.
    pub passive: String,
    /// Rotation of the passive joint divided by rotation of the driving joint.
    pub factor: f64,
}

/// The linkages of an arm, one for each pair of a passive joint and one of its driving joints.
pub(crate) fn linkages(structure: &Structure) -> Vec<Linkage> {
    let driver = |index: usize| {
        structure.joints().find(|j| j.angle == JointAngle::Driven(index)).map(|j| j.name.clone())
    };
    let mut out = Vec::new();
    for piece in &structure.pieces {
        if let Piece::Joint(joint) = piece
            && let JointAngle::Coupled(terms) = &joint.angle
        {
            let of = |(index, factor): &(usize, f64)| {
                Some(Linkage { driver: driver(*index)?, passive: joint.name.clone(), factor: *factor })
            };
            out.extend(terms.iter().filter_map(of));
        }
    }
    out
}
