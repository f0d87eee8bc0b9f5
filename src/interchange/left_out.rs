//! Properties of an arm that a file cannot represent, each with its part of the tip deflection.

use super::snapshot::Snapshot;
use crate::arm::LinkModel;
use crate::arm::load::LoadCase;
use crate::arm::structure::{Piece, Structure};
use nalgebra::Vector3;
use serde_json::{Value, json};

/// A property of an arm or a case that a file does not represent.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LeftOut {
    /// What the property is, such as `water` or `link_compliance`.
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
    tip_m: Vector3<f64>,
    /// The properties that were removed so far.
    pub left_out: Vec<LeftOut>,
}

impl Remainder {
    /// The arm as it is in a case, before anything is removed.
    pub(crate) fn new(structure: Structure, case: &LoadCase) -> Self {
        let tip_m = Snapshot::new(structure.clone(), case, case.links).tip_m();
        Self { structure, case: case.clone(), tip_m, left_out: Vec::new() }
    }

    /// Component of the displacement `part_m` \[m\] along the whole displacement of the tip, divided by the whole
    /// displacement.
    fn share(&self, part_m: &Vector3<f64>) -> f64 {
        match self.tip_m.norm_squared() {
            0.0 => 0.0,
            whole => part_m.dot(&self.tip_m) / whole,
        }
    }

    /// Removes a property from the structure by the function `change`, and records how much of the tip deflection is
    /// lost with it. `what`, `at` and `why` say what the property is, where it is and why it is removed.
    fn remove(&mut self, what: &'static str, at: &str, why: &str, change: impl FnOnce(&mut Structure)) {
        let before_m = Snapshot::new(self.structure.clone(), &self.case, self.case.links).tip_m();
        change(&mut self.structure);
        let after_m = Snapshot::new(self.structure.clone(), &self.case, self.case.links).tip_m();
        let tip_share = self.share(&(before_m - after_m));
        self.left_out.push(LeftOut { what, at: at.into(), why: why.into(), tip_share });
    }

    /// Removes the water around the arm: its buoyancy and its added mass.
    pub(crate) fn without_water(&mut self) {
        if self.structure.water.is_some() {
            let why = "the file has no water: buoyancy and added mass are missing";
            self.remove("water", "arm", why, |structure| structure.water = None);
        }
    }

    /// Removes the springs that balance the arm, one by one.
    pub(crate) fn without_balance_springs(&mut self) {
        let names: Vec<String> = self.structure.springs.iter().map(|spring| spring.name.clone()).collect();
        for name in names {
            let why = "the file has no springs that balance the arm: its joints hold their torque too";
            self.remove("balance_spring", &name, why, |structure| {
                structure.springs.retain(|spring| spring.name != name);
            });
        }
    }

    /// Removes, joint by joint, that a joint turns with other joints because its motor sits inboard of them. Each joint
    /// is then turned by its own drive alone. This is for files that cannot state motors that sit elsewhere.
    pub(crate) fn without_turning_with_others(&mut self) {
        let turned = self.structure.joints().filter(|joint| !joint.turns_with.is_empty());
        let names: Vec<String> = turned.map(|joint| joint.name.clone()).collect();
        for name in names {
            let why = "the file has no motor that sits elsewhere: the joint does not turn with the joints that its belts cross";
            self.remove("turns_with", &name, why, |structure| {
                for piece in &mut structure.pieces {
                    if let Piece::Joint(joint) = piece
                        && joint.name == name
                    {
                        joint.turns_with.clear();
                    }
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
        self.remove("link_compliance", name, why, |structure| {
            for piece in &mut structure.pieces {
                if let Piece::Link(link) = piece
                    && link.name == name
                    && let Some(beam) = &mut link.beam
                {
                    beam.flexibility = 0.0;
                }
            }
        });
    }

    /// Removes the force and the moment at the tip, and returns the case without them. `why` is the reason that is
    /// recorded.
    pub(crate) fn without_tip_load(&mut self, why: &str) -> LoadCase {
        let bare =
            LoadCase { tip_force_n: Vector3::zeros(), tip_moment_nm: Vector3::zeros(), ..self.case.clone() };
        if bare != self.case {
            let rest_m = Snapshot::new(self.structure.clone(), &bare, bare.links).tip_m();
            let whole_m = Snapshot::new(self.structure.clone(), &self.case, self.case.links).tip_m();
            let tip_share = self.share(&(whole_m - rest_m));
            self.left_out.push(LeftOut { what: "tip_load", at: "tip".into(), why: why.into(), tip_share });
        }
        self.case = bare;
        self.case.clone()
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
