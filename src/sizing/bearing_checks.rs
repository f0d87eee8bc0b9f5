//! The checks of an output bearing, one by one, and what is said where they could not be made.

use super::bearing::{self, BearingDemand, BearingLimits, BearingLoad};
use super::check::{Check, CheckKind, check, plain};
use super::demand::JointMotion;
use super::drive::known;
use crate::arm::bearing::Bearing;

/// The checks of an output bearing: moment, static safety at rest and in a stop, life.
pub(super) fn bearing_checks(bearing: &Bearing, motion: &JointMotion, demand: &BearingDemand) -> [Check; 4] {
    let speed_rad_s = motion.mean_speed_rad_s();
    let limits = BearingLimits::of(Some(bearing), speed_rad_s, motion.life_h);
    let ratings = &bearing.ratings;
    let known_pitch = |rating, name| {
        known(ratings.pitch_diameter_m, "bearing_pitch_diameter_m").and_then(|_| known(rating, name))
    };
    let moment_nm = limits.moment_nm(&demand.running);
    let permissible = known(bearing.permissible_moment_nm, "permissible_tilting_moment_nm");
    let safety = |kind, asked, load: &BearingLoad, limit_n: f64| {
        let load_n = limits.static_load_n(load);
        let rating = known_pitch(ratings.static_load_rating_n, "bearing_static_load_rating_n");
        check(kind, Ok(asked), rating.map(|c0_n| c0_n / load_n), load_n, rating.map(|_| limit_n))
    };
    let load_n = limits.dynamic_load_n(&demand.at_rest);
    let rating = known_pitch(ratings.dynamic_load_rating_n, "bearing_dynamic_load_rating_n");
    let life = rating.map(|c_n| bearing::life_h(c_n, load_n, speed_rad_s));
    [
        plain(CheckKind::BearingMoment, moment_nm, permissible),
        safety(CheckKind::BearingRest, bearing::SAFETY_AT_REST, &demand.at_rest, limits.at_rest_n),
        safety(CheckKind::BearingStop, bearing::SAFETY_IN_A_STOP, &demand.in_stop, limits.in_stop_n),
        check(CheckKind::BearingLife, Ok(motion.life_h), life, load_n, rating.map(|_| limits.life_n)),
    ]
}
