//! Drives that a lighter drive dominates within a box.
//!
//! Let a design have drive B at a joint. Let drive A be lighter, and at least as stiff up to the torque that the joint
//! carries. Let A also meet the demand on the joint, and let its bearing tilt no more. The demand depends only on
//! the arm outboard, so it is the same for both. Now put A in the place of B:
//!
//! - Every force of the study grows with every weight. So no torque, stress or demand inboard grows, and the tip does
//!   not deflect further. A load on a bearing is a sum of vectors. Whether it grows with the mass of every drive
//!   outboard is tested separately ([`bearing_rows`](super::bearing_rows)).
//! - No inertia grows. No stiffness falls if every gear inboard stays in its segment of the torsion curve. Then no mode
//!   falls.
//!
//! So the design with A dominates the design with B, whatever its other parts are. A gear inboard may leave
//! its segment when a part becomes lighter; therefore the step is valid only within a box, in which the
//! torques inboard are known as intervals.

use super::box_work::BoxWork;
use super::joint_play::JointPlay;
use super::parts::{DriveBox, SAME_TORQUE};
use super::pose::Pose;
use super::problem::{Part, Problem};
use super::torsion::CurveBox;
use super::tree::Tree;
use crate::sizing::demand::JointDemand;

/// A dominating drive must be lighter by at least this fraction of the arm's mass, so that rounding cannot decide.
const LEAST_MASS_SAVED: f64 = 1e-6;

/// Greatest number of tree nodes that are visited in the search for one dominating drive.
const MOST_NODES: usize = 64;

/// The properties that a drive must have to dominate all drives of a box.
struct DominatingDrive<'a> {
    /// Mass that the dominating drive must stay below \[kg\].
    lighter_than_kg: f64,
    /// Greatest demand on the joint over the box. The dominating drive must carry it.
    demand: &'a JointDemand,
    /// Torsion curves of the drives of the box. The dominating drive must nowhere be softer than any of them. `None` if
    /// a drive of the box is rigid, so that the dominating drive must be rigid too.
    curve: Option<CurveBox>,
    /// Greatest magnitude of the torque on the joint over the box \[N m\]. The curves are compared up to it.
    most_torque_nm: f64,
    /// Greatest tilt per moment that the drive's bearing may have \[rad/(N m)\].
    most_tilt_rad_per_nm: f64,
}

impl DominatingDrive<'_> {
    /// Whether the box `drives` may contain a dominating drive. `false` is certain; `true` is certain only for a box of
    /// a single drive.
    fn may_be_in(&self, drives: &DriveBox) -> bool {
        drives.mass_kg[0] < self.lighter_than_kg
            && drives.tilt_rad_per_nm[0] <= self.most_tilt_rad_per_nm
            && drives.hold(self.demand)
            && match (&drives.curve, &self.curve) {
                (None, _) => true,
                (Some(_), None) => false,
                (Some(a), Some(b)) => a.stiff.windup.never_softer(&b.stiff.windup, self.most_torque_nm),
            }
    }

    /// Mass \[kg\] of some dominating drive below `node`. `None` if none is found within `boxes_left` visits of nodes.
    /// The number of visits is subtracted from `boxes_left`.
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
    /// Whether every load of the arm, and every displacement that a load causes, grows with every weight. Then a
    /// lighter arm of the same stiffness is no worse. With friction this is false, because the twist that friction
    /// holds back grows with the weights too. With first-fit drives (the lightest that meet the demand) it is false
    /// too, because a lighter arm would get lighter and softer drives.
    pub(super) fn grows_with_weight(&self) -> bool {
        let fits_first = self.parts.iter().any(|part| matches!(part, Part::FirstFit { .. }));
        let friction = self.joint_plays.iter().flatten().any(JointPlay::has_friction);
        let is_drive = |piece: usize| matches!(self.parts[piece], Part::Drives { .. });
        let bearings = || self.poses.iter().flat_map(|pose| pose.bearings.iter().flatten());
        !fits_first
            && !friction
            && self.poses.iter().all(Pose::grows_with_weight)
            && bearings().all(|rows| rows.grow_with_mass(&is_drive))
    }

    /// Removes dominated drives from `design_box`, whose numbers are in `work`. `tip_m` is the least tip deflection of
    /// the box \[m\]. Returns whether the box became smaller; `None` if no design is left. The numbers in `work` are
    /// not updated.
    pub(super) fn prune_dominated_drives(
        &self,
        design_box: &mut [u32],
        tip_m: f64,
        work: &BoxWork,
    ) -> Option<bool> {
        let mut shrunk = false;
        // The proof at the head of this file requires that contributions to the tip's displacement do not oppose each
        // other. A pose in which they may oppose each other does no harm if the tip cannot deflect most in this pose.
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

    /// Whether a lighter drive dominates every drive of the box `drives` at the joint `piece`. The whole tree of the
    /// joint is searched for such a drive. `demand` is the greatest demand on the joint over the box.
    fn is_dominated(
        &self,
        piece: usize,
        tree: &Tree<DriveBox>,
        drives: &DriveBox,
        demand: &JointDemand,
        work: &BoxWork,
    ) -> bool {
        let arm_kg: f64 = work.masses.iter().map(|m| m[1]).sum();
        let wanted = DominatingDrive {
            lighter_than_kg: drives.mass_kg[0] - LEAST_MASS_SAVED * arm_kg,
            demand,
            curve: drives.curve,
            most_tilt_rad_per_nm: drives.tilt_rad_per_nm[0],
            most_torque_nm: work.torques.iter().map(|torques| torques[piece][1]).fold(0.0, f64::max),
        };
        // The search starts at the root, because the dominating drive need not be in the box.
        wanted.find(tree, 0, &mut MOST_NODES.clone()).is_some_and(|mass_kg| {
            self.slopes_stay(piece, (drives.mass_kg[1] - mass_kg) * self.space.gravity_m_s2, work)
        })
    }

    /// Whether every gear inboard keeps its tangent stiffness in the modes if the piece becomes lighter by `lost_n`
    /// \[N\]. The stiffness stays if the slope of the gear's torsion curve and the slope of its lost motion both stay.
    fn slopes_stay(&self, piece: usize, lost_n: f64, work: &BoxWork) -> bool {
        self.judged_cases().all(|case| {
            self.poses[case].rows.iter().filter(|row| row.piece > piece).all(|row| {
                let Some(curve) = work.curve(row) else { return true };
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
