//! The lower bound on mass against every design of small random studies.
//! `ARMWRIGHT_EXACT_STUDIES=300 cargo test --release --test design relaxation` draws more of them.

use crate::bodies::add_bodies;
use crate::dice::Dice;
use crate::prismatic::add_prismatic;
use crate::transmissions::add_stages;
use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::pareto::Objectives;
use armwright::relax::Relaxation;
use armwright::space::ArmProblem;
use armwright::space::Evaluated;
use armwright::space::OutwardIn;
use armwright::space::design::options;
use armwright::space::evaluate;
use armwright::study::read_study;
use rayon::prelude::*;
use serde_json::{Value, json};

fn joint(dice: &mut Dice, name: &str) -> Value {
    let mut joint = json!({"type": "joint", "name": name, "axis": [0, 1, 0]});
    match dice.below(4) {
        0 => {
            joint["stiffness_nm_per_rad"] = json!(dice.within(2e4, 1e6));
            joint["mass_kg"] = json!(dice.within(1.0, 20.0));
        }
        1 => joint["drive"] = json!("first_fit"),
        _ => {
            let gears = ["HFUC-25-100", "HFUC-32-100", "HFUC-40-100", "HFUC-50-100", "HFUC-58-100"];
            let first = dice.below(3) as usize;
            joint["drive"] = json!("all_fits");
            joint["drives"] = json!({"gears": &gears[first..first + 3], "motor_models": ["ILM85x26"]});
        }
    }
    match dice.below(4) {
        0 => {
            joint["bearing"] = json!({"tilt_stiffness_nm_per_rad": dice.within(3e4, 1e6), "mass_kg": 0.7,
            "permissible_moment_nm": dice.within(100.0, 2000.0)})
        }
        1 => joint["bearing"] = Value::Null,
        _ => (),
    }
    joint
}

fn choice(dice: &mut Dice, name: &str) -> Value {
    let side = 10.0 * dice.within(5.0, 14.0).round();
    let materials = ["Structural steel S355", "Aluminium 6061-T6", "Titanium Ti-6Al-4V"];
    let first = dice.below(2) as usize;
    json!({"type": "link", "name": name, "vector_m": [dice.within(0.3, 0.9), 0, 0], "choose": {
        "materials": &materials[first..first + 2],
        "sections": [{"shape": "rectangular_tube", "width_mm": [side, side + 30.0], "height_mm": [side, side + 40.0],
            "wall_mm": [3, 6]}]}})
}

/// Physics beyond the nominal model, now and then.
fn effects(dice: &mut Dice, models: &Value) -> Value {
    let spring = |effect: &str, at: &str| json!({"effect": effect, "at": at, "parameters": {"stiffness_nm_per_rad": 2e5}});
    let all = [
        spring("bearing_tilt", "j3"),
        spring("base_compliance", "base"),
        spring("connection_compliance", "j2"),
        json!({"effect": "lost_motion", "at": "j2", "parameters": {"half_width_rad": 2e-4, "torque_nm": 60.0}}),
        json!({"effect": "hysteresis", "at": "j3", "parameters": {"half_width_rad": 1e-4}}),
        json!({"effect": "harness_mass", "at": "forearm", "parameters": {"kg_per_m": 2.0}}),
        json!({"effect": "extra_mass", "at": "j3", "parameters": {"delta_kg": 1.5}}),
        json!({"effect": "modulus_error", "at": "upper_arm", "parameters": {"factor": 0.8}}),
    ];
    // rigid links have no modulus
    let second = if models["links"] == "rigid" { &all[4..7] } else { &all[4..] };
    match dice.below(2) {
        0 => json!([dice.of(&all[..4]), dice.of(second)]),
        _ => json!([]),
    }
}

/// One or two poses, folded ones among them; now and then a force that opposes gravity, or water.
fn study(dice: &mut Dice) -> Value {
    let pose =
        |dice: &mut Dice| -> Vec<f64> { (0..3).map(|_| 15.0 * (dice.below(13) as f64 - 6.0)).collect() };
    let mut poses = vec![json!({"name": "a", "pose_deg": [0, 0, 0]})];
    if dice.below(2) == 0 {
        poses.push(json!({"name": "b", "pose_deg": pose(dice)}));
    }
    if dice.below(3) == 0 {
        let force = [0.0, dice.within(-40.0, 40.0), dice.within(0.0, 200.0)];
        poses.push(json!({"name": "c", "pose_deg": pose(dice), "tip_force_n": force}));
    }
    if dice.below(4) == 0 {
        poses[0]["pose_deg"] = json!(pose(dice));
    }
    let models = [
        json!({}),
        json!({"links": "rigid"}),
        json!({"links": "bending", "joints": "k2"}),
        json!({"joints": "three_segment_k1"}),
    ];
    let models = dice.of(&models);
    let mut study = json!({
        "name": "random", "question": "is the bound one?",
        "chain": [
            {"type": "joint", "name": "j1", "axis": [0, 0, 1], "drive": "first_fit"},
            {"type": "link", "name": "shoulder", "vector_m": [0, 0, 0.3]},
            joint(dice, "j2"), choice(dice, "upper_arm"), joint(dice, "j3"), choice(dice, "forearm"),
        ],
        // beside the plane of the arm now and then, so that j2 and j3 carry moments across their axes
        "payload": {"mass_kg": dice.within(0.0, 15.0), "cg_m": [0.05, dice.of(&[0.0, 0.2]), 0]},
        "poses": poses, "models": models, "effects": effects(dice, &models),
    });
    if dice.below(4) == 0 {
        study["environments"] = json!([{"name": "wet", "water": {"density_kg_m3": 1025.0,
            "added_mass_coefficient": 1.0, "payload_density_kg_m3": 4000.0}}]);
    }
    study
}

/// Every design of a study that holds, by the full model.
fn every_design(problem: &ArmProblem) -> Vec<Evaluated> {
    let total: u64 = problem.level_sizes().iter().map(|&n| u64::from(n)).product();
    (0..total).into_par_iter().filter_map(|n| evaluate(problem, u128::from(n))).collect()
}

/// Whether a design sags at most so much and vibrates at least so fast.
fn meets(o: &Objectives, tip_deflection_m: f64, lowest_mode_hz: f64) -> bool {
    o.tip_deflection_m <= tip_deflection_m && o.lowest_mode_hz >= lowest_mode_hz
}

#[test]
fn no_design_that_meets_a_target_is_lighter_than_the_bound() {
    let catalogs = Catalogs::builtin();
    let mut dice = Dice(7);
    let mut gaps = Vec::new();
    let (mut opposed, mut with_effects) = (0, 0);
    let rounds = std::env::var("ARMWRIGHT_EXACT_STUDIES").ok().and_then(|n| n.parse().ok()).unwrap_or(ROUNDS);
    for round in 0..rounds {
        let mut drawn = study(&mut dice);
        if round % 4 == 3 {
            add_bodies(&mut drawn, round as u64);
        }
        if round % 8 == 5 {
            add_prismatic(&mut drawn, round as u64);
        }
        if round % 8 == 6 {
            add_stages(&mut drawn, round as u64);
        }
        let text = drawn.to_string();
        let study = read_study(Document::parse("random", &text).expect("JSON"), &catalogs)
            .unwrap_or_else(|faults| panic!("{faults}\n{text}"));
        let problem = ArmProblem::new(&study.space, &catalogs);
        let relaxation = Relaxation::new(&problem);
        let designs = every_design(&problem);
        if designs.is_empty() {
            continue;
        }
        for _ in 0..TARGETS {
            // the deflection of one design, the mode of another, each loosened a little
            let tip_deflection_m = dice.of(&designs).objectives.tip_deflection_m * dice.within(1.0, 1.2);
            let lowest_mode_hz = dice.of(&designs).objectives.lowest_mode_hz * dice.within(0.8, 1.0);
            let meeting: Vec<&Evaluated> =
                designs.iter().filter(|d| meets(&d.objectives, tip_deflection_m, lowest_mode_hz)).collect();
            if meeting.is_empty() {
                continue;
            }
            let lightest_kg = meeting.iter().map(|d| d.objectives.mass_kg).fold(f64::INFINITY, f64::min);
            let known = dice.of(&meeting);
            let asked = Objectives { tip_deflection_m, lowest_mode_hz, mass_kg: known.objectives.mass_kg };
            let options = options(problem.level_sizes(), known.number).expect("it was counted");
            let bound = relaxation.mass_lower_bound(&options, &asked).expect("it holds");
            let slack = lightest_kg * (1.0 + 1e-9) - bound.mass_lower_bound_kg;
            assert!(slack >= 0.0, "round {round}: {bound:?} above {lightest_kg} kg\n{text}");
            gaps.push(1.0 - bound.mass_lower_bound_kg / lightest_kg);
            opposed += usize::from(bound.loads_oppose);
            with_effects += usize::from(!study.space.effects.is_empty());
        }
    }
    gaps.sort_by(f64::total_cmp);
    let at = |part: f64| 100.0 * gaps[((gaps.len() - 1) as f64 * part) as usize];
    println!(
        "{} bounds, {opposed} with opposing loads, {with_effects} with effects; below the lightest design: \
         median {:.2} %, 90th percentile {:.2} %, most {:.2} %",
        gaps.len(),
        at(0.5),
        at(0.9),
        at(1.0)
    );
    assert!(gaps.len() > 40 && opposed > 3 && with_effects > 10, "the studies drawn say too little");
    // 6.3 % over 500 studies, a third of them with gears that vibrate with their first slope
    assert!(at(0.5) < 7.0, "the median gap is {:.2} %", at(0.5));
}

/// Studies drawn, and targets in each.
const ROUNDS: usize = 20;
const TARGETS: usize = 4;
