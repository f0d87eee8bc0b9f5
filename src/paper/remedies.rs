//! Remedies that would make the paper's arm more accurate: correction of the joint deflection, stiffer
//! connections, stiffer drives.

use super::arm::{JOINTS, LINKS, PaperArm, Solved, connect, stiffen_link};
use super::output::PaperError;
use super::parts;
use crate::arm::LinkModel;
use crate::arm::joint_law::Curve;
use crate::catalog::Catalogs;
use crate::report::number::{fixed, percent, percent_change, shortest};
use crate::report::table::{Column, Table};

/// Assumed relative errors of the gear's torsion curve, for the second remedy of the paper's conclusions: the
/// deflection of the joints is computed from the motor's torque by this curve.
pub const CURVE_ERRORS: [f64; 3] = [0.05, 0.10, 0.20];
/// Reduction ratio of the drives in the connection table.
pub const RATIO: f64 = 100.0;
/// Stiffnesses of the connections at the output that are compared \[N m/rad\].
const CONNECTIONS_NM_PER_RAD: [f64; 4] = [1e5, 3e5, 1e6, 3e6];

/// The arm of Table 1 with the catalog's gears in joints 2, 3 and 4.
#[derive(Debug, Clone, PartialEq)]
pub struct CatalogGears {
    /// The arm with gears that are linear springs of the middle slope K2.
    pub middle_slope: PaperArm,
    /// The arm with gears that follow the whole torsion curve.
    pub curve: PaperArm,
}

impl CatalogGears {
    /// Looks up the gears in the catalog.
    ///
    /// # Errors
    /// A gear is missing or its torsion curve is incomplete.
    pub fn new(catalogs: &Catalogs) -> Result<Self, PaperError> {
        let mut curves = [Curve::Rigid; 3];
        for (curve, size) in curves.iter_mut().zip([58, 50, 32]) {
            *curve = Curve::Windup(parts::windup(catalogs, size)?);
        }
        let whole = PaperArm { curves, ..PaperArm::table_1() };
        let middle_slope = PaperArm { curves: curves.map(|c| c.middle_slope()), ..whole.clone() };
        Ok(Self { middle_slope, curve: whole })
    }
}

/// The error of the tip's position that remains after a correction.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorLeft {
    /// The method of the correction, in words: what is measured or computed for it.
    pub method: String,
    /// Error of the tip's position that remains if the gears are springs of stiffness K2 \[m\].
    pub middle_slope_m: f64,
    /// Error of the tip's position that remains if the gears follow the three-segment curve \[m\].
    pub curve_m: f64,
}

/// The errors of the tip's position that remain after each of the two remedies in the paper's conclusions. In one, the
/// deflection of the joints is measured at the output. In the other, it is computed from the motor's torque.
pub fn error_left(gears: &CatalogGears) -> Vec<ErrorLeft> {
    let [k2, curve] = [&gears.middle_slope, &gears.curve].map(|arm| arm.solve(LinkModel::Full));
    let row = |method: &str, left: &dyn Fn(&Solved) -> f64| ErrorLeft {
        method: method.to_string(),
        middle_slope_m: left(&k2),
        curve_m: left(&curve),
    };
    let mut rows = vec![
        row("nothing corrected", &Solved::drop_m),
        row("joint deflection measured at the output: the links are left", &Solved::links_m),
    ];
    for error in CURVE_ERRORS {
        let method = format!("computed from motor torque, curve known to {}", percent(100.0 * error, 0));
        rows.push(row(&method, &|s| s.links_m() + error * s.joints_m()));
    }
    rows.push(row("computed from motor torque with K2 alone", &|s| s.drop_m() - k2.joints_m()));
    rows
}

/// The result of [`error_left`] as a table.
pub fn error_left_table(rows: &[ErrorLeft]) -> Table {
    let mut table = Table::new(vec![
        Column::left("correction"),
        Column::unit("left, gears with K2", "mm"),
        Column::right("of all"),
        Column::unit("left, three-segment gears", "mm"),
        Column::right("of all"),
    ]);
    let Some(all) = rows.first() else { return table };
    for row in rows {
        table.row([
            row.method.clone(),
            millimetres(row.middle_slope_m),
            percent(100.0 * (row.middle_slope_m / all.middle_slope_m), 1),
            millimetres(row.curve_m),
            percent(100.0 * (row.curve_m / all.curve_m), 1),
        ]);
    }
    table
}

/// The effect of one connection in series with a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Connection {
    /// Name of the joint.
    pub joint: &'static str,
    /// Stiffness of a connection between gear and arm \[N m/rad\].
    pub output_nm_per_rad: f64,
    /// Stiffness of a connection between motor and gear with the same effect: smaller by the factor N², where N
    /// is the ratio of the gear \[N m/rad\].
    pub motor_side_nm_per_rad: f64,
    /// Increase of the load's displacement by the connection \[m\].
    pub added_m: f64,
    /// Lowest frequency with the connection, divided by the lowest frequency without it.
    pub frequency_ratio: f64,
}

/// The effect of compliant connections (E. I. Rivin, *Mechanical Design of Robots*, 1988) on deflection and lowest
/// frequency. Each connection is between motor and gear or between gear and arm, in one joint at a time.
pub fn connections(arm: &PaperArm) -> Vec<Connection> {
    let before = arm.solve(LinkModel::Full);
    let one = |joint: &'static str, stiffness: f64| {
        let after = arm.solve_changed(LinkModel::Full, |s| connect(s, joint, 1.0 / stiffness));
        Connection {
            joint,
            output_nm_per_rad: stiffness,
            motor_side_nm_per_rad: stiffness / RATIO.powi(2),
            added_m: after.drop_m() - before.drop_m(),
            frequency_ratio: after.lowest_hz() / before.lowest_hz(),
        }
    };
    JOINTS.iter().flat_map(|joint| CONNECTIONS_NM_PER_RAD.map(|c| one(joint, c))).collect()
}

/// The result of [`connections`] as a table.
pub fn connection_table(rows: &[Connection]) -> Table {
    let mut table = Table::new(vec![
        Column::left("joint"),
        Column::unit("gear to arm", "N m/rad"),
        Column::unit("or motor to gear", "N m/rad"),
        Column::unit("adds at the load", "mm"),
        Column::right("lowest mode"),
    ]);
    for row in rows {
        table.row([
            row.joint.to_string(),
            shortest(row.output_nm_per_rad),
            shortest(row.motor_side_nm_per_rad),
            millimetres(row.added_m),
            percent_change(row.frequency_ratio, 1),
        ]);
    }
    table
}

/// The effect of doubling the stiffness of one element.
#[derive(Debug, Clone, PartialEq)]
pub struct Stiffer {
    /// Name of the joint or link.
    pub element: &'static str,
    /// Downward displacement of the load after the change \[m\].
    pub drop_m: f64,
    /// This displacement, divided by the displacement before the change.
    pub drop_ratio: f64,
    /// Lowest frequency after the change \[Hz\].
    pub lowest_hz: f64,
    /// Lowest frequency after the change, divided by the lowest frequency before it.
    pub frequency_ratio: f64,
}

/// Doubles the stiffness of each joint and of each link, one at a time, and computes the effect on deflection and
/// lowest frequency. Masses stay unchanged.
pub fn stiffer(arm: &PaperArm) -> Vec<Stiffer> {
    let before = arm.solve(LinkModel::Full);
    let row = |element, after: Solved| Stiffer {
        element,
        drop_m: after.drop_m(),
        drop_ratio: after.drop_m() / before.drop_m(),
        lowest_hz: after.lowest_hz(),
        frequency_ratio: after.lowest_hz() / before.lowest_hz(),
    };
    let joints = [[2.0, 1.0, 1.0], [1.0, 2.0, 1.0], [1.0, 1.0, 2.0]];
    let joints = JOINTS
        .iter()
        .zip(joints)
        .map(|(name, factors)| row(*name, arm.with_stiffness_factors(factors).solve(LinkModel::Full)));
    let links = LINKS
        .iter()
        .map(|name| row(*name, arm.solve_changed(LinkModel::Full, |s| stiffen_link(s, name, 2.0))));
    joints.chain(links).collect()
}

/// The result of [`stiffer`] as a table.
pub fn stiffer_table(rows: &[Stiffer]) -> Table {
    let mut table = Table::new(vec![
        Column::left("twice as stiff"),
        Column::unit("drop of the load", "mm"),
        Column::right("change"),
        Column::unit("lowest mode", "Hz"),
        Column::right("change"),
    ]);
    for row in rows {
        table.row([
            row.element.to_string(),
            millimetres(row.drop_m),
            percent_change(row.drop_ratio, 1),
            fixed(row.lowest_hz, 3),
            percent_change(row.frequency_ratio, 1),
        ]);
    }
    table
}

fn millimetres(metres: f64) -> String {
    fixed(1e3 * metres, 4)
}
