//! Sessions of absolute positions that `campaign.json` declares. Each begins at a row, before which a point was moved
//! on the tool, or the base of the arm or the instrument was moved.

use super::keys::SESSION;
use super::rows::PositionRow;
use crate::arm::BASE;
use crate::input::json::Node;

/// A session (a run of readings between two changes of the set-up) that `campaign.json` declares.
#[derive(Debug, Clone, PartialEq)]
pub struct DeclaredSession {
    /// Number of the first row of the session. The first row of the file below the column names has the number 1.
    pub from_row: usize,
    /// What was moved before this row: the name of a point, or `base` if it was the base of the arm or the instrument.
    pub moved: String,
}

impl DeclaredSession {
    /// The same session after `rows` other rows were put in front of its file: its row number grows by `rows`.
    pub(super) fn after(self, rows: usize) -> Self {
        Self { from_row: self.from_row + rows, ..self }
    }
}

/// Reads the list `positions.sessions` of `campaign.json`. Returns `None` after recording a fault.
pub(super) fn read(node: &Node) -> Option<Vec<DeclaredSession>> {
    let session = |n: &Node| {
        let object = n.shaped(&SESSION)?;
        let row = object.required("from_row")?;
        let from_row = match row.number()? {
            x if x >= 2.0 && x.fract() == 0.0 => Some(x as usize),
            x => row.fault(format!("= {x} begins no session"), "give the number of a row, 2 or more"),
        };
        let moved = object.required("moved")?.string().map(String::from);
        Some(DeclaredSession { from_row: from_row?, moved: moved? })
    };
    let sessions: Vec<Option<DeclaredSession>> = node.array()?.iter().map(session).collect();
    sessions.into_iter().collect()
}

/// Faults of declared sessions that show only when they are compared with the rows of positions: a row that does not
/// exist, or a point that is not measured. Each fault is a problem and a hint. Empty if there is none.
pub(super) fn problems(sessions: &[DeclaredSession], rows: &[PositionRow]) -> Vec<(String, String)> {
    let mut points: Vec<&str> = rows.iter().map(|row| row.point.as_str()).collect();
    points.sort_unstable();
    points.dedup();
    let mut out = Vec::new();
    for DeclaredSession { from_row, moved } in sessions {
        if *from_row > rows.len() {
            out.push((
                format!("from_row = {from_row} is beyond the {} rows", rows.len()),
                "count the rows".into(),
            ));
        }
        if moved != BASE && !points.contains(&moved.as_str()) {
            let hint = format!("write \"{BASE}\" or the name of a point: {}", points.join(", "));
            out.push((format!("moved = \"{moved}\" is no point"), hint));
        }
    }
    out
}
