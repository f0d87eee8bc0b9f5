//! The catalog parts that the paper's studies use.

use super::output::PaperError;
use crate::arm::file::windup_of;
use crate::arm::joint_law::Windup;
use crate::catalog::Catalogs;
use crate::catalog::gear::Gear;
use crate::catalog::material::Material;
use crate::catalog::motor::Motor;
use crate::report::number::{fixed, shortest};
use crate::report::table::{Column, Table};

/// The HFUC gear of this size with the ratio 100:1.
///
/// # Errors
/// The catalog has no such gear.
pub(crate) fn gear(catalogs: &Catalogs, size: u32) -> Result<&Gear, PaperError> {
    hfuc(catalogs, size, 100)
}

fn hfuc(catalogs: &Catalogs, size: u32, ratio: u32) -> Result<&Gear, PaperError> {
    let found =
        catalogs.gears.iter().find(|g| g.series == "HFUC" && g.size == size && g.ratio == f64::from(ratio));
    found.ok_or_else(|| missing("gear", &format!("HFUC-{size}-{ratio}")))
}

/// The torsion curve of the HFUC gear of this size with the ratio 100:1.
///
/// # Errors
/// The catalog has no such gear, or its torsion curve is incomplete.
pub(crate) fn windup(catalogs: &Catalogs, size: u32) -> Result<Windup, PaperError> {
    let gear = gear(catalogs, size)?;
    windup_of(gear).ok_or_else(|| missing("complete torsion curve of gear", &gear.id))
}

/// The motor of this model name.
///
/// # Errors
/// The catalog has no such motor.
pub(crate) fn motor<'c>(catalogs: &'c Catalogs, id: &str) -> Result<&'c Motor, PaperError> {
    catalogs.motors.iter().find(|m| m.id == id).ok_or_else(|| missing("motor", id))
}

/// The material of this name.
///
/// # Errors
/// The catalog has no such material.
pub(crate) fn material<'c>(catalogs: &'c Catalogs, name: &str) -> Result<&'c Material, PaperError> {
    catalogs.materials.iter().find(|m| m.name == name).ok_or_else(|| missing("material", name))
}

/// The error for a part that a study needs and the catalog lacks.
pub(crate) fn missing(kind: &'static str, name: &str) -> PaperError {
    PaperError::Missing { kind, name: name.to_string() }
}

/// Gears as in the paper's Table 1: size, ratio of the catalog row, mass \[kg\], stiffness \[N m/rad\]. HFUC 20
/// agrees only with the catalog row of ratio 50:1.
const PRINTED_GEARS: [(u32, u32, f64, f64); 4] =
    [(58, 100, 4.7, 607e3), (50, 100, 3.2, 405e3), (32, 100, 0.9, 108e3), (20, 50, 0.98, 17.5e3)];

/// A table that compares the paper's gears with the gears of the catalogs.
///
/// # Errors
/// The catalog lacks a gear.
pub(crate) fn gear_table(catalogs: &Catalogs) -> Result<Table, PaperError> {
    let mut table = Table::new(vec![
        Column::left("gear"),
        Column::unit("paper K", "N m/rad"),
        Column::unit("K1", "N m/rad"),
        Column::unit("K2", "N m/rad"),
        Column::unit("K3", "N m/rad"),
        Column::unit("paper mass", "kg"),
        Column::unit("component set", "kg"),
        Column::unit("housed unit", "kg"),
    ]);
    for (size, ratio, mass_kg, stiffness) in PRINTED_GEARS {
        let gear = hfuc(catalogs, size, ratio)?;
        let whole = |v: Option<f64>| v.map_or_else(|| "?".to_string(), |v| fixed(v, 0));
        let mass = |v: Option<f64>| v.map_or_else(|| "?".to_string(), shortest);
        table.row([
            gear.id.clone(),
            fixed(stiffness, 0),
            whole(gear.k1_nm_per_rad),
            whole(gear.k2_nm_per_rad),
            whole(gear.k3_nm_per_rad),
            shortest(mass_kg),
            mass(gear.mass_component_set_kg),
            mass(gear.mass_housed_unit_kg),
        ]);
    }
    Ok(table)
}
