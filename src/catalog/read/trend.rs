//! Checks that compare the rows of a catalog: ratings grow with size and with ratio, and efficiency curves agree
//! with the rated point. Deviations are only warnings, because the documents of vendors contain some.

use super::log::Log;
use super::row::Order;
use crate::catalog::efficiency::EfficiencyKind;
use crate::catalog::gear::{Gear, GearKind};
use crate::catalog::{Catalogs, Provenance};
use std::collections::BTreeMap;

type Figure = (&'static str, fn(&Gear) -> Option<f64>);

/// Ratings that grow with the size of a gear, if series and ratio are the same: the column, and a function that gives
/// the value.
const GROW_WITH_SIZE: &[Figure] = &[
    ("rated_torque_nm", |g| g.rated_torque_nm),
    ("repeated_peak_torque_nm", |g| g.repeated_peak_torque_nm),
    ("average_torque_limit_nm", |g| g.average_torque_limit_nm),
    ("momentary_peak_torque_nm", |g| g.momentary_peak_torque_nm),
    ("inertia_input_kgm2", |g| g.inertia_input_kgm2),
    ("mass_component_set_kg", |g| g.mass_component_set_kg),
    ("mass_housed_unit_kg", |g| g.mass_housed_unit_kg),
    ("t1_nm", |g| g.t1_nm),
    ("t2_nm", |g| g.t2_nm),
    ("k1_nm_per_rad", |g| g.k1_nm_per_rad),
    ("k2_nm_per_rad", |g| g.k2_nm_per_rad),
    ("k3_nm_per_rad", |g| g.k3_nm_per_rad),
    ("tilting_stiffness_nm_per_rad", |g| g.tilting_stiffness_nm_per_rad),
    ("permissible_tilting_moment_nm", |g| g.permissible_tilting_moment_nm),
    ("bearing_pitch_diameter_m", |g| g.bearing.pitch_diameter_m),
    ("bearing_static_load_rating_n", |g| g.bearing.static_load_rating_n),
    ("bearing_dynamic_load_rating_n", |g| g.bearing.dynamic_load_rating_n),
    ("outer_diameter_mm", |g| g.envelope.outer_diameter_m.map(|x| x * 1e3)),
    ("max_input_speed_rpm", |g| g.max_input_speed_rpm.map(|speed| -speed)),
];

/// Ratings that do not decrease as the ratio of a gear grows, if series and size are the same: the column, and a
/// function that gives the value.
const GROW_WITH_RATIO: &[Figure] = &[
    ("rated_torque_nm", |g| g.rated_torque_nm),
    ("repeated_peak_torque_nm", |g| g.repeated_peak_torque_nm),
    ("average_torque_limit_nm", |g| g.average_torque_limit_nm),
    ("momentary_peak_torque_nm", |g| g.momentary_peak_torque_nm),
    ("k2_nm_per_rad", |g| g.k2_nm_per_rad),
];

/// Warns of gears whose ratings break the trend of their series, and of efficiency curves that disagree with the rated
/// efficiency.
pub(crate) fn check(catalogs: &Catalogs, log: &Log) {
    let by_size = families(&catalogs.gears, |g| g.ratio, |g| f64::from(g.size));
    let by_ratio = families(&catalogs.gears, |g| f64::from(g.size), |g| g.ratio);
    for family in &by_size {
        GROW_WITH_SIZE.iter().for_each(|figure| grows(family, *figure, Order::Rising, log));
    }
    for family in &by_ratio {
        GROW_WITH_RATIO.iter().for_each(|figure| grows(family, *figure, Order::NotFalling, log));
    }
    catalogs.gears.iter().for_each(|gear| rated_point(catalogs, gear, log));
}

/// The strain-wave gears of each series, in lists. The value of `common` is equal for all gears of a list, and the list
/// is sorted by the value of `rising`. Both are numbers of a gear, such as its ratio and its size.
fn families(gears: &[Gear], common: fn(&Gear) -> f64, rising: fn(&Gear) -> f64) -> Vec<Vec<&Gear>> {
    let mut families: BTreeMap<(&str, u64), Vec<&Gear>> = BTreeMap::new();
    for gear in gears.iter().filter(|gear| gear.kind == GearKind::StrainWave) {
        families.entry((&gear.series, common(gear).to_bits())).or_default().push(gear);
    }
    families.values_mut().for_each(|family| family.sort_by(|a, b| rising(a).total_cmp(&rising(b))));
    families.into_values().collect()
}

fn grows(family: &[&Gear], (column, figure): Figure, order: Order, log: &Log) {
    let known: Vec<_> = family.iter().filter_map(|gear| Some((*gear, figure(gear)?))).collect();
    for pair in known.windows(2) {
        let [(smaller, low), (gear, x)] = [pair[0], pair[1]];
        if !order.holds(low, x) {
            let relation = if x == low { "equals" } else { "is out of line with" };
            let problem = format!("{} = {} {relation} {} = {}", gear.id, x.abs(), smaller.id, low.abs());
            warn(
                &gear.provenance,
                column,
                problem,
                "compare with the vendor's table; SOURCES.md lists known ones",
                log,
            );
        }
    }
}

fn rated_point(catalogs: &Catalogs, gear: &Gear, log: &Log) {
    let at_rated = catalogs.efficiency_at(gear, 2000.0);
    if let (Some(rated), Some(curve)) = (gear.efficiency, at_rated)
        && (rated - curve).abs() > 0.005
    {
        let problem = format!("{} = {rated}, its curve gives {curve} at 2000 rpm", gear.id);
        warn(&gear.provenance, "efficiency_rated_2000rpm", problem, "make the two files agree", log);
    }
    let curve = catalogs.efficiency_curve(gear, EfficiencyKind::AgainstInputSpeed);
    if curve.windows(2).any(|pair| pair[1][1] > pair[0][1]) {
        let problem = format!("the efficiency curve of {} rises with input speed", gear.id);
        warn(&gear.provenance, "efficiency_rated_2000rpm", problem, "check gears_efficiency.csv", log);
    }
}

fn warn(provenance: &Provenance, column: &str, problem: String, hint: &str, log: &Log) {
    log.warn(&provenance.file, Some(provenance.line), column, problem, hint.into());
}
