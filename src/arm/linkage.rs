//! Passive joints: which joints drive them, and how far each is turned.

use super::structure::{JointAngle, Piece, Structure};

/// One driver of a passive joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Linkage {
    /// The joint that drives.
    pub driver: String,
    /// The passive joint.
    pub passive: String,
    /// Turn of the passive joint per turn of the driver.
    pub factor: f64,
}

/// Every driver of every passive joint.
pub fn linkages(structure: &Structure) -> Vec<Linkage> {
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
