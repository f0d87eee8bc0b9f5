//! Data from which the loads on output bearings follow, apart from the masses: where links attach, how joints
//! accelerate, and which components of a wrench load a bearing.

use super::design_space::{DesignSpace, SpaceJoint, SpacePiece};
use super::slot::Slot;
use super::station::StationJoint;
use crate::arm::bearing::BearingSource;
use crate::arm::section::Section;
use crate::arm::{Arm, Bearing, Element, Link, LinkBody};
use crate::catalog::gear::GearMass;
use crate::mechanics::across;
use crate::mechanics::beam::section_frame;
use crate::mechanics::statics::JointLoad;
use crate::mechanics::{Wrench, angular, linear};
use crate::sizing::bearing::{BearingLimits, BearingLoad};
use crate::sizing::demand::JointMotion;
use nalgebra::Vector3;

/// The data of a space that the loads on output bearings depend on, in addition to poses and masses.
pub(crate) struct BearingLoads {
    /// The joints of the chain that move by themselves, turning or sliding, tip first. A passive joint, which moves only
    /// together with its driving joints, is none of them.
    pub movers: Vec<Mover>,
    /// For each slot (piece of the arm, tip first), the lever of its joint: how far from the face of the flange the
    /// link attaches. `None` if the slot has no joint with a bearing.
    pub levers: Vec<Option<Lever>>,
    /// Whether the bearing in each slot can exclude a design. A bearing whose ratings are unknown cannot.
    pub checked: Vec<bool>,
}

/// A joint that accelerates while the other joints are at rest. For a prismatic joint (rail), metres take the place of
/// radians.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mover {
    /// Slot of the joint.
    pub slot: usize,
    /// Acceleration of the joint in normal operation \[rad/s²\].
    pub acceleration_rad_s2: f64,
    /// Ratio of the deceleration in the joint's emergency stop to `acceleration_rad_s2`, at least 1.
    pub stop_factor: f64,
}

impl Mover {
    /// The joint in `slot`, which moves as `motion` says.
    pub(crate) fn new(slot: usize, motion: &JointMotion) -> Self {
        Self { slot, acceleration_rad_s2: motion.acceleration_rad_s2, stop_factor: motion.stop.factor }
    }
}

/// The lever: the distance, along the axis of a joint, from the face of its flange to the point at which the link
/// attaches. A lever that the study states is measured from the bearing's centre instead.
pub(crate) struct Lever {
    /// Slot of the link on which the lever depends; `None` if the lever does not depend on a link.
    pub link_slot: Option<usize>,
    /// Lever \[m\] for each option of the link; a single entry if it does not depend on the option.
    pub lever_m: Vec<f64>,
}

impl Lever {
    /// The lever \[m\] if the arm has these `options`, one for each slot.
    pub(crate) fn lever_m(&self, options: &[u32]) -> f64 {
        self.link_slot.map_or(self.lever_m[0], |slot| self.lever_m[options[slot] as usize])
    }

    /// The lever of `joint`: the offset that the study states, or else half the width of the link next to the joint.
    /// It is zero if the next piece is not a tube. `piece` is the number of the joint in the chain, and `piece_slots`
    /// has the slot of each piece.
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
            // Without a tube next to the joint, the force acts at the point that the geometry of the chain gives, so
            // the lever is zero.
            _ => Self { link_slot: None, lever_m: vec![0.0] },
        }
    }
}

/// The bearing of a joint with its lever as a number: the distance from the bearing's centre to the point at which the
/// link attaches. If the arm states no lever, the lever is the distance from the centre to the face of the flange, plus
/// half the extent along the joint's `axis` of the next element, `next`.
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

/// The output bearings of an arm by the names of their joints, each with its lever as a number ([`resolved`]).
pub(crate) fn bearings_of(arm: &Arm) -> impl Iterator<Item = (&str, Bearing)> {
    arm.chain.iter().enumerate().filter_map(|(at, element)| {
        let Element::Joint(joint) = element else { return None };
        Some((joint.name.as_str(), resolved(joint.bearing?, &joint.axis, arm.chain.get(at + 1))))
    })
}

/// Load on a bearing whose lever is a number ([`resolved`]), with the moment taken at the bearing's centre. `load` is
/// the load on the joint, with the moment taken at the joint's position in the chain.
pub(crate) fn at_centre(load: &JointLoad, bearing: &Bearing) -> BearingLoad {
    let JointLoad { moment_nm, radial_n, axial_n } = *load;
    BearingLoad { moment_nm, radial_n, axial_n }.with_lever(bearing.offset_m.unwrap_or_default().abs())
}

/// Half the extent of a link along the axis of the joint to which it attaches \[m\].
fn half_width_m(axis: &Vector3<f64>, vector_m: &Vector3<f64>, section: &Section) -> f64 {
    let along = section_frame(vector_m).tr_mul(axis);
    let (width_m, height_m) = section.outer_m();
    // The result is exact for a rectangular section with one side at right angles to the axis, and for a round tube at
    // right angles to the axis.
    libm::hypot(width_m / 2.0 * along.y, height_m / 2.0 * along.z)
}

impl BearingLoads {
    /// Collects the levers and accelerations of a space. `piece_slots` has the slot of each piece, base to tip.
    /// `reaches_m` has, for each joint that turns, base to tip, the largest distance of the tip from its axis \[m\].
    pub(crate) fn new(space: &DesignSpace, slots: &[Slot], piece_slots: &[usize], reaches_m: &[f64]) -> Self {
        let mut levers: Vec<Option<Lever>> = slots.iter().map(|_| None).collect();
        let mut checked = vec![false; slots.len()];
        let mut movers = Vec::new();
        let mut reaches_m = reaches_m.iter();
        for (piece, what) in space.pieces.iter().enumerate() {
            let slot = piece_slots[piece];
            match what {
                SpacePiece::Joint(joint) => {
                    let reach_m = reaches_m.next().copied().unwrap_or_default();
                    if joint.coupled.is_none() {
                        movers.push(Mover::new(slot, &joint.motion(&space.motion, reach_m)));
                    }
                    if has_bearing(&slots[slot], joint) {
                        levers[slot] = Some(Lever::new(space, piece, joint, piece_slots));
                        checked[slot] = is_checked(&slots[slot], joint);
                    }
                }
                SpacePiece::Prismatic(rail) => movers.push(Mover::new(slot, &rail.motion(&space.motion))),
                SpacePiece::Link(_) | SpacePiece::Choice(_) => {}
            }
        }
        movers.reverse();
        Self { movers, levers, checked }
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

/// Whether some rating of the output bearing of a joint is known, so that the bearing can fail a check. For a sized
/// joint, it is enough that a rating is known with some drive.
fn is_checked(slot: &Slot, joint: &SpaceJoint) -> bool {
    match slot {
        Slot::Sized(sized) => {
            (0..sized.table.len()).any(|i| sized.table.limits(i).bearing != BearingLimits::NONE)
        }
        // Every known rating gives a finite limit, whatever speed and life are. The value 1 for both is therefore good
        // enough.
        _ => BearingLimits::of(joint.bearing.stated().as_ref(), 1.0, 1.0) != BearingLimits::NONE,
    }
}

/// The components of a wrench that load a bearing: the force along two axes at right angles to the joint's axis and
/// along the joint's axis \[N\], then the moment about the two axes at right angles \[N m\].
pub(crate) type Components = [f64; 5];

/// The bearing of a joint in a pose. It turns wrenches about the world's origin into the components that load the
/// bearing.
pub(crate) struct PosedBearing {
    /// Centre of the joint \[m\].
    at_m: Vector3<f64>,
    /// Two axes at right angles to the joint's axis, and the joint's axis.
    axes: [Vector3<f64>; 3],
}

impl PosedBearing {
    /// The output bearing of a joint in a pose.
    pub(crate) fn new(joint: &StationJoint) -> Self {
        let axis = angular(&joint.twist);
        let [u, v] = across(&axis);
        Self { at_m: joint.at_m, axes: [u, v, axis] }
    }

    /// The components of a wrench (about the world's origin) that load the bearing.
    pub(crate) fn components(&self, wrench: &Wrench) -> Components {
        let force_n = linear(wrench);
        let moment_nm = angular(wrench) - self.at_m.cross(&force_n);
        let [u, v, axis] = &self.axes;
        [force_n.dot(u), force_n.dot(v), force_n.dot(axis), moment_nm.dot(u), moment_nm.dot(v)]
    }
}
