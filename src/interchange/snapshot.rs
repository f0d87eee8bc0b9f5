//! An arm in a load case, with the springs of its joints at their working points.
//!
//! A torsion curve has no single stiffness. At the load of a case it has two. With the *secant* stiffness (load over
//! deflection) a linear program computes the right deflection. With the *tangent* stiffness it computes the right
//! frequencies.
//!
//! A file may lack loads that the arm has, such as that of a balance spring. The torque at which each gear works still
//! depends on all loads of the arm. So the tangent stiffnesses in a file are those at the torques with all loads.

use crate::arm::LinkModel;
use crate::arm::load::LoadCase;
use crate::arm::pose::any_slides;
use crate::arm::prismatic::{Moves, PrismaticPiece};
use crate::arm::structure::{LinkPiece, Piece, Structure};
use crate::mechanics::chain::{Chain, Compliance, Item, Posed};
use crate::mechanics::prismatic::guide_name;
use crate::mechanics::statics::Statics;
use nalgebra::{DVector, Vector3};
use serde_json::{Map, Value, json};

/// Load below which a spring counts as unloaded \[N m\].
const REST_NM: f64 = 1e-9;
/// Number of natural frequencies in the expected results.
const MODES: usize = 6;

/// The working point of one spring: its load, its deflection and its compliance at the load of a case. A spring belongs
/// to one coordinate of an elastic element, such as the torsion of a joint or the tilt of a bearing.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Working {
    /// Generalized force on the coordinate \[N m\]. For a coordinate that slides, it is a force \[N\]. The deflection
    /// is then in m and the compliance in m/N.
    pub load_nm: f64,
    /// Deflection of the coordinate under `load_nm` \[rad\].
    pub deflection_rad: f64,
    /// Tangent compliance of the spring at `load_nm` \[rad/(N m)\].
    pub tangent_rad_per_nm: f64,
}

impl Working {
    /// Whether the spring has no compliance: neither a deflection nor a tangent compliance at the load of the case.
    pub(crate) fn is_rigid(&self) -> bool {
        self.tangent_rad_per_nm == 0.0 && self.deflection_rad == 0.0
    }

    /// Tangent stiffness at the load of the case \[N m/rad\]. If the tangent compliance is zero, the function returns
    /// the secant stiffness, because the tangent stiffness would be infinite.
    pub(crate) fn tangent_nm_per_rad(&self) -> f64 {
        match self.tangent_rad_per_nm > 0.0 {
            true => 1.0 / self.tangent_rad_per_nm,
            false => self.load_nm / self.deflection_rad,
        }
    }

    /// Secant stiffness (load over deflection) \[N m/rad\]. For an unloaded spring the function returns the tangent
    /// stiffness, because load over deflection is then undefined.
    pub(crate) fn secant_nm_per_rad(&self) -> f64 {
        let secant = self.load_nm / self.deflection_rad;
        match self.load_nm.abs() > REST_NM && secant.is_finite() && secant > 0.0 {
            true => secant,
            false => self.tangent_nm_per_rad(),
        }
    }

    /// Rest position \[rad\] of a linear spring that can replace this spring. The linear spring has the tangent
    /// stiffness. Under the load of the case it deflects as much as this spring.
    pub(crate) fn rest_rad(&self) -> f64 {
        self.deflection_rad - self.load_nm / self.tangent_nm_per_rad()
    }

    /// The working point, under another load \[N m\], of the linear spring that can replace this spring.
    fn linear_under(&self, load_nm: f64) -> Self {
        if self.is_rigid() {
            return Self { load_nm, ..*self };
        }
        let tangent_rad_per_nm = 1.0 / self.tangent_nm_per_rad();
        match tangent_rad_per_nm.is_finite() {
            true => Self {
                load_nm,
                deflection_rad: self.rest_rad() + load_nm * tangent_rad_per_nm,
                tangent_rad_per_nm,
            },
            // the tangent stiffness is zero, so no linear spring can replace this one
            false => Self { load_nm, ..*self },
        }
    }
}

/// The springs that a file has in place of torsion curves. Their tangent stiffnesses are those at the loads of the
/// whole arm, including loads that the file lacks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FileSprings {
    /// One linear spring for each curve, with its tangent stiffness. The rest position of the spring is chosen such
    /// that it deflects as much as the curve does under all loads of the arm.
    Tangents,
    /// Two stiffnesses for each curve: the secant stiffness at the loads in the file, for deflections, and the tangent
    /// stiffness, for frequencies.
    SecantsAndTangents,
}

/// An arm in a load case.
#[derive(Debug, Clone)]
pub(crate) struct Snapshot {
    /// The load case.
    pub case: LoadCase,
    /// The structure of the arm.
    pub structure: Structure,
    chain: Chain,
    /// Working points of the springs of a file; `None` if the springs follow their curves.
    in_file: Option<Vec<Vec<Working>>>,
}

impl Snapshot {
    /// An arm in a case. `links` is the model of its links, which may be another one than the model that the case
    /// states.
    pub(crate) fn new(structure: Structure, case: &LoadCase, links: LinkModel) -> Self {
        let chain = Chain::new(&structure, links);
        Self { case: LoadCase { links, ..case.clone() }, structure, chain, in_file: None }
    }

    /// This arm with the springs of a file. `whole` has the same elastic elements and all loads; this arm may lack some
    /// of the loads.
    pub(crate) fn with_springs(self, springs: FileSprings, whole: &Snapshot) -> Self {
        let joined = |(here, whole): (&Working, &Working)| match springs {
            FileSprings::Tangents => whole.linear_under(here.load_nm),
            FileSprings::SecantsAndTangents => {
                Working { tangent_rad_per_nm: whole.tangent_rad_per_nm, ..*here }
            }
        };
        let points = self.working_points();
        let both = points.iter().zip(whole.working_points());
        let in_file = both.map(|(here, whole)| here.iter().zip(&whole).map(joined).collect()).collect();
        Self { in_file: Some(in_file), ..self }
    }

    /// The arm in the pose of the case.
    pub(crate) fn posed(&self) -> Posed<'_> {
        self.chain.pose(&self.case)
    }

    /// The arm with all joint angles zero. Every frame is then parallel to the world's.
    pub(crate) fn at_zero(&self) -> Posed<'_> {
        self.chain.pose_rad(&vec![0.0; self.case.pose_deg.len()], &self.case.payload, Vector3::zeros())
    }

    /// Displacement of the tip in the case, from its position in the weightless arm, in world axes \[m\].
    pub(crate) fn tip_m(&self) -> Vector3<f64> {
        self.statics().tip_displacement_m
    }

    /// The static state of the arm in the case. If the arm has the springs of a file, the deflections and the tangent
    /// compliances are those of these springs.
    fn statics(&self) -> Statics {
        let posed = self.posed();
        let mut statics = posed.statics();
        let Some(points) = &self.in_file else { return statics };
        for (i, element) in posed.elements().enumerate() {
            // a link is linear, so it keeps its own deformations; its working points leave out the weight along it
            if element.own.is_none() {
                statics.deformations[i] = points[i].iter().map(|point| point.deflection_rad).collect();
                statics.tangent_compliances[i] =
                    points[i].iter().map(|point| point.tangent_rad_per_nm).collect();
            }
        }
        let shape: Vec<f64> = statics.deformations.iter().flatten().copied().collect();
        statics.tip_displacement_m = posed.tip_motion(&DVector::from_vec(shape));
        statics
    }

    /// The lowest natural frequencies that another program should find \[Hz\]. There are fewer if fewer modes have
    /// inertia.
    pub(crate) fn frequencies_hz(&self) -> Vec<f64> {
        self.posed().modes(&self.statics(), MODES).iter().map(|mode| mode.frequency_hz).collect()
    }

    /// The link with this index among the pieces; `None` if the piece is no link.
    pub(crate) fn link(&self, piece: usize) -> Option<&LinkPiece> {
        match self.structure.pieces.get(piece)? {
            Piece::Link(link) => Some(link),
            _ => None,
        }
    }

    /// The prismatic joint whose guide has this name, if the guide travels with a carriage; `None` for any other name.
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

    /// The working points (load, deflection and compliance) of the springs of all coordinates, as one list for each
    /// element, base to tip.
    pub(crate) fn working_points(&self) -> Vec<Vec<Working>> {
        if let Some(in_file) = &self.in_file {
            return in_file.clone();
        }
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
                    loads.push(match (&element.compliance, torque) {
                        (Compliance::Joint(_), Some((_, torque_nm))) => vec![*torque_nm],
                        _ => element.twists.iter().map(|twist| twist.dot(&wrench)).collect(),
                    });
                    if let Some(own) = &element.own {
                        wrench += own.weight;
                    }
                }
            }
        }
        loads.reverse();
        let deflected = statics.deformations.iter().zip(&statics.tangent_compliances);
        let points = loads.iter().zip(deflected).map(|(loads, (deflections, tangents))| {
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

    /// The results that another program should compute for this arm: torques, displacement of the tip, and lowest
    /// natural frequencies.
    pub(crate) fn expected(&self) -> Value {
        let statics = self.statics();
        let torques: Map<String, Value> =
            statics.joint_torques_nm.iter().map(|(name, nm)| (name.clone(), json!(nm))).collect();
        let forces: Map<String, Value> =
            statics.joint_forces_n.iter().map(|(name, n)| (name.clone(), json!(n))).collect();
        let mut out = json!({
            "joint_torque_nm": torques,
            "tip_displacement_m": statics.tip_displacement_m.as_slice(),
            "frequencies_hz": self.frequencies_hz(),
        });
        if !forces.is_empty() {
            out["joint_force_n"] = Value::Object(forces);
        }
        out
    }
}
