//! The search question of a study prepared for boxes: the option trees of all levels, and the data from which boxes are
//! bounded.
//!
//! A box is a set of designs. A level is the choice of one drive or one tube, and its options are halved again and
//! again into a binary tree. A box has one node of the tree of each level; its designs have options below these nodes.

use super::bound::Members;
use super::drive_range::DriveRange;
use super::drives::{Drives, Ties};
use super::duty::Duty;
use super::parts_box::{Choice, Design, PartsBox, Place};
use super::question::Question;
use super::skeleton::{Parts, Skeleton, joint_offers};
use super::tree::Tree;
use super::tubes::{TubeRange, Tubes};
use crate::catalog::Catalogs;
use std::sync::Arc;

/// A question prepared for branch and bound over boxes of its designs.
pub struct Boxes {
    pub(super) skeleton: Arc<Skeleton>,
    pub(super) joints: Vec<Drives>,
    pub(super) tubes: Vec<Tubes>,
}

impl Boxes {
    /// Prepares a question. Drives of equal mass, torsion curve and bearing stiffness stay separate options.
    pub fn new(question: &Question, catalogs: &Catalogs) -> Self {
        let offers = joint_offers(question, catalogs);
        let skeleton = Skeleton::new(question, &offers);
        let parts = skeleton.parts(question, &offers, Ties::Apart);
        Self::of(Arc::new(skeleton), parts)
    }

    /// Prepares the boxes of an arm whose parts are not chosen (`skeleton`), with trees over the options in `parts`.
    pub(super) fn of(skeleton: Arc<Skeleton>, parts: Parts) -> Self {
        let joints = parts.joints.into_iter().map(Drives::new).collect();
        Self { skeleton, joints, tubes: parts.tubes.iter().map(Tubes::new).collect() }
    }

    /// The box of all designs; `None` if a level has no option.
    pub fn root(&self) -> Option<PartsBox> {
        let some = self.joints.iter().all(|joint| !joint.is_empty())
            && self.tubes.iter().all(|tube| tube.tree.len() > 0);
        some.then(|| PartsBox(vec![0; self.skeleton.levels.len()]))
    }

    /// The two boxes into which the box `parts` is divided by the options of one level; `None` if the level has only
    /// one option.
    pub fn halves(&self, parts: &PartsBox, level: usize) -> Option<[PartsBox; 2]> {
        let halves = self.tree(level).halves(parts.0[level])?;
        Some(halves.map(|node| {
            let mut half = parts.clone();
            half.0[level] = node;
            half
        }))
    }

    /// Indices of the options that the box `parts` has at each level, tip first.
    pub fn options(&self, parts: &PartsBox) -> Vec<Vec<u32>> {
        let levels = self.skeleton.levels.iter().zip(&parts.0);
        levels
            .map(|(place, &node)| match *place {
                Place::Joint(joint) => {
                    self.joints[joint].options(node).flat_map(|o| o.drives.iter().map(|d| d.0)).collect()
                }
                Place::Tube(tube) => {
                    let Tubes { tree, numbers, .. } = &self.tubes[tube];
                    tree.options(node).iter().map(|&i| numbers[i as usize]).collect()
                }
            })
            .collect()
    }

    /// Lower bounds, over the members of the box `parts`, of the mass \[kg\] and of the tip deflection \[m\]. `None`
    /// if it is proved that no member meets the limits.
    pub fn least_mass_and_deflection(&self, parts: &PartsBox) -> Option<[f64; 2]> {
        let ideal = self.skeleton.ideal_point(&self.members(parts)?)?;
        Some([ideal.mass_kg, ideal.tip_m])
    }

    /// Whether it is proved for a box that no member both has a lowest mode above `hz` and meets all checks and limits.
    pub fn proves_none_faster(&self, parts: &PartsBox, hz: f64) -> bool {
        self.members(parts).is_none_or(|members| self.skeleton.slowest(&members, hz).is_none())
    }

    /// The interval of each number of a part over the designs of a box, computed from the tip inward. `None` if it is
    /// proved that no member passes its checks.
    pub(super) fn members(&self, nodes: &PartsBox) -> Option<Members<'_>> {
        let tubes: Vec<&TubeRange> =
            self.tubes.iter().map(|tube| &tube.nodes[self.node(tube.level, nodes)]).collect();
        let drives = self.joints.iter().map(|joint| *joint.range(0)).collect();
        let mut members = Members::new(drives, tubes, self.skeleton.waters.len());
        for joint in (0..self.joints.len()).rev() {
            let drives = &self.joints[joint];
            let range = match &drives.duty {
                Some(duty) => self.drives_that_hold(drives, joint, duty, nodes, &members)?,
                None => *drives.range(0),
            };
            members.set_drive(joint, range);
        }
        self.skeleton.strong_enough(&members).then_some(members)
    }

    fn node(&self, level: Option<usize>, nodes: &PartsBox) -> usize {
        level.map_or(0, |level| nodes.0[level] as usize)
    }

    fn drives_that_hold(
        &self,
        drives: &Drives,
        joint: usize,
        duty: &Duty,
        nodes: &PartsBox,
        members: &Members,
    ) -> Option<DriveRange> {
        let [least, most] = self.skeleton.demands(joint, duty, members);
        match drives.level {
            Some(level) => drives.holding(nodes.0[level], &least),
            None => drives.first_fits(&least, &most),
        }
    }

    /// The single design of a box that has one option at every level, with all designs that tie with it. `None` if a
    /// level has several options.
    pub(super) fn design(&self, parts: &PartsBox) -> Option<Design> {
        let members = self.members(parts)?;
        let choice = |(place, &node): (&Place, &u32)| match *place {
            Place::Joint(joint) => {
                let drives = &self.joints[joint];
                let demands = self.skeleton.demands(joint, drives.duty.as_ref()?, &members);
                Some(drives.options(node).next()?.holding(&demands))
            }
            Place::Tube(tube) => {
                let Tubes { tree, numbers, .. } = &self.tubes[tube];
                let options = tree.options(node).iter().map(|&i| numbers[i as usize]).collect();
                Some(Choice { options, one_holds: true })
            }
        };
        self.skeleton.levels.iter().zip(&parts.0).map(choice).collect()
    }

    /// Levels at which the box has more than one option.
    pub(super) fn open_levels(&self, parts: &PartsBox) -> Vec<usize> {
        let is_open = |&level: &usize| self.tree(level).halves(parts.0[level]).is_some();
        (0..self.skeleton.levels.len()).filter(is_open).collect()
    }

    fn tree(&self, level: usize) -> &Tree {
        match self.skeleton.levels[level] {
            Place::Joint(joint) => &self.joints[joint].tree,
            Place::Tube(tube) => &self.tubes[tube].tree,
        }
    }
}
