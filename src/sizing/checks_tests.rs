//! Tests of the checks: each limit alone, the messages, and that thresholds and printed numbers give the same result.

use super::super::bearing::BearingLimits;
use super::super::bearing_checks::bearing_margin;
use super::super::testing::{
    ample, any_gear, any_link_m, any_motion, any_motor, any_torques, bearing_loads, char_lynn_j_8_2, f11_10,
    hfuc_40_100, housed,
};
use super::*;
use crate::arm::bearing::BearingSource;
use crate::arm::extras::ExtrasSource;
use crate::catalog::gear::{BearingRatings, GearMass};
use crate::catalog::motor::Motor;
use crate::sizing::check::CheckState;
use crate::sizing::drive::MissingRating;
use crate::sizing::limits::{DriveLimits, Obstacle};
use crate::sizing::requirement::MotionRequirement;
use proptest::prelude::*;

/// A joint at 1.35 m from the tip. With [`demand`] it has 300 N m static and 100 N m linear torque.
fn motion() -> JointMotion {
    MotionRequirement::default().joint_motion(1.35, None)
}

fn demand() -> JointDemand {
    motion().demand_of_torques(300.0, 100.0)
}

/// Kinds of the checks that fail after one change to a drive that passes all of them.
fn failing(change: impl FnOnce(&mut Gear, &mut Motor, &mut JointMotion, &mut JointDemand)) -> Vec<CheckKind> {
    let (mut gear, mut motor) = ample();
    let (mut motion, mut demand) = (motion(), demand());
    change(&mut gear, &mut motor, &mut motion, &mut demand);
    let drive = housed(&gear, &motor);
    let checks = checks(&drive, &motion, &demand);
    assert!(checks.iter().all(|c| c.state != CheckState::Holds || c.margin().unwrap() >= 1.0));
    assert!(checks.iter().all(|c| c.state != CheckState::Fails || c.margin().unwrap() < 1.0));
    checks.iter().filter(|c| !c.holds()).map(|c| c.kind).collect()
}

#[test]
fn the_ample_drive_holds_everything() {
    assert_eq!(failing(|_, _, _, d| d.bearing = bearing_loads(500.0)), []);
}

#[test]
fn each_check_fails_alone_when_its_own_limit_is_lowered() {
    assert_eq!(failing(|g, _, _, _| g.repeated_peak_torque_nm = Some(399.0)), [CheckKind::GearPeak]);
    assert_eq!(failing(|g, _, _, _| g.average_torque_limit_nm = Some(300.0)), [CheckKind::GearMean]);
    assert_eq!(failing(|g, _, _, _| g.momentary_peak_torque_nm = Some(499.0)), [CheckKind::GearStop]);
    assert_eq!(failing(|g, _, _, _| g.max_input_speed_rpm = Some(707.0)), [CheckKind::GearSpeed]);
    assert_eq!(
        failing(|g, _, _, _| g.average_input_speed_limit_rpm = Some(282.0)),
        [CheckKind::GearMeanSpeed]
    );
    let holds_too_little = |_: &mut Gear, m: &mut Motor, motion: &mut JointMotion, _: &mut JointDemand| {
        (m.rated_torque_nm, motion.checks_motor_heat) = (Some(3.84), false);
    };
    assert_eq!(failing(holds_too_little), [CheckKind::MotorHold]);
    assert_eq!(failing(|_, m, _, _| m.rated_torque_nm = Some(3.86)), [CheckKind::MotorRms]);
    assert_eq!(failing(|g, _, _, _| g.buckling_torque_nm = Some(499.0)), [CheckKind::GearBuckling]);
    assert_eq!(failing(|g, _, _, _| g.ratcheting_torque_nm = Some(499.0)), [CheckKind::GearRatcheting]);
    assert_eq!(failing(|_, _, motion, _| motion.emergency_stops = Some(1e4)), [CheckKind::GearStops]);
    assert_eq!(failing(|_, m, _, _| m.peak_torque_nm = Some(5.70)), [CheckKind::MotorPeak]);
    assert_eq!(failing(|_, m, _, _| m.max_speed_rpm = Some(707.0)), [CheckKind::MotorSpeed]);
}

/// The motor of an actuator stops its own rotor in addition to the load. With 0.5 kg m² at the output, a ramp of α and
/// a stop of 2 α, the torque T + 2 T_lin + 2 · 0.5 α may reach the peak torque.
#[test]
fn an_actuator_stops_its_own_rotor_too() {
    let (mut gear, mut motor) = ample();
    gear.kind = GearKind::Actuator;
    motor.rotor_inertia_kgm2 = Some(0.5 / gear.ratio.powi(2));
    gear.inertia_input_kgm2 = Some(0.0);
    gear.efficiency = Some(1.0);
    let (motion, demand) = (motion(), demand());
    let own_nm = 2.0 * 0.5 * motion.acceleration_rad_s2;
    let stops = |peak_nm: f64| {
        let gear = Gear { momentary_peak_torque_nm: Some(peak_nm), ..gear.clone() };
        let drive = housed(&gear, &motor);
        let stop = checks(&drive, &motion, &demand).into_iter().filter(|c| c.kind == CheckKind::GearStop);
        let stop: Vec<Check> = stop.collect();
        assert_eq!(stop.len(), 1);
        assert!((stop[0].needed.expect("known") - (500.0 + own_nm)).abs() < 1e-9, "{:?}", stop[0]);
        let holds = DriveLimits::of(&drive, &motion).expect("legal").stop_torque_nm >= demand.stop_torque_nm;
        assert_eq!(holds, stop[0].holds());
        holds
    };
    assert!(own_nm > 3.0 && stops(500.0 + own_nm + 1e-6) && !stops(500.0 + own_nm - 1e-6));
}

#[test]
fn life_fails_alone_when_more_is_required_than_the_bearing_gives() {
    assert_eq!(failing(|_, _, motion, _| motion.life_h = 1.0e6), [CheckKind::GearLife]);
    assert_eq!(failing(|g, _, _, _| g.rated_torque_nm = Some(100.0)), [CheckKind::GearLife]);
}

#[test]
fn buckling_and_ratcheting_are_not_checked_where_the_catalog_has_no_torque_and_exclude_nothing() {
    let (gear, _) = ample();
    let checks = gear_checks(&gear, GearMass::HousedUnit, None, &motion(), &demand());
    let open: Vec<_> = checks.iter().filter(|c| c.needed.is_some() && c.allowed.is_none()).collect();
    assert_eq!(
        open.iter().map(|c| c.to_string()).collect::<Vec<_>>(),
        [
            "buckling not checked: lacks buckling_torque_nm",
            "ratcheting not checked: lacks ratcheting_torque_nm"
        ]
    );
    assert!(all_hold(&checks));
}

#[test]
fn a_brake_holds_what_the_motor_need_not() {
    let brake = |_: &mut Gear, m: &mut Motor, motion: &mut JointMotion, d: &mut JointDemand| {
        (m.rated_torque_nm, motion.has_brake) = (Some(3.5), true);
        d.heat_weights.standing = 0.0;
    };
    assert_eq!(failing(brake), []);
}

#[test]
fn the_bearing_is_checked_if_something_loads_it_and_its_ratings_are_known() {
    // the moment at the bearing's centre: 661 N m plus 0.02 m times 1983 N of radial force are 701 N m
    let loaded = |d: &mut JointDemand| d.bearing = bearing_loads(661.0);
    assert_eq!(failing(|_, _, _, d| loaded(d)), [CheckKind::BearingMoment]);
    let blank = |g: &mut Gear, d: &mut JointDemand| {
        loaded(d);
        g.permissible_tilting_moment_nm = None;
    };
    assert_eq!(failing(|g, _, _, d| blank(g, d)), [], "a blank rating excludes nothing");
    assert_eq!(failing(|g, _, _, _| g.permissible_tilting_moment_nm = None), []);
}

#[test]
fn each_check_of_the_bearing_fails_alone_when_its_own_rating_is_lowered() {
    let with = |change: fn(&mut BearingRatings, &mut JointMotion)| {
        failing(|g, _, motion, d| {
            d.bearing = bearing_loads(500.0);
            change(&mut g.bearing, motion);
        })
    };
    // a stop of 700 N m: P0 = 2100 + 20 (700 + 0.02 2100) + 0.44 1400 = 17556 N, twice that is 35.1 kN; at rest
    // 300 N m: 900 + 20 (300 + 0.02 900) + 0.44 600 = 7524 N, three times that is 22.6 kN
    assert_eq!(with(|b, _| b.static_load_rating_n = Some(35.0e3)), [CheckKind::BearingStop]);
    assert_eq!(
        with(|b, _| b.static_load_rating_n = Some(22.0e3)),
        [CheckKind::BearingRest, CheckKind::BearingStop]
    );
    // Pc = 900 + 20 318 + 0.45 600 = 7530 N; at 0.4 / 1.35 rad/s, 10000 h are 1.70e6 turns: C = 1.3 7530 1.70^0.3
    let turns: f64 = 0.4 / 1.35 / std::f64::consts::TAU * 3600.0 * 1e4;
    let least_n = 1.3 * 7530.0 * libm::pow(turns / 1e6, 0.3);
    assert!((least_n / 11_472.0 - 1.0).abs() < 0.01, "{least_n}");
    assert_eq!(with(|b, _| b.dynamic_load_rating_n = Some(11_300.0)), [CheckKind::BearingLife]);
    assert_eq!(with(|b, _| b.dynamic_load_rating_n = Some(11_700.0)), []);
}

#[test]
fn a_component_set_has_no_bearing_to_tilt() {
    let (gear, _) = ample();
    let demand = demand().with_bearing(bearing_loads(9999.0));
    assert!(all_hold(&gear_checks(
        &gear,
        GearMass::ComponentSet,
        Bearing::of_gear(&gear, GearMass::ComponentSet).as_ref(),
        &motion(),
        &demand
    )));
    assert!(!all_hold(&gear_checks(
        &gear,
        GearMass::HousedUnit,
        Bearing::of_gear(&gear, GearMass::HousedUnit).as_ref(),
        &motion(),
        &demand
    )));
}

#[test]
fn the_life_is_the_vendors_formula() {
    let (gear, _) = ample();
    let checks = gear_checks(
        &gear,
        GearMass::HousedUnit,
        Bearing::of_gear(&gear, GearMass::HousedUnit).as_ref(),
        &motion(),
        &demand(),
    );
    let life = checks.iter().find(|c| c.kind == CheckKind::GearLife).unwrap();
    let mean_rpm = 100.0 * 0.4 / 1.35 * 30.0 / std::f64::consts::PI;
    let by_hand = 10_000.0 * (600.0 / demand().mean_torque_nm()).powi(3) * (2000.0 / mean_rpm);
    assert!((life.allowed.unwrap() / by_hand - 1.0).abs() < 1e-12);
    assert_eq!(life.needed, Some(10_000.0));
}

#[test]
fn a_check_reads_as_needed_and_allowed() {
    let mut gear = hfuc_40_100();
    gear.repeated_peak_torque_nm = Some(523.0);
    let demand = motion().demand_of_torques(376.0, 192.3);
    let checks = gear_checks(
        &gear,
        GearMass::HousedUnit,
        Bearing::of_gear(&gear, GearMass::HousedUnit).as_ref(),
        &motion(),
        &demand,
    );
    assert_eq!(checks[0].to_string(), "peak 568 N m needed, 523 allowed");
}

#[test]
fn numbers_that_round_to_the_same_are_printed_until_they_differ() {
    let near = plain(CheckKind::GearPeak, 523.04, Ok(522.96));
    assert_eq!(near.to_string(), "peak 523.04 N m needed, 522.96 allowed");
}

#[test]
fn a_blank_rating_is_named_and_nothing_else_is_left_unchecked() {
    let (gear, _) = ample();
    let motor = char_lynn_j_8_2();
    let drive = housed(&gear, &motor);
    let checks = checks(&drive, &motion(), &demand());
    let blank: Vec<_> = checks.iter().filter(|c| !c.holds()).map(Check::to_string).collect();
    assert_eq!(
        blank,
        ["peak not checked: lacks rotor_inertia_kgm2", "rms not checked: lacks rotor_inertia_kgm2"]
    );
    assert_eq!(DriveLimits::of(&drive, &motion()), Err(Obstacle::Lacks(MissingRating("rotor_inertia_kgm2"))));
}

#[test]
fn a_blank_mass_is_listed_as_a_check_that_could_not_be_made() {
    assert_eq!(failing(|_, m, _, _| m.mass_kg = None), [CheckKind::Mass]);
}

#[test]
fn a_rated_speed_stands_in_for_a_blank_largest_speed() {
    assert_eq!(failing(|_, m, _, _| m.max_speed_rpm = None), []);
    let slow = |_: &mut Gear, m: &mut Motor, _: &mut JointMotion, _: &mut JointDemand| {
        (m.max_speed_rpm, m.rated_speed_rpm) = (None, Some(700.0));
    };
    assert_eq!(failing(slow), [CheckKind::MotorSpeed]);
}

/// A screw with a lead of 10 mm turns at 1500 rpm where its carriage moves at 0.25 m/s, which is 1500.0000000000002 rpm in
/// floating-point numbers. A speed that is a millionth higher is refused.
#[test]
fn a_speed_that_is_exactly_the_largest_one_holds() {
    for part in [1.0, 1.000_001] {
        let (mut gear, mut motor) = ample();
        let mut motion = motion();
        for _ in 0..20 {
            motion.speed_rad_s *= 0.97;
            let input_rpm = input_speed_rpm(&gear, &motion);
            // the last digit above, as a conversion of units leaves it
            let most_rpm = input_rpm / part * (1.0 - f64::EPSILON);
            (gear.max_input_speed_rpm, motor.max_speed_rpm) = (Some(most_rpm), Some(most_rpm));
            let drive = housed(&gear, &motor);
            let is_speed = |c: &&Check| matches!(c.kind, CheckKind::GearSpeed | CheckKind::MotorSpeed);
            let checks = checks(&drive, &motion, &demand());
            assert!(checks.iter().filter(is_speed).all(|c| c.holds() == (part == 1.0)), "{checks:?}");
            assert_eq!(DriveLimits::of(&drive, &motion).is_ok(), part == 1.0);
        }
    }
}

#[test]
fn what_binds_is_the_smallest_margin() {
    let (gear, motor) = ample();
    let drive = housed(&gear, &motor);
    let mut checks = checks(&drive, &motion(), &demand());
    assert_eq!(binding(&checks).unwrap().kind, CheckKind::GearPeak);
    checks.remove(0);
    assert_eq!(binding(&checks).unwrap().kind, CheckKind::GearMean);
    assert!(binding(&[]).is_none());
}

#[test]
fn a_joint_that_carries_nothing_has_no_end_of_life() {
    let (gear, motor) = (hfuc_40_100(), f11_10());
    let drive = housed(&gear, &motor);
    let checks = checks(&drive, &motion(), &motion().demand_of_torques(0.0, 0.0));
    assert!(all_hold(&checks));
    let life = checks.iter().find(|c| c.kind == CheckKind::GearLife).unwrap();
    assert_eq!(life.allowed, Some(f64::INFINITY));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn thresholds_hold_exactly_when_all_checks_do(
        gear in any_gear(), motor in any_motor(), motion in any_motion(), torques in any_torques(), housed: bool,
        link_m in any_link_m(),
    ) {
        let gear_mass = if housed { GearMass::HousedUnit } else { GearMass::ComponentSet };
        let drive = Drive { gear: &gear, motor: &motor, gear_mass, bearing: BearingSource::OfGear, extras: ExtrasSource::NONE, stage: crate::arm::Stage::NONE };
        let demand = motion
            .demand_of_torques(torques[0], torques[1])
            .with_bearing(bearing_loads(torques[2]))
            .with_room(motion.fit.room(link_m[0], [link_m[1], 0.8 * link_m[1]]));
        let checks = checks(&drive, &motion, &demand);
        let by_thresholds = DriveLimits::of(&drive, &motion).is_ok_and(|l| l.hold(&demand));
        prop_assert_eq!(by_thresholds, all_hold(&checks));
        let limits = BearingLimits::of(drive.bearing().as_ref(), motion.mean_speed_rad_s(), motion.life_h);
        let by_limits = limits.multiple_of(&demand.bearing);
        match bearing_margin(&checks) {
            Some(margin) if margin.is_finite() => prop_assert!((margin / by_limits - 1.0).abs() < 1e-12),
            _ => prop_assert_eq!(by_limits, f64::INFINITY),
        }
        for c in &checks {
            let Some(margin) = c.margin() else {
                prop_assert!(matches!(c.state, CheckState::NotChecked(_)), "{:?}", c);
                continue;
            };
            // The printed numbers give the same result, except for rounding exactly at the limit.
            if (margin - 1.0).abs() > 1e-12 {
                prop_assert_eq!(c.holds(), margin > 1.0, "{:?}", c);
            }
        }
    }
}
