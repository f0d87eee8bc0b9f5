//! What `campaign.json` says about records against time: their files, the names of their columns, and constants of the
//! drives.

use super::keys::RECORD;
use crate::input::json::{Node, Object};

/// Name of the file that is read if `campaign.json` names none.
pub(crate) const DEFAULT_FILE: &str = "record.csv";

/// What follows the name of a joint in the name of a record's column.
pub(crate) const SUFFIXES: [&str; 5] =
    ["_motor_deg", "_motor_shaft_deg", "_link_deg", "_motor_torque_nm", "_current_a"];

/// A constant of the drives: one number for all joints, or a number for each joint by its name.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PerJoint(Vec<(Option<String>, f64)>);

impl PerJoint {
    /// The constant of the joint with the name `joint`; `None` if nothing is stated for it.
    pub fn of(&self, joint: &str) -> Option<f64> {
        let own = self.0.iter().find(|(name, _)| name.as_deref() == Some(joint));
        own.or_else(|| self.0.iter().find(|(name, _)| name.is_none())).map(|(_, value)| *value)
    }

    /// Names of the joints for which `campaign.json` states a number by name.
    pub fn joints(&self) -> impl Iterator<Item = &str> {
        self.0.iter().filter_map(|(name, _)| name.as_deref())
    }
}

/// One record: the name of its file, and what its columns mean.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RecordSpec {
    /// Name of the file, in the folder of `campaign.json`.
    pub file: String,
    /// Whether `campaign.json` has an entry for this record. If it has none, the file need not exist.
    pub is_named: bool,
    /// Columns whose names differ, as pairs: the name in this program, and the name in the file.
    pub columns: Vec<(String, String)>,
    /// Pairs of names as in `columns`, for every record. A record need not have these columns.
    pub(crate) common_columns: Vec<(String, String)>,
    /// Gear ratio: turns of the motor for one turn of the output.
    pub ratio: PerJoint,
    /// Torque at the motor shaft for each ampere \[N m/A\].
    pub torque_constant_nm_per_a: PerJoint,
    /// Inertia of rotor and wave generator \[kg m²\], at the motor shaft if a ratio is stated, otherwise at the output.
    pub rotor_inertia_kgm2: PerJoint,
    /// Whether the torques in the file are at the output of the gear. If not, and a ratio is stated, they are at the
    /// motor shaft.
    pub torque_at_output: bool,
}

/// Reads `records` of `campaign.json`. If the list is absent, the result is one record in [`DEFAULT_FILE`], which need
/// not exist. Constants that an entry does not state are those of `campaign.json` itself. `None` after recording a
/// fault.
pub(crate) fn read_records(root: &Object) -> Option<Vec<RecordSpec>> {
    let common = RecordSpec { file: DEFAULT_FILE.into(), ..RecordSpec::default() };
    let names = root.or("columns", Vec::new(), read_common_columns);
    let common = RecordSpec { common_columns: names?, ..read_constants(root, &common)? };
    let Some(node) = root.optional("records") else { return Some(vec![common]) };
    let read: Vec<Option<RecordSpec>> = node.array()?.iter().map(|n| read_record(n, &common)).collect();
    read.into_iter().collect()
}

fn read_record(node: &Node, common: &RecordSpec) -> Option<RecordSpec> {
    let object = node.shaped(&RECORD)?;
    let file = object.or("file", common.file.clone(), |n| n.string().map(String::from));
    let columns = object.or("columns", Vec::new(), read_columns);
    let constants = read_constants(&object, common);
    Some(RecordSpec { file: file?, is_named: true, columns: columns?, ..constants? })
}

fn read_constants(object: &Object, common: &RecordSpec) -> Option<RecordSpec> {
    let ratio = object.or("ratio", common.ratio.clone(), |n| read_per_joint(n, |x| x != 0.0));
    let constant = object.or("torque_constant_nm_per_a", common.torque_constant_nm_per_a.clone(), |n| {
        read_per_joint(n, |x| x != 0.0)
    });
    let inertia = object
        .or("rotor_inertia_kgm2", common.rotor_inertia_kgm2.clone(), |n| read_per_joint(n, |x| x >= 0.0));
    let at_output = object.or("torque_at", common.torque_at_output, |n| match n.string()? {
        "output" => Some(true),
        "shaft" => Some(false),
        other => n.fault(format!("\"{other}\" is not known"), "choose one of: shaft, output"),
    });
    Some(RecordSpec {
        ratio: ratio?,
        torque_constant_nm_per_a: constant?,
        rotor_inertia_kgm2: inertia?,
        torque_at_output: at_output?,
        ..common.clone()
    })
}

/// The entries of `columns` of `campaign.json` that name columns of records: `t_s`, or a joint with one of the
/// [`SUFFIXES`].
pub(crate) fn record_columns<'a>(columns: &Node<'a>) -> Vec<(&'a str, Node<'a>)> {
    let is_of_record = |name: &str| name == "t_s" || SUFFIXES.iter().any(|suffix| name.ends_with(suffix));
    let entries = if columns.value().is_object() { columns.entries() } else { None };
    entries.unwrap_or_default().into_iter().filter(|(name, _)| is_of_record(name)).collect()
}

fn read_common_columns(columns: &Node) -> Option<Vec<(String, String)>> {
    let read = |(name, n): (&str, Node)| Some((name.to_string(), n.string()?.trim().to_string()));
    record_columns(columns).into_iter().map(read).collect()
}

fn read_columns(node: &Node) -> Option<Vec<(String, String)>> {
    let read = node.entries()?.into_iter().map(|(name, n)| Some((name.to_string(), n.string()?.to_string())));
    read.collect()
}

/// Reads a constant of the drives: one number for all joints, or an object `{"j1": 100, ...}`. A number for which
/// `allowed` is false is a fault. `None` after recording a fault.
fn read_per_joint(node: &Node, allowed: fn(f64) -> bool) -> Option<PerJoint> {
    let number = |n: &Node| match n.number()? {
        x if allowed(x) => Some(x),
        x => n.fault(format!("= {x} is not possible"), "check sign and unit"),
    };
    if !node.value().is_object() {
        return Some(PerJoint(vec![(None, number(node)?)]));
    }
    let each = node.entries()?.into_iter().map(|(name, n)| Some((Some(name.to_string()), number(&n)?)));
    Some(PerJoint(each.collect::<Option<Vec<_>>>()?))
}
