//! The exact search against visiting every design where everything that an arm could fail by may decide at once: bearings that
//! tilt and limit, motor heat, parts that must fit, and what joints weigh beyond their drives.
//!
//! `ARMWRIGHT_EXACT_STUDIES=500 cargo test --release --test design whole_arms` runs more of them.

use crate::dice::Dice;
use crate::exact_bearings::{add_bearings, change_bearings};
use crate::exact_front::random_study;
use crate::exact_support::{both_searches, judged, read};
use crate::fits::{add_fits, change_sizes};
use crate::motor_heat::{add_heat, unheated};
use crate::prismatic::add_prismatic;
use crate::witness_drives::{faults, front};
use armwright::catalog::Catalogs;
use armwright::search::Sweep;
use armwright::space::ArmProblem;
use armwright::study::Study;
use serde_json::{Value, json};
use std::sync::atomic::AtomicBool;

/// States what joints weigh beyond their drives: the usual masses, none, or masses that the study or a joint states.
fn add_extras(study: &mut Value, seed: u64) {
    let dice = &mut Dice(seed + 8_000);
    let stated = |dice: &mut Dice| {
        json!({"housing_kg": dice.within(0.0, 2.0), "brake_kg": dice.of(&[0.0, 0.4]), "encoder_kg": 0.1,
            "flange_kg": dice.within(0.0, 0.5), "cable_kg": dice.of(&[0.0, 0.2])})
    };
    match dice.below(4) {
        0 => study["extras"] = json!("none"),
        1 => study["extras"] = stated(dice),
        _ => {}
    }
    for joint in sized_joints(study) {
        if dice.below(3) == 0 {
            joint["extras"] = stated(dice);
        }
    }
}

fn sized_joints(study: &mut Value) -> impl Iterator<Item = &mut Value> {
    study["chain"].as_array_mut().expect("a chain").iter_mut().filter(|piece| piece["drive"].is_string())
}

/// A random study of a whole arm, and catalogs of parts of any bearing and size. Its payload is light, because four limits
/// together leave few studies with a front.
fn whole_arm(seed: u64) -> (Value, Catalogs) {
    let (mut study, mut catalogs) = (random_study(seed), Catalogs::builtin());
    study["payload"]["mass_kg"] = json!(Dice(seed + 9_000).within(0.5, 2.5));
    add_fits(&mut study, seed);
    add_heat(&mut study, seed);
    study["motion"]["tip_speed_m_s"] = json!(0.4);
    add_bearings(&mut study, seed);
    add_extras(&mut study, seed);
    if seed % 8 == 4 {
        add_prismatic(&mut study, seed);
    }
    change_bearings(&mut catalogs, seed);
    change_sizes(&mut catalogs, seed);
    (study, catalogs)
}

fn swept(study: &Study, catalogs: &Catalogs) -> Vec<u128> {
    let problem = ArmProblem::new(&study.space, catalogs);
    let sweep = Sweep::new(&problem, study.space.constraints, &AtomicBool::new(false)).run();
    judged(&problem, &sweep.front)
}

/// The same study without each of what may decide: bearings, heat, fit, extras.
fn without_each(text: &Value, study: &Study, catalogs: &Catalogs) -> [Study; 4] {
    let [mut rigid, mut roomy, mut light] = [text.clone(), text.clone(), text.clone()];
    rigid["effects"] = json!([]);
    roomy["fit"] = Value::Null;
    light["extras"] = json!("none");
    sized_joints(&mut rigid).for_each(|joint| joint["bearing"] = Value::Null);
    sized_joints(&mut roomy).for_each(|joint| joint["fit"] = Value::Null);
    sized_joints(&mut light).for_each(|joint| joint["extras"] = json!("none"));
    [read(&rigid, catalogs), unheated(study), read(&roomy, catalogs), read(&light, catalogs)]
}

#[test]
fn the_exact_front_is_whole_where_bearings_heat_fit_and_extras_are_judged_together() {
    let studies: u64 =
        std::env::var("ARMWRIGHT_EXACT_STUDIES").ok().and_then(|n| n.parse().ok()).unwrap_or(8);
    let (mut points, mut feasible, mut asked, mut decided) = (0, 0, 0, [0; 4]);
    for seed in 0..studies {
        let (text, catalogs) = whole_arm(seed);
        let study = read(&text, &catalogs);
        let what = format!("seed {seed}: {text}");
        // regions are for spaces far larger: they take long on small ones
        let (swept_front, listed) = both_searches(&study, &catalogs, seed % 32 == 31, &what);
        points += listed;
        feasible += u64::from(listed > 0);
        if seed.is_multiple_of(2) {
            let numbers = judged(&ArmProblem::new(&study.space, &catalogs), &swept_front);
            for (decides, other) in decided.iter_mut().zip(without_each(&text, &study, &catalogs)) {
                *decides += u64::from(swept(&other, &catalogs) != numbers);
            }
            asked += 1;
        }
        if seed.is_multiple_of(4) {
            let rows = front(&study, &catalogs, &catalogs);
            assert_eq!(faults(&study, &catalogs, &rows), [0, 0], "the verifier: {what}");
        }
    }
    println!(
        "{studies} studies, {feasible} feasible, {points} front designs, the same in both; of {asked}, \
         bearings, heat, fit, extras decide {decided:?}"
    );
    assert!(feasible * 4 > studies, "only {feasible} of {studies} studies are feasible");
    assert!(points as u64 > 6 * feasible, "fronts are too small to say much: {points} designs");
    assert!(decided.iter().all(|n| n * 5 > asked), "of {asked} studies, {decided:?} are decided");
}
