//! The demands on one joint of eight arms at once, and the lightest drives that hold them.
//!
//! The operations and their order are those of [`JointMotion::demand`] and [`DriveTable::first_fit`], so that an arm gets
//! the same drive by itself and among eight.

use super::demand::JointMotion;
use super::demand::LinearReading;
use super::heat::{HeatWeights, MotorHeat};
use super::limits::DriveLimits;
use super::select::DriveTable;
use crate::mechanics::lanes::{LANES, Lanes};

/// The torques on one joint of eight arms, on the output side. None is negative. There is no moment across the axis.
#[derive(Clone, Copy)]
pub(crate) struct EightDemands<V> {
    static_torque_nm: V,
    peak_torque_nm: V,
    stop_torque_nm: V,
    mean_torque_cubed_nm3: V,
    /// T + T_lin, and how much T exceeds T_lin and T_lin exceeds T \[N m\].
    up_nm: V,
    down_nm: [V; 2],
    heat_weights: HeatWeights,
}

impl<V: Lanes> EightDemands<V> {
    /// The demands on a joint with this motion, from static torques \[N m\] and outboard inertias \[kg m²\].
    #[inline(always)]
    pub(crate) fn new(motion: &JointMotion, static_torque_nm: V, outboard_inertia_kgm2: V) -> Self {
        let statically = static_torque_nm.abs();
        let linear = match motion.linear_reading {
            LinearReading::Exact => outboard_inertia_kgm2 * V::splat(motion.acceleration_rad_s2),
            LinearReading::Paper => V::splat(motion.acceleration_over_gravity) * statically,
        };
        let linear = linear.abs();
        let (up, down) = (statically + linear, (statically - linear).abs());
        let weights = &motion.mean_torque;
        let [stated_peak_nm, stated_cubed_nm3] = motion.stated_torques();
        let cubed_nm3 = V::splat(weights.sum) * (up * up * up)
            + V::splat(weights.steady) * (statically * statically * statically)
            + V::splat(weights.difference) * (down * down * down);
        Self {
            static_torque_nm: statically,
            peak_torque_nm: up.max(V::splat(stated_peak_nm)),
            stop_torque_nm: (statically + V::splat(motion.stop_factor) * linear)
                .max(V::splat(stated_peak_nm)),
            mean_torque_cubed_nm3: cubed_nm3 + V::splat(stated_cubed_nm3),
            up_nm: up,
            down_nm: [(statically - linear).max(V::zero()), (linear - statically).max(V::zero())],
            heat_weights: motion.heat,
        }
    }

    /// Those of the lanes `of` whose demand a drive holds.
    #[inline(always)]
    fn held_by(&self, limits: &DriveLimits, of: u8) -> u8 {
        let held = of
            & !(V::splat(limits.static_torque_nm).less(self.static_torque_nm)
                | V::splat(limits.peak_torque_nm).less(self.peak_torque_nm)
                | V::splat(limits.stop_torque_nm).less(self.stop_torque_nm)
                | V::splat(limits.mean_torque_cubed_nm3).less(self.mean_torque_cubed_nm3));
        // heat costs the most to compare, and most drives that do not hold fail before
        if held == 0 { held } else { held & !V::splat(1.0).less(self.share_squared(&limits.heat)) }
    }

    /// [`MotorHeat::share_squared`] of each lane.
    #[inline(always)]
    fn share_squared(&self, heat: &MotorHeat) -> V {
        let (weights, own) = (&self.heat_weights, V::splat(heat.own_share));
        let driving = V::splat(heat.driving_per_nm);
        let up = self.up_nm * driving + own;
        let steady = self.static_torque_nm * driving;
        let down = self.down_nm[0] * driving - self.down_nm[1] * V::splat(heat.driven_per_nm) - own;
        V::splat(heat.stated_share_squared)
            + V::splat(weights.sum) * (up * up)
            + V::splat(weights.steady + weights.standing) * (steady * steady)
            + V::splat(weights.difference) * (down * down)
    }
}

impl DriveTable<'_> {
    /// The lightest drive that holds in each wanted lane, and the lanes that have one.
    ///
    /// The search for the first step of the ladder that is within reach begins at `step` and stores there what it found.
    /// The next search is for a similar demand and will be short.
    #[inline(always)]
    pub(crate) fn first_fits<V: Lanes>(
        &self,
        demands: &EightDemands<V>,
        wanted: u8,
        step: &mut usize,
    ) -> ([usize; LANES], u8) {
        let ladder = self.ladder();
        let reach = ladder.reach;
        let mut start = (*step).min(reach.len());
        // `reach` only grows along the ladder, so the first step at which some lane may hold is found from either side
        while start > 0 && demands.held_by(&reach[start - 1], wanted) != 0 {
            start -= 1;
        }
        while start < reach.len() && demands.held_by(&reach[start], wanted) == 0 {
            start += 1;
        }
        *step = start;
        let (mut fits, mut open) = ([0; LANES], wanted);
        for (most, steps) in ladder.flights_from(start) {
            if demands.held_by(most, open) == 0 {
                continue;
            }
            for step in steps {
                let mut held = demands.held_by(&ladder.limits[step], open);
                open &= !held;
                // one pass for each bit that is set
                while held != 0 {
                    fits[held.trailing_zeros() as usize] = ladder.indices[step] as usize;
                    held &= held - 1;
                }
            }
            if open == 0 {
                break;
            }
        }
        (fits, wanted & !open)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{any_gear, any_motion, any_motor};
    use super::*;
    use crate::catalog::gear::{Gear, GearMass};
    use crate::catalog::motor::Motor;
    use crate::mechanics::lanes::{Eight, LaneWork, in_lanes};
    use crate::sizing::select::{DriveFilter, DriveTable};
    use proptest::prelude::*;

    struct Fits<'a>(&'a DriveTable<'a>, Eight, Eight, u8, usize);

    impl LaneWork for Fits<'_> {
        type Output = ([usize; LANES], u8);

        fn run<V: Lanes>(mut self) -> Self::Output {
            let demands = EightDemands::new(self.0.motion(), V::load(&self.1), V::load(&self.2));
            self.0.first_fits(&demands, self.3, &mut self.4)
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]

        #[test]
        fn eight_at_once_get_the_drives_they_get_alone(
            gears in prop::collection::vec(any_gear(), 1..8),
            motors in prop::collection::vec(any_motor(), 1..8),
            motion in any_motion(),
            paper: bool,
            torques in prop::array::uniform8(-900.0..900.0f64),
            inertias in prop::array::uniform8(0.0..60.0f64),
            wanted: u8,
            step in 0..70usize,
        ) {
            let gears: Vec<_> = gears.into_iter().enumerate().map(|(i, g)| Gear { id: format!("G{i}"), ..g }).collect();
            let motors: Vec<_> = motors.into_iter().enumerate().map(|(i, m)| Motor { id: format!("M{i}"), ..m }).collect();
            let reading = if paper { LinearReading::Paper } else { LinearReading::Exact };
            let motion = motion.with_linear_reading(reading);
            let filter = DriveFilter::everything(GearMass::ComponentSet);
            let table = DriveTable::build("j", motion, &filter, &gears, &motors);
            let (fits, fitted) = in_lanes(Fits(&table, torques, inertias, wanted, step));
            for lane in 0..LANES {
                let alone = table.first_fit(&table.motion().demand(torques[lane], inertias[lane]));
                let among = (fitted >> lane & 1 == 1).then_some(fits[lane]);
                prop_assert_eq!(among, alone.filter(|_| wanted >> lane & 1 == 1));
            }
        }
    }
}
