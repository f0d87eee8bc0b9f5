//! Reads a study file: an arm with open links and drives, the cases in which it is judged, and its requirements.
//!
//! In the file, lengths of sections and limits on lengths are in millimetres, because profiles are sold in
//! millimetres. Everything else is in SI units. The resolved [`DesignSpace`] is entirely in SI units.

use super::balance::{balance_remarks, read_balance, read_number_of_choices};
use super::blank_remarks::blank_remarks;
use super::bodies::impossible_bodies_remark;
use super::cases::{Cases, read_cases};
use super::choose_keys::CHOOSE;
use super::connections::{connections_remark, with_connections};
use super::creep::creep_remarks;
use super::definition::Study;
use super::drives::{Drives, read_drives};
use super::effects::{check_effects, effects_remark};
use super::fit::{fit_remarks, measure_links, read_fit};
use super::harness::{harness_effects, harness_remark};
use super::keys::{CONSTRAINTS, JOINT, LINK, MODELS, STUDY};
use super::linkages::drivers_are_inboard;
use super::motion::{duty_remarks, ramp_remark, read_duty, read_motion};
use super::omissions::{actuators_remark, omissions, roller_life_remark, unchecked_remark};
use super::piece_names::check_names;
use super::rail_keys::{OF_CATALOG_DRIVE, PRISMATIC};
use super::rail_remarks::rail_remarks;
use super::rails::read_rail_drive;
use super::range::{check_poses, read_range};
use super::sections::{Aside, MOST_OPTIONS, cost_remark, read_materials, read_sections};
use super::transmissions::{of_joint, place_transmissions, with_stages};
use super::warping;
use crate::arm::MOST_ELEMENTS;
use crate::arm::bearing::{BearingSource, Stated, read_bearing};
use crate::arm::body::{read_joint_bodies, read_link_bodies};
use crate::arm::element_keys::read_coupling;
use crate::arm::element_keys::{read_axis, read_name};
use crate::arm::extras::{ExtrasSource, read_extras_source};
use crate::arm::file::{NO_TYPE, motor_side_kg, read_curve, read_effects, read_gravity, read_joint_mass};
use crate::arm::load::{vector, word};
use crate::arm::pieces::{elements_of, read_links};
use crate::arm::pose::{DrivenJoint, Motion};
use crate::arm::prismatic::Prismatic;
use crate::arm::transmission::{Transmission, read_turns_with};
use crate::arm::{JointModel, LinkModel};
use crate::catalog::Catalogs;
use crate::catalog::gear::GearMass;
use crate::input::json::{Document, Faults, Node, Object};
use crate::sizing::demand::LinearReading;
use crate::sizing::fit::FitRequirement;
use crate::sizing::requirement::MotionRequirement;
use crate::sizing::stated::StatedDuty;
use crate::space::constraint::{Constraints, Servo};
use crate::space::design_space::{DesignSpace, DriveChoice, LinkChoice, SpaceJoint, SpacePiece};
use crate::space::prismatic::SpacePrismatic;
use serde_json::Value;
use std::sync::Arc;

/// Largest number of joints of a study. What the exact search prepares grows with the fourth power of this number, and
/// takes seconds for 200 joints.
const MOST_JOINTS: usize = 200;

/// Reads a study. Materials, profiles and parts that it names are looked up in `catalogs`. The keys are in
/// `docs/study-format.md`.
///
/// # Errors
/// All faults of the document at once.
///
/// ```
/// use armwright::catalog::Catalogs;
/// use armwright::input::Document;
/// use armwright::study::{named, read_study};
///
/// let catalogs = Catalogs::builtin();
/// let text = named("light-arm").expect("a built-in study");
/// let study = read_study(Document::parse("light-arm", text).expect("JSON"), &catalogs).expect("a sound study");
/// assert_eq!(study.name, "light-arm");
/// assert!(study.space.designs(&catalogs).expect("fewer than 2^128") > 1);
///
/// let faulty = text.replace("\"chain\"", "\"chian\"");
/// let faults = read_study(Document::parse("light-arm", &faulty).expect("JSON"), &catalogs).expect_err("two faults");
/// assert!(faults.to_string().contains("did you mean \"chain\"?"));
/// ```
pub fn read_study(document: Document, catalogs: &Catalogs) -> Result<Study, Faults> {
    let study = study(&document.root(), catalogs);
    document.finish(study)
}

fn study(node: &Node, catalogs: &Catalogs) -> Option<Study> {
    let root = node.shaped(&STUDY)?;
    let text = |key| root.or(key, String::new(), |n| n.string().map(String::from));
    let name = root.required("name").and_then(|n| read_study_name(&n));
    let (question, _notes) = (text("question"), text("notes"));
    let gravity = read_gravity(&root);
    let gap = root.or("gap_percent", 0.0, read_gap);
    let constraints = root.or("constraints", Constraints::default(), read_constraints);
    let mut aside = Aside::default();
    let chain = read_open_chain(&root, constraints.as_ref(), catalogs, &mut aside);
    let joints = driven_joints(node);
    let cases = read_cases(&root, &joints);
    let in_range = check_poses(&root, chain.as_deref(), cases.as_ref().map(|read| &read.cases[..]));
    let motion = root.or("motion", MotionRequirement::default(), read_motion);
    let (links, joint_model) = root.or("models", Default::default(), read_models)?;
    let effects = root.or("effects", Vec::new(), read_effects);
    let harness_kg_per_m = root.or("harness_kg_per_m", 0.0, Node::non_negative);
    let Cases { cases, judged, sizing, own_payloads } = cases?;
    let motion = motion?;
    let (gravity_m_s2, down) = gravity?;
    let motion = under_gravity(&root, gravity_m_s2, motion)?;
    let (mut chain, mut effects, harness_kg_per_m) = (chain?, effects?, harness_kg_per_m?);
    let springs = read_balance(&root, &mut chain);
    let balance_choices = read_number_of_choices(&root);
    effects.extend(harness_effects(&chain, harness_kg_per_m, &effects));
    let space = DesignSpace {
        name: name.clone()?,
        gravity_m_s2,
        down,
        pieces: chain,
        cases,
        judged_cases: judged,
        sizing_cases: sizing,
        motion,
        links,
        joints: joint_model,
        constraints: constraints?,
        effects,
        springs: springs?,
    };
    check_effects(&space, &root)?;
    in_range?;
    let Aside { not_checked, mut remarks, .. } = aside;
    remarks.extend(remarks_on(&space, harness_kg_per_m, catalogs));
    Some(Study {
        name: name?,
        question: question?,
        space,
        gap: gap?,
        own_payloads,
        balance_choices: balance_choices?,
        not_checked,
        remarks,
    })
}

/// Reads the chain of a study, and the defaults for all of its open links and drives. `constraints` is `None` if the
/// study's constraints are faulty. Returns `None` after recording a fault.
fn read_open_chain(
    root: &Object,
    constraints: Option<&Constraints>,
    catalogs: &Catalogs,
    aside: &mut Aside,
) -> Option<Vec<SpacePiece>> {
    let filter = root.or("drives", Drives::default(), |n| read_drives(n, catalogs));
    let extras = read_extras_source(root, ExtrasSource::Usual);
    let fit = read_fit(root, FitRequirement::default());
    let connection_share = root.or("connection_share", 0.0, Node::non_negative);
    let duty = root.or("duty", None, |n| read_duty_of_only_joint(n, root.node()).map(Some));
    let chain = root.required("chain")?;
    let (drives, extras, fit) = (filter.as_ref()?, extras?, fit?);
    let (connection_share, duty) = (connection_share?, duty.as_ref()?.as_ref());
    let open = Open { catalogs, drives, constraints: constraints?, extras, fit, connection_share, duty };
    read_chain(&chain, &open, aside)
}

/// Reads the name of a study. It must have a letter or a digit, because the folder of results is named after it.
/// Returns `None` after recording a fault.
fn read_study_name(node: &Node) -> Option<String> {
    match node.string()? {
        name if name.chars().any(|c| c.is_alphanumeric()) => Some(name.to_string()),
        name => node
            .fault(format!("\"{name}\" is no name"), "give letters or digits: results are written under it"),
    }
}

/// Remarks that follow from the whole design space, for the reader of the result.
fn remarks_on(space: &DesignSpace, harness_kg_per_m: f64, catalogs: &Catalogs) -> Vec<String> {
    let mut out = Vec::new();
    out.extend(effects_remark(space));
    out.extend(connections_remark(space));
    out.extend(harness_remark(space, harness_kg_per_m));
    out.extend(ramp_remark(&space.motion));
    out.extend(duty_remarks(space));
    out.extend(rail_remarks(space));
    out.extend(fit_remarks(space, catalogs));
    out.extend(omissions(space));
    out.extend(blank_remarks(space, catalogs));
    out.extend(actuators_remark(space, catalogs));
    out.extend(roller_life_remark(space, catalogs));
    out.extend(unchecked_remark(space, catalogs));
    out.extend(cost_remark(space));
    out.extend(creep_remarks(space, catalogs));
    out.extend(warping::of_space(space));
    out.extend(impossible_bodies_remark(space));
    out.extend(balance_remarks(space));
    out
}

/// The motion `motion` that the study requires, with the gravity of the study written into it. Returns `None` after
/// recording a fault.
fn under_gravity(
    root: &Object,
    gravity_m_s2: f64,
    mut motion: MotionRequirement,
) -> Option<MotionRequirement> {
    weight_is_needed(root, gravity_m_s2, &motion)?;
    // only the paper's reading of Eq 8 uses this value, and it was refused above if there is no gravity
    if gravity_m_s2 > 0.0 {
        motion.gravity_m_s2 = gravity_m_s2;
    }
    Some(motion)
}

/// Checks that a study without gravity asks for nothing that is defined as a multiple of the weight: the paper's
/// reading of Eq 8, and the stress at peak load, which is taken as 1 + a/g times the stress under the weight. Returns
/// `None` after recording a fault.
fn weight_is_needed(root: &Object, gravity_m_s2: f64, motion: &MotionRequirement) -> Option<()> {
    let stress = root.optional("constraints").filter(|n| n.value().get("stress_safety_factor_min").is_some());
    let node = match motion.linear_reading {
        LinearReading::Paper => root.optional("motion").or(stress),
        LinearReading::Exact => stress,
    };
    match node.filter(|_| gravity_m_s2 == 0.0) {
        Some(node) => node.fault(
            "asks for loads as a multiple of the weight, and without gravity there is none",
            "leave stress_safety_factor_min away, or state gravity_m_s2",
        ),
        None => Some(()),
    }
}

/// Reads the gap at which a search may end. The file has it in percent; the result is a fraction. Returns `None` after
/// recording a fault.
fn read_gap(node: &Node) -> Option<f64> {
    match node.non_negative()? {
        percent if percent < 100.0 => Some(percent / 100.0),
        percent => {
            node.fault(format!("{percent} is no gap"), "give a percentage below 100, 0 for the whole front")
        }
    }
}

/// The driven joints as the file has them. They are read separately, so that poses are checked even if the chain is
/// faulty.
fn driven_joints(study: &Node) -> Vec<DrivenJoint> {
    let chain = study.value().get("chain").and_then(|c| c.as_array());
    let joint = |e: &Value| {
        let motion = match e.get("type")?.as_str()? {
            "joint" if e.get("coupled").is_none() => Motion::Turns,
            "prismatic" => Motion::Slides,
            _ => return None,
        };
        let name = e.get("name").and_then(|n| n.as_str()).unwrap_or("(unnamed)").to_string();
        Some(DrivenJoint { name, motion })
    };
    chain.into_iter().flatten().filter_map(joint).collect()
}

/// Reads a duty that is stated for the whole study. It is allowed only if the study has a single joint, as in the
/// worked examples of vendors. Returns `None` after recording a fault.
fn read_duty_of_only_joint(node: &Node, study: &Node) -> Option<StatedDuty> {
    let duty = read_duty(node);
    match driven_joints(study).len() {
        0 | 1 => duty,
        joints => node
            .fault(format!("stands beside {joints} joints"), "write \"duty\" into the joint it belongs to"),
    }
}

/// Gives each material an index that is the same for all links of the study, in the order in which materials first
/// appear.
fn number_materials(pieces: &mut [SpacePiece]) {
    let mut names: Vec<String> = Vec::new();
    let choices = pieces.iter_mut().filter_map(SpacePiece::as_choice_mut);
    for option in choices.flat_map(|choice| Arc::make_mut(&mut choice.options)) {
        option.material_index = names.iter().position(|n| *n == option.material_name).unwrap_or_else(|| {
            names.push(option.material_name.clone());
            names.len() - 1
        });
    }
}

/// The settings of a study that are not about a single piece: the parts from which open pieces are chosen, and defaults
/// for joints.
struct Open<'a> {
    catalogs: &'a Catalogs,
    drives: &'a Drives,
    constraints: &'a Constraints,
    extras: ExtrasSource,
    fit: FitRequirement,
    connection_share: f64,
    /// The duty that the study states for its only joint; `None` if it states none.
    duty: Option<&'a StatedDuty>,
}

/// Refuses a chain that is empty, or that has too many elements or joints for a search. Returns `None` after recording
/// a fault.
fn fits_a_search(node: &Node, items: &[Node]) -> Option<()> {
    let elements: usize = items.iter().map(elements_of).sum();
    let joints = items.iter().filter(|n| n.value().get("type").is_some_and(|kind| kind != "link")).count();
    let (problem, hint) = match (elements, joints) {
        (1..=MOST_ELEMENTS, ..=MOST_JOINTS) => return Some(()),
        (0, _) => ("is empty".into(), "an arm has at least one joint or link"),
        (..=MOST_ELEMENTS, joints) => (
            format!("has {joints} joints, and the limit of a study is {MOST_JOINTS}"),
            "study a part of the arm, or solve the arm of a stated design by `armwright analyze`",
        ),
        (elements, _) => (
            format!("has {elements} joints and links, and the limit is {MOST_ELEMENTS}"),
            "join links that lie in line, or study a part of the arm",
        ),
    };
    node.fault(problem, hint)
}

fn read_chain(node: &Node, open: &Open, aside: &mut Aside) -> Option<Vec<SpacePiece>> {
    let items = node.array()?;
    fits_a_search(node, &items)?;
    let counts: Vec<usize> = items.iter().map(elements_of).collect();
    let mut transmissions = Vec::new();
    let read: Vec<Option<Vec<SpacePiece>>> = items
        .iter()
        .map(|n| match n.value().get("type").and_then(|v| v.as_str()) {
            Some("joint") => read_space_joint(n, open).map(|(joint, transmission)| {
                transmissions.push(transmission);
                vec![SpacePiece::Joint(joint)]
            }),
            Some("prismatic") => {
                read_space_prismatic(n, open).map(|slide| vec![SpacePiece::Prismatic(slide)])
            }
            Some("link") => read_space_link(n, open, aside),
            _ => n.fault(NO_TYPE.0, NO_TYPE.1),
        })
        .collect();
    let mut pieces: Vec<SpacePiece> =
        read.into_iter().collect::<Option<Vec<_>>>()?.into_iter().flatten().collect();
    let repeated = items.into_iter().zip(counts).flat_map(|(n, count)| std::iter::repeat_n(n, count));
    let items: Vec<Node> = repeated.collect();
    number_materials(&mut pieces);
    measure_links(&mut pieces);
    check_names(node, &pieces)?;
    drivers_are_inboard(&items, &pieces)?;
    let mut transmissions = transmissions.into_iter();
    let driven = pieces.iter().zip(&items).enumerate().filter_map(|(number, (piece, node))| match piece {
        SpacePiece::Joint(joint) => Some(of_joint(node, joint, number, transmissions.next()?)),
        _ => None,
    });
    let driven = driven.collect();
    place_transmissions(&mut pieces, driven, open.catalogs)?;
    Some(pieces)
}

/// Reads a joint that turns, and its transmission. The inner `None` means that no key of the joint describes a
/// transmission, the outer `None` that a fault was recorded.
fn read_space_joint(node: &Node, open: &Open) -> Option<(SpaceJoint, Option<Transmission>)> {
    let object = node.shaped(&JOINT)?;
    let name = read_name(&object);
    let axis = object.required("axis").and_then(|n| read_axis(&n));
    let max_speed = object.or("max_speed_rad_s", None, |n| n.positive().map(Some));
    let brake = object.or("brake", false, Node::boolean);
    let duty = object.or("duty", open.duty.cloned(), |n| read_duty(n).map(Some));
    let fit = read_fit(&object, open.fit);
    refuse_keys_of_other_joints(&object);
    let coupled = object.or("coupled", None, |n| read_coupling(n).map(Some));
    let (turns_with, transmission) = (
        read_turns_with(&object),
        Transmission::read(&object, open.catalogs, motor_side_kg(&object, open.catalogs)),
    );
    let drive = read_drive(&object, open);
    let (drive, bearing) = (drive?, read_bearing(&object, open.catalogs));
    let bearing = bearing_source(&object, bearing?, &drive, open.catalogs);
    // the mass of a given drive is stated and includes its extras
    let usually = if drive.is_sized() { open.extras } else { ExtrasSource::NONE };
    let extras = read_extras_source(&object, usually);
    let bodies = read_joint_bodies(&object);
    let range_deg = object.or("range_deg", None, |n| read_range(n).map(Some));
    let connection_share = open.connection_share;
    let (drive, bearing) = with_connections(connection_share, &object, drive, bearing?);
    let (extras, range_deg) = (extras?, range_deg?);
    let (max_speed_rad_s, has_brake, duty) = (max_speed?, brake?, duty?);
    let (name, axis, fit) = (name?, axis?, fit?);
    let transmission = transmission?;
    let drive = with_stages(drive, transmission.as_ref());
    let joint = SpaceJoint {
        name,
        axis,
        bearing,
        extras,
        bodies: bodies?,
        drive,
        max_speed_rad_s,
        range_deg,
        has_brake,
        duty,
        fit,
        connection_share,
        coupled: coupled?,
        stages: transmission.as_ref().map_or_else(Default::default, Transmission::stages),
        motor_place: None,
        turns_with: turns_with?,
    };
    Some((joint, transmission))
}

/// Reports keys that do not suit the joint: keys that need a motor if the joint has none, and keys of a driven joint if
/// a linkage turns the joint.
fn refuse_keys_of_other_joints(object: &Object) {
    if !object.has("drive") && !object.has("motor") {
        stray(
            object,
            &["brake", "duty", "fit"],
            "has no motor beside it",
            "add \"drive\", or \"gear\" and \"motor\"",
        );
    }
    if object.has("coupled") {
        let of_driven = ["drive", "motor", "range_deg", "max_speed_rad_s", "brake", "duty"];
        stray(
            object,
            &of_driven,
            "stands beside \"coupled\"",
            "a linkage turns this joint: write it at the joint that drives it",
        );
    }
}

/// Reads the drive of a joint: it is searched for if the joint has the key `drive`, otherwise the study gives it.
/// Returns `None` after recording a fault.
fn read_drive(object: &Object, open: &Open) -> Option<DriveChoice> {
    let Some(drive) = object.optional("drive") else {
        stray(
            object,
            &["drives"],
            "has no \"drive\" beside it",
            "add \"drive\": \"first_fit\" or \"all_fits\"",
        );
        return read_given_drive(object, open);
    };
    let given = [
        "stiffness_nm_per_rad",
        "windup",
        "gear",
        "motor",
        "gear_mass",
        "mass_kg",
        "motor_mass_kg",
        "gear_at",
        "gear_ratio",
    ];
    stray(object, &given, "stands beside \"drive\"", "a drive is either searched for or given; keep one");
    let own = object.or("drives", open.drives.clone(), |n| read_drives(n, open.catalogs));
    read_drive_choice(&drive, &own?)
}

/// Reads a prismatic joint. The study gives its guide and masses, and also its drive unless the drive is sized. Returns
/// `None` after recording a fault.
fn read_space_prismatic(node: &Node, open: &Open) -> Option<SpacePrismatic> {
    if let Some(key) = OF_CATALOG_DRIVE.iter().find(|key| node.value().get(*key).is_some()) {
        return node.fault_below(
            key,
            "stands at a prismatic joint, which has no gear of the catalogs",
            "give the joint in numbers (stiffness_n_per_m of screw or rack), or \"drive\": \"first_fit\" with \"screws\" or \"racks\"",
        );
    }
    let object = node.shaped(&PRISMATIC)?;
    let range_mm = object.or("range_mm", None, |n| read_range(n).map(Some));
    let max_speed_m_s = object.or("max_speed_m_s", None, |n| n.positive().map(Some));
    let drive = read_rail_drive(&object, open.drives, open.catalogs);
    let joint = match object.has("drive") {
        true => Prismatic::read_undriven(&object),
        false => Prismatic::read(&object),
    };
    let rail = SpacePrismatic::new(joint?, range_mm?);
    Some(SpacePrismatic { max_speed_m_s: max_speed_m_s?, drive: drive?, ..rail })
}

/// Whether the bearing of a joint is the stated one or the one of its gear. A component set has no bearing, so a joint
/// that is sized with component sets must state its bearing. Returns `None` after recording a fault.
fn bearing_source(
    object: &Object,
    stated: Stated,
    drive: &DriveChoice,
    catalogs: &Catalogs,
) -> Option<BearingSource> {
    match (stated, drive) {
        (Stated::Bearing(bearing), _) => Some(BearingSource::Stated(bearing)),
        (Stated::Nothing, DriveChoice::Given { .. }) => {
            crate::arm::file::read_joint_bearing(object, catalogs).map(BearingSource::Stated)
        }
        (Stated::Nothing, DriveChoice::FirstFit(filter) | DriveChoice::AllFits(filter))
            if filter.gear_mass == GearMass::ComponentSet =>
        {
            object.node().fault(
                "is sized with component sets, which have no output bearing, and states no \"bearing\"",
                "name a housed gear whose bearing it turns on (\"bearing\": \"HFUC-32-100\"), give tilt_stiffness_nm_per_rad \
                 and permissible_moment_nm, write \"bearing\": null for a rigid bearing without mass, or use housed units \
                 (\"gear_mass\": \"housed_unit\")",
            )
        }
        _ => Some(BearingSource::OfGear),
    }
}

/// Reports those of `keys` that `object` has as faults, because another key makes them meaningless. No key of a file is
/// ignored silently.
fn stray(object: &Object, keys: &[&str], problem: &str, hint: &str) {
    for node in keys.iter().filter_map(|key| object.optional(key)) {
        node.fault::<()>(problem, hint);
    }
}

fn read_drive_choice(node: &Node, drives: &Drives) -> Option<DriveChoice> {
    match node.string()? {
        "first_fit" => Some(DriveChoice::FirstFit(drives.filter.clone())),
        "all_fits" => Some(DriveChoice::AllFits(drives.filter.clone())),
        other => node.fault(
            format!("\"{other}\" is not known"),
            "choose first_fit (the lightest that holds) or all_fits, or give gear, motor or stiffness_nm_per_rad",
        ),
    }
}

fn read_given_drive(object: &Object, open: &Open) -> Option<DriveChoice> {
    let curve = read_curve(object, open.catalogs);
    let mass_kg = read_joint_mass(object, open.catalogs);
    let text = |key| object.or(key, None, |n| n.string().map(|s| Some(s.to_string())));
    let (gear, motor) = (text("gear")?, text("motor")?);
    Some(DriveChoice::Given { curve: curve?, mass_kg: mass_kg?, gear, motor })
}

fn read_space_link(node: &Node, open: &Open, aside: &mut Aside) -> Option<Vec<SpacePiece>> {
    let object = node.shaped(&LINK)?;
    let Some(choose) = object.optional("choose") else {
        let links = read_links(&object, &[], open.catalogs)?;
        return Some(links.into_iter().map(SpacePiece::Link).collect());
    };
    stray(
        &object,
        &["material", "section", "mass_kg", "pieces", "stiffness_factor", "mass_factor"],
        "stands beside \"choose\"",
        "a link is either chosen or given; keep one",
    );
    let name = read_name(&object);
    let vector_m = object.required("vector_m").and_then(|n| vector(&n)).filter(|v| {
        v.norm() > 1e-6 || object.node().fault::<()>("has no length", "give a longer vector_m").is_some()
    });
    let choices = choose.shaped(&CHOOSE)?;
    let materials = choices.required("materials").and_then(|n| read_materials(&n, open.catalogs));
    let sections = choices.required("sections").and_then(|n| read_sections(&n, open.catalogs));
    let (materials, sections) = (materials?, sections?);
    aside.options += materials.len() * sections.len();
    if aside.options > MOST_OPTIONS {
        let problem = format!("brings the study to {} choices of material and section", aside.options);
        return node.fault(problem, &format!("the limit is {MOST_OPTIONS} for all links; thin a grid"));
    }
    let options = super::sections::options(&materials, &sections, open.constraints, name.as_deref()?, aside);
    let bodies = read_link_bodies(&object);
    Some(vec![SpacePiece::Choice(LinkChoice {
        name: name?,
        vector_m: vector_m?,
        options: options.into(),
        bodies: bodies?,
        excerpt: None,
    })])
}

fn read_constraints(node: &Node) -> Option<Constraints> {
    let object = node.shaped(&CONSTRAINTS)?;
    let limit = |key| object.or(key, None, |n| n.positive().map(Some));
    let (deflection_mm, mass) = (limit("tip_deflection_max_mm"), limit("mass_max_kg"));
    let (mode, bandwidth) = (limit("lowest_mode_min_hz"), limit("servo_bandwidth_hz"));
    let ratio = object.or("servo_ratio", 3.0, Node::positive);
    if !object.has("servo_bandwidth_hz") {
        stray(
            &object,
            &["servo_ratio"],
            "has no \"servo_bandwidth_hz\" beside it",
            "add the bandwidth, or remove it",
        );
    }
    let (stress, slenderness) = (limit("stress_safety_factor_min"), limit("wall_slenderness_max"));
    let cost = limit("material_cost_max_eur");
    let ratio = ratio?;
    Some(Constraints {
        tip_deflection_max_m: deflection_mm?.map(|mm| mm / 1e3),
        mass_max_kg: mass?,
        lowest_mode_min_hz: mode?,
        servo: bandwidth?.map(|bandwidth_hz| Servo { bandwidth_hz, ratio }),
        stress_safety_factor_min: stress?,
        wall_slenderness_max: slenderness?,
        material_cost_max_eur: cost?,
    })
}

fn read_models(node: &Node) -> Option<(LinkModel, JointModel)> {
    let object = node.shaped(&MODELS)?;
    let links = object.or("links", LinkModel::default(), word);
    let joints = object.or("joints", JointModel::default(), word);
    Some((links?, joints?))
}
