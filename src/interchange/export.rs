//! Export of an arm in a load case to files of other programs. The result also lists what the files cannot represent
//! and which results the other program should give.

use super::bill::{bill, bill_csv};
use super::calculix::deck::{Step, deck};
use super::calculix::mesh::has_shape;
use super::calculix::model::model;
use super::design_table::design_csv;
use super::left_out::{LeftOut, Remainder};
use super::mjcf::{Mjcf, mjcf};
use super::motors::{motors, plays};
use super::snapshot::{FileSprings, Snapshot};
use super::table_notes::{not_in_bill, not_in_design_table};
use super::tree::TreeOptions;
use super::urdf_out::{TRAVEL_M, stiffness_file, urdf, with_several_drivers};
use super::xml::triple;
use crate::arm::effect::entry::Effect;
use crate::arm::load::{LoadCase, Payload};
use crate::arm::section::Section;
use crate::arm::structure::{Piece, Structure};
use crate::arm::{Arm, Element, GRAVITY_M_S2, LinkBody, LinkModel, Words};
use crate::catalog::Catalogs;
use nalgebra::Vector3;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// The program or file format to export to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Input decks of CalculiX.
    Calculix,
    /// MJCF, the model format of MuJoCo.
    Mjcf,
    /// URDF, a robot description, with a stiffness file.
    Urdf,
    /// Arm file and cases file of this program.
    Json,
    /// A CSV table of the elements.
    Csv,
    /// A bill of materials.
    Bom,
}

impl Words for Format {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("calculix", Self::Calculix),
        ("mjcf", Self::Mjcf),
        ("urdf", Self::Urdf),
        ("json", Self::Json),
        ("csv", Self::Csv),
        ("bom", Self::Bom),
    ];
}

/// The input of an export.
pub(crate) struct Asked<'a> {
    /// The arm to export.
    pub arm: &'a Arm,
    /// The load case that fixes the pose and, by its loads, the stiffness of nonlinear springs.
    pub case: &'a LoadCase,
    /// All load cases. They are written together with an arm file.
    pub cases: &'a [LoadCase],
    /// The file format.
    pub format: Format,
    /// Number of rigid pieces into which MJCF divides each flexible link; 0 for rigid links.
    pub pieces: usize,
    /// Whether joints in MJCF have the backlash of their gears.
    pub backlash: bool,
}

/// The files of an export, with remarks.
#[derive(Default)]
pub(crate) struct Export {
    /// Name and content of each file.
    pub files: Vec<(String, Vec<u8>)>,
    /// Properties of the arm that the files do not represent.
    pub left_out: Vec<LeftOut>,
    /// Remarks for the reader of the files.
    pub notes: Vec<String>,
    /// Results that another program should compute from the files; null if the files are no model.
    pub expected: Value,
}

/// Exports an arm as files of the format that is asked for.
pub(crate) fn export(asked: &Asked, catalogs: &Catalogs) -> Export {
    let mut out = match asked.format {
        Format::Calculix => to_calculix(asked),
        Format::Mjcf => to_mjcf(asked, catalogs),
        Format::Urdf => to_urdf(asked),
        Format::Json => to_json(asked),
        Format::Csv => Export {
            files: vec![("design.csv".into(), design_csv(asked.arm))],
            notes: not_in_design_table(asked.arm).into_iter().collect(),
            ..Export::default()
        },
        Format::Bom => Export {
            files: vec![("bom.csv".into(), bill_csv(&bill(asked.arm, catalogs)))],
            notes: not_in_bill(asked.arm, effects_mass_kg(asked)).into_iter().collect(),
            ..Export::default()
        },
    };
    let added_kg = effects_mass_kg(asked);
    if added_kg != 0.0 && matches!(asked.format, Format::Calculix | Format::Mjcf | Format::Urdf) {
        out.notes.push(format!("effects add {added_kg} kg, which the files have in addition to mass_kg"));
    }
    let ignored: Vec<String> = asked.arm.ignored_effects().into_iter().map(Effect::label).collect();
    if !ignored.is_empty() {
        out.notes.push(format!(
            "effects that describe a test and not the arm are not in the files: {}",
            ignored.join(", ")
        ));
    }
    out
}

impl Export {
    /// The parts of the export, and what the other program should compute, as JSON: the content of `export.json`.
    pub(crate) fn to_json(&self, asked: &Asked) -> Value {
        let names: Vec<&str> = self.files.iter().map(|(name, _)| name.as_str()).collect();
        json!({
            "to": Format::WORDS.iter().find(|(_, format)| *format == asked.format).map(|(word, _)| word),
            "arm": asked.arm.name,
            "mass_kg": asked.arm.mass_kg(),
            "effects_mass_kg": effects_mass_kg(asked),
            "case": asked.case.to_json(&asked.arm.driven_joints()),
            "files": names,
            "left_out": self.left_out.iter().map(LeftOut::to_json).collect::<Vec<_>>(),
            "notes": self.notes,
            "expected": self.expected,
            "tool_version": env!("CARGO_PKG_VERSION"),
        })
    }
}

/// Mass that effects add to the arm \[kg\].
fn effects_mass_kg(asked: &Asked) -> f64 {
    let arm = asked.arm;
    match arm.effects.is_empty() {
        true => 0.0,
        false => {
            let nominal_kg = arm.nominal_structure(asked.case.joints).mass_kg();
            arm.structure_in(asked.case).mass_kg() - nominal_kg
        }
    }
}

/// One line that describes arm and case, for the head of files.
fn heading(asked: &Asked) -> String {
    let case = asked.case;
    format!(
        "{}, case {}: pose {:?} deg, payload {} kg at {:?} m from the tip",
        asked.arm.name,
        case.name,
        case.pose_deg,
        case.payload.mass_kg,
        case.payload.cg_m.as_slice()
    )
}

fn to_calculix(asked: &Asked) -> Export {
    let structure = asked.arm.structure_in(asked.case);
    let mut rest = Remainder::new(structure, asked.case, FileSprings::SecantsAndTangents);
    rest.without_water();
    rest.without_balance_springs();
    let links = rest.structure.pieces.iter().filter_map(|piece| match piece {
        Piece::Link(link) => link.beam.filter(|beam| !has_shape(&beam.section)).map(|_| link.name.clone()),
        _ => None,
    });
    if asked.case.links != LinkModel::Rigid {
        let why = "its section is stated by stiffnesses and has no shape: the link is rigid";
        links.collect::<Vec<_>>().iter().for_each(|name| rest.without_flexible_link(name, why));
    }
    let links = match asked.case.links {
        LinkModel::Rigid => LinkModel::Rigid,
        LinkModel::Bending | LinkModel::Full => LinkModel::Full,
    };
    let snapshot = rest.snapshot(links);
    let model = model(&snapshot);
    let gravity = snapshot.structure.down * snapshot.structure.gravity_m_s2;
    let file =
        |step, what: &str| deck(&model, step, &format!("{}. {what}", heading(asked)), &gravity).into_bytes();
    let mut out = Export {
        files: vec![(
            "static.inp".into(),
            file(Step::Static, "Stiffnesses of joints are secants at the loads of this deck"),
        )],
        left_out: rest.left_out,
        expected: snapshot.expected(),
        notes: Vec::new(),
    };
    out.notes.push(match model.modes {
        0 => "run: ccx static; static.dat has the displacement of the tip. Nothing of the arm vibrates, so there is no modes.inp".into(),
        _ => "run: ccx static, then ccx modes; static.dat has the displacement of the tip".into(),
    });
    if model.modes > 0 {
        out.files.push((
            "modes.inp".into(),
            file(Step::Frequency, "Stiffnesses of joints are tangents at the loads of the arm as it stands"),
        ));
    }
    out.notes.extend(working_points_note(&out.left_out));
    out.notes.extend(solids_notes(asked, links, &model.impossible));
    out
}

/// Remarks on differences between the arm and the model of solids, in which both ends of a link are rigid. `impossible`
/// names bodies whose inertia no solid has.
fn solids_notes(asked: &Asked, links: LinkModel, impossible: &[String]) -> Vec<String> {
    let mut out = Vec::new();
    let open = asked
        .arm
        .links()
        .filter(|link| matches!(&link.body, LinkBody::Tube { section: Section::IBeam { .. }, .. }));
    let open: Vec<&str> = open.map(|link| link.name.as_str()).collect();
    if !open.is_empty() && links == LinkModel::Full {
        out.push(format!(
            "rigid end faces hold the warping of open sections, so that they twist less than expected: {}",
            open.join(", ")
        ));
    }
    let runs = links_in_pieces(asked.arm);
    if !runs.is_empty() && links == LinkModel::Full {
        out.push(format!(
            "links that follow each other have a rigid face between them, which holds the cross-section in shape; for a taper of \
             12 pieces this costs 2 % of the tip's displacement and 3 % of frequencies: {}",
            runs.join(", ")
        ));
    }
    if asked.case.links == LinkModel::Bending {
        out.push(
            "solids shear, twist and stretch: expected is the full model of links, not bending alone".into(),
        );
    }
    if !impossible.is_empty() {
        let names = impossible.join(", ");
        out.push(format!(
            "no solid has the inertia of a body, which is exported as near as point masses can: {names}"
        ));
    }
    out
}

/// The arm as an MJCF file of MuJoCo.
fn to_mjcf(asked: &Asked, catalogs: &Catalogs) -> Export {
    let mut rest = Remainder::new(asked.arm.structure_in(asked.case), asked.case, FileSprings::Tangents);
    rest.without_water();
    rest.without_balance_springs();
    rest.without_joint_torques();
    rest.without_turning_with_others();
    rest.without_tip_load("an MJCF file has no load: apply it at the site \"tip\" (xfrc_applied)");
    if asked.pieces == 0 {
        rest.without_flexible_links("links are rigid: ask for pieces with --flexible N");
    }
    let links = if asked.pieces == 0 { LinkModel::Rigid } else { asked.case.links };
    let mut notes = Vec::new();
    let snapshot = rest.snapshot(links);
    let options = TreeOptions {
        springs: true,
        pieces: if links == LinkModel::Rigid { 0 } else { asked.pieces },
        links,
        plays: match asked.backlash {
            true => plays(asked.arm, catalogs, &mut notes),
            false => BTreeMap::new(),
        },
    };
    let motors = motors(asked.arm, catalogs, &mut notes);
    let file = mjcf(&asked.arm.name, &snapshot, &options, &motors);
    notes.extend(mjcf_notes(options.pieces, &file));
    notes.extend(working_points_note(&rest.left_out));
    Export {
        files: vec![("arm.xml".into(), file.text.into_bytes())],
        left_out: rest.left_out,
        notes,
        expected: snapshot.expected(),
    }
}

/// Remarks on differences between an MJCF file and the arm. `pieces` is the number of parts of each link; 0 if links
/// are rigid.
fn mjcf_notes(pieces: usize, file: &Mjcf) -> Vec<String> {
    let mut out = vec![match pieces {
        0 => "links are rigid".into(),
        n => format!(
            "links are cut into {n} parts; the error of their compliance falls with 1/{n}². Their springs are stiff: the \
             time step is small"
        ),
    }];
    out.push("the keyframe \"pose\" is the pose with straight springs, in which torques and frequencies are compared; \"deflected\" has \
                every spring where it rests under the load"
        .into());
    if file.step.is_short() {
        out.push(format!(
            "the time step is {} s, for a light body between stiff springs vibrates at {:.0} Hz; a heavier body or a rigid element \
             allows a longer one",
            file.step.step_s, file.step.highest_hz
        ));
    }
    if file.balanced {
        out.push("no solid has the inertia of a body: MuJoCo makes its moments equal (balanceinertia), so frequencies differ".into());
    }
    out
}

/// The arm as a URDF file.
fn to_urdf(asked: &Asked) -> Export {
    let case = LoadCase { payload: Payload::default(), ..asked.case.clone() };
    let structure = asked.arm.structure_in(asked.case);
    let mut rest = Remainder::new(structure, &case, FileSprings::SecantsAndTangents);
    rest.without_water();
    rest.without_balance_springs();
    rest.without_joint_torques();
    rest.without_turning_with_others();
    rest.without_tip_load("a URDF has no load");
    rest.without_flexible_links("a URDF has rigid links");
    rest.without_springs(
        "a URDF has rigid joints; stiffness.json has the springs of joints and bearings, without effects",
    );
    let snapshot = rest.snapshot(LinkModel::Rigid);
    let mut notes = vec![
        "the payload is not part of the file, and tip_share is that of the arm without payload; joints have no ranges and are \
         continuous"
            .to_string(),
    ];
    notes.extend(gravity_note(&snapshot.structure));
    if asked.arm.prismatics().next().is_some() {
        notes.push(format!(
            "a URDF must have ranges of prismatic joints and an arm has none: {TRAVEL_M} m to either side stand in"
        ));
    }
    let several = with_several_drivers(asked.arm);
    if !several.is_empty() {
        let names: Vec<&str> = several.iter().map(|joint| joint.name.as_str()).collect();
        notes.push(format!(
            "passive joints with several drivers are free in the file, for <mimic> has one: {}",
            names.join(", ")
        ));
    }
    let file = urdf(asked.arm, &snapshot);
    if file.tip != "tip" {
        notes.push(format!(
            "the link at the tip is \"{}\", because another part of the arm has the name tip",
            file.tip
        ));
    }
    Export {
        files: vec![
            ("arm.urdf".into(), file.text.into_bytes()),
            ("stiffness.json".into(), pretty(&stiffness_file(asked.arm))),
        ],
        left_out: rest.left_out,
        notes,
        // the expected results of a rigid arm are the torques and forces alone
        expected: torques_and_forces(&snapshot),
    }
}

/// The first and the last link of each run of tubes without a joint between them, in words.
fn links_in_pieces(arm: &Arm) -> Vec<String> {
    let is_tube = |element: &&Element| matches!(element, Element::Link(link) if matches!(link.body, LinkBody::Tube { .. }));
    let runs = arm.chain.split(|element| !is_tube(&element));
    runs.filter_map(|run| match run {
        [first, .., last] => Some(format!("{} to {}", first.name(), last.name())),
        _ => None,
    })
    .collect()
}

/// A note for files that lack some loads of the arm. It says that the springs in the files have the tangent stiffnesses
/// at the torques with all loads. `None` if the files lack no load.
fn working_points_note(left_out: &[LeftOut]) -> Option<String> {
    const LOADS: [&str; 5] = ["water", "balance_spring", "joint_torque", "turns_with", "tip_load"];
    let loads: Vec<&str> =
        left_out.iter().map(|left| left.what).filter(|what| LOADS.contains(what)).collect();
    (!loads.is_empty()).then(|| {
        "torsion curves are tangents at the torques of the arm as it stands, with all loads, so that frequencies are the arm's; \
         expected has the torques and the displacement of the tip under the loads that the files have"
            .into()
    })
}

/// A note on the gravity of the arm, which a URDF cannot state. `None` if it is the usual gravity.
fn gravity_note(structure: &Structure) -> Option<String> {
    let gravity = structure.down * structure.gravity_m_s2;
    let usual = Vector3::new(0.0, 0.0, -GRAVITY_M_S2);
    (gravity != usual).then(|| {
        format!(
            "a URDF has no gravity: set that of the simulator to {} m/s2, for which expected is computed",
            triple(&gravity)
        )
    })
}

/// The torques and forces that hold the driven joints. A rigid arm has no other expected results.
fn torques_and_forces(snapshot: &Snapshot) -> Value {
    let mut expected = snapshot.expected();
    if let Some(expected) = expected.as_object_mut() {
        expected.retain(|key, _| key.starts_with("joint_"));
    }
    expected
}

fn to_json(asked: &Asked) -> Export {
    let joints = asked.arm.driven_joints();
    let cases: Vec<Value> = asked.cases.iter().map(|case| case.to_json(&joints)).collect();
    Export {
        files: vec![
            ("arm.json".into(), pretty(&asked.arm.to_json())),
            ("cases.json".into(), pretty(&json!(cases))),
        ],
        ..Export::default()
    }
}

fn pretty(value: &Value) -> Vec<u8> {
    serde_json::to_vec_pretty(value).expect("a value of numbers and strings serializes")
}
