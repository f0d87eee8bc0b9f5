//! Motor heat in the searches: random small studies whose drives the root mean square of the motor's torque decides.
//!
//! `ARMWRIGHT_HEAT_STUDIES=300 cargo test --release --test design motor_heat` runs more of them.

use crate::dice::Dice;
use crate::exact_front::random_study;
use crate::exact_support::{both_searches, judged, read};
use crate::witness_drives::{faults, front};
use armwright::catalog::Catalogs;
use armwright::search::Sweep;
use armwright::space::ArmProblem;
use armwright::study::Study;
use serde_json::{Value, json};
use std::sync::atomic::AtomicBool;

fn studies() -> u64 {
    std::env::var("ARMWRIGHT_HEAT_STUDIES").ok().and_then(|n| n.parse().ok()).unwrap_or(16)
}

/// A cycle with short rests, steep ramps or none, and phases at part load.
fn cycle(dice: &mut Dice) -> Value {
    let ramp_s = dice.within(0.1, 0.3);
    let mut cycle = vec![
        json!({"phase": "accelerate", "time_s": ramp_s}),
        json!({"phase": "constant", "time_s": dice.within(0.0, 0.5)}),
        json!({"phase": "decelerate", "time_s": ramp_s}),
        json!({"phase": "rest", "time_s": dice.within(0.0, 0.6)}),
    ];
    if dice.below(2) == 0 {
        let speed = dice.of(&[0.0, 0.5]);
        cycle.push(json!({"phase": "fraction", "time_s": 0.2, "of_static_torque": 0.9, "of_speed": speed}));
    }
    json!(cycle)
}

/// Lets the motors of a study work hard: quick ramps, short rests, some brakes, now and then a joint with a duty of its own.
pub fn add_heat(study: &mut Value, seed: u64) {
    let dice = &mut Dice(seed.wrapping_mul(104_729).wrapping_add(5));
    study["motion"] = json!({"tip_speed_m_s": dice.within(0.5, 1.2), "ramp_time_s": dice.within(0.08, 0.25)});
    if dice.below(2) == 0 {
        study["motion"]["cycle"] = cycle(dice);
    }
    if dice.below(4) == 0 {
        study["motion"]["emergency_stops"] = json!(dice.within(1000.0, 6000.0));
    }
    for piece in study["chain"].as_array_mut().expect("a chain") {
        if piece["drive"].is_null() {
            continue;
        }
        if dice.below(3) == 0 {
            piece["brake"] = json!(true);
        }
        if dice.below(6) == 0 {
            let (full_rpm, most_nm) = (dice.within(4.0, 9.0), dice.within(20.0, 80.0));
            piece["duty"] = json!([
                {"torque_nm": most_nm, "time_s": 0.2, "speed_rpm": 0.5 * full_rpm},
                {"torque_nm": 0.6 * most_nm, "time_s": 0.6, "speed_rpm": full_rpm},
                {"torque_nm": -0.3 * most_nm, "time_s": 0.2, "speed_rpm": 0.5 * full_rpm},
                {"torque_nm": 0.5 * most_nm, "time_s": dice.within(0.0, 1.0), "speed_rpm": 0.0}]);
        }
    }
}

/// A study whose drives motor heat decides. In every other one the bearings are rigid: what no bearing limits, motors do.
fn hot_study(seed: u64) -> Value {
    let mut study = random_study(seed);
    add_heat(&mut study, seed);
    let joints =
        study["chain"].as_array_mut().expect("a chain").iter_mut().filter(|p| p["drive"].is_string());
    if seed.is_multiple_of(2) {
        joints.for_each(|joint| joint["bearing"] = Value::Null);
    }
    study
}

/// The same study without the check.
pub fn unheated(study: &Study) -> Study {
    let mut study = study.clone();
    study.space.motion.checks_motor_heat = false;
    study
}

fn swept(study: &Study, catalogs: &Catalogs) -> Vec<u128> {
    let problem = ArmProblem::new(&study.space, catalogs);
    let sweep = Sweep::new(&problem, study.space.constraints, &AtomicBool::new(false)).run();
    judged(&problem, &sweep.front)
}

#[test]
fn the_exact_front_is_the_front_of_every_design_where_motor_heat_decides() {
    let catalogs = Catalogs::builtin();
    let (mut points, mut decided) = (0, 0);
    for seed in 0..studies() {
        let text = hot_study(seed);
        let study = read(&text, &catalogs);
        let problem = ArmProblem::new(&study.space, &catalogs);
        let (front, listed) = both_searches(&study, &catalogs, false, &format!("seed {seed}: {text}"));
        points += listed;
        decided += u64::from(judged(&problem, &front) != swept(&unheated(&study), &catalogs));
    }
    println!("{} studies, heat decides {decided}, {points} front designs, the same in both", studies());
    assert!(decided * 6 > studies(), "heat decides only {decided} of {}", studies());
    assert!(points as u64 > 5 * studies(), "fronts are too small to say much: {points} designs");
}

#[test]
fn the_verifier_finds_the_drives_that_a_search_takes_or_drops_by_wrong_heat() {
    let catalogs = Catalogs::builtin();
    let (mut forgot, mut pruned) = (0, 0);
    for seed in 0..studies() {
        let truth = read(&hot_study(seed), &catalogs);
        let rows = front(&truth, &catalogs, &catalogs);
        assert_eq!(faults(&truth, &catalogs, &rows), [0, 0], "seed {seed}");
        // a search that forgets the check takes drives that do not hold
        let forgetful = front(&unheated(&truth), &catalogs, &catalogs);
        if forgetful.iter().any(|row| !rows.contains(row)) {
            assert!(faults(&truth, &catalogs, &forgetful)[0] > 0, "seed {seed}");
            forgot += 1;
        }
        // a search whose motors are weaker at speed than they are drops drives that hold
        let mut weaker = catalogs.clone();
        weaker
            .motors
            .iter_mut()
            .for_each(|m| m.rated_speed_rpm = m.rated_speed_rpm.or(m.max_speed_rpm).map(|n| 0.2 * n));
        let strict = front(&truth, &weaker, &catalogs);
        if rows.iter().any(|row| !strict.contains(row)) {
            let [wrong, missing] = faults(&truth, &catalogs, &strict);
            assert!(wrong + missing > 0, "seed {seed}");
            pruned += u64::from(missing > 0);
        }
    }
    println!("{} studies: check forgotten in {forgot}, drives dropped in {pruned}", studies());
    assert!(6 * forgot > studies() && 6 * pruned > studies(), "{forgot}, {pruned}");
}
