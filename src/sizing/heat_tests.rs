//! Tests of the heating of motors: comparison with a motion that is stepped through in time, and bounds over random
//! members of boxes.

use super::super::duty::{DutyCycle, HeatWeights, Phase, PhaseKind};
use super::super::limits::DriveLimits;
use super::super::requirement::MotionRequirement;
use super::super::stated::{StatedDuty, StatedPhase};
use super::super::testing::{any_gear, any_motion, any_motor, component_set, gear, motor};
use super::*;
use crate::catalog::gear::{Gear, GearKind, LifeLaw};
use crate::catalog::motor::Motor;
use crate::sizing::motor_curve::continuous_torque_nm;
use proptest::prelude::*;

fn motion() -> JointMotion {
    MotionRequirement::default().joint_motion(1.0, None)
}

fn parts() -> (Gear, Motor) {
    let gear = gear("CSG-50-100", [600.0, 900.0, 700.0, 2000.0], [3500.0, 2500.0], 0.00125, [3.2, 8.9]);
    (gear, motor("M", [4.0, 20.0], [3000.0, 4000.0], 0.0003, 4.0))
}

/// Root mean square of the motor's torque over a cycle that is stepped through in time \[N m\]. The joint lifts
/// (`direction` is 1) or lowers its load; positive torques lift.
fn simulated_rms_nm(drive: &Drive, motion: &JointMotion, [t_nm, t_lin_nm]: [f64; 2], direction: f64) -> f64 {
    const STEPS: usize = 200;
    let (ratio, efficiency) = (drive.ratio(), drive.efficiency().unwrap());
    let (inertia_kgm2, alpha) = (drive.input_inertia_kgm2().unwrap(), motion.acceleration_rad_s2);
    let outboard_kgm2 = t_lin_nm / alpha;
    let (ramp_s, whole_s) = (motion.ramp_time_s, 10.0 * motion.ramp_time_s);
    let dt_s = ramp_s / STEPS as f64;
    let squares: f64 = (0..10 * STEPS)
        .map(|step| {
            let t_s = (step as f64 + 0.5) * dt_s;
            let (speed, acceleration) = match t_s / ramp_s {
                r if r < 1.0 => (alpha * t_s, alpha),
                r if r < 4.0 => (alpha * ramp_s, 0.0),
                r if r < 5.0 => (alpha * (5.0 * ramp_s - t_s), -alpha),
                _ => (0.0, 0.0),
            };
            let output_nm = t_nm + outboard_kgm2 * direction * acceleration;
            let power_w = output_nm * direction * speed;
            let through_gear_nm = match power_w < 0.0 {
                true => output_nm * efficiency / ratio,
                false => output_nm / (ratio * efficiency),
            };
            let rests_with_brake = speed == 0.0 && motion.has_brake;
            let motor_nm = through_gear_nm + inertia_kgm2 * ratio * direction * acceleration;
            if rests_with_brake { 0.0 } else { motor_nm * motor_nm }
        })
        .sum();
    (squares * dt_s / whole_s).sqrt()
}

#[test]
fn the_mean_square_is_that_of_the_worse_direction_stepped_through_in_time() {
    let (gear, motor) = parts();
    let drive = component_set(&gear, &motor);
    for has_brake in [false, true] {
        let motion = motion().of_joint(None, has_brake, None);
        for torques in [[0.0, 80.0], [100.0, 40.0], [40.0, 100.0], [100.0, 98.0], [250.0, 0.0], [0.0, 0.0]] {
            let demand = motion.demand_of_torques(torques[0], torques[1]);
            let share = MotorHeat::of(&drive, &motion).unwrap().share_squared(&demand).sqrt();
            let [lift, lower] = [1.0, -1.0].map(|to| simulated_rms_nm(&drive, &motion, torques, to));
            assert!(lift >= lower, "{torques:?}: {lift}, {lower}");
            assert!((share * 4.0 - lift).abs() < 1e-9 * lift, "{torques:?}: {share}, simulated {lift}");
        }
    }
}

#[test]
fn a_vertical_axis_heats_its_motor_by_its_ramps_alone() {
    // inertia outboard 4 kg m², ratio 100, η = 0.78, acceleration 5 rad/s²
    let (gear, motor) = parts();
    let drive = component_set(&gear, &motor);
    let demand = motion().demand(0.0, 4.0);
    let (own, driving, driven): (f64, f64, f64) = (0.00155 * 100.0 * 5.0, 20.0 / 78.0, 20.0 * 0.78 / 100.0);
    let by_hand: f64 =
        (((driving + own) * (driving + own) + (driven + own) * (driven + own)) / 10.0).sqrt() / 4.0;
    let share = MotorHeat::of(&drive, &motion()).unwrap().share_squared(&demand).sqrt();
    assert!((share / by_hand - 1.0).abs() < 1e-12, "{share}, by hand {by_hand}");
}

#[test]
fn the_worked_example_of_a_vertical_axis() {
    // CSG-20-100 with MF0060008 at the base of a six-axis arm: linear torque 82.94 N m, acceleration 5 / 1.35 rad/s²
    let motion = MotionRequirement::default().joint_motion(1.35, None);
    let mut gear = gear("CSG-20-100", [52.0, 107.0, 64.0, 191.0], [6500.0, 3500.0], 1.93e-5, [0.28, 0.98]);
    gear.efficiency = Some(0.78);
    let motor = motor("MF0060008", [0.29, 2.3], [4140.0, 4469.0], 2.1e-5, 0.13);
    let drive = component_set(&gear, &motor);
    let own = drive.rotary_torque_motor_nm(&motion).unwrap();
    let (up, down) = (82.94 / 78.0 + own, -82.94 * 0.78 / 100.0 - own);
    assert!((up - 1.078).abs() < 1e-3 && (down + 0.662).abs() < 1e-3, "{up}, {down}");
    let share = MotorHeat::of(&drive, &motion).unwrap().share_squared(&motion.demand_of_torques(0.0, 82.94));
    assert!((share.sqrt() * 0.29 - 0.400).abs() < 5e-4, "{}", share.sqrt() * 0.29);
    assert!(!DriveLimits::of(&drive, &motion).unwrap().hold(&motion.demand_of_torques(0.0, 82.94)));
}

#[test]
fn beyond_the_rated_speed_a_motor_gives_its_rated_power() {
    let (_, motor) = parts();
    let at = |rpm| continuous_torque_nm(&motor, rpm).unwrap();
    assert_eq!((at(0.0), at(3000.0), at(4000.0)), (4.0, 4.0, 3.0));
    let unknown = Motor { rated_speed_rpm: None, ..motor };
    assert_eq!(continuous_torque_nm(&unknown, 4000.0), Ok(4.0));
}

#[test]
fn a_study_may_turn_the_check_off() {
    let (gear, motor) = parts();
    let off = MotionRequirement { checks_motor_heat: false, ..Default::default() }.joint_motion(1.0, None);
    assert_eq!(MotorHeat::of(&component_set(&gear, &motor), &off), Ok(MotorHeat::NONE));
}

#[test]
fn a_stated_duty_heats_the_motor_phase_by_phase() {
    let (gear, motor) = parts();
    let drive = component_set(&gear, &motor);
    let phase = |torque_nm, time_s, speed_rpm| StatedPhase { torque_nm, time_s, speed_rpm };
    let phases =
        vec![phase(200.0, 0.3, 7.0), phase(100.0, 3.0, 14.0), phase(-50.0, 0.4, 7.0), phase(90.0, 0.3, 0.0)];
    let duty = StatedDuty { phases };
    // ramps to and from 14 rpm in 0.3 s and 0.4 s; inertia of rotor and gear input 0.00155 kg m²
    let speed = 14.0 * std::f64::consts::PI / 30.0;
    let own = |ramp_s: f64| 0.00155 * 100.0 * speed / ramp_s;
    let motor_nm = [200.0 / 78.0 + own(0.3), 100.0 / 78.0, -50.0 * 0.78 / 100.0 - own(0.4), 90.0 / 78.0];
    for (has_brake, standing) in [(false, 1.0), (true, 0.0)] {
        let motion = motion().of_joint(None, has_brake, Some(&duty));
        let weights = [0.3, 3.0, 0.4, 0.3 * standing];
        let mean: f64 = (0..4).map(|i| weights[i] * motor_nm[i] * motor_nm[i]).sum::<f64>() / 4.0;
        let heat = MotorHeat::of(&drive, &motion).unwrap();
        let share = heat.share_squared(&motion.demand_of_torques(1e4, 1e4)).sqrt();
        assert!((share * 4.0 / mean.sqrt() - 1.0).abs() < 1e-12, "{share}, by hand {}", mean.sqrt() / 4.0);
    }
}

#[test]
fn a_stated_duty_sets_speed_ramp_mean_and_peak_and_the_arm_may_ask_for_more() {
    let phase = |torque_nm, time_s, speed_rpm| StatedPhase { torque_nm, time_s, speed_rpm };
    let phases =
        vec![phase(40.0, 0.3, 7.0), phase(30.0, 3.0, 14.0), phase(20.0, 0.4, 7.0), phase(0.0, 0.2, 0.0)];
    let duty = StatedDuty { phases };
    let motion = motion().of_joint(None, false, Some(&duty));
    assert!((motion.speed_rad_s * 30.0 / std::f64::consts::PI - 14.0).abs() < 1e-12);
    assert!((motion.ramp_time_s - 0.3).abs() < 1e-12 && (motion.stop_time_s() - 0.15).abs() < 1e-12);
    let (light, heavy) = (motion.demand_of_torques(10.0, 2.0), motion.demand_of_torques(100.0, 2.0));
    assert_eq!((light.peak_torque_nm(), heavy.peak_torque_nm()), (40.0, 102.0));
    assert_eq!((light.stop_torque_nm, heavy.stop_torque_nm), (40.0, 104.0));
    assert_eq!(light.mean_torque_cubed_nm3, heavy.mean_torque_cubed_nm3);
}

fn any_heat() -> impl Strategy<Value = MotorHeat> {
    (1e-4..0.1f64, 0.3..1.0f64, 0.0..1.2f64, 0.0..0.3f64).prop_map(|(driving, efficiency, own, stated)| {
        MotorHeat {
            driving_per_nm: driving,
            driven_per_nm: driving * efficiency * efficiency,
            own_share: own,
            stated_share_squared: stated,
        }
    })
}

/// Weights of a random cycle that slows down no longer than it speeds up.
fn any_cycle() -> impl Strategy<Value = HeatWeights> {
    (0.0..0.3f64, 0.0..0.4f64, 0.0..=1.0f64, 0.0..0.3f64).prop_map(|(sum, steady, part, standing)| {
        HeatWeights { sum, steady, difference: part * sum, standing }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    /// The lower bound of the exact search: the least torques of a box of designs, together with the least numbers of a
    /// box of drives, give no more heat than any member has.
    #[test]
    fn the_least_numbers_of_a_box_bound_the_heat_of_every_member(
        drives in prop::collection::vec(any_heat(), 1..5),
        torques in prop::collection::vec((0.0..200.0f64, 0.0..200.0f64), 1..5),
        weights in any_cycle(),
    ) {
        let demand = |t_nm: f64, lin_nm: f64| {
            let plain = motion().demand_of_torques(t_nm, lin_nm);
            super::super::JointDemand { heat_weights: weights, ..plain }
        };
        let least = |pick: fn(&(f64, f64)) -> f64| torques.iter().map(pick).fold(f64::INFINITY, f64::min);
        let box_of_drives = drives.iter().copied().reduce(|a, b| a.least(&b)).unwrap();
        let bound = box_of_drives.share_squared(&demand(least(|t| t.0), least(|t| t.1)));
        for heat in &drives {
            prop_assert!(box_of_drives.covers(heat));
            for (t_nm, lin_nm) in &torques {
                let member = heat.share_squared(&demand(*t_nm, *lin_nm));
                prop_assert!(bound <= member * (1.0 + 1e-12), "{} above {}", bound, member);
            }
        }
    }

    #[test]
    fn the_largest_multiple_of_a_demand_is_where_the_motor_is_just_warm(
        heat in any_heat(), weights in any_cycle(), t_nm in 0.0..200.0f64, lin_nm in 0.0..200.0f64,
    ) {
        let plain = motion().demand_of_torques(t_nm, lin_nm);
        let demand = super::super::JointDemand { heat_weights: weights, ..plain };
        let at = |factor: f64| heat.share_squared(&demand.scaled(factor));
        match heat.multiple_of(&demand) {
            0.0 => prop_assert!(at(0.0) > 1.0),
            k if k.is_finite() => {
                prop_assert!(at(k) >= 1.0 - 1e-9, "{}", at(k));
                prop_assert!(at(k * (1.0 - 1e-5) - 1e-9) <= 1.0 || at(0.0) > 1.0 - 1e-9);
            }
            _ => prop_assert!(at(1e6) <= 1.0),
        }
    }

    /// Dominance of drives: a drive that covers another meets every demand that the other meets.
    #[test]
    fn a_drive_that_covers_another_holds_what_it_holds(
        gears in prop::array::uniform2(any_gear()), motors in prop::array::uniform2(any_motor()),
        motion in any_motion(), t_nm in 0.0..400.0f64, lin_nm in 0.0..400.0f64,
    ) {
        let limits = |i: usize| DriveLimits::of(&component_set(&gears[i], &motors[i]), &motion);
        if let (Ok(a), Ok(b)) = (limits(0), limits(1)) {
            let demand = motion.demand_of_torques(t_nm, lin_nm);
            prop_assert!(!(a.cover(&b) && b.hold(&demand)) || a.hold(&demand));
            prop_assert!(!(a.hold(&demand) || b.hold(&demand)) || a.max(&b).hold(&demand));
            prop_assert!(!a.min(&b).hold(&demand) || (a.hold(&demand) && b.hold(&demand)));
        }
    }
}

#[test]
fn the_default_cycle_slows_down_as_long_as_it_speeds_up() {
    let weights = DutyCycle::move_and_rest(0.3).heat_weights();
    assert_eq!(weights.sum, weights.difference);
}

/// Harmonic Drive SE, manual of the CHA series, 1018854 (12/2015), pages 64 to 67: an FHA-25C-50 with 0.86 kg m² at its
/// output turns 1.3 kg m² against 5 N m up to 40 rpm. It speeds up, moves and slows down for 0.1 s each and rests 1.0 s
/// without torque. The manual rounds: 93 and 95 N m of 151, 35 N m as root mean square, 6 rpm as mean.
#[test]
fn the_makers_example_of_an_integrated_actuator_comes_out() {
    let gear = Gear {
        kind: GearKind::Actuator,
        life: LifeLaw::usual(GearKind::Actuator),
        efficiency: None,
        inertia_input_kgm2: None,
        ..gear("FHA25C-25-50", [1.0, 1.0, 1.0, 1.0], [1.0, 1.0], 0.0, [0.0, 4.0])
    };
    // the manual's ratings at the output, converted to the motor, which turns 50 times as fast
    let motor =
        motor("FHA-25C-50", [40.0 / 50.0, 151.0 / 50.0], [50.0 * 45.0, 50.0 * 90.0], 0.86 / 2500.0, 0.0);
    let phase = |duration_s, kind| Phase { duration_s, kind };
    let duty_cycle = DutyCycle {
        phases: vec![
            phase(0.1, PhaseKind::Accelerate),
            phase(0.1, PhaseKind::Constant),
            phase(0.1, PhaseKind::Decelerate),
            phase(1.0, PhaseKind::Rest),
        ],
    };
    let asked = MotionRequirement { ramp_time_s: 0.1, duty_cycle, ..Default::default() };
    let speed_rad_s = 40.0 * std::f64::consts::PI / 30.0;
    let motion = asked.joint_motion(1.0, Some(speed_rad_s)).of_joint(Some(speed_rad_s), true, None);
    let demand = motion.demand(5.0, 1.3);
    let drive = component_set(&gear, &motor);
    let peak_nm = drive.peak_motor_torque_nm(&motion, demand.peak_torque_nm()).unwrap() * 50.0;
    let by_hand = 5.0 + (1.3 + 0.86) * speed_rad_s / 0.1;
    assert!((peak_nm - by_hand).abs() < 1e-9 && (peak_nm - 95.0).abs() < 0.6, "{peak_nm}");
    let continuous_nm = continuous_torque_nm(&motor, drive.motor_speed_rpm(&motion)).unwrap() * 50.0;
    let rms_nm = MotorHeat::of(&drive, &motion).unwrap().share_squared(&demand).sqrt() * continuous_nm;
    assert!((rms_nm - 35.0).abs() < 0.6, "{rms_nm}");
    let mean_rpm = crate::sizing::rpm_from_rad_s(motion.mean_speed_rad_s());
    assert!((mean_rpm - 6.0).abs() < 0.2, "{mean_rpm}");
}
