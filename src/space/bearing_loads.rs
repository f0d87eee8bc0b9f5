//! What loads output bearings, apart from the masses: where links attach, how joints move, and which components of a wrench
//! a bearing feels.

use super::design_space::{DesignSpace, SpaceJoint, SpacePiece};
use super::slot::Slot;
use super::station::StationJoint;
use crate::arm::bearing::BearingSource;
use crate::arm::section::Section;
use crate::arm::{Bearing, Element, Link, LinkBody};
use crate::catalog::gear::GearMass;
use crate::mechanics::beam::section_frame;
use crate::mechanics::chain::across;
use crate::mechanics::{Wrench, angular, linear};
use crate::sizing::bearing::BearingLimits;
use nalgebra::Vector3;

/// What is needed to load the bearings of a space, apart from the pose.
pub(crate) struct BearingLoads {
    /// The joints of the chain, tip first.
    pub movers: Vec<Mover>,
    /// Where the link attaches to the joint in each slot; `None` if it has no bearing.
    pub levers: Vec<Option<Lever>>,
    /// Whether the bearing in each slot can exclude a design. One whose ratings are unknown cannot.
    pub checked: Vec<bool>,
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
        let half_m =
            |vector_m: &Vector3<f64>, section: &Section| half_width_m(&joint.axis, vector_m, section);
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

/// The bearing of a joint of an arm with its lever resolved: the offset of the flange, and half the extent of the link that is
/// next to the joint.
pub(crate) fn resolved(bearing: Bearing, axis: &Vector3<f64>, next: Option<&Element>) -> Bearing {
    let half_m = match next {
        Some(Element::Link(Link { vector_m, body: LinkBody::Tube { section, .. }, .. })) => {
            half_width_m(axis, vector_m, section)
        }
        _ => 0.0,
    };
    let lever_m = bearing.ratings.offset_m.unwrap_or_default() + half_m;
    Bearing { offset_m: bearing.offset_m.or(Some(lever_m)), ..bearing }
}

/// Half the extent of a link along the axis of the joint that carries it \[m\].
fn half_width_m(axis: &Vector3<f64>, vector_m: &Vector3<f64>, section: &Section) -> f64 {
    let along = section_frame(vector_m).tr_mul(axis);
    let (width_m, height_m) = section.outer_m();
    // exact for a box seen along one of its sides, and for a round tube that is not oblique
    libm::hypot(width_m / 2.0 * along.y, height_m / 2.0 * along.z)
}

impl BearingLoads {
    /// The loads of a space whose slots are known. `reaches_m` are in order from the base.
    pub(crate) fn new(space: &DesignSpace, slots: &[Slot], piece_slots: &[usize], reaches_m: &[f64]) -> Self {
        let mut levers: Vec<Option<Lever>> = slots.iter().map(|_| None).collect();
        let mut checked = vec![false; slots.len()];
        let mut movers = Vec::new();
        let mut reaches_m = reaches_m.iter();
        for (piece, what) in space.pieces.iter().enumerate() {
            let SpacePiece::Joint(joint) = what else { continue };
            let slot = piece_slots[piece];
            let reach_m = reaches_m.next().copied().unwrap_or_default();
            let motion = joint.motion(&space.motion, reach_m);
            // a passive joint moves with its drivers
            if joint.coupled.is_none() {
                movers.push(Mover { slot, acceleration_rad_s2: motion.acceleration_rad_s2 });
            }
            if has_bearing(&slots[slot], joint) {
                levers[slot] = Some(Lever::new(space, piece, joint, piece_slots));
                checked[slot] = is_checked(&slots[slot], joint);
            }
        }
        movers.reverse();
        Self { movers, levers, checked, stop_factor: space.motion.stop_factor() }
    }

    /// Whether some joint has a bearing.
    pub(crate) fn any(&self) -> bool {
        self.levers.iter().any(Option::is_some)
    }
}

/// Whether a joint has an output bearing, rated or not.
fn has_bearing(slot: &Slot, joint: &SpaceJoint) -> bool {
    match (slot, joint.bearing) {
        (Slot::Sized(sized), BearingSource::OfGear) => sized.table.gear_mass() == GearMass::HousedUnit,
        _ => joint.bearing.stated().is_some(),
    }
}

/// Whether the bearing of a joint can limit what it carries.
fn is_checked(slot: &Slot, joint: &SpaceJoint) -> bool {
    match slot {
        Slot::Sized(sized) => {
            (0..sized.table.len()).any(|i| sized.table.limits(i).bearing != BearingLimits::NONE)
        }
        // the thresholds of a rating that is known are finite at any speed and life
        _ => BearingLimits::of(joint.bearing.stated().as_ref(), 1.0, 1.0) != BearingLimits::NONE,
    }
}

/// What a bearing feels of a wrench: force along two axes across the joint's axis and along the axis \[N\], and moment
/// about the two axes across \[N m\].
pub(crate) type Components = [f64; 5];

/// The bearing of a joint in a pose: it takes the components of wrenches about the world's origin.
pub(crate) struct PosedBearing {
    at_m: Vector3<f64>,
    /// Two axes across the joint's axis, and the axis.
    axes: [Vector3<f64>; 3],
}

impl PosedBearing {
    /// The bearing of a joint.
    pub(crate) fn new(joint: &StationJoint) -> Self {
        let axis = angular(&joint.twist);
        let [u, v] = across(&axis);
        Self { at_m: joint.at_m, axes: [u, v, axis] }
    }

    /// Components of a wrench.
    pub(crate) fn components(&self, wrench: &Wrench) -> Components {
        let force_n = linear(wrench);
        let moment_nm = angular(wrench) - self.at_m.cross(&force_n);
        let [u, v, axis] = &self.axes;
        [force_n.dot(u), force_n.dot(v), force_n.dot(axis), moment_nm.dot(u), moment_nm.dot(v)]
    }
}
