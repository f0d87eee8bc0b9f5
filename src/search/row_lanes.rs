//! Eight designs finished at once: the pieces from the innermost level to the base added in lanes, then
//! [their lowest modes](super::row_modes).

// matrices by row and column read better than iterators over them
#![allow(clippy::needless_range_loop)]

use super::outward::{ArmProblem, Partial, SizedJoint, Slot};
use super::row::{Begun, Chunk, DriveFigures, MOST_SLOTS, Row, StressEight, Twisting};
use super::row_modes::Question;
use super::station::{Station, StationJoint, StationSlot};
use super::{Keep, Objectives};
use crate::mechanics::lanes::{Eight, LANES, LaneWork, Lanes, splat_all};
use crate::sizing::EightDemands;
use std::f64::consts::TAU;

/// Eight options of a row.
#[derive(Clone, Copy)]
pub(super) struct RowChunk<'a, 'c> {
    pub problem: &'a ArmProblem<'c>,
    pub row: &'a Row,
    pub from: &'a Partial,
    pub chunk: usize,
}

/// Eight options of a row to be finished.
pub(super) struct RowWork<'a, 'c> {
    pub at: RowChunk<'a, 'c>,
    pub begun: &'a mut Begun,
    pub arms: &'a mut EightArms,
    /// Bits of the options that exist.
    pub valid: u8,
    /// Which designs are of interest.
    pub keep: &'a dyn Keep,
}

/// What became of eight designs; what they come to is in their [`EightArms`].
#[derive(Default)]
pub(super) struct FinishedEight {
    /// Bits of the designs that hold.
    pub held: u8,
    /// Bits of those whose lowest mode is below the bar, wherever it is.
    pub below_bar: u8,
    /// Bits of those whose lowest mode was not found.
    pub unsure: u8,
}

/// Eight arms as they grow inward.
pub(super) struct EightArms {
    /// Bits of those that hold so far.
    pub held: u8,
    pub mass_kg: Eight,
    /// Mass of the drive in each inner slot.
    pub masses_kg: [Eight; MOST_SLOTS],
    /// The largest of what single joints add to Dunkerley's sums: no lowest eigenvalue is above one over that.
    pub largest_s2: Eight,
    pub cases: Vec<CaseArms>,
    /// What they come to, once finished.
    pub tip_deflection_m: Eight,
    lowest_mode_hz: Eight,
}

/// Eight arms in one case.
#[derive(Clone)]
pub(super) struct CaseArms {
    wrench: [Eight; 6],
    tip_m: [Eight; 3],
    inertia_at: [Eight; MOST_SLOTS],
    pub compliance: [Eight; MOST_SLOTS],
    /// Dunkerley's sum of each block.
    pub trace_s2: [Eight; 2],
}

impl EightArms {
    /// Room for eight arms in so many cases.
    pub fn new(cases: usize) -> Self {
        let zeros = [0.0; LANES];
        let nothing = CaseArms {
            wrench: [zeros; 6],
            tip_m: [zeros; 3],
            inertia_at: [zeros; MOST_SLOTS],
            compliance: [zeros; MOST_SLOTS],
            trace_s2: [zeros; 2],
        };
        Self {
            held: 0,
            mass_kg: zeros,
            masses_kg: [zeros; MOST_SLOTS],
            largest_s2: zeros,
            cases: vec![nothing; cases],
            tip_deflection_m: zeros,
            lowest_mode_hz: zeros,
        }
    }

    /// Objectives of one of the eight.
    pub fn objectives(&self, lane: usize) -> Objectives {
        Objectives {
            tip_deflection_m: self.tip_deflection_m[lane],
            mass_kg: self.mass_kg[lane],
            lowest_mode_hz: self.lowest_mode_hz[lane],
        }
    }
}

impl LaneWork for RowWork<'_, '_> {
    type Output = FinishedEight;

    #[inline(always)]
    fn run<V: Lanes>(self) -> FinishedEight {
        let RowWork { at, begun, arms, valid, keep } = self;
        arms.held = valid;
        at.grow::<V>(begun, arms);
        if let Some(max_kg) = at.problem.space().constraints.mass_max_kg {
            arms.held &= !V::splat(max_kg).less(V::load(&arms.mass_kg));
        }
        if arms.held == 0 {
            return FinishedEight::default();
        }
        let mut tip_m2 = V::zero();
        for (_, lanes) in at.row.cases.iter().zip(&arms.cases).filter(|(case, _)| case.judged) {
            let [x, y, z]: [V; 3] = load_all(&lanes.tip_m);
            tip_m2 = tip_m2.max(x * x + y * y + z * z);
        }
        let held = arms.held;
        let mut below_bar = Question::new(at, begun, arms).below_one_bar::<V>(keep, &tip_m2.store(), held);
        if below_bar == held {
            return FinishedEight { held, below_bar, unsure: 0 };
        }
        arms.tip_deflection_m = tip_m2.sqrt().store();
        let question = Question::new(at, begun, arms);
        below_bar |= question.below_bar::<V>(keep, held & !below_bar);
        if below_bar == held {
            return FinishedEight { held, below_bar, unsure: 0 };
        }
        let (eigenvalue, unsure) = question.lowest::<V>(held & !below_bar);
        arms.lowest_mode_hz = (eigenvalue.sqrt() / V::splat(TAU)).store();
        FinishedEight { held, below_bar, unsure }
    }
}

impl RowChunk<'_, '_> {
    /// Adds piece after piece.
    #[inline(always)]
    fn grow<V: Lanes>(&self, begun: &mut Begun, arms: &mut EightArms) {
        let slots = &self.problem.slots()[self.row.first..];
        arms.largest_s2 = [0.0; LANES];
        // a link comes first or not at all
        match self.row.chunks.get(self.chunk) {
            Some(chunk) => self.start_with_link::<V>(chunk, begun, arms),
            None => self.start(begun, arms),
        }
        for (k, slot) in slots.iter().enumerate() {
            match slot {
                Slot::Link { .. } => {}
                Slot::Offset { .. } if self.row.idle[k] => {}
                Slot::Offset { mass_kg } => self.add_offset::<V>(k, *mass_kg, arms),
                Slot::Given { .. } => self.add_joint::<V>(k, [0; LANES], arms),
                Slot::Sized(sized) => {
                    let indices = self.pick::<V>(k, sized, &mut begun.steps[k], arms);
                    if arms.held == 0 {
                        return;
                    }
                    self.add_joint::<V>(k, indices, arms);
                }
            }
        }
    }

    /// The arm outboard of the row, eight times.
    #[inline(always)]
    fn start(&self, begun: &Begun, arms: &mut EightArms) {
        arms.mass_kg = [self.from.mass_kg; LANES];
        for (c, (lanes, state)) in arms.cases.iter_mut().zip(&self.from.stations).enumerate() {
            let (case, begun) = (&self.row.cases[c], &begun.cases[c]);
            for i in (0..6).filter(|&i| case.loaded[i]) {
                lanes.wrench[i] = [state.wrench[i]; LANES];
            }
            for i in 0..3 {
                lanes.tip_m[i] = [state.tip_m[i]; LANES];
            }
            for &j in &self.row.joints {
                lanes.inertia_at[j] = [begun.inertia_at[j]; LANES];
            }
            for b in 0..2 {
                lanes.trace_s2[b] = [state.trace_s2[b]; LANES];
            }
        }
    }

    /// The same with a link on it.
    #[inline(always)]
    fn start_with_link<V: Lanes>(&self, chunk: &Chunk, begun: &Begun, arms: &mut EightArms) {
        let constraints = &self.problem.space().constraints;
        arms.held &= !chunk.slender;
        arms.mass_kg = (V::splat(self.from.mass_kg) + V::load(&chunk.mass_kg)).store();
        if let Some(max) = constraints.material_cost_max_eur {
            let cost = V::splat(self.from.cost_eur) + V::load(&chunk.cost_eur);
            arms.held &= !V::splat(max).less(cost);
        }
        for (k, case) in self.row.cases.iter().enumerate() {
            let (state, begun, own) = (&self.from.stations[k], &begun.cases[k], &chunk.cases[k]);
            let lanes = &mut arms.cases[k];
            let weight = V::load(&own.weight_n);
            for i in (0..6).filter(|&i| case.loaded[i]) {
                let mut component = V::splat(state.wrench[i]);
                if case.link_weight[i] != 0.0 {
                    component = component + weight * V::splat(case.link_weight[i]);
                }
                lanes.wrench[i] = component.store();
            }
            for &j in &self.row.joints {
                lanes.inertia_at[j] = (V::splat(begun.inertia_at[j]) + V::load(&own.inertia_at[j])).store();
            }
            if !case.judged {
                continue;
            }
            for i in 0..3 {
                let mut tip = V::splat(state.tip_m[i]);
                if case.bends[i] {
                    tip = tip + V::load(&own.sag_m[i]);
                    for j in (0..6).filter(|&j| state.wrench[j] != 0.0) {
                        tip = tip + V::load(&own.flexibility[i][j]) * V::splat(state.wrench[j]);
                    }
                }
                lanes.tip_m[i] = tip.store();
            }
            for b in 0..2 {
                let mut sum = V::splat(state.trace_s2[b]);
                if case.links_yield {
                    sum = sum + V::load(&own.trace_s2[b]);
                    for e in case.spread_of[b].clone() {
                        sum = sum + V::splat(begun.spread[e]) * V::load(&own.spread[e]);
                    }
                }
                lanes.trace_s2[b] = sum.store();
            }
        }
        if let Some(least) = constraints.stress_safety_factor_min {
            let stress: V = self.stress(chunk, begun);
            arms.held &= !V::splat(1.0).less(stress * V::splat(least));
        }
    }

    /// The largest stress at the ends of the links so far at peak load, over the strength.
    #[inline(always)]
    fn stress<V: Lanes>(&self, chunk: &Chunk, begun: &Begun) -> V {
        let (mut standing, mut moving) = (V::zero(), V::zero());
        for (k, case) in self.row.cases.iter().enumerate() {
            let weight = V::load(&chunk.cases[k].weight_n);
            let mut at_root: [V; 4] = splat_all(begun.cases[k].at_root);
            for i in 0..4 {
                at_root[i] = at_root[i] + weight * V::splat(case.link_weight_at_root[i]);
            }
            let at_end: V = stress_squared(&chunk.stress, splat_all(begun.cases[k].at_end));
            let largest = at_end.max(stress_squared(&chunk.stress, at_root));
            // where joints are sized the arm also accelerates; elsewhere it only stands
            match case.sizing {
                true => moving = moving.max(largest),
                false => standing = standing.max(largest),
            }
        }
        let own = standing.sqrt().max(moving.sqrt() * V::splat(self.problem.peak_factor()));
        own.max(V::splat(self.from.stress_ratio))
    }

    #[inline(always)]
    fn add_offset<V: Lanes>(&self, k: usize, mass_kg: f64, arms: &mut EightArms) {
        add(&mut arms.mass_kg, V::splat(mass_kg));
        for (c, case) in self.row.cases.iter().enumerate() {
            let StationSlot::Body { weight, .. } = &self.station(c).slots[self.row.first + k] else {
                continue;
            };
            let lanes = &mut arms.cases[c];
            for i in (0..6).filter(|&i| case.weighs[k] && weight[i] != 0.0) {
                add(&mut lanes.wrench[i], V::splat(weight[i]));
            }
            for &j in self.row.joints.iter().filter(|&&j| case.carried[k][j] != 0.0) {
                add(&mut lanes.inertia_at[j], V::splat(case.carried[k][j]));
            }
        }
    }

    /// The drive of each arm; an arm without one is no longer held.
    #[inline(always)]
    fn pick<V: Lanes>(
        &self,
        k: usize,
        sized: &SizedJoint,
        step: &mut usize,
        arms: &mut EightArms,
    ) -> [usize; LANES] {
        let (mut static_nm, mut inertia_kgm2) = (V::zero(), V::zero());
        for (c, case) in self.row.cases.iter().enumerate().filter(|(_, case)| case.sizing) {
            static_nm = static_nm.max(torque::<V>(&case.twists[k], &arms.cases[c]).abs());
            inertia_kgm2 = inertia_kgm2.max(V::load(&arms.cases[c].inertia_at[k]));
        }
        if !sized.all_fits {
            let demands = EightDemands::new(sized.table.motion(), static_nm, inertia_kgm2);
            let (fits, held) = sized.table.first_fits(&demands, arms.held, step);
            arms.held = held;
            return fits;
        }
        let (static_nm, inertia_kgm2) = (static_nm.store(), inertia_kgm2.store());
        let mut indices = [0; LANES];
        for lane in 0..LANES {
            if arms.held >> lane & 1 == 1 {
                let demand = sized.table.motion().demand(static_nm[lane], inertia_kgm2[lane]);
                indices[lane] = LANES * self.chunk + lane;
                arms.held &= !(u8::from(!sized.table.limits(indices[lane]).hold(&demand)) << lane);
            }
        }
        indices
    }

    #[inline(always)]
    fn add_joint<V: Lanes>(&self, k: usize, indices: [usize; LANES], arms: &mut EightArms) {
        let drives = &self.row.drives[k];
        // eight arms much alike often have the same drive
        let alike = indices.iter().all(|index| *index == indices[0]);
        let mass: V = at_places(&drives.mass_kg, &indices, alike);
        let first: V = at_places(&drives.compliance[0], &indices, alike);
        let twisting = self.row.twisting[k];
        let curves = match twisting {
            Twisting::Segments => Curves::<V>::gather(drives, &indices, alike),
            _ => Curves::line(first),
        };
        add(&mut arms.mass_kg, mass);
        arms.masses_kg[k] = mass.store();
        let mut largest = V::load(&arms.largest_s2);
        for (c, case) in self.row.cases.iter().enumerate() {
            let Some(joint) = self.joint(c, k) else { continue };
            let lanes = &mut arms.cases[c];
            if case.judged {
                let mut compliance = first;
                if twisting != Twisting::AtRest {
                    let torque_nm: V = torque(&case.twists[k], lanes);
                    let (angle, tangent) = match twisting {
                        Twisting::AtRest | Twisting::Line => (torque_nm * first, first),
                        Twisting::Segments => curves.windup(torque_nm),
                        Twisting::Play => self.each_by_itself(k, indices, torque_nm),
                    };
                    compliance = tangent;
                    for i in (0..3).filter(|&i| joint.tip_m_per_rad[i] != 0.0) {
                        add(&mut lanes.tip_m[i], V::splat(joint.tip_m_per_rad[i]) * angle);
                    }
                }
                lanes.compliance[k] = compliance.store();
                let inertia = V::load(&lanes.inertia_at[k]);
                let own = compliance * inertia;
                add(&mut lanes.trace_s2[joint.block], own);
                largest = largest.max(own);
            }
            for i in (0..6).filter(|&i| case.weighs[k] && joint.weight_per_kg[i] != 0.0) {
                add(&mut lanes.wrench[i], V::splat(joint.weight_per_kg[i]) * mass);
            }
            for &j in self.row.joints.iter().filter(|&&j| case.carried[k][j] != 0.0) {
                add(&mut lanes.inertia_at[j], V::splat(case.carried[k][j]) * mass);
            }
        }
        arms.largest_s2 = largest.store();
    }

    /// Twist under a torque and twist per further torque of joints with play or friction.
    #[inline(always)]
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
}

/// Adds to eight numbers.
#[inline(always)]
fn add<V: Lanes>(to: &mut Eight, more: V) {
    *to = (V::load(to) + more).store();
}

/// Eights from memory.
#[inline(always)]
fn load_all<V: Lanes, const K: usize>(from: &[Eight; K]) -> [V; K] {
    let mut out = [V::zero(); K];
    for k in 0..K {
        out[k] = V::load(&from[k]);
    }
    out
}

/// Numbers of a list at eight places, or at one that all share.
#[inline(always)]
fn at_places<V: Lanes>(list: &[f64], at: &[usize; LANES], alike: bool) -> V {
    if alike { V::splat(list[at[0]]) } else { V::gather(list, at) }
}

/// Square of the von Mises stress of bending, axial force and torsion, over the strength.
#[inline(always)]
fn stress_squared<V: Lanes>(per: &StressEight, [axial, torsion, y, z]: [V; 4]) -> V {
    let y = y.abs() * V::load(&per.per_moment_y);
    let z = z.abs() * V::load(&per.per_moment_z);
    let bending = match per.round {
        0 => y + z,
        round => V::choose(round, (y * y + z * z).sqrt(), y + z),
    };
    let normal = axial.abs() * V::load(&per.per_axial_n) + bending;
    let shear = torsion.abs() * V::load(&per.per_torsion);
    normal * normal + V::splat(3.0) * shear * shear
}

/// Torque about a joint's axis.
#[inline(always)]
fn torque<V: Lanes>(twist: &[f64; 6], lanes: &CaseArms) -> V {
    let mut sum = V::zero();
    for i in 0..6 {
        if twist[i] != 0.0 {
            sum = sum + V::splat(twist[i]) * V::load(&lanes.wrench[i]);
        }
    }
    sum
}

/// The three-segment curves of eight gears.
struct Curves<V> {
    compliance: [V; 3],
    ends_nm: [V; 2],
    first_in_modes: bool,
}

impl<V: Lanes> Curves<V> {
    /// Those of one slope.
    #[inline(always)]
    fn line(compliance: V) -> Self {
        Self { compliance: [compliance; 3], ends_nm: [V::zero(); 2], first_in_modes: true }
    }

    #[inline(always)]
    fn gather(of: &DriveFigures, at: &[usize; LANES], alike: bool) -> Self {
        let zero = V::zero();
        let mut curves =
            Self { compliance: [zero; 3], ends_nm: [zero; 2], first_in_modes: of.first_in_modes };
        for segment in 0..3 {
            curves.compliance[segment] = at_places(&of.compliance[segment], at, alike);
        }
        for end in 0..2 {
            curves.ends_nm[end] = at_places(&of.ends_nm[end], at, alike);
        }
        curves
    }

    /// Twist under a torque, and compliance in modes.
    #[inline(always)]
    fn windup(&self, torque_nm: V) -> (V, V) {
        let Self { compliance, ends_nm, first_in_modes } = self;
        let t = torque_nm.abs();
        let first = t.min(ends_nm[0]) * compliance[0];
        let second = (t.min(ends_nm[1]) - ends_nm[0]).max(V::zero()) * compliance[1];
        let third = (t - ends_nm[1]).max(V::zero()) * compliance[2];
        let size = first + second + third;
        let angle = V::choose(torque_nm.less(V::zero()), V::zero() - size, size);
        let beyond = [ends_nm[0].less(t), ends_nm[1].less(t)];
        let tangent = V::choose(beyond[0], V::choose(beyond[1], compliance[2], compliance[1]), compliance[0]);
        (angle, if *first_in_modes { compliance[0] } else { tangent })
    }
}
