//! Drives that a lighter one makes pointless.
//!
//! Let a design hold drive B at a joint, and let drive A be lighter, nowhere softer up to the torque it
//! carries, and able to hold what the joint is asked for, which depends on the arm outboard only. With A in
//! B's place no torque, force or demand inboard grows, since every force of the study grows with every
//! weight; so whatever held still holds and the tip sags no further. No inertia grows and no stiffness falls
//! if the gears inboard stay in their segments; so no mode falls either. The design with B is then beaten,
//! whatever else it is made of. That a gear inboard may leave its segment is why this cannot be said of
//! drives once and for all, only within a box: there the torques inboard are intervals.

use super::joint_play::JointPlay;
use super::parts::{DriveBox, SAME_TORQUE};
use super::pose::Pose;
use super::problem::{Part, Problem};
use super::torsion::CurveBox;
use super::tree::Tree;
use super::work::Work;
use crate::sizing::demand::JointDemand;

/// Share of an arm's mass by which a drive must be lighter.
const LIGHTER: f64 = 1e-6;

/// Boxes to look into for a drive that makes others pointless.
const BOXES: usize = 64;

/// A drive to look for.
struct DominatingDrive<'a> {
    lighter_than_kg: f64,
    demand: &'a JointDemand,
    curve: Option<CurveBox>,
    most_torque_nm: f64,
}

impl DominatingDrive<'_> {
    /// Whether a box of drives may have a member that is wanted; of a box of one, whether it is.
    fn may_be_in(&self, drives: &DriveBox) -> bool {
        drives.mass_kg[0] < self.lighter_than_kg
            && drives.hold(self.demand)
            && match (&drives.curve, &self.curve) {
                (None, _) => true,
                (Some(_), None) => false,
                (Some(a), Some(b)) => a.stiff.windup.never_softer(&b.stiff.windup, self.most_torque_nm),
            }
    }

    /// The mass of a drive that is wanted \[kg\], if one is soon found.
    fn find(&self, tree: &Tree<DriveBox>, node: u32, boxes_left: &mut usize) -> Option<f64> {
        let drives = &tree.node(node).bounds;
        if *boxes_left == 0 || !self.may_be_in(drives) {
            return None;
        }
        *boxes_left -= 1;
        match tree.children(node) {
            None => Some(drives.mass_kg[0]),
            Some([a, b]) => self.find(tree, a, boxes_left).or_else(|| self.find(tree, b, boxes_left)),
        }
    }
}

impl Problem<'_> {
    /// Whether everything that is asked of an arm, and everything it yields by, grows with every weight: then
    /// a lighter arm that is no softer is no worse. What friction holds back grows with the weights too.
    pub fn grows_with_weight(&self) -> bool {
        let fits_first = self.parts.iter().any(|part| matches!(part, Part::FirstFit { .. }));
        let friction = self.joint_plays.iter().flatten().any(JointPlay::has_friction);
        !fits_first && !friction && self.poses.iter().all(Pose::grows_with_weight)
    }

    /// Takes pointless drives out of a box whose numbers are in `work`. `None` if no design is left,
    /// otherwise whether the box has shrunk.
    pub fn prune_dominated_drives(&self, design_box: &mut [u32], tip_m: f64, work: &Work) -> Option<bool> {
        let mut shrunk = false;
        // the tip's way matters where it may be the longest
        if !self.lighter_is_better || work.greatest_tip_m.iter().any(|most_m| *most_m > tip_m) {
            return Some(false);
        }
        for (level, &piece) in self.level_pieces.iter().enumerate() {
            let Part::Drives { tree, .. } = &self.parts[piece] else { continue };
            let Some(demand) = &work.greatest_demands[piece] else { continue };
            let is_dominated = |drives: &DriveBox| self.is_dominated(piece, tree, drives, demand, work);
            let node = tree.smallest_node(design_box[level], |drives| !is_dominated(drives))?;
            shrunk |= node != design_box[level];
            design_box[level] = node;
        }
        Some(shrunk)
    }

    fn is_dominated(
        &self,
        piece: usize,
        tree: &Tree<DriveBox>,
        drives: &DriveBox,
        demand: &JointDemand,
        work: &Work,
    ) -> bool {
        let arm_kg: f64 = work.masses.iter().map(|m| m[1]).sum();
        let wanted = DominatingDrive {
            lighter_than_kg: drives.mass_kg[0] - LIGHTER * arm_kg,
            demand,
            curve: drives.curve,
            most_torque_nm: work.torques.iter().map(|torques| torques[piece][1]).fold(0.0, f64::max),
        };
        wanted.find(tree, 0, &mut BOXES.clone()).is_some_and(|mass_kg| {
            self.slopes_stay(piece, (drives.mass_kg[1] - mass_kg) * self.space.gravity_m_s2, work)
        })
    }

    /// Whether every gear inboard stays in its segment, and its play as it is, if a piece loses so much weight \[N\].
    fn slopes_stay(&self, piece: usize, lost_n: f64, work: &Work) -> bool {
        self.judged_cases().all(|case| {
            self.poses[case].rows.iter().filter(|row| row.piece > piece && row.coordinate == 0).all(|row| {
                let Some(curve) = &work.curves[row.piece] else { return true };
                let [least_nm, most_nm] = work.torques[case][row.piece];
                let drop_nm = row.per_n.get(piece).map_or(0.0, |c| c.abs() * lost_n);
                let from_nm = (least_nm * (1.0 - SAME_TORQUE) - drop_nm).max(0.0);
                let between_nm = [from_nm, most_nm * (1.0 + SAME_TORQUE)];
                curve.keeps_its_slope(
                    self.joint_plays[row.piece].as_ref(),
                    between_nm,
                    work.breaks[row.piece],
                )
            })
        })
    }
}
