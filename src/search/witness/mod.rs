//! A second proof that a front lacks no design.
//!
//! This module shares no code with the exact search (`search::exact`), so that a mistake in one shows in the
//! other. What it knows are the pieces of a space, the tables of drives and sections, and the full model,
//! which judges single designs.
//!
//! A box is, for each level, a node of a binary tree over the level's options (`tree.rs`). The members of a
//! box are bounded by
//!
//! - *mass*: the sum of the least masses;
//! - *demand on joints*: torques by lever arms, every weight an interval that enters once (`span.rs`,
//!   `pose.rs`). A box none of whose drives holds the least demand is cut; the drive that fits first is one
//!   that holds the least demand and none that comes after the fit of the greatest (`drives.rs`);
//! - *deflection*: the method of the unit load along a fixed direction; a displacement is at least as long
//!   as its component along any direction (`bound.rs`);
//! - *lowest mode*: that of an arm as stiff as the stiffest and as light as the lightest number of the box
//!   allows, which has fewer ways to move than the full model (`pencil.rs`, `layout.rs`).
//!
//! A box is cut if no member holds or if a row of the front is no worse in all three objectives and better
//! in one (`staircase.rs`). Otherwise one of its levels is halved (`search.rs`). What is left are single
//! designs, which the full model judges: those that hold and that no row beats belong on the front. So every
//! design of the space is either in a box that was cut, and then beaten by a row, or among those judged.

mod bound;
mod drives;
mod layout;
mod pencil;
mod pose;
mod search;
mod span;
mod staircase;
mod tree;
mod tubes;

use super::constraint::Constraints;
use super::space::{DesignSpace, SpacePiece};
use super::station::reaches_m;
use super::{ArmProblem, Objectives, OutwardIn, evaluate};
use crate::arm::Water;
use crate::catalog::Catalogs;
use crate::search::design::number;
use drives::Drives;
use layout::{Coordinate, Layout, coordinates, has_line, offset_mass_kg};
use pose::{Pose, water_of};
use rayon::prelude::*;
use search::{Found, Search};
use staircase::Staircase;
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use tree::Tree;
use tubes::Tubes;

/// Single designs judged at a time.
const BATCH: usize = 4096;

/// A design space prepared for its boxes.
pub struct Witness {
    joints: Vec<Drives>,
    tubes: Vec<Tubes>,
    /// Mass of rigid offsets \[kg\].
    offsets_kg: f64,
    poses: Vec<Pose>,
    /// Number of different surroundings.
    waters: usize,
    coordinates: Vec<Coordinate>,
    /// Stiffnesses of the effects' springs \[N m/rad\].
    spring_stiffnesses: Vec<f64>,
    constraints: Constraints,
    /// What each level chooses, tip first.
    levels: Vec<Place>,
    level_sizes: Vec<u32>,
}

/// The piece that a level chooses, base to tip.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    Joint(usize),
    Tube(usize),
}

/// A set of designs: one set of options for each level, tip first.
#[derive(Debug, Clone, PartialEq)]
pub struct PartsBox(Vec<u32>);

/// What looking for missing designs came to.
#[derive(Debug, Clone, PartialEq)]
pub struct Looked {
    /// Numbers of the designs that hold and that no row beats, ascending; those of the rows among them.
    pub candidates: Vec<u128>,
    /// Boxes bounded.
    pub boxes: u64,
    /// Boxes left unopened when it was stopped.
    pub open: u64,
}

/// Whether the bounds see all there is in a space.
///
/// # Errors
/// What they do not see, in words.
pub fn conditions(space: &DesignSpace) -> Result<(), String> {
    let weights = space.motion.duty_cycle.mean_torque_weights();
    if weights.difference > weights.sum {
        return Err("its bounds do not know a duty cycle that decelerates longer than it accelerates".into());
    }
    Ok(())
}

/// Looks for designs that belong beside the rows of a front.
///
/// The answer does not depend on the number of threads unless it is stopped.
pub fn missing(
    space: &DesignSpace,
    catalogs: &Catalogs,
    front: &[Objectives],
    stop: &AtomicBool,
    deadline: Option<Instant>,
) -> Looked {
    let witness = Witness::new(space, catalogs);
    let staircase = Staircase::new(front);
    let search = Search { witness: &witness, front: &staircase, stop, deadline, designs: Default::default() };
    let found = witness.root().map_or_else(Found::default, |root| search.explore(&root));
    let mut looked = Looked { candidates: Vec::new(), boxes: found.boxes, open: found.open };
    let mut designs = found.designs;
    designs.sort_unstable();
    for batch in designs.chunks(BATCH) {
        match search.out_of_time() {
            true => looked.open += batch.len() as u64,
            false => looked.candidates.extend(unbeaten(space, catalogs, batch, &staircase)),
        }
    }
    looked
}

/// Those of some designs that hold and that no row beats, by the full model.
fn unbeaten(space: &DesignSpace, catalogs: &Catalogs, designs: &[u128], front: &Staircase) -> Vec<u128> {
    let Some(excerpt) = space.excerpt(catalogs, designs) else { return Vec::new() };
    let problem = ArmProblem::new(&excerpt, catalogs);
    let stays = |whole: &u128| {
        let options = problem.options_of_whole(*whole)?;
        let judged = evaluate(&problem, number(problem.level_sizes(), &options))?;
        let holds = !space.constraints.broken(&judged.objectives).contains(&true);
        (holds && !front.beats(&judged.objectives)).then_some(*whole)
    };
    designs.par_iter().filter_map(stays).collect()
}

impl Witness {
    /// Prepares a space that meets the [`conditions`].
    pub fn new(space: &DesignSpace, catalogs: &Catalogs) -> Self {
        let mut waters: Vec<Option<Water>> = Vec::new();
        for water in space.cases.iter().map(|case| water_of(space, case)) {
            if !waters.contains(&water) {
                waters.push(water);
            }
        }
        let mut witness = Self {
            joints: Vec::new(),
            tubes: Vec::new(),
            offsets_kg: 0.0,
            poses: Vec::new(),
            waters: waters.len(),
            coordinates: Vec::new(),
            spring_stiffnesses: Vec::new(),
            constraints: space.constraints,
            levels: Vec::new(),
            level_sizes: space.level_sizes(catalogs),
        };
        witness.read_pieces(space, catalogs, &waters);
        if let Some(case) = space.cases.first() {
            let layout = Layout::new(space, case);
            witness.coordinates = coordinates(&layout, space.links);
            witness.spring_stiffnesses = layout.springs.iter().map(|s| 1.0 / s.rad_per_nm).collect();
        }
        let pose = |case: usize| Pose::new(space, case, &waters, &witness.coordinates);
        witness.poses = (0..space.cases.len()).map(pose).collect();
        witness
    }

    /// Joints, tubes and offsets, base to tip; their levels go from the tip inward.
    fn read_pieces(&mut self, space: &DesignSpace, catalogs: &Catalogs, waters: &[Option<Water>]) {
        let sizing = space.sizing_cases.iter().map(|&i| &space.cases[i]);
        let mut reaches = reaches_m(space, sizing).into_iter();
        for piece in &space.pieces {
            let level = self.level_sizes.len().saturating_sub(self.levels.len() + 1);
            match piece {
                SpacePiece::Joint(joint) => {
                    let reach_m = reaches.next().unwrap_or_default();
                    self.joints.push(Drives::new(space, joint, reach_m, level, catalogs));
                    if joint.drive.is_open() {
                        self.levels.push(Place::Joint(self.joints.len() - 1));
                    }
                }
                SpacePiece::Choice(choice) => {
                    self.tubes.push(Tubes::of_choice(space, choice, level, waters));
                    self.levels.push(Place::Tube(self.tubes.len() - 1));
                }
                SpacePiece::Link(link) => {
                    self.offsets_kg += offset_mass_kg(link).unwrap_or_default();
                    if has_line(space, link) {
                        self.tubes.push(Tubes::of_link(space, link, waters));
                    }
                }
            }
        }
        self.levels.reverse();
    }

    /// All designs; `None` if there is none.
    pub fn root(&self) -> Option<PartsBox> {
        let some = self.joints.iter().all(|joint| !joint.is_empty())
            && self.tubes.iter().all(|tube| tube.tree.len() > 0);
        some.then(|| PartsBox(vec![0; self.levels.len()]))
    }

    /// A box with the options of one level halved; `None` if there is one option.
    pub fn halves(&self, parts: &PartsBox, level: usize) -> Option<[PartsBox; 2]> {
        let halves = self.tree(level).halves(parts.0[level])?;
        Some(halves.map(|node| {
            let mut half = parts.clone();
            half.0[level] = node;
            half
        }))
    }

    /// The options that a box has at each level, tip first.
    pub fn options(&self, parts: &PartsBox) -> Vec<&[u32]> {
        (0..self.levels.len()).map(|level| self.tree(level).options(parts.0[level])).collect()
    }

    /// A mass \[kg\] and a tip deflection \[m\] that no member of a box betters; `None` if no member holds.
    pub fn least_mass_and_deflection(&self, parts: &PartsBox) -> Option<[f64; 2]> {
        let ceiling = self.ceiling(&self.members(parts)?)?;
        Some([ceiling.mass_kg, ceiling.tip_m])
    }

    /// Whether it is proved that no member of a box that holds has a lowest mode above `hz`.
    pub fn proves_none_faster(&self, parts: &PartsBox, hz: f64) -> bool {
        self.members(parts).is_none_or(|members| self.none_faster(&members, hz))
    }

    fn tree(&self, level: usize) -> &Tree {
        match self.levels[level] {
            Place::Joint(joint) => &self.joints[joint].tree,
            Place::Tube(tube) => &self.tubes[tube].tree,
        }
    }
}
