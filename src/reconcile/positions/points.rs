//! The points on the tools of the arms. A point of a separate session is a separate point.

use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::readings::rows::PositionRow;

/// A point on the tool of an arm.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Point {
    /// The arm, in the order of the campaign.
    pub arm: usize,
    /// Its name in the readings.
    pub name: String,
    /// For a session of its own: the row, from 1, before which the session ends.
    pub before_row: Option<usize>,
}

impl Point {
    /// The point of a row.
    pub(crate) fn of(row: &PositionRow) -> Self {
        Self { arm: row.arm, name: row.point.clone(), before_row: None }
    }

    /// Its name, with the session.
    pub(crate) fn label(&self) -> String {
        match self.before_row {
            Some(row) => format!("{} before row {row}", self.name),
            None => self.name.clone(),
        }
    }
}

/// Every point that the readings name, in the order of its first row.
pub(crate) fn points(campaign: &Campaign) -> Vec<Point> {
    let mut out: Vec<Point> = Vec::new();
    for point in campaign.positions.iter().map(Point::of) {
        if !out.contains(&point) {
            out.push(point);
        }
    }
    out
}
