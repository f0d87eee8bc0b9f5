//! The remark that the true lowest mode is lower than the printed one. The printed mode is computed with undivided
//! links. It is too high if a body on a link, between its ends, has its centre of gravity away from the axis of the
//! link (see `src/arm/divided.rs`).

use super::number::{percent, significant};
use crate::arm::Arm;
use crate::arm::load::LoadCase;
use crate::mechanics::chain::Chain;

/// Smallest difference between the two lowest modes that is reported, as a fraction of the printed one.
const REMARKED_SHARE: f64 = 0.005;

/// The lowest mode \[Hz\] of an arm in a case, with every tube divided at the bodies on it. `None` if no tube has a
/// body between its ends.
pub(crate) fn divided_lowest_hz(arm: &Arm, case: &LoadCase) -> Option<f64> {
    let structure = arm.structure_in(case).divided_at_bodies()?;
    let chain = Chain::new(&structure, case.links);
    let posed = chain.pose(case);
    let statics = posed.statics();
    Some(posed.lowest_frequency_hz(&statics))
}

/// The remark for a lowest mode `printed_hz` that is `divided_hz` with divided tubes, in words that continue a name;
/// `None` if the two differ by little.
pub(crate) fn too_high(printed_hz: f64, divided_hz: f64) -> Option<String> {
    let part = (printed_hz - divided_hz) / printed_hz;
    (part > REMARKED_SHARE).then(|| {
        format!(
            "lowest mode {} Hz, {} lower than printed, if its tubes are divided at the bodies on them: the inertia of a \
             body twists a part of its tube only",
            significant(divided_hz, 4),
            percent(100.0 * part, 1)
        )
    })
}
