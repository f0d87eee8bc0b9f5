//! The bound of a box: for each objective, the best value that any of its members could have.
//!
//! A box is a set of designs; its members are these designs. An incumbent is a design that was found already.
//!
//! - *mass*: the sum of the least masses.
//! - *tip deflection*: torques, forces and compliances are intervals, so each component of the tip's displacement lies
//!   in an interval too. The bound is the length of the shortest displacement within these intervals.
//! - *lowest mode*: the Rayleigh quotient of a trial shape ([`shape`](super::shape)) with every stiffness at its
//!   greatest and every inertia at its least. For a gear, the slope of the torsion curve is the greatest that it has
//!   under the torques of the box.
//!
//! If a joint or a link cannot carry even its least load, the whole box is infeasible.

use super::box_work::BoxWork;
use super::intervals::ROUNDING;
use super::pose::{Pose, Row, TORSION};
use super::problem::{Part, Problem};
use super::shape::{Ideal, Shape};
use crate::pareto::objectives::Objectives;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The refinement of the trial shapes (motions that give an upper bound of the lowest mode) stops when a step lowers
/// the bound by less than this fraction of its value.
const SHAPE_CONVERGENCE: f64 = 1e-10;
/// Accelerations of the base \[m/s²\], one vertical and one sideways with a little forward. The first trial shapes are
/// the deformations of the arm by the inertia forces of these accelerations.
pub(super) const START_SHAPES: [[f64; 3]; 2] = [[0.0, 0.0, 1.0], [0.3, 1.0, 0.0]];
/// Greatest number of refinement steps of the trial shapes on a box of one design.
const MOST_STEPS: usize = 30;

/// A better trial shape is assumed to lower the upper bound of the lowest mode at most to this fraction of its value.
/// The number is an estimate. It decides whether a better shape is computed, and no proof rests on it.
const LOWEST_BY_SHAPE: f64 = 0.4;

/// A box of designs: for each level (choice of a part), tip first, the number of a node of the level's tree.
pub(super) type DesignBox = Vec<u32>;

/// The ideal point of a box: the least mass \[kg\], the least tip deflection \[m\] and the highest lowest mode \[Hz\]
/// that a member could have. No member is better in any of them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct BoxBound {
    pub mass_kg: f64,
    pub tip_m: f64,
    pub hz: f64,
}

impl BoxBound {
    /// The bound of a box of which nothing is known yet: zero mass, zero deflection and an infinite frequency.
    pub(super) const OPEN: Self = Self { mass_kg: 0.0, tip_m: 0.0, hz: f64::INFINITY };

    /// The bound that a better trial shape would give at best: its frequency is lowered by the factor
    /// [`LOWEST_BY_SHAPE`]. If even such a bound would not prune the box, no better shape is computed.
    pub(super) fn with_better_shape(&self) -> Self {
        Self { hz: LOWEST_BY_SHAPE * self.hz, ..*self }
    }

    /// The bound with all three objectives made worse by the factor `1 + slack`. The slack is a fraction; it is the
    /// same throughout one pass of the search.
    pub(super) fn slackened(&self, slack: f64) -> Self {
        let factor = 1.0 + slack;
        Self { mass_kg: self.mass_kg * factor, tip_m: self.tip_m * factor, hz: self.hz / factor }
    }
}

impl From<BoxBound> for Objectives {
    fn from(box_bound: BoxBound) -> Self {
        Self { tip_deflection_m: box_bound.tip_m, mass_kg: box_bound.mass_kg, lowest_mode_hz: box_bound.hz }
    }
}

/// The result of bounding a box.
pub(super) enum Verdict {
    /// No member meets the constraints, or an incumbent dominates the bound and therefore every member.
    Pruned,
    /// The box has this bound, and a member of it may be on the front.
    Open(BoxBound),
}

impl<'c> Problem<'c> {
    /// The box of all designs.
    pub(super) fn root(&self) -> DesignBox {
        vec![0; self.level_pieces.len()]
    }

    /// The objectives of the single design in a box. Its mass and deflection are taken from `box_bound`, which is exact
    /// for a single design. The lowest mode is computed again, because a trial shape gives only an upper bound of its
    /// frequency.
    pub(super) fn objectives(&self, box_bound: &BoxBound, work: &BoxWork) -> Objectives {
        let quotient = (box_bound.hz * std::f64::consts::TAU).powi(2);
        let lowest =
            self.judged_cases().zip(self.inertias.iter()).fold(quotient, |lowest, (case, inertia)| {
                inertia.lowest(
                    &self.poses[case],
                    &Ideal { stiffness: &work.stiff_in[case], inertia: &work.light },
                    lowest,
                )
            });
        Objectives {
            tip_deflection_m: box_bound.tip_m,
            mass_kg: box_bound.mass_kg,
            lowest_mode_hz: lowest.sqrt() / std::f64::consts::TAU,
        }
    }

    /// The first trial shapes, made for the box of all designs: for each judged case (a case that counts for deflection
    /// and lowest mode), one for each acceleration in [`START_SHAPES`]. `None` if no design meets the constraints.
    pub(super) fn first_shapes(&self, work: &mut BoxWork) -> Option<Vec<Shape>> {
        self.fill(&mut self.root(), work)?;
        self.least_tip_m(work)?;
        let mut shapes = Vec::new();
        for case in self.judged_cases() {
            let first = shapes.len();
            for [x, y, z] in START_SHAPES {
                let direction = Vector3::new(x, y, z);
                let ideal = Ideal { stiffness: &work.stiff_in[case], inertia: &work.light };
                let shape = Shape::start(&self.poses[case], &ideal, direction, &shapes[first..], 6);
                shapes.push(shape);
            }
        }
        Some(shapes)
    }

    /// Bounds a box. `shapes` are the trial shapes (motions that give an upper bound of the lowest mode) of the parent
    /// box. A shape is replaced by one made for this box if that lowers the bound. `is_dominated` tells whether an
    /// incumbent dominates a given bound. `worth_refining` tells whether the bound is so close to being dominated that
    /// better shapes might prune the box.
    pub(super) fn bound(
        &self,
        design_box: &mut [u32],
        shapes: &mut Arc<Vec<Shape>>,
        work: &mut BoxWork,
        is_dominated: impl Fn(&BoxBound) -> bool,
        worth_refining: impl Fn(&BoxBound) -> bool,
    ) -> Verdict {
        let fails = |box_bound: &BoxBound| {
            box_bound.hz < self.space.constraints.required_mode_hz() || is_dominated(box_bound)
        };
        let Some(mut box_bound) = self.first_bound(design_box, shapes, work, &fails) else {
            return Verdict::Pruned;
        };
        // A step of inverse iteration costs about as much as the rest of the bound, so it is made only where it can
        // prune the box. A single design is refined in any case, because its mode is reported.
        if !work.is_point() && !worth_refining(&box_bound) {
            return Verdict::Open(box_bound);
        }
        self.refine(&mut box_bound, Arc::make_mut(shapes).as_mut_slice(), work, fails)
    }

    /// The bound of a box, computed with the trial shapes of its parent box. `fails` tells whether a given bound prunes
    /// the box. `None` if the box is pruned: no member meets the limits, or `fails` is true for the bound.
    fn first_bound(
        &self,
        design_box: &mut [u32],
        shapes: &[Shape],
        work: &mut BoxWork,
        fails: &impl Fn(&BoxBound) -> bool,
    ) -> Option<BoxBound> {
        self.fill(design_box, work)?;
        let mass_kg = work.masses.iter().map(|m| m[0]).sum::<f64>() * (1.0 - ROUNDING);
        let limits = &self.space.constraints;
        if limits.mass_max_kg.is_some_and(|max| mass_kg > max) {
            return None;
        }
        let tip_m = self.least_tip_m(work)? * (1.0 - ROUNDING);
        if limits.tip_deflection_max_m.is_some_and(|max| tip_m > max) {
            return None;
        }
        let mut box_bound = BoxBound { mass_kg, tip_m, hz: f64::INFINITY };
        if fails(&BoxBound { hz: f64::MAX, ..box_bound }) {
            return None;
        }
        for (judged, case) in self.judged_cases().enumerate() {
            let ideal = Ideal { stiffness: &work.stiff_in[case], inertia: &work.light };
            for start in 0..START_SHAPES.len() {
                let hz = hertz(shapes[judged * START_SHAPES.len() + start].quotient(&ideal));
                if hz < box_bound.hz {
                    box_bound.hz = hz;
                    work.worst = (judged, start);
                }
            }
            if fails(&box_bound) {
                return None;
            }
        }
        Some(box_bound)
    }

    /// Improves the trial shapes of a box by inverse iteration, until `fails` is true for the bound or the bound no
    /// longer falls. A box of several designs gets only one step.
    fn refine(
        &self,
        box_bound: &mut BoxBound,
        shapes: &mut [Shape],
        work: &mut BoxWork,
        fails: impl Fn(&BoxBound) -> bool,
    ) -> Verdict {
        let steps = if work.is_point() { MOST_STEPS } else { 1 };
        for _ in 0..steps {
            let before = box_bound.hz;
            for (judged, case) in self.judged_cases().enumerate() {
                for start in 0..START_SHAPES.len() {
                    // The second shape is kept orthogonal to the first. Otherwise both would converge to the same
                    // mode, and the bound would miss a lower mode of the arm in the other plane.
                    let (others, rest) = shapes[judged * START_SHAPES.len()..].split_at_mut(start);
                    let shape = &mut rest[0];
                    let ideal = Ideal { stiffness: &work.stiff_in[case], inertia: &work.light };
                    shape.improve(&self.poses[case], &ideal, others, &mut work.shape);
                    let hz = hertz(shape.quotient(&ideal));
                    if hz < box_bound.hz {
                        box_bound.hz = hz;
                        work.worst = (judged, start);
                    }
                }
            }
            if fails(box_bound) {
                return Verdict::Pruned;
            }
            if box_bound.hz >= before * (1.0 - SHAPE_CONVERGENCE) {
                break;
            }
        }
        Verdict::Open(*box_bound)
    }

    /// The least tip deflection over the members of the box \[m\], in the judged case in which it is greatest. The
    /// function also writes the forces, torques, slopes and tip directions of the box to `work`. `None` if no member
    /// keeps the forces within the intervals to which branching has restricted them (the force bounds of the problem).
    pub(super) fn least_tip_m(&self, work: &mut BoxWork) -> Option<f64> {
        let mut worst = 0.0f64;
        work.worst_tip = None;
        work.greatest_tip_m.clear();
        work.tip_directions.clear();
        for (case, pose) in self.poses.iter().enumerate().filter(|(_, p)| p.judged) {
            work.stiff_in[case].clone_from(&work.stiff);
            let mut tip_m = [[0.0f64; 2]; 3];
            let mut most_m = 0.0;
            let BoxWork { forces, weights, .. } = work;
            self.forces(case, weights, &mut forces[case])?;
            for (at, row) in pose.rows.iter().enumerate() {
                let force = work.forces[case][at];
                let moved = match &work.curves[row.piece] {
                    Some(curve) if row.coordinate == TORSION => {
                        let size = force[0].abs().max(force[1].abs());
                        let least = force[0].max(-force[1]).max(0.0);
                        let range = (least * (1.0 - ROUNDING), size * (1.0 + ROUNDING));
                        let play = self.joint_plays[row.piece].as_ref();
                        let stiffest = curve.stiffest(range.0, range.1);
                        work.stiff_in[case][row.piece][TORSION] =
                            play.map_or(stiffest, |play| play.in_series(stiffest, range.1));
                        work.torques[case][row.piece] = range.into();
                        curve.twist(play, force)
                    }
                    _ => linear_strain(pose, row, force, work),
                };
                most_m += moved[1].max(-moved[0]) * row.tip_m_per_unit;
                for (tip, d) in tip_m.iter_mut().zip(row.tip_m.iter()) {
                    let (a, b) = (d * moved[0], d * moved[1]);
                    tip[0] += a.min(b);
                    tip[1] += a.max(b);
                }
            }
            if !pose.contributions_align {
                work.greatest_tip_m.push(most_m);
            }
            // Each component of the tip's displacement has its own interval, so the shortest displacement is found
            // component by component.
            let nearest = Vector3::from(tip_m.map(|[low, high]| if low > 0.0 { low } else { high.min(0.0) }));
            work.tip_directions.push(nearest.try_normalize(0.0).unwrap_or_default());
            if nearest.norm() > worst {
                worst = nearest.norm();
                work.worst_tip = nearest.try_normalize(0.0).map(|d| (case, d));
            }
        }
        Some(worst)
    }

    /// Indices of the judged cases, over which deflection and lowest mode are taken.
    pub(super) fn judged_cases(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.poses.len()).filter(|&case| self.poses[case].judged)
    }

    /// The option of each level of a box of one design, tip first. `None` if the box has several designs.
    pub(super) fn options(&self, design_box: &[u32]) -> Option<Vec<u32>> {
        self.level_pieces
            .iter()
            .zip(design_box)
            .map(|(&piece, &node)| match &self.parts[piece] {
                Part::Drives { tree, .. } => tree.option(node),
                Part::Links { tree, .. } => tree.option(node),
                _ => None,
            })
            .collect()
    }
}

/// Frequency \[Hz\] of an eigenvalue \[1/s²\], raised by the rounding margin so that it remains an upper bound.
fn hertz(lambda: f64) -> f64 {
    lambda.sqrt() / std::f64::consts::TAU * (1.0 + ROUNDING)
}

/// The least and the greatest deflection in one strain coordinate (one way to deform) of a tube or a bearing, under a
/// generalized force between `low` and `high`. The deflection is force times compliance, and the compliance too is an
/// interval over the box.
pub(super) fn linear_strain(pose: &Pose, row: &Row, [low, high]: [f64; 2], work: &BoxWork) -> [f64; 2] {
    let (resisted, factor) = pose.pieces[row.piece].resisted(row.coordinate);
    let (stiff, soft) = (work.stiff[row.piece][resisted], work.soft[row.piece][resisted]);
    if stiff == 0.0 {
        return [0.0; 2];
    }
    let (least, most) = (factor / stiff, factor / soft);
    [low * if low >= 0.0 { least } else { most }, high * if high >= 0.0 { most } else { least }]
}
