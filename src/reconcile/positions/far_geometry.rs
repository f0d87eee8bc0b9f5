//! Links and axes that calibration moved much further than their priors expect. A free geometry can absorb a wrong unit
//! of the positions, or the lengths of another arm.

use super::analysis::Positions;
use super::fitted::Fitted;
use super::kinematics::Number;
use crate::report::number::significant;

/// A link's vector or a joint's axis has moved far if it moved by more than this many standard deviations of its prior.
/// On the measured arms of docs/positions.md none moves by more than one. In a simulated campaign with parallel axes, a
/// transmission error tilted the axes by 2.9 standard deviations.
const FAR_SIGMAS: f64 = 3.0;

/// A link or a joint whose vector or axis was moved by calibration.
struct Move {
    /// Index of the piece.
    piece: usize,
    /// Length of the change of a link's vector \[m\], or angle by which a joint's axis was tilted \[rad\].
    by: f64,
    /// Standard deviation of the prior of each component, in the unit of `by`.
    prior: f64,
    is_link: bool,
}

/// The vectors and axes that moved far if the `numbers` of the geometry moved by `moved`. They are in the order of the
/// numbers.
fn far_moves(numbers: &[Number], moved: &[f64]) -> Vec<Move> {
    let mut all: Vec<Move> = Vec::new();
    for (number, by) in numbers.iter().zip(moved) {
        let (piece, is_link) = match *number {
            Number::Vector(piece, _) => (piece, true),
            Number::Axis(piece, _) => (piece, false),
            _ => continue,
        };
        match all.iter_mut().find(|m| m.piece == piece) {
            Some(known) => known.by = libm::hypot(known.by, *by),
            None => all.push(Move { piece, by: by.abs(), prior: number.prior(), is_link }),
        }
    }
    all.retain(|m| m.by > FAR_SIGMAS * m.prior);
    all
}

impl Fitted {
    /// Whether calibration moved a link's vector or a joint's axis far. `numbers` are the numbers that were fitted.
    pub(super) fn is_far_from_nominal(&self, numbers: &[Number]) -> bool {
        !far_moves(numbers, &self.moved).is_empty()
    }
}

impl Positions {
    /// Whether calibration moved a link's vector or a joint's axis far.
    pub(super) fn has_far_geometry(&self) -> bool {
        self.fitted.is_far_from_nominal(&self.numbers)
    }

    /// A sentence on the links and axes that calibration moved far; `None` if there are none.
    pub(super) fn moved_geometry(&self) -> Option<String> {
        let told = |m: &Move| {
            let name = self.tree.pieces[m.piece].name();
            let (what, scale, unit) = match m.is_link {
                true => ("the vector", 1e3, "mm"),
                false => ("the axis", 1f64.to_degrees(), "deg"),
            };
            let [by, prior] = [m.by, m.prior].map(|x| significant(scale * x, 3));
            format!("{what} of {name} by {by} {unit} (prior {prior} {unit})")
        };
        let far: Vec<String> = far_moves(&self.numbers, &self.fitted.moved).iter().map(told).collect();
        (!far.is_empty()).then(|| {
            format!(
                "calibration moves links or axes much further than their prior expects: {}",
                far.join(", ")
            )
        })
    }
}
