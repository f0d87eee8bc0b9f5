//! Checks of an output bearing by the vendor's selection procedure for crossed-roller bearings.
//!
//! - *running*: the largest moment at the centre of the bearing, `M + R F_r`, is at most the permissible moment, which
//!   limits the deflection.
//! - *static safety*: `P₀ = F_r + 2 (M + R F_r) / d_p + 0.44 F_a` is at most `C₀ / 3` at rest (for high precision) and
//!   at most `C₀ / 2` in a stop (because of shocks).
//! - *life*: `10⁶ / (60 n) · (C / (f_w P_c))^(10/3)` is at least the hours that the study asks for, with
//!   `P_c = X (F_r + 2 (M + R F_r) / d_p) + Y F_a`. The loads are the loads of the arm at rest: the life does not count
//!   accelerations.
//!
//! `M`, `F_r` and `F_a` are the moment, the radial force and the axial force at the face of the flange. `R` is the
//! distance from there to the centre of the bearing, and `d_p` is the pitch diameter of the bearing. `C₀` and `C` are
//! the static and the dynamic load rating, `n` is the mean speed of the joint \[rpm\], and `X`, `Y` and `f_w` are
//! factors of the vendor.
//!
//! (Harmonic Drive LLC, FHA-C manual, pages 20 to 23; Harmonic Drive AG, engineering data 1021387, pages 23, 43
//! and 45.)
//! A rating that the catalog leaves blank limits nothing. Without a pitch diameter only the moment is checked.
//!
//! Nothing of `sizing` is used, so that an error in a limit there is not repeated here.

use crate::arm::bearing::{Bearing, BearingSource};
use crate::catalog::gear::{Gear, GearMass};

/// The load on an output bearing; also a lower or an upper bound of the load over several designs.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct BearingLoad {
    /// Moment about an axis at right angles to the joint's axis \[N m\]. It is taken where the link attaches or, after
    /// [`with_lever`](Self::with_lever), at the face of the joint's flange.
    pub moment_nm: f64,
    /// Force at right angles to the axis of the joint (radial) \[N\].
    pub radial_n: f64,
    /// Force along the axis of the joint \[N\].
    pub axial_n: f64,
}

/// The largest loads on the bearing of one joint: at rest, while a joint ramps, and while a joint makes an emergency
/// stop. They are the largest over the sizing cases, in which drives and stresses are checked.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct BearingDemand {
    pub at_rest: BearingLoad,
    /// Load while one joint speeds up or slows down and the other joints are at rest.
    pub running: BearingLoad,
    /// Load while one joint stops in an emergency and the other joints are at rest.
    pub in_stop: BearingLoad,
}

/// The limits of one bearing in its joint. An infinite limit limits nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BearingRatings {
    /// Distance R along the axis from the centre of the bearing to the face of its flange \[m\].
    centre_m: f64,
    /// Radial force that is equivalent to a moment of 1 N m, `2 / d_p` for the pitch diameter `d_p` \[1/m\].
    per_moment_per_m: f64,
    /// Greatest moment at the centre of the bearing in running \[N m\].
    running_nm: f64,
    /// Greatest static equivalent load `P₀` at rest \[N\].
    at_rest_n: f64,
    /// Greatest static equivalent load `P₀` in an emergency stop \[N\].
    in_stop_n: f64,
    /// Greatest dynamic equivalent load `P_c` under which the bearing reaches the required life \[N\].
    life_n: f64,
}

/// Static safety `C₀ / P₀` at rest. The vendor asks for this value where precision is high.
const SAFETY_AT_REST: f64 = 3.0;
/// Static safety `C₀ / P₀` in an emergency stop. The vendor asks for this value under shocks.
const SAFETY_IN_A_STOP: f64 = 2.0;
/// Load factor f_w of the life: the value for which the vendor's own tables are valid.
const LOAD_FACTOR: f64 = 1.3;

/// The output bearing that a joint has with `gear`. `source` tells whether the study states the bearing or it comes
/// with the gear, and `which` whether the gear is a housed unit or a component set. `None` if the bearing would come
/// with a component set, which has none.
pub(super) fn with_gear(source: &BearingSource, gear: &Gear, which: GearMass) -> Option<Bearing> {
    match (source, which) {
        (BearingSource::Stated(bearing), _) => *bearing,
        (BearingSource::OfGear, GearMass::ComponentSet) => None,
        (BearingSource::OfGear, GearMass::HousedUnit) => Some(Bearing {
            tilt_stiffness_nm_per_rad: gear.tilting_stiffness_nm_per_rad,
            permissible_moment_nm: gear.permissible_tilting_moment_nm,
            mass_kg: 0.0,
            offset_m: None,
            ratings: gear.bearing,
        }),
    }
}

impl BearingLoad {
    fn times(self, factor: f64) -> Self {
        let Self { moment_nm, radial_n, axial_n } = self;
        Self { moment_nm: moment_nm * factor, radial_n: radial_n * factor, axial_n: axial_n * factor }
    }

    /// The load if the same forces attach further out along the axis, by `lever_m` \[m\]. The radial force times this
    /// lever then adds to the moment.
    fn with_lever(self, lever_m: f64) -> Self {
        Self { moment_nm: self.moment_nm + lever_m * self.radial_n, ..self }
    }
}

impl BearingDemand {
    fn with_each(self, change: impl Fn(BearingLoad) -> BearingLoad) -> Self {
        let Self { at_rest, running, in_stop } = self;
        Self { at_rest: change(at_rest), running: change(running), in_stop: change(in_stop) }
    }

    /// This demand with every load multiplied by `factor`.
    pub(super) fn times(self, factor: f64) -> Self {
        self.with_each(|load| load.times(factor))
    }

    /// This demand if the forces attach further out along the axis, by `lever_m` \[m\].
    pub(super) fn with_lever(self, lever_m: f64) -> Self {
        self.with_each(|load| load.with_lever(lever_m))
    }
}

impl BearingRatings {
    /// Limits of a bearing that is not checked: all are infinite.
    pub(super) const UNLIMITED: Self = Self {
        centre_m: 0.0,
        per_moment_per_m: 0.0,
        running_nm: f64::INFINITY,
        at_rest_n: f64::INFINITY,
        in_stop_n: f64::INFINITY,
        life_n: f64::INFINITY,
    };

    /// The limits of a bearing. `duty` is the mean speed of the joint \[rad/s\] and its required life \[h\]. Without a
    /// bearing nothing is limited.
    pub(super) fn of(bearing: Option<&Bearing>, duty: [f64; 2]) -> Self {
        let Some(bearing) = bearing else { return Self::UNLIMITED };
        let printed = &bearing.ratings;
        // A lever that the study states is measured from the centre of the bearing, so the distance R is not added to
        // it.
        let centre_m = bearing.offset_m.map_or(printed.offset_m.unwrap_or(0.0), |_| 0.0);
        let running_nm = bearing.permissible_moment_nm.unwrap_or(f64::INFINITY);
        let of_moment = Self { centre_m, running_nm, ..Self::UNLIMITED };
        let Some(pitch_m) = printed.pitch_diameter_m else { return of_moment };
        let static_n = printed.static_load_rating_n.unwrap_or(f64::INFINITY);
        let life_n = printed.dynamic_load_rating_n.map_or(f64::INFINITY, |c_n| life_load_n(c_n, duty));
        Self {
            per_moment_per_m: 2.0 / pitch_m,
            at_rest_n: static_n / SAFETY_AT_REST,
            in_stop_n: static_n / SAFETY_IN_A_STOP,
            life_n,
            ..of_moment
        }
    }

    /// The moment at the centre of the bearing \[N m\].
    fn moment_nm(&self, load: &BearingLoad) -> f64 {
        load.moment_nm + self.centre_m * load.radial_n
    }

    /// The equivalent radial force \[N\]: the radial force plus the moment converted to a force at the pitch circle.
    fn across_n(&self, load: &BearingLoad) -> f64 {
        load.radial_n + self.per_moment_per_m * self.moment_nm(load)
    }

    /// Static equivalent load `P₀` of the bearing under `load` \[N\].
    fn static_n(&self, load: &BearingLoad) -> f64 {
        self.across_n(load) + 0.44 * load.axial_n
    }

    /// Dynamic equivalent load `P_c` of the bearing under `load` \[N\].
    fn dynamic_n(&self, load: &BearingLoad) -> f64 {
        let across_n = self.across_n(load);
        let is_radial = load.axial_n <= 1.5 * across_n;
        let (x, y) = if is_radial { (1.0, 0.45) } else { (0.67, 0.67) };
        x * across_n + y * load.axial_n
    }

    /// Whether the bearing passes all of its checks under the demand `asked`.
    pub(super) fn hold(&self, asked: &BearingDemand) -> bool {
        self.moment_nm(&asked.running) <= self.running_nm
            && self.static_n(&asked.at_rest) <= self.at_rest_n
            && self.static_n(&asked.in_stop) <= self.in_stop_n
            && self.dynamic_n(&asked.at_rest) <= self.life_n
    }

    /// Whether this bearing passes its checks under every load under which the bearing `other` does.
    pub(super) fn cover(&self, other: &Self) -> bool {
        let limits = self.limits().into_iter().zip(other.limits());
        let levers = self.levers().into_iter().zip(other.levers());
        limits.into_iter().all(|(a, b)| a >= b) && levers.into_iter().all(|(a, b)| a <= b)
    }

    /// Ratings at least as good as these and as `other`: the larger of each limit, with the smaller of each lever.
    pub(super) fn max(&self, other: &Self) -> Self {
        Self {
            centre_m: self.centre_m.min(other.centre_m),
            per_moment_per_m: self.per_moment_per_m.min(other.per_moment_per_m),
            running_nm: self.running_nm.max(other.running_nm),
            at_rest_n: self.at_rest_n.max(other.at_rest_n),
            in_stop_n: self.in_stop_n.max(other.in_stop_n),
            life_n: self.life_n.max(other.life_n),
        }
    }

    fn limits(&self) -> [f64; 4] {
        [self.running_nm, self.at_rest_n, self.in_stop_n, self.life_n]
    }

    fn levers(&self) -> [f64; 2] {
        [self.centre_m, self.per_moment_per_m]
    }
}

/// The dynamic equivalent load \[N\] under which a bearing of dynamic rating C \[N\] reaches exactly the required
/// life.
fn life_load_n(rating_n: f64, [mean_speed_rad_s, life_h]: [f64; 2]) -> f64 {
    let mean_rpm = mean_speed_rad_s * 30.0 / std::f64::consts::PI;
    let million_turns = 60.0 * mean_rpm * life_h / 1e6;
    rating_n / (LOAD_FACTOR * libm::pow(million_turns, 0.3))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalog::Catalogs;
    use crate::catalog::gear::BearingRatings as Printed;

    /// A joint that always turns at 1.5 rad/s, for 20 000 h.
    const DUTY: [f64; 2] = [1.5, 20_000.0];

    /// HFUC-20 as printed: d_p 50 mm, R 9.5 mm, C₀ 9000 N, C 5800 N, M 91 N m.
    fn bearing() -> Bearing {
        Bearing {
            tilt_stiffness_nm_per_rad: Some(1.3e5),
            permissible_moment_nm: Some(91.0),
            mass_kg: 0.0,
            offset_m: None,
            ratings: Printed {
                pitch_diameter_m: Some(0.05),
                offset_m: Some(0.0095),
                static_load_rating_n: Some(9000.0),
                dynamic_load_rating_n: Some(5800.0),
            },
        }
    }

    fn load(moment_nm: f64, radial_n: f64, axial_n: f64) -> BearingLoad {
        BearingLoad { moment_nm, radial_n, axial_n }
    }

    /// The largest factor by which the demand can be multiplied so that the bearing still passes.
    fn most(ratings: &BearingRatings, demand: &BearingDemand) -> f64 {
        let (mut low, mut high) = (0.0, 1e9);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            *(if ratings.hold(&demand.times(middle)) { &mut low } else { &mut high }) = middle;
        }
        low
    }

    #[test]
    fn each_check_decides_at_the_load_worked_out_by_hand() {
        let ratings = BearingRatings::of(Some(&bearing()), DUTY);
        let near = |demand: BearingDemand, by_hand: f64| {
            let most = most(&ratings, &demand);
            assert!((most / by_hand - 1.0).abs() < 1e-12, "{most}, by hand {by_hand}");
        };
        let none = BearingDemand::default();
        // 50 + 0.0095 · 200 = 51.9 N m
        near(BearingDemand { running: load(50.0, 200.0, 0.0), ..none }, 91.0 / 51.9);
        // 200 + 40 · 21.9 + 0.44 · 300 = 1208 N
        near(BearingDemand { in_stop: load(20.0, 200.0, 300.0), ..none }, 9000.0 / 2.0 / 1208.0);
        // 14.323945 rpm: 17 188.734 million turns, and P_c = 200 + 40 · 21.9 + 0.45 · 300 = 1211 N
        let million = 60.0 * 45.0 / std::f64::consts::PI * 20_000.0 / 1e6;
        let life_n = 5800.0 / 1.3 / libm::pow(million, 0.3);
        assert!(life_n < 3000.0, "life decides before static safety at rest");
        near(BearingDemand { at_rest: load(20.0, 200.0, 300.0), ..none }, life_n / 1211.0);
        // 2000 > 1.5 · (200 + 40 · 1.9) = 414: P_c = 0.67 (276 + 2000)
        near(BearingDemand { at_rest: load(0.0, 200.0, 2000.0), ..none }, life_n / (0.67 * 2276.0));
        let at_rest = BearingRatings::of(Some(&bearing()), [DUTY[0], 1.0]);
        let demand = BearingDemand { at_rest: load(20.0, 200.0, 300.0), ..none };
        assert!((most(&at_rest, &demand) / (9000.0 / 3.0 / 1208.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_blank_number_limits_nothing_and_a_stated_offset_begins_at_the_centre() {
        let heavy = BearingDemand { at_rest: load(1e6, 1e6, 1e6), ..BearingDemand::default() };
        let unknown =
            Bearing { ratings: Printed { pitch_diameter_m: None, ..bearing().ratings }, ..bearing() };
        let of_moment = BearingRatings::of(Some(&unknown), DUTY);
        assert!(of_moment.hold(&heavy));
        let running =
            |moment_nm| BearingDemand { running: load(moment_nm, 1000.0, 0.0), ..BearingDemand::default() };
        assert!(of_moment.hold(&running(81.0)) && !of_moment.hold(&running(82.0)), "R counts: 9.5 N m");
        let stated = BearingRatings::of(Some(&Bearing { offset_m: Some(0.1), ..bearing() }), DUTY);
        assert!(stated.hold(&running(90.9)) && !stated.hold(&running(91.1)));
        assert_eq!(BearingRatings::of(None, DUTY), BearingRatings::UNLIMITED);
    }

    #[test]
    fn a_bound_of_two_bearings_holds_what_either_holds() {
        let catalogs = Catalogs::builtin();
        let all: Vec<BearingRatings> = catalogs
            .gears
            .iter()
            .filter_map(|gear| with_gear(&BearingSource::OfGear, gear, GearMass::HousedUnit))
            .map(|bearing| BearingRatings::of(Some(&bearing), DUTY))
            .collect();
        assert!(all.len() > 50);
        for (a, b) in all.iter().zip(all.iter().skip(7)) {
            let larger = a.max(b);
            assert!(larger.cover(a) && larger.cover(b));
            for (moment_nm, force_n) in [(1.0, 0.0), (1.0, 30.0), (0.0, 1.0)] {
                let load = load(moment_nm, force_n, force_n);
                let demand = BearingDemand { at_rest: load, running: load, in_stop: load };
                assert!(most(&larger, &demand) >= most(a, &demand).max(most(b, &demand)));
                assert!(!a.cover(b) || most(a, &demand) >= most(b, &demand));
            }
        }
    }
}
