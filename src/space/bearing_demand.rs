//! Loads on output bearings, from the masses outboard of a joint.
//!
//! A bearing transmits the force and the moment of everything outboard of it. These are due to gravity and load, and to
//! the acceleration or emergency stop of one joint while the others are at rest. A joint may turn or slide (a rail). A
//! joint *outboard* of the bearing accelerates only what is outboard of that joint. The joint of the bearing and the
//! joints *inboard* of it accelerate everything outboard of the bearing. In this way the stop of a shoulder also loads
//! the bearing of the waist, which is inboard of the shoulder.
//!
//! Forces are added as vectors before their norms are taken. The link attaches at some distance along the joint's axis
//! from the face of the flange (the lever). The lever times the radial force is added to the moment, as in the vendor's
//! `M = F_r (L_r + R) + F_a L_a`. There, `F_r` and `F_a` are the radial and the axial force, `L_r` and `L_a` are their
//! levers, and `R` is the distance from the face of the flange to the centre of the bearing.

use super::bearing_loads::{Components, PosedBearing};
use super::problem::ArmProblem;
use super::state::StationState;
use super::station::StationSlot;
use crate::sizing::bearing::{BearingDemand, BearingLoad};

/// The largest loads found so far. Each load has three numbers: the square of the moment \[N² m²\], the square of the
/// radial force \[N²\], and the axial force \[N\].
#[derive(Default)]
struct Largest {
    /// Largest loads under weight and tip load alone.
    at_rest: [f64; 3],
    /// Largest loads while a joint accelerates in normal operation.
    running: [f64; 3],
    /// Largest loads while a joint makes an emergency stop.
    in_stop: [f64; 3],
}

impl Largest {
    /// Raises the largest loads to the loads of a moving arm, where these are larger: the load `rest` at rest,
    /// combined with the load `ramp` that the acceleration of one joint adds. The acceleration may have either sign,
    /// and in an emergency stop it is `stop_factor` times as large. For the vector `s` of a load at rest and the vector
    /// `d` that the acceleration adds, the larger norm of `s ± d` is the root of `|s|² + |d|² + 2 |s·d|`.
    fn moving(&mut self, rest: &Components, ramp: &Components, stop_factor: f64) {
        let larger = |first: usize, times: f64| {
            let (s, d) = ([rest[first], rest[first + 1]], [ramp[first] * times, ramp[first + 1] * times]);
            let both = 2.0 * (s[0] * d[0] + s[1] * d[1]).abs();
            s[0] * s[0] + s[1] * s[1] + d[0] * d[0] + d[1] * d[1] + both
        };
        for (largest, times) in [(&mut self.running, 1.0), (&mut self.in_stop, stop_factor)] {
            let axial_n = rest[2].abs() + ramp[2].abs() * times;
            take(largest, [larger(3, times), larger(0, times), axial_n]);
        }
    }

    fn at_rest(&mut self, rest: &Components) {
        let square = |first: usize| rest[first] * rest[first] + rest[first + 1] * rest[first + 1];
        take(&mut self.at_rest, [square(3), square(0), rest[2].abs()]);
    }

    fn demand(self) -> BearingDemand {
        let load = |[moment, radial, axial_n]: [f64; 3]| BearingLoad {
            moment_nm: moment.sqrt(),
            radial_n: radial.sqrt(),
            axial_n,
        };
        BearingDemand {
            at_rest: load(self.at_rest),
            running: load(self.running),
            in_stop: load(self.in_stop),
        }
    }
}

fn take(largest: &mut [f64; 3], load: [f64; 3]) {
    largest.iter_mut().zip(load).for_each(|(largest, load)| *largest = largest.max(load));
}

impl ArmProblem<'_> {
    /// Loads on the output bearing of the joint in `slot`: the largest over the cases with the indices `cases`. The arm
    /// outboard of the joint has the states `states`, one for each case, and the options `options`, one for each slot
    /// (piece of the arm, tip first). The loads are zero if the joint has no bearing.
    pub(crate) fn bearing_demand(
        &self,
        cases: &[usize],
        states: &[StationState],
        options: &[u32],
        slot: usize,
    ) -> BearingDemand {
        let loads = self.bearing_loads();
        let Some(lever) = &loads.levers[slot] else { return BearingDemand::default() };
        let mut largest = Largest::default();
        for &case in cases {
            self.load_bearing(case, &states[case], slot, &mut largest);
        }
        largest.demand().with_lever(lever.lever_m(options))
    }

    /// Raises `largest` to the loads on the bearing of the joint in `slot` in one case, taken at the face of the
    /// joint's flange. `state` is the state of the arm outboard of the joint in this case.
    fn load_bearing(&self, case: usize, state: &StationState, slot: usize, largest: &mut Largest) {
        let station = &self.stations()[case];
        let StationSlot::Joint(joint) = &station.slots[slot] else { return };
        let (loads, bearing) = (self.bearing_loads(), PosedBearing::new(joint));
        let rest = bearing.components(&state.wrench);
        largest.at_rest(&rest);
        for (k, mover) in loads.movers.iter().enumerate() {
            let ramp = match &station.slots[mover.slot] {
                _ if mover.slot < slot => state.ramps[k],
                StationSlot::Joint(moving) => state.momentum(slot, moving) * mover.acceleration_rad_s2,
                _ => continue,
            };
            largest.moving(&rest, &bearing.components(&ramp), mover.stop_factor);
        }
    }

    /// Stores the wrench with which the joint in `slot` loads the bearings inboard of it while it accelerates. The
    /// wrench is stored in the state of each sizing case, in which drives and stresses are checked. The function is
    /// called just before the joint is added to the arm, when the state has everything outboard of the joint.
    pub(crate) fn keep_ramp(&self, slot: usize, states: &mut [StationState]) {
        let loads = self.bearing_loads();
        let Some(k) = loads.movers.iter().position(|mover| mover.slot == slot).filter(|_| loads.any()) else {
            return;
        };
        for &case in &self.space().sizing_cases {
            if let StationSlot::Joint(moving) = &self.stations()[case].slots[slot] {
                let state = &mut states[case];
                state.ramps[k] = state.momentum(slot, moving) * loads.movers[k].acceleration_rad_s2;
            }
        }
    }
}
