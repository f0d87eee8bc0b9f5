//! An arm as a tree of designs.
//!
//! The arm is built from the tip to the base. Each joint is sized when everything outboard of it is known (Eqs 7-12 of
//! docs/model.md). Every piece that is added changes the wrench, the inertia and the displacement of the tip (Eqs
//! 13-16). A partial arm therefore has all the data that the next pieces need.

use super::attributes::OptionAttributes;
use super::bearing_loads::BearingLoads;
use super::design_space::{DesignSpace, LinkOption, SpacePiece};
use super::effects::Layer;
use super::fit::RoomAtJoint;
use super::full_model::full_objectives;
use super::group::Group;
use super::joints::TabulatedJoints;
use super::levels::OutwardIn;
pub(crate) use super::slot::SizedJoint;
pub(crate) use super::slot::Slot;
use super::slot::{choice_slot, link_slot};
use super::state::StationState;
use super::station::{Block, BlockSlot, Modal, Station, StationSlot, reaches_m};
use crate::arm::joint_law::{Curve, JointLaw};
use crate::arm::{Link, LinkBody};
use crate::catalog::Catalogs;
use crate::mechanics::Wrench;
use crate::mechanics::lanes::LANES;
use crate::mechanics::lowest::{Step, frequency_hz, lowest_eigenvalue};
use crate::pareto::objectives::Objectives;
use crate::sizing::demand::{JointDemand, JointMotion, linear_torque_nm};
use crate::sizing::fit::LinkRoom;
use nalgebra::Vector3;

/// A design space as the search uses it, with tables of all drives and with stations for all cases.
///
/// `ArmProblem` implements [`OutwardIn`], the tree of designs that a search evaluates. It can also give the
/// [parts](ArmProblem::parts) and the [arm](ArmProblem::arm) of one design. [`DesignSpace`] has an example.
pub struct ArmProblem<'c> {
    space: &'c DesignSpace,
    /// The slots of the arm, which are the pieces that the search adds, one in each step, tip first.
    slots: Vec<Slot<'c>>,
    /// Slot of each piece, base to tip. The effects of a piece may have further slots.
    piece_slots: Vec<usize>,
    /// Slot of each level, tip first.
    level_slots: Vec<usize>,
    /// Number of options of each level, tip first.
    level_sizes: Vec<u32>,
    /// The row level: the level whose options are evaluated together.
    row_level: usize,
    /// The station of each case, in the order of the design space.
    stations: Vec<Station>,
    /// Number of materials. Each material has a front of its own.
    materials: usize,
    /// Ratio of the stress at peak load to the stress at rest.
    peak_factor: f64,
    /// The data from which the loads on output bearings are computed.
    bearing_loads: BearingLoads,
    /// For each slot, the room that the link of its joint leaves for gear and motor; `None` where no limit refers to
    /// a link.
    rooms: Vec<Option<RoomAtJoint>>,
}

/// A partial arm: everything from the tip to the next level.
#[derive(Debug, Clone, Default)]
pub struct Partial {
    /// The slot (step in which the arm is built) that is added next.
    next_slot: usize,
    /// Demand on the joint in the next slot. The demand does not depend on the joint's own drive. `None` if the next
    /// slot is not a sized joint.
    pub(crate) next_demand: Option<JointDemand>,
    /// Mass of the partial arm \[kg\].
    pub(crate) mass_kg: f64,
    /// Cost of the material of the links in the partial arm \[EUR\]. Unknown costs count as 0.
    pub(crate) cost_eur: f64,
    /// The material that the chosen links of the partial arm have in common.
    pub(crate) group: Group,
    /// Largest ratio of stress to strength at peak load over the links of the partial arm whose strength is known.
    pub(crate) stress_ratio: f64,
    /// Option of each slot, tip first; 0 for slots that are not added yet.
    pub(crate) options: Vec<u32>,
    /// Mass of the drive in each slot \[kg\], tip first.
    pub(crate) masses_kg: Vec<f64>,
    /// The state of the arm in each case.
    pub(crate) stations: Vec<StationState>,
}

impl Partial {
    /// Option of each slot, tip first.
    pub(crate) fn slot_options(&self) -> &[u32] {
        &self.options
    }
}

impl<'c> ArmProblem<'c> {
    /// Makes the tables of drives from the catalogs and the stations of the cases.
    ///
    /// The work grows with the number of link options times the number of cases. A space can be reduced first
    /// ([`DesignSpace::excerpt`]).
    pub fn new(space: &'c DesignSpace, catalogs: &'c Catalogs) -> Self {
        Self::with_joints(space, &TabulatedJoints::new(space, catalogs))
    }

    /// Does the same as [`new`](Self::new), for joints whose drives are already in tables.
    pub(crate) fn with_joints(space: &'c DesignSpace, joints: &TabulatedJoints<'c>) -> Self {
        let sizing = space.sizing_cases.iter().map(|&i| &space.cases[i]);
        let reaches = reaches_m(space, sizing);
        let mut piece_slots = vec![0; space.pieces.len()];
        let mut slots: Vec<Slot> = Vec::new();
        for (piece, layer) in space.layers() {
            if let Layer::Piece(_) = layer {
                piece_slots[piece] = slots.len();
            }
            slots.push(match layer {
                Layer::Piece(SpacePiece::Joint(_) | SpacePiece::Prismatic(_)) => {
                    // The table has every joint of the space, so a slot is always found.
                    joints.slot(piece).unwrap_or(Slot::Offset { mass_kg: 0.0 })
                }
                Layer::Piece(SpacePiece::Link(link)) => link_slot(space, link),
                Layer::Piece(SpacePiece::Choice(choice)) => choice_slot(space, choice),
                Layer::Bearing(_) => Slot::bearing(piece_slots[piece], &slots),
                Layer::Motor(motor) => Slot::motor(piece_slots[motor.of], &slots),
                Layer::Extra(mass_kg) => Slot::Offset { mass_kg },
                Layer::Bodies(carried) => Slot::Offset { mass_kg: carried.mass_kg() },
                Layer::Tilt(tilt) => Slot::Given { law: tilt.law(), mass_kg: 0.0 },
                Layer::Guide(spring) => Slot::Given { law: spring.law(), mass_kg: 0.0 },
                // These layers have weight and inertia in the station, but no mass that counts in a design.
                Layer::Mass(_) | Layer::Travelling(_) | Layer::Springs(_) => Slot::Offset { mass_kg: 0.0 },
            });
        }
        let level_slots: Vec<usize> = (0..slots.len()).filter(|&i| slots[i].is_level()).collect();
        let level_sizes: Vec<u32> = level_slots.iter().map(|&i| slots[i].options()).collect();
        Self {
            space,
            row_level: row_level(&slots, &level_slots, &level_sizes),
            level_slots,
            level_sizes,
            stations: Station::all(space),
            materials: space.material_names().len(),
            peak_factor: space.peak_factor(),
            bearing_loads: BearingLoads::new(space, &slots, &piece_slots, &reaches),
            rooms: RoomAtJoint::all(&space.pieces, &piece_slots, slots.len()),
            slots,
            piece_slots,
        }
    }

    /// The design space.
    pub fn space(&self) -> &'c DesignSpace {
        self.space
    }

    /// The sized joint that is piece number `piece` (base to tip); `None` if the piece is not a joint or its drive is
    /// given.
    pub fn sized_joint(&self, piece: usize) -> Option<&SizedJoint<'c>> {
        match &self.slots[self.piece_slots[piece]] {
            Slot::Sized(sized) => Some(sized),
            _ => None,
        }
    }

    /// Smallest ratio of strength to stress of an arm at peak load; `None` if no strength is known.
    pub fn stress_safety_factor(&self, partial: &Partial) -> Option<f64> {
        (partial.stress_ratio > 0.0).then(|| 1.0 / partial.stress_ratio)
    }

    /// Cost of the material of the chosen links \[EUR\]; `None` if the cost of some material is unknown.
    pub fn material_cost_eur(&self, partial: &Partial) -> Option<f64> {
        let known = self.slots.iter().zip(&partial.options).all(|(slot, &option)| match slot {
            Slot::Link { options, open: true } => options[option as usize].cost_eur.is_some(),
            _ => true,
        });
        known.then_some(partial.cost_eur)
    }

    /// Largest wall slenderness over the tubes of an arm, chosen and given, as far as it is built; 0 if it has none.
    pub fn wall_slenderness(&self, partial: &Partial) -> f64 {
        let built =
            self.space.pieces.iter().zip(&self.piece_slots).filter(|(_, slot)| **slot < partial.next_slot);
        let of_piece = |(piece, slot): (&SpacePiece, &usize)| match piece {
            SpacePiece::Choice(choice) => choice.options[partial.options[*slot] as usize].wall_slenderness(),
            SpacePiece::Link(Link { body: LinkBody::Tube { material, section, .. }, .. }) => {
                LinkOption::given(*material, *section).wall_slenderness()
            }
            _ => 0.0,
        };
        built.map(of_piece).fold(0.0, f64::max)
    }

    /// Mass of a partial arm \[kg\].
    pub fn mass_kg(&self, partial: &Partial) -> f64 {
        partial.mass_kg
    }

    /// Option of every piece of a complete arm, base to tip. For a sized joint it is the index of its drive.
    pub fn options<'p>(&'p self, complete: &'p Partial) -> impl Iterator<Item = u32> + 'p {
        self.piece_slots.iter().map(|&slot| complete.options[slot])
    }

    /// Demand on the joint in `slot` over the sizing cases, in which drives and stresses are checked. `partial` is the
    /// arm outboard of the joint.
    pub fn demand_at(&self, partial: &Partial, slot: usize) -> JointDemand {
        self.demand(partial, slot, self.slots[slot].motion())
    }

    /// Builds the design with these options, one for each level, tip first. Before each piece is added, the function
    /// calls `see` with the slot of the piece and the arm outboard of it.
    ///
    /// # Errors
    /// The slot at which the design breaks a limit.
    pub fn walk(&self, options: &[u32], mut see: impl FnMut(usize, &Partial)) -> Result<Partial, usize> {
        let mut partial = self.empty();
        let mut levels = options.iter();
        while partial.next_slot < self.slots.len() {
            let slot = partial.next_slot;
            if self.piece_slots.contains(&slot) {
                see(slot, &partial);
            }
            let option = if self.slots[slot].is_level() { levels.next().copied().unwrap_or(0) } else { 0 };
            if !self.add(slot, option, &mut partial) {
                return Err(slot);
            }
        }
        Ok(partial)
    }

    /// The arm with these `options`, one for each slot. For a sized joint the option is the index of its drive. This
    /// drive is taken even where first fit (the lightest drive that meets the demand) would take another drive. `None`
    /// if the arm breaks a limit.
    pub(crate) fn assemble(&self, options: &[u32]) -> Option<Partial> {
        let mut partial = self.empty();
        let mut adds = |(slot, &option): (usize, &u32)| match &self.slots[slot] {
            Slot::Sized(sized) => {
                let demand = self.demand(&partial, slot, Some(sized.table.motion()));
                let index = option as usize;
                sized.table.holds(index, &demand) && self.add_drive(slot, sized, index, &mut partial)
            }
            _ => self.add(slot, option, &mut partial),
        };
        options.iter().enumerate().all(&mut adds).then_some(partial)
    }

    /// Number of the piece (base to tip) in a slot (numbered tip first); 0 if the slot belongs to an effect.
    pub fn piece_of_slot(&self, slot: usize) -> usize {
        self.piece_slots.iter().position(|&s| s == slot).unwrap_or_default()
    }

    /// The piece of the chain in a slot; `None` if the slot belongs to an effect.
    pub(crate) fn piece_in_slot(&self, slot: usize) -> Option<&'c SpacePiece> {
        self.piece_slots.iter().position(|&s| s == slot).map(|piece| &self.space.pieces[piece])
    }

    pub(crate) fn slots(&self) -> &[Slot<'c>] {
        &self.slots
    }

    pub(crate) fn level_slots(&self) -> &[usize] {
        &self.level_slots
    }

    pub(crate) fn level_sizes_slice(&self) -> &[u32] {
        &self.level_sizes
    }

    /// Slot of the row level; `None` if the space has no level.
    pub(crate) fn row_slot(&self) -> Option<usize> {
        self.level_slots.get(self.row_level).copied()
    }

    pub(crate) fn stations(&self) -> &[Station] {
        &self.stations
    }

    pub(crate) fn bearing_loads(&self) -> &BearingLoads {
        &self.bearing_loads
    }

    pub(crate) fn rooms(&self) -> &[Option<RoomAtJoint>] {
        &self.rooms
    }

    pub(crate) fn peak_factor(&self) -> f64 {
        self.peak_factor
    }

    pub(crate) fn empty(&self) -> Partial {
        Partial {
            options: vec![0; self.slots.len()],
            masses_kg: vec![0.0; self.slots.len()],
            stations: self
                .stations
                .iter()
                .map(|station| StationState {
                    wrench: station.start_wrench,
                    inertia: station.start_inertia,
                    tip_m: Vector3::zeros(),
                    trace_s2: [0.0; 2],
                    compliances: vec![0.0; self.slots.len()],
                    ramps: match self.bearing_loads.any() {
                        true => vec![Wrench::zeros(); self.bearing_loads.movers.len()],
                        false => Vec::new(),
                    },
                    passive: Vec::new(),
                })
                .collect(),
            ..Partial::default()
        }
    }

    /// Adds the slots inboard of `partial` in which nothing is chosen, up to the next level. Returns `false` if the arm
    /// breaks a limit with one of them.
    fn advance(&self, partial: &mut Partial) -> bool {
        while partial.next_slot < self.slots.len() && !self.slots[partial.next_slot].is_level() {
            if !self.add(partial.next_slot, 0, partial) {
                return false;
            }
        }
        partial.next_demand = match self.slots.get(partial.next_slot) {
            Some(Slot::Sized(sized)) => {
                Some(self.demand(partial, partial.next_slot, Some(sized.table.motion())))
            }
            _ => None,
        };
        true
    }

    /// Adds the next slot, `slot`, with an option, to the arm `to`. Returns `false` if the arm then breaks a limit.
    pub(super) fn add(&self, slot: usize, option: u32, to: &mut Partial) -> bool {
        to.next_slot = slot + 1;
        to.options[slot] = option;
        let added = match &self.slots[slot] {
            Slot::Given { law, mass_kg } => self.add_joint(slot, law, *mass_kg, to),
            Slot::Sized(sized) => self.add_sized(slot, sized, option, to),
            Slot::Bearing { joint, laws } => {
                to.options[slot] = to.options[*joint];
                self.add_joint(slot, &laws[to.options[slot] as usize], 0.0, to)
            }
            Slot::Motor { joint, masses_kg } => {
                to.options[slot] = to.options[*joint];
                self.add_joint(slot, &JointLaw::from(Curve::Rigid), masses_kg[to.options[slot] as usize], to)
            }
            Slot::Link { options, .. } => self.add_link(slot, option, &options[option as usize], to),
            Slot::Offset { mass_kg } => self.add_offset(slot, *mass_kg, to),
        };
        // No slot reduces the mass, so the limit on mass can be checked after each slot.
        added && self.space.constraints.mass_max_kg.is_none_or(|max| to.mass_kg <= max)
    }

    fn add_sized(&self, slot: usize, sized: &SizedJoint, option: u32, to: &mut Partial) -> bool {
        let demand =
            to.next_demand.take().unwrap_or_else(|| self.demand(to, slot, Some(sized.table.motion())));
        let index = match sized.all_fits {
            true => Some(option as usize).filter(|&i| sized.table.holds(i, &demand)),
            false => sized.table.first_fit(&demand),
        };
        index.is_some_and(|index| self.add_drive(slot, sized, index, to))
    }

    /// Adds the drive `index` to the joint in `slot`; it is known to meet the demand. The index is stored as the option
    /// of the slot even where first fit chose it, so that the parts of the arm can be read later.
    pub(super) fn add_drive(&self, slot: usize, sized: &SizedJoint, index: usize, to: &mut Partial) -> bool {
        to.options[slot] = index as u32;
        self.add_joint(slot, &sized.laws[index], sized.table.mass_kg(index) - sized.away_kg[index], to)
    }

    /// Demand on a joint over the sizing cases. It is made of the largest static torque (Eq 7, plus torque that acts on
    /// the joint in addition to weight and load) and of the largest inertia outboard. The motion turns both into
    /// torques (Eqs 8-12). The largest torque and the largest inertia may come from different cases, so the demand is
    /// on the safe side. As in the paper, Eq 8 uses the torque of weight and load alone: a counterbalance does not
    /// reduce the mass that is accelerated.
    pub(crate) fn demand(
        &self,
        outboard: &Partial,
        slot: usize,
        motion: Option<&JointMotion>,
    ) -> JointDemand {
        self.demand_in(&self.space.sizing_cases, outboard, slot, motion)
    }

    /// Demand on the joint in `slot` over the given cases, made in the same way as by [`demand`](Self::demand).
    pub(super) fn demand_in(
        &self,
        cases: &[usize],
        outboard: &Partial,
        slot: usize,
        motion: Option<&JointMotion>,
    ) -> JointDemand {
        let (mut static_nm, mut load_nm, mut inertia_kgm2) = (0.0f64, 0.0f64, 0.0f64);
        for &case in cases {
            let StationSlot::Joint(joint) = &self.stations[case].slots[slot] else { continue };
            let state = &outboard.stations[case];
            static_nm = static_nm.max(state.torque_nm(joint).abs());
            load_nm = load_nm.max(state.load_torque_nm(joint).abs());
            inertia_kgm2 = inertia_kgm2.max(state.inertia_about(slot, joint));
        }
        let still = self.space.motion.joint_motion(0.0, None);
        let motion = motion.unwrap_or(&still);
        let torques = motion.demand_of_torques(static_nm, linear_torque_nm(motion, load_nm, inertia_kgm2));
        let room = self.rooms[slot].as_ref().map_or(LinkRoom::ANY, |room| room.of(&outboard.options));
        let bearing = self.bearing_demand(cases, &outboard.stations, &outboard.options, slot);
        torques.with_bearing(bearing).with_room(room)
    }

    /// Adds the joint in `slot` with the joint law `law` and a drive of the mass `mass_kg` to the state of every case.
    /// It always returns `true`: a sized drive was checked before, and a given drive excludes no design.
    fn add_joint(&self, slot: usize, law: &JointLaw, mass_kg: f64, to: &mut Partial) -> bool {
        to.mass_kg += mass_kg;
        to.masses_kg[slot] = mass_kg;
        self.keep_ramp(slot, &mut to.stations);
        for (station, state) in self.stations.iter().zip(&mut to.stations) {
            if let StationSlot::Joint(joint) = &station.slots[slot] {
                state.add_joint(slot, joint, law, mass_kg);
            }
        }
        true
    }

    fn add_offset(&self, slot: usize, mass_kg: f64, to: &mut Partial) -> bool {
        to.mass_kg += mass_kg;
        for (station, state) in self.stations.iter().zip(&mut to.stations) {
            if let StationSlot::Body { inertia, weight } = &station.slots[slot] {
                state.add_body(inertia, weight);
            }
        }
        true
    }

    fn add_link(&self, slot: usize, option: u32, link: &OptionAttributes, to: &mut Partial) -> bool {
        if link.slender {
            return false;
        }
        to.mass_kg += link.mass_kg;
        // If the study limits the cost, it has no material of unknown cost: such a study is refused when it is read.
        to.cost_eur += link.cost_eur.unwrap_or(0.0);
        to.group = to.group.with(link.material);
        if self.space.constraints.material_cost_max_eur.is_some_and(|max| to.cost_eur > max) {
            return false;
        }
        for (case, (station, state)) in self.stations.iter().zip(&mut to.stations).enumerate() {
            let StationSlot::Link { options, place, carried } = &station.slots[slot] else { continue };
            let outboard = state.wrench;
            state.add_link(&options[option as usize]);
            let Some(stress) = &link.stress else { continue };
            // In a sizing case the arm accelerates. In the other cases it is at rest.
            let factor = if self.space.sizing_cases.contains(&case) { self.peak_factor } else { 1.0 };
            let largest = stress.largest(place, carried, &outboard, &options[option as usize].weight);
            to.stress_ratio = to.stress_ratio.max(largest * factor);
        }
        self.space.constraints.stress_safety_factor_min.is_none_or(|least| to.stress_ratio * least <= 1.0)
    }

    /// The judged cases, which count for deflection and lowest mode: the station of each, and the state of a complete
    /// arm in it.
    fn judged<'s>(
        &'s self,
        complete: &'s Partial,
    ) -> impl Iterator<Item = (&'s Station, &'s StationState)> + Clone {
        self.space.judged_cases.iter().map(|&i| (&self.stations[i], &complete.stations[i]))
    }
}

/// Selects the row level, whose options are evaluated eight at a time. It is the level of the innermost link, or the
/// innermost level if this link has fewer than eight options and fewer options than the innermost level. The drives
/// inboard of the row level are the same for a whole row.
fn row_level(slots: &[Slot], level_slots: &[usize], level_sizes: &[u32]) -> usize {
    let innermost = level_slots.len().saturating_sub(1);
    let link = level_slots.iter().rposition(|&slot| matches!(slots[slot], Slot::Link { .. }));
    link.filter(|&link| level_sizes[link] as usize >= LANES || level_sizes[link] >= level_sizes[innermost])
        .unwrap_or(innermost)
}

/// Objectives of the arm `complete`. `judged` are the judged cases: the station of each, and the state of the arm in
/// it.
pub(crate) fn objectives_over<'s>(
    judged: impl Iterator<Item = (&'s Station, &'s StationState)> + Clone,
    complete: &Partial,
) -> Objectives {
    let tip_deflection_m = judged.clone().map(|(_, s)| s.tip_m.norm()).fold(0.0, f64::max);
    let lowest_mode_hz = lowest_mode_hz(judged, complete);
    Objectives { tip_deflection_m, mass_kg: complete.mass_kg, lowest_mode_hz }
}

/// Smallest lowest natural frequency \[Hz\] of the arm `complete` over the cases `judged`.
fn lowest_mode_hz<'s>(
    judged: impl Iterator<Item = (&'s Station, &'s StationState)>,
    complete: &Partial,
) -> f64 {
    let lowest = judged
        .map(|(station, state)| match &station.modal {
            Modal::Planar(blocks) => {
                let [within, across] = &**blocks;
                block_eigenvalue(within, complete, state, state.trace_s2[0]).min(block_eigenvalue(
                    across,
                    complete,
                    state,
                    state.trace_s2[1],
                ))
            }
            Modal::Spatial(block) => block_eigenvalue(block, complete, state, state.trace_s2[0]),
        })
        .fold(f64::INFINITY, f64::min);
    frequency_hz(lowest)
}

fn block_eigenvalue<const N: usize>(
    block: &Block<N>,
    complete: &Partial,
    state: &StationState,
    trace_s2: f64,
) -> f64 {
    let steps: Vec<Step<N>> = block_steps(block, complete, state, block.slots.len()).collect();
    lowest_eigenvalue(&steps, trace_s2)
}

/// The steps in which the lowest mode of a block is computed, tip first: the payload and the first `slots` slots of
/// the arm. A block is a set of motions that do not couple with others. Slots with neither compliance nor mass are
/// left out.
pub(crate) fn block_steps<'a, const N: usize>(
    block: &'a Block<N>,
    arm: &'a Partial,
    state: &'a StationState,
    slots: usize,
) -> impl Iterator<Item = Step<'a, N>> {
    let steps = block.slots[..slots].iter().enumerate().flat_map(|(slot, piece)| match piece {
        BlockSlot::Joint { twist, inertia_per_kg } => {
            let is_compliant = state.compliances[slot] > 0.0 && twist.amax() > 0.0;
            let weighs = arm.masses_kg[slot] > 0.0;
            [
                is_compliant.then_some(Step::Joint(twist, state.compliances[slot])),
                weighs.then_some(Step::Body(arm.masses_kg[slot], inertia_per_kg)),
            ]
        }
        BlockSlot::Body(inertia) => [Some(Step::Body(1.0, inertia)), None],
        BlockSlot::Links(options) => [Some(Step::Link(&options[arm.options[slot] as usize])), None],
    });
    std::iter::once(Step::Body(1.0, &block.payload)).chain(steps.flatten())
}

impl OutwardIn for ArmProblem<'_> {
    type Partial = Partial;

    fn level_sizes(&self) -> &[u32] {
        &self.level_sizes
    }

    fn row_level(&self) -> usize {
        self.row_level
    }

    fn root(&self) -> Option<Partial> {
        let mut partial = self.empty();
        self.advance(&mut partial).then_some(partial)
    }

    fn extend(&self, level: usize, option: u32, from: &Partial, to: &mut Partial) -> bool {
        to.clone_from(from);
        self.add(self.level_slots[level], option, to) && self.advance(to)
    }

    fn objectives(&self, complete: &Partial) -> Option<Objectives> {
        // The fast computation of the lowest mode does not know linkages, nor masses that depend on the drive of
        // another joint.
        if self.space.has_linkages() || self.space.has_motors_elsewhere() {
            return Some(full_objectives(&self.arm_of(complete)?, &self.load_cases()));
        }
        Some(objectives_over(self.judged(complete), complete))
    }

    fn groups(&self) -> usize {
        self.materials
    }

    fn group(&self, complete: &Partial) -> Option<usize> {
        complete.group.material()
    }
}
