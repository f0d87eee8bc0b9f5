//! Reads a record: a table against time, with the angles on both sides of each gear and the motor's torque.
//!
//! All values are converted to SI units and referred to the output of the gear. An angle of the motor shaft is divided
//! by the gear ratio, and a torque at the shaft is multiplied by it. A record may have a hundred thousand rows, so only
//! the columns that are used are converted to numbers.

use super::median::median;
use super::record_spec::{RecordSpec, SUFFIXES};
use super::spreadsheet::is_spreadsheet;
use crate::input::csv::other_separators;
use crate::input::json::{Fault, InputError, closest};
use csv::{ReaderBuilder, Trim};
use std::path::Path;

/// Largest number of faults of one file that are listed. Further faults are only counted.
const MOST_FAULTS: usize = 10;
/// Smallest number of rows of a record. A shorter record is a fault.
pub(crate) const FEWEST_ROWS: usize = 200;

/// Largest range of the readings of an encoder that starts again at zero after one turn \[rad\]. The factor leaves room
/// for rounding.
const ONE_TURN_RAD: f64 = std::f64::consts::TAU * (1.0 + 1e-9);
/// The angles of motor and link are compared only if both turn through at least this angle \[rad\].
const LEAST_RANGE_RAD: f64 = 0.1;
/// Motor and link move in proportion if the square of the correlation of their angles is at least this.
const TOGETHER: f64 = 0.9;
/// Largest credible ratio of the motion of one side of the gear to the motion of the other side, both referred to the
/// output. Torsion of a joint does not turn one side twice as far as the other, so a larger ratio is a fault.
const MOST_SLOPE: f64 = 2.0;

/// Signals of one joint, all referred to the output of the gear.
#[derive(Debug, Clone, PartialEq)]
pub struct JointSignals {
    /// Name of the joint.
    pub joint: String,
    /// Gear ratio: turns of the motor for one turn of the output; `None` if it is not stated.
    pub ratio: Option<f64>,
    /// Inertia of the rotor, referred to the output \[kg m²\]; `None` if it is not stated.
    pub rotor_inertia_kgm2: Option<f64>,
    /// Angle of the motor divided by the ratio, one per row \[rad\].
    pub motor_rad: Vec<f64>,
    /// Angle of the link, one per row \[rad\]; empty if it is not recorded.
    pub link_rad: Vec<f64>,
    /// Torque of the motor times the ratio, one per row \[N m\]; empty if it is not recorded.
    pub torque_nm: Vec<f64>,
}

/// A record against time of one or several joints.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Path of the file.
    pub file: String,
    /// Time of each row, strictly rising \[s\].
    pub t_s: Vec<f64>,
    /// Joints of which the file has the angle of the motor, in the order of the arm.
    pub joints: Vec<JointSignals>,
    /// Sentences on what the reader noticed: columns that are not used, or times that may be in another unit. Empty if
    /// nothing was noticed.
    pub(crate) remarks: Vec<String>,
}

/// Indices of the columns of a file that have the signals of one joint; `None` for a signal that is not recorded. The
/// second number of `motor` and `torque` is the factor that refers the signal to the output of the gear.
struct Columns {
    joint: String,
    motor: (usize, f64),
    link: Option<usize>,
    torque: Option<(usize, f64)>,
}

/// Times are suspected to be in another unit than seconds if the usual time between two rows is longer than this \[s\].
/// Controllers write a row of a moving joint every 0.25 to 20 ms.
const LONGEST_STEP_S: f64 = 0.15;

/// Reads one file and collects its faults.
struct Reader<'a> {
    file: String,
    spec: &'a RecordSpec,
    header: Vec<String>,
    faults: Vec<Fault>,
}

/// Reads all records that `specs` lists, for the joints with the names `joints`. A record that `campaign.json` does not
/// name is read only if its file exists.
pub(crate) fn read_all(
    folder: &Path,
    specs: &[RecordSpec],
    joints: &[String],
    faults: &mut Vec<Fault>,
) -> Result<Vec<Record>, InputError> {
    let mut out = Vec::new();
    for spec in specs {
        let path = folder.join(&spec.file);
        if spec.is_named || path.exists() {
            out.extend(read_record(&path, spec, joints, faults)?);
        }
    }
    Ok(out)
}

/// Reads one record. `None` if the file has faults, which are added to `faults`.
///
/// # Errors
/// The file cannot be opened.
fn read_record(
    path: &Path,
    spec: &RecordSpec,
    joints: &[String],
    faults: &mut Vec<Fault>,
) -> Result<Option<Record>, InputError> {
    let file = path.display().to_string();
    let text = std::fs::read(path).map_err(|source| InputError::Unreadable { file: file.clone(), source })?;
    let mut reader = Reader { file, spec, header: Vec::new(), faults: Vec::new() };
    let record = match no_csv(path, &text) {
        Some((problem, hint)) => {
            reader.fault(None, "", problem.into(), hint);
            None
        }
        None => reader.read(&text, joints),
    };
    let is_sound = reader.faults.is_empty();
    let listed = reader.faults.len();
    faults.extend(reader.faults.into_iter().take(MOST_FAULTS));
    if listed > MOST_FAULTS {
        let problem = format!("{} further faults of this kind", listed - MOST_FAULTS);
        faults.push(Fault {
            file: reader.file,
            line: None,
            field: String::new(),
            problem,
            hint: String::new(),
        });
    }
    Ok(record.filter(|_| is_sound))
}

/// Why the content `text` of a file cannot be the CSV of a record, and what to do; `None` if it can be.
fn no_csv(path: &Path, text: &[u8]) -> Option<(&'static str, &'static str)> {
    const HINT: &str = "records are read as CSV: save the sheet as CSV, with commas between the columns";
    match () {
        () if is_spreadsheet(path) => Some(("is a spreadsheet", HINT)),
        // a text has no zero bytes, and a file that is none must not be shown in messages
        () if text.contains(&0) => Some(("is no text", HINT)),
        () => None,
    }
}

impl Reader<'_> {
    /// Reads the content `text` of the file. Faults are collected. `None` if the columns are not those of a record.
    fn read(&mut self, text: &[u8], joints: &[String]) -> Option<Record> {
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
        let mut csv = ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(Trim::All)
            .comment(Some(b'#'))
            .from_reader(text);
        let mut records = csv.byte_records();
        let first = records.next().and_then(Result::ok);
        let as_text = |cell: &[u8]| String::from_utf8_lossy(cell).into_owned();
        self.header = first.iter().flatten().map(as_text).collect();
        let separators: Vec<&str> = other_separators(&self.header, 2).collect();
        if !separators.is_empty() {
            let problem = format!("its columns are separated by {}", separators.join(" and "));
            let hint = "separate columns with commas, write decimals with a point, and name the columns in the first row";
            self.fault(Some(1), "", problem, hint);
            return None;
        }
        self.check_names(joints);
        let time = self.required("t_s");
        let columns: Vec<Columns> = joints.iter().filter_map(|j| self.columns_of(j)).collect();
        if !columns.iter().any(|c| c.link.is_some()) && self.faults.is_empty() {
            let hint = format!(
                "for a joint j1 a record has j1_motor_deg, j1_link_deg and j1_motor_torque_nm; joints of the arm: {}; columns \
                 found: {}; other names are mapped by \"columns\" of campaign.json",
                joints.join(", "),
                self.header.join(", ")
            );
            self.fault(Some(1), "", "no joint has both a motor's and a link's angle".into(), &hint);
        }
        let time = time.filter(|_| self.faults.is_empty())?;
        let mut out = self.empty(&columns);
        for record in records {
            match record {
                Ok(record) => self.push(&mut out, &columns, time, &record),
                Err(e) => self.fault(None, "", format!("not valid CSV: {e}"), "save the table as plain CSV"),
            }
        }
        self.finish(&mut out, &columns);
        out.remarks.extend(self.unused(time, &columns));
        out.remarks.extend(slow_rows(&out));
        Some(out)
    }

    fn fault(&mut self, line: Option<usize>, field: &str, problem: String, hint: &str) {
        self.faults.push(Fault {
            file: self.file.clone(),
            line,
            field: field.into(),
            problem,
            hint: hint.into(),
        });
    }

    /// Name in the file of the column that this program calls `column`.
    fn name_of(&self, column: &str) -> String {
        let own = self.spec.columns.iter().find(|(ours, _)| ours == column);
        let mut common = self.spec.common_columns.iter();
        let mapped =
            own.or_else(|| common.find(|(ours, theirs)| ours == column && self.header.contains(theirs)));
        mapped.map_or(column, |(_, theirs)| theirs).to_string()
    }

    fn index(&self, column: &str) -> Option<usize> {
        let name = self.name_of(column);
        self.header.iter().position(|c| *c == name)
    }

    fn required(&mut self, column: &str) -> Option<usize> {
        self.index(column).or_else(|| {
            let name = self.name_of(column);
            let known: Vec<&str> = self.header.iter().map(String::as_str).collect();
            let near = closest(&name, &known).map_or(String::new(), |n| format!("is it \"{n}\"? "));
            let hint = format!("{near}columns found: {}", self.header.join(", "));
            self.fault(Some(1), &name, "the column is missing".into(), &hint);
            None
        })
    }

    /// Adds a fault for each column that `campaign.json` names and the file lacks, for each name of a column that is
    /// unknown, and for each joint that `campaign.json` names and the arm lacks.
    fn check_names(&mut self, joints: &[String]) {
        for (ours, theirs) in self.spec.columns.clone() {
            if !self.header.contains(&theirs) {
                let hint = format!("columns found: {}", self.header.join(", "));
                let problem = format!("campaign.json gives it for {ours}, but the file has no such column");
                self.fault(Some(1), &theirs, problem, &hint);
            }
        }
        let spec = self.spec;
        for (ours, _) in spec.columns.iter().chain(&spec.common_columns) {
            let of_joint =
                SUFFIXES.iter().any(|s| ours.strip_suffix(s).is_some_and(|j| joints.iter().any(|k| k == j)));
            if ours != "t_s" && !of_joint {
                let hint = format!(
                    "known are t_s and, for each joint ({}), the joint's name followed by one of: {}",
                    joints.join(", "),
                    SUFFIXES.join(", ")
                );
                self.fault(None, ours, "\"columns\" of campaign.json maps an unknown name".into(), &hint);
            }
        }
        let stated = [&spec.ratio, &spec.torque_constant_nm_per_a, &spec.rotor_inertia_kgm2];
        for name in stated.iter().flat_map(|p| p.joints()).filter(|n| !joints.iter().any(|j| j == n)) {
            let hint = format!("joints of the arm: {}", joints.join(", "));
            self.fault(
                None,
                name,
                "campaign.json states a constant of this joint, which the arm lacks".into(),
                &hint,
            );
        }
    }

    /// Finds the columns of a joint. `None` if the file lacks its motor angle, or if the ratio that the angle needs is
    /// not stated; the latter is a fault.
    fn columns_of(&mut self, joint: &str) -> Option<Columns> {
        let ratio = self.spec.ratio.of(joint);
        let at_output = self.index(&format!("{joint}_motor_deg")).map(|c| (c, 1.0));
        let shaft = format!("{joint}_motor_shaft_deg");
        let at_shaft = self.index(&shaft).filter(|_| at_output.is_none());
        if at_shaft.is_some() && ratio.is_none() {
            let hint = format!("add \"ratio\": {{\"{joint}\": 100}} to campaign.json");
            self.fault(Some(1), &shaft, "an angle of the shaft needs the ratio".into(), &hint);
        }
        let motor = at_output.or_else(|| Some((at_shaft?, 1.0 / ratio?)))?;
        let to_output = if self.spec.torque_at_output { 1.0 } else { ratio.unwrap_or(1.0) };
        let torque = self.index(&format!("{joint}_motor_torque_nm")).map(|c| (c, to_output));
        let current = format!("{joint}_current_a");
        let by_current = self.index(&current).filter(|_| torque.is_none());
        let constant = self.spec.torque_constant_nm_per_a.of(joint);
        if by_current.is_some() && constant.is_none() {
            let hint = format!("add \"torque_constant_nm_per_a\": {{\"{joint}\": 0.1}} to campaign.json");
            self.fault(Some(1), &current, "a current needs the torque constant".into(), &hint);
        }
        Some(Columns {
            joint: joint.into(),
            motor,
            link: self.index(&format!("{joint}_link_deg")),
            torque: torque.or_else(|| Some((by_current?, constant? * to_output))),
        })
    }

    /// Sentence that lists the columns of the file that are not used; `None` if all are used.
    fn unused(&self, time: usize, columns: &[Columns]) -> Option<String> {
        let of_joint = |c: &Columns| [Some(c.motor.0), c.link, c.torque.map(|t| t.0)];
        let used: Vec<usize> = columns.iter().flat_map(of_joint).flatten().chain([time]).collect();
        let names =
            self.header.iter().enumerate().filter(|(i, _)| !used.contains(i)).map(|(_, n)| n.as_str());
        let names: Vec<&str> = names.collect();
        (!names.is_empty()).then(|| format!("{}: columns that are not used: {}", self.file, names.join(", ")))
    }

    /// The record without rows, with the constants of each joint.
    fn empty(&self, columns: &[Columns]) -> Record {
        let signals = |c: &Columns| {
            let ratio = self.spec.ratio.of(&c.joint);
            JointSignals {
                joint: c.joint.clone(),
                ratio: ratio.map(f64::abs),
                rotor_inertia_kgm2: self
                    .spec
                    .rotor_inertia_kgm2
                    .of(&c.joint)
                    .map(|inertia| inertia * ratio.unwrap_or(1.0).powi(2)),
                motor_rad: Vec::new(),
                link_rad: Vec::new(),
                torque_nm: Vec::new(),
            }
        };
        Record {
            file: self.file.clone(),
            t_s: Vec::new(),
            joints: columns.iter().map(signals).collect(),
            remarks: Vec::new(),
        }
    }

    /// Appends the row `cells` to the record `out`, in SI units at the output of the gear. The index `time` is that of
    /// the column of times. Faults are collected.
    fn push(&mut self, out: &mut Record, columns: &[Columns], time: usize, cells: &csv::ByteRecord) {
        let line = cells.position().map(|p| p.line() as usize);
        if cells.iter().all(<[u8]>::is_empty) {
            return;
        }
        if cells.len() != self.header.len() {
            let problem = format!("has {} cells, the header has {}", cells.len(), self.header.len());
            return self.fault(line, "", problem, "give every row a value for every column");
        }
        let before = self.faults.len();
        let t_s = self.number(cells, line, time);
        if out.t_s.last().is_some_and(|last| t_s <= *last) {
            let problem = format!("{t_s} s does not come after {} s", out.t_s[out.t_s.len() - 1]);
            self.fault(
                line,
                "t_s",
                problem,
                "sort the rows by time and give each time once; cut records apart",
            );
        }
        for (c, signals) in columns.iter().zip(&mut out.joints) {
            signals.motor_rad.push(self.number(cells, line, c.motor.0).to_radians());
            if let Some(link) = c.link {
                signals.link_rad.push(self.number(cells, line, link).to_radians());
            }
            if let Some((torque, factor)) = c.torque {
                signals.torque_nm.push(self.number(cells, line, torque) * factor);
            }
        }
        if self.faults.len() == before {
            out.t_s.push(t_s);
        }
    }

    fn number(&mut self, cells: &csv::ByteRecord, line: Option<usize>, column: usize) -> f64 {
        let text = String::from_utf8_lossy(&cells[column]);
        match text.parse::<f64>() {
            Ok(x) if x.is_finite() => x,
            _ => {
                let problem = match text.is_empty() {
                    true => "the cell is empty".to_string(),
                    false => format!("\"{text}\" is not a finite number"),
                };
                let name = self.header[column].clone();
                self.fault(line, &name, problem, "remove the row, or give the value that was measured");
                0.0
            }
        }
    }

    /// Checks the number of rows, removes jumps of a whole turn from the angles, and checks that motor and link of each
    /// joint move together. Faults are collected.
    fn finish(&mut self, out: &mut Record, columns: &[Columns]) {
        if self.faults.is_empty() && out.t_s.len() < FEWEST_ROWS {
            let problem = format!("has {} rows", out.t_s.len());
            self.fault(None, "", problem, &format!("a record against time needs at least {FEWEST_ROWS}"));
        }
        for (signals, c) in out.joints.iter_mut().zip(columns) {
            let is_at_shaft = c.motor.1 != 1.0;
            // a motor shaft may turn by more than half a turn between two rows, so a change of the angle by a whole
            // turn is taken for a jump only if all angles are within one turn
            if !is_at_shaft || range(&signals.motor_rad) < ONE_TURN_RAD {
                unwrap(&mut signals.motor_rad);
            }
            signals.motor_rad.iter_mut().for_each(|angle| *angle *= c.motor.1);
            unwrap(&mut signals.link_rad);
            if self.faults.is_empty()
                && let Some(problem) = not_together(signals)
            {
                let hint = "check the sign and the unit of both angles, the ratio, and which of them is at the shaft";
                self.fault(None, &format!("{}_link_deg", signals.joint), problem, hint);
            }
        }
    }
}

/// A remark if the usual time between rows is so long that the times may be in milliseconds or microseconds. `None` if
/// it is not.
fn slow_rows(record: &Record) -> Option<String> {
    let step_s = usual_step_s(&record.t_s);
    (step_s > LONGEST_STEP_S).then(|| {
        format!(
            "{}: rows follow each other after {step_s} s: t_s must be in seconds, and these times may be in milliseconds or \
             microseconds; time shifts, speeds and frictions are then wrong by this factor",
            record.file
        )
    })
}

/// Usual (median) time between two rows \[s\].
pub(crate) fn usual_step_s(t_s: &[f64]) -> f64 {
    median(t_s.windows(2).map(|w| w[1] - w[0]).collect())
}

/// Difference of the largest and the smallest of the angles \[rad\].
fn range(angles_rad: &[f64]) -> f64 {
    let ends = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = angles_rad.iter().fold(ends, |(low, high), a| (low.min(*a), high.max(*a)));
    high - low
}

/// Problem of a joint whose link and motor move in proportion, but by clearly different angles or in opposite
/// directions. `None` if they move by about the same angle, or if one of them hardly moves, as in a test with a locked
/// output.
fn not_together(signals: &JointSignals) -> Option<String> {
    let (motor_rad, link_rad) = (&signals.motor_rad, &signals.link_rad);
    if link_rad.is_empty() || range(motor_rad).min(range(link_rad)) < LEAST_RANGE_RAD {
        return None;
    }
    let count = motor_rad.len() as f64;
    let [of_motor, of_link] = [motor_rad, link_rad].map(|x| x.iter().sum::<f64>() / count);
    let product = |a: &[f64], a0: f64, b: &[f64], b0: f64| -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - a0) * (b - b0)).sum()
    };
    let both = product(motor_rad, of_motor, link_rad, of_link);
    let motors = product(motor_rad, of_motor, motor_rad, of_motor);
    let links = product(link_rad, of_link, link_rad, of_link);
    let slope = both / motors;
    if both.powi(2) < TOGETHER * motors * links || (1.0 / MOST_SLOPE..MOST_SLOPE).contains(&slope) {
        return None;
    }
    Some(match slope < 0.0 {
        true => format!("the link turns against the motor: by {slope:.4} rad for each radian"),
        false => format!("the link turns by {slope:.4} rad for each radian of the motor, both at the output"),
    })
}

/// Removes jumps of a whole turn from a list of angles \[rad\]. They occur where an encoder that shows one turn starts
/// again at zero.
fn unwrap(angles_rad: &mut [f64]) {
    let mut turns = 0.0;
    for i in 1..angles_rad.len() {
        let step = angles_rad[i] + turns - angles_rad[i - 1];
        turns -= (step / std::f64::consts::TAU).round() * std::f64::consts::TAU;
        angles_rad[i] += turns;
    }
}
