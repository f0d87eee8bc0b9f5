//! Reads the rows of the tables of readings: `static.csv`, `modal.csv`, `windup.csv` and `positions.csv`.

use super::cells::{ABSURD, Purpose, measured, needed, or_zero, reading_column, sigma};
use super::components::{Components, DISPLACEMENT, POSITION, VectorColumns};
use super::table::{Table, renamed};
use crate::arm::Arm;
use crate::arm::effect::warming::Moment;
use crate::arm::load::Payload;
use crate::arm::pose::{DrivenJoint, Motion, any_slides};
use nalgebra::Vector3;
use std::collections::{HashMap, HashSet};

/// Key of a pose for a hash map: the bits of each angle. Equal poses have equal keys; zero and minus zero count as
/// equal.
pub(crate) fn pose_key(pose_deg: &[f64]) -> Vec<u64> {
    pose_deg.iter().map(|angle| (angle + 0.0).to_bits()).collect()
}

/// Displacement of the tip under load: one row of `static.csv`.
#[derive(Debug, Clone, PartialEq)]
pub struct StaticRow {
    /// Number of the row in the file, from 0, without the header.
    pub row: usize,
    /// Mark of the file: a number made from its content; 0 for a row that is in no file.
    pub file: usize,
    /// Angles of the driven joints \[deg\]; travels of prismatic joints \[mm\].
    pub pose_deg: Vec<f64>,
    /// Payload as stated in the file.
    pub payload: Payload,
    /// Temperature of the arm \[°C\]; `None` if the file has no column `temperature_c`.
    pub temperature_c: Option<f64>,
    /// Force at the tip, in the directions of the world \[N\].
    pub force_n: Vector3<f64>,
    /// Branch of the loading cycle (loading or unloading) as the file names it; empty if the file does not say.
    pub branch: String,
    /// Components of the displacement of the tip from the reference state \[mm\]; `None` for a component that was not
    /// measured.
    pub measured: Components,
}

/// A natural frequency: one row of `modal.csv`.
#[derive(Debug, Clone, PartialEq)]
pub struct ModalRow {
    /// Number of the row in the file, from 0, without the header.
    pub row: usize,
    /// Mark of the file: a number made from its content; 0 for a row that is in no file.
    pub file: usize,
    /// Angles of the driven joints \[deg\]; travels of prismatic joints \[mm\].
    pub pose_deg: Vec<f64>,
    /// Payload as stated in the file.
    pub payload: Payload,
    /// Temperature of the arm \[°C\]; `None` if the file has no column `temperature_c`.
    pub temperature_c: Option<f64>,
    /// Number of the mode among the modes of one pose and payload, from 1 in the order of rising frequency.
    pub mode: usize,
    /// Measured natural frequency \[Hz\].
    pub frequency_hz: f64,
    /// Standard deviation of the frequency \[Hz\].
    pub sigma_hz: f64,
}

/// The twist (torsion) of one joint on a bench: one row of `windup.csv`.
#[derive(Debug, Clone, PartialEq)]
pub struct WindupRow {
    /// Number of the row in the file, from 0, without the header.
    pub row: usize,
    /// Name of the joint.
    pub joint: String,
    /// Torque on the joint \[N m\].
    pub torque_nm: f64,
    /// Branch of the torque cycle (loading or unloading) as the file names it; empty if the file does not say.
    pub branch: String,
    /// Twist of the joint \[arcmin\].
    pub windup_arcmin: f64,
    /// Standard deviation of the twist \[arcmin\].
    pub sigma_arcmin: f64,
}

/// An absolute position of a point on the tool: one row of `positions.csv`.
#[derive(Debug, Clone, PartialEq)]
pub struct PositionRow {
    /// Number of the row in the file, from 0, without the header.
    pub row: usize,
    /// Name or number of the test; empty if it has none.
    pub test: String,
    /// Angles of the driven joints \[deg\]: those of the first arm, then those that only other arms have.
    pub pose_deg: Vec<f64>,
    /// Payload as stated in the file.
    pub payload: Payload,
    /// Temperature of the arm \[°C\]; `None` if the file has no column `temperature_c`.
    pub temperature_c: Option<f64>,
    /// Index of the arm to which the point belongs, in the order of
    /// [`Campaign::arms`](super::campaign::Campaign::arms).
    pub arm: usize,
    /// Name of the point; `tip` if the file has no column `point`.
    pub point: String,
    /// Coordinates of the point in the frame of the instrument \[mm\]; `None` for a coordinate that was not measured.
    pub measured: Components,
}

impl PositionRow {
    /// Mean standard deviation of the measured coordinates \[mm\]; 0 if none was measured.
    pub(crate) fn sigma_mm(&self) -> f64 {
        let own = || self.measured.iter().flatten().map(|read| read.sigma_mm);
        own().sum::<f64>() / own().count().max(1) as f64
    }
}

impl StaticRow {
    /// Row and temperature of the reading, on which effects of warming depend.
    pub fn moment(&self) -> Moment {
        Moment { row: self.row, temperature_c: self.temperature_c }
    }
}

impl ModalRow {
    /// Row and temperature of the reading, on which effects of warming depend.
    pub fn moment(&self) -> Moment {
        Moment { row: self.row, temperature_c: self.temperature_c }
    }
}

impl PositionRow {
    /// Row and temperature of the reading, on which effects of warming depend.
    pub fn moment(&self) -> Moment {
        Moment { row: self.row, temperature_c: self.temperature_c }
    }
}

/// Indices of the columns of pose, payload and temperature in a table of readings; `None` for a column that the table
/// lacks. `motions` says of each driven joint whether it turns or slides.
struct StateColumns {
    pose: Vec<usize>,
    motions: Vec<Motion>,
    mass: Option<usize>,
    cg: [Option<usize>; 3],
    temperature: Option<usize>,
}

/// Whether a table must have a column of payload masses.
#[derive(Clone, Copy, PartialEq)]
enum PayloadColumn {
    Needed,
    Optional,
}

impl StateColumns {
    /// Finds the columns. Missing or unknown columns are recorded as faults; `None` if a necessary one is missing.
    fn find(table: &Table, joints: &[DrivenJoint], payload: PayloadColumn) -> Option<Self> {
        let expected: Vec<String> = joints.iter().map(|joint| format!("q_{}", joint.key())).collect();
        for column in table.columns.iter().filter(|c| c.starts_with("q_") && !expected.contains(c)) {
            // a column of one of the joints, in another unit
            let joint = |name: &str| name.rsplit_once('_').map(|(joint, _)| joint.to_string());
            let meant = expected.iter().find(|name| joint(name) == joint(column));
            let advice = meant.map_or(String::new(), |name| format!("{}; ", renamed(name, column)));
            table.fault(
                Some(1),
                column,
                "is the angle or travel of no driven joint".into(),
                &format!("{advice}the columns of the arm's joints: {}", expected.join(", ")),
            );
        }
        // all of them are asked for first, so that a missing one is not taken for the column of another joint
        for name in &expected {
            table.optional(name);
        }
        let pose: Vec<Option<usize>> = expected.iter().map(|name| table.required(name)).collect();
        const CG: [&str; 3] = ["payload_cg_x_m", "payload_cg_y_m", "payload_cg_z_m"];
        const MASS: &str = "payload_kg";
        table.check_family("payload", &[MASS, CG[0], CG[1], CG[2]]);
        let cg = CG.map(|name| table.optional(name));
        let mass = match payload == PayloadColumn::Needed || cg.iter().any(Option::is_some) {
            true => Some(table.required(MASS)?),
            false => table.optional(MASS),
        };
        let temperature = table.optional("temperature_c");
        let motions = joints.iter().map(|joint| joint.motion).collect();
        Some(Self { motions, pose: pose.into_iter().collect::<Option<_>>()?, mass, cg, temperature })
    }

    /// Angles \[deg\] and travels \[mm\] of the driven joints in the row with index `row`. `None` if there is a fault,
    /// which is recorded.
    fn pose(&self, table: &Table, row: usize) -> Option<Vec<f64>> {
        let angles: Vec<_> = self
            .pose
            .iter()
            .zip(&self.motions)
            .map(|(&c, motion)| match motion {
                Motion::Turns => {
                    table.number_that(row, c, |a| a.abs() <= 720.0, "an angle in degrees is below 720")
                }
                Motion::Slides => {
                    table.number_that(row, c, |mm| mm.abs() <= 1e5, "a travel in mm is below 100000")
                }
            })
            .collect();
        angles.into_iter().collect()
    }

    /// Temperature of the arm in the row with index `row` \[°C\]. The outer value is `None` if there is a fault, which
    /// is recorded. The inner value is `None` if there is no such column.
    fn temperature_c(&self, table: &Table, row: usize) -> Option<Option<f64>> {
        let Some(column) = self.temperature else { return Some(None) };
        let is_sound = |c: f64| (-100.0..=200.0).contains(&c);
        let hint = "an arm in degrees Celsius is between -100 and 200; is it in kelvin or Fahrenheit?";
        table.number_that(row, column, is_sound, hint).map(Some)
    }

    /// Payload in the row with index `row`; no payload if the file has no such column. `None` if there is a fault,
    /// which is recorded.
    fn payload(&self, table: &Table, row: usize) -> Option<Payload> {
        let Some(mass) = self.mass else { return Some(Payload::default()) };
        let mass_kg = table.number_that(
            row,
            mass,
            |m| (0.0..=1e4).contains(&m),
            "a payload in kg is neither negative nor above 10 t; is it in grams?",
        );
        let cg = self.cg.map(|column| {
            or_zero(table, row, column, |table, row, column| {
                let hint = "more than 5 m from the tip: is it in mm?";
                table.number_that(row, column, |x| x.abs() <= 5.0, hint)
            })
        });
        let cg_m = Vector3::new(cg[0]?, cg[1]?, cg[2]?);
        Some(Payload { mass_kg: mass_kg?, cg_m, ..Payload::default() })
    }
}

/// Reads the rows of `static.csv`. `purpose` says whether readings may be blank. Faults are recorded in `table`, and
/// rows with faults are left out.
pub(crate) fn static_rows(table: &Table, arm: &Arm, purpose: Purpose) -> Vec<StaticRow> {
    const FORCE: [&str; 3] = ["force_x_n", "force_y_n", "force_z_n"];
    table.check_family("force", &FORCE);
    let force = FORCE.map(|name| table.optional(name));
    // a displacement needs a load: a payload, or a force at the tip
    let payload = match force.iter().all(Option::is_none) {
        true => PayloadColumn::Needed,
        false => PayloadColumn::Optional,
    };
    let state = StateColumns::find(table, &arm.driven_joints(), payload);
    let components = VectorColumns::find(table, &DISPLACEMENT, purpose);
    let branch = table.optional("branch");
    let (Some(state), Some(components)) = (state, components) else { return Vec::new() };
    let file = table.mark();
    let rows = each_row(table, |row| {
        let (pose_deg, payload) = (state.pose(table, row), state.payload(table, row));
        let force = force.map(|column| or_zero(table, row, column, measured));
        let read = components.read(row);
        let temperature_c = state.temperature_c(table, row);
        Some(StaticRow {
            row,
            file,
            pose_deg: pose_deg?,
            payload: payload?,
            temperature_c: temperature_c?,
            force_n: Vector3::new(force[0]?, force[1]?, force[2]?),
            branch: branch.map_or(String::new(), |c| table.text(row, c).to_string()),
            measured: read?,
        })
    });
    let coarse = rows.iter().filter(|r| r.measured.contains(&None)).map(|r| r.row);
    check_duplicates(table, &coarse.collect());
    check_angles(table, &state.motions, rows.iter().map(|r| r.pose_deg.as_slice()));
    rows
}

/// Reads the rows of `modal.csv`. `purpose` says whether readings may be blank. Faults are recorded in `table`, and
/// rows with faults are left out.
pub(crate) fn modal_rows(table: &Table, arm: &Arm, purpose: Purpose) -> Vec<ModalRow> {
    let state = StateColumns::find(table, &arm.driven_joints(), PayloadColumn::Optional);
    let mode = table.required("mode");
    let readings = ["frequency_hz", "sigma_hz"].map(|name| reading_column(table, name, purpose));
    let (Some(state), Some(mode), [Some(frequency), Some(sigma_hz)]) = (state, mode, readings) else {
        return Vec::new();
    };
    let file = table.mark();
    let rows = each_row(table, |row| {
        let (pose_deg, payload) = (state.pose(table, row), state.payload(table, row));
        let temperature_c = state.temperature_c(table, row);
        let mode = table.number_that(
            row,
            mode,
            |m| m >= 1.0 && m.fract() == 0.0 && m < 1000.0,
            "modes are numbered 1, 2, 3 ... by rising frequency",
        );
        let frequency_hz = needed(table, row, frequency, purpose, |table, row, column| {
            let hint = "a frequency is greater than 0 and below 1 GHz";
            table.number_that(row, column, |f| f > 0.0 && f < ABSURD, hint)
        });
        let sigma_hz = needed(table, row, sigma_hz, purpose, sigma);
        Some(ModalRow {
            row,
            file,
            pose_deg: pose_deg?,
            payload: payload?,
            temperature_c: temperature_c?,
            mode: mode? as usize,
            frequency_hz: frequency_hz?,
            sigma_hz: sigma_hz?,
        })
    });
    check_duplicates(table, &(0..table.rows.len()).collect());
    check_angles(table, &state.motions, rows.iter().map(|r| r.pose_deg.as_slice()));
    rows
}

/// Reads the rows of `windup.csv`. `purpose` says whether readings may be blank. Faults are recorded in `table`, and
/// rows with faults are left out.
pub(crate) fn windup_rows(table: &Table, arm: &Arm, purpose: Purpose) -> Vec<WindupRow> {
    let columns = ["joint", "torque_nm"].map(|n| table.required(n));
    let readings = ["windup_arcmin", "sigma_arcmin"].map(|name| reading_column(table, name, purpose));
    let branch = table.optional("branch");
    let ([Some(joint), Some(torque)], [Some(windup), Some(sigma_arcmin)]) = (columns, readings) else {
        return Vec::new();
    };
    let names: Vec<&str> = arm.joints().map(|j| j.name.as_str()).collect();
    let rows = each_row(table, |row| {
        let name = table.text(row, joint);
        if !names.contains(&name) {
            let hint = format!("the arm's joints: {}", names.join(", "));
            table.row_fault(row, "joint", format!("\"{name}\" is no joint of the arm"), &hint);
        }
        let torque_nm = measured(table, row, torque);
        let windup_arcmin = needed(table, row, windup, purpose, measured);
        let sigma_arcmin = needed(table, row, sigma_arcmin, purpose, sigma);
        Some(WindupRow {
            row,
            joint: name.to_string(),
            torque_nm: torque_nm?,
            branch: branch.map_or(String::new(), |c| table.text(row, c).to_string()),
            windup_arcmin: windup_arcmin?,
            sigma_arcmin: sigma_arcmin?,
        })
    });
    check_duplicates(table, &(0..table.rows.len()).collect());
    rows
}

/// Reads the rows of `positions.csv`. `arms` lists the names of the arms, and `driven` lists the driven joints, each of
/// which has a column of angles. `purpose` says whether readings may be blank. Faults are recorded in `table`, and rows
/// with faults are left out. Prismatic joints are a fault, because positions of arms with such joints are not computed.
pub(crate) fn position_rows(
    table: &Table,
    arms: &[&str],
    driven: &[DrivenJoint],
    purpose: Purpose,
) -> Vec<PositionRow> {
    if any_slides(driven) {
        table.fault(
            None,
            "",
            "has positions of an arm with prismatic joints, which are not computed".into(),
            "leave the file away: static.csv and modal.csv take such arms",
        );
        return Vec::new();
    }
    let state = StateColumns::find(table, driven, PayloadColumn::Optional);
    let components = VectorColumns::find(table, &POSITION, purpose);
    let point = table.optional("point");
    let test = table.optional("test");
    let arm = table.optional("arm");
    let (Some(state), Some(components)) = (state, components) else { return Vec::new() };
    let rows = each_row(table, |row| {
        let (pose_deg, payload) = (state.pose(table, row), state.payload(table, row));
        let read = components.read(row);
        let temperature_c = state.temperature_c(table, row);
        let arm = match arm {
            Some(column) => arm_named(table, row, column, arms),
            None => Some(0),
        };
        Some(PositionRow {
            row,
            test: test.map_or(String::new(), |c| table.text(row, c).to_string()),
            pose_deg: pose_deg?,
            payload: payload?,
            temperature_c: temperature_c?,
            arm: arm?,
            point: point.map_or("tip".to_string(), |c| table.text(row, c).to_string()),
            measured: read?,
        })
    });
    let coarse = rows.iter().filter(|r| r.measured.contains(&None)).map(|r| r.row);
    check_duplicates(table, &coarse.collect());
    check_angles(table, &state.motions, rows.iter().map(|r| r.pose_deg.as_slice()));
    rows
}

/// Index in `arms` of the arm that the cell at `row` and `column` names. `None` if there is no such arm, which is
/// recorded as a fault.
fn arm_named(table: &Table, row: usize, column: usize, arms: &[&str]) -> Option<usize> {
    let name = table.text(row, column);
    let found = arms.iter().position(|a| *a == name);
    if found.is_none() {
        table.row_fault(
            row,
            "arm",
            format!("\"{name}\" is no arm"),
            &format!("the arms: {}", arms.join(", ")),
        );
    }
    found
}

/// Reads every row by `read`, and leaves out those for which it gives `None`.
fn each_row<T>(table: &Table, read: impl Fn(usize) -> Option<T>) -> Vec<T> {
    let rows: Vec<Option<T>> = (0..table.rows.len()).map(read).collect();
    rows.into_iter().flatten().collect()
}

/// Records a fault for each row that repeats an earlier row in every cell but the label of the test. Such a row is a
/// copying error, because a repeated test would have noise of its own.
///
/// The rows with indices in `coarse`, whose readings have only one or two numbers, are an exception: an instrument may
/// show the same digits twice. Two such rows with different labels are taken as repeated tests. If the table has no
/// labels, these rows are not checked.
fn check_duplicates(table: &Table, coarse: &HashSet<usize>) {
    let label = table.optional("test");
    let mut seen: HashMap<Vec<&str>, usize> = HashMap::new();
    for (row, cells) in table.rows.iter().enumerate() {
        let is_coarse = coarse.contains(&row);
        if is_coarse && label.is_none() {
            continue;
        }
        let counts = |c: &usize| is_coarse || Some(*c) != label;
        let key: Vec<&str> =
            cells.iter().enumerate().filter(|(c, _)| counts(c)).map(|(_, s)| s.as_str()).collect();
        if let Some(first) = seen.get(&key) {
            let problem = format!("repeats line {} in every value", table.lines[*first]);
            table.row_fault(row, "", problem, "remove the copy; a repeated test has noise of its own");
        } else {
            seen.insert(key, row);
        }
    }
}

/// Records a fault if the angles are probably in radians: the table has five or more different poses, and the largest
/// angle is between 0.3 and 3.2 (about half a turn in radians).
fn check_angles<'a>(table: &Table, motions: &[Motion], poses: impl Iterator<Item = &'a [f64]>) {
    let poses: Vec<&[f64]> = poses.collect();
    let angles = poses.iter().flat_map(|p| p.iter().zip(motions)).filter(|(_, m)| **m == Motion::Turns);
    let largest = angles.fold(0.0f64, |most, (angle, _)| most.max(angle.abs()));
    let distinct: HashSet<Vec<u64>> = poses.iter().map(|pose| pose_key(pose)).collect();
    if distinct.len() >= 5 && largest > 0.3 && largest < 3.2 {
        table.fault(
            Some(1),
            "q_..._deg",
            format!("no angle of {} poses exceeds {largest} degrees", distinct.len()),
            "they look like radians; write degrees",
        );
    }
}
