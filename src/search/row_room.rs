//! The room that links leave for the gears and motors of inner joints, for eight designs at once.

use crate::mechanics::lanes::{Eight, LANES, Lanes};
use crate::space::fit::RoomAtJoint;
use crate::space::problem::{ArmProblem, Partial};
use crate::space::slot::Slot;

/// The room that a link leaves for the gear and motor of a joint inboard of the row level, which is the choice in which
/// the eight designs differ.
pub(crate) struct RowRoom {
    /// Index of the joint among the inner slots (the slots from the row level to the base).
    pub k: usize,
    /// The link that determines how much room the joint has.
    of: RoomOf,
}

/// The link that determines how much room a joint has.
enum RoomOf {
    /// A link that is given or outboard of the row. The number is the slot of the joint.
    Slot(usize),
    /// The link of the row. Each entry is for a chunk of its options: the largest widths \[m\] of gear, round motor and
    /// square flange, for eight options.
    Chunk(Vec<[Eight; 3]>),
}

impl RowRoom {
    /// The rooms for gear and motor at the joints inboard of the row level, as far as they are limited. `first` is the
    /// slot of the row level.
    pub(crate) fn all(problem: &ArmProblem, first: usize) -> Vec<Self> {
        let slots = problem.slots();
        let is_inboard =
            |slot: usize| matches!(&slots[slot], Slot::Sized(sized) if slot > first || !sized.all_fits);
        let rooms = problem.rooms().iter().enumerate().skip(first).filter(|(slot, _)| is_inboard(*slot));
        let room = |(slot, room): (usize, &Option<RoomAtJoint>)| {
            let room = room.as_ref()?;
            let of = if room.link_slot == first { RoomOf::Chunk(chunks(room)) } else { RoomOf::Slot(slot) };
            Some(Self { k: slot - first, of })
        };
        rooms.filter_map(room).collect()
    }

    /// Largest widths \[m\] that the link leaves for gear, round motor and square flange at this joint, for the eight
    /// designs of a chunk. `from` is the arm outboard of the row. `None` if no link limits them.
    #[inline(always)]
    pub(crate) fn room<V: Lanes>(
        &self,
        problem: &ArmProblem,
        (from, chunk): (&Partial, usize),
    ) -> Option<[V; 3]> {
        match &self.of {
            RoomOf::Chunk(chunks) => Some(std::array::from_fn(|part| V::load(&chunks[chunk][part]))),
            RoomOf::Slot(slot) => {
                let room = problem.rooms()[*slot].as_ref()?.of(&from.options);
                Some([V::splat(room.gear_m), V::splat(room.motor_m), V::splat(room.square_m)])
            }
        }
    }
}

/// Largest widths \[m\] that each option of the link leaves for gear, round motor and square flange, eight options in a
/// chunk. The last chunk is filled up with copies of the last option.
fn chunks(room: &RoomAtJoint) -> Vec<[Eight; 3]> {
    let of = |option: usize| room.rooms[option.min(room.rooms.len() - 1)];
    let eight = |chunk: usize| {
        let rooms: [_; LANES] = std::array::from_fn(|lane| of(LANES * chunk + lane));
        [rooms.map(|room| room.gear_m), rooms.map(|room| room.motor_m), rooms.map(|room| room.square_m)]
    };
    (0..room.rooms.len().div_ceil(LANES)).map(eight).collect()
}
