//! Structures whose links are divided at the bodies on them.
//!
//! The strains of a link are smooth along its length (see [`crate::mechanics::beam`]). A body beside the axis of a link
//! twists the link inboard of it and not outboard of it, so the twist rate has a step at the body. Smooth strains hold a
//! part of such a step only: the deflection of the tip is exact, but the frequency of a mode in which the body swings
//! about the link comes out too high, by up to 6 %. Where the link is divided at the body, the step lies between two
//! links, and the frequency is right.

use super::structure::{FrameCompliance, LinkPiece, Piece, Structure};

/// Smallest distance between two divisions, and to the ends of a link, relative to the length of the link.
const NEAREST: f64 = 1e-3;

impl Structure {
    /// This structure with every tube divided where a body moves with it. `None` if no body is between the ends of a
    /// tube, or if the structure has springs, which refer to its pieces by their index.
    pub(crate) fn divided_at_bodies(&self) -> Option<Structure> {
        if !self.springs.is_empty() {
            return None;
        }
        let divided = |piece: &Piece| match piece {
            Piece::Link(link) => link.divided_at_bodies().into_iter().map(Piece::Link).collect(),
            joint => vec![joint.clone()],
        };
        let pieces: Vec<Piece> = self.pieces.iter().flat_map(divided).collect();
        (pieces.len() > self.pieces.len()).then(|| Structure { pieces, ..self.clone() })
    }
}

impl LinkPiece {
    /// The parts of this link, from root to end: one part if it is no tube, or has no body between its ends.
    fn divided_at_bodies(&self) -> Vec<LinkPiece> {
        let length2_m2 = self.vector_m.norm_squared();
        if self.beam.is_none() || length2_m2 == 0.0 {
            return vec![self.clone()];
        }
        // the point of the axis with which a body moves is the nearest to its centre of gravity
        let places = self.bodies.iter().map(|body| self.vector_m.dot(&body.cg_m) / length2_m2);
        let mut cuts: Vec<f64> = places.clone().filter(|xi| (NEAREST..1.0 - NEAREST).contains(xi)).collect();
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|next, before| *next - *before < NEAREST);
        let starts: Vec<f64> = [0.0].into_iter().chain(cuts).collect();
        let part_of = |xi: f64| starts.iter().rposition(|start| *start <= xi).unwrap_or_default();
        let parts = starts.iter().enumerate().map(|(i, &start)| {
            let end = starts.get(i + 1).copied().unwrap_or(1.0);
            let own = self.bodies.iter().zip(places.clone()).filter(|(_, xi)| part_of(*xi) == i);
            LinkPiece {
                name: if i == 0 { self.name.clone() } else { format!("{}, part {}", self.name, i + 1) },
                vector_m: self.vector_m * (end - start),
                bodies: own
                    .map(|(body, _)| super::body::RigidBody {
                        cg_m: body.cg_m - self.vector_m * start,
                        ..*body
                    })
                    .collect(),
                root_frame: if i == 0 { self.root_frame } else { FrameCompliance::default() },
                ..self.clone()
            }
        });
        parts.collect()
    }
}
