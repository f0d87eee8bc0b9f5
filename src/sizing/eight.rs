//! The demands on the same joint of eight arms at once, and the lightest drives that meet them.
//!
//! The operations and their order are the same as in [`JointMotion::demand`] and [`DriveTable::first_fit`]. An arm
//! therefore gets the same drive whether it is sized by itself or among eight.

use super::bearing::{AXIAL_FACTOR, AXIAL_SHARE, BearingLimits, STEEP_FACTOR};
use super::demand::JointMotion;
use super::demand::LinearReading;
use super::duty::HeatWeights;
use super::heat::MotorHeat;
use super::limits::DriveLimits;
use super::select::DriveTable;
use crate::mechanics::lanes::{LANES, Lanes};

/// The torques on one joint of eight arms, on the output side. Each number has one lane per arm; none is negative.
#[derive(Clone, Copy)]
pub(crate) struct EightDemands<V> {
    static_torque_nm: V,
    peak_torque_nm: V,
    stop_torque_nm: V,
    mean_torque_cubed_nm3: V,
    /// Loads on the output bearings; `None` if they are not checked.
    bearing: Option<EightBearing<V>>,
    /// Largest widths of gear, round motor and square flange that the links leave room for \[m\]; `None` if the study
    /// does not ask for this check.
    room: Option<[V; 3]>,
    /// Torque while speeding up \[N m\]: T + T_lin, with the static torque T and the linear torque T_lin. The field
    /// `down_nm` has max(T - T_lin, 0) and max(T_lin - T, 0) \[N m\], from which the torque while slowing down follows.
    up_nm: V,
    down_nm: [V; 2],
    heat_weights: HeatWeights,
}

/// The loads on one output bearing of eight arms. While loads are collected, `moment` and `radial` are squares;
/// [`EightBearing::with_lever`] takes their roots.
#[derive(Clone, Copy)]
pub(crate) struct EightBearing<V> {
    at_rest: EightLoad<V>,
    running: EightLoad<V>,
    in_stop: EightLoad<V>,
}

/// A load on the bearing in eight arms: moment across the axis \[N m\], radial force \[N\] and axial force \[N\].
/// Moment and radial force are first collected as squares, then as norms.
#[derive(Clone, Copy)]
struct EightLoad<V> {
    moment: V,
    radial: V,
    axial_n: V,
}

impl<V: Lanes> EightLoad<V> {
    #[inline(always)]
    fn zero() -> Self {
        Self { moment: V::zero(), radial: V::zero(), axial_n: V::zero() }
    }

    /// Replaces each component of this load by the given component in the lanes where the given one is larger. `radial`
    /// and `moment` are squares of norms.
    #[inline(always)]
    fn max_of_squares(&mut self, radial: V, axial_n: V, moment: V) {
        self.radial = self.radial.max(radial);
        self.axial_n = self.axial_n.max(axial_n);
        self.moment = self.moment.max(moment);
    }

    /// This load with moment and radial force as norms, after their squares were collected. The forces attach further
    /// out along the axis by `lever_m` \[m\], so the radial force adds to the moment.
    #[inline(always)]
    fn with_lever(self, lever_m: V) -> Self {
        let radial = self.radial.sqrt();
        Self { moment: self.moment.sqrt() + lever_m * radial, radial, axial_n: self.axial_n }
    }

    /// Radial force plus the force that is equivalent to the moment \[N\], in each lane, computed as in
    /// [`BearingLimits`].
    #[inline(always)]
    fn across(&self, limits: &BearingLimits) -> V {
        self.radial + V::splat(limits.force_per_moment_per_m) * self.moment_at_centre(limits)
    }

    #[inline(always)]
    fn moment_at_centre(&self, limits: &BearingLimits) -> V {
        self.moment + V::splat(limits.flange_offset_m) * self.radial
    }
}

impl<V: Lanes> EightBearing<V> {
    /// No load on the bearing in any of the eight arms.
    #[inline(always)]
    pub(crate) fn zero() -> Self {
        Self { at_rest: EightLoad::zero(), running: EightLoad::zero(), in_stop: EightLoad::zero() }
    }

    /// Raises the largest load at rest, lane by lane, to a further load at rest. The five components of that load are
    /// two forces across the axis \[N\], the force along it \[N\], and two moments across it \[N m\].
    #[inline(always)]
    pub(crate) fn rest(&mut self, [u, v, along, about_u, about_v]: &[V; 5]) {
        let (radial, moment) = (*u * *u + *v * *v, *about_u * *about_u + *about_v * *about_v);
        self.at_rest.max_of_squares(radial, along.abs(), moment);
        // `running` and `in_stop` need not be updated: `moving` takes each ramp with both signs, and one of the two
        // loads the bearing at least as much as the load at rest does
    }

    /// Raises the largest loads in a ramp and in an emergency stop, lane by lane, to those of a further ramp. With the
    /// load s at rest and the load d that the ramp adds, they are s ± d in the ramp and s ± `stop_factor` d in the
    /// stop. Of the two signs the larger squared norm is `|s|² + |d|² + 2 |s·d|`.
    #[inline(always)]
    pub(crate) fn moving(&mut self, at_rest: &[V; 5], ramp: &[V; 5], stop_factor: V) {
        let (radial, moment) = (Pair::new(at_rest, ramp, 0), Pair::new(at_rest, ramp, 3));
        let (rest_n, ramp_n) = (at_rest[2].abs(), ramp[2].abs());
        self.running.max_of_squares(radial.largest(), rest_n + ramp_n, moment.largest());
        let (radial, moment) = (radial.times(stop_factor), moment.times(stop_factor));
        self.in_stop.max_of_squares(radial.largest(), rest_n + stop_factor * ramp_n, moment.largest());
    }

    /// The loads on the bearing as norms, if all forces attach further out along the axis by `lever_m` \[m\].
    #[inline(always)]
    pub(crate) fn with_lever(self, lever_m: V) -> Self {
        Self {
            at_rest: self.at_rest.with_lever(lever_m),
            running: self.running.with_lever(lever_m),
            in_stop: self.in_stop.with_lever(lever_m),
        }
    }

    /// Bit mask of the lanes (arms) in which a load exceeds one of `limits`, the limits of a bearing.
    #[inline(always)]
    fn broken_by(&self, limits: &BearingLimits) -> u8 {
        let across = self.at_rest.across(limits);
        let axial_n = self.at_rest.axial_n;
        let share = V::splat(AXIAL_SHARE);
        let lasting =
            (across + V::splat(AXIAL_FACTOR) * axial_n).max(V::splat(STEEP_FACTOR) * (across + axial_n));
        V::splat(limits.running_moment_nm).less(self.running.moment_at_centre(limits))
            | V::splat(limits.at_rest_n).less(across + share * axial_n)
            | V::splat(limits.in_stop_n).less(self.in_stop.across(limits) + share * self.in_stop.axial_n)
            | V::splat(limits.life_n).less(lasting)
    }
}

/// Squared norms of two components: of the load at rest, s, and of what a ramp adds, d.
#[derive(Clone, Copy)]
struct Pair<V> {
    /// `|s|²` of the load at rest.
    rest: V,
    /// `|d|²` of the load d that the ramp adds.
    ramp: V,
    /// `2 |s·d|`, the mixed term of both loads.
    both: V,
}

impl<V: Lanes> Pair<V> {
    /// Squared norms over the components `first` and `first + 1` of `at_rest` (s) and `ramp` (d): |s|², |d|² and the
    /// mixed term 2 |s·d|.
    #[inline(always)]
    fn new(at_rest: &[V; 5], ramp: &[V; 5], first: usize) -> Self {
        let (s, d) = ([at_rest[first], at_rest[first + 1]], [ramp[first], ramp[first + 1]]);
        let both = (s[0] * d[0] + s[1] * d[1]).abs();
        Self { rest: s[0] * s[0] + s[1] * s[1], ramp: d[0] * d[0] + d[1] * d[1], both: both + both }
    }

    /// These squared norms if the load d of the ramp is multiplied by `factor`.
    #[inline(always)]
    fn times(self, factor: V) -> Self {
        Self { rest: self.rest, ramp: self.ramp * factor * factor, both: self.both * factor }
    }

    /// The larger of `|s + d|²` and `|s - d|²`, where s is the load at rest and d the load that a ramp adds.
    #[inline(always)]
    fn largest(self) -> V {
        self.rest + self.ramp + self.both
    }
}

impl<V: Lanes> EightDemands<V> {
    /// The demands on a joint with the motion `motion` in eight arms, from their static torques \[N m\] and the
    /// inertias of everything outboard about the axis \[kg m²\].
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
            stop_torque_nm: (statically + V::splat(motion.stop.factor) * linear)
                .max(V::splat(stated_peak_nm)),
            mean_torque_cubed_nm3: cubed_nm3 + V::splat(stated_cubed_nm3),
            up_nm: up,
            down_nm: [(statically - linear).max(V::zero()), (linear - statically).max(V::zero())],
            heat_weights: motion.heat,
            bearing: None,
            room: None,
        }
    }

    /// These demands with `bearing` as the loads on the output bearings. With `None`, the bearings are not checked.
    #[inline(always)]
    pub(crate) fn with_bearing(self, bearing: Option<EightBearing<V>>) -> Self {
        Self { bearing, ..self }
    }

    /// These demands with `room` as the largest widths of gear, round motor and square flange that fit \[m\]. With
    /// `None`, sizes are not checked.
    #[inline(always)]
    pub(crate) fn with_room(self, room: Option<[V; 3]>) -> Self {
        Self { room, ..self }
    }

    /// Bit mask of the lanes (arms) in which a drive with these limits meets the demand. Only the lanes in the mask
    /// `of` are tested.
    #[inline(always)]
    pub(crate) fn held_by(&self, limits: &DriveLimits, of: u8) -> u8 {
        let held = of
            & !(V::splat(limits.static_torque_nm).less(self.static_torque_nm)
                | V::splat(limits.peak_torque_nm).less(self.peak_torque_nm)
                | V::splat(limits.stop_torque_nm).less(self.stop_torque_nm)
                | V::splat(limits.mean_torque_cubed_nm3).less(self.mean_torque_cubed_nm3)
                | match &self.bearing {
                    Some(bearing) => bearing.broken_by(&limits.bearing),
                    None => 0,
                }
                | match &self.room {
                    Some([gear_m, motor_m, square_m]) => {
                        gear_m.less(V::splat(limits.widths.gear_m))
                            | motor_m.less(V::splat(limits.widths.motor_m))
                            | square_m.less(V::splat(limits.widths.square_m))
                    }
                    None => 0,
                });
        // the heat of the motor costs the most to compare, and most drives that fail do so in an earlier comparison
        if held == 0 { held } else { held & !V::splat(1.0).less(self.share_squared(&limits.heat)) }
    }

    /// Mean square of the motor's torque over its continuous torque, computed as [`MotorHeat::share_squared`] in each
    /// lane.
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
    /// For each lane (arm) in the mask `wanted`, the index of the lightest drive that meets its demand, and the bit
    /// mask of the lanes that have such a drive.
    ///
    /// The ladder lists the drives that can be the lightest for some demand, lightest first. The search for the
    /// first step of the ladder that may meet a demand begins at `step`. The step that it finds is
    /// stored in `step`. Successive demands are similar, so the next search is short.
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
        // `reach[step]` has the most permissive value of each limit up to this step, so it only grows along the ladder. The
        // first step that may meet the demand of some lane can therefore be found from either side.
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
                // one pass for each bit of the mask that is set, that is, for each lane whose drive is found
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
    use super::super::testing::{any_gear, any_link_m, any_motion, any_motor};
    use super::*;
    use crate::catalog::gear::{Gear, GearMass};
    use crate::catalog::motor::Motor;
    use crate::mechanics::lanes::{Eight, LaneWork, in_lanes};
    use crate::sizing::select::{DriveFilter, DriveTable};
    use proptest::prelude::*;

    struct Fits<'a>(&'a DriveTable<'a>, Eight, Eight, u8, usize, [Eight; 3]);

    impl LaneWork for Fits<'_> {
        type Output = ([usize; LANES], u8);

        fn run<V: Lanes>(mut self) -> Self::Output {
            let room = [V::load(&self.5[0]), V::load(&self.5[1]), V::load(&self.5[2])];
            let demands =
                EightDemands::new(self.0.motion(), V::load(&self.1), V::load(&self.2)).with_room(Some(room));
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
            links_m in prop::array::uniform8(any_link_m()),
            wanted: u8,
            step in 0..70usize,
        ) {
            let gears: Vec<_> = gears.into_iter().enumerate().map(|(i, g)| Gear { id: format!("G{i}"), ..g }).collect();
            let motors: Vec<_> = motors.into_iter().enumerate().map(|(i, m)| Motor { id: format!("M{i}"), ..m }).collect();
            let reading = if paper { LinearReading::Paper } else { LinearReading::Exact };
            let motion = motion.with_linear_reading(reading);
            let filter = DriveFilter::everything(GearMass::ComponentSet);
            let table = DriveTable::build("j", motion, &filter, &gears, &motors);
            let rooms = links_m.map(|[width_m, hollow_m]| motion.fit.room(width_m, [hollow_m, 0.8 * hollow_m]));
            let room_m = [rooms.map(|room| room.gear_m), rooms.map(|room| room.motor_m), rooms.map(|room| room.square_m)];
            let (fits, fitted) = in_lanes(Fits(&table, torques, inertias, wanted, step, room_m));
            for lane in 0..LANES {
                let demand = table.motion().demand(torques[lane], inertias[lane]).with_room(rooms[lane]);
                let alone = table.first_fit(&demand);
                let among = (fitted >> lane & 1 == 1).then_some(fits[lane]);
                prop_assert_eq!(among, alone.filter(|_| wanted >> lane & 1 == 1));
            }
        }
    }
}
