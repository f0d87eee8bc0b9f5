//! Properties of an arm that a file cannot represent, each with its part of the tip deflection.

use super::snapshot::{FileSprings, Snapshot};
use crate::arm::LinkModel;
use crate::arm::joint_torque::JointTorque;
use crate::arm::load::LoadCase;
use crate::arm::structure::{JointPiece, Piece, Structure};
use nalgebra::Vector3;
use serde_json::{Value, json};

/// A property of an arm or a case that a file does not represent.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LeftOut {
    /// Kind of the property, such as `water` or `link_compliance`.
    pub what: &'static str,
    /// Element that has the property: the name of a link, a joint or a spring, or `arm` or `tip`.
    pub at: String,
    /// Reason why it is left out, and what to do instead.
    pub why: String,
    /// The part of the tip deflection that is lost with this property: the component of the lost displacement along the
    /// whole deflection, divided by the whole. The parts of all properties and the remaining part add up to 1.
    pub tip_share: f64,
}

impl LeftOut {
    pub(crate) fn to_json(&self) -> Value {
        json!({"what": self.what, "at": self.at, "why": self.why, "tip_share": self.tip_share})
    }
}

/// An arm in a case, from which properties are removed one after the other.
pub(crate) struct Remainder {
    /// The arm without the properties that were removed so far.
    pub structure: Structure,
    case: LoadCase,
    /// The arm that determines the working points of the springs. It keeps the loads that were removed from
    /// `structure`, and lacks only the compliances that were removed.
    whole: Structure,
    whole_case: LoadCase,
    springs: FileSprings,
    tip_m: Vector3<f64>,
    /// The properties that were removed so far.
    pub left_out: Vec<LeftOut>,
}

impl Remainder {
    /// The arm as it is in a case, before anything is removed. `springs` are those of the file.
    pub(crate) fn new(structure: Structure, case: &LoadCase, springs: FileSprings) -> Self {
        let tip_m = Snapshot::new(structure.clone(), case, case.links).tip_m();
        let (whole, whole_case) = (structure.clone(), case.clone());
        Self { structure, case: case.clone(), whole, whole_case, springs, tip_m, left_out: Vec::new() }
    }

    /// The arm without the properties that were removed so far, with the springs of the file and the link model
    /// `links`.
    pub(crate) fn snapshot(&self, links: LinkModel) -> Snapshot {
        let whole = Snapshot::new(self.whole.clone(), &self.whole_case, links);
        Snapshot::new(self.structure.clone(), &self.case, links).with_springs(self.springs, &whole)
    }

    /// Displacement of the tip of the arm without the properties that were removed so far \[m\].
    fn rest_m(&self) -> Vector3<f64> {
        self.snapshot(self.case.links).tip_m()
    }

    /// Component of the displacement `part_m` \[m\] along the whole displacement of the tip, divided by the whole
    /// displacement; 0 if the tip is not displaced.
    fn share(&self, part_m: &Vector3<f64>) -> f64 {
        match self.tip_m.norm_squared() {
            0.0 => 0.0,
            whole => part_m.dot(&self.tip_m) / whole,
        }
    }

    /// Removes a property by the function `change`, and records how much of the tip deflection is lost with it. `what`,
    /// `at` and `why` say what the property is, where it is and why it is removed.
    fn remove(&mut self, what: &'static str, at: &str, why: &str, change: impl FnOnce(&mut Self)) {
        let before_m = self.rest_m();
        change(self);
        let tip_share = self.share(&(before_m - self.rest_m()));
        self.left_out.push(LeftOut { what, at: at.into(), why: why.into(), tip_share });
    }

    /// Removes the water around the arm: its buoyancy and its added mass.
    pub(crate) fn without_water(&mut self) {
        if self.structure.water.is_some() {
            let why = "the file has no water: buoyancy and added mass are missing";
            self.remove("water", "arm", why, |rest| rest.structure.water = None);
        }
    }

    /// Removes the springs that balance the arm, one by one.
    pub(crate) fn without_balance_springs(&mut self) {
        let names: Vec<String> = self.structure.springs.iter().map(|spring| spring.name.clone()).collect();
        for name in names {
            let why = "the file has no springs that balance the arm: its joints hold their torque too";
            self.remove("balance_spring", &name, why, |rest| {
                rest.structure.springs.retain(|spring| spring.name != name);
            });
        }
    }

    /// Removes, joint by joint, the torques that act in addition to weight and load, such as that of a counterbalance.
    pub(crate) fn without_joint_torques(&mut self) {
        let names = self.joints_that(|joint| !joint.torque.is_none());
        for name in names {
            let why =
                "the file has no torque on a joint in addition to weight: its motor holds this torque too";
            self.remove("joint_torque", &name, why, |rest| {
                if let Some(joint) = rest.structure.joint_mut(&name) {
                    joint.torque = JointTorque::default();
                }
            });
        }
    }

    /// Names of the joints with a property.
    fn joints_that(&self, has: impl Fn(&JointPiece) -> bool) -> Vec<String> {
        self.structure.joints().filter(|joint| has(joint)).map(|joint| joint.name.clone()).collect()
    }

    /// Makes each joint turn by its own drive alone, joint by joint. In the arm, a joint whose motor sits inboard of
    /// other joints also turns when those joints turn. Files that cannot state where motors sit lose this coupling.
    pub(crate) fn without_turning_with_others(&mut self) {
        for name in self.joints_that(|joint| !joint.turns_with.is_empty()) {
            let why = "the file has no motor that sits elsewhere: the joint does not turn with the joints that its belts cross";
            self.remove("turns_with", &name, why, |rest| {
                if let Some(joint) = rest.structure.joint_mut(&name) {
                    joint.turns_with.clear();
                }
            });
        }
    }

    /// Removes the compliance of every link, one by one, so that the loss of each is recorded. `why` is the reason that
    /// is recorded.
    pub(crate) fn without_flexible_links(&mut self, why: &str) {
        let names: Vec<String> = self
            .structure
            .pieces
            .iter()
            .filter_map(|piece| match piece {
                Piece::Link(link) if link.beam.is_some_and(|beam| beam.flexibility > 0.0) => {
                    Some(link.name.clone())
                }
                _ => None,
            })
            .collect();
        if self.case.links != LinkModel::Rigid {
            names.iter().for_each(|name| self.without_flexible_link(name, why));
        }
    }

    /// Removes the compliance of the link `name`. `why` is the reason that is recorded.
    pub(crate) fn without_flexible_link(&mut self, name: &str, why: &str) {
        self.remove("link_compliance", name, why, |rest| {
            stiffen(&mut rest.structure, name);
            // no load depends on a compliance, so the springs of the whole arm keep their working points
            stiffen(&mut rest.whole, name);
        });
    }

    /// Removes the force and the moment at the tip. `why` is the reason that is recorded.
    pub(crate) fn without_tip_load(&mut self, why: &str) {
        let unloaded =
            LoadCase { tip_force_n: Vector3::zeros(), tip_moment_nm: Vector3::zeros(), ..self.case.clone() };
        if unloaded != self.case {
            self.remove("tip_load", "tip", why, |rest| rest.case = unloaded);
        }
    }

    /// Records all springs of joints, bearings and frames as left out, for files without springs. `why` is the reason
    /// that is recorded.
    pub(crate) fn without_springs(&mut self, why: &str) {
        let statics = {
            let snapshot = Snapshot::new(self.structure.clone(), &self.case, self.case.links);
            snapshot.posed().statics()
        };
        let is_link = |name: &str| {
            let links = self.structure.pieces.iter().filter_map(|piece| match piece {
                Piece::Link(link) => Some(&link.name),
                _ => None,
            });
            links.into_iter().any(|link| link == name)
        };
        let springs =
            statics.shares_m.iter().filter(|(name, share)| !is_link(name) && *share != Vector3::zeros());
        let out: Vec<LeftOut> = springs
            .map(|(name, share)| LeftOut {
                what: "spring",
                at: name.clone(),
                why: why.into(),
                tip_share: self.share(share),
            })
            .collect();
        self.left_out.extend(out);
    }
}

/// Makes the link `name` of a structure rigid.
fn stiffen(structure: &mut Structure, name: &str) {
    for piece in &mut structure.pieces {
        if let Piece::Link(link) = piece
            && link.name == name
            && let Some(beam) = &mut link.beam
        {
            beam.flexibility = 0.0;
        }
    }
}
