//! Rows of `gears.csv` and what must hold within one row.

use super::row::Row;
use crate::catalog::gear::Gear;

/// The gear of a row; `None` if its name or source was refused.
pub(crate) fn gear(row: &Row) -> Option<Gear> {
    check(row);
    let (series, size, ratio) = (row.filled("series")?.to_string(), row.count("size")?, row.count("ratio")?);
    Some(Gear {
        id: format!("{series}-{size}-{ratio}"),
        series,
        size,
        ratio,
        rated_torque_nm: row.number("rated_torque_nm"),
        repeated_peak_torque_nm: row.number("repeated_peak_torque_nm"),
        average_torque_limit_nm: row.number("average_torque_limit_nm"),
        momentary_peak_torque_nm: row.number("momentary_peak_torque_nm"),
        max_input_speed_rpm: row.number("max_input_speed_rpm"),
        average_input_speed_limit_rpm: row.number("average_input_speed_limit_rpm"),
        inertia_input_kgm2: row.number("inertia_input_kgm2"),
        mass_component_set_kg: row.number("mass_component_set_kg"),
        mass_housed_unit_kg: row.number("mass_housed_unit_kg"),
        t1_nm: row.number("t1_nm"),
        t2_nm: row.number("t2_nm"),
        k1_nm_per_rad: row.number("k1_nm_per_rad"),
        k2_nm_per_rad: row.number("k2_nm_per_rad"),
        k3_nm_per_rad: row.number("k3_nm_per_rad"),
        hysteresis_loss_arcmin: row.number("hysteresis_loss_arcmin"),
        transmission_accuracy_arcmin: row.number("transmission_accuracy_arcmin"),
        tilting_stiffness_nm_per_rad: row.number("tilting_stiffness_nm_per_rad"),
        permissible_tilting_moment_nm: row.number("permissible_tilting_moment_nm"),
        efficiency: row.number("efficiency_rated_2000rpm"),
        provenance: row.provenance()?,
    })
}

/// The word by which the row's series is also sold. A cell such as `HFUS outline` describes the series and
/// is no other name of it; a remark in brackets is left away.
pub(crate) fn alias<'r>(row: &'r Row) -> Option<&'r str> {
    let word = row.filled("alias_series")?.split('(').next()?.trim();
    (!word.is_empty() && !word.contains(' ')).then_some(word)
}

fn check(row: &Row) {
    order(
        row,
        &["rated_torque_nm", "average_torque_limit_nm", "repeated_peak_torque_nm"],
        false,
        "rated <= average limit <= repeated peak < momentary peak",
    );
    order(
        row,
        &["repeated_peak_torque_nm", "momentary_peak_torque_nm"],
        true,
        "rated <= average limit <= repeated peak < momentary peak",
    );
    order(
        row,
        &["k1_nm_per_rad", "k2_nm_per_rad", "k3_nm_per_rad"],
        false,
        "a harmonic drive stiffens: K1 <= K2 <= K3",
    );
    order(row, &["t1_nm", "t2_nm"], true, "the first segment of the torsion curve ends before the second");
    order(
        row,
        &["average_input_speed_limit_rpm", "max_input_speed_rpm"],
        false,
        "the limit for the average speed is not above that for the peak",
    );
    order(
        row,
        &["mass_component_set_kg", "mass_housed_unit_kg"],
        true,
        "the housed unit contains the component set",
    );
    usual_figures(row);
}

fn order(row: &Row, columns: &[&'static str], strict: bool, hint: &str) {
    let figures: Vec<_> = columns.iter().map(|column| (*column, row.number(column))).collect();
    row.ascending(&figures, strict, hint);
}

/// Warns of figures that are far from those of all known harmonic drives of that size: a slip of unit.
fn usual_figures(row: &Row) {
    let Some(size) = row.count("size").map(f64::from) else { return };
    let scaled = |column: &str, scale: f64, [low, high]: [f64; 2], unit: &str| {
        if let Some(x) = row.number(column).filter(|x| !(low..=high).contains(&(x / scale))) {
            row.warn(
                column,
                format!("= {x} is unusual for size {size}"),
                &format!("usual: {:.3e} to {:.3e} {unit}; a slip of unit?", low * scale, high * scale),
            );
        }
    };
    scaled("k3_nm_per_rad", size.powi(3), [0.9, 4.2], "N m/rad");
    scaled("inertia_input_kgm2", size.powi(5), [2e-12, 3e-11], "kg m2");
    if let Some(t2) = row.number("t2_nm") {
        scaled("t1_nm", t2, [1.5e-3, 0.5], "N m");
    }
    scaled("efficiency_rated_2000rpm", 1.0, [0.5, 0.9], "");
}
