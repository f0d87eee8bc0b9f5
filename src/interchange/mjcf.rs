//! Export to MJCF, the model format of MuJoCo.
//!
//! A driven joint becomes two hinges in series. The hinge of the motor has the inertia of rotor and gear (`armature`)
//! and an actuator. The hinge of the gear has the spring and no armature. A single hinge with both would be wrong:
//! its rotor would move with the output. The two tilts of a bearing become two more hinges. A torsion curve is
//! replaced by its tangent at the load of the case. The rest position of the spring (`springref`) is chosen such that
//! the spring deflects at this load as much as the curve does.

use super::free_name::FreeNames;
use super::motors::Motor;
use super::snapshot::{Snapshot, Working};
use super::time_step::{Moving, TimeStep};
use super::tree::{Hinge, Node, Role, TreeOptions, mass_properties, tree};
use super::xml::{Xml, numbers, triple};
use crate::arm::body::RigidBody;
use crate::arm::structure::JointAngle;
use crate::mechanics::body_inertia;
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeMap;

/// Mass of a body that has none, relative to the mass of the arm. MuJoCo accepts no moving body without mass.
const LEAST_MASS: f64 = 1e-10;
/// Square of the least radius of gyration of every body \[m²\]: 0.3 mm. MuJoCo accepts no moving body without inertia,
/// and a body with less would need a shorter time step. A body without mass has the least moments of a body with a
/// tenth of the arm's mass.
const LEAST_RADIUS2_M2: f64 = 1e-7;
/// Least armature of the hinge of a backlash, relative to the motor's.
const PLAY_ARMATURE: f64 = 1e-3;
/// Time step at which a simulation is stable in spite of a backlash \[s\]. The armature of the hinge of the backlash is
/// chosen for this step.
const PLAY_STEP_S: f64 = 1e-4;

/// An MJCF file, and what the reader must know of it.
pub(crate) struct Mjcf {
    /// The text of the file.
    pub text: String,
    /// Whether some body has an inertia that no solid can have, so that MuJoCo must change it.
    pub balanced: bool,
    /// The time step that the file states, and what limits it.
    pub step: TimeStep,
}

/// Writes an arm in a case as MJCF. `motors` has inertia and peak torque of the motors by name of the joint.
pub(crate) fn mjcf(
    name: &str,
    snapshot: &Snapshot,
    options: &TreeOptions,
    motors: &BTreeMap<String, Motor>,
) -> Mjcf {
    let mut nodes = tree(snapshot, options);
    name_bodies(&mut nodes);
    let least = Least::of(&nodes);
    let balanced = nodes.iter().any(|node| !is_solid(node, &least));
    let step = TimeStep::below(moving(snapshot, &nodes, &least, motors).highest_rad_per_s());
    let case = &snapshot.case;
    let comment = format!(
        "{name}, case \"{}\": pose {}, payload {} kg at {:?} m from the tip. Torsion curves are tangents at the torques of this case. {}",
        case.name,
        snapshot.pose_words(),
        case.payload.mass_kg,
        case.payload.cg_m.as_slice(),
        step_words(step)
    );
    let mut xml = Xml::new(&comment);
    xml.open("mujoco", &[("model", name.into())]);
    let mut compiler = vec![("angle", "radian".to_string()), ("autolimits", "true".into())];
    if balanced {
        compiler.push(("balanceinertia", "true".into()));
    }
    xml.leaf("compiler", &compiler);
    let gravity = snapshot.structure.down * snapshot.structure.gravity_m_s2;
    xml.leaf(
        "option",
        &[
            ("gravity", triple(&gravity)),
            ("integrator", "implicitfast".into()),
            ("timestep", numbers(&[step.step_s])),
        ],
    );
    xml.open("worldbody", &[]);
    let mut before_m = Vector3::zeros();
    for node in &nodes {
        body(&mut xml, node, &before_m, &least, motors);
        before_m = node.origin_m;
    }
    let posed = snapshot.at_zero();
    xml.leaf(
        "site",
        &[("name", "tip".into()), ("pos", triple(&(posed.tip_m - before_m))), ("size", "0.01".into())],
    );
    nodes.iter().for_each(|_| xml.close());
    xml.close();
    couplings(&mut xml, snapshot, &nodes, step.step_s);
    actuators(&mut xml, snapshot, motors);
    keyframes(&mut xml, snapshot, &nodes);
    Mjcf { text: xml.finish(), balanced, step }
}

/// Words for the head of the file that say what limits the time step.
fn step_words(step: TimeStep) -> String {
    match step.highest_hz > 0.0 {
        true => format!(
            "The time step is at most half of the longest one that is stable in this pose, 1/(pi f), for the highest natural \
             frequency f = {:.0} Hz",
            step.highest_hz
        ),
        false => "Nothing vibrates that could limit the time step".into(),
    }
}

/// The exported arm as MuJoCo moves it, for the choice of the time step. The arm is in the pose of the case, and its
/// springs are undeflected.
fn moving<'n>(
    snapshot: &Snapshot,
    nodes: &'n [Node],
    least: &Least,
    motors: &BTreeMap<String, Motor>,
) -> Moving<'n> {
    let hinges: Vec<&Hinge> = nodes.iter().flat_map(|node| &node.hinges).collect();
    let spring = |(at, hinge): (usize, &&Hinge)| match hinge.role {
        Role::Spring(working) => Some((working.tangent_nm_per_rad(), vec![(at, 1.0)])),
        Role::Follower(working) if !working.is_rigid() => {
            Some((working.tangent_nm_per_rad(), coupling_terms(snapshot, &hinges, at)))
        }
        _ => None,
    };
    let inertia = |node: &Node| {
        let RigidBody { mass_kg, cg_m, inertia_kgm2 } = least.written(node);
        body_inertia(mass_kg, &cg_m, &inertia_kgm2)
    };
    Moving {
        nodes,
        inertias: nodes.iter().map(inertia).collect(),
        armatures_kgm2: hinges.iter().map(|hinge| armature_kgm2(hinge, motors).unwrap_or(0.0)).collect(),
        positions: positions(snapshot, nodes, Springs::Straight),
        springs: hinges.iter().enumerate().filter_map(spring).collect(),
    }
}

/// Opens the XML element of a body. It stays open, because the bodies outboard of it are nested inside. `before_m` is
/// the origin of the body that contains it \[m\].
fn body(
    xml: &mut Xml,
    node: &Node,
    before_m: &Vector3<f64>,
    least: &Least,
    motors: &BTreeMap<String, Motor>,
) {
    xml.open("body", &[("name", node.name.clone()), ("pos", triple(&(node.origin_m - before_m)))]);
    for hinge in &node.hinges {
        xml.leaf("joint", &joint(hinge, &node.origin_m, motors));
    }
    let RigidBody { mass_kg, cg_m, inertia_kgm2: inertia } = least.written(node);
    let full = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|at| inertia[at]);
    xml.leaf(
        "inertial",
        &[
            ("pos", triple(&(cg_m - node.origin_m))),
            ("mass", numbers(&[mass_kg])),
            ("fullinertia", numbers(&full)),
        ],
    );
    for (from_m, to_m, radius_m) in &node.rods {
        let ends = format!("{} {}", triple(&(from_m - node.origin_m)), triple(&(to_m - node.origin_m)));
        xml.leaf(
            "geom",
            &[
                ("type", "capsule".into()),
                ("fromto", ends),
                ("size", numbers(&[*radius_m])),
                ("contype", "0".into()),
                ("conaffinity", "0".into()),
            ],
        );
    }
}

fn joint(
    hinge: &Hinge,
    origin_m: &Vector3<f64>,
    motors: &BTreeMap<String, Motor>,
) -> Vec<(&'static str, String)> {
    let mut out = vec![
        ("name", hinge.name.clone()),
        ("type", if hinge.slides { "slide" } else { "hinge" }.to_string()),
        ("axis", triple(&hinge.axis)),
        ("pos", triple(&(hinge.at_m - origin_m))),
    ];
    match hinge.role {
        Role::Follower(_) | Role::Motor => {}
        Role::Spring(working) => {
            out.push(("stiffness", numbers(&[working.tangent_nm_per_rad()])));
            out.push(("springref", numbers(&[working.rest_rad()])));
        }
        Role::Play { half_rad, .. } => out.push(("range", numbers(&[-half_rad, half_rad]))),
    }
    out.extend(armature_kgm2(hinge, motors).map(|kgm2| ("armature", numbers(&[kgm2]))));
    out
}

/// Armature of a hinge \[kg m²\]; `None` if it has none.
fn armature_kgm2(hinge: &Hinge, motors: &BTreeMap<String, Motor>) -> Option<f64> {
    let motor = |name: &str| motors.get(name).map(|motor| motor.armature_kgm2);
    match hinge.role {
        Role::Motor => motor(&hinge.name),
        Role::Play { gear, .. } => Some(play_armature_kgm2(motor(&hinge.element).unwrap_or(0.0), &gear)),
        Role::Spring(_) | Role::Follower(_) => None,
    }
}

/// Armature of the hinge of a backlash \[kg m²\]. `motor_kgm2` is the armature of the motor, and `gear` the spring of
/// the gear.
///
/// Without any armature, this hinge and that of the gear would have one axis and no mass between them, and the mass
/// matrix would be singular. With a very small armature, the hinge would vibrate very fast on the spring of the gear,
/// and the time step would have to be shorter. A step of `h` is stable up to an angular frequency of `2/h`; the
/// armature is chosen such that the hinge has half of this frequency at the step `PLAY_STEP_S`.
fn play_armature_kgm2(motor_kgm2: f64, gear: &Working) -> f64 {
    let steady_kgm2 =
        if gear.is_rigid() { 0.0 } else { gear.tangent_nm_per_rad() * PLAY_STEP_S * PLAY_STEP_S };
    steady_kgm2.max(PLAY_ARMATURE * motor_kgm2)
}

/// Writes the couplings of passive joints as tendons. The length of such a tendon is the angle of the passive joint
/// minus the angle that follows from its driving joints. The angle of a driving joint is the sum of its motor, backlash
/// and gear. A rigid coupling keeps the length at zero. In a compliant coupling the tendon has the spring of the
/// passive joint. A separate hinge for this spring would lie on the axis of the joint without mass between them, and
/// the mass matrix would be singular.
fn couplings(xml: &mut Xml, snapshot: &Snapshot, nodes: &[Node], step_s: f64) {
    let hinges: Vec<&Hinge> = nodes.iter().flat_map(|node| &node.hinges).collect();
    let mut followers: Vec<(usize, &Hinge, Working)> = Vec::new();
    for (at, hinge) in hinges.iter().enumerate() {
        if let Role::Follower(working) = hinge.role {
            followers.push((at, hinge, working));
        }
    }
    if followers.is_empty() {
        return;
    }
    let name_of = |hinge: &Hinge| format!("{}.coupling", hinge.name);
    xml.open("tendon", &[]);
    for (at, follower, working) in &followers {
        let mut attributes = vec![("name", name_of(follower))];
        if !working.is_rigid() {
            attributes.push(("stiffness", numbers(&[working.tangent_nm_per_rad()])));
            attributes.push(("springlength", numbers(&[working.rest_rad()])));
        }
        xml.open("fixed", &attributes);
        for (hinge, coefficient) in coupling_terms(snapshot, &hinges, *at) {
            let joint = hinges[hinge].name.clone();
            xml.leaf("joint", &[("joint", joint), ("coef", numbers(&[coefficient]))]);
        }
        xml.close();
    }
    xml.close();
    let rigid: Vec<&Hinge> =
        followers.iter().filter(|(.., working)| working.is_rigid()).map(|(_, hinge, _)| *hinge).collect();
    if rigid.is_empty() {
        return;
    }
    rigid_couplings(xml, rigid.into_iter().map(name_of), step_s);
}

/// Keeps the lengths of the tendons of rigid couplings at zero. MuJoCo pulls such a length back like a damped spring, and
/// by default this takes 20 ms: an arm that hangs on the coupling then sinks by many times its deflection. Two time
/// steps are the shortest time that MuJoCo takes. Of the acceleration that opens the coupling, 1 % is left.
fn rigid_couplings(xml: &mut Xml, tendons: impl Iterator<Item = String>, step_s: f64) {
    xml.open("equality", &[]);
    for tendon in tendons {
        let attributes = [
            ("tendon1", tendon),
            ("polycoef", "0 0 0 0 0".into()),
            ("solref", format!("{} 1", numbers(&[2.0 * step_s]))),
            ("solimp", "0.99 0.99 0.001".into()),
        ];
        xml.leaf("tendon", &attributes);
    }
    xml.close();
}

/// The hinges on whose positions the length of the tendon of a passive joint depends, each with its coefficient: first
/// the hinge of the joint itself, which has the index `passive`.
fn coupling_terms(snapshot: &Snapshot, hinges: &[&Hinge], passive: usize) -> Vec<(usize, f64)> {
    let driven = snapshot.case_joints();
    let mut out = vec![(passive, 1.0)];
    for (index, factor) in coupled(snapshot, &hinges[passive].name).unwrap_or_default() {
        let of_driver = (0..hinges.len()).filter(|at| hinges[*at].element == driven[*index]);
        out.extend(of_driver.map(|at| (at, -factor)));
    }
    out
}

/// The driving joints of a passive joint, each with its index in a pose and its factor; `None` if a motor drives it.
fn coupled<'s>(snapshot: &'s Snapshot, joint: &str) -> Option<&'s [(usize, f64)]> {
    let passive = snapshot.structure.joints().find(|other| other.name == joint)?;
    match &passive.angle {
        JointAngle::Coupled(terms) => Some(terms),
        JointAngle::Driven(_) => None,
    }
}

fn actuators(xml: &mut Xml, snapshot: &Snapshot, motors: &BTreeMap<String, Motor>) {
    xml.open("actuator", &[]);
    for joint in snapshot.case_joints() {
        let mut attributes = vec![("name", joint.clone()), ("joint", joint.clone())];
        if let Some(peak_nm) = motors.get(&joint).and_then(|motor| motor.peak_nm) {
            attributes.push(("ctrlrange", numbers(&[-peak_nm, peak_nm])));
        }
        xml.leaf("motor", &attributes);
    }
    xml.close();
}

/// Writes the pose of the case as two keyframes. In the first, all springs are undeflected; frequencies and torques are
/// compared in it. In the second, they are deflected by the load of the case.
fn keyframes(xml: &mut Xml, snapshot: &Snapshot, nodes: &[Node]) {
    let position = |springs: Springs| numbers(&positions(snapshot, nodes, springs));
    xml.open("keyframe", &[]);
    xml.leaf("key", &[("name", "pose".into()), ("qpos", position(Springs::Straight))]);
    xml.leaf("key", &[("name", "deflected".into()), ("qpos", position(Springs::Deflected))]);
    xml.close();
}

/// Whether springs are straight or deflected by the load of the case.
#[derive(Clone, Copy, PartialEq)]
enum Springs {
    Straight,
    Deflected,
}

/// The position of every hinge in the pose of the case \[rad, m\].
fn positions(snapshot: &Snapshot, nodes: &[Node], springs: Springs) -> Vec<f64> {
    let deflected = springs == Springs::Deflected;
    let (driven, pose) = (snapshot.case_joints(), snapshot.pose_si());
    let hinges = || nodes.iter().flat_map(|node| &node.hinges);
    let drive = |hinge: &Hinge| match hinge.role {
        Role::Motor => driven.iter().position(|joint| *joint == hinge.name).map_or(0.0, |at| pose[at]),
        Role::Spring(working) if deflected => working.deflection_rad,
        // the load of the gear pushes the backlash to its stop
        Role::Play { half_rad, gear } if deflected && gear.load_nm != 0.0 => half_rad.copysign(gear.load_nm),
        _ => 0.0,
    };
    // a passive joint follows the outputs of its driving joints: motor, backlash and gear
    let follow = |name: &str| -> f64 {
        let output =
            |joint: &String| hinges().filter(|hinge| hinge.element == *joint).map(drive).sum::<f64>();
        let terms = coupled(snapshot, name).unwrap_or_default();
        terms.iter().map(|(index, factor)| factor * output(&driven[*index])).sum()
    };
    let of = |hinge: &Hinge| match hinge.role {
        Role::Follower(working) => follow(&hinge.name) + if deflected { working.deflection_rad } else { 0.0 },
        _ => drive(hinge),
    };
    hinges().map(of).collect()
}

/// Whether a solid can have the inertia of this body: no principal moment exceeds the sum of the other two.
fn is_solid(node: &Node, least: &Least) -> bool {
    let RigidBody { mass_kg, inertia_kgm2, .. } = mass_properties(&node.inertia);
    let moments = least.raised(mass_kg, inertia_kgm2).symmetric_eigenvalues();
    2.0 * moments.max() <= moments.sum() * (1.0 + 1e-9)
}

/// Gives every body a name of its own. An element of an arm may be called `world` or `base`.
fn name_bodies(nodes: &mut [Node]) {
    let mut free = FreeNames::all_but(["world".to_string()]);
    nodes.iter_mut().for_each(|node| node.name = free.take(&node.name, "_body"));
}

/// Least values of mass and inertia, too small to change anything, for bodies that have less.
struct Least {
    /// Mass of a body without mass \[kg\].
    mass_kg: f64,
}

impl Least {
    /// The least values for an arm with these bodies.
    fn of(nodes: &[Node]) -> Self {
        let arm_kg: f64 = nodes.iter().map(|node| node.inertia[(0, 0)]).sum();
        Self { mass_kg: LEAST_MASS * if arm_kg > 0.0 { arm_kg } else { 1.0 } }
    }

    /// The body as the file states it: its own mass and inertia, raised to the least values.
    fn written(&self, node: &Node) -> RigidBody {
        let RigidBody { mass_kg, cg_m, inertia_kgm2 } = mass_properties(&node.inertia);
        let inertia_kgm2 = self.raised(mass_kg, inertia_kgm2);
        match mass_kg > 0.0 {
            true => RigidBody { mass_kg, cg_m, inertia_kgm2 },
            false => RigidBody { mass_kg: self.mass_kg, cg_m: node.origin_m, inertia_kgm2 },
        }
    }

    /// The inertia of a body of this mass, raised equally about all axes until its smallest moment is the least
    /// \[kg m²\].
    fn raised(&self, mass_kg: f64, inertia_kgm2: Matrix3<f64>) -> Matrix3<f64> {
        let mass_kg = if mass_kg > 0.0 { mass_kg } else { 0.1 * self.mass_kg / LEAST_MASS };
        let lacks_kgm2 = LEAST_RADIUS2_M2 * mass_kg - inertia_kgm2.symmetric_eigenvalues().min();
        inertia_kgm2 + Matrix3::identity() * lacks_kgm2.max(0.0)
    }
}
