//! Remarks on the screws and racks of a study: what is not checked because their rows leave it blank, and what their
//! lives leave out.

use crate::catalog::gear::{Gear, GearKind};
use crate::space::design_space::{DesignSpace, SpacePiece};

/// The sentence on lives of screws. It states the cubes of the load factor f_w of 1.2 to 1.5, by which the life (C_a /
/// (f_w F))³ of a ball screw is divided: THK, general catalog, ball screws, "Studying the service life" (for slight
/// shocks and 0.25 to 1 m/s).
const SMOOTH: &str = "The lives of screws are those of smooth motion: with the load factor of 1.2 to 1.5 that makers ask for in \
    usual motion they are 1.7 to 3.4 times shorter.";

/// Remarks on every screw and rack that the study offers.
pub(super) fn rail_remarks(space: &DesignSpace) -> Vec<String> {
    let mut out = Vec::new();
    let mut has_lives = false;
    for piece in &space.pieces {
        let SpacePiece::Prismatic(rail) = piece else { continue };
        let Some(drive) = &rail.drive else { continue };
        let names = |is_meant: fn(&Gear) -> bool| -> Option<String> {
            let meant: Vec<&str> =
                drive.gears.iter().filter(|gear| is_meant(gear)).map(|gear| gear.id.as_str()).collect();
            (!meant.is_empty()).then(|| meant.join(", "))
        };
        let joint = &rail.joint.name;
        out.extend(names(lacks_life).map(|names| {
            format!("Joint {joint}: the life of {names} is not checked: no dynamic_load_rating_n.")
        }));
        out.extend(
            names(lacks_force).map(|names| {
                format!("Joint {joint}: the strength of {names} is not checked: no max_force_n.")
            }),
        );
        has_lives |= drive.gears.iter().any(|gear| gear.kind == GearKind::Screw && !lacks_life(gear));
    }
    out.extend(has_lives.then(|| SMOOTH.to_string()));
    out
}

fn lacks_life(gear: &Gear) -> bool {
    gear.kind == GearKind::Screw && gear.life.rated_h.is_none()
}

fn lacks_force(gear: &Gear) -> bool {
    gear.momentary_peak_torque_nm.is_none()
}
