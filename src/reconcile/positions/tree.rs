//! One arm, or several that stand on a common trunk, as one list of pieces.

use crate::arm::structure::{JointAngle, Piece};
use crate::arm::{Arm, JointModel};
use crate::reconcile::readings::campaign::Campaign;

/// Joints and links of all arms of a campaign. Those of the trunk are listed once.
#[derive(Debug, Clone)]
pub(crate) struct Tree {
    /// Joints and links of all arms. The angle of a joint refers to the pose of the whole campaign.
    pub pieces: Vec<Piece>,
    /// For each arm, the indices in `pieces` of its joints and links, base to tip.
    pub arms: Vec<Vec<usize>>,
    /// Number of joints and links, counted from the base, that all arms have in common.
    pub trunk: usize,
    /// Names of the driven joints, in the order of their angles in a pose.
    pub driven: Vec<String>,
    /// For each arm, the indices of its driven joints in the pose of the whole campaign.
    poses: Vec<Vec<usize>>,
}

impl Tree {
    /// Collects the joints and links of all arms of a campaign.
    pub(crate) fn new(campaign: &Campaign) -> Self {
        let driven = campaign.driven_joint_names();
        let arms = campaign.arms();
        let trunk = campaign.trunk();
        let mut tree = Self { pieces: Vec::new(), arms: Vec::new(), trunk, driven, poses: Vec::new() };
        for arm in arms {
            tree.add(arm);
        }
        tree
    }

    fn add(&mut self, arm: &Arm) {
        let own: Vec<usize> = arm
            .driven_joint_names()
            .iter()
            .filter_map(|name| self.driven.iter().position(|d| d == name))
            .collect();
        let known = if self.arms.is_empty() { 0 } else { self.trunk };
        let mut chain: Vec<usize> = (0..known).collect();
        for mut piece in arm.nominal_structure(JointModel::ThreeSegment).pieces.into_iter().skip(known) {
            if let Piece::Joint(joint) = &mut piece {
                joint.angle = match &joint.angle {
                    JointAngle::Driven(i) => JointAngle::Driven(own[*i]),
                    JointAngle::Coupled(terms) => {
                        JointAngle::Coupled(terms.iter().map(|(i, f)| (own[*i], *f)).collect())
                    }
                };
            }
            chain.push(self.pieces.len());
            self.pieces.push(piece);
        }
        self.arms.push(chain);
        self.poses.push(own);
    }

    /// The pose `pose` of all arms, in which the angles of the arm with index `arm` are replaced by `own`.
    pub(crate) fn with_pose_of(&self, arm: usize, own: &[f64], pose: &[f64]) -> Vec<f64> {
        let mut out = pose.to_vec();
        self.poses[arm].iter().zip(own).for_each(|(&i, angle)| out[i] = *angle);
        out
    }

    /// The angles of the driven joints of the arm with index `arm`, taken from `pose`, the pose of the whole
    /// campaign.
    pub(crate) fn pose_of(&self, arm: usize, pose: &[f64]) -> Vec<f64> {
        self.poses[arm].iter().map(|&i| pose[i]).collect()
    }
}
