//! Rows of `gears_efficiency.csv`, and the checks within one row.

use super::row::Row;
use crate::catalog::efficiency::{EfficiencyKind, EfficiencyPoint};

/// The point of an efficiency curve that a row states; `None` if a required cell is blank or not valid.
pub(crate) fn point(row: &Row) -> Option<EfficiencyPoint> {
    let kind = EfficiencyKind::from_word(row.text("kind"));
    if let Some(kind) = kind {
        check(row, kind);
    }
    Some(EfficiencyPoint {
        kind: kind?,
        series: row.filled("series")?.to_string(),
        size: row.count("size"),
        ratio: row.number("ratio"),
        x: row.number("x")?,
        value: row.number("value")?,
        provenance: row.provenance()?,
    })
}

fn check(row: &Row, kind: EfficiencyKind) {
    let unit = row.text("x_unit");
    if !unit.is_empty() && unit != kind.x_unit() {
        row.fault(
            "x_unit",
            format!("\"{unit}\" is not the unit of this kind"),
            &format!("write {}", kind.x_unit()),
        );
    }
    if kind == EfficiencyKind::AgainstInputSpeed {
        for column in ["size", "ratio"].iter().filter(|column| row.text(column).is_empty()) {
            row.fault(column, "is blank", "a curve against input speed belongs to one gear");
        }
    }
}
