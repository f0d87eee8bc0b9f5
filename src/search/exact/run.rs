//! Branch and bound: cut, halve, judge.

use super::archive::Found;
use super::bound::{Ceiling, Cell, Verdict, Work};
use super::problem::{Part, Problem, Restriction};
use super::shape::Shape;
use crate::catalog::Catalogs;
use crate::search::Objectives;
use crate::search::design::number;
use crate::search::space::DesignSpace;
use crate::search::sweep::Candidate;
use rayon::prelude::*;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Boxes to open before the workers start.
const TASKS: usize = 2048;
/// A level with more options than this is thinned for the first search.
const THIN: usize = 24;

/// A search for the exact front that others can watch and stop.
pub struct Exact<'p> {
    space: &'p DesignSpace,
    catalogs: &'p Catalogs,
    stop: &'p AtomicBool,
    boxes: AtomicU64,
    counts: [AtomicU64; 8],
}

/// What the search found.
#[derive(Debug, Clone, PartialEq)]
pub struct ExactOutcome {
    /// Designs in the space.
    pub designs_total: u128,
    /// Designs judged by the full model.
    pub designs_evaluated: u64,
    /// Boxes bounded.
    pub boxes: u64,
    /// Boxes left unopened because the search was stopped.
    pub boxes_open: u64,
    /// Designs that no other one found beats.
    pub front: Vec<Candidate>,
}

struct Search<'s, 'p> {
    exact: &'s Exact<'p>,
    problem: &'s Problem<'p>,
    found: &'s Found,
    kept: &'s Mutex<Vec<Candidate>>,
    evaluated: &'s AtomicU64,
    open: &'s AtomicU64,
    /// Turns a restricted problem's designs into those of the whole.
    sizes: &'s [u32],
}

struct Box_ {
    cell: Cell,
    shapes: Arc<Vec<Shape>>,
}

impl<'p> Exact<'p> {
    /// A search of a space; it ends early when `stop` is set.
    pub fn new(space: &'p DesignSpace, catalogs: &'p Catalogs, stop: &'p AtomicBool) -> Self {
        Self { space, catalogs, stop, boxes: AtomicU64::new(0), counts: Default::default() }
    }

    /// Boxes bounded so far.
    pub fn boxes(&self) -> u64 {
        self.boxes.load(Ordering::Relaxed)
    }

    /// dbg
    pub fn progress(&self) -> String {
        format!("boxes {} {:?}", self.boxes(), self.counts)
    }

    /// Finds the front.
    pub fn run(&self) -> ExactOutcome {
        let found = Found::new();
        let kept = Mutex::new(Vec::new());
        let (evaluated, open) = (AtomicU64::new(0), AtomicU64::new(0));
        let whole = Problem::new(self.space, self.catalogs, None).map(Problem::with_inertias);
        if let Some(whole) = &whole {
            let search = |problem: &Problem| {
                Search {
                    exact: self,
                    problem,
                    found: &found,
                    kept: &kept,
                    evaluated: &evaluated,
                    open: &open,
                    sizes: &whole.level_sizes,
                }
                .run();
            };
            for keep in [THIN, 8 * THIN] {
                let thinned = thinned(whole, keep);
                if let Some(problem) = thinned.and_then(|t| Problem::new(self.space, self.catalogs, Some(&t))) {
                    search(&problem.with_inertias());
                    if std::env::var("DBG").is_ok() {
                        eprintln!("seed {keep}: boxes {} kept {}", self.boxes(), kept.lock().unwrap().len());
                    }
                }
            }
            search(whole);
        }
        let mut front = kept.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        clear(&mut front);
        front.sort_unstable_by_key(|c| c.number);
        front.dedup_by_key(|c| c.number);
        ExactOutcome {
            designs_total: whole.as_ref().map_or(0, Problem::designs),
            designs_evaluated: evaluated.into_inner(),
            boxes: self.boxes(),
            boxes_open: open.into_inner(),
            front,
        }
    }
}

/// Every level with at most `keep` options, the best of them first: those that no other beats in mass and
/// stiffness, thinned evenly. `None` if no level is larger.
fn thinned(problem: &Problem, keep: usize) -> Option<Restriction> {
    let mut any = false;
    let levels = problem
        .level_pieces
        .iter()
        .zip(&problem.level_sizes)
        .map(|(&piece, &size)| {
            if size as usize <= keep {
                return None;
            }
            any = true;
            let merits = match &problem.parts[piece] {
                Part::Drives { tree, .. } => tree.leaves(|d| {
                    let k = d.curve.map_or([0.0; 2], |c| [c.stiff.k1_nm_per_rad, c.stiff.k3_nm_per_rad]);
                    [d.mass_kg[0], -k[0], -d.limits.peak_torque_nm]
                }),
                Part::Links { tree, .. } => {
                    tree.leaves(|l| [l.low.inertias[0], -l.low.stiffnesses[0], -l.low.stiffnesses[1]])
                }
                _ => return None,
            };
            Some(evenly(best(merits), keep))
        })
        .collect();
    any.then_some(levels)
}

/// The options that no other beats in all three merits, lightest first.
fn best(merits: Vec<(u32, [f64; 3])>) -> Vec<u32> {
    let points: Vec<[f64; 3]> = merits.iter().map(|(_, m)| *m).collect();
    let groups = crate::search::front::nondominated(&points);
    groups.into_iter().map(|group| merits[group[0]].0).collect()
}

fn evenly(options: Vec<u32>, keep: usize) -> Vec<u32> {
    let n = options.len();
    if n <= keep {
        return options;
    }
    (0..keep).map(|i| options[i * (n - 1) / (keep - 1)]).collect()
}

impl Search<'_, '_> {
    fn run(&self) {
        let mut work = Work::default();
        let Some(shapes) = self.problem.first_shapes(&mut work) else { return };
        let mut queue = VecDeque::from([Box_ { cell: self.problem.root(), shapes: Arc::new(shapes) }]);
        while queue.len() < TASKS {
            let Some(next) = queue.pop_front() else { break };
            let mut children = Vec::new();
            self.open(next, &mut work, &mut |child| children.push(child));
            queue.extend(children);
        }
        queue.into_par_iter().for_each_init(Work::default, |work, start| {
            let mut stack = vec![start];
            while let Some(next) = stack.pop() {
                if self.exact.stop.load(Ordering::Relaxed) {
                    self.open.fetch_add(1 + stack.len() as u64, Ordering::Relaxed);
                    return;
                }
                self.open(next, work, &mut |child| stack.push(child));
            }
        });
    }

    /// Bounds a box and halves it, or judges it if it is one design.
    fn open(&self, mut here: Box_, work: &mut Work, child: &mut dyn FnMut(Box_)) {
        self.exact.boxes.fetch_add(1, Ordering::Relaxed);
        let verdict =
            self.problem.bound(
                &here.cell,
                &mut here.shapes,
                work,
                |ceiling| self.found.beats(ceiling),
                |ceiling| self.found.nearly_beats(ceiling),
            );
        let Verdict::Open(ceiling) = verdict else {
            self.exact.counts[work.reason].fetch_add(1, Ordering::Relaxed);
            return;
        };
        self.exact.counts[6].fetch_add(1, Ordering::Relaxed);
        let Some(level) = self.problem.widest_level(&here.cell, &here.shapes, work) else {
            self.judge(&here.cell, &ceiling, work);
            return;
        };
        let Some([first, second]) = self.problem.halves(&here.cell, level) else { return };
        let mut other = Box_ { cell: here.cell.clone(), shapes: Arc::clone(&here.shapes) };
        other.cell[level] = second;
        here.cell[level] = first;
        child(other);
        child(here);
    }

    /// One design: its ceiling is its objectives once its mode is made sure of.
    fn judge(&self, cell: &[u32], ceiling: &Ceiling, work: &Work) {
        let Some(options) = self.problem.options(cell) else { return };
        self.evaluated.fetch_add(1, Ordering::Relaxed);
        self.exact.counts[7].fetch_add(1, Ordering::Relaxed);
        let objectives = self.problem.objectives(ceiling, work);
        if !self.meets(&objectives) {
            return;
        }
        self.found.enter(&objectives);
        let candidate = Candidate { number: number(self.sizes, &options), objectives };
        let mut kept = self.kept.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        kept.push(candidate);
        if kept.len().is_power_of_two() && kept.len() > 4096 {
            clear(&mut kept);
        }
    }

    fn meets(&self, o: &Objectives) -> bool {
        let c = &self.problem.space.constraints;
        c.tip_deflection_max_m.is_none_or(|max| o.tip_deflection_m <= max)
            && c.mass_max_kg.is_none_or(|max| o.mass_kg <= max)
            && o.lowest_mode_hz >= c.required_mode_hz()
    }
}

/// Drops what another candidate beats.
fn clear(kept: &mut Vec<Candidate>) {
    let points: Vec<[f64; 3]> = kept.iter().map(|c| c.objectives.minimized()).collect();
    let stay = crate::search::front::not_clearly_beaten(&points, crate::search::sweep::SLACK);
    *kept = stay.into_iter().map(|i| kept[i]).collect();
}
