//! What all designs of a space have in common, and the parts that each piece of it may be.

use super::Place;
use super::drives::{Alike, DriveOptions};
use super::layout::{Coordinate, Layout, coordinates, has_line, offset_mass_kg};
use super::pose::{Pose, water_of};
use super::tubes::TubeOptions;
use crate::arm::load::Water;
use crate::catalog::Catalogs;
use crate::space::constraint::Constraints;
use crate::space::design_space::{DesignSpace, SpacePiece};
use crate::space::station::reaches_m;

/// An arm but for its drives and tubes.
pub(super) struct Arm {
    /// Lengths of the tubes \[m\].
    pub lengths_m: Vec<f64>,
    /// Mass of rigid offsets \[kg\].
    pub offsets_kg: f64,
    pub poses: Vec<Pose>,
    /// Number of different surroundings.
    pub waters: usize,
    pub coordinates: Vec<Coordinate>,
    /// Stiffnesses of the effects' springs \[N m/rad\].
    pub spring_stiffnesses: Vec<f64>,
    pub constraints: Constraints,
    /// What each level chooses, tip first.
    pub levels: Vec<Place>,
    pub level_sizes: Vec<u32>,
}

/// What each joint and each tube may be, base to tip.
pub(super) struct Parts {
    pub joints: Vec<DriveOptions>,
    pub tubes: Vec<TubeOptions>,
}

/// Reads a space.
pub(super) fn read(space: &DesignSpace, catalogs: &Catalogs, alike: Alike) -> (Arm, Parts) {
    let mut waters: Vec<Option<Water>> = Vec::new();
    for water in space.cases.iter().map(|case| water_of(space, case)) {
        if !waters.contains(&water) {
            waters.push(water);
        }
    }
    let mut arm = Arm {
        lengths_m: Vec::new(),
        offsets_kg: 0.0,
        poses: Vec::new(),
        waters: waters.len(),
        coordinates: Vec::new(),
        spring_stiffnesses: Vec::new(),
        constraints: space.constraints,
        levels: Vec::new(),
        level_sizes: space.level_sizes(catalogs),
    };
    let parts = arm.read_pieces(space, catalogs, &waters, alike);
    if let Some(case) = space.cases.first() {
        let layout = Layout::new(space, case);
        arm.coordinates = coordinates(&layout, space.links);
        arm.spring_stiffnesses = layout.springs.iter().map(|s| 1.0 / s.rad_per_nm).collect();
    }
    let pose = |case: usize| Pose::new(space, case, &waters, &arm.coordinates);
    arm.poses = (0..space.cases.len()).map(pose).collect();
    (arm, parts)
}

impl Arm {
    /// Joints, tubes and offsets, base to tip; their levels go from the tip inward.
    fn read_pieces(
        &mut self,
        space: &DesignSpace,
        catalogs: &Catalogs,
        waters: &[Option<Water>],
        alike: Alike,
    ) -> Parts {
        let sizing = space.sizing_cases.iter().map(|&i| &space.cases[i]);
        let mut reaches = reaches_m(space, sizing).into_iter();
        let (mut joints, mut tubes) = (Vec::new(), Vec::<TubeOptions>::new());
        for piece in &space.pieces {
            let level = self.level_sizes.len().saturating_sub(self.levels.len() + 1);
            match piece {
                SpacePiece::Joint(joint) => {
                    let reach_m = reaches.next().unwrap_or_default();
                    joints.push(DriveOptions::new(space, joint, reach_m, level, catalogs, alike));
                    if joint.drive.is_open() {
                        self.levels.push(Place::Joint(joints.len() - 1));
                    }
                }
                SpacePiece::Choice(choice) => {
                    tubes.push(TubeOptions::of_choice(space, choice, level, waters));
                    self.levels.push(Place::Tube(tubes.len() - 1));
                }
                SpacePiece::Link(link) => {
                    self.offsets_kg += offset_mass_kg(link).unwrap_or_default();
                    if has_line(space, link) {
                        tubes.push(TubeOptions::of_link(space, link, waters));
                    }
                }
            }
        }
        self.levels.reverse();
        self.lengths_m = tubes.iter().map(|tube| tube.length_m).collect();
        Parts { joints, tubes }
    }
}
