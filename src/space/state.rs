//! The state of a partial arm in one case, and how every slot (piece of the arm) that is added inboard changes it.
//!
//! The torque on a driving joint includes the torques of its passive joints. A radian of the driving joint turns each
//! passive joint by its factor `f`. By virtual work the torque on the driving joint is therefore `t_d·w + Σ f t_p·w_p`.
//! Here `t` are twists (velocities and angular velocities per unit of a joint's rotation) and `w` are outboard wrenches
//! (forces and moments), of the driving joint (d) and of the passive joints (p). The inertia about the driving joint is
//! found in the same way, with the motion `t_d + Σ f t_p` of everything outboard of all these joints.

use super::station::{StationJoint, StationLink, Turned};
use crate::arm::joint_law::JointLaw;
use crate::mechanics::Wrench;
use nalgebra::{Matrix6, Vector3};

/// Forces on a partial arm, its inertia and its displacement, in one case. Wrench and inertia are taken about the
/// world's origin.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StationState {
    /// Wrench of weight and load of everything outboard.
    pub wrench: Wrench,
    /// Inertia matrix of everything outboard.
    pub inertia: Matrix6<f64>,
    /// Displacement of the tip \[m\] from the slots added so far.
    pub tip_m: Vector3<f64>,
    /// Dunkerley's sum of each block \[s²\]: the trace of flexibility times mass, which equals the sum of `1/λ` over
    /// all modes. The reciprocal of the sum is a lower bound of the lowest eigenvalue.
    pub trace_s2: [f64; 2],
    /// Tangent compliance of each slot \[rad/(N m)\], tip first; 0 for slots that are not joints or are not added yet.
    pub compliances: Vec<f64>,
    /// Wrench that the acceleration of each driven joint makes while the other joints are at rest. There is one entry
    /// for each driven joint, tip first; it is zero until the joint is added. The list is empty if no joint has an
    /// output bearing.
    pub ramps: Vec<Wrench>,
    /// The passive joints added so far, tip first. Each has its slot, and the wrench and the inertia of everything
    /// outboard of it.
    pub passive: Vec<(usize, Wrench, Matrix6<f64>)>,
}

impl StationState {
    /// Adds a joint with its drive. The mass of the drive is inboard of the joint. The torque on the joint and the
    /// inertia about it are therefore taken before this mass is added.
    pub(crate) fn add_joint(&mut self, slot: usize, joint: &StationJoint, law: &JointLaw, mass_kg: f64) {
        let torque_nm = self.torque_nm(joint);
        let law = law.at_angle(joint.angle_rad);
        let compliance = law.tangent_compliance_rad_per_nm(torque_nm);
        let turned: Vector3<f64> = joint.turns.iter().map(|turned| turned.tip_m_per_rad).sum();
        self.tip_m += (joint.tip_m_per_rad + turned) * law.rising_angle_rad(torque_nm);
        self.compliances[slot] = compliance;
        self.trace_s2[joint.block] += compliance * self.inertia_about(slot, joint);
        if joint.is_passive {
            self.passive.push((slot, self.wrench, self.inertia));
        }
        self.inertia += joint.inertia_per_kg * mass_kg;
        self.wrench += joint.weight_per_kg * mass_kg;
    }

    /// Torque on the joint that is to be added next \[N m\]: the torque of weight and load outboard, plus the torque
    /// that acts on this joint in addition, such as the torque of a counterbalance.
    pub(crate) fn torque_nm(&self, joint: &StationJoint) -> f64 {
        let of_passive: f64 = joint.turns.iter().map(|turned| turned.own_nm).sum();
        self.load_torque_nm(joint) + joint.own_nm + of_passive
    }

    /// Torque of weight and load outboard on the joint that is to be added next \[N m\]. The torques on the passive
    /// joints that this joint drives are included, by virtual work: a radian of the driving joint turns each of them by
    /// its factor.
    pub(crate) fn load_torque_nm(&self, joint: &StationJoint) -> f64 {
        let of_passive =
            |turned: &Turned| self.outboard_of(turned.slot).map_or(0.0, |(w, _)| turned.twist.dot(w));
        joint.twist.dot(&self.wrench) + joint.turns.iter().map(of_passive).sum::<f64>()
    }

    /// Inertia of everything outboard about the axis of the joint that is to be added next in `slot` \[kg m²\]. The
    /// passive joints that this joint drives turn with it.
    pub(crate) fn inertia_about(&self, slot: usize, joint: &StationJoint) -> f64 {
        if joint.turns.is_empty() {
            return joint.twist.dot(&(self.inertia * joint.twist));
        }
        self.inertia_between(slot, joint, joint)
    }

    /// Inertia between the motions of two joints \[kg m²\]: the torque about the first joint per unit of acceleration
    /// of the second. The first is the joint that is to be added next in `slot`. The second is the joint `moving`,
    /// which is the same joint or a joint inboard of it.
    pub(crate) fn inertia_between(&self, slot: usize, joint: &StationJoint, moving: &StationJoint) -> f64 {
        let momentum = self.momentum(slot, moving);
        // Everything outboard of a passive joint moves with the rotation of that joint too.
        let with_passive = |turned: &Turned| {
            let outboard = self.outboard_of(turned.slot);
            outboard.map_or(0.0, |(_, of)| turned.twist.dot(&self.momentum_of(of, turned.slot, moving)))
        };
        joint.twist.dot(&momentum) + joint.turns.iter().map(with_passive).sum::<f64>()
    }

    /// Momentum of everything outboard of `slot` per unit of the speed of `joint` \[per rad/s\]. The joint is in this
    /// slot or inboard of it.
    pub(crate) fn momentum(&self, slot: usize, joint: &StationJoint) -> Wrench {
        self.momentum_of(&self.inertia, slot, joint)
    }

    /// Momentum per unit of the speed of `joint` \[per rad/s\] of bodies with the inertia matrix `inertia`. These
    /// bodies are everything outboard of `slot`.
    fn momentum_of(&self, inertia: &Matrix6<f64>, slot: usize, joint: &StationJoint) -> Wrench {
        let (further, nearer): (Vec<&Turned>, Vec<&Turned>) = joint.turns.iter().partition(|t| t.slot < slot);
        let motion = nearer.iter().fold(joint.twist, |sum, turned| sum + turned.twist);
        let of = |turned: &&Turned| self.outboard_of(turned.slot).map(|(_, inertia)| inertia * turned.twist);
        further.iter().filter_map(of).fold(inertia * motion, |sum, own| sum + own)
    }

    /// Wrench and inertia of everything outboard of the passive joint in a slot; `None` if this joint is not added
    /// yet.
    fn outboard_of(&self, passive: usize) -> Option<(&Wrench, &Matrix6<f64>)> {
        self.passive.iter().find(|(slot, ..)| *slot == passive).map(|(_, wrench, inertia)| (wrench, inertia))
    }

    /// Adds a rigid body, given by its inertia matrix and its weight about the world's origin.
    pub(crate) fn add_body(&mut self, inertia: &Matrix6<f64>, weight: &Wrench) {
        self.inertia += inertia;
        self.wrench += weight;
    }

    /// Adds a tube. The end of the tube deflects under the wrench of everything outboard and under the weight of the
    /// tube.
    pub(crate) fn add_link(&mut self, link: &StationLink) {
        let end = link.end.tr_mul(&self.wrench) + link.own_weight_end;
        self.tip_m += link.tip * end;
        let momentum = self.inertia * link.end;
        for g in 0..6 {
            // The end coordinates have unit stiffness, so their diagonal inertias are the terms of Dunkerley's sum.
            let own: f64 = link.end.column(g).dot(&momentum.column(g)) + link.end_inertia[g];
            self.trace_s2[link.block[g]] += own;
        }
        self.trace_s2.iter_mut().for_each(|t| *t += link.inner_trace_s2);
        self.inertia += link.inertia;
        self.wrench += link.weight;
    }
}
