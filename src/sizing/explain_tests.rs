//! Tests of the explanations why no drive, or no lighter drive, holds.

use super::super::testing::{char_lynn_j_8_2, f11_10, hfuc_40_100, hfuc_58_100, motor};
use super::*;
use crate::catalog::gear::GearMass;
use crate::catalog::motor::Motor;
use crate::sizing::demand::JointMotion;
use crate::sizing::requirement::MotionRequirement;
use crate::sizing::select::DriveFilter;
use crate::sizing::stated::{StatedDuty, StatedPhase};

fn motion() -> JointMotion {
    MotionRequirement::default().joint_motion(1.35, None)
}

fn table<'c>(gears: &'c [Gear], motors: &'c [Motor]) -> DriveTable<'c> {
    DriveTable::build("j2", motion(), &DriveFilter::everything(GearMass::ComponentSet), gears, motors)
}

fn small_motor() -> Motor {
    motor("HG-KR43", [1.3, 4.5], [3000.0, 6000.0], 0.0000371, 1.4)
}

fn lines(rejections: &[Rejection]) -> Vec<String> {
    rejections.iter().map(Rejection::to_string).collect()
}

#[test]
fn a_gear_that_fails_alone_says_so() {
    let (mut weak, motors) = (hfuc_40_100(), [f11_10()]);
    weak.repeated_peak_torque_nm = Some(523.0);
    let gears = [weak, hfuc_58_100()];
    let rejections = table(&gears, &motors).explain(&motion().demand_of_torques(376.0, 192.3));
    let first = rejections[0].to_string();
    assert!(first.starts_with("joint j2: HFUC-40-100 peak 568 N m needed, 523 allowed; mean "), "{first}");
    assert_eq!(rejections.len(), 1, "the other gear and the motor hold");
}

#[test]
fn a_motor_that_is_too_small_names_the_gear_with_which_it_comes_nearest() {
    let (gears, motors) = ([hfuc_58_100(), hfuc_40_100()], [small_motor(), f11_10()]);
    let rejections = table(&gears, &motors).explain(&motion().demand_of_torques(200.0, 100.0));
    assert_eq!(
        lines(&rejections),
        [
            "joint j2: HG-KR43 behind HFUC-40-100 rms 2.65 N m needed, 1.30 allowed; hold 2.56 N m needed, 1.30 allowed \
          (rejected with 2 of 2 gears that hold)"
        ]
    );
}

#[test]
fn a_gear_that_holds_but_finds_no_motor_says_which_came_nearest() {
    let (gears, motors) = ([hfuc_58_100()], [small_motor()]);
    let rejections = table(&gears, &motors).explain(&motion().demand_of_torques(200.0, 0.0));
    assert_eq!(
        rejections[0].part,
        RejectedPart::GearWithoutMotor { gear: "HFUC-58-100".into(), nearest_motor: "HG-KR43".into() }
    );
    assert!(rejections[0].to_string().contains("HFUC-58-100 finds no motor, nearest HG-KR43: rms"));
    assert_eq!(rejections.len(), 2);
}

#[test]
fn a_motor_may_fail_behind_one_gear_and_hold_behind_another() {
    let mut fast = hfuc_40_100();
    (fast.id, fast.ratio) = ("HFUC-40-160".into(), 160.0);
    let slow_motor = motor("SLOW", [5.0, 9.0], [800.0, 800.0], 0.0001, 3.0);
    let (gears, motors) = ([fast, hfuc_40_100()], [slow_motor]);
    let rejections = table(&gears, &motors).explain(&motion().demand_of_torques(200.0, 100.0));
    let part = RejectedPart::Motor {
        motor: "SLOW".into(),
        nearest_gear: "HFUC-40-160".into(),
        rejected_with: vec!["HFUC-40-160".into()],
        fits_with: vec!["HFUC-40-100".into()],
    };
    assert!(rejections.iter().any(|r| r.part == part), "{:?}", lines(&rejections));
}

#[test]
fn a_part_with_blank_ratings_is_listed_as_not_checked() {
    let (gears, motors) = ([hfuc_40_100()], [char_lynn_j_8_2()]);
    let rejections = table(&gears, &motors).explain(&motion().demand_of_torques(100.0, 50.0));
    assert!(rejections.iter().all(Rejection::is_not_checked));
    assert!(
        rejections[1]
            .to_string()
            .contains("J 8.2 (129-) behind HFUC-40-100 peak not checked: lacks rotor_inertia_kgm2")
    );
    assert_eq!(table(&gears, &motors).smallest_shortfall(&motion().demand_of_torques(100.0, 50.0)), None);
}

#[test]
fn everything_that_is_no_fit_is_explained() {
    let gears = [hfuc_40_100(), hfuc_58_100()];
    let motors = [small_motor(), f11_10(), char_lynn_j_8_2()];
    let table = table(&gears, &motors);
    for static_nm in [50.0, 150.0, 400.0, 600.0, 5000.0] {
        let demand = motion().demand_of_torques(static_nm, 0.4 * static_nm);
        let rejections = table.explain(&demand);
        for drive in table.all_drives() {
            let fits = table.index_of(&drive.gear.id, &drive.motor.id);
            let fits = fits.is_some_and(|i| table.all_fits(&demand).any(|j| i == j));
            let explained = rejections.iter().any(|r| match &r.part {
                RejectedPart::Gear { gear } => *gear == drive.gear.id,
                RejectedPart::GearWithoutMotor { .. } | RejectedPart::Actuator { .. } => false,
                RejectedPart::Motor { motor, rejected_with, .. } => {
                    *motor == drive.motor.id && rejected_with.contains(&drive.gear.id)
                }
            });
            assert_ne!(fits, explained, "{} at {static_nm}", drive.name());
        }
    }
}

/// The motor is warm through the duty alone. The factor that is named is that with which the duty itself, written with
/// smaller torques, passes.
#[test]
fn a_smaller_torque_is_smaller_in_the_duty_that_heats_the_motor_too() {
    let (gears, motors) = ([hfuc_58_100()], [small_motor()]);
    let duty = |factor: f64| StatedDuty {
        phases: [(300.0, 4.0, 10.0), (250.0, 20.0, 8.0), (0.0, 1.0, 0.0)]
            .map(|(nm, time_s, speed_rpm)| StatedPhase { torque_nm: nm * factor, time_s, speed_rpm })
            .to_vec(),
    };
    let moving = |factor: f64| {
        JointMotion { checks_motor_heat: true, ..motion() }.of_joint(None, false, Some(&duty(factor)))
    };
    let table = |factor: f64| {
        let filter = DriveFilter::everything(GearMass::ComponentSet);
        DriveTable::build("j2", moving(factor), &filter, &gears, &motors)
    };
    let fits = |factor: f64| {
        table(factor).first_fit(&moving(factor).demand_of_torques(50.0 * factor, 20.0 * factor)).is_some()
    };
    let shortfall =
        table(1.0).smallest_shortfall(&moving(1.0).demand_of_torques(50.0, 20.0)).expect("too hot");
    assert_eq!(shortfall.check.kind, CheckKind::MotorRms);
    let torque = shortfall.relaxations.iter().find(|r| r.kind == RelaxationKind::Torque).expect("a step");
    assert!(fits(torque.factor) && !fits(torque.factor + 0.01), "{}", torque.factor);
}

#[test]
fn when_nothing_holds_the_nearest_drive_and_the_smallest_step_are_named() {
    let (gears, motors) = ([hfuc_40_100(), hfuc_58_100()], [f11_10()]);
    let table = table(&gears, &motors);
    let demand = motion().demand_of_torques(1200.0, 600.0);
    let shortfall = table.smallest_shortfall(&demand).unwrap();
    assert_eq!(shortfall.drive, "HFUC-58-100 + F11-10");
    assert_eq!(shortfall.check.kind, CheckKind::GearMean);
    let torque = &shortfall.relaxations.iter().find(|r| r.kind == RelaxationKind::Torque).unwrap();
    assert!(table.first_fit(&demand.scaled(torque.factor)).is_some());
    assert!(table.first_fit(&demand.scaled(torque.factor + 0.01)).is_none());
    assert!(shortfall.relaxations.windows(2).all(|w| w[0].factor >= w[1].factor));
    let text = shortfall.to_string();
    assert!(text.starts_with("joint j2: no drive holds; nearest HFUC-58-100 + F11-10: mean "), "{text}");
    assert!(text.contains("smallest relaxation that helps: torque on the joint"), "{text}");
}

#[test]
fn a_joint_that_is_only_too_fast_needs_only_less_speed() {
    let (gears, motors) = ([hfuc_58_100()], [f11_10()]);
    let fast = MotionRequirement::default().joint_motion(1.35, Some(4.0));
    let filter = DriveFilter::everything(GearMass::ComponentSet);
    let table = DriveTable::build("j2", fast, &filter, &gears, &motors);
    let shortfall = table.smallest_shortfall(&fast.demand_of_torques(100.0, 50.0)).unwrap();
    assert_eq!(shortfall.check.kind, CheckKind::GearSpeed);
    assert_eq!(shortfall.relaxations.len(), 1, "no torque is small enough");
    // 3000 rpm at a ratio of 100 is 3.14 rad/s, which is 78 % of the 4 rad/s that are asked for
    assert_eq!(shortfall.relaxations[0].factor, 0.78);
    assert!(
        shortfall
            .to_string()
            .contains("speed, acceleration and emergency deceleration down to 78 %, then HFUC-58-100")
    );
}

#[test]
fn less_speed_takes_its_share_off_the_linear_torque() {
    let (gears, motors) = ([hfuc_40_100()], [f11_10()]);
    let table = table(&gears, &motors);
    // A vertical axis has linear torque only: 600 N m, while the gear's repeated peak allows 568 N m.
    let shortfall = table.smallest_shortfall(&motion().demand_of_torques(0.0, 600.0)).unwrap();
    let slower = shortfall.relaxations.iter().find(|r| r.kind == RelaxationKind::Speed).unwrap();
    assert_eq!(slower.factor, 0.90, "1200 N m in an emergency stop, 1080 allowed");
    assert!(shortfall.to_string().contains("stop 1200 N m needed, 1080 allowed (short by 120 N m)"));
}

#[test]
fn a_shortfall_of_torque_is_a_larger_one_of_the_payload_alone() {
    let step = Relaxation {
        kind: RelaxationKind::Torque,
        factor: 0.9,
        has_duty: false,
        slides: false,
        drive: String::new(),
    };
    assert!(step.to_string().starts_with("torque on the joint (payload, outboard mass, reach) down to 90 %"));
    let of_duty = Relaxation { has_duty: true, ..step.clone() };
    assert!(of_duty.to_string().contains("reach, and the torques of its duty)"));
    assert!((step.payload_factor(0.4).unwrap() - 0.75).abs() < 1e-12);
    assert_eq!(step.payload_factor(0.05), None);
}
