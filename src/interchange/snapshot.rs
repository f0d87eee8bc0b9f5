//! An arm in a load case, solved: the springs of its joints at their working points.
//!
//! A curve has no single stiffness. At the load of a case it has a *secant* (deflection over load), with which a linear program
//! finds the deflection, and a *tangent*, with which it finds the frequencies.

use crate::arm::LinkModel;
use crate::arm::load::LoadCase;
use crate::arm::pose::any_slides;
use crate::arm::prismatic::{Moves, PrismaticPiece};
use crate::arm::structure::{LinkPiece, Piece, Structure};
use crate::mechanics::chain::{Chain, Item, Posed, Yielding};
use crate::mechanics::prismatic::guide_name;
use nalgebra::Vector3;
use serde_json::{Map, Value, json};

/// Load below which a spring counts as unloaded \[N m\].
const REST_NM: f64 = 1e-9;
/// How many frequencies are said.
const MODES: usize = 6;

/// A spring at the load of a case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Working {
    /// Generalized force on the coordinate \[N m\]. Of a coordinate that slides it is a force \[N\], and deflection and
    /// compliance are in m and m/N.
    pub load_nm: f64,
    /// What the coordinate yields \[rad\].
    pub deflection_rad: f64,
    /// Tangent compliance \[rad/(N m)\].
    pub tangent_rad_per_nm: f64,
}

impl Working {
    /// Whether nothing yields.
    pub(crate) fn is_rigid(&self) -> bool {
        self.tangent_rad_per_nm == 0.0 && self.deflection_rad == 0.0
    }

    /// Tangent stiffness \[N m/rad\]; the secant where the tangent is vertical.
    pub(crate) fn tangent_nm_per_rad(&self) -> f64 {
        match self.tangent_rad_per_nm > 0.0 {
            true => 1.0 / self.tangent_rad_per_nm,
            false => self.load_nm / self.deflection_rad,
        }
    }

    /// Secant stiffness \[N m/rad\]; the tangent where nothing loads the spring.
    pub(crate) fn secant_nm_per_rad(&self) -> f64 {
        let secant = self.load_nm / self.deflection_rad;
        match self.load_nm.abs() > REST_NM && secant.is_finite() && secant > 0.0 {
            true => secant,
            false => self.tangent_nm_per_rad(),
        }
    }

    /// Where a straight spring of the tangent stiffness must be at rest to yield as much under the load \[rad\].
    pub(crate) fn rest_rad(&self) -> f64 {
        self.deflection_rad - self.load_nm / self.tangent_nm_per_rad()
    }
}

/// An arm in a load case.
#[derive(Debug, Clone)]
pub(crate) struct Snapshot {
    /// The case.
    pub case: LoadCase,
    /// The arm.
    pub structure: Structure,
    chain: Chain,
}

impl Snapshot {
    /// An arm in a case, with a model of the links that need not be the case's.
    pub(crate) fn new(structure: Structure, case: &LoadCase, links: LinkModel) -> Self {
        let chain = Chain::new(&structure, links);
        Self { case: LoadCase { links, ..case.clone() }, structure, chain }
    }

    /// The arm in the pose of the case.
    pub(crate) fn posed(&self) -> Posed<'_> {
        self.chain.pose(&self.case)
    }

    /// The arm with all angles zero, in which every frame is parallel to the world's.
    pub(crate) fn at_zero(&self) -> Posed<'_> {
        self.chain.pose_rad(&vec![0.0; self.case.pose_deg.len()], &self.case.payload, Vector3::zeros())
    }

    /// Displacement of the tip \[m\].
    pub(crate) fn tip_m(&self) -> Vector3<f64> {
        self.posed().statics().tip_displacement_m
    }

    /// The link of a piece, by its number.
    pub(crate) fn link(&self, piece: usize) -> Option<&LinkPiece> {
        match self.structure.pieces.get(piece)? {
            Piece::Link(link) => Some(link),
            _ => None,
        }
    }

    /// The prismatic joint whose guide has this name, if the guide travels with a carriage.
    pub(crate) fn carriage(&self, guide: &str) -> Option<&PrismaticPiece> {
        let prismatics = self.structure.pieces.iter().filter_map(|piece| match piece {
            Piece::Prismatic(joint) => Some(joint),
            _ => None,
        });
        let mut carriages = prismatics.filter(|joint| joint.moves == Moves::Carriage);
        carriages.find(|joint| guide_name(&joint.name) == guide)
    }

    /// Names of the driven joints, in the order of the pose.
    pub(crate) fn case_joints(&self) -> Vec<String> {
        self.structure.driven_joints().into_iter().map(|joint| joint.name).collect()
    }

    /// The pose of the case: an entry for each driven joint \[rad or m\].
    pub(crate) fn pose_si(&self) -> Vec<f64> {
        let joints = self.structure.driven_joints();
        joints.iter().zip(&self.case.pose_deg).map(|(joint, entry)| joint.motion.si(*entry)).collect()
    }

    /// The pose of the case in words.
    pub(crate) fn pose_words(&self) -> String {
        let joints = self.structure.driven_joints();
        if !any_slides(&joints) {
            return format!("{:?} deg", self.case.pose_deg);
        }
        let entries = joints.iter().zip(&self.case.pose_deg);
        entries.map(|(joint, entry)| format!("{} {entry}", joint.key())).collect::<Vec<_>>().join(", ")
    }

    /// The working point of each coordinate, element by element, base to tip.
    pub(crate) fn working_points(&self) -> Vec<Vec<Working>> {
        let posed = self.posed();
        let statics = posed.statics();
        let mut wrench = posed.tip_load();
        let mut loads: Vec<Vec<f64>> = Vec::new();
        for item in posed.items.iter().rev() {
            match item {
                Item::Body(body) => wrench += body.weight(),
                Item::Load(load) => wrench += load,
                Item::Elastic(element) => {
                    let torque = statics.joint_torques_nm.iter().find(|(name, _)| *name == element.name);
                    loads.push(match (&element.yielding, torque) {
                        (Yielding::Joint(_), Some((_, torque_nm))) => vec![*torque_nm],
                        _ => element.twists.iter().map(|twist| twist.dot(&wrench)).collect(),
                    });
                    if let Some(own) = &element.own {
                        wrench += own.weight;
                    }
                }
            }
        }
        loads.reverse();
        let yielded = statics.deformations.iter().zip(&statics.tangent_compliances);
        let points = loads.iter().zip(yielded).map(|(loads, (deflections, tangents))| {
            let each = loads.iter().zip(deflections).zip(tangents);
            each.map(|((load_nm, deflection_rad), tangent)| Working {
                load_nm: *load_nm,
                deflection_rad: *deflection_rad,
                tangent_rad_per_nm: *tangent,
            })
            .collect()
        });
        points.collect()
    }

    /// What a program must find that is given this arm: torques, displacement of the tip, and lowest frequencies.
    pub(crate) fn expected(&self) -> Value {
        let posed = self.posed();
        let statics = posed.statics();
        let torques: Map<String, Value> =
            statics.joint_torques_nm.iter().map(|(name, nm)| (name.clone(), json!(nm))).collect();
        let modes: Vec<f64> = posed.modes(&statics, MODES).iter().map(|mode| mode.frequency_hz).collect();
        let forces: Map<String, Value> =
            statics.joint_forces_n.iter().map(|(name, n)| (name.clone(), json!(n))).collect();
        let mut out = json!({
            "joint_torque_nm": torques,
            "tip_displacement_m": statics.tip_displacement_m.as_slice(),
            "frequencies_hz": modes,
        });
        if !forces.is_empty() {
            out["joint_force_n"] = Value::Object(forces);
        }
        out
    }
}
