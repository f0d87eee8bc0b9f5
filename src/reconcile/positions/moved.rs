//! What can be moved between two sessions, and the boundary at which a session begins.

use super::fitted::Sample;
use super::kinematics::Number;

/// Label of the rows of a session: which point on the tool, or which set-up of instrument and base, has a placement
/// of its own in these rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Moved {
    /// A point on the tool, by its index among the points.
    Point(usize),
    /// The instrument or the base, by the index of the session that sets its place.
    Station(usize),
}

impl Moved {
    pub(super) fn has(self, sample: &Sample) -> bool {
        match self {
            Moved::Point(p) => sample.point == p,
            Moved::Station(s) => sample.station == s,
        }
    }

    /// Gives the label `new` to those samples before the row `first` that have this label.
    pub(super) fn relabel(self, samples: &mut [Sample], first: usize, new: Moved) {
        for sample in samples[..first].iter_mut().filter(|s| self.has(s)) {
            match new {
                Moved::Point(p) => sample.point = p,
                Moved::Station(s) => sample.station = s,
            }
        }
    }

    pub(super) fn numbers(self) -> Vec<Number> {
        match self {
            Moved::Point(p) => (0..3).map(|c| Number::Tool(p, c)).collect(),
            Moved::Station(s) => {
                let turns = (0..3).map(move |c| Number::SessionRotation(s, c));
                turns.chain((0..3).map(move |c| Number::SessionPosition(s, c))).collect()
            }
        }
    }
}

/// What was moved between two sessions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    /// A point on the tool, by its index among the points. A point has one index for each of its sessions, and any of
    /// these indices may be given.
    Point(usize),
    /// The instrument or the base.
    Station,
}

impl Kind {
    /// Label of the session to which a sample belongs, as far as this kind of move is concerned.
    pub(super) fn label(self, sample: &Sample) -> Moved {
        match self {
            Kind::Point(_) => Moved::Point(sample.point),
            Kind::Station => Moved::Station(sample.station),
        }
    }
}

/// The boundary between two sessions.
#[derive(Debug, Clone)]
pub(crate) struct Boundary {
    /// What was moved at the boundary.
    pub kind: Kind,
    /// Label of the rows before the boundary.
    pub earlier: Moved,
    /// First row of the later session, counted from 0.
    pub first: usize,
    /// Whether campaign.json declares the session; otherwise it was found in the readings.
    pub declared: bool,
}
