//! What the designs found leave open: the corners of the region that none of them beats.
//!
//! A design that nothing found beats is lighter than some corner's mass, sags less than its deflection and is
//! faster than its mode. Corners come from one sweep over the designs by rising mass: a staircase of deflection
//! and mode has a corner between any two steps, and such a corner becomes one of the region at the mass at which
//! a further design cuts it off.

use super::bound::BoxBound;
use crate::pareto::objectives::Objectives;

/// A corner: a design below it in mass and deflection and above it in its mode is not beaten.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LocalUpperBound {
    pub mass_kg: f64,
    pub tip_m: f64,
    pub hz: f64,
}

impl LocalUpperBound {
    /// The corner that bounds two.
    fn join(&self, other: &Self) -> Self {
        Self {
            mass_kg: self.mass_kg.max(other.mass_kg),
            tip_m: self.tip_m.max(other.tip_m),
            hz: self.hz.min(other.hz),
        }
    }

    /// Whether a box with this ceiling may have a member below the corner.
    #[inline]
    pub fn is_in_reach_of(&self, box_bound: &BoxBound) -> bool {
        box_bound.mass_kg <= self.mass_kg && box_bound.tip_m <= self.tip_m && box_bound.hz >= self.hz
    }

    /// Square of its frequency \[1/s²\].
    pub fn lambda(&self) -> f64 {
        (self.hz * std::f64::consts::TAU).powi(2)
    }

    fn numbers(&self) -> [f64; 3] {
        [self.mass_kg, self.tip_m, self.hz]
    }
}

/// All corners, in a tree whose nodes know the corner that bounds those below.
pub(super) struct LocalUpperBounds {
    nodes: Vec<Node>,
}

/// A node in preorder.
struct Node {
    bound: LocalUpperBound,
    /// The first node that is not below this one.
    end: usize,
}

impl LocalUpperBounds {
    /// The corners that designs leave open within limits. Designs that another one beats are taken out.
    pub fn new(designs: &mut Vec<Objectives>, limits: LocalUpperBound) -> Self {
        designs.sort_unstable_by(|a, b| {
            (a.mass_kg.total_cmp(&b.mass_kg))
                .then(a.tip_deflection_m.total_cmp(&b.tip_deflection_m))
                .then(b.lowest_mode_hz.total_cmp(&a.lowest_mode_hz))
        });
        let mut stairs = Stairs { steps: Vec::new(), limits };
        let mut upper_bounds = Vec::new();
        designs.retain(|design| stairs.add(design, &mut upper_bounds));
        upper_bounds.extend((0..=stairs.steps.len()).map(|k| stairs.upper(k, limits.mass_kg)));
        upper_bounds.retain(|c| c.tip_m > 0.0 && c.hz < f64::INFINITY);
        let mut nodes = Vec::with_capacity(2 * upper_bounds.len());
        if !upper_bounds.is_empty() {
            grow(&mut upper_bounds, &mut nodes);
        }
        Self { nodes }
    }

    /// A node, the first of all being 0: the corner that bounds those below it, and its two halves.
    pub fn node(&self, at: usize) -> Option<(LocalUpperBound, Option<[usize; 2]>)> {
        let node = self.nodes.get(at)?;
        let halves = (node.end > at + 1).then(|| [at + 1, self.nodes[at + 1].end]);
        Some((node.bound, halves))
    }
}

/// Deflection and mode of the designs so far that none of them beats: both rise.
struct Stairs {
    steps: Vec<[f64; 2]>,
    limits: LocalUpperBound,
}

impl Stairs {
    /// Adds a design heavier than all before and returns the corners that it cuts off; whether it is no worse
    /// than any before.
    fn add(&mut self, design: &Objectives, upper_bounds: &mut Vec<LocalUpperBound>) -> bool {
        let (tip_m, hz) = (design.tip_deflection_m, design.lowest_mode_hz);
        // steps before `from` sag less; steps before `to` are no faster
        let from = self.steps.partition_point(|step| step[0] < tip_m);
        let to = self.steps.partition_point(|step| step[1] <= hz);
        if to < from || self.steps.get(from).is_some_and(|step| step[0] == tip_m && step[1] >= hz) {
            return false;
        }
        // corners k between the steps k - 1 and k, the outer ones shared with the neighbours
        upper_bounds.extend((from..=to).map(|k| self.upper(k, design.mass_kg)));
        self.steps.splice(from..to, [[tip_m, hz]]);
        true
    }

    /// The corner before a step.
    fn upper(&self, k: usize, mass_kg: f64) -> LocalUpperBound {
        LocalUpperBound {
            mass_kg,
            tip_m: self.steps.get(k).map_or(self.limits.tip_m, |step| step[0]),
            hz: k.checked_sub(1).map_or(self.limits.hz, |k| self.steps[k][1]),
        }
    }
}

/// Halves corners at the median of the coordinate with the largest ratio.
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

    /// Whether a design is below some corner under a node, asked node by node.
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
        fn a_design_is_below_a_corner_exactly_if_none_beats_it(designs in designs()) {
            let mut kept = designs.clone();
            let upper_bounds = LocalUpperBounds::new(&mut kept, LIMITS);
            for cell in 0..12 * 12 * 12 {
                let [mass_kg, tip_m, hz] = [cell % 12, cell / 12 % 12, cell / 144].map(|k| f64::from(k) + 0.5);
                let beaten = |o: &Objectives| {
                    o.mass_kg < mass_kg && o.tip_deflection_m < tip_m && o.lowest_mode_hz > hz
                };
                let below = is_below(&upper_bounds, 0, [mass_kg, tip_m, hz]);
                prop_assert_eq!(below, !designs.iter().any(beaten));
                prop_assert_eq!(below, !kept.iter().any(beaten));
            }
        }
    }
}
