//! The bound of a box: the best that any of its members could be.
//!
//! | objective | bound of the box |
//! |---|---|
//! | mass | every part at its least |
//! | tip deflection | torques, forces and compliances as intervals; the point of the tip's box nearest to rest |
//! | lowest mode | Rayleigh's quotient ([`shape`](super::shape)) of every stiffness at its greatest over every inertia at its least; a gear's slope, and its play's, at the largest torque it may carry |
//!
//! A joint or link that cannot hold even the least demand makes the whole box infeasible.

use super::check::Inertia;
use super::parts::{Asked, DriveBox, INERTIAS, LinkBox, STIFFNESSES, inertia};
use super::pose::{Pose, RESISTED, degree_factor};
use super::problem::{Part, Problem};
use super::shape::{Ideal, Shape, Work as ShapeWork};
use super::torsion::{Breaks, CurveBox};
use super::tree::{Bounds, Tree};
use crate::pareto::objectives::Objectives;
use crate::sizing::demand::JointDemand;
use crate::space::attributes::von_mises;
use nalgebra::Vector3;
use std::sync::Arc;

/// Rounding of a sum of a few dozen terms, with room.
const ROUNDING: f64 = 1e-12;
/// A shape that improves by less than this is as good as it gets.
const SETTLED: f64 = 1e-10;
/// Accelerations of the base that trial shapes start from: vertical, and sideways with a little forward.
pub(super) const STARTS: [[f64; 3]; 2] = [[0.0, 0.0, 1.0], [0.3, 1.0, 0.0]];
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

    /// The ceiling worsened by a part in all three.
    pub fn slackened(&self, slack: f64) -> Self {
        let factor = 1.0 + slack;
        Self { mass_kg: self.mass_kg * factor, tip_m: self.tip_m * factor, hz: self.hz / factor }
    }
}

impl From<Ceiling> for Objectives {
    fn from(ceiling: Ceiling) -> Self {
        Self { tip_deflection_m: ceiling.tip_m, mass_kg: ceiling.mass_kg, lowest_mode_hz: ceiling.hz }
    }
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
    pub(super) stiff: Vec<[f64; STIFFNESSES]>,
    pub(super) soft: Vec<[f64; STIFFNESSES]>,
    pub(super) light: Vec<[f64; INERTIAS]>,
    pub(super) heavy: Vec<[f64; INERTIAS]>,
    /// Weight interval of each piece of the case at hand \[N\].
    pub(super) weights: Vec<Vec<[f64; 2]>>,
    /// The force of each row of a judged case.
    pub(super) forces: Vec<Vec<[f64; 2]>>,
    pub(super) curves: Vec<Option<CurveBox>>,
    /// Greatest stiffness of each piece by case: a gear's slope depends on its torque.
    pub(super) stiff_in: Vec<Vec<[f64; STIFFNESSES]>>,
    pub(super) masses: Vec<[f64; 2]>,
    /// The least that is asked of each drive that is a choice.
    pub(super) least: Vec<Option<Asked>>,
    /// The most that is asked of each drive that is a choice.
    pub(super) demands: Vec<Option<JointDemand>>,
    /// Break points of the curves of each joint.
    pub(super) breaks: Vec<Breaks>,
    /// Least and greatest size of the torque on each joint, by judged case \[N m\].
    pub(super) torques: Vec<Vec<[f64; 2]>>,
    /// The case whose tip moves most at least, and in which direction.
    pub(super) sagging: Option<(usize, Vector3<f64>)>,
    /// Direction of the tip's least deflection in each judged case.
    pub(super) tip_ways: Vec<Vector3<f64>>,
    /// No less than the tip moves in each judged case in which parts may move it against each other \[m\].
    pub(super) most_tip_m: Vec<f64>,
    /// By what part the deflection would grow if a piece were middling.
    pub(super) tip_yields: Vec<f64>,
    shape: ShapeWork,
    /// Judged case and start whose quotient is least.
    pub(super) worst: (usize, usize),
}

impl<'c> Problem<'c> {
    /// The box of everything.
    pub fn root(&self) -> Cell {
        vec![0; self.level_pieces.len()]
    }

    /// The inertia matrices of every judged case.
    pub(super) fn with_inertias(mut self) -> Self {
        let mut work = Work::default();
        let filled = self.fill(&mut self.root(), &mut work);
        if filled.and_then(|()| self.least_tip_m(&mut work)).is_some() {
            let of = |case: usize| {
                let ideal = Ideal { stiffness: &work.stiff_in[case], inertia: &work.light };
                Inertia::new(&self.poses[case], &ideal)
            };
            self.inertias = Arc::new(self.judged_cases().map(of).collect());
        }
        self
    }

    /// The objectives of a box of one whose ceiling is known: the ceiling, with its mode made sure of.
    pub fn objectives(&self, ceiling: &Ceiling, work: &Work) -> Objectives {
        let quotient = (ceiling.hz * std::f64::consts::TAU).powi(2);
        let lowest =
            self.judged_cases().zip(self.inertias.iter()).fold(quotient, |lowest, (case, inertia)| {
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
        self.fill(&mut self.root(), work)?;
        self.least_tip_m(work)?;
        let mut shapes = Vec::new();
        for case in self.judged_cases() {
            let first = shapes.len();
            for [x, y, z] in STARTS {
                let direction = Vector3::new(x, y, z);
                let ideal = Ideal { stiffness: &work.stiff_in[case], inertia: &work.light };
                let shape = Shape::start(&self.poses[case], &ideal, direction, &shapes[first..], 6);
                shapes.push(shape);
            }
        }
        Some(shapes)
    }

    /// Bounds a box. `shapes` come from the box above and are replaced by this box's own where that helps.
    /// `beaten` tells whether a design found is better than a ceiling.
    pub fn bound(
        &self,
        cell: &mut [u32],
        shapes: &mut Arc<Vec<Shape>>,
        work: &mut Work,
        beaten: impl Fn(&Ceiling) -> bool,
        near: impl Fn(&Ceiling) -> bool,
    ) -> Verdict {
        let fails =
            |ceiling: &Ceiling| ceiling.hz < self.space.constraints.required_mode_hz() || beaten(ceiling);
        let Some(mut ceiling) = self.look(cell, shapes, work, &fails) else { return Verdict::Cut };
        if !work.is_point() && !near(&ceiling) {
            return Verdict::Open(ceiling);
        }
        self.refine(&mut ceiling, Arc::make_mut(shapes).as_mut_slice(), work, fails)
    }

    /// The ceiling of a box with the shapes of the box above; `None` if no member can be on the front.
    fn look(
        &self,
        cell: &mut [u32],
        shapes: &[Shape],
        work: &mut Work,
        fails: &impl Fn(&Ceiling) -> bool,
    ) -> Option<Ceiling> {
        self.fill(cell, work)?;
        let mass_kg = work.masses.iter().map(|m| m[0]).sum::<f64>() * (1.0 - ROUNDING);
        let limits = &self.space.constraints;
        if limits.mass_max_kg.is_some_and(|max| mass_kg > max) {
            return None;
        }
        let tip_m = self.least_tip_m(work)? * (1.0 - ROUNDING);
        if limits.tip_deflection_max_m.is_some_and(|max| tip_m > max) {
            return None;
        }
        let mut ceiling = Ceiling { mass_kg, tip_m, hz: f64::INFINITY };
        if fails(&Ceiling { hz: f64::MAX, ..ceiling }) {
            return None;
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
                return None;
            }
        }
        Some(ceiling)
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
                    let (others, rest) = shapes[judged * STARTS.len()..].split_at_mut(start);
                    let shape = &mut rest[0];
                    let ideal = Ideal { stiffness: &work.stiff_in[case], inertia: &work.light };
                    shape.improve(&self.poses[case], &ideal, others, &mut work.shape);
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
    pub(super) fn fill(&self, cell: &mut [u32], work: &mut Work) -> Option<()> {
        work.clear(self.parts.len(), self.poses.len());
        let mut level = 0;
        let mut cost_eur = 0.0;
        for (piece, part) in self.parts.iter().enumerate() {
            match part {
                Part::Given { mass_kg, curve } => work.joint(self, piece, [*mass_kg; 2], *curve),
                Part::Drives { sized, tree, rays, .. } => {
                    let (static_nm, inertia_kgm2) = self.loads(piece, work);
                    let least = Asked::new(sized.table.motion(), rays, static_nm[0], inertia_kgm2[0]);
                    let node = &mut cell[level];
                    level += 1;
                    *node = tree.narrowed(*node, |drives| drives.may_hold(&least))?;
                    let drives = holding(tree, *node, &least, DEPTH)?;
                    work.joint(self, piece, drives.mass_kg, drives.curve);
                    work.breaks[piece] = drives.breaks;
                    work.least[piece] = Some(least);
                    work.demands[piece] = Some(sized.table.motion().demand(static_nm[1], inertia_kgm2[1]));
                }
                Part::FirstFit { sized, ladder } => {
                    let (static_nm, inertia_kgm2) = self.loads(piece, work);
                    let demand = |i: usize| sized.table.motion().demand(static_nm[i], inertia_kgm2[i]);
                    let (least, most) = (demand(0), demand(1));
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
                    let node = &mut cell[level];
                    level += 1;
                    work.tube(self, piece, *length_m, &tree.node(*node).bounds);
                    while let Some(safety) = self.space.constraints.stress_safety_factor_min {
                        let loads = self.least_loads(piece, safety, work);
                        let narrowed =
                            tree.narrowed(*node, |links| loads.iter().all(|l| stress_holds(links, l)))?;
                        if narrowed == *node {
                            break;
                        }
                        // what is left weighs more, and has to carry itself
                        *node = narrowed;
                        work.tube(self, piece, *length_m, &tree.node(narrowed).bounds);
                    }
                    let links = &tree.node(*node).bounds;
                    cost_eur += links.cost_eur_per_m * length_m;
                    let max = self.space.constraints.material_cost_max_eur;
                    if max.is_some_and(|max| cost_eur * (1.0 - ROUNDING) > max) {
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

    /// The least and the largest static torque on a joint and inertia about it.
    fn loads(&self, piece: usize, work: &Work) -> ([f64; 2], [f64; 2]) {
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
        let rounded = |[least, most]: [f64; 2]| [least * (1.0 - ROUNDING), most * (1.0 + ROUNDING)];
        (rounded(static_nm), rounded(inertia_kgm2))
    }

    /// The least axial force, moments and torsion at the ends of a tube in every case, times what they are
    /// to be multiplied with before they are compared with the strength.
    fn least_loads(&self, piece: usize, safety: f64, work: &Work) -> Vec<[f64; 4]> {
        let cases = self.poses.iter().zip(&work.weights);
        cases
            .flat_map(|(pose, weights)| {
                let peak = if pose.sizing { self.peak_factor } else { 1.0 };
                let factor = peak * safety * (1.0 - ROUNDING);
                pose.stress.iter().filter(|s| s.piece == piece).map(move |row| {
                    row.loads.each_ref().map(|(fixed, per_n)| {
                        let [low, high] = interval(*fixed, per_n, weights);
                        low.max(-high).max(0.0) * factor
                    })
                })
            })
            .collect()
    }

    /// Least deflection of the tip in the worst judged case \[m\]; `None` if no member has the forces that are held.
    fn least_tip_m(&self, work: &mut Work) -> Option<f64> {
        let mut worst = 0.0f64;
        work.sagging = None;
        work.most_tip_m.clear();
        work.tip_ways.clear();
        for (case, pose) in self.poses.iter().enumerate().filter(|(_, p)| p.judged) {
            work.stiff_in[case].clone_from(&work.stiff);
            let mut tip_m = [[0.0f64; 2]; 3];
            let mut most_m = 0.0;
            let Work { forces, weights, .. } = work;
            self.forces(case, weights, &mut forces[case])?;
            for (at, row) in pose.rows.iter().enumerate() {
                let force = work.forces[case][at];
                let moved = match &work.curves[row.piece] {
                    Some(curve) => {
                        let size = force[0].abs().max(force[1].abs());
                        let least = force[0].max(-force[1]).max(0.0);
                        let range = (least * (1.0 - ROUNDING), size * (1.0 + ROUNDING));
                        let play = self.plays[row.piece].as_ref();
                        let stiffest = curve.stiffest(range.0, range.1);
                        work.stiff_in[case][row.piece][0] =
                            play.map_or(stiffest, |play| play.in_series(stiffest, range.1));
                        work.torques[case][row.piece] = range.into();
                        curve.twist(play, force)
                    }
                    None => stretch(row.coordinate, pose, row.piece, force, work),
                };
                most_m += moved[1].max(-moved[0]) * row.way_m;
                for (tip, d) in tip_m.iter_mut().zip(row.tip_m.iter()) {
                    let (a, b) = (d * moved[0], d * moved[1]);
                    tip[0] += a.min(b);
                    tip[1] += a.max(b);
                }
            }
            if !pose.parts_sag_together {
                work.most_tip_m.push(most_m);
            }
            let nearest = Vector3::from(tip_m.map(|[low, high]| if low > 0.0 { low } else { high.min(0.0) }));
            work.tip_ways.push(nearest.try_normalize(0.0).unwrap_or_default());
            if nearest.norm() > worst {
                worst = nearest.norm();
                work.sagging = nearest.try_normalize(0.0).map(|d| (case, d));
            }
        }
        Some(worst)
    }

    pub(super) fn judged_cases(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.poses.len()).filter(|&case| self.poses[case].judged)
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

fn hertz(lambda: f64) -> f64 {
    lambda.sqrt() / std::f64::consts::TAU * (1.0 + ROUNDING)
}

/// Levels of a tree to look down for drives that cannot hold.
const DEPTH: usize = 6;

/// The box around the drives below a node that may hold a demand; looks a few levels down.
fn holding(tree: &Tree<DriveBox>, node: u32, asked: &Asked, depth: usize) -> Option<DriveBox> {
    let drives = &tree.node(node).bounds;
    if !drives.may_hold(asked) {
        return None;
    }
    let (Some([a, b]), false) = (tree.children(node), depth == 0 || drives.least_limits.hold(&asked.demand))
    else {
        return Some(drives.clone());
    };
    match (holding(tree, a, asked, depth - 1), holding(tree, b, asked, depth - 1)) {
        (Some(a), Some(b)) => Some(a.join(&b)),
        (one, other) => one.or(other),
    }
}

/// Whether some option of a box may hold a load.
fn stress_holds(links: &LinkBox, load: &[f64; 4]) -> bool {
    let [axial, y, z, torsion]: [f64; 4] = std::array::from_fn(|k| load[k] * links.stress[k]);
    let bending = if links.round { y.hypot(z) } else { y + z };
    von_mises(axial + bending, torsion) <= 1.0
}

/// A tube's coordinate between two forces.
pub(super) fn stretch(
    coordinate: usize,
    pose: &Pose,
    piece: usize,
    [low, high]: [f64; 2],
    work: &Work,
) -> [f64; 2] {
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
pub(super) fn interval(fixed: f64, per_n: &[f64], weights: &[[f64; 2]]) -> [f64; 2] {
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

    /// Torque on a joint without the weight of any part \[N m\].
    pub fn payload_torque_nm(&self, piece: usize) -> f64 {
        self.rows.iter().find(|row| row.piece == piece).map_or(0.0, |row| row.fixed)
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
        zero(&mut self.demands, pieces, None);
        self.least.clear();
        self.least.resize_with(pieces, || None);
        zero(&mut self.breaks, pieces, Breaks::default());
        self.weights.resize_with(cases, Vec::new);
        self.stiff_in.resize_with(cases, Vec::new);
        self.torques.resize_with(cases, Vec::new);
        self.forces.resize_with(cases, Vec::new);
        for case in 0..cases {
            zero(&mut self.weights[case], pieces, [0.0; 2]);
            zero(&mut self.torques[case], pieces, [0.0; 2]);
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
        for (weights, pose) in self.weights.iter_mut().zip(problem.poses.iter()) {
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
