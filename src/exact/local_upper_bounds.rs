//! Local upper bounds of the incumbents. They describe the region in which further designs of the front may lie.
//!
//! The search region is the set of objective vectors that no incumbent dominates. It is the union of boxes
//! below local upper bounds: a design that is not dominated is lighter, deflects less and has a higher mode
//! than some local upper bound.
//!
//! One sweep over the incumbents by rising mass finds all local upper bounds. Deflection and mode of the incumbents so
//! far form a staircase, with a bound between any two neighbouring steps. When a heavier incumbent cuts off such a
//! bound, the bound is complete and its mass is the mass of this incumbent.

use super::bound::BoxBound;
use crate::pareto::objectives::Objectives;

/// A local upper bound: a mass \[kg\], a tip deflection \[m\] and a frequency \[Hz\]. A design below it (of less mass,
/// less deflection and a higher mode) is not dominated by the incumbents from which the bound was made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LocalUpperBound {
    pub mass_kg: f64,
    pub tip_m: f64,
    pub hz: f64,
}

impl LocalUpperBound {
    /// The bound of the smallest region that contains the regions below this local upper bound and below `other`. It
    /// has the larger mass and deflection and the lower frequency of the two.
    fn join(&self, other: &Self) -> Self {
        Self {
            mass_kg: self.mass_kg.max(other.mass_kg),
            tip_m: self.tip_m.max(other.tip_m),
            hz: self.hz.min(other.hz),
        }
    }

    /// Whether a box of designs with the ideal point `box_bound` may have a member below this local upper bound.
    #[inline]
    pub(super) fn admits(&self, box_bound: &BoxBound) -> bool {
        box_bound.mass_kg <= self.mass_kg && box_bound.tip_m <= self.tip_m && box_bound.hz >= self.hz
    }

    /// The eigenvalue `(2πf)²` of the frequency `f` of this local upper bound \[1/s²\].
    pub(super) fn lambda(&self) -> f64 {
        (self.hz * std::f64::consts::TAU).powi(2)
    }

    /// Mass, deflection and frequency in this order.
    fn numbers(&self) -> [f64; 3] {
        [self.mass_kg, self.tip_m, self.hz]
    }
}

/// All local upper bounds, as the leaves of a binary tree. The bound of each node covers all bounds below the node, so
/// that many of them can be refuted at once.
pub(super) struct LocalUpperBounds {
    nodes: Vec<Node>,
}

/// A node of the tree. Nodes are stored in preorder: a node, its first half, its second half.
struct Node {
    bound: LocalUpperBound,
    /// Index of the first node after this subtree.
    end: usize,
}

impl LocalUpperBounds {
    /// The local upper bounds of the region that `designs` leave undominated within `limits`, the limits of the study.
    /// Dominated designs are removed from `designs`.
    pub(super) fn new(designs: &mut Vec<Objectives>, limits: LocalUpperBound) -> Self {
        designs.sort_unstable_by(|a, b| {
            (a.mass_kg.total_cmp(&b.mass_kg))
                .then(a.tip_deflection_m.total_cmp(&b.tip_deflection_m))
                .then(b.lowest_mode_hz.total_cmp(&a.lowest_mode_hz))
        });
        let mut stairs = Stairs { steps: Vec::new(), limits };
        let mut upper_bounds = Vec::new();
        designs.retain(|design| stairs.add(design, &mut upper_bounds));
        upper_bounds.extend((0..=stairs.steps.len()).map(|k| stairs.bound_before(k, limits.mass_kg)));
        // A bound that asks for no deflection, or for an infinite mode, admits no design.
        upper_bounds.retain(|c| c.tip_m > 0.0 && c.hz < f64::INFINITY);
        let mut nodes = Vec::with_capacity(2 * upper_bounds.len());
        if !upper_bounds.is_empty() {
            grow(&mut upper_bounds, &mut nodes);
        }
        Self { nodes }
    }

    /// The local upper bound at node `at`, and the numbers of the node's two halves; `None` in place of the halves for
    /// a leaf. Node 0 is the root. `None` if there is no node `at`.
    pub(super) fn node(&self, at: usize) -> Option<(LocalUpperBound, Option<[usize; 2]>)> {
        let node = self.nodes.get(at)?;
        let halves = (node.end > at + 1).then(|| [at + 1, self.nodes[at + 1].end]);
        Some((node.bound, halves))
    }
}

/// The staircase of the incumbents added so far: deflection \[m\] and mode \[Hz\] of those that are not dominated, in
/// ascending order of both.
struct Stairs {
    steps: Vec<[f64; 2]>,
    limits: LocalUpperBound,
}

impl Stairs {
    /// Adds a design that is at least as heavy as all designs before it. Local upper bounds that are complete now are
    /// appended to `upper_bounds`. Returns whether no earlier design dominates this one.
    fn add(&mut self, design: &Objectives, upper_bounds: &mut Vec<LocalUpperBound>) -> bool {
        let (tip_m, hz) = (design.tip_deflection_m, design.lowest_mode_hz);
        // Steps before `from` deflect less than the design. Steps before `to` have no higher mode.
        let from = self.steps.partition_point(|step| step[0] < tip_m);
        let to = self.steps.partition_point(|step| step[1] <= hz);
        // In these cases an incumbent dominates the design: it deflects no more, has no lower mode, and is no heavier.
        if to < from || self.steps.get(from).is_some_and(|step| step[0] == tip_m && step[1] >= hz) {
            return false;
        }
        // Bound k lies between the steps k - 1 and k. The design cuts off the bounds from `from` to `to`, and replaces
        // the steps between them.
        upper_bounds.extend((from..=to).map(|k| self.bound_before(k, design.mass_kg)));
        self.steps.splice(from..to, [[tip_m, hz]]);
        true
    }

    /// The local upper bound between step `k` of the staircase and the step before it. `mass_kg` is its mass. Where one
    /// of the steps is missing, the limits of the study take its place.
    fn bound_before(&self, k: usize, mass_kg: f64) -> LocalUpperBound {
        LocalUpperBound {
            mass_kg,
            tip_m: self.steps.get(k).map_or(self.limits.tip_m, |step| step[0]),
            hz: k.checked_sub(1).map_or(self.limits.hz, |k| self.steps[k][1]),
        }
    }
}

/// Builds the tree over the bounds `upper_bounds`, appends its nodes to `nodes` and returns the bound of its root. The
/// bounds are divided at the median of one objective: the one in which the ratio of the greatest to the least value is
/// largest.
fn grow(upper_bounds: &mut [LocalUpperBound], nodes: &mut Vec<Node>) -> LocalUpperBound {
    let here = nodes.len();
    nodes.push(Node { bound: upper_bounds[0], end: here + 1 });
    if upper_bounds.len() == 1 {
        return upper_bounds[0];
    }
    let ratio = |axis: usize| {
        let (low, high) = upper_bounds.iter().fold((f64::INFINITY, f64::MIN_POSITIVE), |(low, high), c| {
            let x = c.numbers()[axis];
            (low.min(x), if x.is_finite() { high.max(x) } else { high })
        });
        high / low.max(f64::MIN_POSITIVE)
    };
    let ratios = [ratio(0), ratio(1), ratio(2)];
    let axis = (0..3).max_by(|&a, &b| ratios[a].total_cmp(&ratios[b])).unwrap_or(0);
    let middle = upper_bounds.len() / 2;
    upper_bounds.select_nth_unstable_by(middle, |a, b| a.numbers()[axis].total_cmp(&b.numbers()[axis]));
    let (low, high) = upper_bounds.split_at_mut(middle);
    let bound = grow(low, nodes).join(&grow(high, nodes));
    nodes[here] = Node { bound, end: nodes.len() };
    bound
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const LIMITS: LocalUpperBound = LocalUpperBound { mass_kg: 12.0, tip_m: 12.0, hz: 0.0 };

    fn designs() -> impl Strategy<Value = Vec<Objectives>> {
        let number = || (1u32..12).prop_map(f64::from);
        let design =
            (number(), number(), number()).prop_map(|(mass_kg, tip_deflection_m, lowest_mode_hz)| {
                Objectives { tip_deflection_m, mass_kg, lowest_mode_hz }
            });
        prop::collection::vec(design, 0..40)
    }

    /// Whether a design is below some local upper bound under a node. The tree is descended node by node.
    fn is_below(upper_bounds: &LocalUpperBounds, at: usize, design: [f64; 3]) -> bool {
        let [mass_kg, tip_m, hz] = design;
        upper_bounds.node(at).is_some_and(|(c, halves)| {
            let here = mass_kg < c.mass_kg && tip_m < c.tip_m && hz > c.hz;
            here && halves
                .is_none_or(|halves| halves.into_iter().any(|half| is_below(upper_bounds, half, design)))
        })
    }

    proptest! {
        #[test]
        fn a_design_is_below_a_bound_exactly_if_none_dominates_it(designs in designs()) {
            let mut kept = designs.clone();
            let upper_bounds = LocalUpperBounds::new(&mut kept, LIMITS);
            for cell in 0..12 * 12 * 12 {
                let [mass_kg, tip_m, hz] = [cell % 12, cell / 12 % 12, cell / 144].map(|k| f64::from(k) + 0.5);
                let dominated = |o: &Objectives| {
                    o.mass_kg < mass_kg && o.tip_deflection_m < tip_m && o.lowest_mode_hz > hz
                };
                let below = is_below(&upper_bounds, 0, [mass_kg, tip_m, hz]);
                prop_assert_eq!(below, !designs.iter().any(dominated));
                prop_assert_eq!(below, !kept.iter().any(dominated));
            }
        }
    }
}
