//! Drops the drives that are too weak, or needlessly strong, for every demand that the remaining options of the other
//! pieces leave possible.

use super::parts::Parts;
use super::statics::CaseLoads;
use crate::sizing::fit::LinkRoom;
use crate::space::fit::RoomAtJoint;
use crate::space::problem::ArmProblem;
use crate::space::slot::Slot;

impl Parts {
    /// Drops the drives that cannot meet the least demand that any remaining options outboard put on their joint. If a
    /// joint takes the lightest drive that meets its demand, drives heavier than the lightest drive that meets the
    /// greatest demand are dropped too. Returns whether any drive was dropped.
    pub(super) fn drop_drives(&mut self, problem: &ArmProblem, cases: &[CaseLoads]) -> bool {
        let mut dropped = false;
        for (slot, piece) in problem.slots().iter().enumerate() {
            let Slot::Sized(sized) = piece else { continue };
            let motion = sized.table.motion();
            // If a joint slows down for longer than it speeds up, the mean torque or the motor's heat may decrease
            // while a load grows. The ends of the intervals then prove nothing.
            let heat = &motion.heat;
            if motion.mean_torque.sum < motion.mean_torque.difference || heat.sum < heat.difference {
                continue;
            }
            let (mut static_nm, mut inertia_kgm2) = ([0.0f64; 2], [0.0f64; 2]);
            for &case in &problem.space().sizing_cases {
                let torque = cases[case].torque_size(problem, self, slot);
                let inertia = cases[case].inertia_range(problem, self, slot);
                for end in 0..2 {
                    static_nm[end] = static_nm[end].max(torque[end]);
                    inertia_kgm2[end] = inertia_kgm2[end].max(inertia[end]);
                }
            }
            let relaxed = [1.0 - 1e-12, 1.0 + 1e-12];
            let room = self.rooms(problem, slot);
            let [least, most] = [0, 1].map(|end| {
                let demand = motion.demand(static_nm[end] * relaxed[end], inertia_kgm2[end] * relaxed[end]);
                demand.with_heat_times(relaxed[end]).with_room(room[end])
            });
            // the load on a bearing has no upper bound here, so the bearing may need a heavier drive than the torques
            // do
            let by_bearing = problem.bearing_loads().checked[slot];
            let heaviest = if sized.all_fits || by_bearing { None } else { sized.table.first_fit(&most) };
            dropped |= self.keep(slot, |_, option| {
                sized.table.limits(option as usize).hold(&least)
                    && heaviest.is_none_or(|heaviest| option as usize <= heaviest)
            });
        }
        dropped
    }

    /// The largest and the smallest space that the remaining tubes leave to the gear and motor of a joint.
    fn rooms(&self, problem: &ArmProblem, slot: usize) -> [LinkRoom; 2] {
        let Some(RoomAtJoint { link_slot, rooms }) = &problem.rooms()[slot] else {
            return [LinkRoom::ANY; 2];
        };
        let remaining = || self.alive[*link_slot].iter().map(|&option| rooms[option as usize]);
        let widest = remaining().reduce(LinkRoom::max).unwrap_or(LinkRoom::ANY);
        [widest, remaining().fold(LinkRoom::ANY, LinkRoom::min)]
    }
}
