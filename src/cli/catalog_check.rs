//! `armwright catalog check`: the number of rows in the catalogs, their blank ratings, and the parts that cannot be
//! chosen because of a blank rating.

use super::catalog_table::{TextTable, cell, provenances};
use crate::arm::bearing::BearingSource;
use crate::catalog::gear::{Gear, GearKind, GearMass};
use crate::catalog::load::Loaded;
use crate::catalog::lookup::first_names;
use crate::catalog::needs::{Lack, words};
use crate::catalog::schema::CatalogFile;
use crate::catalog::{Catalogs, Confidence, Provenance};
use crate::input::json::InputError;
use crate::sizing::bearing_checks::RigidBearing;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

/// Loads the catalogs and reports their rows, the confidence in them, blank ratings and warnings.
///
/// # Errors
/// All faults of all files.
pub(crate) fn check(overlay: Option<&Path>) -> Result<String, InputError> {
    let catalogs = Catalogs::load(overlay)?;
    let mut out = files_table(&catalogs.loaded);
    out.push_str("\nFigures that a sizing check needs and rows leave blank:\n");
    out.push_str(&blanks_table(&catalogs));
    out.push_str(&unchoosable(&catalogs));
    out.push_str(&by_usual_life(&catalogs));
    out.push_str(&belts(&catalogs));
    out.push_str(&rigid_bearings(&catalogs));
    match catalogs.warnings.as_slice() {
        [] => out.push_str("\nNo faults, no warnings.\n"),
        warnings => {
            // Writing to a String cannot fail.
            let _ = writeln!(out, "\nNo faults. Warnings ({}):", warnings.len());
            warnings.iter().for_each(|warning| {
                let _ = writeln!(out, "  {warning}");
            });
        }
    }
    Ok(out)
}

fn files_table(loaded: &[Loaded]) -> String {
    let mut table = TextTable::new(["file", "rows", "replacing"].into_iter().map(String::from).collect());
    table.head.extend(Confidence::ALL.iter().map(ToString::to_string));
    for file in loaded {
        let mut row = vec![file.name.clone(), file.rows.to_string(), file.replaced.to_string()];
        row.extend(file.by_confidence.iter().map(ToString::to_string));
        table.rows.push(row);
    }
    table.to_text()
}

/// Columns that sizing reads, for each catalog file.
const SIZING_COLUMNS: [(CatalogFile, &[&str]); 4] = [
    (
        CatalogFile::Gears,
        &[
            "rated_torque_nm",
            "repeated_peak_torque_nm",
            "average_torque_limit_nm",
            "momentary_peak_torque_nm",
            "max_input_speed_rpm",
            "average_input_speed_limit_rpm",
            "inertia_input_kgm2",
            "mass_component_set_kg",
            "mass_housed_unit_kg",
            "t1_nm",
            "t2_nm",
            "k1_nm_per_rad",
            "k2_nm_per_rad",
            "k3_nm_per_rad",
            "efficiency_rated_2000rpm",
        ],
    ),
    (
        CatalogFile::Motors,
        &[
            "rated_torque_nm",
            "peak_torque_nm",
            "rated_speed_rpm",
            "max_speed_rpm",
            "rotor_inertia_kgm2",
            "mass_kg",
        ],
    ),
    (
        CatalogFile::Actuators,
        &[
            "rated_torque_nm",
            "peak_torque_nm",
            "max_speed_rpm",
            "inertia_output_kgm2",
            "k1_nm_per_rad",
            "mass_kg",
        ],
    ),
    (CatalogFile::Materials, &["g_pa", "poisson", "yield_or_strength_pa", "cost_eur_per_kg"]),
];

fn blanks_table(catalogs: &Catalogs) -> String {
    let mut table = TextTable::new(["file", "column", "blank", "of"].map(String::from).into());
    for (file, columns) in SIZING_COLUMNS {
        let rows: Vec<_> = provenances(catalogs, file).map(|p| catalogs.printed_row(p)).collect();
        for column in columns {
            let blank = rows.iter().filter(|row| cell(row, column).is_empty()).count();
            if blank > 0 {
                let row = [file.file_name(), column, &blank.to_string(), &rows.len().to_string()];
                table.rows.push(row.map(String::from).into());
            }
        }
    }
    table.to_text()
}

/// Number of parts whose names are listed in one line; further parts are only counted.
const PARTS_NAMED: usize = 3;

/// A list of the parts that `size` and `run` cannot choose, and of the materials that no link can have, because ratings are
/// blank, grouped by file and by blank ratings. It also says which of these parts an arm file cannot name. It is empty if
/// there are no such parts.
fn unchoosable(catalogs: &Catalogs) -> String {
    let mut by_lacks: BTreeMap<(String, String), Vec<(usize, &str)>> = BTreeMap::new();
    let mut add = |from: &Provenance, id, lacks: Vec<Lack>| {
        if !lacks.is_empty() {
            by_lacks.entry((from.file.clone(), verbs(&lacks))).or_default().push((from.line, id));
        }
    };
    for gear in &catalogs.gears {
        // the mass that is needed is that of the version in which the gear is sold: as a component set or as a housed
        // unit
        let mass = match gear.mass_housed_unit_kg {
            None if gear.mass_component_set_kg.is_some() => GearMass::ComponentSet,
            _ => GearMass::HousedUnit,
        };
        let mut lacks = gear.lacks(mass);
        if gear.kind == GearKind::Actuator {
            let own = catalogs.motors.iter().find(|motor| gear.goes_with(motor));
            lacks.extend(own.map(|motor| motor.lacks()).unwrap_or_default());
        }
        add(&gear.provenance, gear.id.as_str(), lacks);
    }
    for motor in catalogs
        .motors
        .iter()
        .filter(|m| !catalogs.gears.iter().any(|g| g.kind == GearKind::Actuator && g.goes_with(m)))
    {
        add(&motor.provenance, motor.id.as_str(), motor.lacks());
    }
    for material in catalogs.materials.iter().filter(|material| material.shear_modulus_pa.is_none()) {
        let Provenance { file, line, .. } = &material.provenance;
        let why = "no link can be made of it: no g_pa (torsion and shear)";
        by_lacks.entry((file.clone(), why.into())).or_default().push((*line, material.name.as_str()));
    }
    let lines = by_lacks.into_iter().map(|((file, lacks), mut parts)| {
        parts.sort_unstable();
        format!("  {file}:{} {}: {lacks}\n", parts[0].0, named(&parts))
    });
    let lines: String = lines.collect();
    if lines.is_empty() {
        lines
    } else {
        format!("\nParts that cannot be used because a rating is blank:\n{lines}")
    }
}

/// The verbs that cannot use a part with the blank ratings `lacks`, and the checks for which the ratings are needed.
fn verbs(lacks: &[Lack]) -> String {
    let of_arm: Vec<Lack> =
        lacks.iter().copied().filter(|lack| matches!(lack.purpose, "torsion" | "mass")).collect();
    let named = match of_arm.as_slice() {
        [] => String::new(),
        of_arm => {
            format!("; an arm file that names one must also state its stiffness and mass: {}", words(of_arm))
        }
    };
    format!("cannot be chosen by size and run: {}{named}", words(lacks))
}

fn named(parts: &[(usize, &str)]) -> String {
    let names: Vec<&str> = parts.iter().map(|(_, id)| *id).collect();
    first_names(&names, PARTS_NAMED)
}

/// Housed gears and actuators whose output bearing counts as rigid because their row states no tilting stiffness. The
/// text has one line for each file.
fn rigid_bearings(catalogs: &Catalogs) -> String {
    let mut by_file: BTreeMap<&str, Vec<(usize, &str)>> = BTreeMap::new();
    for gear in &catalogs.gears {
        let is_housed = gear.mass_housed_unit_kg.is_some() && !gear.kind.slides();
        if is_housed && RigidBearing::of(&BearingSource::OfGear, gear, GearMass::HousedUnit).is_some() {
            let Provenance { file, line, .. } = &gear.provenance;
            by_file.entry(file.as_str()).or_default().push((*line, gear.id.as_str()));
        }
    }
    let lines = by_file.into_iter().map(|(file, mut parts)| {
        parts.sort_unstable();
        format!("  {file}:{} {}: no tilting_stiffness_nm_per_rad\n", parts[0].0, named(&parts))
    });
    let lines: String = lines.collect();
    match lines.is_empty() {
        true => lines,
        false => {
            format!("\nOutput bearings that count as rigid (the tip deflects more than printed):\n{lines}")
        }
    }
}

/// Ratings that the row of a belt may leave blank: the column of each, and the number that the checks use in its place.
fn ratings_of_belt(belt: &Gear) -> [(&'static str, Option<f64>); 4] {
    [
        ("average_torque_limit_nm", belt.average_torque_limit_nm),
        ("repeated_peak_torque_nm", belt.repeated_peak_torque_nm),
        ("momentary_peak_torque_nm", belt.momentary_peak_torque_nm),
        ("average_input_speed_limit_rpm", belt.average_input_speed_limit_rpm),
    ]
}

/// A list of the belts with their blank ratings, the numbers that the checks use in their place, and the properties of
/// belts that no check considers.
fn belts(catalogs: &Catalogs) -> String {
    let mut out = String::new();
    // a belt without a rated torque is listed with the parts that cannot be used
    let is_rated = |gear: &&Gear| gear.kind == GearKind::Belt && gear.average_torque_limit_nm.is_some();
    for gear in catalogs.gears.iter().filter(is_rated) {
        let Provenance { file, line, .. } = &gear.provenance;
        let printed = catalogs.printed_row(&gear.provenance);
        let stands = ratings_of_belt(gear).into_iter().filter(|(column, _)| cell(printed, column).is_empty());
        let stands: Vec<String> =
            stands.filter_map(|(column, rating)| Some(format!("{column} {}", rating?))).collect();
        let words = match stands.as_slice() {
            [] => "all ratings stated".to_string(),
            stands => format!(
                "blank, so the next lower rating (of the mean speed: the largest speed) stands for it: {}",
                stands.join(", ")
            ),
        };
        let _ = writeln!(out, "  {file}:{line} {}: {words}", gear.id);
    }
    match out.is_empty() {
        true => out,
        false => format!(
            "\nBelts (not checked: pretension, its load on the shafts, teeth in mesh, and that the rated torque falls with \
             speed: state the torque rated at the largest speed, divided by the maker's service factor):\n{out}"
        ),
    }
}

/// A list of the gears whose row states no life. The life that is usual for their kind is taken instead, or the life is
/// not checked (belts).
fn by_usual_life(catalogs: &Catalogs) -> String {
    let is_blank = |from: &Provenance| cell(catalogs.printed_row(from), "rated_life_h").is_empty();
    let mut out = String::new();
    for gear in catalogs.gears.iter().filter(|g| g.kind != GearKind::Actuator && is_blank(&g.provenance)) {
        let Provenance { file, line, .. } = &gear.provenance;
        match (gear.life.rated_h, gear.kind.wears_out()) {
            (Some(hours), _) => {
                let _ = writeln!(
                    out,
                    "  {file}:{line} {}: no rated_life_h; the usual {hours} h of its kind stand for it",
                    gear.id
                );
            }
            (None, false) if gear.kind == GearKind::Belt => {
                let _ =
                    writeln!(out, "  {file}:{line} {}: no rated_life_h; its life is not checked", gear.id);
            }
            _ => {}
        }
    }
    if out.is_empty() { out } else { format!("\nLives that no row states:\n{out}") }
}
