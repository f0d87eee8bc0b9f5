//! What the rows of a front leave open: corners below which a design lies that no row beats, in a tree.
//!
//! A corner is a mass, a deflection and a frequency. What no row beats is below some corner: no heavier, deflects
//! no more, is no slower. The corners are made row by row: those that a row beats are each replaced by three that it does not,
//! one an objective, and of these those that lie within another go.

use super::super::bound::{Ceiling, ROUNDING};
use super::super::search::eigenvalue_of;
use crate::pareto::objectives::Objectives;
use std::collections::HashSet;

/// A row must be better than what it beats by this in one objective (relative), and counts for worse by as much.
const BETTER: f64 = 2e-7;

/// A mass, a deflection and a lowest mode that bound designs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct Corner {
    pub mass_kg: f64,
    pub tip_m: f64,
    pub hz: f64,
}

/// A binary tree over corners; the root is node 0.
pub(super) struct Corners(Vec<Node>);

/// The corner that bounds those below, and the halves.
type Node = (Corner, Option<[usize; 2]>);

impl Corner {
    /// Everything is below it.
    pub const OPEN: Self = Self { mass_kg: f64::INFINITY, tip_m: f64::INFINITY, hz: 0.0 };

    /// Whether something of this mass and deflection may be below.
    pub fn is_in_reach_of(&self, ceiling: &Ceiling) -> bool {
        let most = 1.0 + ROUNDING;
        ceiling.mass_kg <= self.mass_kg * most && ceiling.tip_m <= self.tip_m * most
    }

    /// `(2 π f)²`.
    pub fn eigenvalue(&self) -> f64 {
        eigenvalue_of(self.hz)
    }

    /// The corner that bounds two.
    fn join(&self, other: &Self) -> Self {
        Self {
            mass_kg: self.mass_kg.max(other.mass_kg),
            tip_m: self.tip_m.max(other.tip_m),
            hz: self.hz.min(other.hz),
        }
    }

    /// Whether all that is below this corner is below another.
    fn is_within(&self, other: &Self) -> bool {
        self.mass_kg <= other.mass_kg && self.tip_m <= other.tip_m && self.hz >= other.hz
    }

    /// Whether a row beats some of what is below.
    fn is_cut_by(&self, row: &Corner) -> bool {
        row.mass_kg < self.mass_kg && row.tip_m < self.tip_m && row.hz > self.hz
    }

    /// What a row leaves of it: no heavier than the row, or deflecting no more, or no slower.
    fn left_by(&self, row: &Corner) -> [Self; 3] {
        [
            Self { mass_kg: row.mass_kg, ..*self },
            Self { tip_m: row.tip_m, ..*self },
            Self { hz: row.hz, ..*self },
        ]
    }

    fn numbers(&self) -> [f64; 3] {
        [self.mass_kg, self.tip_m, self.hz]
    }
}

impl Corners {
    /// The corners that rows leave of what the limits allow. Rows closer to each other than `apart` (relative) may be
    /// left out: fewer rows leave more open.
    pub fn new(front: &[Objectives], limits: Corner, apart: f64) -> Self {
        let mut corners = left_open(&thinned(front, apart), limits);
        let mut nodes = Vec::new();
        if !corners.is_empty() {
            grow(&mut corners, &mut nodes);
        }
        Self(nodes)
    }

    /// A node; `None` if nothing is open.
    pub fn node(&self, at: usize) -> Option<Node> {
        self.0.get(at).copied()
    }
}

/// One row a cell of a grid whose lines are a part apart; all rows if it is none.
fn thinned(front: &[Objectives], apart: f64) -> Vec<Corner> {
    let mut taken = HashSet::new();
    let step = apart.ln_1p();
    let cell = |x: f64| if step > 0.0 { (x.ln() / step).floor() as i64 } else { 0 };
    let rows = front.iter().filter(|row| {
        let cells = [row.mass_kg, row.tip_deflection_m, row.lowest_mode_hz].map(cell);
        step == 0.0 || taken.insert(cells)
    });
    let worse = |row: &Objectives| Corner {
        mass_kg: row.mass_kg * (1.0 + BETTER),
        tip_m: row.tip_deflection_m * (1.0 + BETTER),
        hz: row.lowest_mode_hz * (1.0 - BETTER),
    };
    rows.map(worse).collect()
}

/// The corners that rows leave, none within another.
fn left_open(rows: &[Corner], limits: Corner) -> Vec<Corner> {
    let mut corners = vec![limits];
    for row in rows {
        let (cut, mut kept): (Vec<_>, Vec<_>) = corners.iter().partition(|corner| corner.is_cut_by(row));
        let parts: [Vec<Corner>; 3] =
            std::array::from_fn(|axis| cut.iter().map(|corner: &Corner| corner.left_by(row)[axis]).collect());
        for parts in parts {
            let touching: Vec<Corner> = kept
                .iter()
                .copied()
                .filter(|corner| parts.iter().any(|part| part.is_within(corner)))
                .collect();
            let own = |at: usize, part: &Corner| {
                let earlier = |(i, other): (usize, &Corner)| {
                    i != at && part.is_within(other) && (i < at || part != other)
                };
                !parts.iter().enumerate().any(earlier)
                    && !touching.iter().any(|corner| part.is_within(corner))
            };
            kept.extend(parts.iter().enumerate().filter(|(at, part)| own(*at, part)).map(|(_, part)| *part));
        }
        corners = kept;
    }
    corners.retain(|corner| corner.tip_m > 0.0 && corner.hz < f64::INFINITY);
    corners
}

/// Halves corners where they are furthest apart.
fn grow(corners: &mut [Corner], nodes: &mut Vec<Node>) -> usize {
    let here = nodes.len();
    nodes.push((corners[0], None));
    if corners.len() > 1 {
        let width = |axis: usize| {
            let finite = corners.iter().map(|c| c.numbers()[axis].max(1e-9)).filter(|x| x.is_finite());
            let (least, most) =
                finite.fold((f64::INFINITY, 0.0), |(a, b): (f64, f64), x| (a.min(x), b.max(x)));
            if most > 0.0 { most / least } else { 1.0 }
        };
        let widths = [0, 1, 2].map(width);
        let axis = (0..3).rev().max_by(|&a, &b| widths[a].total_cmp(&widths[b])).unwrap_or(0);
        let half = corners.len() / 2;
        corners.select_nth_unstable_by(half, |a, b| a.numbers()[axis].total_cmp(&b.numbers()[axis]));
        let (low, high) = corners.split_at_mut(half);
        let halves = [grow(low, nodes), grow(high, nodes)];
        nodes[here] = (nodes[halves[0]].0.join(&nodes[halves[1]].0), Some(halves));
    }
    here
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Whether a design is below some corner under a node, asked node by node.
    fn is_below(corners: &Corners, at: usize, design: &Corner) -> bool {
        corners.node(at).is_some_and(|(corner, halves)| {
            design.is_within(&corner)
                && halves.is_none_or(|halves| halves.into_iter().any(|half| is_below(corners, half, design)))
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
            let corners = Corners::new(&rows, Corner { mass_kg: 9.0, tip_m: f64::INFINITY, hz: 0.0 }, 0.0);
            for cell in 0..9 * 9 * 9 {
                let [mass_kg, tip_m, hz] = [cell % 9, cell / 9 % 9, cell / 81].map(|k| f64::from(k) + 0.5);
                let design = Corner { mass_kg, tip_m, hz };
                let beaten = rows.iter().any(|row| {
                    row.mass_kg < mass_kg && row.tip_deflection_m < tip_m && row.lowest_mode_hz > hz
                });
                prop_assert_eq!(is_below(&corners, 0, &design), !beaten);
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
        let limits = Corner { mass_kg: 20.0, tip_m: 20.0, hz: 0.0 };
        let [all, few] = [0.0, 0.1].map(|apart| Corners::new(&rows, limits, apart));
        assert!(few.0.len() < all.0.len());
        for (corner, halves) in &all.0 {
            assert!(halves.is_some() || is_below(&few, 0, corner));
        }
    }
}
