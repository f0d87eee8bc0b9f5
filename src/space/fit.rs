//! The room that links leave for the gears and motors of the joints to which they attach.
//!
//! The link of a joint is the first tube between it and the next joint outboard. If there are only rigid offsets, the
//! joint has no link in this sense, and the limits that refer to a link are not checked at this joint.

use super::design_space::{SpaceJoint, SpacePiece};
use crate::arm::section::Section;
use crate::arm::{Link, LinkBody};
use crate::mechanics::beam::ALONG_COSINE;
use crate::mechanics::beam::section_frame;
use crate::sizing::fit::{FitRequirement, LinkRoom};
use nalgebra::{Unit, Vector3};
use std::f64::consts::FRAC_1_SQRT_2;

/// The space that the link of one joint leaves for gear and motor: their largest widths.
pub(crate) struct RoomAtJoint {
    /// Slot of the link whose section limits the widths of gear and motor.
    pub link_slot: usize,
    /// The largest widths of gear and motor with each option of the link; a single entry if the study gives the
    /// link.
    pub rooms: Vec<LinkRoom>,
}

impl RoomAtJoint {
    /// The rooms at the joints in all slots (pieces of the arm, tip first); `None` for a slot where no limit refers to
    /// a link.
    pub(crate) fn all(pieces: &[SpacePiece], piece_slots: &[usize], slots: usize) -> Vec<Option<Self>> {
        let mut rooms: Vec<Option<Self>> = (0..slots).map(|_| None).collect();
        for (place, &slot) in piece_slots.iter().enumerate() {
            rooms[slot] = Self::new(pieces, place, piece_slots);
        }
        rooms
    }

    /// The room at the joint with number `place` in the chain; `None` if no limit refers to its link, or if it has no
    /// link. `piece_slots` are the slots of all pieces.
    pub(crate) fn new(pieces: &[SpacePiece], place: usize, piece_slots: &[usize]) -> Option<Self> {
        let SpacePiece::Joint(joint) = &pieces[place] else { return None };
        let link = carried_link(pieces, place).filter(|_| joint.fit.asks_of_link())?;
        let room =
            |vector_m: &Vector3<f64>, section: &Section| room(&joint.fit, &joint.axis, vector_m, section);
        let rooms = match &pieces[link] {
            SpacePiece::Choice(choice) => {
                choice.options.iter().map(|option| room(&choice.vector_m, &option.section)).collect()
            }
            SpacePiece::Link(Link { vector_m, body: LinkBody::Tube { section, .. }, .. }) => {
                vec![room(vector_m, section)]
            }
            _ => return None,
        };
        Some(Self { link_slot: piece_slots[link], rooms })
    }

    /// The room that the link leaves if the arm has these `options`, one for each slot.
    pub(crate) fn of(&self, options: &[u32]) -> LinkRoom {
        self.rooms[options[self.link_slot] as usize]
    }
}

/// Number of the link that belongs to the joint with the number `place` in the chain: the first tube outboard of the
/// joint. `None` if there is no tube before the next joint.
pub(crate) fn carried_link(pieces: &[SpacePiece], place: usize) -> Option<usize> {
    let outboard = pieces.iter().enumerate().skip(place + 1);
    let mut before_next_joint =
        outboard.take_while(|(_, piece)| !matches!(piece, SpacePiece::Joint(_) | SpacePiece::Prismatic(_)));
    let is_tube = |piece: &SpacePiece| match piece {
        SpacePiece::Choice(_) => true,
        SpacePiece::Link(link) => matches!(link.body, LinkBody::Tube { .. }),
        SpacePiece::Joint(_) | SpacePiece::Prismatic(_) => false,
    };
    before_next_joint.find(|(_, piece)| is_tube(piece)).map(|(link, _)| link)
}

/// Length \[m\] of the tubes from the link of the joint with the number `place` up to the next joint. Only tubes that
/// follow each other in the direction of this link count. `None` if the joint has no link.
pub(crate) fn carried_length_m(pieces: &[SpacePiece], place: usize) -> Option<f64> {
    let first = carried_link(pieces, place)?;
    let tube = |piece: &SpacePiece| match piece {
        SpacePiece::Choice(choice) => Some(choice.vector_m),
        SpacePiece::Link(Link { vector_m, body: LinkBody::Tube { .. }, .. }) => Some(*vector_m),
        _ => None,
    };
    let direction = tube(&pieces[first])?.normalize();
    let goes_on = |vector_m: &Vector3<f64>| vector_m.dot(&direction) > ALONG_COSINE * vector_m.norm();
    Some(pieces[first..].iter().map_while(tube).take_while(goes_on).map(|vector_m| vector_m.norm()).sum())
}

/// Names of the joints for which a study limits sizes in relation to a link, but which have no link.
pub(crate) fn joints_without_link(pieces: &[SpacePiece]) -> Vec<&str> {
    let asks = |joint: &SpaceJoint| joint.drive.is_sized() && joint.fit.asks_of_link();
    let without = pieces.iter().enumerate().filter_map(|(place, piece)| match piece {
        SpacePiece::Joint(joint) if asks(joint) && carried_link(pieces, place).is_none() => {
            Some(joint.name.as_str())
        }
        _ => None,
    });
    without.collect()
}

fn room(
    fit: &FitRequirement,
    axis: &Unit<Vector3<f64>>,
    vector_m: &Vector3<f64>,
    section: &Section,
) -> LinkRoom {
    let (outer_m, wall_m) = (section.outer_m(), section.wall_m());
    let hollow_m = outer_m.0.min(outer_m.1) - 2.0 * wall_m;
    let square_m = if section.is_round() { hollow_m * FRAC_1_SQRT_2 } else { hollow_m };
    fit.room(width_across_m(axis, vector_m, section), [hollow_m, square_m])
}

/// Width of a link at right angles to the axis of its joint \[m\]. If the joint turns the link, it is the extent of
/// the section in the plane of the rotation. If the joint rolls the link about the link's own axis, it is the smaller
/// side of the section.
fn width_across_m(axis: &Unit<Vector3<f64>>, vector_m: &Vector3<f64>, section: &Section) -> f64 {
    let along = section_frame(vector_m).tr_mul(axis);
    let (width_m, height_m) = section.outer_m();
    if along.x.abs() > ALONG_COSINE {
        return width_m.min(height_m);
    }
    // The result is exact for a rectangular section with one side along the axis, and for a round tube.
    libm::hypot(width_m * along.z, height_m * along.y) / libm::hypot(along.y, along.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn box_of(width_m: f64, height_m: f64) -> Section {
        Section::RectangularTube { width_m, height_m, wall_m: 0.003 }
    }

    fn width_mm(axis: [f64; 3], section: Section) -> f64 {
        let width_m =
            width_across_m(&Unit::new_normalize(Vector3::from(axis)), &Vector3::new(0.5, 0.0, 0.0), &section);
        (width_m * 1e9).round() / 1e6
    }

    #[test]
    fn a_gear_is_as_wide_as_the_side_of_the_link_in_the_plane_in_which_it_turns() {
        let section = || box_of(0.08, 0.14);
        assert_eq!(
            width_mm([0.0, 1.0, 0.0], section()),
            140.0,
            "a pitch joint turns its disc beside the height"
        );
        assert_eq!(width_mm([0.0, 0.0, 1.0], section()), 80.0, "a yaw joint beside the width");
        assert_eq!(width_mm([1.0, 0.0, 0.0], section()), 80.0, "a roll joint within the smaller of both");
        let round = Section::RoundTube { diameter_m: 0.1, wall_m: 0.003 };
        for axis in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, 0.4, -0.5]] {
            assert_eq!(width_mm(axis, round), 100.0);
        }
    }

    #[test]
    fn a_bar_has_no_hollow() {
        let fit =
            FitRequirement { motor: crate::sizing::fit::MotorPlace::InLink, ..FitRequirement::default() };
        let hollow_m =
            |section: Section| room(&fit, &Vector3::y_axis(), &Vector3::new(0.5, 0.0, 0.0), &section).motor_m;
        assert_eq!(hollow_m(Section::RoundBar { diameter_m: 0.05 }), 0.0);
        assert!((hollow_m(box_of(0.08, 0.14)) - 0.074).abs() < 1e-9);
    }
}
