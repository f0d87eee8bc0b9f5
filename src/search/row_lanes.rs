//! The inner loop of the sweep: it evaluates eight designs of a row at once.
//!
//! The slots from the row level to the base are added to eight arms at a time, one design in each lane of a vector
//! register. Then the [lowest modes](super::row_modes) are computed. A design that breaks a limit, or that is surely
//! dominated, is only counted.
//!
//! The functions are `#[inline(always)]` because this code is compiled once for each set of vector instructions. A
//! function that is not inlined would be compiled for the common instructions alone and would be slow.

// matrices by row and column read better than iterators over them
#![allow(clippy::needless_range_loop)]

use super::arms::EightArms;
use super::row::{Row, RowChunk, Twisting};
use super::row_begun::{Begun, RowScratch};
use super::row_case::{AtJoint, Hinge};
use super::row_chunk::{Chunk, StressEight};
use super::row_drives::DriveAttributes;
use super::row_modes::Question;
use crate::mechanics::lanes::{Eight, LANES, LaneWork, Lanes, load_all, splat_all};
use crate::sizing::eight::EightDemands;
use crate::space::levels::{DesignRow, Finished, Keep, OutwardIn};
use crate::space::problem::{ArmProblem, Partial};
use crate::space::slot::{SizedJoint, Slot};
use crate::space::station::{Station, StationJoint, StationSlot};
use std::f64::consts::TAU;

/// Rows whose designs are to be evaluated, with everything that the evaluation needs.
pub(crate) struct RowsWork<'a, 'c, K> {
    pub problem: &'a ArmProblem<'c>,
    pub row: &'a Row,
    /// The rows of one batch.
    pub rows: &'a [DesignRow<Partial>],
    /// Number of designs in each row: the options of the row level.
    pub options: u32,
    pub scratch: &'a mut RowScratch,
    /// Takes the designs that are of interest, and counts the designs that are not.
    pub keep: &'a mut K,
}

/// The outcome of eight designs, as bit masks with one bit per design. Their objectives are in the [`EightArms`].
#[derive(Clone, Copy, Default)]
struct FinishedEight {
    /// Designs that meet all limits.
    held: u8,
    /// Designs that meet all limits, but whose lowest mode is below the bar. The bar of a design is the lowest mode
    /// below which a design of its mass and deflection is dominated. The modes of these designs are not computed.
    below_bar: u8,
    /// Designs that meet all limits, but whose iteration for the lowest mode did not converge. They are computed
    /// again, one by one.
    unsure: u8,
}

impl<K: Keep> LaneWork for RowsWork<'_, '_, K> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(self) {
        let RowsWork { problem, row, rows, options, scratch, keep } = self;
        let (mut excluded, mut below_bar) = (0, 0);
        // The outer loop is over chunks and the inner loop over rows, so that each chunk is read from memory once for
        // all rows.
        for chunk in 0..(options as usize).div_ceil(LANES) {
            let lanes = LANES.min(options as usize - chunk * LANES);
            let valid = u8::MAX >> (LANES - lanes);
            // If all eight designs of a row fail with the first drives, they also fail in every other row with the same
            // arm outboard and the same first drives.
            let mut ruled_out: Option<(&DesignRow<Partial>, usize)> = None;
            for (designs, begun) in rows.iter().zip(&mut scratch.rows) {
                if ruled_out.is_some_and(|(other, levels)| designs.begins_like(other, levels)) {
                    excluded += u128::from(valid.count_ones());
                    continue;
                }
                let at = RowChunk { problem, row, from: &designs.from, inner: &designs.inner, chunk };
                let done = at.finish::<V>(begun, &mut scratch.arms, valid, keep);
                ruled_out = (done.held == 0).then_some((designs, scratch.arms.failed_with));
                excluded += u128::from((valid & !done.held).count_ones());
                below_bar += u64::from(done.below_bar.count_ones());
                if done.below_bar != done.held {
                    at.hand_over(done, designs, &scratch.arms, &mut scratch.spare, keep);
                }
            }
        }
        keep.exclude(excluded);
        keep.below_bar(below_bar);
    }
}

impl RowChunk<'_, '_> {
    /// Evaluates eight designs. `valid` is a bit mask of the lanes that have a design. The tests go from the cheapest
    /// to the most expensive. The function returns as soon as every design breaks a limit or has a lowest mode below
    /// its bar, the mode below which it is dominated.
    #[inline(always)]
    fn finish<V: Lanes>(
        &self,
        begun: &mut Begun,
        arms: &mut EightArms,
        valid: u8,
        keep: &impl Keep,
    ) -> FinishedEight {
        arms.held = valid;
        arms.failed_with = self.grow::<V>(begun, arms);
        if let Some(max_kg) = self.problem.space().constraints.mass_max_kg {
            arms.held &= !V::splat(max_kg).less(V::load(&arms.mass_kg));
        }
        if arms.held == 0 {
            return FinishedEight::default();
        }
        // Squares of the deflections are compared first, because they decide about most designs without a square root.
        let mut tip_m2 = V::zero();
        for (_, lanes) in self.row.cases.iter().zip(&arms.cases).filter(|(case, _)| case.judged) {
            let [x, y, z]: [V; 3] = load_all(&lanes.tip_m);
            tip_m2 = tip_m2.max(x * x + y * y + z * z);
        }
        let held = arms.held;
        let mut below_bar = Question::new(*self, begun, arms).below_one_bar::<V>(keep, &tip_m2.store(), held);
        if below_bar == held {
            return FinishedEight { held, below_bar, unsure: 0 };
        }
        arms.tip_deflection_m = tip_m2.sqrt().store();
        // Dunkerley's sums (of 1/λ over all modes) are computed only here, because few designs get so far.
        self.sum_traces::<V>(begun, arms);
        let question = Question::new(*self, begun, arms);
        below_bar |= question.below_bar::<V>(keep, held & !below_bar);
        if below_bar == held {
            return FinishedEight { held, below_bar, unsure: 0 };
        }
        let (eigenvalue, unsure) = question.lowest::<V>(held & !below_bar);
        arms.lowest_mode_hz = (eigenvalue.sqrt() / V::splat(TAU)).store();
        FinishedEight { held, below_bar, unsure }
    }

    /// Reports to `keep` the designs whose lowest mode is above the bar. `done` is the outcome of the eight designs.
    /// The function is rarely called, so it is not inlined into the loop.
    #[inline(never)]
    fn hand_over(
        &self,
        done: FinishedEight,
        designs: &DesignRow<Partial>,
        arms: &EightArms,
        spare: &mut Partial,
        keep: &mut impl Keep,
    ) {
        for lane in (0..LANES).filter(|lane| (done.held & !done.below_bar) >> lane & 1 == 1) {
            let option = (self.chunk * LANES + lane) as u32;
            // the iteration for eight designs at once may not converge; the search for a single design always does
            if done.unsure >> lane & 1 == 1 {
                self.problem.finish_one(designs, option, spare, keep);
            } else {
                let finished = Finished { objectives: arms.objectives(lane), group: self.group(lane) };
                keep.complete(designs.number(option), finished);
            }
        }
    }

    /// Adds one inner slot (from the row level to the base) after another to the eight arms, until every arm is
    /// complete or every arm breaks a limit. Returns how many of the drives chosen inboard of the row level were added.
    #[inline(always)]
    fn grow<V: Lanes>(&self, begun: &mut Begun, arms: &mut EightArms) -> usize {
        let slots = &self.problem.slots()[self.row.first..];
        let mut largest_s2 = V::zero();
        let mut indices = [0; LANES];
        // The row level is either a link or a drive. None of the other inner slots is a link with options.
        match self.row.chunks.get(self.chunk) {
            Some(chunk) => self.start_with_link::<V>(chunk, begun, arms),
            None => self.start::<V>(begun, arms),
        }
        let mut chosen = 0;
        for &k in &self.row.compliant {
            if slots[k].given_tube().is_some() {
                largest_s2 = largest_s2.max(self.add_tube(k, arms));
                continue;
            }
            // The springs of a bearing take the index of the drive to which they belong.
            indices = match &slots[k] {
                Slot::Sized(sized) => self.pick::<V>(k, sized, begun, arms),
                Slot::Bearing { .. } => indices,
                _ => [0; LANES],
            };
            chosen += usize::from(self.row.chosen[k].is_some());
            if arms.held == 0 {
                return chosen;
            }
            if matches!(slots[k], Slot::Sized(_)) {
                self.add_drive::<V>(k, &indices, arms);
            }
            largest_s2 = largest_s2.max(self.add_joint(k, indices, arms));
        }
        arms.largest_s2 = largest_s2.store();
        chosen
    }

    /// Sets all eight arms to the same arm outboard of the row, whose numbers are in `begun`. Nothing is added for the
    /// row level.
    #[inline(always)]
    fn start<V: Lanes>(&self, begun: &Begun, arms: &mut EightArms) {
        arms.mass_kg = V::splat(self.from.mass_kg + self.row.fixed_kg).store();
        for (c, (lanes, state)) in arms.cases.iter_mut().zip(&self.from.stations).enumerate() {
            for i in 0..3 {
                lanes.tip_m[i] = V::splat(state.tip_m[i]).store();
            }
            for &Hinge { number: j, .. } in &self.row.hinges {
                lanes.torque_at[j] = V::splat(begun.cases[c].at[j].torque_nm).store();
                lanes.inertia_at[j] = V::splat(begun.cases[c].at[j].inertia_kgm2).store();
            }
        }
    }

    /// Sets the eight arms to the arm outboard of the row, whose numbers are in `begun`, and adds one link option of
    /// `chunk` to each.
    #[inline(always)]
    fn start_with_link<V: Lanes>(&self, chunk: &Chunk, begun: &Begun, arms: &mut EightArms) {
        let constraints = &self.problem.space().constraints;
        arms.held &= !chunk.slender;
        arms.mass_kg = (V::splat(self.from.mass_kg + self.row.fixed_kg) + V::load(&chunk.mass_kg)).store();
        if let Some(max) = constraints.material_cost_max_eur {
            let cost = V::splat(self.from.cost_eur) + V::load(&chunk.cost_eur);
            arms.held &= !V::splat(max).less(cost);
        }
        for (k, case) in self.row.cases.iter().enumerate() {
            let (state, begun, own) = (&self.from.stations[k], &begun.cases[k], &chunk.cases[k]);
            let lanes = &mut arms.cases[k];
            let weight = V::load(&own.weight_n);
            for &Hinge { number: j, .. } in &self.row.hinges {
                let AtJoint { torque_nm, inertia_kgm2 } = begun.at[j];
                // A joint that no load or weight turns has zero torque in every arm.
                if case.turned[j] {
                    let own = weight * V::splat(case.link_torque[j]);
                    lanes.torque_at[j] = (V::splat(torque_nm) + own).store();
                }
                lanes.inertia_at[j] = (V::splat(inertia_kgm2) + V::load(&own.inertia_at[j])).store();
            }
            if !case.judged {
                continue;
            }
            for i in 0..3 {
                let mut tip = V::splat(state.tip_m[i]);
                if case.bends[i] {
                    tip = tip + V::load(&own.own_weight_deflection_m[i]);
                    // in a planar pose half of the components of the wrench are zero
                    for j in (0..6).filter(|&j| state.wrench[j] != 0.0) {
                        tip = tip + V::load(&own.flexibility[i][j]) * V::splat(state.wrench[j]);
                    }
                }
                lanes.tip_m[i] = tip.store();
            }
        }
        if let Some(least) = constraints.stress_safety_factor_min {
            let stress: V = self.stress(chunk, begun);
            arms.held &= !V::splat(1.0).less(stress * V::splat(least));
        }
    }

    /// For each of eight designs, the largest ratio of stress to strength at peak load, over both ends of the row's
    /// link and of all links outboard of it.
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
            // In a sizing case the arm accelerates. In the other cases it is at rest.
            match case.sizing {
                true => moving = moving.max(largest),
                false => standing = standing.max(largest),
            }
        }
        // The square roots are taken after the largest squares over the cases, so that two roots are enough.
        let own = standing.sqrt().max(moving.sqrt() * V::splat(self.problem.peak_factor()));
        own.max(V::splat(self.from.stress_ratio))
    }

    /// Index of the drive that each of the eight arms gets at inner slot `k`: the chosen drive, or the lightest drive
    /// that meets the demand. An arm for which no drive meets the demand is removed from `held`.
    #[inline(always)]
    fn pick<V: Lanes>(
        &self,
        k: usize,
        sized: &SizedJoint,
        begun: &mut Begun,
        arms: &mut EightArms,
    ) -> [usize; LANES] {
        let (mut static_nm, mut inertia_kgm2) = (V::zero(), V::zero());
        for (c, case) in self.row.cases.iter().enumerate().filter(|(_, case)| case.sizing) {
            if case.turned[k] {
                static_nm = static_nm.max(V::load(&arms.cases[c].torque_at[k]).abs());
            }
            inertia_kgm2 = inertia_kgm2.max(V::load(&arms.cases[c].inertia_at[k]));
        }
        if sized.all_fits && k == 0 {
            return self.drive_in_each_lane(sized, begun, [static_nm.store(), inertia_kgm2.store()], arms);
        }
        let bearing = match self.row.bearings.iter().position(|bearing| bearing.k == k) {
            None => None,
            Some(which) => Some(self.row.bearings[which].demands(
                self.problem,
                (self.from, self.chunk),
                &begun.bearings[which],
                &arms.masses_kg,
            )),
        };
        let room = self.row.rooms.iter().find(|room| room.k == k);
        let room = room.and_then(|room| room.room(self.problem, (self.from, self.chunk)));
        let demands = EightDemands::new(sized.table.motion(), static_nm, inertia_kgm2)
            .with_bearing(bearing)
            .with_room(room);
        match self.row.chosen[k] {
            Some(level) => {
                let index = self.inner[level] as usize;
                arms.held = demands.held_by(sized.table.limits(index), arms.held);
                [index; LANES]
            }
            None => {
                let (fits, held) = sized.table.first_fits(&demands, arms.held, &mut begun.steps[k]);
                arms.held = held;
                fits
            }
        }
    }

    /// Index of the drive of each arm if the row level is a joint. The eight lanes have eight different drives, with
    /// different limits, while the demand is the same in all lanes. An arm whose drive does not meet the demand is
    /// removed from `held`.
    #[inline(always)]
    fn drive_in_each_lane(
        &self,
        sized: &SizedJoint,
        begun: &Begun,
        [static_nm, inertia_kgm2]: [Eight; 2],
        arms: &mut EightArms,
    ) -> [usize; LANES] {
        let mut indices = [0; LANES];
        for lane in 0..LANES {
            if arms.held >> lane & 1 == 1 {
                let torques = sized.table.motion().demand(static_nm[lane], inertia_kgm2[lane]);
                let demand = torques.with_bearing(begun.of_row).with_room(begun.room_of_row);
                indices[lane] = LANES * self.chunk + lane;
                arms.held &= !(u8::from(!sized.table.limits(indices[lane]).hold(&demand)) << lane);
            }
        }
        indices
    }

    /// Adds the mass of each arm's drive at inner slot `k`, and the torque and inertia that this mass causes at the
    /// joints inboard. `indices` are the drives of the eight arms.
    #[inline(always)]
    fn add_drive<V: Lanes>(&self, k: usize, indices: &[usize; LANES], arms: &mut EightArms) {
        let mass: V = at_places(&self.row.drives[k].mass_kg, indices, all_equal(indices));
        add(&mut arms.mass_kg, mass);
        arms.masses_kg[k] = mass.store();
        for (case, lanes) in self.row.cases.iter().zip(&mut arms.cases) {
            for &Hinge { number: j, .. } in self.row.hinges.iter().filter(|hinge| hinge.slot > k) {
                let AtJoint { torque_nm, inertia_kgm2 } = case.per_kg[k][j];
                // Torque and inertia per kilogram are the same for all lanes, and often zero.
                if torque_nm != 0.0 {
                    add(&mut lanes.torque_at[j], V::splat(torque_nm) * mass);
                }
                if inertia_kgm2 != 0.0 {
                    add(&mut lanes.inertia_at[j], V::splat(inertia_kgm2) * mass);
                }
            }
        }
    }

    /// Adds the tip displacement that the torsion of the joint in inner slot `k` causes. `indices` are the drives of
    /// the eight arms. Returns, for each arm, the largest term that this joint adds to Dunkerley's sums \[s²\].
    #[inline(always)]
    fn add_joint<V: Lanes>(&self, k: usize, indices: [usize; LANES], arms: &mut EightArms) -> V {
        let drives = &self.row.drives[k];
        let all_same = all_equal(&indices);
        let first: V = at_places(&drives.compliance[0], &indices, all_same);
        let twisting = self.row.twisting[k];
        // The wind-up curves do not depend on the case, so they are loaded once for all cases.
        let curves = match twisting {
            Twisting::Segments => Curves::<V>::gather(drives, &indices, all_same),
            _ => Curves::line(first),
        };
        let mut largest = V::zero();
        for (c, _) in self.row.cases.iter().enumerate().filter(|(_, case)| case.judged) {
            let Some(joint) = self.joint(c, k) else { continue };
            let lanes = &mut arms.cases[c];
            let torque_nm = V::load(&lanes.torque_at[k]);
            let (angle, compliance) = match twisting {
                Twisting::AtRest => (V::zero(), first),
                Twisting::Line => (torque_nm * first, first),
                Twisting::Segments => curves.windup(torque_nm),
                Twisting::Play => self.each_by_itself(k, indices, torque_nm),
            };
            if twisting != Twisting::AtRest {
                for i in (0..3).filter(|&i| joint.tip_m_per_rad[i] != 0.0) {
                    add(&mut lanes.tip_m[i], V::splat(joint.tip_m_per_rad[i]) * angle);
                }
            }
            lanes.compliance[k] = compliance.store();
            largest = largest.max(compliance * V::load(&lanes.inertia_at[k]));
        }
        largest
    }

    /// Adds the tip displacement that the bending of the given tube in inner slot `k` causes. Returns, for each arm,
    /// the largest term that one end coordinate of the tube (one motion of its end) adds to Dunkerley's sums \[s²\].
    #[inline(always)]
    fn add_tube<V: Lanes>(&self, k: usize, arms: &mut EightArms) -> V {
        let mut largest = V::zero();
        for (c, case) in self.row.cases.iter().enumerate().filter(|(_, case)| case.judged) {
            let StationSlot::Link { options, .. } = &self.station(c).slots[self.row.first + k] else {
                continue;
            };
            let (tube, lanes) = (&options[0], &mut arms.cases[c]);
            for hinge in self.row.hinges.iter().filter(|hinge| hinge.slot == k) {
                let Some(g) = hinge.end else { continue };
                let mut bent = V::splat(tube.own_weight_end[g]);
                if case.turned[hinge.number] {
                    bent = bent + V::load(&lanes.torque_at[hinge.number]);
                }
                for i in (0..3).filter(|&i| tube.tip[(i, g)] != 0.0) {
                    add(&mut lanes.tip_m[i], V::splat(tube.tip[(i, g)]) * bent);
                }
                largest = largest.max(V::load(&lanes.inertia_at[hinge.number]));
            }
        }
        largest
    }

    /// Computes Dunkerley's sum for each case and block of the eigenvalue problem \[s²\]: the trace of flexibility
    /// matrix times mass matrix, which equals the sum of `1/λ` over the eigenvalues.
    #[inline(always)]
    fn sum_traces<V: Lanes>(&self, begun: &Begun, arms: &mut EightArms) {
        for (c, case) in self.row.cases.iter().enumerate().filter(|(_, case)| case.judged) {
            let lanes = &mut arms.cases[c];
            for b in 0..2 {
                let mut sum = V::splat(self.from.stations[c].trace_s2[b]);
                if let Some(chunk) = self.row.chunks.get(self.chunk).filter(|_| case.links_are_compliant) {
                    let own = &chunk.cases[c];
                    sum = sum + V::load(&own.trace_s2[b]);
                    for e in case.spread_of[b].clone() {
                        sum = sum + V::splat(begun.cases[c].spread[e]) * V::load(&own.spread[e]);
                    }
                }
                sum = sum + V::splat(case.tubes_trace_s2[b]);
                for hinge in &self.row.hinges {
                    let inertia = V::load(&lanes.inertia_at[hinge.number]);
                    match (&self.station(c).slots[self.row.first + hinge.slot], hinge.end) {
                        (StationSlot::Joint(joint), _) if joint.block == b => {
                            sum = sum + V::load(&lanes.compliance[hinge.slot]) * inertia;
                        }
                        // An end coordinate has unit stiffness, so its compliance is 1.
                        (StationSlot::Link { options, .. }, Some(end)) if options[0].block[end] == b => {
                            sum = sum + inertia;
                        }
                        _ => {}
                    }
                }
                lanes.trace_s2[b] = sum.store();
            }
        }
    }

    /// Angle \[rad\] and tangent compliance \[rad/(N m)\] of the joints in inner slot `k`, which have play or friction,
    /// under `torque_nm`. They are computed one arm at a time, because laws with play are not written for eight at
    /// once.
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

    /// The joint in inner slot `k` in a case; `None` if the slot is not a joint.
    #[inline(always)]
    fn joint(&self, case: usize, k: usize) -> Option<&StationJoint> {
        match &self.station(case).slots[self.row.first + k] {
            StationSlot::Joint(joint) => Some(joint),
            _ => None,
        }
    }
}

/// Adds the eight numbers `more` to the eight numbers `to` in memory.
#[inline(always)]
fn add<V: Lanes>(to: &mut Eight, more: V) {
    *to = (V::load(to) + more).store();
}

/// Whether all eight arms have the same drive. This is frequent, because the drives of neighbouring designs are
/// similar, and one load from memory is faster than eight.
#[inline(always)]
fn all_equal(indices: &[usize; LANES]) -> bool {
    indices.iter().all(|index| *index == indices[0])
}

/// The entries of `list` at the eight indices `at`. `all_same` tells that these are equal.
#[inline(always)]
fn at_places<V: Lanes>(list: &[f64], at: &[usize; LANES], all_same: bool) -> V {
    if all_same { V::splat(list[at[0]]) } else { V::gather(list, at) }
}

/// Square of the ratio of von Mises stress (bending, axial force and torsion) to strength, for eight links. `per` has
/// the ratio per unit of each load. The loads are axial force \[N\], torsion and the two bending moments \[N m\].
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

/// The torsion curves of eight gears, each with three segments.
struct Curves<V> {
    /// Compliance of each segment \[rad/(N m)\].
    compliance: [V; 3],
    /// Torques at which the first and the second segment end \[N m\].
    ends_nm: [V; 2],
    /// Whether modes use the compliance of the first segment at every torque.
    first_in_modes: bool,
}

impl<V: Lanes> Curves<V> {
    /// Curves with a single slope, for drives that need only one.
    #[inline(always)]
    fn line(compliance: V) -> Self {
        Self { compliance: [compliance; 3], ends_nm: [V::zero(); 2], first_in_modes: true }
    }

    /// The torsion curves of the drives with the eight indices `at`. `all_same` says that the indices are equal.
    #[inline(always)]
    fn gather(of: &DriveAttributes, at: &[usize; LANES], all_same: bool) -> Self {
        let zero = V::zero();
        let mut curves =
            Self { compliance: [zero; 3], ends_nm: [zero; 2], first_in_modes: of.first_in_modes };
        for segment in 0..3 {
            curves.compliance[segment] = at_places(&of.compliance[segment], at, all_same);
        }
        for end in 0..2 {
            curves.ends_nm[end] = at_places(&of.ends_nm[end], at, all_same);
        }
        curves
    }

    /// Angle \[rad\] of eight gears under `torque_nm`, and their compliance in modes \[rad/(N m)\]. Every segment is
    /// computed and then selected, because the eight lanes cannot branch separately.
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
