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

pub(crate) mod arm;
pub(crate) mod bound;
pub(crate) mod drives;
pub(crate) mod layout;
pub(crate) mod pencil;
pub(crate) mod pose;
pub(crate) mod region;
pub(crate) mod search;
pub(crate) mod span;
pub(crate) mod staircase;
pub(crate) mod tree;
pub(crate) mod tubes;

use crate::catalog::Catalogs;
use crate::pareto::objectives::Objectives;
use crate::space::design::evaluate;
use crate::space::design::number;
use crate::space::design_space::DesignSpace;
use crate::space::levels::OutwardIn;
use crate::space::problem::ArmProblem;
use crate::verify::region::corners::Corner;
use arm::{Arm, Parts, read};
use drives::{Alike, Choice, Drives};
use rayon::prelude::*;
use search::{Design, Found, Halt, Search};
use staircase::Staircase;
use std::collections::BTreeSet;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, PoisonError};
use std::time::Instant;
use tree::Tree;
use tubes::Tubes;

/// Single designs judged at a time.
const BATCH: usize = 4096;
/// Spaces of more designs than this are searched region by region.
const VAST: u128 = 100_000_000_000_000;
/// Zones of no more designs than this are searched box by box.
const FEW: f64 = 1e5;
/// Designs that are listed with all their ties; of more, one of each is.
const MOST_TIES: f64 = 2e4;

/// A design space prepared for its boxes.
pub struct Witness {
    arm: Arc<Arm>,
    joints: Vec<Drives>,
    tubes: Vec<Tubes>,
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
    /// Whether no candidate was left out because it ties with another.
    pub ties_listed: bool,
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

/// How to look for missing designs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct By {
    /// Spaces of more designs are searched region by region.
    pub regions_from: u128,
    /// What has no more designs left is searched box by box.
    pub boxes_to: f64,
    /// Rows closer to each other than this part may stand for each other.
    pub apart: f64,
}

impl Default for By {
    fn default() -> Self {
        Self { regions_from: VAST, boxes_to: FEW, apart: 0.0 }
    }
}

/// Looks for designs that belong beside the rows of a front.
///
/// The answer does not depend on the number of threads unless it is stopped.
pub fn missing(
    space: &DesignSpace,
    catalogs: &Catalogs,
    front: &[Objectives],
    by: By,
    stop: &AtomicBool,
    deadline: Option<Instant>,
) -> Looked {
    let staircase = Staircase::new(front);
    let halt = Halt { stop, deadline, designs: Default::default(), count: Default::default() };
    let found = match space.designs(catalogs).is_none_or(|designs| designs > by.regions_from) {
        false => {
            let witness = Witness::new(space, catalogs);
            let search = Search { witness: &witness, front: &staircase, corner: Corner::OPEN, halt: &halt };
            witness.root().map_or_else(Found::default, |root| search.explore(&root))
        }
        true => region::explore(space, catalogs, (front, &staircase), by, &halt),
    };
    let designs = halt.designs.lock().unwrap_or_else(PoisonError::into_inner).clone();
    let (designs, ties_listed) = numbers(&space.level_sizes(catalogs), &designs);
    let mut looked = Looked { candidates: Vec::new(), boxes: found.boxes, open: found.open, ties_listed };
    for batch in designs.chunks(BATCH) {
        match halt.out_of_time() {
            true => looked.open += batch.len() as u64,
            false => looked.candidates.extend(unbeaten(space, catalogs, batch, &staircase)),
        }
    }
    looked
}

/// Numbers of some designs, ascending, and whether they are those of all: if ties are too many they are those of one
/// of each.
fn numbers(level_sizes: &[u32], designs: &BTreeSet<Design>) -> (Vec<u128>, bool) {
    let count = |design: &Design| design.iter().map(|choice| choice.options.len() as f64).product::<f64>();
    let is_one = |design: &Design| count(design) == 1.0;
    let ties_listed = designs.iter().map(count).sum::<f64>() <= MOST_TIES || designs.iter().all(is_one);
    let mut numbers = Vec::new();
    for design in designs {
        let mut chosen: Vec<Vec<u32>> = vec![Vec::new()];
        for Choice { options, one_holds } in design {
            let options = if ties_listed || !one_holds { &options[..] } else { &options[..1] };
            let longer = |start: Vec<u32>| options.iter().map(move |&o| [&start[..], &[o]].concat());
            chosen = chosen.into_iter().flat_map(longer).collect();
        }
        numbers.extend(chosen.iter().map(|options| number(level_sizes, options)));
    }
    numbers.sort_unstable();
    numbers.dedup();
    (numbers, ties_listed)
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
        let (arm, parts) = read(space, catalogs, Alike::Apart);
        Self::of(Arc::new(arm), parts)
    }

    fn of(arm: Arc<Arm>, parts: Parts) -> Self {
        let joints = parts.joints.into_iter().map(Drives::new).collect();
        Self { arm, joints, tubes: parts.tubes.iter().map(Tubes::new).collect() }
    }

    /// All designs; `None` if there is none.
    pub fn root(&self) -> Option<PartsBox> {
        let some = self.joints.iter().all(|joint| !joint.is_empty())
            && self.tubes.iter().all(|tube| tube.tree.len() > 0);
        some.then(|| PartsBox(vec![0; self.arm.levels.len()]))
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
    pub fn options(&self, parts: &PartsBox) -> Vec<Vec<u32>> {
        let levels = self.arm.levels.iter().zip(&parts.0);
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

    /// A mass \[kg\] and a tip deflection \[m\] that no member of a box betters; `None` if no member holds.
    pub fn least_mass_and_deflection(&self, parts: &PartsBox) -> Option<[f64; 2]> {
        let ceiling = self.arm.ceiling(&self.members(parts)?)?;
        Some([ceiling.mass_kg, ceiling.tip_m])
    }

    /// Whether it is proved that no member of a box that holds has a lowest mode above `hz`.
    pub fn proves_none_faster(&self, parts: &PartsBox, hz: f64) -> bool {
        self.members(parts).is_none_or(|members| self.arm.none_faster(&members, hz))
    }

    fn tree(&self, level: usize) -> &Tree {
        match self.arm.levels[level] {
            Place::Joint(joint) => &self.joints[joint].tree,
            Place::Tube(tube) => &self.tubes[tube].tree,
        }
    }
}
