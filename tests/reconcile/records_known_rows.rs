//! Records with rows or columns that a fit must leave out, and with causes that look like an effect of the library.

use super::generator::Dice;
use super::record_simulator::{Joint, Test};
use super::records::{campaign, middling, names, number, outcome, rewrite, test};
use armwright::reconcile::verdict::joint_record::State;
use armwright::reconcile::{Outcome, Verdict};
use std::path::Path;

fn words(outcome: &Outcome) -> String {
    outcome.to_text().split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn jumps_of_the_torque_bias_neither_stiffness_nor_friction() {
    // at other seeds the moves are too equal to tell friction from the load
    for seed in 1..4 {
        let mut dice = Dice(900 + seed);
        let joint = Joint { shift_s: 0.0, ..Joint::random(&mut dice) };
        let test = Test { has_corners: true, torque_noise_nm: 0.2, ..test() };
        let folder = campaign(&joint, &test, Some(joint.stiffness_nm_per_rad), &mut dice);
        let outcome = outcome(folder.path());
        let truths = [
            ("compliance", joint.stiffness_nm_per_rad),
            ("coulomb_friction", joint.coulomb_nm),
            ("viscous_friction", joint.viscous_nms_per_rad),
        ];
        for (what, truth) in truths {
            let (value, low, high) = number(&outcome.records[0], what).expect(what);
            assert!(low <= truth && truth <= high, "{seed}: {what} {value} ({low} to {high}) for {truth}");
        }
        assert!(names(&outcome).is_empty(), "{seed}: {:?}", names(&outcome));
    }
}

/// The outcome of a middling joint whose link's reading has an error of the angle, both in radians.
fn with_error(seed: u64, error_rad: impl Fn(f64) -> f64) -> Outcome {
    let joint = Joint { shift_s: 0.0, ..middling() };
    let test = Test { amplitude_rad: 1.0, ..test() };
    let folder = campaign(&joint, &test, Some(joint.stiffness_nm_per_rad), &mut Dice(seed));
    rewrite(folder.path(), |_, cells| {
        cells[2] += error_rad(cells[2].to_radians()).to_degrees();
        true
    });
    outcome(folder.path())
}

#[test]
fn a_gain_of_the_encoder_and_a_belt_are_no_transmission_error() {
    let gain = with_error(910, |q| 1e-3 * q);
    assert_eq!(gain.verdict, Verdict::Unexplained, "{}", words(&gain));
    assert!(!names(&gain).contains(&"transmission_error"), "{}", words(&gain));
    assert!(words(&gain).contains("in proportion to the angle"), "{}", words(&gain));
    let belt = with_error(911, |q| 4e-4 * (2.7 * q).sin());
    assert_eq!(belt.verdict, Verdict::Unexplained, "{}", words(&belt));
    assert!(words(&belt).contains("2.7 times a turn"), "{}", words(&belt));
    let own = with_error(912, |q| 4e-4 * q.sin() + 2e-4 * (2.0 * q).cos());
    let state = own.records[0].of("transmission_error").map(|s| s.state);
    assert!(state == Some(State::Found) || own.verdict == Verdict::InsufficientData, "{}", words(&own));
}

#[test]
fn an_error_above_the_noise_of_averages_is_no_noise() {
    // a twist of 0.05 mrad under a wave of 0.02 mrad: less than the noise of a row, more than that of its average
    let stiff =
        Joint { shift_s: 0.0, gravity_nm: 1.0, coulomb_nm: 0.3, viscous_nms_per_rad: 0.5, ..middling() };
    let test = Test { amplitude_rad: 0.05, noise_rad: 2e-5, torque_noise_nm: 0.02, ..test() };
    let folder = campaign(&stiff, &test, Some(stiff.stiffness_nm_per_rad), &mut Dice(920));
    rewrite(folder.path(), |_, cells| {
        cells[2] += 2e-5f64.to_degrees() * libm::sin(80.0 * cells[1].to_radians());
        true
    });
    let outcome = outcome(folder.path());
    assert!(!matches!(outcome.verdict, Verdict::NoGap | Verdict::Explained), "{}", words(&outcome));
}

/// Writes the record with its head changed by `head`.
fn rename(folder: &Path, head: impl Fn(&str) -> String) {
    let path = folder.join("record.csv");
    let text = std::fs::read_to_string(&path).expect("text");
    let (first, rest) = text.split_once('\n').expect("a head");
    std::fs::write(path, format!("{}\n{rest}", head(first))).expect("written");
}

#[test]
fn columns_that_are_not_used_and_times_in_milliseconds_are_said() {
    let joint = middling();
    let folder = campaign(&joint, &test(), Some(joint.stiffness_nm_per_rad), &mut Dice(930));
    assert!(!words(&outcome(folder.path())).contains("not used"));
    rename(folder.path(), |head| head.replace("j1_motor_torque_nm", "j1_torque_nm"));
    let text = words(&outcome(folder.path()));
    assert!(text.contains("columns that are not used: j1_torque_nm"), "{text}");
    rewrite(folder.path(), |_, cells| {
        cells[0] *= 1000.0;
        true
    });
    let text = words(&outcome(folder.path()));
    assert!(text.contains("milliseconds"), "{text}");
}

#[test]
fn a_viscous_friction_that_is_refused_widens_the_time_shift() {
    // a friction at rest that drives the motion, and a viscous one above the largest torque of the motor
    let joint = Joint { gravity_nm: 30.0, ..middling() };
    let folder = campaign(&joint, &test(), Some(joint.stiffness_nm_per_rad), &mut Dice(940));
    let mut last_deg = f64::NAN;
    let path = folder.path().join("record.csv");
    let text = std::fs::read_to_string(&path).expect("text");
    let rows = text.lines().enumerate().map(|(row, line)| {
        let mut cells: Vec<f64> = line.split(',').filter_map(|cell| cell.parse().ok()).collect();
        if row == 0 || cells.len() < 4 {
            return line.to_string();
        }
        let speed = if last_deg.is_nan() { 0.0 } else { (cells[1] - last_deg).to_radians() / 2e-3 };
        last_deg = cells[1];
        cells[3] = 300.0 * speed - 250.0 * (speed / 0.02).tanh();
        cells.iter().map(f64::to_string).collect::<Vec<_>>().join(",")
    });
    let changed = rows.collect::<Vec<_>>().join("\n");
    std::fs::write(&path, changed).expect("written");
    let outcome = outcome(folder.path());
    println!("{}", outcome.to_text());
    let stated = outcome.records[0].of("time_shift").expect("stated");
    let shift = &stated.parameters[0].1[0];
    let half_s = 0.5 * (shift.high.expect("an end") - shift.low.expect("an end"));
    assert!(half_s > 5e-4, "{shift:?}");
}
