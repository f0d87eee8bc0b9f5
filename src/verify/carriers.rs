//! Which joint carries a piece of the chain.

use super::question::{AskedJoint, AskedPiece, Question};
use crate::arm::LinkBody;

/// The joints that a piece has to do with.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Carrier<'q> {
    /// The joint next to it inboard, if nothing is in between.
    pub next: Option<&'q AskedJoint>,
    /// The joint that carries it, if no tube is in between.
    pub of_first_tube: Option<&'q AskedJoint>,
}

/// Every piece with the joints inboard of it.
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

/// Whether a piece has a section, chosen or given.
pub(super) fn is_tube(piece: &AskedPiece) -> bool {
    match piece {
        AskedPiece::Joint(_) | AskedPiece::Prismatic(_) => false,
        AskedPiece::Choice(_) => true,
        AskedPiece::Link(link) => matches!(link.body, LinkBody::Tube { .. }),
    }
}
