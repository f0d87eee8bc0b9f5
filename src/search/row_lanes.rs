//! Eight designs finished at once: the pieces from the innermost level to the base added in lanes, then
//! the lowest mode over all cases.
//!
//! Few eigenproblems are solved to the end. The block whose Dunkerley sum is largest is solved first,
//! from a guess that the neighbouring row gives; any other block whose lower bound lies below that root
//! gets one pass at it, and only if a pivot is negative there, a root of its own.

// matrices by row and column read better than iterators over them
#![allow(clippy::needless_range_loop)]

use super::Objectives;
use super::outward::{ArmProblem, Partial, SizedJoint, Slot};
use super::row::{
    CaseOutboard, CaseScratch, Chunk, ChunkModal, DriveFigures, MOST_SLOTS, Row, RowCase, RowScratch,
    StressEight,
};
use super::station::{Block, BlockSlot, Modal, Place, Station, StationJoint, StationSlot};
use crate::mechanics::lanes::{Eight, LANES, LaneWork, Lanes, splat_all};
use crate::mechanics::lowest_lanes::{LaneLink, LaneStep, Outboard, pass, roots};
use crate::mechanics::{angular, linear};
use nalgebra::{SMatrix, Vector3, Vector6};
use std::f64::consts::TAU;

/// Eight options of a row to be finished.
pub(super) struct RowWork<'a, 'c, const CASES: usize> {
    pub problem: &'a ArmProblem<'c>,
    pub row: &'a Row,
    pub from: &'a Partial,
    pub scratch: &'a mut RowScratch,
    pub chunk: usize,
    /// Bits of the options that exist.
    pub valid: u8,
}

/// Eight designs finished.
pub(super) struct FinishedEight {
    /// Bits of the designs that hold.
    pub held: u8,
    /// Bits of those whose lowest mode was not found.
    pub unsure: u8,
    pub tip_deflection_m: Eight,
    pub mass_kg: Eight,
    pub lowest_mode_hz: Eight,
}

/// Eight arms in one case as they grow inward.
#[derive(Clone, Copy)]
struct CaseLanes<V> {
    wrench: [V; 6],
    tip_m: [V; 3],
    inertia_at: [V; MOST_SLOTS],
    compliance: [V; MOST_SLOTS],
    trace_s2: [V; 2],
}

/// Most cases that a row handles.
pub(super) const MOST_CASES: usize = 8;

/// Eight arms as they grow inward, in at most so many cases.
struct Growing<V, const CASES: usize> {
    held: u8,
    mass_kg: V,
    masses_kg: [V; MOST_SLOTS],
    cases: [CaseLanes<V>; CASES],
}

impl<const CASES: usize> LaneWork for RowWork<'_, '_, CASES> {
    type Output = FinishedEight;

    #[inline(always)]
    fn run<V: Lanes>(mut self) -> FinishedEight {
        let mut arms = self.start::<V>();
        self.grow(&mut arms);
        let max_kg = self.problem.space().constraints.mass_max_kg.unwrap_or(f64::INFINITY);
        arms.held &= !V::splat(max_kg).less(arms.mass_kg);
        if arms.held == 0 {
            return FinishedEight::none();
        }
        let mut tip_m = V::zero();
        for (_, lanes) in self.row.cases.iter().zip(&arms.cases).filter(|(case, _)| case.judged) {
            let [x, y, z] = lanes.tip_m;
            tip_m = tip_m.max((x * x + y * y + z * z).sqrt());
        }
        let (eigenvalue, unsure) = self.lowest(&arms);
        FinishedEight {
            held: arms.held,
            unsure,
            tip_deflection_m: tip_m.store(),
            mass_kg: arms.mass_kg.store(),
            lowest_mode_hz: (eigenvalue.sqrt() / V::splat(TAU)).store(),
        }
    }
}

impl FinishedEight {
    /// Objectives of one of the eight.
    pub fn objectives(&self, lane: usize) -> Objectives {
        Objectives {
            tip_deflection_m: self.tip_deflection_m[lane],
            mass_kg: self.mass_kg[lane],
            lowest_mode_hz: self.lowest_mode_hz[lane],
        }
    }

    fn none() -> Self {
        let zeros = [0.0; LANES];
        Self { held: 0, unsure: 0, tip_deflection_m: zeros, mass_kg: zeros, lowest_mode_hz: zeros }
    }
}

impl<const CASES: usize> RowWork<'_, '_, CASES> {
    /// Adds piece after piece.
    #[inline(always)]
    fn grow<V: Lanes>(&self, arms: &mut Growing<V, CASES>) {
        let first = self.row.first;
        for (k, slot) in self.problem.slots()[first..].iter().enumerate() {
            match slot {
                Slot::Link { .. } => self.add_link(&self.row.chunks[self.chunk], arms),
                Slot::Offset { mass_kg } => self.add_offset(k, *mass_kg, arms),
                Slot::Given { .. } => self.add_joint(k, [0; LANES], arms),
                Slot::Sized(sized) => {
                    let indices = self.pick(k, sized, arms);
                    if arms.held == 0 {
                        return;
                    }
                    self.add_joint(k, indices, arms);
                }
            }
        }
    }

    #[inline(always)]
    fn start<V: Lanes>(&self) -> Growing<V, CASES> {
        let nothing = CaseLanes {
            wrench: [V::zero(); 6],
            tip_m: [V::zero(); 3],
            inertia_at: [V::zero(); MOST_SLOTS],
            compliance: [V::zero(); MOST_SLOTS],
            trace_s2: [V::zero(); 2],
        };
        let mut cases = [nothing; CASES];
        for ((lanes, state), scratch) in cases.iter_mut().zip(&self.from.stations).zip(&self.scratch.cases) {
            lanes.wrench = splat_all(state.wrench.into());
            lanes.tip_m = splat_all(state.tip_m.into());
            lanes.inertia_at = splat_all(scratch.inertia_at);
            lanes.trace_s2 = splat_all(state.trace_s2);
        }
        let mass_kg = V::splat(self.from.mass_kg);
        Growing { held: self.valid, mass_kg, masses_kg: [V::zero(); MOST_SLOTS], cases }
    }

    #[inline(always)]
    fn add_link<V: Lanes>(&self, chunk: &Chunk, arms: &mut Growing<V, CASES>) {
        let constraints = &self.problem.space().constraints;
        arms.held &= !chunk.slender;
        arms.mass_kg = arms.mass_kg + V::load(&chunk.mass_kg);
        if let Some(max) = constraints.material_cost_max_eur {
            let cost = V::splat(self.from.cost_eur) + V::load(&chunk.cost_eur);
            arms.held &= !V::splat(max).less(cost);
        }
        let mut stress = V::splat(self.from.stress_ratio);
        for (k, case) in self.row.cases.iter().enumerate() {
            let own = &chunk.cases[k];
            let (lanes, wrench) = (&mut arms.cases[k], &self.from.stations[k].wrench);
            let weight = V::load(&own.weight_n);
            if constraints.stress_safety_factor_min.is_some() {
                let StationSlot::Link { place, .. } = &self.station(k).slots[self.row.first] else {
                    continue;
                };
                stress = stress.max(self.stress(chunk, place, wrench, case, weight));
            }
            for i in 0..3 {
                let mut tip = lanes.tip_m[i] + V::load(&own.sag_m[i]);
                for j in (0..6).filter(|&j| wrench[j] != 0.0) {
                    tip = tip + V::load(&own.flexibility[i][j]) * V::splat(wrench[j]);
                }
                lanes.tip_m[i] = tip;
            }
            for i in 0..6 {
                lanes.wrench[i] = lanes.wrench[i] + weight * V::splat(case.link_weight[i]);
            }
            for j in 0..self.inner_slots() {
                lanes.inertia_at[j] = lanes.inertia_at[j] + V::load(&own.inertia_at[j]);
            }
            for b in 0..2 {
                lanes.trace_s2[b] = lanes.trace_s2[b] + V::load(&own.trace_s2[b]);
            }
            let factors = &self.scratch.cases[k].spread;
            for ((&(block, ..), factor), spread) in case.spread_entries.iter().zip(factors).zip(&own.spread) {
                lanes.trace_s2[block] = lanes.trace_s2[block] + V::splat(*factor) * V::load(spread);
            }
        }
        if let Some(least) = constraints.stress_safety_factor_min {
            arms.held &= !V::splat(1.0).less(stress * V::splat(least));
        }
    }

    /// The larger of the stresses at a link's two ends at peak load, over the strength.
    #[inline(always)]
    fn stress<V: Lanes>(
        &self,
        chunk: &Chunk,
        place: &Place,
        wrench: &Vector6<f64>,
        case: &RowCase,
        weight: V,
    ) -> V {
        let at_end: [V; 4] = splat_all(local(place, wrench, &place.end_m));
        let carried: [V; 4] = splat_all(local(place, wrench, &place.root_m));
        let own: [V; 4] = splat_all(local(place, &case.link_weight, &place.root_m));
        let mut at_root = carried;
        for i in 0..4 {
            at_root[i] = carried[i] + weight * own[i];
        }
        let larger = stress_at(&chunk.stress, at_end).max(stress_at(&chunk.stress, at_root));
        // where joints are sized the arm also accelerates; elsewhere it only stands
        larger * V::splat(if case.sizing { self.problem.peak_factor() } else { 1.0 })
    }

    #[inline(always)]
    fn add_offset<V: Lanes>(&self, k: usize, mass_kg: f64, arms: &mut Growing<V, CASES>) {
        arms.mass_kg = arms.mass_kg + V::splat(mass_kg);
        for (c, case) in self.row.cases.iter().enumerate() {
            let StationSlot::Body { weight, .. } = &self.station(c).slots[self.row.first + k] else {
                continue;
            };
            let lanes = &mut arms.cases[c];
            for i in 0..6 {
                lanes.wrench[i] = lanes.wrench[i] + V::splat(weight[i]);
            }
            for j in k + 1..self.inner_slots() {
                lanes.inertia_at[j] = lanes.inertia_at[j] + V::splat(case.carried[k][j]);
            }
        }
    }

    /// The drive of each arm; an arm without one is no longer held.
    #[inline(always)]
    fn pick<V: Lanes>(&self, k: usize, sized: &SizedJoint, arms: &mut Growing<V, CASES>) -> [usize; LANES] {
        let (mut static_nm, mut inertia_kgm2) = (V::zero(), V::zero());
        for (c, _) in self.row.cases.iter().enumerate().filter(|(_, case)| case.sizing) {
            let Some(joint) = self.joint(c, k) else { continue };
            static_nm = static_nm.max(torque(joint, &arms.cases[c]).abs());
            inertia_kgm2 = inertia_kgm2.max(arms.cases[c].inertia_at[k]);
        }
        let (static_nm, inertia_kgm2) = (static_nm.store(), inertia_kgm2.store());
        let mut indices = [0; LANES];
        let held = arms.held;
        for lane in (0..LANES).filter(|lane| held >> lane & 1 == 1) {
            let demand = sized.table.motion().demand(static_nm[lane], inertia_kgm2[lane]);
            let index = match sized.all_fits {
                true => Some(LANES * self.chunk + lane).filter(|&i| sized.table.limits(i).hold(&demand)),
                false => sized.table.first_fit(&demand),
            };
            match index {
                Some(index) => indices[lane] = index,
                None => arms.held &= !(1 << lane),
            }
        }
        indices
    }

    #[inline(always)]
    fn add_joint<V: Lanes>(&self, k: usize, indices: [usize; LANES], arms: &mut Growing<V, CASES>) {
        let drives = indices.map(|i| self.row.drives[k][i]);
        let mass = gather(&drives, |d| d.mass_kg);
        let segments = Segments {
            stiffness: [0, 1, 2].map(|i| gather(&drives, |d| d.stiffness[i])),
            mode_stiffness: [0, 1, 2].map(|i| gather(&drives, |d| d.mode_stiffness[i])),
            ends_nm: [0, 1].map(|i| gather(&drives, |d| d.ends_nm[i])),
        };
        arms.mass_kg = arms.mass_kg + mass;
        arms.masses_kg[k] = mass;
        for (c, case) in self.row.cases.iter().enumerate() {
            let Some(joint) = self.joint(c, k) else { continue };
            let lanes = &mut arms.cases[c];
            let torque_nm = torque(joint, lanes);
            let (angle, compliance) = match self.row.segmented[k] {
                true => windup(torque_nm, &segments),
                false => self.each_by_itself(k, indices, torque_nm),
            };
            lanes.compliance[k] = compliance;
            for i in (0..3).filter(|&i| joint.tip_m_per_rad[i] != 0.0) {
                lanes.tip_m[i] = lanes.tip_m[i] + V::splat(joint.tip_m_per_rad[i]) * angle;
            }
            lanes.trace_s2[joint.block] = lanes.trace_s2[joint.block] + compliance * lanes.inertia_at[k];
            for i in (0..6).filter(|&i| joint.weight_per_kg[i] != 0.0) {
                lanes.wrench[i] = lanes.wrench[i] + V::splat(joint.weight_per_kg[i]) * mass;
            }
            for j in k + 1..self.inner_slots() {
                lanes.inertia_at[j] = lanes.inertia_at[j] + V::splat(case.carried[k][j]) * mass;
            }
        }
    }

    /// Twist under a torque and twist per further torque of joints with play or friction.
    fn each_by_itself<V: Lanes>(&self, k: usize, indices: [usize; LANES], torque_nm: V) -> (V, V) {
        let slot = &self.problem.slots()[self.row.first + k];
        let (torques_nm, mut angles, mut compliances) = (torque_nm.store(), [0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            if let Some(law) = slot.law(indices[lane]) {
                angles[lane] = law.rising_angle_rad(torques_nm[lane]);
                compliances[lane] = law.tangent_compliance_rad_per_nm(torques_nm[lane]);
            }
        }
        (V::load(&angles), V::load(&compliances))
    }

    #[inline(always)]
    fn inner_slots(&self) -> usize {
        self.row.drives.len()
    }

    #[inline(always)]
    fn station(&self, case: usize) -> &Station {
        &self.problem.stations()[case]
    }

    #[inline(always)]
    fn joint(&self, case: usize, k: usize) -> Option<&StationJoint> {
        match &self.station(case).slots[self.row.first + k] {
            StationSlot::Joint(joint) => Some(joint),
            _ => None,
        }
    }

    /// Lowest eigenvalue over all judged cases, and the lanes in which it was not found.
    #[inline(always)]
    fn lowest<V: Lanes>(&mut self, arms: &Growing<V, CASES>) -> (V, u8) {
        let blocks = self.blocks(arms);
        let remembered = V::load(&self.scratch.eigenvalues[self.chunk]);
        let (mut lowest, mut unsure) = (V::splat(f64::INFINITY), 0);
        for &(c, block) in blocks.iter().flatten() {
            let bound = V::splat(1.0) / arms.cases[c].trace_s2[block];
            let open = arms.held & bound.less(lowest);
            if open == 0 {
                continue;
            }
            let guess = remembered * V::splat(self.scratch.drift);
            let guess = V::choose(guess.less(lowest), guess, V::splat(0.97) * lowest).max(bound);
            let scratch = &mut self.scratch.cases[c];
            let problem = (&self.problem.stations()[c], &self.row.cases[c]);
            let chunk = self.row.chunks.get(self.chunk).map(|chunk| &chunk.cases[c].modal);
            let ask = Ask { arms, case: c, block, first: self.row.first, lowest, guess, open };
            let (root, lost) = ask.answer(problem, chunk, scratch);
            lowest = lowest.min(root);
            unsure |= lost;
        }
        self.remember(arms.held & !unsure, remembered, lowest);
        (lowest, unsure)
    }

    /// Blocks of the judged cases, that of the largest Dunkerley sum first.
    #[inline(always)]
    fn blocks<V: Lanes>(&self, arms: &Growing<V, CASES>) -> [Option<(usize, usize)>; 2 * MOST_CASES] {
        let mut blocks = [None; 2 * MOST_CASES];
        let mut sums = [0.0; 2 * MOST_CASES];
        let mut count = 0;
        for (c, _) in self.row.cases.iter().enumerate().filter(|(_, case)| case.judged) {
            for block in 0..2 {
                let traces = arms.cases[c].trace_s2[block].store();
                let sum: f64 =
                    (0..LANES).filter(|lane| arms.held >> lane & 1 == 1).map(|lane| traces[lane]).sum();
                if sum > 0.0 {
                    (blocks[count], sums[count]) = (Some((c, block)), sum);
                    if sum > sums[0] {
                        blocks.swap(0, count);
                        sums.swap(0, count);
                    }
                    count += 1;
                }
            }
        }
        blocks
    }

    /// Keeps the roots as guesses for the next row, and by how much this row differs from the last.
    #[inline(always)]
    fn remember<V: Lanes>(&mut self, found: u8, before: V, now: V) {
        let kept = V::choose(found & now.less(V::splat(f64::INFINITY)), now, before);
        self.scratch.eigenvalues[self.chunk] = kept.store();
        let both = found & V::zero().less(before);
        if both != 0 {
            let ratios = (kept / before).store();
            let sum: f64 = (0..LANES).filter(|lane| both >> lane & 1 == 1).map(|lane| ratios[lane]).sum();
            self.scratch.drift = sum / f64::from(both.count_ones());
        }
    }
}

/// A block asked for its lowest eigenvalues where they are below those found so far.
struct Ask<'a, V, const CASES: usize> {
    arms: &'a Growing<V, CASES>,
    case: usize,
    block: usize,
    first: usize,
    lowest: V,
    guess: V,
    open: u8,
}

impl<V: Lanes, const CASES: usize> Ask<'_, V, CASES> {
    #[inline(always)]
    fn answer(
        &self,
        (station, case): (&Station, &RowCase),
        chunk: Option<&ChunkModal>,
        scratch: &mut CaseScratch,
    ) -> (V, u8) {
        let slopes = &mut scratch.slopes[self.block];
        match (&station.modal, &scratch.outboard) {
            (Modal::Planar(blocks), CaseOutboard::Planar(outboard)) => {
                let link = match chunk {
                    Some(ChunkModal::Planar(links)) => Some(&links[self.block]),
                    _ => None,
                };
                self.solve(&blocks[self.block], &outboard[self.block], link, case, slopes)
            }
            (Modal::Spatial(block), CaseOutboard::Spatial(outboard)) => {
                let link = match chunk {
                    Some(ChunkModal::Spatial(link)) => Some(&**link),
                    _ => None,
                };
                self.solve(block, outboard, link, case, slopes)
            }
            _ => (self.lowest, self.open),
        }
    }

    #[inline(always)]
    fn solve<const N: usize>(
        &self,
        block: &Block<N>,
        outboard: &Outboard<N>,
        link: Option<&LaneLink<N>>,
        case: &RowCase,
        slopes: &mut Eight,
    ) -> (V, u8) {
        let nothing = SMatrix::<f64, N, N>::zeros();
        let mut steps = [LaneStep::Body(&nothing); 2 * MOST_SLOTS];
        let count = self.steps(block, link, case, &mut steps);
        let steps = &steps[..count];
        let mut open = self.open;
        // below what was found so far?
        let known = open & self.lowest.less(V::splat(f64::INFINITY));
        if known != 0 {
            let here = pass(outboard, steps, V::choose(known, self.lowest, self.guess));
            open &= !(known & here.sound & V::zero().less(here.last));
        }
        if open == 0 {
            return (self.lowest, 0);
        }
        let found = roots(outboard, steps, self.guess, V::load(slopes), open);
        *slopes = V::choose(open & !found.unsure, found.slope, V::load(slopes)).store();
        (V::choose(open, found.eigenvalue, self.lowest), found.unsure)
    }

    /// The inner pieces as the pass sees them, up to the last that yields.
    #[inline(always)]
    fn steps<'s, const N: usize>(
        &self,
        block: &'s Block<N>,
        link: Option<&'s LaneLink<N>>,
        case: &RowCase,
        steps: &mut [LaneStep<'s, V, N>; 2 * MOST_SLOTS],
    ) -> usize {
        let lanes = &self.arms.cases[self.case];
        let end = case.ends[self.block];
        let mut count = 0;
        let mut push = |step| {
            steps[count] = step;
            count += 1;
        };
        for (k, slot) in block.slots[self.first..self.first + end].iter().enumerate() {
            match slot {
                BlockSlot::Joint { twist, inertia_per_kg } => {
                    if twist.amax() > 0.0 {
                        push(LaneStep::Joint(twist, lanes.compliance[k]));
                    }
                    if k + 1 < end {
                        push(LaneStep::Mass(self.arms.masses_kg[k], inertia_per_kg));
                    }
                }
                BlockSlot::Body(inertia) => push(LaneStep::Body(inertia)),
                BlockSlot::Links(_) => match link {
                    Some(link) if case.links_yield => push(LaneStep::Link(link)),
                    Some(link) => push(LaneStep::Rigid(link.rigid())),
                    None => {}
                },
            }
        }
        count
    }
}

/// Axial force, torsion and both bending moments of a wrench at a point of a link.
fn local(place: &Place, wrench: &Vector6<f64>, at_m: &Vector3<f64>) -> [f64; 4] {
    let force = place.frame.tr_mul(&linear(wrench));
    let moment = place.frame.tr_mul(&(angular(wrench) - at_m.cross(&linear(wrench))));
    [force.x, moment.x, moment.y, moment.z]
}

/// Von Mises stress of bending, axial force and torsion, over the strength.
#[inline(always)]
fn stress_at<V: Lanes>(per: &StressEight, [axial, torsion, y, z]: [V; 4]) -> V {
    let y = y.abs() * V::load(&per.per_moment_y);
    let z = z.abs() * V::load(&per.per_moment_z);
    let bending = match per.round {
        0 => y + z,
        round => V::choose(round, (y * y + z * z).sqrt(), y + z),
    };
    let normal = axial.abs() * V::load(&per.per_axial_n) + bending;
    let shear = torsion.abs() * V::load(&per.per_torsion);
    (normal * normal + V::splat(3.0) * shear * shear).sqrt()
}

/// Torque about a joint's axis.
#[inline(always)]
fn torque<V: Lanes>(joint: &StationJoint, lanes: &CaseLanes<V>) -> V {
    let mut sum = V::zero();
    for i in 0..6 {
        if joint.twist[i] != 0.0 {
            sum = sum + V::splat(joint.twist[i]) * lanes.wrench[i];
        }
    }
    sum
}

/// A figure of eight drives.
#[inline(always)]
fn gather<V: Lanes>(drives: &[DriveFigures; LANES], of: impl Fn(&DriveFigures) -> f64) -> V {
    let mut out = [0.0; LANES];
    for lane in 0..LANES {
        out[lane] = of(&drives[lane]);
    }
    V::load(&out)
}

/// The three-segment curves of eight gears.
struct Segments<V> {
    stiffness: [V; 3],
    mode_stiffness: [V; 3],
    ends_nm: [V; 2],
}

/// Twist under a torque, and compliance in modes.
#[inline(always)]
fn windup<V: Lanes>(torque_nm: V, gears: &Segments<V>) -> (V, V) {
    let Segments { stiffness, mode_stiffness, ends_nm } = gears;
    let t = torque_nm.abs();
    let first = t.min(ends_nm[0]) / stiffness[0];
    let second = (t.min(ends_nm[1]) - ends_nm[0]).max(V::zero()) / stiffness[1];
    let third = (t - ends_nm[1]).max(V::zero()) / stiffness[2];
    let size = first + second + third;
    let angle = V::choose(torque_nm.less(V::zero()), V::zero() - size, size);
    let tangent = V::choose(
        ends_nm[0].less(t),
        V::choose(ends_nm[1].less(t), mode_stiffness[2], mode_stiffness[1]),
        mode_stiffness[0],
    );
    (angle, V::splat(1.0) / tangent)
}
