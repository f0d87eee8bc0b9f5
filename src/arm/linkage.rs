//! Linkages: which joints drive a passive joint, and how far each of them turns it.

use super::structure::{JointAngle, Piece, Structure};

/// One driver of a passive joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Linkage {
    /// Name of the joint that drives.
    pub driver: String,
    /// Name of the passive joint.
    pub passive: String,
    /// Rotation of the passive joint per rotation of the driver.
    pub factor: f64,
}

/// The linkages of an arm: every driver of every passive joint.
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
