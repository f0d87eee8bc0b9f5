//! The sizing table: one row of numbers for each joint, from the tip to the base. Equation numbers refer to
//! docs/model.md.

use super::bearing_checks::{BlankRatings, RigidBearing, bearing_margin};
use super::check::{Check, CheckKind, CheckState};
use super::checks::{binding, checks, motor_checks};
use super::demand::{JointDemand, JointMotion, input_speed_rpm, mean_input_speed_rpm};
use super::drive::{Drive, rotary_torque_output_nm};
use super::limits::stops_allowed;
use super::rpm_from_rad_s;
use crate::arm::bearing::BearingSource;
use crate::catalog::gear::Gear;
use serde::Serialize;

/// The sizing result of one joint. A number is `None` if it depends on a rating that the catalog leaves blank.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(remote = "Self")]
pub struct JointSizingRow {
    /// Name of the joint.
    pub joint: String,
    /// Static torque, Eq 7 \[N m\].
    pub static_torque_nm: f64,
    /// Torque of linear acceleration, Eq 8 \[N m\].
    pub linear_torque_nm: f64,
    /// Rotary torque as printed in Eq 11, on the motor's side \[N m\]; `None` if an inertia is blank.
    pub rotary_torque_motor_nm: Option<f64>,
    /// Rotary torque referred to the joint, N times as large \[N m\]; `None` if an inertia is blank.
    pub rotary_torque_output_nm: Option<f64>,
    /// Sum of static, linear and rotary torque, all referred to the joint \[N m\] (Eq 12); `None` if an inertia is
    /// blank.
    pub total_torque_nm: Option<f64>,
    /// Torque of the motor while the joint accelerates, with the losses of the gear \[N m\]; `None` if a rating that it
    /// needs is blank.
    pub motor_peak_torque_nm: Option<f64>,
    /// Torque in an emergency stop \[N m\]; of an actuator, with the torque that stops its own rotor.
    pub stop_torque_nm: f64,
    /// Cubic mean torque over the duty cycle \[N m\].
    pub mean_torque_nm: f64,
    /// Root mean square of the motor's torque over the cycle \[N m\]; `None` also if heating is not checked.
    pub motor_rms_torque_nm: Option<f64>,
    /// Continuous torque of the motor at the cruising speed \[N m\]; `None` also if heating is not checked.
    pub motor_continuous_torque_nm: Option<f64>,
    /// Continuous torque divided by root mean square torque of the motor. `None` also if the root mean square is 0.
    pub motor_rms_margin: Option<f64>,
    /// Efficiency of the gear at the mean speed and torque of the cycle, from representative curves. It is for
    /// information only: the checks use the rated efficiency. `None` if the catalogs have no such curve for the gear.
    pub cycle_efficiency: Option<f64>,
    /// Margin of the motor's heat (continuous torque divided by root mean square torque) if the gear has the efficiency
    /// `cycle_efficiency`. `None` also without this efficiency.
    pub motor_rms_margin_at_cycle_efficiency: Option<f64>,
    /// Largest moment across the axis at the centre of the output bearing while a joint is in its ramp \[N m\]. `None`
    /// if the joint has no bearing.
    pub bearing_moment_nm: Option<f64>,
    /// Moment that the bearing permits while the joint turns \[N m\]; `None` if it is unknown or the joint has no
    /// bearing.
    pub bearing_moment_permissible_nm: Option<f64>,
    /// Static safety C₀ / P₀ of the bearing at rest; `None` if a rating is unknown or the joint has no bearing.
    pub bearing_safety_at_rest: Option<f64>,
    /// Static safety of the bearing in an emergency stop; `None` if a rating is unknown or the joint has no bearing.
    pub bearing_safety_in_a_stop: Option<f64>,
    /// L10 life of the bearing \[h\]; `None` if a rating is unknown or the joint has no bearing.
    pub bearing_life_h: Option<f64>,
    /// The factor by which all loads on the bearing may grow until one of its checks fails. `None` also if nothing
    /// loads the bearing or no check could be made.
    pub bearing_margin: Option<f64>,
    /// Largest speed of the joint \[rpm\].
    pub joint_speed_rpm: f64,
    /// Largest speed of the motor \[rpm\].
    pub motor_speed_rpm: f64,
    /// Speed of the gear's input while the joint cruises \[rpm\]. It equals the speed of the motor, unless a stage lies
    /// between motor and gear.
    pub input_speed_rpm: f64,
    /// Mean speed of the gear's input over the cycle, rests included \[rpm\].
    pub mean_input_speed_rpm: f64,
    /// Number of emergency stops that the gear may see in its life. `None` also for gears that have no such limit.
    pub emergency_stops_allowed: Option<f64>,
    /// Name of the chosen gear.
    pub gear: String,
    /// Name of the chosen motor.
    pub motor: String,
    /// Label of the check with the smallest torque margin; `None` if no check could be made.
    pub binds: Option<&'static str>,
    /// Torque margin of the binding check: allowed over needed torque. For a life it is a root of the ratio of lives,
    /// see [`Check::torque_margin`]. `None` also if nothing is needed.
    pub margin: Option<f64>,
    /// L10 life of the gear \[h\] (of a strain-wave gear: of its wave-generator bearing); `None` if its life is not
    /// checked or a rating is blank.
    pub life_h: Option<f64>,
    /// Whether the joint slides. Its torques are then forces \[N\], and `joint_speed_rpm` is its speed in m/s times
    /// 30/π. In JSON they have keys of their own, such as `static_force_n` and `joint_speed_m_s`.
    pub slides: bool,
    /// Mass of the drive \[kg\]; `None` if a mass is blank.
    pub mass_kg: Option<f64>,
    /// Mass that this joint and everything outboard of it add to the load of the next joint inboard \[kg\]. It includes
    /// the parts of the drive that sit at this joint, and other parts that are fixed to it, such as a half of a belt.
    pub mass_passed_inward_kg: f64,
    /// Every check, including the checks that could not be made.
    #[serde(skip)]
    pub checks: Vec<Check>,
    /// Messages of the checks that fail. The list can have entries only if the user fixed the drive; a drive that the
    /// program selects passes all checks.
    pub fails: Vec<String>,
    /// Checks that could not be made, and a bearing that is taken as rigid because its stiffness is unknown, in words.
    pub not_checked: Vec<String>,
}

impl JointSizingRow {
    /// The row of the joint named `joint` with this drive, under its motion and its demand. `mass_passed_inward_kg` is
    /// the mass of everything outboard and of the drive \[kg\].
    pub fn new(
        joint: &str,
        drive: &Drive,
        motion: &JointMotion,
        demand: &JointDemand,
        mass_passed_inward_kg: f64,
    ) -> Self {
        let checks = checks(drive, motion, demand);
        let bound = binding(&checks);
        let finite = |x: &f64| x.is_finite();
        let of_kind = |kind| checks.iter().find(|c| c.kind == kind);
        let allowed = |kind| of_kind(kind).and_then(|c: &Check| c.allowed).filter(finite);
        let rms = of_kind(CheckKind::MotorRms);
        let rotary_output = drive
            .input_inertia_kgm2()
            .map(|inertia| rotary_torque_output_nm(inertia, drive.ratio(), motion.acceleration_rad_s2));
        Self {
            joint: joint.to_string(),
            static_torque_nm: demand.static_torque_nm,
            linear_torque_nm: demand.linear_torque_nm,
            rotary_torque_motor_nm: drive.rotary_torque_motor_nm(motion).ok(),
            rotary_torque_output_nm: rotary_output.ok(),
            total_torque_nm: rotary_output.ok().map(|rotary| demand.peak_torque_nm() + rotary),
            motor_peak_torque_nm: drive.peak_motor_torque_nm(motion, demand.peak_torque_nm()).ok(),
            stop_torque_nm: of_kind(CheckKind::GearStop)
                .and_then(|c| c.needed)
                .unwrap_or(demand.stop_torque_nm),
            mean_torque_nm: demand.mean_torque_nm(),
            motor_rms_torque_nm: rms.and_then(|c| c.needed),
            motor_continuous_torque_nm: rms.and_then(|c| c.allowed),
            motor_rms_margin: rms.and_then(Check::margin).filter(finite),
            cycle_efficiency: None,
            motor_rms_margin_at_cycle_efficiency: None,
            bearing_moment_nm: of_kind(CheckKind::BearingMoment).and_then(|c| c.needed),
            bearing_moment_permissible_nm: allowed(CheckKind::BearingMoment),
            bearing_safety_at_rest: allowed(CheckKind::BearingRest),
            bearing_safety_in_a_stop: allowed(CheckKind::BearingStop),
            bearing_life_h: allowed(CheckKind::BearingLife),
            bearing_margin: bearing_margin(&checks).filter(finite),
            joint_speed_rpm: rpm_from_rad_s(motion.speed_rad_s),
            motor_speed_rpm: drive.motor_speed_rpm(motion),
            input_speed_rpm: input_speed_rpm(drive.gear, motion),
            mean_input_speed_rpm: mean_input_speed_rpm(drive.gear, motion),
            emergency_stops_allowed: stops_allowed(drive.gear, motion),
            gear: drive.gear.id.clone(),
            motor: drive.motor.id.clone(),
            binds: bound.map(|c| c.kind.label()),
            margin: bound.and_then(Check::torque_margin).filter(finite),
            life_h: allowed(CheckKind::GearLife),
            slides: drive.gear.kind.slides(),
            mass_kg: drive.mass_kg().ok(),
            mass_passed_inward_kg,
            fails: remarks(checks.iter().filter(|c| c.state == CheckState::Fails)),
            not_checked: not_checked(drive, &checks),
            checks,
        }
    }
}

impl JointSizingRow {
    /// This row, completed by the efficiency that the gear has at the mean speed and torque of the cycle, and by the
    /// margin of the motor's heat at this efficiency.
    pub fn at_efficiency(
        self,
        efficiency: f64,
        drive: &Drive,
        motion: &JointMotion,
        demand: &JointDemand,
    ) -> Self {
        let gear = Gear { efficiency: Some(efficiency), ..drive.gear.clone() };
        let checks = motor_checks(&Drive { gear: &gear, ..*drive }, motion, demand);
        let rms = checks.iter().find(|c| c.kind == CheckKind::MotorRms);
        Self {
            cycle_efficiency: Some(efficiency),
            motor_rms_margin_at_cycle_efficiency: rms.and_then(Check::margin).filter(|x| x.is_finite()),
            ..self
        }
    }
}

/// Messages of the checks, each with the kind of part that it is about.
fn remarks<'c>(checks: impl Iterator<Item = &'c Check>) -> Vec<String> {
    checks.map(with_part).collect()
}

/// A check in words, with the part that it is about: `gear peak 111 N m needed, 107 allowed`.
pub(crate) fn with_part(check: &Check) -> String {
    let part = match check.kind {
        kind if kind.is_bearing() => "",
        kind if kind.is_gear() => "gear ",
        _ => "motor ",
    };
    format!("{part}{check}")
}

/// Messages of the checks that could not be made. A bearing gets one line, however many of its ratings are blank.
fn not_checked(drive: &Drive, checks: &[Check]) -> Vec<String> {
    let open = |c: &&Check| matches!(c.state, CheckState::NotChecked(_)) && !c.kind.is_bearing();
    let mut out = remarks(checks.iter().filter(open));
    let (blank, rigid) = match drive.bearing {
        BearingSource::OfGear => {
            let (source, gear, which) = (&drive.bearing, drive.gear, drive.gear_mass);
            let of_gear = Some(gear.id.as_str());
            (
                BlankRatings::of(source, gear, which).map(|blank| (blank, of_gear)),
                RigidBearing::of(source, gear, which).map(|rigid| (rigid, of_gear)),
            )
        }
        // the bearing of a gear that the file names is stated in the arm too
        BearingSource::Stated(bearing) => (
            bearing.and_then(|bearing| BlankRatings::of_given(&bearing, Some(drive.gear))),
            bearing.and_then(|bearing| RigidBearing::of_given(&bearing, Some(drive.gear))),
        ),
    };
    let whose = |gear: Option<&str>| gear.unwrap_or("the stated bearing").to_string();
    out.extend(blank.map(|(blank, gear)| blank.words(&[&whose(gear)])));
    out.extend(rigid.map(|(rigid, gear)| rigid.words(&[&whose(gear)])));
    out
}

/// Largest number of characters of a motor's name in the table.
const MOTOR_WIDTH: usize = 14;

/// Header and unit of a column of the table, and whether the column is aligned to the right.
type Header = (&'static str, &'static str, bool);

const HEADERS: [Header; 15] = [
    ("joint", "", false),
    ("static", "N m", true),
    ("linear", "N m", true),
    ("rot.mot", "N m", true),
    ("rot.out", "N m", true),
    ("total", "N m", true),
    ("speed", "rpm", true),
    ("motor", "rpm", true),
    ("gear", "", false),
    ("motor", "", false),
    ("binds", "", false),
    ("margin", "-", true),
    ("life", "h", true),
    ("drive", "kg", true),
    ("inward", "kg", true),
];

/// Columns of the second table: numbers that depend on the whole duty cycle.
const CYCLE_HEADERS: [Header; 9] = [
    ("joint", "", false),
    ("mean", "N m", true),
    ("input", "rpm", true),
    ("motor rms", "N m", true),
    ("allowed", "N m", true),
    ("margin", "-", true),
    ("efficiency", "~", true),
    ("margin", "~", true),
    ("stops", "-", true),
];

/// The headers of a table for joints that slide, made from the `headers` for joints that turn: forces along the travel
/// take the place of torques, and a speed in mm/s takes the place of the joint's speed.
fn of_rails<const N: usize>(headers: [Header; N]) -> [Header; N] {
    let at_motor = ["rot.mot", "motor rms", "allowed"];
    headers.map(|(name, unit, right)| match (name, unit) {
        ("gear", _) => ("screw or rack", unit, right),
        ("speed", _) => (name, "mm/s", right),
        (_, "N m") if !at_motor.contains(&name) => (name, "N", right),
        _ => (name, unit, right),
    })
}

/// Columns of the third table: numbers of the output bearings.
const BEARING_HEADERS: [Header; 7] = [
    ("joint", "", false),
    ("moment", "N m", true),
    ("allowed", "N m", true),
    ("fs rest", "-", true),
    ("fs stop", "-", true),
    ("life", "h", true),
    ("margin", "-", true),
];

/// Footnote that explains the tilde in the headers.
const REPRESENTATIVE: &str = "~ at the gear's efficiency at the mean speed and torque of the cycle, by representative \
    curves; the checks use the rated one\n";

/// The rows as text tables of about 120 characters a line: first the drives, then numbers of the whole cycle, then
/// the output bearings if there are any. Remarks on checks that failed or could not be made follow.
pub fn render_rows(rows: &[JointSizingRow]) -> String {
    let (sliding, turning): (Vec<_>, Vec<_>) = rows.iter().partition(|row| row.slides);
    let mut text = String::new();
    for (rows, headers, cycle) in
        [(&turning, HEADERS, CYCLE_HEADERS), (&sliding, of_rails(HEADERS), of_rails(CYCLE_HEADERS))]
    {
        if rows.is_empty() {
            continue;
        }
        let above = if text.is_empty() { "" } else { "\n" };
        text.push_str(&format!("{above}{}", table(&headers, rows.iter().map(|row| cells(row)))));
        text.push_str("\nover the cycle:\n");
        text.push_str(&table(&cycle, rows.iter().map(|row| cycle_cells(row))));
    }
    if rows.iter().any(|row| row.cycle_efficiency.is_some()) {
        text.push_str(REPRESENTATIVE);
    }
    let mut on_bearings = rows.iter().filter(|row| row.bearing_moment_nm.is_some()).peekable();
    if on_bearings.peek().is_some() {
        text.push_str("\noutput bearings:\n");
        text.push_str(&table(&BEARING_HEADERS, on_bearings.map(bearing_cells)));
    }
    for row in rows {
        for remark in row.fails.iter().chain(&row.not_checked) {
            text.push_str(&format!("joint {}: {remark}\n", row.joint));
        }
    }
    text
}

fn table<const N: usize>(headers: &[Header; N], rows: impl Iterator<Item = [String; N]>) -> String {
    let mut lines = vec![headers.map(|h| h.0.to_string()), headers.map(|h| h.1.to_string())];
    lines.extend(rows);
    let width = |column: usize| lines.iter().map(|l| l[column].chars().count()).max().unwrap_or(0);
    let pad = |line: &[String; N], column: usize| match (headers[column].2, width(column)) {
        (true, width) => format!("{:>width$}", line[column]),
        (false, width) => format!("{:<width$}", line[column]),
    };
    let text = |line: &[String; N]| (0..N).map(|column| pad(line, column)).collect::<Vec<_>>().join(" ");
    lines.iter().map(|line| text(line).trim_end().to_string() + "\n").collect()
}

fn digits(x: f64, n: usize) -> String {
    format!("{x:.n$}")
}

/// A number with `n` decimals, or a question mark if the number is unknown because a rating is blank.
fn or_open(x: Option<f64>, n: usize) -> String {
    x.map_or("?".to_string(), |x| digits(x, n))
}

fn cells(row: &JointSizingRow) -> [String; 15] {
    [
        row.joint.clone(),
        digits(row.static_torque_nm, 2),
        digits(row.linear_torque_nm, 2),
        or_open(row.rotary_torque_motor_nm, 3),
        or_open(row.rotary_torque_output_nm, 2),
        or_open(row.total_torque_nm, 1),
        match row.slides {
            true => digits(row.joint_speed_rpm * super::RAD_S_PER_RPM * 1e3, 1),
            false => digits(row.joint_speed_rpm, 1),
        },
        digits(row.motor_speed_rpm, 0),
        row.gear.clone(),
        shortened(&row.motor),
        row.binds.unwrap_or("-").to_string(),
        row.margin.map_or("-".to_string(), |x| digits(x, 2)),
        row.life_h.map_or("-".to_string(), life_text),
        or_open(row.mass_kg, 2),
        digits(row.mass_passed_inward_kg, 2),
    ]
}

fn cycle_cells(row: &JointSizingRow) -> [String; 9] {
    let or_none = |x: Option<f64>| x.map_or("-".to_string(), |x| digits(x, 2));
    [
        row.joint.clone(),
        digits(row.mean_torque_nm, 2),
        digits(row.mean_input_speed_rpm, 0),
        or_open(row.motor_rms_torque_nm, 3),
        or_open(row.motor_continuous_torque_nm, 3),
        or_none(row.motor_rms_margin),
        or_none(row.cycle_efficiency),
        or_none(row.motor_rms_margin_at_cycle_efficiency),
        row.emergency_stops_allowed.map_or("-".into(), |stops| digits(stops.floor(), 0)),
    ]
}

fn bearing_cells(row: &JointSizingRow) -> [String; 7] {
    [
        row.joint.clone(),
        or_open(row.bearing_moment_nm, 1),
        or_open(row.bearing_moment_permissible_nm, 1),
        or_open(row.bearing_safety_at_rest, 2),
        or_open(row.bearing_safety_in_a_stop, 2),
        row.bearing_life_h.map_or("?".to_string(), life_text),
        row.bearing_margin.map_or("-".to_string(), |x| digits(x, 2)),
    ]
}

/// A life in hours; in scientific notation from one million on.
fn life_text(life_h: f64) -> String {
    if life_h < 1e6 { format!("{life_h:.0}") } else { format!("{life_h:.1e}") }
}

fn shortened(name: &str) -> String {
    if name.chars().count() <= MOTOR_WIDTH {
        return name.to_string();
    }
    let kept: String = name.chars().take(MOTOR_WIDTH - 1).collect();
    format!("{}\u{2026}", kept.trim_end())
}

#[cfg(test)]
mod tests {
    use super::super::testing::{char_lynn_j_8_2, component_set, f11_10, hfuc_40_100, hfuc_58_100};
    use super::*;
    use crate::catalog::gear::GearKind;
    use crate::catalog::motor::Motor;
    use crate::sizing::demand::LinearReading;
    use crate::sizing::requirement::MotionRequirement;

    fn paper_joint_2(motor: &Motor) -> JointSizingRow {
        let study = MotionRequirement { linear_reading: LinearReading::Paper, ..Default::default() };
        let motion = study.joint_motion(1.35, None);
        let gear = hfuc_58_100();
        let drive = component_set(&gear, motor);
        JointSizingRow::new("j2", &drive, &motion, &motion.demand(568.3, 0.0), 80.0)
    }

    /// The stop of an actuator includes its own rotor: twice 0.5 kg m² at the output times α, besides T + 2 T_lin.
    #[test]
    fn the_stop_of_an_actuator_is_the_one_that_is_checked() {
        let (mut gear, mut motor) = (hfuc_58_100(), f11_10());
        gear.kind = GearKind::Actuator;
        (gear.inertia_input_kgm2, gear.efficiency) = (Some(0.0), Some(1.0));
        motor.rotor_inertia_kgm2 = Some(0.5 / gear.ratio.powi(2));
        let motion = MotionRequirement::default().joint_motion(1.35, None);
        let demand = motion.demand_of_torques(300.0, 100.0);
        let row = JointSizingRow::new("j2", &component_set(&gear, &motor), &motion, &demand, 80.0);
        let right_nm = 300.0 + 2.0 * 100.0 + 2.0 * 0.5 * motion.acceleration_rad_s2;
        assert!((row.stop_torque_nm - right_nm).abs() < 1e-9, "{}", row.stop_torque_nm);
    }

    #[test]
    fn the_papers_joint_2_has_all_its_numbers() {
        let row = paper_joint_2(&f11_10());
        assert!((row.linear_torque_nm - 289.65).abs() < 0.01);
        assert!(
            (row.rotary_torque_output_nm.unwrap() / row.rotary_torque_motor_nm.unwrap() - 100.0).abs() < 1e-9
        );
        assert!((row.total_torque_nm.unwrap() - (568.3 + 289.65 + 115.56)).abs() < 0.01);
        assert!((row.joint_speed_rpm - 7.07).abs() < 0.01);
        assert!((row.motor_speed_rpm - 707.4).abs() < 0.1);
        assert_eq!(row.mass_kg, Some(12.2));
        assert_eq!(row.binds, Some("gear mean"));
        assert!(row.fails.is_empty() && row.not_checked.is_empty());
    }

    #[test]
    fn the_margin_is_that_of_the_check_that_binds_as_a_factor_on_torque() {
        let long = MotionRequirement { life_h: 1e6, ..Default::default() };
        let motion = long.joint_motion(1.35, None);
        let (gear, motor) = (hfuc_58_100(), f11_10());
        let drive = component_set(&gear, &motor);
        let row = JointSizingRow::new("j2", &drive, &motion, &motion.demand(400.0, 1.0), 80.0);
        let life = row.checks.iter().find(|c| c.kind == CheckKind::GearLife).unwrap();
        let part = life.allowed.unwrap() / life.needed.unwrap();
        assert_eq!(row.binds, Some("gear life"));
        assert!(
            part < 0.9 && (row.margin.unwrap() - libm::cbrt(part)).abs() < 1e-12,
            "{part} {:?}",
            row.margin
        );
    }

    #[test]
    fn a_motor_without_inertia_leaves_its_numbers_open_and_says_so() {
        let row = paper_joint_2(&char_lynn_j_8_2());
        assert_eq!((row.rotary_torque_motor_nm, row.total_torque_nm), (None, None));
        assert_eq!(
            row.not_checked,
            [
                "motor peak not checked: lacks rotor_inertia_kgm2",
                "motor rms not checked: lacks rotor_inertia_kgm2"
            ]
        );
        assert!(
            render_rows(&[row]).contains("\njoint j2: motor peak not checked: lacks rotor_inertia_kgm2\n")
        );
    }

    #[test]
    fn a_fixed_selection_that_fails_is_remarked_below_the_table() {
        let motion = MotionRequirement::default().joint_motion(1.35, None);
        let (gear, motor) = (hfuc_40_100(), f11_10());
        let drive = component_set(&gear, &motor);
        let row = JointSizingRow::new("j2", &drive, &motion, &motion.demand_of_torques(500.0, 100.0), 0.0);
        assert_eq!(row.fails[0], "gear peak 600 N m needed, 568 allowed");
        assert!(row.margin.unwrap() < 1.0);
    }

    #[test]
    fn the_table_prints_like_this() {
        let text = render_rows(&[paper_joint_2(&f11_10())]);
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(
            lines,
            [
                "joint static linear rot.mot rot.out total speed motor gear        motor  binds     margin  \
                 life drive inward",
                "         N m    N m     N m     N m   N m   rpm   rpm                                   -     \
                 h    kg     kg",
                "j2    568.30 289.65   1.156  115.56 973.5   7.1   707 HFUC-58-100 F11-10 gear mean   1.76 \
                 76071 12.20  80.00",
                "",
                "over the cycle:",
                "joint   mean input motor rms allowed margin efficiency margin stops",
                "         N m   rpm       N m     N m      -          ~      ~     -",
                "j2    603.04   283     7.604  31.120   4.09          -      -  4241",
            ]
        );
    }

    #[test]
    fn the_table_fits_about_120_columns_and_long_names_are_cut() {
        let mut row = paper_joint_2(&f11_10());
        row.motor = "EC-i 40 100 W 48 V (488607)".into();
        (row.joint, row.gear, row.binds) = ("wrist1".into(), "HFUC-58-160".into(), Some("gear av.speed"));
        row.life_h = Some(2.5e9);
        let text = render_rows(&[row]);
        assert!(text.contains("EC-i 40 100 W\u{2026}"));
        assert!(text.contains("2.5e9"));
        assert!(text.lines().all(|l| l.chars().count() <= 122), "{text}");
    }

    #[test]
    fn a_row_is_json_with_null_for_what_is_open() {
        let json = serde_json::to_value(paper_joint_2(&char_lynn_j_8_2())).unwrap();
        assert!(json["total_torque_nm"].is_null());
        assert_eq!(json["gear"], "HFUC-58-100");
    }
}
