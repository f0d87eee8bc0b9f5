//! Local upper bounds: what the incumbents leave open.
//!
//! The search region is the set of objective vectors that no incumbent dominates. It is the union of boxes
//! below local upper bounds: a design that is not dominated is lighter, deflects less and has a higher mode
//! than some local upper bound.
//!
//! One sweep over the incumbents by rising mass finds them all. Deflection and mode of the incumbents so far
//! form a staircase, with a bound between any two neighbouring steps. Such a bound is complete, and gets its
//! mass, when a heavier incumbent cuts it off.

use super::bound::BoxBound;
use crate::pareto::objectives::Objectives;

/// A local upper bound. A design below it, that is, of less mass, less deflection and a higher mode, is not dominated
/// by the incumbents from which the bound was made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LocalUpperBound {
    pub mass_kg: f64,
    pub tip_m: f64,
    pub hz: f64,
}

impl LocalUpperBound {
    /// The least local upper bound that covers two others.
    fn join(&self, other: &Self) -> Self {
        Self {
            mass_kg: self.mass_kg.max(other.mass_kg),
            tip_m: self.tip_m.max(other.tip_m),
            hz: self.hz.min(other.hz),
        }
    }

    /// Whether a box with this bound may have a member below this local upper bound.
    #[inline]
    pub(super) fn admits(&self, box_bound: &BoxBound) -> bool {
        box_bound.mass_kg <= self.mass_kg && box_bound.tip_m <= self.tip_m && box_bound.hz >= self.hz
    }

    /// Eigenvalue of the local upper bound's frequency, `(2πf)²` \[1/s²\].
    pub(super) fn lambda(&self) -> f64 {
        (self.hz * std::f64::consts::TAU).powi(2)
    }

    fn numbers(&self) -> [f64; 3] {
        [self.mass_kg, self.tip_m, self.hz]
    }
}

/// All local upper bounds, as the leaves of a binary tree. Each node has a bound that covers those below it, so that
/// many are refuted at once.
pub(super) struct LocalUpperBounds {
    nodes: Vec<Node>,
}

/// A node, in preorder.
struct Node {
    bound: LocalUpperBound,
    /// Index after the last node of this subtree.
    end: usize,
}

impl LocalUpperBounds {
    /// The local upper bounds that designs leave open within limits. Dominated designs are removed from the
    /// list.
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

    /// The bound of a node, and the node's two halves if it has any. Node 0 is the root. `None` if there is no such
    /// node.
    pub(super) fn node(&self, at: usize) -> Option<(LocalUpperBound, Option<[usize; 2]>)> {
        let node = self.nodes.get(at)?;
        let halves = (node.end > at + 1).then(|| [at + 1, self.nodes[at + 1].end]);
        Some((node.bound, halves))
    }
}

/// Deflection and mode of the incumbents added so far that are not dominated, in ascending order of both.
struct Stairs {
    steps: Vec<[f64; 2]>,
    limits: LocalUpperBound,
}

impl Stairs {
    /// Adds a design that is at least as heavy as all designs before it, and appends the local upper bounds that are
    /// complete now. Returns whether the design is not dominated.
    fn add(&mut self, design: &Objectives, upper_bounds: &mut Vec<LocalUpperBound>) -> bool {
        let (tip_m, hz) = (design.tip_deflection_m, design.lowest_mode_hz);
        // Steps before `from` deflect less; steps before `to` have no higher mode.
        let from = self.steps.partition_point(|step| step[0] < tip_m);
        let to = self.steps.partition_point(|step| step[1] <= hz);
        // An incumbent so far deflects no more and has no lower mode, and all of them are no heavier.
        if to < from || self.steps.get(from).is_some_and(|step| step[0] == tip_m && step[1] >= hz) {
            return false;
        }
        // Bound k lies between the steps k - 1 and k. The outer two are shared with the neighbours.
        upper_bounds.extend((from..=to).map(|k| self.bound_before(k, design.mass_kg)));
        self.steps.splice(from..to, [[tip_m, hz]]);
        true
    }

    /// The local upper bound between step `k` and the step before it.
    fn bound_before(&self, k: usize, mass_kg: f64) -> LocalUpperBound {
        LocalUpperBound {
            mass_kg,
            tip_m: self.steps.get(k).map_or(self.limits.tip_m, |step| step[0]),
            hz: k.checked_sub(1).map_or(self.limits.hz, |k| self.steps[k][1]),
        }
    }
}

/// Builds the tree: halves the bounds at the median of the objective in which the ratio of their greatest to their
/// least value is largest.
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
