//! What is left of a box below a corner: the weightings that refute it, or else the options that they leave, where to
//! part them, and designs that may be there.

use super::bound::{Ceiling, Cell, Work};
use super::corners::Corner;
use super::parting::Parting;
use super::problem::Problem;
use super::tradeoff::{Member, Plane, ROUNDING, Rows, Trade};

/// Weightings of several rows, and new sets of shapes, at the most for one box.
const MOST_PLANES: usize = 24;
const MOST_SHAPES: usize = 3;
/// Weightings once no more than the options may be narrowed.
const TO_NARROW: usize = 8;
/// The best weighting found is as good as any if the game promises no more than this beyond it.
const SETTLED: f64 = 1e-4;
/// Shares of a mixture below this are rounding.
const SHARE: f64 = 1e-9;

/// What is left of a box below a corner.
pub(super) struct Left {
    /// The nodes of each level's whole tree that hold every option a member below the corner may have.
    pub kept: Vec<Vec<u32>>,
    /// Where to part them, the most promising first.
    pub partings: Vec<Parting>,
    /// Designs that may be below the corner.
    pub likely: Vec<Cell>,
}

impl Problem<'_> {
    /// What is left of a box, whose numbers are in `work`, below a corner; `None` if no member is.
    pub fn left_below(
        &self,
        cell: &[u32],
        ceiling: &Ceiling,
        trade: &mut Trade,
        work: &Work,
        corner: &Corner,
    ) -> Option<Left> {
        let mut rows = Rows::new(self, cell, ceiling, corner, &trade.shapes, work);
        let (mut planes, mut members) = (Vec::<Plane>::new(), Vec::<Member>::new());
        let mut starts = rows.singles(corner);
        let most = starts.len() + MOST_PLANES;
        starts.push(rows.inherited(&trade.weights));
        let (mut new_shapes, mut to_narrow, mut nearest) = (0, 0, f64::NEG_INFINITY);
        let game = loop {
            let weights = match starts.pop() {
                Some(weights) => weights,
                None => {
                    let game = rows.game(&members, corner);
                    if game.value <= ROUNDING && new_shapes < MOST_SHAPES {
                        new_shapes += 1;
                        if rows.separate(&mut members, &game.mix, corner) {
                            continue;
                        }
                    }
                    to_narrow += usize::from(game.value <= ROUNDING);
                    if planes.len() >= most || to_narrow > TO_NARROW || game.value <= nearest + SETTLED {
                        break game;
                    }
                    game.weights
                }
            };
            let (plane, member) = rows.least(cell, weights);
            let above = plane.least - rows.weighted(&plane.weights, corner);
            if above > ROUNDING {
                return None;
            }
            nearest = nearest.max(above);
            planes.push(plane);
            members.push(member);
        };
        let mixed: Vec<(&Member, f64)> =
            members.iter().zip(game.mix.iter().copied()).filter(|(_, share)| *share > SHARE).collect();
        let left = Left {
            kept: rows.kept(cell, &planes, corner)?,
            partings: rows.partings(&mixed, &game.weights),
            likely: mixed.iter().map(|(member, _)| member.cell.clone()).collect(),
        };
        rows.bequeath(&game.weights, trade);
        Some(left)
    }
}
