//! Reads a campaign: the arm file, what `campaign.json` states about arm and readings, and the readings.

use super::cells::Purpose;
use super::components::{Components, DISPLACEMENT, POSITION, leave_out_idle, never_read};
use super::declared::{self, DeclaredSession};
use super::keys::{CAMPAIGN, POSITIONS, TOLERANCE};
use super::record::{Record, read_all};
use super::record_spec::{RecordSpec, read_records};
use super::rows::{
    ModalRow, PositionRow, StaticRow, WindupRow, modal_rows, position_rows, static_rows, windup_rows,
};
use super::source::{DEFAULT_FILES, Source, read_sources};
use super::table::Table;
use crate::arm::effect::catalogue::KINDS;
use crate::arm::effect::channel::Channel;
use crate::arm::file::read_arm;
use crate::arm::pose::{DrivenJoint, Motion};
use crate::arm::{Arm, Element};
use crate::catalog::Catalogs;
use crate::input::json::{Document, Fault, Faults, InputError, Node};
use std::path::{Path, PathBuf};

/// Tolerance of parts, as fractions of nominal values. 95 % of faultless parts deviate from their nominal value by no
/// more than this.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Tolerance of the stiffness of each joint. Joints deviate independently of each other.
    pub joint_stiffness: f64,
    /// Tolerance of one factor for each material, by which both its moduli E and G are multiplied.
    pub modulus: f64,
    /// Tolerance of the mass of each joint. Joints deviate independently of each other.
    pub joint_mass: f64,
    /// Tolerance of the tilting stiffness of the output bearing of each joint. Bearings deviate independently of each
    /// other.
    pub bearing_stiffness: f64,
}

/// What `campaign.json` says about absolute positions.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PositionsSpec {
    /// Whether the position and attitude of the base in the instrument's frame are unknown.
    pub base_placement: bool,
    /// Whether the position of each measured point in the last frame of the arm is unknown.
    pub tool_offset: bool,
    /// Whether the zero of the angle of each joint may deviate from its nominal value.
    pub joint_offsets: bool,
    /// Whether each link's vector and each joint's axis may deviate from their nominal values.
    pub geometry: bool,
    /// Whether the direction of gravity may deviate from the -z axis of the arm's base.
    pub gravity_direction: bool,
    /// Names of the links whose mounting is unknown: position and attitude of everything outboard of such a link are
    /// fitted. An example is an arm that is bolted to a trunk at an unknown attitude.
    pub mounts: Vec<String>,
    /// Sessions that `campaign.json` declares because something was moved on purpose.
    pub sessions: Vec<DeclaredSession>,
}

impl PositionsSpec {
    /// Whether the direction of gravity must be fitted. This is so if `campaign.json` states it. It is also so if both
    /// the base placement and the axis of the first joint are free, because positions cannot tell which of the two is
    /// not vertical.
    pub fn frees_gravity(&self) -> bool {
        self.gravity_direction || (self.geometry && self.base_placement)
    }
}

/// Content of `campaign.json`.
#[derive(Debug, Clone, PartialEq)]
pub struct Statement {
    /// Name of the campaign.
    pub name: String,
    /// How far stiffnesses, masses and moduli of good parts may be from their nominal values. Calibration may change
    /// them within this tolerance.
    pub tolerance: Tolerance,
    /// Density of the payloads, from which their buoyancy in a fluid follows \[kg/m³\].
    pub payload_density_kg_m3: f64,
    /// Whether the links are rigid in the nominal model.
    pub rigid_links: bool,
    /// Names of the effects that may be named as causes; `None` if all effects may be.
    pub effects: Option<Vec<String>>,
    /// What is unknown in absolute positions, and the declared sessions.
    pub positions: PositionsSpec,
    /// Files, columns and constants of each record against time.
    pub records: Vec<RecordSpec>,
    /// Arm file of the nominal arm, in the folder of `campaign.json`.
    pub(crate) arm_file: String,
    /// Arm files of other arms on the same trunk (the elements at the base that all arms have in common), in the folder
    /// of `campaign.json`.
    pub other_arm_files: Vec<String>,
    /// File and columns of each channel, in the order of [`Channel::ALL`]; `None` if nothing is stated.
    sources: [Option<Source>; 4],
}

/// A campaign: an arm, what is stated about it, and its readings. All of it was read and checked.
#[derive(Debug, Clone)]
pub struct Campaign {
    /// Folder of the campaign.
    pub folder: PathBuf,
    /// Content of its `campaign.json`.
    pub statement: Statement,
    /// The nominal arm, as its arm file describes it.
    pub arm: Arm,
    /// Other arms on the same trunk (see [`Campaign::trunk`]). Only absolute positions use them.
    pub other_arms: Vec<Arm>,
    /// Tip displacements, in the order of the file.
    pub statics: Vec<StaticRow>,
    /// Natural frequencies, in the order of the file.
    pub modal: Vec<ModalRow>,
    /// Twists of single joints on the bench, in the order of the file.
    pub windup: Vec<WindupRow>,
    /// Absolute positions, in the order of the file.
    pub positions: Vec<PositionRow>,
    /// Sentences on readings that were left out, for example a column that has the same value in all rows.
    pub remarks: Vec<String>,
    /// Index in `positions` of the first row of each campaign that was joined to this one. Empty if no campaign with
    /// positions was joined.
    pub(crate) joined_at: Vec<usize>,
    /// Records against time.
    pub records: Vec<Record>,
    /// BLAKE3 hash of all files of the campaign, in hexadecimal digits; empty if it was not read from files.
    pub hash: String,
}

const DEFAULT_PAYLOAD_DENSITY_KG_M3: f64 = 7850.0;

/// The file is missing, or it has faults. The error lists all of them.
pub(crate) fn read_statement(path: &Path) -> Result<Statement, InputError> {
    let document = Document::read(path)?;
    let statement = statement(&document.root());
    Ok(document.finish(statement)?)
}

/// Reads the arm file of a campaign; `None` if it has faults or is missing, which is added to `faults`.
fn read_arm_of(path: &Path, catalogs: &Catalogs, faults: &mut Vec<Fault>) -> Result<Option<Arm>, InputError> {
    if path.exists() {
        return keep_faults(read_arm(path, catalogs), faults);
    }
    let hint = "the arm file of the campaign belongs here; `armwright new campaign ARM --out DIR` starts a folder with a copy \
                of its arm";
    faults.push(missing(path, hint));
    Ok(None)
}

/// The fault that a file is missing.
fn missing(path: &Path, hint: &str) -> Fault {
    let file = path.display().to_string();
    Fault {
        file,
        line: None,
        field: String::new(),
        problem: "there is no such file".into(),
        hint: hint.into(),
    }
}

/// Reads the content of `campaign.json`. `None` after recording a fault.
fn statement(node: &Node) -> Option<Statement> {
    let root = node.shaped(&CAMPAIGN)?;
    let name = root.or("name", "campaign".to_string(), |n| n.string().map(String::from));
    let arm_file = root.or("arm", "arm.json".to_string(), |n| n.string().map(String::from));
    let other_arm_files = root.or("other_arms", Vec::new(), read_names);
    let tolerance = root.or("tolerance", DEFAULT_TOLERANCE, read_tolerance);
    let payload_density_kg_m3 = root.or("conventions", DEFAULT_PAYLOAD_DENSITY_KG_M3, read_payload_density);
    let rigid_links = root.or("links", false, |n| match n.string()? {
        "rigid" => Some(true),
        "full" => Some(false),
        other => n.fault(format!("\"{other}\" is not known"), "choose one of: rigid, full"),
    });
    let effects = root.or("effects", None, |n| read_effect_names(n).map(Some));
    let positions = root.or("positions", PositionsSpec::default(), read_positions);
    let records = read_records(&root);
    Some(Statement {
        name: name?,
        tolerance: tolerance?,
        payload_density_kg_m3: payload_density_kg_m3?,
        rigid_links: rigid_links?,
        effects: effects?,
        positions: positions?,
        records: records?,
        arm_file: arm_file?,
        other_arm_files: other_arm_files?,
        sources: read_sources(&root),
    })
}

/// Tolerance if `campaign.json` has no key `tolerance`. If it has this key, each tolerance that it does not state is
/// zero.
const DEFAULT_TOLERANCE: Tolerance =
    Tolerance { joint_stiffness: 0.10, modulus: 0.03, joint_mass: 0.02, bearing_stiffness: 0.0 };

/// Reads the density of the payloads from `conventions` \[kg/m³\]. Other keys of `conventions` are for people and are
/// ignored. Returns `None` after recording a fault.
fn read_payload_density(node: &Node) -> Option<f64> {
    let (_, density) = node.entries()?.into_iter().find(|(key, _)| *key == "payload_density_kg_m3").unzip();
    density.map_or(Some(DEFAULT_PAYLOAD_DENSITY_KG_M3), |density| density.positive())
}

fn read_tolerance(node: &Node) -> Option<Tolerance> {
    let object = node.shaped(&TOLERANCE)?;
    let part = |key, default| {
        object.or(key, default, |n| match n.non_negative()? {
            x if x < 1.0 => Some(x),
            x => n.fault(format!("= {x} is no part of 1"), "write 0.05 for 5 %"),
        })
    };
    let (k, e, m) = (part("joint_stiffness", 0.0), part("modulus", 0.0), part("joint_mass", 0.0));
    let bearing = part("bearing_stiffness", 0.0);
    Some(Tolerance { joint_stiffness: k?, modulus: e?, joint_mass: m?, bearing_stiffness: bearing? })
}

fn read_positions(node: &Node) -> Option<PositionsSpec> {
    let object = node.shaped(&POSITIONS)?;
    let flags = ["base_placement", "tool_offset", "joint_offsets", "geometry", "gravity_direction"]
        .map(|key| object.or(key, false, Node::boolean));
    let mounts = object.or("mounts", Vec::new(), read_names);
    let sessions = object.or("sessions", Vec::new(), declared::read);
    Some(PositionsSpec {
        base_placement: flags[0]?,
        tool_offset: flags[1]?,
        joint_offsets: flags[2]?,
        geometry: flags[3]?,
        gravity_direction: flags[4]?,
        mounts: mounts?,
        sessions: sessions?,
    })
}

fn read_effect_names(node: &Node) -> Option<Vec<String>> {
    let known: Vec<&str> = KINDS.iter().map(|k| k.name).collect();
    let read = |n: &Node| match n.string()? {
        name if known.contains(&name) => Some(name.to_string()),
        name => n.fault(
            format!("effect \"{name}\" is not known"),
            &format!("known effects: {}", known.join(", ")),
        ),
    };
    let names: Vec<Option<String>> = node.array()?.iter().map(read).collect();
    names.into_iter().collect()
}

fn read_names(node: &Node) -> Option<Vec<String>> {
    node.array()?.iter().map(|n| n.string().map(String::from)).collect()
}

impl Statement {
    /// File and columns of a channel, as `campaign.json` states them. If it states nothing, all fields are empty and
    /// the usual names apply.
    pub(crate) fn source(&self, channel: Channel) -> Source {
        self.sources[channel as usize].clone().unwrap_or_default()
    }

    /// Whether the effect with the name `effect` may be named as a cause.
    pub fn considers(&self, effect: &str) -> bool {
        self.effects.as_ref().is_none_or(|list| list.iter().any(|name| name == effect))
    }
}

/// Largest number of readings of a channel. Up to this number, time and memory were measured (docs/speed.md).
pub(crate) const MOST_READINGS: usize = 100_000;

impl Campaign {
    /// Reads the campaign in the folder `folder`. The path of a file in the folder, such as `campaign.json`, is
    /// accepted too.
    ///
    /// # Errors
    /// A file cannot be read, or there are faults. The error lists all faults of all files.
    pub fn read(folder: &Path, catalogs: &Catalogs) -> Result<Self, InputError> {
        if !folder.join("campaign.json").exists() && folder.is_file() {
            return Self::read(folder.parent().unwrap_or(folder), catalogs);
        }
        let mut faults = Vec::new();
        let statement = keep_faults(read_statement(&folder.join("campaign.json")), &mut faults)?;
        let arm_file = statement.as_ref().map_or("arm.json", |s| s.arm_file.as_str());
        let arm = read_arm_of(&folder.join(arm_file), catalogs, &mut faults)?;
        let mut other_arms = Vec::new();
        for file in statement.iter().flat_map(|s| &s.other_arm_files) {
            other_arms.extend(keep_faults(read_arm(&folder.join(file), catalogs), &mut faults)?);
        }
        let (Some(statement), Some(arm)) = (statement, arm) else { return Err(Faults(faults).into()) };
        let mut campaign = Self {
            folder: folder.to_path_buf(),
            statement,
            arm,
            other_arms,
            statics: Vec::new(),
            modal: Vec::new(),
            windup: Vec::new(),
            positions: Vec::new(),
            remarks: Vec::new(),
            joined_at: Vec::new(),
            records: Vec::new(),
            hash: String::new(),
        };
        faults.extend(campaign.faults());
        let arms = std::iter::once(&campaign.arm).chain(&campaign.other_arms);
        faults.extend(arms.filter_map(|arm| arm.tilt_fault(&arm.name)));
        for channel in Channel::ALL {
            campaign.read_file(channel, &mut faults)?;
        }
        if !campaign.positions.is_empty() {
            let arms = std::iter::once(&campaign.arm).chain(&campaign.other_arms);
            let faults_of = |arm: &Arm| [arm.springs_fault(&arm.name), arm.turns_with_fault(&arm.name)];
            faults.extend(arms.flat_map(faults_of).flatten());
        }
        let specs = &campaign.statement.records;
        let turning = driven_joints(&campaign.arms()).into_iter().filter(|j| j.motion == Motion::Turns);
        let names: Vec<String> = turning.map(|joint| joint.name).collect();
        campaign.records = read_all(folder, specs, &names, &mut faults)?;
        let declared = declared::problems(&campaign.statement.positions.sessions, &campaign.positions);
        faults.extend(
            declared.into_iter().map(|(what, hint)| campaign.fault("positions.sessions", what, &hint)),
        );
        campaign.hash = campaign.hash_files();
        if faults.is_empty() { Ok(campaign) } else { Err(Faults(faults).into()) }
    }

    /// Reads the file of a channel, if there is one. Its faults are added to `faults`.
    fn read_file(&mut self, channel: Channel, faults: &mut Vec<Fault>) -> Result<(), InputError> {
        let Some(file) = self.file(channel) else { return Ok(()) };
        if !file.exists() {
            let hint = format!(
                "campaign.json names it for the {} readings; `armwright new campaign ARM --out DIR` writes such a file with \
                 its columns",
                channel.word()
            );
            faults.push(missing(&file, &hint));
            return Ok(());
        }
        let source = self.statement.source(channel);
        let mut table = Table::read_from(&file, &source)?;
        table.refuse_more_than(MOST_READINGS);
        self.read_channel(channel, &table);
        self.remarks.extend(table.unused());
        self.remarks.extend(table.rows.is_empty().then(|| {
            format!("{}: has the names of columns and no row of readings: it is not used", table.short_name())
        }));
        faults.extend(table.into_faults());
        Ok(())
    }

    /// Stores the rows of a table. Components that were not measured are left out with a remark (see
    /// [`leave_out_idle`]).
    fn read_channel(&mut self, channel: Channel, table: &Table) {
        match channel {
            Channel::Static => {
                self.statics = static_rows(table, &self.arm, Purpose::Fit);
                let mut read: Vec<&mut Components> =
                    self.statics.iter_mut().map(|r| &mut r.measured).collect();
                self.remarks.extend(never_read(table, &DISPLACEMENT, &read));
                self.remarks.extend(leave_out_idle(&table.short_name(), &DISPLACEMENT, &mut read));
            }
            Channel::Modal => self.modal = modal_rows(table, &self.arm, Purpose::Fit),
            Channel::Windup => self.windup = windup_rows(table, &self.arm, Purpose::Fit),
            Channel::Positions => {
                let names: Vec<&str> = self.arms().iter().map(|a| a.name.as_str()).collect();
                self.positions = position_rows(table, &names, &driven_joints(&self.arms()), Purpose::Fit);
                let mut read: Vec<&mut Components> =
                    self.positions.iter_mut().map(|r| &mut r.measured).collect();
                self.remarks.extend(never_read(table, &POSITION, &read));
                self.remarks.extend(leave_out_idle(&table.short_name(), &POSITION, &mut read));
            }
        }
    }

    /// All arms on the trunk, the arm of the campaign first.
    pub fn arms(&self) -> Vec<&Arm> {
        std::iter::once(&self.arm).chain(&self.other_arms).collect()
    }

    /// Names of the driven joints, in the order of the angles of a pose: those of the first arm, then those that only
    /// other arms have.
    pub fn driven_joint_names(&self) -> Vec<String> {
        driven_joints(&self.arms()).into_iter().map(|joint| joint.name).collect()
    }

    /// A campaign of absolute positions `rows` of points on `arms`, without files. The first arm is the arm of the
    /// campaign.
    ///
    /// # Errors
    /// Two arms have the same name, two elements outboard of the trunk have the same name, or a mount names no
    /// link.
    pub fn of_positions(
        statement: &Statement,
        arms: &[&Arm],
        rows: Vec<PositionRow>,
    ) -> Result<Self, Faults> {
        let campaign = Self {
            folder: PathBuf::new(),
            statement: statement.clone(),
            arm: arms[0].clone(),
            other_arms: arms[1..].iter().map(|arm| (*arm).clone()).collect(),
            statics: Vec::new(),
            modal: Vec::new(),
            windup: Vec::new(),
            positions: rows,
            remarks: Vec::new(),
            joined_at: Vec::new(),
            records: Vec::new(),
            hash: String::new(),
        };
        let faults = campaign.faults();
        if faults.is_empty() { Ok(campaign) } else { Err(Faults(faults)) }
    }

    /// Number of elements of the trunk, which are the elements from the base on that all arms have in common. All
    /// elements of the arm if it is the only one.
    pub fn trunk(&self) -> usize {
        let shared =
            |other: &Arm| self.arm.chain.iter().zip(&other.chain).take_while(|(a, b)| a == b).count();
        self.other_arms.iter().map(shared).min().unwrap_or(self.arm.chain.len())
    }

    /// Faults that show when the arms are compared with one another, and names of mounts in `campaign.json` that are no
    /// link of any arm. Empty if there are none.
    fn faults(&self) -> Vec<Fault> {
        let mut out = Vec::new();
        let trunk: Vec<&str> = self.arm.chain[..self.trunk()].iter().map(Element::name).collect();
        let mut taken: Vec<&str> = self.arm.chain.iter().map(Element::name).collect();
        let mut names = vec![self.arm.name.as_str()];
        for other in &self.other_arms {
            if names.contains(&other.name.as_str()) {
                out.push(self.fault(
                    "other_arms",
                    format!("two arms are called \"{}\"", other.name),
                    "give each a name of its own",
                ));
            }
            names.push(&other.name);
            for name in other.chain.iter().map(Element::name).filter(|n| !trunk.contains(n)) {
                if taken.contains(&name) {
                    let problem =
                        format!("\"{name}\" of {} is also in another arm, but not the same", other.name);
                    out.push(self.fault(
                        "other_arms",
                        problem,
                        "elements of the trunk are the same in all arms; others have names of their own",
                    ));
                }
                taken.push(name);
            }
        }
        let links: Vec<&str> = self.arms().iter().flat_map(|a| a.links()).map(|l| l.name.as_str()).collect();
        for name in self.statement.positions.mounts.iter().filter(|m| !links.contains(&m.as_str())) {
            let hint = format!("the arms' links: {}", links.join(", "));
            out.push(self.fault("positions.mounts", format!("\"{name}\" is no link"), &hint));
        }
        out
    }

    /// A copy of the campaign with displacements, frequencies and bench readings only: without absolute positions,
    /// records and other arms.
    pub fn without_positions(&self) -> Self {
        Self { positions: Vec::new(), records: Vec::new(), other_arms: Vec::new(), ..self.clone() }
    }

    /// A copy of the campaign with absolute positions as its only readings.
    pub fn positions_alone(&self) -> Self {
        Self {
            statics: Vec::new(),
            modal: Vec::new(),
            windup: Vec::new(),
            records: Vec::new(),
            ..self.clone()
        }
    }

    /// Whether the campaign has displacements, frequencies or bench readings.
    pub fn has_displacements(&self) -> bool {
        !self.statics.is_empty() || !self.modal.is_empty() || !self.windup.is_empty()
    }

    fn fault(&self, field: &str, problem: String, hint: &str) -> Fault {
        let file = self.folder.join("campaign.json").display().to_string();
        Fault { file, line: None, field: field.into(), problem, hint: hint.into() }
    }

    /// Path of the file of a channel: the file that `campaign.json` names, otherwise the file with the usual name if it
    /// exists. `None` if there is neither.
    fn file(&self, channel: Channel) -> Option<PathBuf> {
        let usual = self.folder.join(DEFAULT_FILES[channel as usize]);
        match self.statement.source(channel).file {
            Some(file) => Some(self.folder.join(file)),
            None => usual.exists().then_some(usual),
        }
    }

    /// Paths of all files that were read.
    pub fn input_files(&self) -> Vec<PathBuf> {
        let others = self.statement.other_arm_files.iter();
        let named = ["campaign.json", &self.statement.arm_file].into_iter().chain(others.map(String::as_str));
        let files =
            named.map(|f| self.folder.join(f)).chain(Channel::ALL.into_iter().filter_map(|c| self.file(c)));
        let records = self.records.iter().map(|r| PathBuf::from(&r.file));
        files.chain(records).collect()
    }

    /// BLAKE3 hash of the content of all files that were read, in hexadecimal digits.
    fn hash_files(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        for file in self.input_files() {
            hasher.update(&std::fs::read(file).unwrap_or_default());
        }
        hasher.finalize().to_hex().to_string()
    }

    /// Appends the readings of further campaigns of the same arm to this one. Names and hashes are combined too.
    ///
    /// # Errors
    /// The arms or the tolerances of two campaigns differ.
    pub fn join(mut self, others: Vec<Campaign>) -> Result<Self, String> {
        for other in others {
            let is_same = other.arm == self.arm && other.other_arms == self.other_arms;
            if !is_same || other.statement.tolerance != self.statement.tolerance {
                return Err(format!(
                    "{} and {} measure different arms or state different tolerances: reconcile them one by one",
                    self.folder.display(),
                    other.folder.display()
                ));
            }
            self.statics.extend(other.statics);
            self.modal.extend(other.modal);
            self.windup.extend(other.windup);
            let rows = self.positions.len();
            let later = other.statement.positions.sessions.into_iter().map(|session| session.after(rows));
            self.statement.positions.sessions.extend(later);
            if rows > 0 && !other.positions.is_empty() {
                self.joined_at.push(rows);
            }
            self.positions.extend(other.positions);
            self.remarks.extend(other.remarks);
            self.records.extend(other.records);
            self.statement.name = format!("{}+{}", self.statement.name, other.statement.name);
            self.hash = blake3::hash(format!("{}{}", self.hash, other.hash).as_bytes()).to_hex().to_string();
        }
        Ok(self)
    }
}

/// Driven joints of several arms, in the order of the angles of a pose: those of the first arm, then those that only
/// other arms have.
pub(crate) fn driven_joints(arms: &[&Arm]) -> Vec<DrivenJoint> {
    let mut out: Vec<DrivenJoint> = Vec::new();
    for joint in arms.iter().flat_map(|arm| arm.driven_joints()) {
        if out.iter().all(|known| known.name != joint.name) {
            out.push(joint);
        }
    }
    out
}

/// Moves the faults of a file to `faults`, so that the other files are read too. The value is then `None`.
fn keep_faults<T>(
    result: Result<T, InputError>,
    faults: &mut Vec<crate::input::json::Fault>,
) -> Result<Option<T>, InputError> {
    match result {
        Ok(value) => Ok(Some(value)),
        Err(InputError::Faulty(found)) => {
            faults.extend(found.0);
            Ok(None)
        }
        Err(other) => Err(other),
    }
}
