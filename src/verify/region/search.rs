//! The search through the local upper bounds that a front leaves open.
//!
//! A local upper bound is a mass, a deflection and a frequency such that a design below it would be new to the front. A
//! subproblem has the options that such a design may have.

use super::super::bound::{Members, ROUNDING};
use super::super::boxes::Boxes;
use super::super::front_index::FrontIndex;
use super::super::halt::{Found, Halt};
use super::super::ledger::{Branch, Ledger};
use super::super::modes::eigenvalue_of;
use super::super::search::Search;
use super::super::settings::Settings;
use super::super::skeleton::{Parts, Skeleton};
use super::super::upper_bound::UpperBound;
use super::branch::Branchings;
use super::parts_table::PartsTable;
use super::rows::Rows;
use super::subproblem::{Shape, Subproblem};
use super::upper_bounds::{Node, UpperBounds};
use super::weights::Reduced;
use crate::pareto::objectives::Objectives;
use std::sync::Arc;

/// The options are reduced once more if the last reduction removed at least this fraction of the designs.
const WORTH_IT: f64 = 0.3;

/// The inputs of a search, except the parts (the options of joints and tubes).
pub(in super::super) struct Work<'s> {
    /// The designs of the front. `index` finds the highest frequency among the designs up to a given mass and
    /// deflection.
    pub front: &'s [Objectives],
    pub index: &'s FrontIndex,
    pub settings: Settings,
    pub halt: &'s Halt<'s>,
    pub ledger: &'s Ledger<'s>,
}

/// A search through all regions that the designs of a front leave open.
pub(in super::super) struct RegionSearch<'s> {
    skeleton: Arc<Skeleton>,
    table: PartsTable,
    work: &'s Work<'s>,
}

/// How the reduction of the options of a subproblem ended.
enum Narrowed {
    /// The subproblem is done: it is proved that no member is below the upper bound.
    Refuted,
    /// So few designs are left that they are searched box by box.
    Few,
    /// Two conditions are true: more designs are left than are searched box by box, and the last step removed few of
    /// them. The subproblem is divided in one of these ways, unless its local upper bounds can be divided first.
    Many(Branchings),
    /// The search was stopped.
    Stopped,
}

impl RegionSearch<'_> {
    /// Searches all regions for designs that belong on a front but are missing from it. `parts` are the options of the
    /// space, and `work` has the front and the conditions that end the search.
    pub(crate) fn explore_all(skeleton: Arc<Skeleton>, parts: Parts, work: &Work) -> Found {
        let limits = &skeleton.limits;
        let room = 1.0 + ROUNDING;
        let limit = UpperBound {
            mass_kg: limits.mass_max_kg.map_or(f64::INFINITY, |most| most * room),
            tip_m: limits.tip_deflection_max_m.map_or(f64::INFINITY, |most| most * room),
            hz: skeleton.required_hz(),
        };
        let uppers = UpperBounds::new(work.front, limit, work.settings.apart);
        let table = PartsTable::new(parts);
        let Some(whole) = Subproblem::whole(&table) else { return Found::default() };
        RegionSearch { skeleton, table, work }.explore((&uppers, 0), whole, Branch::ROOT)
    }

    /// Searches the regions below a node of the tree of upper bounds, unless the ledger has the result of this branch
    /// already.
    fn explore(&self, uppers: (&UpperBounds, usize), subproblem: Subproblem, branch: Branch) -> Found {
        self.work.ledger.of(branch, self.work.halt, || self.explore_now(uppers, subproblem, branch))
    }

    fn explore_now(
        &self,
        (uppers, at): (&UpperBounds, usize),
        mut subproblem: Subproblem,
        branch: Branch,
    ) -> Found {
        let Some(Node { upper, halves }) = uppers.node(at) else { return Found::default() };
        let mut found = Found::default();
        let branchings = match self.narrow(&mut subproblem, upper, &mut found.boxes) {
            Narrowed::Refuted => return found,
            Narrowed::Stopped => return Found { open: 1, ..found },
            Narrowed::Few => return found.with(self.explore_boxes(&subproblem, upper)),
            Narrowed::Many(branchings) => branchings,
        };
        let subproblems = match halves {
            Some(_) => Some([subproblem.clone(), subproblem.clone()]),
            None => branchings.halves(&self.table, &subproblem),
        };
        let Some([a, b]) = subproblems else { return found.with(self.explore_boxes(&subproblem, upper)) };
        let [first, second] = halves.unwrap_or([at; 2]);
        let [of_a, of_b] = branch.halves();
        let (a, b) = rayon::join(
            || self.explore((uppers, first), a, of_a),
            || self.explore((uppers, second), b, of_b),
        );
        found.with(a).with(b)
    }

    /// Reduces the options of `subproblem` below `upper` as long as each step removes enough designs. `regions` counts
    /// the steps.
    fn narrow(&self, subproblem: &mut Subproblem, upper: UpperBound, regions: &mut u64) -> Narrowed {
        loop {
            if self.work.halt.stopped() {
                return Narrowed::Stopped;
            }
            *regions += 1;
            let before = subproblem.designs(&self.table);
            let Some(branchings) = self.narrow_once(subproblem, upper) else { return Narrowed::Refuted };
            let left = subproblem.designs(&self.table);
            if left <= self.work.settings.boxes_to {
                return Narrowed::Few;
            }
            if left > (1.0 - WORTH_IT) * before {
                return Narrowed::Many(branchings);
            }
        }
    }

    /// Removes the options that no member below `upper` can have from `subproblem`, and returns ways to branch the
    /// rest. `None` if it is proved that no member is left.
    fn narrow_once(&self, subproblem: &mut Subproblem, upper: UpperBound) -> Option<Branchings> {
        let tubes = subproblem.tube_ranges(&self.table);
        let members = subproblem.hold(&self.skeleton, &self.table, &tubes)?;
        let ideal = self.skeleton.ideal_point(&members)?;
        if !upper.is_in_reach_of(&ideal) {
            return None;
        }
        let beaten_hz = self.work.index.beaten_up_to_hz(ideal.mass_kg, ideal.tip_m);
        self.stiffest_shapes(subproblem, &members, upper.hz.max(beaten_hz))?;
        let mut rows = Rows::new(&self.skeleton, &self.table, subproblem, &members, upper);
        if rows.rows.is_empty() {
            return Some(Branchings::default());
        }
        let left = rows.reduce(subproblem)?;
        let branchings = rows.branchings(&members, &left);
        let Reduced { joints, tubes: kept, weights, .. } = left;
        let curves = std::mem::take(&mut rows.curves);
        let (others, of_modes) = weights.split_at(rows.first_mode);
        subproblem.shapes = rows
            .modes
            .into_iter()
            .zip(of_modes)
            .map(|((case, motion), &weight)| Shape { case, motion, weight })
            .collect();
        subproblem.keep_shapes(rows.columns.cases);
        subproblem.weights = others[..rows.first_interval].to_vec();
        (subproblem.joints, subproblem.tubes) = (joints, kept);
        Some(Branchings { branchings, curves })
    }

    /// Adds a trial shape (a motion that bounds the lowest mode) to `subproblem` in each judged case in which it has
    /// none. A judged case counts for deflection and lowest mode. The shape is the lowest mode of the ideal arm (every
    /// stiffness greatest, every inertia least). `None` if this arm has a frequency of at most `hz` in some case, so
    /// that no member has a higher lowest mode.
    fn stiffest_shapes(&self, subproblem: &mut Subproblem, members: &Members, hz: f64) -> Option<()> {
        let eigenvalue = eigenvalue_of(hz);
        if !eigenvalue.is_finite() {
            return None;
        }
        for (case, pose) in self.skeleton.poses.iter().filter(|pose| pose.judged).enumerate() {
            let pencil = self.skeleton.pencil(pose, members);
            let factor = pencil.factor(eigenvalue)?;
            if eigenvalue > 0.0 && subproblem.shapes.iter().all(|shape| shape.case != case) {
                subproblem.shapes.push(Shape { case, motion: pencil.lowest_mode(&factor), weight: 0.0 });
            }
        }
        Some(())
    }

    /// Searches the designs of a subproblem below `upper` box by box.
    fn explore_boxes(&self, subproblem: &Subproblem, upper: UpperBound) -> Found {
        let boxes = Boxes::of(Arc::clone(&self.skeleton), subproblem.parts(&self.table));
        let Work { index, halt, ledger, .. } = *self.work;
        let search = Search { boxes: &boxes, front: index, upper, halt, ledger };
        boxes.root().map_or_else(Found::default, |root| search.explore(&root, Branch::DEEP))
    }
}
