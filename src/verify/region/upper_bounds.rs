//! All local upper bounds of a front, in a tree.
//!
//! A design that no design of the front dominates lies below some upper bound. *Below* means that its mass and its
//! deflection are at most the values of the bound, and its lowest mode is at least the value of the bound. The bounds
//! are updated with one design of the front after another. A bound above a design is replaced by three bounds, one for
//! each objective, that are not above it. Bounds within another bound are removed.

use super::super::upper_bound::UpperBound;
use crate::pareto::objectives::Objectives;
use std::collections::HashSet;

/// Relative amount by which a dominating design must be better in at least one objective. All objectives of the
/// front's designs are made worse by this amount before the bounds are computed.
const BETTER_BY: f64 = 2e-7;

/// A binary tree over the local upper bounds of a front. The root is node 0.
pub(super) struct UpperBounds(Vec<Node>);

/// A node of the tree.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    /// The upper bound that covers all bounds below the node.
    pub upper: UpperBound,
    /// Indices of the two halves of the node; a leaf has none.
    pub halves: Option<[usize; 2]>,
}

impl UpperBounds {
    /// The local upper bounds that a front leaves open within the limits. Every feasible design that no design of the
    /// front dominates lies below at least one of them. With `apart` > 0, only one design of the front is used for each
    /// cell of a logarithmic grid of this relative step. Fewer designs give looser bounds, so nothing is missed.
    pub(super) fn new(front: &[Objectives], limits: UpperBound, apart: f64) -> Self {
        let mut uppers = left_open(&thinned(front, apart), limits);
        let mut nodes = Vec::new();
        if !uppers.is_empty() {
            grow(&mut uppers, &mut nodes);
        }
        Self(nodes)
    }

    /// The node with the number `at`. Node 0 is the root; it is missing (`None`) if no region is open.
    pub(super) fn node(&self, at: usize) -> Option<Node> {
        self.0.get(at).copied()
    }
}

/// One design of the front for each cell of a logarithmic grid with steps of `apart` (relative), or all designs if
/// `apart` is zero. The objectives of each are made worse by [`BETTER_BY`].
fn thinned(front: &[Objectives], apart: f64) -> Vec<UpperBound> {
    let mut taken = HashSet::new();
    let step = libm::log1p(apart);
    let cell = |x: f64| if step > 0.0 { (libm::log(x) / step).floor() as i64 } else { 0 };
    let rows = front.iter().filter(|row| {
        let cells = [row.mass_kg, row.tip_deflection_m, row.lowest_mode_hz].map(cell);
        step == 0.0 || taken.insert(cells)
    });
    let worse = |row: &Objectives| UpperBound {
        mass_kg: row.mass_kg * (1.0 + BETTER_BY),
        tip_m: row.tip_deflection_m * (1.0 + BETTER_BY),
        hz: row.lowest_mode_hz * (1.0 - BETTER_BY),
    };
    rows.map(worse).collect()
}

/// The local upper bounds within `limits` of the region that the designs `rows` leave undominated. No bound lies within
/// another.
fn left_open(rows: &[UpperBound], limits: UpperBound) -> Vec<UpperBound> {
    let mut uppers = vec![limits];
    for row in rows {
        let (cut, mut kept): (Vec<_>, Vec<_>) = uppers.iter().partition(|upper| upper.is_cut_by(row));
        let parts: [Vec<UpperBound>; 3] = std::array::from_fn(|axis| {
            cut.iter().map(|upper: &UpperBound| upper.left_by(row)[axis]).collect()
        });
        for parts in parts {
            let touching: Vec<UpperBound> =
                kept.iter().copied().filter(|upper| parts.iter().any(|part| part.is_within(upper))).collect();
            let own = |at: usize, part: &UpperBound| {
                let earlier = |(i, other): (usize, &UpperBound)| {
                    i != at && part.is_within(other) && (i < at || part != other)
                };
                !parts.iter().enumerate().any(earlier) && !touching.iter().any(|upper| part.is_within(upper))
            };
            kept.extend(parts.iter().enumerate().filter(|(at, part)| own(*at, part)).map(|(_, part)| *part));
        }
        uppers = kept;
    }
    uppers.retain(|upper| upper.tip_m > 0.0 && upper.hz < f64::INFINITY);
    uppers
}

/// Builds the tree over some upper bounds. They are divided at the median of the objective in which they are spread
/// most, and each half is divided in the same way. Returns the index of the node.
fn grow(uppers: &mut [UpperBound], nodes: &mut Vec<Node>) -> usize {
    let here = nodes.len();
    nodes.push(Node { upper: uppers[0], halves: None });
    if uppers.len() > 1 {
        let width = |axis: usize| {
            let finite = uppers.iter().map(|c| c.numbers()[axis].max(1e-9)).filter(|x| x.is_finite());
            let (least, most) =
                finite.fold((f64::INFINITY, 0.0), |(a, b): (f64, f64), x| (a.min(x), b.max(x)));
            if most > 0.0 { most / least } else { 1.0 }
        };
        let widths = [0, 1, 2].map(width);
        let axis = (0..3).rev().max_by(|&a, &b| widths[a].total_cmp(&widths[b])).unwrap_or(0);
        let half = uppers.len() / 2;
        uppers.select_nth_unstable_by(half, |a, b| a.numbers()[axis].total_cmp(&b.numbers()[axis]));
        let (low, high) = uppers.split_at_mut(half);
        let halves = [grow(low, nodes), grow(high, nodes)];
        let upper = nodes[halves[0]].upper.join(&nodes[halves[1]].upper);
        nodes[here] = Node { upper, halves: Some(halves) };
    }
    here
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Whether a design is below some upper bound under a node.
    fn is_below(uppers: &UpperBounds, at: usize, design: &UpperBound) -> bool {
        uppers.node(at).is_some_and(|Node { upper, halves }| {
            design.is_within(&upper)
                && halves.is_none_or(|halves| halves.into_iter().any(|half| is_below(uppers, half, design)))
        })
    }

    proptest! {
        #[test]
        fn a_design_is_below_a_corner_exactly_if_no_row_beats_it(
            rows in prop::collection::vec((1u32..8, 1u32..8, 1u32..8), 0..30),
        ) {
            let rows: Vec<Objectives> = rows
                .into_iter()
                .map(|(m, d, f)| Objectives {
                    mass_kg: m.into(), tip_deflection_m: d.into(), lowest_mode_hz: f.into(),
                })
                .collect();
            let uppers = UpperBounds::new(&rows, UpperBound { mass_kg: 9.0, tip_m: f64::INFINITY, hz: 0.0 }, 0.0);
            for cell in 0..9 * 9 * 9 {
                let [mass_kg, tip_m, hz] = [cell % 9, cell / 9 % 9, cell / 81].map(|k| f64::from(k) + 0.5);
                let design = UpperBound { mass_kg, tip_m, hz };
                let beaten = rows.iter().any(|row| {
                    row.mass_kg < mass_kg && row.tip_deflection_m < tip_m && row.lowest_mode_hz > hz
                });
                prop_assert_eq!(is_below(&uppers, 0, &design), !beaten);
            }
        }
    }

    #[test]
    fn fewer_rows_leave_more_open_and_none_less() {
        let rows: Vec<Objectives> = (0..200)
            .map(|i| {
                let part = f64::from(i * 37 % 200) / 200.0;
                let other = f64::from(i * 71 % 200) / 200.0;
                Objectives {
                    mass_kg: 5.0 + part,
                    tip_deflection_m: 2.0 - part + other,
                    lowest_mode_hz: 5.0 + other,
                }
            })
            .collect();
        let limits = UpperBound { mass_kg: 20.0, tip_m: 20.0, hz: 0.0 };
        let [all, few] = [0.0, 0.1].map(|apart| UpperBounds::new(&rows, limits, apart));
        assert!(few.0.len() < all.0.len());
        for Node { upper, halves } in &all.0 {
            assert!(halves.is_some() || is_below(&few, 0, upper));
        }
    }
}
