//! What one more kilogram buys: against a spring in closed form, and against arm files changed as text.

use armwright::arm::Extras;
use armwright::arm::LoadCase;
use armwright::arm::read_arm_document;
use armwright::catalog::{Catalogs, GearMass};
use armwright::input::Document;
use armwright::pareto::Objectives;
use armwright::report::budget::{
    BudgetRow, Gain, PickBudget, PieceKind, budget_csv, budget_markdown, budget_text,
};
use armwright::space::ArmProblem;
use armwright::space::OutwardIn;
use armwright::space::design::{full_objectives, number_of, options};
use armwright::study::budgets;
use armwright::study::front_table;
use armwright::study::run_study;
use armwright::study::{Study, read_study};
use serde_json::{Value, json};
use std::sync::atomic::AtomicBool;

fn read(study: &Value, catalogs: &Catalogs) -> Study {
    read_study(Document::parse("study", &study.to_string()).expect("JSON"), catalogs).expect("whole")
}

fn budgets_of(study: &Study, catalogs: &Catalogs) -> Vec<PickBudget> {
    let problem = ArmProblem::new(&study.space, catalogs);
    let front = run_study(study, catalogs, &AtomicBool::new(false), |_, _, _| ()).front;
    budgets(&problem, &study.space, catalogs, &front_table(&problem, catalogs, &front))
}

#[test]
fn at_a_single_spring_a_kilogram_more_buys_the_deflection_over_the_mass() {
    let catalogs = Catalogs::builtin();
    let study = json!({
        "name": "spring", "question": "what does a kilogram buy?",
        "chain": [
            {"type": "joint", "name": "j1", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e5, "mass_kg": 10},
            {"type": "link", "name": "arm", "vector_m": [1, 0, 0], "choose": {"materials": ["Aluminium 6061-T6"],
                "sections": [{"shape": "rectangular_tube", "width_mm": [60, 80], "height_mm": "=width", "wall_mm": [3, 5]}]}},
        ],
        "payload": {"mass_kg": 5}, "poses": [{"name": "out", "pose_deg": [0]}], "models": {"links": "rigid"},
    });
    let all = budgets_of(&read(&study, &catalogs), &catalogs);
    // rigid links: the lightest tube is best in everything, and nothing lighter is as good
    let [pick] = all.as_slice() else { panic!("{all:?}") };
    assert_eq!(pick.bound.expect("all options are at hand").mass_kg, pick.mass_kg);
    let tube_kg = pick.rows[1].mass_kg;
    let torque_nm = 9.81 * (5.0 + tube_kg / 2.0);
    // tip = T L / K: stiffer by 1/10 a kilogram; f ~ sqrt(K)
    let gain = pick.rows[0].in_place.expect("of a joint");
    assert!((gain.mm_per_kg / (-1e3 * torque_nm / 1e5 / 10.0) - 1.0).abs() < 1e-5, "{gain:?}");
    // inertia of a thin tube about its end: m L^2/3 and what its section adds
    let side_m = 0.06;
    let inner_m = side_m - 2.0 * 0.003;
    let across_m2 = (side_m * side_m + inner_m * inner_m) / 12.0;
    let inertia_kgm2 = 5.0 + tube_kg * (1.0 / 3.0 + across_m2);
    let mode_hz = (1e5 / inertia_kgm2).sqrt() / std::f64::consts::TAU;
    assert!((gain.hz_per_kg / (mode_hz / 2.0 / 10.0) - 1.0).abs() < 1e-5, "{gain:?} {mode_hz}");
    // a kilogram more of the rigid tube only weighs, at half the lever
    let tube = &pick.rows[1];
    assert!(
        (tube.in_place.expect("of a link").mm_per_kg / (1e3 * 9.81 * 0.5 / 1e5) - 1.0).abs() < 1e-6,
        "{tube:?}"
    );
    assert!((pick.rows[0].share - 1.0).abs() < 1e-12 && tube.share == 0.0);
    let words = budget_text(&all, 80).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        words.contains("add mass first to the drive of j1, where it lowers the deflection by"),
        "{words}"
    );
    // rates, not what a whole kilogram would do
    let change =
        format!("by {:.3} mm/kg and raises the mode by {:.1} Hz/kg", -gain.mm_per_kg, gain.hz_per_kg);
    assert!(words.contains(&change), "{words}");
}

#[test]
fn the_next_tube_is_no_softer_either_way_and_not_too_slender() {
    let catalogs = Catalogs::builtin();
    let square = |side_mm: f64, wall_mm: f64| json!({"shape": "rectangular_tube", "width_mm": [side_mm], "height_mm": "=width", "wall_mm": [wall_mm]});
    let mut study = json!({
        "name": "tubes", "question": "which tube next?",
        "chain": [
            {"type": "joint", "name": "j1", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e6, "mass_kg": 10},
            {"type": "link", "name": "arm", "vector_m": [1, 0, 0], "choose": {"materials": ["Aluminium 6061-T6"],
                "sections": [square(60.0, 3.0), square(80.0, 3.0), square(110.0, 2.0),
                    {"shape": "rectangular_tube", "width_mm": [40], "height_mm": [100], "wall_mm": [3]}]}},
        ],
        "payload": {"mass_kg": 5}, "poses": [{"name": "out", "pose_deg": [0]}],
    });
    let next_of_lightest = |study: &Value| {
        let all = budgets_of(&read(study, &catalogs), &catalogs);
        let lightest = all.iter().find(|pick| pick.names.contains(&"lightest")).expect("a pick");
        lightest.rows[1].next_part.clone().expect("a heavier tube").name
    };
    // per kilogram the tall one is better than the square of 80 mm, but softer sideways
    assert_eq!(next_of_lightest(&study), "110 x 110 x 2 mm Aluminium 6061-T6");
    study["constraints"] = json!({"wall_slenderness_max": 40});
    assert_eq!(next_of_lightest(&study), "80 x 80 x 3 mm Aluminium 6061-T6");
}

/// The motors of the drives below.
const MOTORS: [&str; 3] = ["MF0060008 48V", "MF0076008 48V", "MF0076032 48V"];

/// The bench arm of the examples with few drives, and effects at its elbow and forearm.
fn bench() -> Value {
    let mut study: Value = serde_json::from_str(include_str!("../../examples/bench-arm.json")).expect("JSON");
    study["drives"] = json!({"gear_series": ["CSG"], "ratios": [100],
        "motor_models": MOTORS});
    study["effects"] = json!([
        {"effect": "connection_compliance", "at": "elbow", "parameters": {"stiffness_nm_per_rad": 3e4}},
        {"effect": "harness_mass", "at": "forearm", "parameters": {"kg_per_m": 0.5}}]);
    study
}

/// An arm file with one piece's mass and stiffness times a factor.
fn grown(arm: &Value, piece: &str, factor: f64) -> Value {
    let mut arm = arm.clone();
    let times = |number: &mut Value| *number = json!(number.as_f64().expect("a number") * factor);
    let at =
        arm["chain"].as_array().expect("a chain").iter().position(|p| p["name"] == piece).expect("the piece");
    match arm["chain"][at]["type"].as_str() {
        Some("joint") => {
            let joint = &mut arm["chain"][at];
            times(&mut joint["mass_kg"]);
            joint["extras"].as_object_mut().expect("masses").values_mut().for_each(times);
            for key in ["tilt_stiffness_nm_per_rad", "mass_kg"] {
                times(&mut joint["bearing"][key]);
            }
            for key in ["k1_nm_per_rad", "k2_nm_per_rad", "k3_nm_per_rad"] {
                times(&mut arm["chain"][at]["windup"][key]);
            }
        }
        _ => {
            let name = arm["chain"][at]["material"].as_str().expect("a material").to_string();
            let mut material = arm["materials"][&name].clone();
            for key in ["youngs_modulus_pa", "shear_modulus_pa", "density_kg_m3"] {
                times(&mut material[key]);
            }
            arm["materials"]["another"] = material;
            arm["chain"][at]["material"] = json!("another");
        }
    }
    arm
}

fn objectives(arm: &Value, cases: &[LoadCase], catalogs: &Catalogs) -> Objectives {
    let arm =
        read_arm_document(Document::parse("arm", &arm.to_string()).expect("JSON"), catalogs).expect("an arm");
    full_objectives(&arm, cases)
}

/// Change of deflection \[mm\] and mode \[Hz\] per kilogram between two arms.
fn per_kg(from: &Objectives, to: &Objectives) -> [f64; 2] {
    let kg = to.mass_kg - from.mass_kg;
    [1e3 * (to.tip_deflection_m - from.tip_deflection_m), to.lowest_mode_hz - from.lowest_mode_hz]
        .map(|x| x / kg)
}

#[test]
fn the_budget_is_what_arm_files_changed_as_text_say() {
    let catalogs = Catalogs::builtin();
    let study = read(&bench(), &catalogs);
    let problem = ArmProblem::new(&study.space, &catalogs);
    let cases = problem.load_cases();
    let all = budgets_of(&study, &catalogs);
    assert!(all.len() >= 3, "{all:?}");
    let mut next_parts = 0;
    for pick in &all {
        let number = number_of(&pick.design_id).expect("a name");
        let options = options(problem.level_sizes(), number).expect("a design");
        let arm = problem.arm(&options).expect("it holds").to_json();
        let now = objectives(&arm, &cases, &catalogs);
        let pieces: Vec<&str> = pick.rows.iter().map(|row| row.piece.as_str()).collect();
        let bearings = ["shoulder", "shoulder.bearing", "upper_arm", "elbow", "elbow.bearing", "forearm"];
        assert_eq!(pieces, bearings);
        assert!((pick.rows.iter().map(|r| r.share).sum::<f64>() - 1.0).abs() < 1e-9, "shares sum to 1");
        for row in pick.rows.iter().filter(|row| row.kind != PieceKind::Bearing) {
            // differences over 2 h and h, extrapolated to none
            let over = |h: f64| {
                let [less, more] =
                    [1.0 - h, 1.0 + h].map(|f| objectives(&grown(&arm, &row.piece, f), &cases, &catalogs));
                per_kg(&less, &more)
            };
            let (wide, narrow) = (over(8e-3), over(4e-3));
            let scale = [1e3 * now.tip_deflection_m, now.lowest_mode_hz].map(|x| x / now.mass_kg);
            let gain = row.in_place.expect("of a joint or link");
            let found = [gain.mm_per_kg, gain.hz_per_kg];
            for i in 0..2 {
                let limit = (4.0 * narrow[i] - wide[i]) / 3.0;
                assert!((found[i] - limit).abs() < 1e-5 * (limit.abs() + scale[i]), "{row:?}: {limit}");
            }
            let helps = |gain: Gain| gain.mm_per_kg < 0.0 || gain.hz_per_kg > 0.0;
            assert!(row.next_part.as_ref().is_none_or(|next| helps(next.gain)), "{row:?}");
            if row.kind == PieceKind::Joint
                && let Some(next) = &row.next_part
            {
                let at =
                    arm["chain"].as_array().expect("a chain").iter().position(|p| p["name"] == row.piece);
                let joint = &arm["chain"][at.expect("the joint")];
                let gear = catalogs.gear(&next.name).expect("a gear");
                let weighs = |motor: &&str| {
                    let motor = catalogs.motor(motor).expect("a motor");
                    let extras = Extras::usual(gear, motor, GearMass::HousedUnit);
                    let housed_kg = gear.mass_housed_unit_kg.expect("its mass");
                    housed_kg + motor.mass_kg.expect("its mass") + extras.total_kg()
                };
                let masses_kg: Vec<f64> = MOTORS.iter().map(weighs).collect();
                assert!(
                    masses_kg.iter().any(|kg| (kg - next.mass_kg).abs() < 1e-8),
                    "{next:?}: {masses_kg:?}"
                );
                let mut with = arm.clone();
                with["chain"][at.expect("the joint")] = json!({"type": "joint", "name": row.piece,
                    "axis": joint["axis"], "gear": next.name, "mass_kg": next.mass_kg});
                let told = [next.gain.mm_per_kg, next.gain.hz_per_kg];
                let by_text = per_kg(&now, &objectives(&with, &cases, &catalogs));
                (0..2).for_each(|i| {
                    assert!((told[i] - by_text[i]).abs() < 1e-9 * by_text[i].abs().max(1e-3), "{next:?}")
                });
                next_parts += 1;
            }
        }
    }
    assert!(next_parts >= 3, "some joint of some pick has a heavier drive");
}

#[test]
fn every_pick_has_a_bound_and_every_text_its_budget() {
    let catalogs = Catalogs::builtin();
    let all = budgets_of(&read(&bench(), &catalogs), &catalogs);
    for pick in &all {
        let bound = pick.bound.expect("all options are at hand");
        assert!(bound.mixture_kg > 0.2 * pick.mass_kg && bound.mass_kg <= pick.mass_kg, "{pick:?}");
    }
    // what a bearing may carry is not in the bound, so it is close only without bearings
    let mut rigid = bench();
    for piece in rigid["chain"].as_array_mut().expect("a chain").iter_mut().filter(|p| p["type"] == "joint") {
        piece["bearing"] = Value::Null;
    }
    for pick in budgets_of(&read(&rigid, &catalogs), &catalogs) {
        let bound = pick.bound.expect("all options are at hand").mass_kg;
        // after an exhaustive search a pick is the lightest of those as good
        assert!(bound > 0.9 * pick.mass_kg && bound <= pick.mass_kg, "{pick:?}");
        let mixture = pick.bound.expect("all options are at hand").mixture_kg;
        assert!(mixture > 0.5 * pick.mass_kg && mixture <= bound * (1.0 + 1e-9), "{pick:?}");
    }
    let text = budget_text(&all, 80);
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    let markdown = budget_markdown(&all);
    for pick in &all {
        let names = pick.names.join(", ");
        assert!(markdown.contains(&pick.design_id) && text.contains(&names), "{text}{markdown}");
    }
    let rows: Vec<&BudgetRow> = all.iter().flat_map(|p| &p.rows).collect();
    assert_eq!(budget_csv(&all).lines().count(), 1 + rows.len());
    assert!(rows.iter().all(|r| markdown.contains(&r.piece)));
}
