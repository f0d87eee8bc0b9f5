//! The columns `outer_diameter_mm`, `length_mm` and `hollow_bore_mm` of gears and motors.

use super::row::{Order, Row};
use crate::catalog::envelope::Envelope;

/// Reads the outer diameter, the length and the bore of a part, and checks them.
pub(crate) fn envelope(row: &Row) -> Envelope {
    let [outer, length, bore] =
        ["outer_diameter_mm", "length_mm", "hollow_bore_mm"].map(|c| (c, row.number(c)));
    for (column, x) in [outer, length] {
        if let Some(x) = x {
            row.within(column, x, [1.0, 5000.0], [5.0, 1000.0], "write mm (1 m = 1000 mm)");
        }
    }
    row.ascending(&[bore, outer], Order::Rising, "the passage lies within the part");
    let metres = |(_, x_mm): (&str, Option<f64>)| x_mm.map(|x| x / 1e3);
    Envelope { outer_diameter_m: metres(outer), length_m: metres(length), hollow_bore_m: metres(bore) }
}
