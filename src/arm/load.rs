//! Load cases: a pose, a payload, a force at the tip, and the models to use.

use super::case_keys::CASE;
use super::keys::{PAYLOAD, WATER};
use super::pose::{DrivenJoint, pose_json, read_pose};
use super::{JointModel, LinkModel, Words};
use crate::input::json::{Document, Faults, Node};
use nalgebra::Vector3;
use serde_json::{Value, json};

/// The payload of an arm. Centre of gravity and inertia are written in the last frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Payload {
    /// Mass of the payload \[kg\].
    pub mass_kg: f64,
    /// Position of the centre of gravity from the tip \[m\].
    pub cg_m: Vector3<f64>,
    /// Moments of inertia about the centre of gravity, about the x, y and z axes of the last frame \[kg m²\].
    pub inertia_about_cg_kgm2: Vector3<f64>,
}

/// A load case: a pose with a load, in which an arm is analysed.
///
/// ```
/// use armwright::arm::{DrivenJoint, JointModel, LinkModel, LoadCase, Payload};
/// use nalgebra::Vector3;
///
/// let case = LoadCase {
///     name: "stretched, 5 kg".into(),
///     pose_deg: vec![0.0, -30.0, 60.0],
///     payload: Payload { mass_kg: 5.0, cg_m: Vector3::new(0.05, 0.0, 0.0), ..Payload::default() },
///     tip_force_n: Vector3::zeros(),
///     tip_moment_nm: Vector3::zeros(),
///     links: LinkModel::Full,
///     joints: JointModel::ThreeSegment,
///     water: None,
/// };
/// let driven = ["j1", "j2", "j3"].map(DrivenJoint::turning);
/// assert_eq!(case.to_json(&driven)["payload"]["mass_kg"], 5.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LoadCase {
    /// Name of the case.
    pub name: String,
    /// The pose in the units of files, with one entry for each driven joint, base to tip: an angle \[deg\], or the
    /// travel of a prismatic joint \[mm\].
    pub pose_deg: Vec<f64>,
    /// The payload that the arm holds.
    pub payload: Payload,
    /// Force at the tip in world axes \[N\].
    pub tip_force_n: Vector3<f64>,
    /// Moment at the tip in world axes \[N m\].
    pub tip_moment_nm: Vector3<f64>,
    /// Model of the links: which of their deformations are computed.
    pub links: LinkModel,
    /// Model of the joints: which torsion curve of their gears is used.
    pub joints: JointModel,
    /// The water around the arm in this case. `None`: the effects of the arm decide whether there is water.
    pub water: Option<Water>,
}

impl LoadCase {
    /// The case as files write it. `driven` are the driven joints of its arm.
    pub fn to_json(&self, driven: &[DrivenJoint]) -> Value {
        let (pose_key, pose) = pose_json(driven, &self.pose_deg);
        let mut case = json!({
            "name": self.name,
            pose_key: pose,
            "payload": self.payload.to_json(),
            "tip_force_n": self.tip_force_n.as_slice(),
            "links": self.links.word(),
            "joints": self.joints.word(),
        });
        if self.tip_moment_nm != Vector3::zeros() {
            case["tip_moment_nm"] = json!(self.tip_moment_nm.as_slice());
        }
        if let Some(water) = self.water {
            case["water"] = water.to_json();
        }
        case
    }
}

impl Payload {
    /// The payload as files write it.
    pub fn to_json(&self) -> Value {
        json!({
            "mass_kg": self.mass_kg,
            "cg_m": self.cg_m.as_slice(),
            "inertia_about_cg_kgm2": self.inertia_about_cg_kgm2.as_slice(),
        })
    }

    /// Reads a payload object. Returns `None` after recording a fault.
    pub fn read(node: &Node) -> Option<Self> {
        let object = node.shaped(&PAYLOAD)?;
        let mass_kg = object.required("mass_kg").and_then(|n| n.non_negative());
        let cg_m = object.or("cg_m", Vector3::zeros(), vector);
        let inertia = object.or("inertia_about_cg_kgm2", Vector3::zeros(), read_inertia);
        Some(Self { mass_kg: mass_kg?, cg_m: cg_m?, inertia_about_cg_kgm2: inertia? })
    }
}

/// Water around the arm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Water {
    /// Density of the water \[kg/m³\].
    pub density_kg_m3: f64,
    /// Added mass across a link divided by the mass of the water that the link displaces.
    pub added_mass_coefficient: f64,
    /// Density of the payload, for its buoyancy \[kg/m³\].
    pub payload_density_kg_m3: f64,
}

impl Water {
    /// The water as files write it.
    pub fn to_json(&self) -> Value {
        json!({
            "density_kg_m3": self.density_kg_m3,
            "added_mass_coefficient": self.added_mass_coefficient,
            "payload_density_kg_m3": self.payload_density_kg_m3,
        })
    }

    /// Reads a water object. If it gives no density of the payload, the density of steel is taken. Returns `None` after
    /// recording a fault.
    pub fn read(node: &Node) -> Option<Self> {
        let object = node.shaped(&WATER)?;
        let density_kg_m3 = object.required("density_kg_m3").and_then(|n| n.positive());
        let added_mass_coefficient = object.or("added_mass_coefficient", 1.0, Node::non_negative);
        let payload_density_kg_m3 = object.or("payload_density_kg_m3", 7850.0, Node::positive);
        Some(Self {
            density_kg_m3: density_kg_m3?,
            added_mass_coefficient: added_mass_coefficient?,
            payload_density_kg_m3: payload_density_kg_m3?,
        })
    }
}

fn read_inertia(node: &Node) -> Option<Vector3<f64>> {
    let inertia = vector(node)?;
    match inertia.iter().all(|&i| i >= 0.0) {
        true => Some(inertia),
        false => {
            node.fault("has a negative moment of inertia", "give [ixx, iyy, izz] in kg m², none negative")
        }
    }
}

/// Reads a vector of three numbers. Returns `None` after recording a fault.
pub(crate) fn vector(node: &Node) -> Option<Vector3<f64>> {
    node.numbers::<3>().map(Vector3::from)
}

/// Reads a word that stands for one of the values of the enumeration `T`. Returns `None` after recording a fault.
pub(crate) fn word<T: Words>(node: &Node) -> Option<T> {
    let text = node.string()?;
    T::from_word(text)
        .or_else(|| node.fault(format!("\"{text}\" is not known"), &format!("choose one of: {}", T::words())))
}

/// Reads a `cases.json` document: an array of load cases for an arm with these driven joints.
///
/// # Errors
/// All faults of the document at once.
pub fn read_load_cases(document: Document, driven_joints: &[DrivenJoint]) -> Result<Vec<LoadCase>, Faults> {
    let root = document.root();
    let cases = root.array().and_then(|items| {
        if items.is_empty() {
            return root.fault("has no case", "give at least one, with its \"pose_deg\" or \"pose\"");
        }
        let read: Vec<_> = items.iter().map(|item| read_case(item, driven_joints)).collect();
        read.into_iter().collect::<Option<Vec<_>>>()
    });
    document.finish(cases)
}

fn read_case(node: &Node, driven_joints: &[DrivenJoint]) -> Option<LoadCase> {
    let object = node.shaped(&CASE)?;
    let name = object.or("name", node.path().to_string(), |n| n.string().map(String::from));
    let pose_deg = read_pose(&object, driven_joints);
    let payload = object.or("payload", Payload::default(), Payload::read);
    let water = object.or("water", None, |n| Water::read(n).map(Some));
    let tip_moment_nm = object.or("tip_moment_nm", Vector3::zeros(), vector);
    let tip_force_n = object.or("tip_force_n", Vector3::zeros(), vector);
    let links = object.or("links", LinkModel::default(), word);
    let joints = object.or("joints", JointModel::default(), word);
    Some(LoadCase {
        name: name?,
        pose_deg: pose_deg?,
        payload: payload?,
        tip_force_n: tip_force_n?,
        tip_moment_nm: tip_moment_nm?,
        links: links?,
        joints: joints?,
        water: water?,
    })
}
