//! Warnings about gears that excite the arm. A gear excites the arm twice in each turn of its input. At the critical
//! speed of the input, the frequency of this excitation equals the lowest mode. Picks whose motors cruise near this
//! speed are reported.

use super::front_table::FrontTable;
use super::number::significant;
use super::picks::Pick;

/// A warning is given if the cruising speed is within this fraction of the critical speed.
const NEAR_CRITICAL_SPEED: f64 = 0.15;

/// Warnings for the picks of a front in words, one for each joint and pick near resonance.
pub(crate) fn warnings(front: &FrontTable, picks: &[Pick]) -> Vec<String> {
    let joints = front.columns.iter().filter_map(|column| column.strip_suffix("_critical_rpm"));
    joints.flat_map(|joint| picks.iter().filter_map(move |pick| warning(front, joint, pick))).collect()
}

fn warning(front: &FrontTable, joint: &str, pick: &Pick) -> Option<String> {
    let number = |what: &str| front.numbers(&format!("{joint}_{what}"))[pick.design.row];
    let (cruising_rpm, critical_rpm) = (number("input_rpm")?, number("critical_rpm")?);
    let apart = cruising_rpm / critical_rpm - 1.0;
    (apart.abs() < NEAR_CRITICAL_SPEED).then(|| {
        format!(
            "{} ({}): the motor of {joint} cruises at {cruising_rpm:.0} rpm, {} % {} the {critical_rpm:.0} rpm at which its \
             gear excites the lowest mode",
            pick.names.join(", "),
            pick.design.design_id,
            significant(100.0 * apart.abs(), 2),
            if apart < 0.0 { "below" } else { "above" },
        )
    })
}
