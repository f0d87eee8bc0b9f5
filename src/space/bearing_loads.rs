//! Loads on output bearings, from the masses outboard of a joint.
//!
//! A bearing carries the force and the moment of everything outboard: of gravity and load, and of the ramp or the stop of
//! one joint while the others are at rest. A joint *outboard* of the bearing moves only what is outboard of itself; the
//! joint of the bearing and those *inboard* of it move everything outboard of the bearing. In this way the stop of a
//! shoulder tilts the bearing of the waist below it.
//!
//! Forces are added as vectors before their norms are taken. A lever along the axis, to where the link attaches, adds
//! lever times radial force to the moment, as in the vendor's `M = F_r (L_r + R) + F_a L_a`.

use super::design_space::{DesignSpace, SpaceJoint, SpacePiece};
use super::problem::{ArmProblem, StationState};
use super::slot::Slot;
use super::station::{StationJoint, StationSlot};
use crate::arm::section::Section;
use crate::arm::{Link, LinkBody};
use crate::mechanics::beam::section_frame;
use crate::mechanics::{Wrench, angular, linear};
use crate::sizing::bearing::{BearingDemand, BearingLimits, BearingLoad};
use nalgebra::Vector3;

/// What is needed to load the bearings of a space, apart from the pose.
pub(crate) struct BearingLoads {
    /// The joints of the chain, tip first.
    pub movers: Vec<Mover>,
    /// Where the link attaches to the joint in each slot; `None` if its bearing is not checked.
    pub levers: Vec<Option<Lever>>,
    /// Ratio of emergency deceleration to acceleration.
    pub stop_factor: f64,
}

/// A joint that moves while the others are at rest.
pub(crate) struct Mover {
    pub slot: usize,
    /// Acceleration of the joint in a ramp \[rad/s²\].
    pub acceleration_rad_s2: f64,
}

/// Lever along the axis of a joint from the face of its flange to where the link attaches.
pub(crate) struct Lever {
    /// Slot of the link.
    pub link_slot: Option<usize>,
    /// Lever \[m\] by the option of the link; a single one if the study states it.
    pub lever_m: Vec<f64>,
}

impl Lever {
    /// The lever with the options of an arm \[m\].
    pub(crate) fn lever_m(&self, options: &[u32]) -> f64 {
        self.link_slot.map_or(self.lever_m[0], |slot| self.lever_m[options[slot] as usize])
    }

    /// A joint whose link attaches at a stated offset, or at half the width of the link that is next to it.
    pub(crate) fn new(space: &DesignSpace, piece: usize, joint: &SpaceJoint, piece_slots: &[usize]) -> Self {
        let half_m = |vector_m: &Vector3<f64>, section: &Section| half_width_m(joint, vector_m, section);
        if let Some(offset_m) = joint.bearing.stated().and_then(|bearing| bearing.offset_m) {
            return Self { link_slot: None, lever_m: vec![offset_m.abs()] };
        }
        let link_slot = piece_slots.get(piece + 1).copied();
        match space.pieces.get(piece + 1) {
            Some(SpacePiece::Choice(choice)) => {
                let options = choice.options.iter();
                let lever_m = options.map(|option| half_m(&choice.vector_m, &option.section)).collect();
                Self { link_slot, lever_m }
            }
            Some(SpacePiece::Link(Link { vector_m, body: LinkBody::Tube { section, .. }, .. })) => {
                Self { link_slot, lever_m: vec![half_m(vector_m, section)] }
            }
            // forces act where the geometry of the chain says
            _ => Self { link_slot: None, lever_m: vec![0.0] },
        }
    }
}

/// Half the extent of a link along the axis of the joint that carries it \[m\].
fn half_width_m(joint: &SpaceJoint, vector_m: &Vector3<f64>, section: &Section) -> f64 {
    let along = section_frame(vector_m).tr_mul(&joint.axis);
    let (width_m, height_m) = section.outer_m();
    // exact for a box seen along one of its sides, and for a round tube that is not oblique
    (width_m / 2.0 * along.y).hypot(height_m / 2.0 * along.z)
}

impl BearingLoads {
    /// The loads of a space whose slots are known. `reaches_m` are in order from the base.
    pub(crate) fn new(space: &DesignSpace, slots: &[Slot], piece_slots: &[usize], reaches_m: &[f64]) -> Self {
        let mut levers: Vec<Option<Lever>> = slots.iter().map(|_| None).collect();
        let mut movers = Vec::new();
        let mut reaches_m = reaches_m.iter();
        for (piece, what) in space.pieces.iter().enumerate() {
            let SpacePiece::Joint(joint) = what else { continue };
            let slot = piece_slots[piece];
            let reach_m = reaches_m.next().copied().unwrap_or_default();
            let motion = space.motion.joint_motion(reach_m, joint.max_speed_rad_s);
            movers.push(Mover { slot, acceleration_rad_s2: motion.acceleration_rad_s2 });
            if is_checked(&slots[slot], joint) {
                levers[slot] = Some(Lever::new(space, piece, joint, piece_slots));
            }
        }
        movers.reverse();
        Self { movers, levers, stop_factor: space.motion.stop_factor() }
    }

    /// Whether some bearing is checked.
    pub(crate) fn any(&self) -> bool {
        self.levers.iter().any(Option::is_some)
    }
}

/// Whether the bearing of a joint can limit what it carries.
fn is_checked(slot: &Slot, joint: &SpaceJoint) -> bool {
    match slot {
        Slot::Sized(sized) => {
            (0..sized.table.len()).any(|i| sized.table.limits(i).bearing != BearingLimits::NONE)
        }
        _ => joint.bearing.stated().is_some_and(|bearing| bearing.permissible_moment_nm.is_some()),
    }
}

impl StationJoint {
    /// The load of a wrench (about the world's origin) on the face of the bearing.
    pub(crate) fn bearing_load(&self, wrench: &Wrench) -> BearingLoad {
        let axis = angular(&self.twist);
        let force_n = linear(wrench);
        let moment_nm = angular(wrench) - self.at_m.cross(&force_n);
        let along_n = force_n.dot(&axis);
        BearingLoad {
            moment_nm: (moment_nm - axis * moment_nm.dot(&axis)).norm(),
            radial_n: (force_n - axis * along_n).norm(),
            axial_n: along_n.abs(),
        }
    }
}

impl ArmProblem<'_> {
    /// Loads on the bearing of the joint in a slot, when an arm of these states and options is everything outboard of it;
    /// zero if the bearing is not checked.
    pub(crate) fn bearing_demand(
        &self,
        states: &[StationState],
        options: &[u32],
        slot: usize,
    ) -> BearingDemand {
        let loads = self.bearing_loads();
        let Some(lever) = &loads.levers[slot] else { return BearingDemand::default() };
        let cases = self.space().sizing_cases.iter();
        let demands = cases.map(|&case| self.bearing_demand_in(case, &states[case], slot));
        demands.fold(BearingDemand::default(), BearingDemand::max).with_lever(lever.lever_m(options))
    }

    /// Loads at the face of the flange in one case.
    fn bearing_demand_in(&self, case: usize, state: &StationState, slot: usize) -> BearingDemand {
        let station = &self.stations()[case];
        let StationSlot::Joint(joint) = &station.slots[slot] else { return BearingDemand::default() };
        let loads = self.bearing_loads();
        let at_rest = joint.bearing_load(&state.wrench);
        let mut out = BearingDemand { at_rest, running: at_rest, in_stop: at_rest };
        for (k, mover) in loads.movers.iter().enumerate() {
            let ramp = match &station.slots[mover.slot] {
                _ if mover.slot < slot => state.ramps[k],
                StationSlot::Joint(moving) => state.inertia * moving.twist * mover.acceleration_rad_s2,
                _ => continue,
            };
            for sign in [1.0, -1.0] {
                let moving = |times: f64| joint.bearing_load(&(state.wrench + ramp * (sign * times)));
                out.running = out.running.max(moving(1.0));
                out.in_stop = out.in_stop.max(moving(loads.stop_factor));
            }
        }
        out
    }

    /// Keeps what the joint in a slot, which is about to be added, does to bearings inboard of it.
    pub(crate) fn keep_ramp(&self, slot: usize, states: &mut [StationState]) {
        let loads = self.bearing_loads();
        let Some(k) = loads.movers.iter().position(|mover| mover.slot == slot).filter(|_| loads.any()) else {
            return;
        };
        for &case in &self.space().sizing_cases {
            if let StationSlot::Joint(moving) = &self.stations()[case].slots[slot] {
                let state = &mut states[case];
                state.ramps[k] = state.inertia * moving.twist * loads.movers[k].acceleration_rad_s2;
            }
        }
    }
}
