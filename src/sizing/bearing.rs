//! The check of an output bearing: the vendor's procedure for crossed-roller bearings, reduced to thresholds.
//!
//! The vendor compares three things with what a bearing is rated for (Harmonic Drive LLC, FHA-C manual, pages 20 to 23;
//! Harmonic Drive AG, engineering data 1021387, pages 43 and 45):
//!
//! 1. *Running*. The largest moment while the joint turns is at most the permissible moment. The permissible moment is
//!    a limit of deflection and not of life, so it applies however short the load lasts. `M = M₀ + R F_r`, with the
//!    moment M₀ at the face of the flange, and R the distance from the bearing's centre to this face.
//! 2. *Static safety*. The safety factor `fs = C₀ / P₀` with `P₀ = F_r + 2 M / d_p + 0.44 F_a` is at least 1.5 in
//!    normal use, 2 with shocks and 3 for high precision. Here: [`SAFETY_AT_REST`] at rest, [`SAFETY_IN_A_STOP`] in an
//!    emergency stop.
//! 3. *Life*. `L₁₀ = 10⁶ / (60 n) · (C / (f_w P_c))^(10/3)` hours with `P_c = X (F_r + 2 M / d_p) + Y F_a`. X and Y are
//!    1 and 0.45 while `F_a` is at most 1.5 times `F_r + 2 M / d_p`, else both are 0.67. n is the mean speed of the
//!    joint over its cycle, so the same formula holds for joints that swing. A swing of ±θ travels 4θ in each
//!    oscillation.
//!
//! F_r and F_a are the radial and the axial force. d_p is the pitch diameter of the bearing. C₀ and C are its static
//! and its dynamic load rating, and f_w is a load factor of the vendor.
//!
//! Each of the three loads grows with every force and moment. So a bearing is described by a set of thresholds, as the
//! gear and the motor of a drive are.

use crate::arm::bearing::Bearing;

/// Static safety factor fs that is required at rest: the vendor's value for high precision.
pub(crate) const SAFETY_AT_REST: f64 = 3.0;
/// Static safety factor fs that is required in an emergency stop: the vendor's value for shocks.
pub(crate) const SAFETY_IN_A_STOP: f64 = 2.0;
/// Load factor f_w of the life: the vendor's value for its own tables, which lies in the range of normal use, 1.2 to
/// 1.5.
pub(crate) const LOAD_FACTOR: f64 = 1.3;
/// Factor of the axial force in the static equivalent load P₀.
pub(super) const AXIAL_SHARE: f64 = 0.44;
/// Factor Y of the axial force in the dynamic equivalent load P_c, while the axial force is at most 1.5 times
/// `F_r + 2 M / d_p`. The factor X of `F_r + 2 M / d_p` is then 1.
pub(super) const AXIAL_FACTOR: f64 = 0.45;
/// The factors X and Y of the dynamic equivalent load P_c where the axial force exceeds 1.5 times `F_r + 2 M / d_p`.
pub(super) const STEEP_FACTOR: f64 = 0.67;
/// Number of turns for which the dynamic load rating C is defined.
pub(super) const RATED_TURNS: f64 = 1e6;

/// The load on a bearing: the forces and the moment that everything outboard puts on it, at the face of its flange.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BearingLoad {
    /// Moment across the axis at the face of the flange \[N m\].
    pub moment_nm: f64,
    /// Force across the axis \[N\].
    pub radial_n: f64,
    /// Force along the axis \[N\].
    pub axial_n: f64,
}

/// The loads on the output bearing of a joint in a study. Each number is the largest over the sizing cases (in which
/// drives and stresses are checked) and over the ramps or stops of single joints. The moment and the forces of one load
/// may come from different cases, which is on the safe side.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BearingDemand {
    /// Loads from gravity, payload and tip force alone, with all joints at rest.
    pub at_rest: BearingLoad,
    /// Loads while one joint is in its ramp and the others are at rest.
    pub running: BearingLoad,
    /// Loads while one joint is in its emergency stop and the others are at rest.
    pub in_stop: BearingLoad,
}

/// Thresholds of an output bearing. A bearing passes its checks exactly if no load exceeds its threshold. A threshold
/// is infinite if the rating behind it is unknown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BearingLimits {
    /// Distance R from the bearing's centre to the face of the flange \[m\].
    pub flange_offset_m: f64,
    /// Force that is equivalent to a moment of 1 N m: `2 / d_p` \[1/m\]. 0 if the pitch diameter is unknown.
    pub force_per_moment_per_m: f64,
    /// Largest moment at the bearing's centre while the joint turns \[N m\].
    pub running_moment_nm: f64,
    /// Largest static equivalent load P₀ at rest \[N\].
    pub at_rest_n: f64,
    /// Largest static equivalent load P₀ in an emergency stop \[N\].
    pub in_stop_n: f64,
    /// Largest dynamic equivalent load P_c at which the bearing reaches the required life \[N\].
    pub life_n: f64,
}

impl BearingLoad {
    /// The larger of this load and `other`, component by component. The result may be larger than both.
    pub fn max(self, other: Self) -> Self {
        Self {
            moment_nm: self.moment_nm.max(other.moment_nm),
            radial_n: self.radial_n.max(other.radial_n),
            axial_n: self.axial_n.max(other.axial_n),
        }
    }

    /// This load if its forces attach further out along the axis by `lever_m` \[m\]. The radial force then adds to the
    /// moment.
    pub fn with_lever(self, lever_m: f64) -> Self {
        Self { moment_nm: self.moment_nm + lever_m * self.radial_n, ..self }
    }

    /// This load with all three components multiplied by `factor`.
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            moment_nm: self.moment_nm * factor,
            radial_n: self.radial_n * factor,
            axial_n: self.axial_n * factor,
        }
    }
}

impl BearingDemand {
    /// Whether every load is zero: nothing loads the bearing, or the joint has no bearing.
    pub fn is_zero(&self) -> bool {
        *self == Self::default()
    }

    /// The larger of this demand and `other`, component by component.
    pub fn max(self, other: Self) -> Self {
        Self {
            at_rest: self.at_rest.max(other.at_rest),
            running: self.running.max(other.running),
            in_stop: self.in_stop.max(other.in_stop),
        }
    }

    /// This demand if all forces attach further out along the axis by `lever_m` \[m\].
    pub fn with_lever(self, lever_m: f64) -> Self {
        Self {
            at_rest: self.at_rest.with_lever(lever_m),
            running: self.running.with_lever(lever_m),
            in_stop: self.in_stop.with_lever(lever_m),
        }
    }

    /// An upper bound of this demand when all accelerations are multiplied by `factor` (0 to 1). The norm of a load is
    /// a convex function of the accelerations, so a linear interpolation between the load at rest and the load at full
    /// acceleration is not below it.
    pub fn slowed(self, factor: f64) -> Self {
        let between = |at_rest: f64, moving: f64| at_rest + factor * (moving - at_rest).max(0.0);
        let load = |moving: BearingLoad| BearingLoad {
            moment_nm: between(self.at_rest.moment_nm, moving.moment_nm),
            radial_n: between(self.at_rest.radial_n, moving.radial_n),
            axial_n: between(self.at_rest.axial_n, moving.axial_n),
        };
        Self { at_rest: self.at_rest, running: load(self.running), in_stop: load(self.in_stop) }
    }

    /// This demand with every load multiplied by `factor`.
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            at_rest: self.at_rest.scaled(factor),
            running: self.running.scaled(factor),
            in_stop: self.in_stop.scaled(factor),
        }
    }
}

impl BearingLimits {
    /// Limits that no load exceeds: for a joint without a bearing, or with a bearing that is not to be checked.
    pub(crate) const NONE: Self = Self {
        flange_offset_m: 0.0,
        force_per_moment_per_m: 0.0,
        running_moment_nm: f64::INFINITY,
        at_rest_n: f64::INFINITY,
        in_stop_n: f64::INFINITY,
        life_n: f64::INFINITY,
    };

    /// The limits of a bearing in a joint with this mean speed \[rad/s\] and required life \[h\]. Where a rating is
    /// blank, the limit is infinite; [`BlankRatings`](super::BlankRatings) lists the checks that cannot be made for
    /// this reason.
    pub fn of(bearing: Option<&Bearing>, mean_speed_rad_s: f64, life_h: f64) -> Self {
        let Some(bearing) = bearing else { return Self::NONE };
        let ratings = &bearing.ratings;
        let flange_offset_m =
            if bearing.offset_m.is_some() { 0.0 } else { ratings.offset_m.unwrap_or_default() };
        let Some(pitch_m) = ratings.pitch_diameter_m else {
            let running_moment_nm = bearing.permissible_moment_nm.unwrap_or(f64::INFINITY);
            return Self { flange_offset_m, running_moment_nm, ..Self::NONE };
        };
        let share = |safety: f64| ratings.static_load_rating_n.map_or(f64::INFINITY, |c0_n| c0_n / safety);
        Self {
            flange_offset_m,
            force_per_moment_per_m: 2.0 / pitch_m,
            running_moment_nm: bearing.permissible_moment_nm.unwrap_or(f64::INFINITY),
            at_rest_n: share(SAFETY_AT_REST),
            in_stop_n: share(SAFETY_IN_A_STOP),
            life_n: ratings
                .dynamic_load_rating_n
                .map_or(f64::INFINITY, |c_n| load_of_life_n(c_n, mean_speed_rad_s, life_h)),
        }
    }

    /// Moment across the axis at the centre of the bearing \[N m\], for a `load` that is given at the face of the
    /// flange.
    #[inline]
    pub fn moment_nm(&self, load: &BearingLoad) -> f64 {
        load.moment_nm + self.flange_offset_m * load.radial_n
    }

    /// Radial force of a load plus the force that is equivalent to its moment at the bearing's centre:
    /// `F_r + 2 M / d_p` \[N\].
    #[inline]
    fn across_n(&self, load: &BearingLoad) -> f64 {
        load.radial_n + self.force_per_moment_per_m * self.moment_nm(load)
    }

    /// Static equivalent load P₀ of a load on the bearing \[N\]: radial force, force equivalent to the moment, and 0.44
    /// times the axial force.
    #[inline]
    pub fn static_load_n(&self, load: &BearingLoad) -> f64 {
        self.across_n(load) + AXIAL_SHARE * load.axial_n
    }

    /// Dynamic equivalent load P_c \[N\]. The vendor changes from one pair of X and Y to the other where the axial
    /// force is 1.5 times `F_r + 2 M / d_p`. On either side of this point the vendor's formula is the one with the
    /// larger result, so the larger of the two is taken and no case distinction is needed.
    #[inline]
    pub fn dynamic_load_n(&self, load: &BearingLoad) -> f64 {
        let across_n = self.across_n(load);
        (across_n + AXIAL_FACTOR * load.axial_n).max(STEEP_FACTOR * (across_n + load.axial_n))
    }

    /// Whether the bearing meets `demand`: no load of the demand exceeds its limit.
    #[inline]
    pub fn hold(&self, demand: &BearingDemand) -> bool {
        (self.moment_nm(&demand.running) <= self.running_moment_nm)
            & (self.static_load_n(&demand.at_rest) <= self.at_rest_n)
            & (self.static_load_n(&demand.in_stop) <= self.in_stop_n)
            & (self.dynamic_load_n(&demand.at_rest) <= self.life_n)
    }

    /// The largest factor by which every load of `demand` may be multiplied so that the bearing still passes its
    /// checks. Infinite if all loads are zero.
    pub fn multiple_of(&self, demand: &BearingDemand) -> f64 {
        let times = |limit: f64, asked: f64| if asked > 0.0 { limit / asked } else { f64::INFINITY };
        times(self.running_moment_nm, self.moment_nm(&demand.running))
            .min(times(self.at_rest_n, self.static_load_n(&demand.at_rest)))
            .min(times(self.in_stop_n, self.static_load_n(&demand.in_stop)))
            .min(times(self.life_n, self.dynamic_load_n(&demand.at_rest)))
    }

    /// The weaker of the limits of this bearing and of `other`, one by one. If one of the two bearings meets a demand,
    /// the demand is within these limits.
    pub fn max(&self, other: &Self) -> Self {
        Self {
            flange_offset_m: self.flange_offset_m.min(other.flange_offset_m),
            force_per_moment_per_m: self.force_per_moment_per_m.min(other.force_per_moment_per_m),
            running_moment_nm: self.running_moment_nm.max(other.running_moment_nm),
            at_rest_n: self.at_rest_n.max(other.at_rest_n),
            in_stop_n: self.in_stop_n.max(other.in_stop_n),
            life_n: self.life_n.max(other.life_n),
        }
    }

    /// The stricter of the limits of this bearing and of `other`, one by one. If a demand is within these limits, both
    /// bearings meet it.
    pub fn min(&self, other: &Self) -> Self {
        Self {
            flange_offset_m: self.flange_offset_m.max(other.flange_offset_m),
            force_per_moment_per_m: self.force_per_moment_per_m.max(other.force_per_moment_per_m),
            running_moment_nm: self.running_moment_nm.min(other.running_moment_nm),
            at_rest_n: self.at_rest_n.min(other.at_rest_n),
            in_stop_n: self.in_stop_n.min(other.in_stop_n),
            life_n: self.life_n.min(other.life_n),
        }
    }

    /// Whether no limit of this bearing is stricter than the same limit of `other`. This bearing then meets every
    /// demand that `other` meets.
    #[inline]
    pub fn cover(&self, other: &Self) -> bool {
        (self.flange_offset_m <= other.flange_offset_m)
            & (self.force_per_moment_per_m <= other.force_per_moment_per_m)
            & (self.running_moment_nm >= other.running_moment_nm)
            & (self.at_rest_n >= other.at_rest_n)
            & (self.in_stop_n >= other.in_stop_n)
            & (self.life_n >= other.life_n)
    }
}

/// Life of a bearing \[h\] with the dynamic load rating C = `rating_n` \[N\] under the equivalent load `load_n` \[N\],
/// at a mean speed of the joint \[rad/s\].
pub(super) fn life_h(rating_n: f64, load_n: f64, mean_speed_rad_s: f64) -> f64 {
    RATED_TURNS / turns_per_h(mean_speed_rad_s) * libm::pow(rating_n / (LOAD_FACTOR * load_n), 10.0 / 3.0)
}

/// The equivalent load \[N\] under which a bearing with the dynamic load rating C = `rating_n` \[N\] reaches exactly
/// the life `life_h` \[h\] at a mean speed of the joint \[rad/s\].
fn load_of_life_n(rating_n: f64, mean_speed_rad_s: f64, life_h: f64) -> f64 {
    rating_n / LOAD_FACTOR * libm::pow(RATED_TURNS / (turns_per_h(mean_speed_rad_s) * life_h), 0.3)
}

/// Number of turns in one hour at a speed \[rad/s\].
fn turns_per_h(speed_rad_s: f64) -> f64 {
    speed_rad_s / std::f64::consts::TAU * 3600.0
}
