//! The bound of a box: the best that any of its members could be.
//!
//! | objective | bound of the box |
//! |---|---|
//! | mass | every part at its least |
//! | tip deflection | torques, forces and compliances as intervals; the point of the tip's box nearest to rest |
//! | lowest mode | Rayleigh's quotient ([`shape`](super::shape)) of every stiffness at its greatest over every inertia at its least; a gear's slope at the largest torque it may carry |
//!
//! A joint or link that cannot hold even the least demand makes the whole box infeasible.

use super::check::Inertia;
use super::parts::{CurveBox, DriveBox, INERTIAS, LinkBox, STIFFNESSES, inertia};
use super::pose::{Pose, RESISTED, degree_factor};
use super::problem::{Part, Problem};
use super::shape::{Ideal, Shape, Work as ShapeWork};
use crate::arm::Windup;
use crate::search::Objectives;
use crate::search::figures::von_mises;
use crate::sizing::{JointDemand, JointMotion};
use nalgebra::Vector3;
use std::sync::Arc;

/// Rounding of a sum of a few dozen terms, with room.
const ROUNDING: f64 = 1e-12;
/// A shape that improves by less than this is as good as it gets.
const SETTLED: f64 = 1e-10;
/// Accelerations of the base that trial shapes start from: vertical, and sideways with a little forward.
const STARTS: [[f64; 3]; 2] = [[0.0, 0.0, 1.0], [0.3, 1.0, 0.0]];
/// Steps at the most on one box.
const MOST_STEPS: usize = 30;

/// A box of designs: a node of each level's tree.
pub(super) type Cell = Vec<u32>;

/// The best that a member of a box could be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ceiling {
    pub mass_kg: f64,
    pub tip_m: f64,
    pub hz: f64,
}

impl Ceiling {
    /// Of a box of which nothing is known.
    pub const OPEN: Self = Self { mass_kg: 0.0, tip_m: 0.0, hz: f64::INFINITY };
}

/// What is known of a box.
pub(super) enum Verdict {
    /// No member meets the constraints, or a design found is better than any.
    Cut,
    /// Some member may be on the front.
    Open(Ceiling),
}

/// Numbers of one box, kept by a worker.
#[derive(Default)]
pub(super) struct Work {
    /// Greatest and least stiffness and inertia of each piece.
    stiff: Vec<[f64; STIFFNESSES]>,
    soft: Vec<[f64; STIFFNESSES]>,
    light: Vec<[f64; INERTIAS]>,
    heavy: Vec<[f64; INERTIAS]>,
    /// Weight interval of each piece of the case at hand \[N\].
    weights: Vec<Vec<[f64; 2]>>,
    curves: Vec<Option<CurveBox>>,
    /// Greatest stiffness of each piece, and least of each joint, by case: a gear's slope depends on its
    /// torque.
    stiff_in: Vec<Vec<[f64; STIFFNESSES]>>,
    joint_soft: Vec<Vec<f64>>,
    masses: Vec<[f64; 2]>,
    shape: ShapeWork,
    /// Judged case and start whose quotient is least.
    worst: (usize, usize),
}

impl<'c> Problem<'c> {
    /// The box of everything.
    pub fn root(&self) -> Cell {
        vec![0; self.level_pieces.len()]
    }

    /// The inertia matrices of every judged case.
    pub fn with_inertias(mut self) -> Self {
        let mut work = Work::default();
        if self.fill(&self.root(), &mut work).is_some() {
            self.least_tip_m(&mut work);
            self.inertias = self
                .judged_cases()
                .map(|case| {
                    Inertia::new(
                        &self.poses[case],
                        &Ideal { stiffness: &work.stiff_in[case], inertia: &work.light },
                    )
                })
                .collect();
        }
        self
    }

    /// The objectives of a box of one whose ceiling is known: the ceiling, with its mode made sure of.
    pub fn objectives(&self, ceiling: &Ceiling, work: &Work) -> Objectives {
        let quotient = (ceiling.hz * std::f64::consts::TAU).powi(2);
        let lowest = self.judged_cases().zip(&self.inertias).fold(quotient, |lowest, (case, inertia)| {
            inertia.lowest(
                &self.poses[case],
                &Ideal { stiffness: &work.stiff_in[case], inertia: &work.light },
                lowest,
            )
        });
        Objectives {
            tip_deflection_m: ceiling.tip_m,
            mass_kg: ceiling.mass_kg,
            lowest_mode_hz: lowest.sqrt() / std::f64::consts::TAU,
        }
    }

    /// First shapes: the box of everything, started vertically and sideways in each judged case.
    pub fn first_shapes(&self, work: &mut Work) -> Option<Vec<Shape>> {
        self.fill(&self.root(), work)?;
        self.least_tip_m(work);
        let mut shapes = Vec::new();
        for case in self.judged_cases() {
            for [x, y, z] in STARTS {
                let direction = Vector3::new(x, y, z);
                let ideal = Ideal { stiffness: &work.stiff_in[case], inertia: &work.light };
                shapes.push(Shape::start(&self.poses[case], &ideal, direction, 6));
            }
        }
        Some(shapes)
    }

    /// Bounds a box. `shapes` come from the box above and are replaced by this box's own where that helps.
    /// `beaten` tells whether a design found is better than a ceiling.
    pub fn bound(
        &self,
        cell: &[u32],
        shapes: &mut Arc<Vec<Shape>>,
        work: &mut Work,
        beaten: impl Fn(&Ceiling) -> bool,
        near: impl Fn(&Ceiling) -> bool,
    ) -> Verdict {
        if self.fill(cell, work).is_none() {
            return Verdict::Cut;
        }
        let mass_kg = work.masses.iter().map(|m| m[0]).sum::<f64>() * (1.0 - ROUNDING);
        let limits = &self.space.constraints;
        if limits.mass_max_kg.is_some_and(|max| mass_kg > max) {
            return Verdict::Cut;
        }
        let tip_m = self.least_tip_m(work) * (1.0 - ROUNDING);
        if limits.tip_deflection_max_m.is_some_and(|max| tip_m > max) {
            return Verdict::Cut;
        }
        let required_hz = limits.required_mode_hz();
        let mut ceiling = Ceiling { mass_kg, tip_m, hz: f64::INFINITY };
        let fails = |ceiling: &Ceiling| ceiling.hz < required_hz || beaten(ceiling);
        if fails(&Ceiling { hz: f64::MAX, ..ceiling }) {
            return Verdict::Cut;
        }
        for (judged, case) in self.judged_cases().enumerate() {
            let ideal = Ideal { stiffness: &work.stiff_in[case], inertia: &work.light };
            for start in 0..STARTS.len() {
                let hz = hertz(shapes[judged * STARTS.len() + start].quotient(&ideal));
                if hz < ceiling.hz {
                    ceiling.hz = hz;
                    work.worst = (judged, start);
                }
            }
            if fails(&ceiling) {
                return Verdict::Cut;
            }
        }
        if !work.is_point() && !near(&ceiling) {
            return Verdict::Open(ceiling);
        }
        self.refine(&mut ceiling, Arc::make_mut(shapes).as_mut_slice(), work, fails)
    }

    /// Improves the shapes until the box is cut or none moves any more.
    fn refine(
        &self,
        ceiling: &mut Ceiling,
        shapes: &mut [Shape],
        work: &mut Work,
        fails: impl Fn(&Ceiling) -> bool,
    ) -> Verdict {
        let steps = if work.is_point() { MOST_STEPS } else { 1 };
        for _ in 0..steps {
            let before = ceiling.hz;
            for (judged, case) in self.judged_cases().enumerate() {
                for start in 0..STARTS.len() {
                    let shape = &mut shapes[judged * STARTS.len() + start];
                    let ideal = Ideal { stiffness: &work.stiff_in[case], inertia: &work.light };
                    shape.improve(&self.poses[case], &ideal, &mut work.shape);
                    let hz = hertz(shape.quotient(&ideal));
                    if hz < ceiling.hz {
                        ceiling.hz = hz;
                        work.worst = (judged, start);
                    }
                }
            }
            if fails(ceiling) {
                return Verdict::Cut;
            }
            if ceiling.hz >= before * (1.0 - SETTLED) {
                break;
            }
        }
        Verdict::Open(*ceiling)
    }

    /// Fills in every interval from the tip inward; `None` if a part cannot hold.
    fn fill(&self, cell: &[u32], work: &mut Work) -> Option<()> {
        work.clear(self.parts.len(), self.poses.len());
        let mut level = 0;
        let mut cost_eur = 0.0;
        for (piece, part) in self.parts.iter().enumerate() {
            match part {
                Part::Given { mass_kg, curve } => work.joint(self, piece, [*mass_kg; 2], *curve),
                Part::Drives { sized, tree } => {
                    let drives = &tree.node(cell[level]).bounds;
                    level += 1;
                    let [least, _] = self.demands(piece, work, sized.table.motion());
                    if !drives.limits.hold(&least) {
                        return None;
                    }
                    work.joint(self, piece, drives.mass_kg, drives.curve);
                }
                Part::FirstFit { sized, ladder } => {
                    let [least, most] = self.demands(piece, work, sized.table.motion());
                    let step = |demand: &JointDemand| {
                        let fit = sized.table.first_fit(demand)? as u32;
                        sized.table.first_fit_candidates().binary_search(&fit).ok()
                    };
                    let first = step(&least)?;
                    let last = step(&most).unwrap_or(ladder.len() - 1);
                    let DriveBox { mass_kg, curve, .. } = ladder.run(first, last);
                    work.joint(self, piece, mass_kg, curve);
                }
                Part::Links { length_m, tree } => {
                    let links = &tree.node(cell[level]).bounds;
                    level += 1;
                    cost_eur += links.cost_eur_per_m * length_m;
                    let max = self.space.constraints.material_cost_max_eur;
                    if max.is_some_and(|max| cost_eur * (1.0 - ROUNDING) > max) {
                        return None;
                    }
                    work.tube(self, piece, *length_m, links);
                    if !self.stress_holds(piece, links, work) {
                        return None;
                    }
                }
                Part::Tube { length_m, tube } => work.tube(self, piece, *length_m, tube),
                Part::Offset { mass_kg } => {
                    work.masses[piece] = [*mass_kg; 2];
                }
            }
        }
        Some(())
    }

    /// The least and the most that is asked of a joint.
    fn demands(&self, piece: usize, work: &Work, motion: &JointMotion) -> [JointDemand; 2] {
        let (mut static_nm, mut inertia_kgm2) = ([0.0f64; 2], [0.0f64; 2]);
        for (pose, weights) in self.poses.iter().zip(&work.weights).filter(|(p, _)| p.sizing) {
            let Some(row) = &pose.inertia_about[piece] else { continue };
            let [low, high] = pose.torque(piece, weights);
            static_nm[0] = static_nm[0].max(low.max(-high).max(0.0));
            static_nm[1] = static_nm[1].max(high.max(-low));
            for (bound, lines) in inertia_kgm2.iter_mut().zip([&work.light, &work.heavy]) {
                let of = row.per_line.iter().zip(lines);
                let chosen: f64 = of.map(|(c, l)| c.iter().zip(l).map(|(c, l)| c * l).sum::<f64>()).sum();
                *bound = bound.max(row.fixed + chosen);
            }
        }
        let demand = |i: usize, factor: f64| motion.demand(static_nm[i] * factor, inertia_kgm2[i] * factor);
        [demand(0, 1.0 - ROUNDING), demand(1, 1.0 + ROUNDING)]
    }

    /// Whether some option of a box may hold the least stress at its ends.
    fn stress_holds(&self, piece: usize, links: &LinkBox, work: &Work) -> bool {
        let Some(safety) = self.space.constraints.stress_safety_factor_min else { return true };
        if links.stress[0] == 0.0 {
            return true;
        }
        self.poses.iter().zip(&work.weights).all(|(pose, weights)| {
            let factor = if pose.sizing { self.peak_factor } else { 1.0 };
            pose.stress.iter().filter(|s| s.piece == piece).all(|row| {
                let [axial, y, z, torsion] = std::array::from_fn(|k| {
                    let (fixed, per_n) = &row.loads[k];
                    let [low, high] = interval(*fixed, per_n, weights);
                    low.max(-high).max(0.0) * links.stress[k]
                });
                let bending = if links.round { y.hypot(z) } else { y + z };
                let ratio = von_mises(axial + bending, torsion);
                ratio * factor * safety * (1.0 - ROUNDING) <= 1.0
            })
        })
    }

    /// Least deflection of the tip in the worst judged case \[m\].
    fn least_tip_m(&self, work: &mut Work) -> f64 {
        let mut worst = 0.0f64;
        for (case, pose) in self.poses.iter().enumerate().filter(|(_, p)| p.judged) {
            work.stiff_in[case].clone_from(&work.stiff);
            let mut tip_m = [[0.0f64; 2]; 3];
            for row in &pose.rows {
                let force = interval(row.fixed, &row.per_n, &work.weights[case]);
                let moved = match &work.curves[row.piece] {
                    Some(curve) => {
                        let size = force[0].abs().max(force[1].abs());
                        let least = force[0].max(-force[1]).max(0.0);
                        let range = (least * (1.0 - ROUNDING), size * (1.0 + ROUNDING));
                        work.stiff_in[case][row.piece][0] = curve.stiffest(range.0, range.1);
                        work.joint_soft[case][row.piece] = curve.softest(range.0, range.1);
                        twist(curve, force)
                    }
                    None => stretch(row.coordinate, pose, row.piece, force, work),
                };
                for (tip, d) in tip_m.iter_mut().zip(row.tip_m.iter()) {
                    let (a, b) = (d * moved[0], d * moved[1]);
                    tip[0] += a.min(b);
                    tip[1] += a.max(b);
                }
            }
            let nearest = tip_m.map(|[low, high]| low.max(-high).max(0.0));
            worst = worst.max(Vector3::from(nearest).norm());
        }
        worst
    }

    /// The level whose halving should sharpen the bound most; `None` if every level is down to one option.
    pub fn widest_level(&self, cell: &[u32], shapes: &[Shape], work: &Work) -> Option<usize> {
        let (judged, start) = work.worst;
        let shape = &shapes[judged * STARTS.len() + start];
        let case = self.judged_cases().nth(judged)?;
        let stiffness = &work.stiff_in[case];
        let ideal = Ideal { stiffness: &work.stiff_in[case], inertia: &work.light };
        let strain: f64 = products(&shape.strain, ideal.stiffness);
        let kinetic: f64 = shape.kinetic_fixed + products(&shape.kinetic, ideal.inertia);
        let mass_kg: f64 = work.masses.iter().map(|m| m[0]).sum();
        let mut best: Option<(f64, usize)> = None;
        for (level, &piece) in self.level_pieces.iter().enumerate() {
            let leaf = match &self.parts[piece] {
                Part::Drives { tree, .. } => tree.option(cell[level]).is_some(),
                Part::Links { tree, .. } => tree.option(cell[level]).is_some(),
                _ => true,
            };
            if leaf {
                continue;
            }
            let mut score = (work.masses[piece][1] - work.masses[piece][0]) / mass_kg.max(1e-9);
            let joint = work.curves[piece].is_some();
            for i in 0..STIFFNESSES {
                let (high, low) = match joint && i == 0 {
                    true => (stiffness[piece][0], work.joint_soft[case][piece]),
                    false => (work.stiff[piece][i], work.soft[piece][i]),
                };
                if low > 0.0 && high > low {
                    score += 2.0 * shape.strain[piece][i] * high / strain * (high / low).ln();
                }
            }
            for i in 0..INERTIAS {
                let (low, high) = (work.light[piece][i], work.heavy[piece][i]);
                if low > 0.0 && high > low {
                    score += shape.kinetic[piece][i] * low / kinetic * (high / low).ln();
                }
            }
            if best.is_none_or(|(most, _)| score > most) {
                best = Some((score, level));
            }
        }
        best.map(|(_, level)| level)
    }

    fn judged_cases(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.poses.len()).filter(|&case| self.poses[case].judged)
    }

    /// The two halves of a box along a level.
    pub fn halves(&self, cell: &[u32], level: usize) -> Option<[u32; 2]> {
        match &self.parts[self.level_pieces[level]] {
            Part::Drives { tree, .. } => tree.children(cell[level]),
            Part::Links { tree, .. } => tree.children(cell[level]),
            _ => None,
        }
    }

    /// The options of a box of one, tip first.
    pub fn options(&self, cell: &[u32]) -> Option<Vec<u32>> {
        self.level_pieces
            .iter()
            .zip(cell)
            .map(|(&piece, &node)| match &self.parts[piece] {
                Part::Drives { tree, .. } => tree.option(node),
                Part::Links { tree, .. } => tree.option(node),
                _ => None,
            })
            .collect()
    }
}

fn products<const N: usize>(a: &[[f64; N]], b: &[[f64; N]]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>()).sum()
}

fn hertz(lambda: f64) -> f64 {
    lambda.sqrt() / std::f64::consts::TAU * (1.0 + ROUNDING)
}

/// Twist of a joint between two torques \[rad\].
fn twist(curve: &CurveBox, [low, high]: [f64; 2]) -> [f64; 2] {
    let outer = |windup: &Windup, t: f64| windup.angle_rad(t);
    [
        outer(if low >= 0.0 { &curve.stiff } else { &curve.soft }, low),
        outer(if high >= 0.0 { &curve.soft } else { &curve.stiff }, high),
    ]
}

/// A tube's coordinate between two forces.
fn stretch(coordinate: usize, pose: &Pose, piece: usize, [low, high]: [f64; 2], work: &Work) -> [f64; 2] {
    let super::pose::PosedPiece::Tube(tube) = &pose.pieces[piece] else { return [0.0; 2] };
    let (resisted, _) = RESISTED[coordinate];
    let (stiff, soft) = (work.stiff[piece][resisted], work.soft[piece][resisted]);
    if stiff == 0.0 {
        return [0.0; 2];
    }
    let factor = degree_factor(coordinate) / tube.length_m;
    let (least, most) = (factor / stiff, factor / soft);
    [low * if low >= 0.0 { least } else { most }, high * if high >= 0.0 { most } else { least }]
}

/// `fixed + Σ per_n · weight` as an interval.
#[inline]
fn interval(fixed: f64, per_n: &[f64], weights: &[[f64; 2]]) -> [f64; 2] {
    let (mut low, mut high) = (fixed, fixed);
    for (c, w) in per_n.iter().zip(weights) {
        let (a, b) = (c * w[0], c * w[1]);
        low += a.min(b);
        high += a.max(b);
    }
    [low, high]
}

impl Pose {
    /// Torque on a joint as an interval \[N m\].
    fn torque(&self, piece: usize, weights: &[[f64; 2]]) -> [f64; 2] {
        let row = self.rows.iter().find(|row| row.piece == piece);
        row.map_or([0.0; 2], |row| interval(row.fixed, &row.per_n, weights))
    }
}

impl Work {
    fn clear(&mut self, pieces: usize, cases: usize) {
        fn zero<T: Clone>(items: &mut Vec<T>, n: usize, value: T) {
            items.clear();
            items.resize(n, value);
        }
        zero(&mut self.stiff, pieces, [0.0; STIFFNESSES]);
        zero(&mut self.soft, pieces, [0.0; STIFFNESSES]);
        zero(&mut self.light, pieces, [0.0; INERTIAS]);
        zero(&mut self.heavy, pieces, [0.0; INERTIAS]);
        zero(&mut self.curves, pieces, None);
        zero(&mut self.masses, pieces, [0.0; 2]);
        self.weights.resize_with(cases, Vec::new);
        self.stiff_in.resize_with(cases, Vec::new);
        self.joint_soft.resize_with(cases, Vec::new);
        for case in 0..cases {
            zero(&mut self.weights[case], pieces, [0.0; 2]);
            zero(&mut self.joint_soft[case], pieces, 0.0);
        }
    }

    fn joint(&mut self, problem: &Problem, piece: usize, mass_kg: [f64; 2], curve: Option<CurveBox>) {
        self.masses[piece] = mass_kg;
        self.curves[piece] = curve;
        self.light[piece][inertia::MASS] = mass_kg[0];
        self.heavy[piece][inertia::MASS] = mass_kg[1];
        let g = problem.space.gravity_m_s2;
        for weights in &mut self.weights {
            weights[piece] = mass_kg.map(|m| m * g);
        }
    }

    fn tube(&mut self, problem: &Problem, piece: usize, length_m: f64, links: &LinkBox) {
        let finite = |s: f64| if s.is_finite() { s } else { 0.0 };
        self.stiff[piece] = links.high.stiffnesses.map(finite);
        self.soft[piece] = links.low.stiffnesses.map(finite);
        self.light[piece] = links.low.inertias;
        self.heavy[piece] = links.high.inertias;
        let (light, heavy) = (&links.low.inertias, &links.high.inertias);
        self.masses[piece] = [light[inertia::MASS] * length_m, heavy[inertia::MASS] * length_m];
        let g = problem.space.gravity_m_s2 * length_m;
        for (weights, pose) in self.weights.iter_mut().zip(&problem.poses) {
            weights[piece] = [
                g * (light[inertia::MASS] - pose.water_kg_m3 * heavy[inertia::OUTER_AREA]),
                g * (heavy[inertia::MASS] - pose.water_kg_m3 * light[inertia::OUTER_AREA]),
            ];
        }
    }

    /// Whether the box has no width in anything a mode sees.
    pub fn is_point(&self) -> bool {
        self.light == self.heavy
            && self.stiff == self.soft
            && self.curves.iter().flatten().all(|c| c.stiff == c.soft)
    }
}
