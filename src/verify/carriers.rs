//! The joint to which each piece of the chain is attached.

use super::question::{AskedJoint, AskedPiece, Question};
use crate::arm::LinkBody;

/// The joint inboard of a piece, as far as the bearing or the drive of this joint depends on the piece.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Carrier<'q> {
    /// The nearest joint inboard, if nothing lies between it and the piece; else `None`.
    pub next: Option<&'q AskedJoint>,
    /// The nearest joint inboard, if no tube lies between it and the piece; else `None`. A tube with such a joint
    /// is the link in which the joint's parts must fit.
    pub of_first_tube: Option<&'q AskedJoint>,
}

/// All pieces in order from base to tip, each with the joint inboard of it.
pub(super) fn carriers<'q>(question: &'q Question) -> impl Iterator<Item = (Carrier<'q>, &'q AskedPiece)> {
    let mut carrier = Carrier::default();
    question.pieces.iter().map(move |piece| {
        let here = carrier;
        carrier = match piece {
            AskedPiece::Joint(joint) => Carrier { next: Some(joint), of_first_tube: Some(joint) },
            AskedPiece::Prismatic(_) => Carrier::default(),
            _ if is_tube(piece) => Carrier::default(),
            _ => Carrier { next: None, ..here },
        };
        (here, piece)
    })
}

/// Whether a piece has a cross-section, chosen by the search or given by the study.
pub(super) fn is_tube(piece: &AskedPiece) -> bool {
    match piece {
        AskedPiece::Joint(_) | AskedPiece::Prismatic(_) => false,
        AskedPiece::Choice(_) => true,
        AskedPiece::Link(link) => matches!(link.body, LinkBody::Tube { .. }),
    }
}
