//! Warnings of numbers that no gear or actuator has, because they are in another unit than their column states.
//!
//! The sizes of gears differ by orders of magnitude, so each number is compared with another number of the same row.
//! The comparisons, with the values in all rows of the built-in catalogs, are:
//!
//! - the twist T / k of a gear under its rated torque T: 1 to 13 arcmin;
//! - the tilt of its output bearing under the permissible moment: 0.6 to 3.2 arcmin;
//! - the tilt of its output bearing under the rated torque: 0.15 to 1.5 arcmin;
//! - the radius of gyration sqrt(J/m) of its turning parts: 1 to 23 mm.
//!
//! The usual ranges in this file are several times wider, yet narrower than the factors between units (1 N m/arcmin =
//! 3438 N m/rad, 1 N m/deg = 57 N m/rad, 1 kg cm2 = 1e-4 kg m2).

use super::row::Row;
use crate::catalog::gear::GearKind;
use std::f64::consts::PI;

const ARCMIN_PER_RAD: f64 = 10_800.0 / PI;
/// Usual twist of a gear under its rated torque \[arcmin\].
const TWIST_ARCMIN: [f64; 2] = [0.1, 50.0];
/// Usual tilt of an output bearing under its permissible moment \[arcmin\].
const TILT_ARCMIN: [f64; 2] = [0.05, 20.0];
/// Usual tilt of an output bearing under a moment as large as the rated torque \[arcmin\]. A small gear may have a
/// large bearing, so the lower limit is much lower than that of [`TILT_ARCMIN`].
const TILT_BY_TORQUE_ARCMIN: [f64; 2] = [0.002, 30.0];
/// Largest angle by which a gear twists, or its bearing tilts, under its own rating \[arcmin\]: 1 rad.
const POSSIBLE_ARCMIN: f64 = ARCMIN_PER_RAD;
/// Usual radius of gyration of the turning parts \[m\]. It is computed with the mass of the whole gear, because the
/// mass of its turning parts is not known.
const GYRATION_M: [f64; 2] = [3e-4, 0.06];
/// Usual pitch diameters of output bearings \[m\].
const PITCH_M: [f64; 2] = [0.005, 1.0];

const STIFFNESS_UNITS: &str =
    "a slip of unit? (1 N m/arcmin = 3438 N m/rad, 1 N m/deg = 57.3 N m/rad, 1e4 N m/rad = 10000 N m/rad)";

/// The columns of the torques for which a gear is rated, from the smallest to the largest.
pub(super) const TORQUES: [&str; 4] =
    ["rated_torque_nm", "average_torque_limit_nm", "repeated_peak_torque_nm", "momentary_peak_torque_nm"];

/// Warns of stiffnesses, a pitch diameter or an inertia of a gear that are far from those of all known gears. A
/// stiffness by which the gear twists more than 1 rad under its own rating is a fault. The stiffness of a direct drive
/// has no upper limit. The pitch diameter and the inertia of strain-wave gears are compared with their size instead,
/// for which the usual ranges are narrower.
pub(super) fn of_gear(row: &Row, kind: GearKind) {
    angles(row, rating(row, &TORQUES), kind == GearKind::Direct);
    if kind == GearKind::StrainWave {
        return;
    }
    pitch(row);
    if let Some(inertia_kgm2) = row.number("inertia_input_kgm2") {
        let mass_kg = row.number("mass_housed_unit_kg").or(row.number("mass_component_set_kg"));
        gyration(row, "inertia_input_kgm2", inertia_kgm2, mass_kg);
    }
}

/// Warns of numbers of an actuator as [`of_gear`] does of a gear. The inertia at the output is compared only if the row
/// states the ratio, from which the inertia of the rotor follows.
pub(super) fn of_actuator(row: &Row) {
    angles(row, rating(row, &["rated_torque_nm", "peak_torque_nm"]), false);
    pitch(row);
    if let (Some(inertia_kgm2), Some(ratio)) = (row.number("inertia_output_kgm2"), row.number("ratio")) {
        gyration(row, "inertia_output_kgm2", inertia_kgm2 / (ratio * ratio), row.number("mass_kg"));
    }
}

/// The first of the columns that the row fills, with its number; `None` if the row fills none of them.
fn rating(row: &Row, columns: &[&'static str]) -> Option<(&'static str, f64)> {
    columns.iter().find_map(|column| Some((*column, row.number(column)?)))
}

fn angles(row: &Row, torque: Option<(&str, f64)>, may_be_rigid: bool) {
    let above = |[low, high]: [f64; 2]| [if may_be_rigid { 0.0 } else { low }, high];
    if let Some(torque) = torque {
        for column in ["k1_nm_per_rad", "k2_nm_per_rad", "k3_nm_per_rad"] {
            angle(row, column, torque, above(TWIST_ARCMIN));
        }
    }
    let moment = row.number("permissible_tilting_moment_nm").map(|nm| ("permissible_tilting_moment_nm", nm));
    match (moment, torque) {
        (Some(moment), _) => angle(row, "tilting_stiffness_nm_per_rad", moment, TILT_ARCMIN),
        (None, Some(torque)) => {
            angle(row, "tilting_stiffness_nm_per_rad", torque, above(TILT_BY_TORQUE_ARCMIN));
        }
        (None, None) => {}
    }
}

fn pitch(row: &Row) {
    if let Some(pitch_m) = row.number("bearing_pitch_diameter_m").filter(|x| !in_range(*x, PITCH_M)) {
        let problem = format!("= {pitch_m} is outside {} to {} m", PITCH_M[0], PITCH_M[1]);
        row.warn("bearing_pitch_diameter_m", problem, "a slip of unit? (1 mm = 0.001 m)");
    }
}

/// Compares an angle with the range `usual` \[arcmin\]. The angle is the load `load_nm` \[N m\], whose column is
/// `load`, divided by the stiffness in the column `column`.
fn angle(row: &Row, column: &str, (load, load_nm): (&str, f64), usual: [f64; 2]) {
    let Some(stiffness_nm_per_rad) = row.number(column) else { return };
    let arcmin = ARCMIN_PER_RAD * load_nm / stiffness_nm_per_rad;
    let given = format!("= {stiffness_nm_per_rad} gives {arcmin:.3e} arcmin under {load} = {load_nm}");
    if arcmin > POSSIBLE_ARCMIN {
        row.fault(column, format!("{given}, more than 1 rad"), STIFFNESS_UNITS);
    } else if !in_range(arcmin, usual) {
        row.warn(column, given, &format!("usual: {} to {} arcmin; {STIFFNESS_UNITS}", usual[0], usual[1]));
    }
}

fn gyration(row: &Row, column: &str, inertia_kgm2: f64, mass_kg: Option<f64>) {
    let Some(mass_kg) = mass_kg.filter(|_| inertia_kgm2 > 0.0) else { return };
    let radius_m = (inertia_kgm2 / mass_kg).sqrt();
    if !in_range(radius_m, GYRATION_M) {
        let problem = format!(
            "= {} gives sqrt(J/m) = {radius_m:.3e} m at the input",
            row.number(column).unwrap_or(0.0)
        );
        let [low, high] = GYRATION_M;
        let hint = format!("usual: {low} to {high} m; a slip of unit? (1 kg cm2 = 1e-4 kg m2)");
        row.warn(column, problem, &hint);
    }
}

fn in_range(x: f64, [low, high]: [f64; 2]) -> bool {
    (low..=high).contains(&x)
}

#[cfg(test)]
mod tests {
    use crate::catalog::CatalogFile;
    use crate::catalog::read::log::Log;
    use crate::catalog::read::table::rows;
    use crate::catalog::read::{actuators, gears};

    const GEAR: &str = "kind,series,size,ratio,rated_torque_nm,inertia_input_kgm2,mass_housed_unit_kg,t1_nm,t2_nm,\
        k1_nm_per_rad,k2_nm_per_rad,k3_nm_per_rad,tilting_stiffness_nm_per_rad,permissible_tilting_moment_nm,\
        bearing_pitch_diameter_m,source,confidence";
    const ACTUATOR: &str = "model,ratio,rated_torque_nm,peak_torque_nm,inertia_output_kgm2,mass_kg,k1_nm_per_rad,\
        tilting_stiffness_nm_per_rad,bearing_pitch_diameter_m,source,confidence";

    /// The columns of one row that have faults, and those that have warnings.
    fn found(file: CatalogFile, header: &str, figures: &str) -> [Vec<String>; 2] {
        let log = Log::default();
        let text = format!("{header}\n{figures},a test,verified\n");
        for row in rows(file, "a.csv", text.as_bytes(), &log) {
            match file {
                CatalogFile::Gears => drop(gears::gear(&row)),
                _ => drop(actuators::gear(&row)),
            }
        }
        [log.faults, log.warnings].map(|list| list.borrow().iter().map(|x| x.field.clone()).collect())
    }

    fn gear(figures: &str) -> [Vec<String>; 2] {
        found(CatalogFile::Gears, GEAR, figures)
    }

    #[test]
    fn a_sound_row_of_each_kind_is_not_warned_of() {
        for sound in [
            "planetary,AFX,75,50,110,1.6e-5,1.7,,,24000,,,170000,270,0.05",
            ",FSK,25,100,87,4.1e-5,1.5,14,48,31000,50000,57000,127000,156,0.062",
            "cycloidal,F2C,25,59,260,5e-5,5.5,,,240000,,,,,",
            "belt,GT3,60,4,50,1e-4,1.2,,,30000,,,,,",
            "belt,PRINTED,20,3,5,1e-6,0.1,,,400,,,,,",
            "direct,D,1,1,50,,0.2,,,1e12,,,1e6,,",
        ] {
            assert_eq!(gear(sound).concat(), [""; 0], "{sound}");
        }
        let sound = "A-50,50,40,82,0.5,2.1,16000,120000,0.07";
        assert_eq!(found(CatalogFile::Actuators, ACTUATOR, sound).concat(), [""; 0]);
    }

    #[test]
    fn stiffnesses_in_newton_metres_per_arcmin_are_faults_of_gears_of_every_kind() {
        let [faults, warnings] = gear("planetary,AFX,75,50,110,0.16,1.7,,,7,,,50,270,50");
        assert_eq!(faults, ["k1_nm_per_rad", "tilting_stiffness_nm_per_rad"]);
        assert_eq!(warnings, ["bearing_pitch_diameter_m", "inertia_input_kgm2"]);
        let [faults, _] = gear(",FSK,25,100,87,4.1e-5,1.5,,,9,,,37,156,0.062");
        assert_eq!(faults, ["k1_nm_per_rad", "tilting_stiffness_nm_per_rad"]);
        let [faults, _] = found(CatalogFile::Actuators, ACTUATOR, "A,50,40,82,0.5,2.1,4.6,35,0.07");
        assert_eq!(faults, ["k1_nm_per_rad", "tilting_stiffness_nm_per_rad"], "by the rated torque");
    }

    #[test]
    fn stiffnesses_in_other_units_are_warned_of() {
        let per_degree = gear("planetary,AFX,75,50,110,1.6e-5,1.7,,,420,,,2900,270,0.05");
        assert_eq!(
            per_degree,
            [vec![], vec!["k1_nm_per_rad".to_string(), "tilting_stiffness_nm_per_rad".into()]]
        );
        let in_millimetres = gear("cycloidal,F2C,25,59,260,5e-5,5.5,,,2.4e8,,,,,").concat();
        assert_eq!(in_millimetres, ["k1_nm_per_rad"]);
        let rotor_in_kgcm2 = found(CatalogFile::Actuators, ACTUATOR, "A,50,40,82,5000,2.1,16000,,").concat();
        assert_eq!(rotor_in_kgcm2, ["inertia_output_kgm2"]);
    }
}
