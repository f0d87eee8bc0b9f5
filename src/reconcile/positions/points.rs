//! The points on the tools of the arms. A point that was moved between two sessions is listed as two points.

use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::readings::rows::PositionRow;

/// A measured point on the tool of an arm, as the fit sees it. If the point was moved on the tool, each of its
/// sessions has a `Point` of its own.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Point {
    /// Index of the arm in the campaign.
    pub arm: usize,
    /// Name of the point in the readings.
    pub name: String,
    /// If the point belongs to an earlier session: the row, counted from 1, that begins the next session. `None` in the
    /// last session.
    pub before_row: Option<usize>,
}

impl Point {
    /// The point that a row of readings names, in its last session.
    pub(crate) fn of(row: &PositionRow) -> Self {
        Self { arm: row.arm, name: row.point.clone(), before_row: None }
    }

    /// Name of the point for reports. For an earlier session it includes the row that ends the session.
    pub(crate) fn label(&self) -> String {
        match self.before_row {
            Some(row) => format!("{} before row {row}", self.name),
            None => self.name.clone(),
        }
    }
}

/// All points that the readings name, in the order in which they first appear.
pub(crate) fn points(campaign: &Campaign) -> Vec<Point> {
    let mut out: Vec<Point> = Vec::new();
    for point in campaign.positions.iter().map(Point::of) {
        if !out.contains(&point) {
            out.push(point);
        }
    }
    out
}
