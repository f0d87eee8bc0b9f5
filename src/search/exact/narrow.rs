//! Which options a member below a corner may have at all: those whose price the corner can afford when every other
//! part is the cheapest (reduced costs).

use super::corners::Corner;
use super::parts::DriveBox;
use super::price::{Price, TubeNumbers};
use super::problem::Part;
use super::tradeoff::{Plane, ROUNDING, Rows};

/// Boxes of options a level is looked at in, about.
const BOXES: usize = 256;
/// Weightings that count: the strictest.
const STRICTEST: usize = 32;

/// The price of a level's options under a weighting, and what the corner can afford.
type Afforded = (Price, f64);

impl Rows<'_> {
    /// The nodes of each level's whole tree that hold what no weighting excludes; `None` if some level has none.
    pub fn kept(&self, cell: &[u32], planes: &[Plane], corner: &Corner) -> Option<Vec<Vec<u32>>> {
        let mut strict: Vec<(f64, Vec<f64>, &[f64])> = planes
            .iter()
            .map(|plane| {
                let room = self.weighted(&plane.weights, corner) - plane.least + ROUNDING;
                // modes that were added later had no say
                let mut weights = plane.weights.clone();
                weights.resize(self.scale.len(), 0.0);
                (room, weights, &plane.levels[..])
            })
            .collect();
        strict.sort_by(|a, b| a.0.total_cmp(&b.0));
        strict.truncate(STRICTEST);
        let levels = self.problem.level_pieces.iter().enumerate();
        levels
            .map(|(level, &piece)| {
                let afforded: Vec<Afforded> = strict
                    .iter()
                    .map(|(room, weights, levels)| (self.price(piece, weights), levels[level] + room))
                    .collect();
                let kept = self.affordable(piece, cell[level], &afforded);
                (!kept.is_empty()).then_some(kept)
            })
            .collect()
    }

    fn affordable(&self, piece: usize, node: u32, afforded: &[Afforded]) -> Vec<u32> {
        match &self.problem.parts[piece] {
            Part::Drives { tree, .. } => {
                let asked = self.work.least[piece].as_ref();
                tree.kept(node, BOXES, |drives| {
                    asked.is_none_or(|asked| drives.may_hold(asked)) && drives.is_affordable(afforded)
                })
            }
            Part::Links { tree, .. } => tree.kept(node, BOXES, |links| {
                let tube = TubeNumbers::of(links);
                !afforded.iter().any(|(price, most)| price.of_tube(&tube) > *most)
            }),
            _ => Vec::new(),
        }
    }
}

impl DriveBox {
    /// Whether a member may cost no more than can be afforded, at each of some prices.
    fn is_affordable(&self, afforded: &[Afforded]) -> bool {
        let mut left = [0.0; STRICTEST];
        for (left, (price, most)) in left.iter_mut().zip(afforded) {
            *left = most - price.of_mass(self.mass_kg);
        }
        let gears = afforded.first().map_or(&[][..], |(price, _)| &price.joint);
        for (g, gear) in gears.iter().enumerate() {
            let states = self.curve.as_ref().map(|curve| gear.states(curve));
            for (left, (price, _)) in left.iter_mut().zip(afforded) {
                *left -= price.joint[g].best(states.as_ref()).0;
            }
        }
        // what is no number excludes nothing
        !left.iter().any(|left| *left < 0.0)
    }
}
