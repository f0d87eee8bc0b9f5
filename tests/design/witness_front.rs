//! The second search for missing designs against the full model and against visiting every design, on random
//! small studies.
//!
//! No member of a box may be better than the box's ceiling; nothing is missing beside a true front; and a
//! design taken out of it is found.
//!
//! `ARMWRIGHT_WITNESS_STUDIES=300 cargo test --release --test design witness_front` runs more of them.

use crate::bodies::add_bodies;
use crate::dice::Dice;
use crate::prismatic::add_prismatic;
use crate::transmissions::add_stages;
use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::pareto::Objectives;
use armwright::pareto::front::nondominated;
use armwright::search::Sweep;
use armwright::sizing::PhaseKind;
use armwright::space::ArmProblem;
use armwright::space::Evaluated;
use armwright::space::OutwardIn;
use armwright::space::constraint::Constraints;
use armwright::space::design::number;
use armwright::space::evaluate;
use armwright::study::question::{number_of_picks, picks, question};
use armwright::study::{Study, read_study};
use armwright::verify::{Boxes, Judge, Judged, Looked, PartsBox, Pick, Settings, conditions};
use serde_json::{Value, json};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Rounding of the full model and of the bounds.
const ROUNDING: f64 = 1e-9;

fn studies() -> u64 {
    std::env::var("ARMWRIGHT_WITNESS_STUDIES").ok().and_then(|n| n.parse().ok()).unwrap_or(16)
}

fn tube(dice: &mut Dice, name: &str, vector_m: [f64; 3]) -> Value {
    let walls = [json!([2, 4]), json!([1.5, 3, 6])];
    let round = json!({"shape": "round_tube", "diameter_mm": [40, 65, 100, 150], "wall_mm": dice.of(&walls)});
    let flat = json!({"shape": "rectangular_tube", "width_mm": [50, 80, 120], "height_mm": [60, 100, 140],
        "wall_mm": dice.of(&walls)});
    let sections = dice.of(&[json!([round]), json!([flat]), json!([flat, round])]);
    let materials = dice.of(&[
        json!(["Structural steel S355", "Aluminium 6061-T6"]),
        json!([
            "Titanium Ti-6Al-4V",
            "Aluminium 6061-T6",
            "CFRP T300/5208 (standard modulus) quasi-isotropic"
        ]),
    ]);
    if dice.below(6) == 0 {
        return json!({"type": "link", "name": name, "vector_m": vector_m, "material": "Aluminium 6061-T6",
            "section": {"shape": "round_tube", "diameter_m": 0.09, "wall_m": 0.004}});
    }
    json!({"type": "link", "name": name, "vector_m": vector_m, "choose": {"materials": materials, "sections": sections}})
}

fn joint(dice: &mut Dice, name: &str, axis: [f64; 3]) -> Value {
    let mut joint = json!({"type": "joint", "name": name, "axis": axis});
    let fields = match dice.below(9) {
        0 => json!({"stiffness_nm_per_rad": null, "mass_kg": 2}),
        1 => {
            json!({"stiffness_nm_per_rad": 10f64.powf(dice.within(4.0, 5.5)), "mass_kg": dice.within(0.0, 8.0)})
        }
        2 => {
            // softer beyond the first break point
            let windup = json!({"k1_nm_per_rad": 3e5, "k2_nm_per_rad": 8e4, "k3_nm_per_rad": 2e5,
                "t1_nm": dice.within(5.0, 60.0), "t2_nm": dice.within(60.0, 140.0)});
            json!({"windup": windup, "mass_kg": dice.within(1.0, 5.0)})
        }
        3 => json!({"gear": dice.of(&["CSG-32-100", "HFUC-40-100"]), "mass_kg": dice.within(1.0, 6.0)}),
        4 | 5 => {
            let motors = dice.of(&[["ILM70x18", "ILM85x26"], ["ILM50x14", "ILM85x26"]]);
            json!({"drive": "all_fits", "drives": {"gear_series": [dice.of(&["CSG", "HFUC"])],
                "ratios": [dice.of(&[80, 100])], "motor_models": motors}})
        }
        _ => {
            json!({"drive": "first_fit", "drives": {"gear_series": ["CSG", "HFUC"], "motors": ["electric"]}})
        }
    };
    let fields = fields.as_object().expect("fields").clone();
    joint.as_object_mut().expect("a joint").extend(fields);
    if let Some(bearing) = bearing(dice) {
        joint["bearing"] = bearing;
    }
    joint
}

/// What a joint may say of its output bearing; nothing is the gear's.
fn bearing(dice: &mut Dice) -> Option<Value> {
    match dice.below(8) {
        0 => Some(Value::Null),
        1 => Some(json!("HFUC-32-100")),
        2 => Some(json!({"tilt_stiffness_nm_per_rad": 10f64.powf(dice.within(4.5, 6.0)),
            "permissible_moment_nm": dice.within(60.0, 400.0), "mass_kg": dice.within(0.0, 2.0),
            "offset_m": dice.of(&[json!(null), json!(0.05)]), "pitch_diameter_m": 0.08,
            "static_load_rating_n": dice.within(5e3, 3e4), "dynamic_load_rating_n": dice.within(4e3, 2e4)})),
        _ => None,
    }
}

/// The catalogs of a random study. In one of three some bearings are rigid, and numbers of others are not known.
fn catalogs(seed: u64) -> Catalogs {
    let mut catalogs = Catalogs::builtin();
    if seed % 3 == 1 {
        for (place, gear) in (seed..).zip(&mut catalogs.gears) {
            match place % 7 {
                0 | 1 => gear.tilting_stiffness_nm_per_rad = None,
                2 => gear.permissible_tilting_moment_nm = None,
                3 => gear.bearing.pitch_diameter_m = None,
                4 => gear.bearing.dynamic_load_rating_n = None,
                _ => {}
            }
        }
    }
    catalogs
}

fn random_study(seed: u64) -> Value {
    let dice = &mut Dice(seed.wrapping_mul(7919).wrapping_add(17));
    let roll = dice.of(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.6, 0.8]]);
    let mut chain = vec![
        joint(dice, "j1", [0.0, 0.0, 1.0]),
        json!({"type": "link", "name": "column", "vector_m": [0, 0, 0.4], "mass_kg": dice.within(0.0, 5.0)}),
        joint(dice, "j2", [0.0, 1.0, 0.0]),
    ];
    if dice.below(4) == 0 {
        chain.push(json!({"type": "link", "name": "back", "vector_m": [-0.4, 0, 0], "mass_kg": 25}));
        chain.push(json!({"type": "link", "name": "forth", "vector_m": [0.4, 0, 0]}));
    }
    let (upper_m, fore_m, aside_m) = (dice.within(0.4, 1.0), dice.within(0.2, 0.6), dice.of(&[0.0, 0.1]));
    chain.push(tube(dice, "upper", [upper_m, 0.0, 0.0]));
    chain.push(joint(dice, "j3", [0.0, 1.0, 0.0]));
    chain.push(tube(dice, "fore", [fore_m, aside_m, 0.05]));
    chain.push(joint(dice, "j4", roll));
    chain.push(json!({"type": "link", "name": "hand", "vector_m": [0.08, 0, 0], "mass_kg": 0.5}));
    let poses: Vec<Value> = (0..1 + dice.below(3))
        .map(|i| {
            let angles: Vec<f64> = (0..4).map(|_| dice.within(-150.0, 150.0)).collect();
            let angles = if dice.below(3) == 0 { vec![0.0; 4] } else { angles };
            json!({"pose_deg": angles, "judged": i == 0 || dice.below(2) == 0})
        })
        .collect();
    let mut study = json!({"name": format!("verify-{seed}"), "chain": chain, "poses": poses,
        "payload": {"mass_kg": dice.within(0.5, 9.0), "cg_m": [0.05, dice.of(&[0.0, -0.06]), 0.03],
            "inertia_about_cg_kgm2": [0.01, 0.02, 0.015]},
        "models": {"links": dice.of(&["full", "full", "bending", "rigid"]),
            "joints": dice.of(&["three_segment", "three_segment", "three_segment_k1", "k2"])},
        "constraints": constraints(dice)});
    if dice.below(3) == 0 {
        study["tip_force_n"] = json!([dice.within(-40.0, 40.0), 15.0, dice.within(-60.0, 150.0)]);
    }
    if dice.below(4) == 0 {
        study["environments"] = json!([{"name": "dry"}, {"name": "sea", "water": {"density_kg_m3": 1025}}]);
    }
    if dice.below(3) == 0 {
        study["effects"] = effects(dice);
        // effects of a link are for links that yield
        study["models"]["links"] = json!("full");
    }
    if seed % 4 == 3 {
        add_bodies(&mut study, seed);
    }
    if seed % 8 == 5 {
        add_prismatic(&mut study, seed);
    }
    if seed % 8 == 6 {
        add_stages(&mut study, seed);
    }
    study
}

/// Lost motion or friction of a joint.
fn play(dice: &mut Dice, effect: &str, joint: &str) -> Value {
    let mut parameters = json!({"half_width_rad": 10f64.powf(dice.within(-5.0, -3.3))});
    if effect == "lost_motion" {
        parameters["torque_nm"] = json!(10f64.powf(dice.within(0.0, 2.5)));
    }
    json!({"effect": effect, "at": joint, "parameters": parameters})
}

/// One to four effects of the arm.
fn effects(dice: &mut Dice) -> Value {
    let spring = |dice: &mut Dice, effect: &str, at: &str| json!({"effect": effect, "at": at, "parameters": {"stiffness_nm_per_rad": 10f64.powf(dice.within(4.3, 5.8))}});
    let frame = json!({"diagonal_rad_per_nm": [3e-6, 5e-6, 2e-6], "coupling_rad_per_nm": [1e-6, 0.0, -1e-6]});
    let all = [
        spring(dice, "bearing_tilt", "j2"),
        spring(dice, "bearing_tilt", "j4"),
        spring(dice, "base_compliance", "base"),
        spring(dice, "connection_compliance", "j2"),
        spring(dice, "connection_compliance", "j3"),
        json!({"effect": "extra_mass", "at": "j3", "parameters": {"delta_kg": dice.within(0.5, 4.0)}}),
        json!({"effect": "harness_mass", "at": "fore", "parameters": {"kg_per_m": dice.within(0.5, 6.0)}}),
        json!({"effect": "harness_mass", "at": "column", "parameters": {"kg_per_m": dice.within(0.5, 6.0)}}),
        json!({"effect": "harness_mass", "at": "hand", "parameters": {"kg_per_m": dice.within(0.5, 6.0)}}),
        json!({"effect": "modulus_error", "at": "upper", "parameters": {"factor": dice.within(0.5, 1.2)}}),
        json!({"effect": "link_flexibility", "at": "fore", "parameters": {"factor": dice.within(0.3, 2.0)}}),
        json!({"effect": "frame_compliance", "at": dice.of(&["upper", "hand", "base"]), "parameters": frame}),
        json!({"effect": "immersion", "at": "arm",
            "parameters": {"water_density_kg_m3": 1000, "added_mass_coefficient": 1.1}}),
        play(dice, "lost_motion", "j2"),
        play(dice, "lost_motion", "j4"),
        play(dice, "hysteresis", "j2"),
        play(dice, "hysteresis", "j3"),
    ];
    let mut places: Vec<usize> = (0..=dice.below(4)).map(|_| dice.below(all.len() as u64) as usize).collect();
    places.sort_unstable();
    places.dedup();
    places.into_iter().map(|i| all[i].clone()).collect()
}

fn constraints(dice: &mut Dice) -> Value {
    let mut constraints = json!({});
    let limits = [
        ("stress_safety_factor_min", 10f64.powf(dice.within(0.2, 1.3))),
        ("tip_deflection_max_mm", dice.within(1.0, 6.0)),
        ("lowest_mode_min_hz", dice.within(3.0, 9.0)),
        ("mass_max_kg", dice.within(25.0, 70.0)),
        ("wall_slenderness_max", 45.0),
    ];
    for (name, limit) in limits {
        if dice.below(4) == 0 {
            constraints[name] = json!(limit);
        }
    }
    constraints
}

fn read(study: &Value, catalogs: &Catalogs) -> Study {
    let text = study.to_string();
    let document = Document::parse("random study", &text).unwrap_or_else(|e| panic!("{e}"));
    read_study(document, catalogs).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// A box at the end of a walk of some steps down the trees.
fn random_box(boxes: &Boxes, dice: &mut Dice) -> Option<PartsBox> {
    let mut parts = boxes.root()?;
    let levels = boxes.options(&parts).len() as u64;
    // a study without a choice is its one box
    let steps = if levels > 0 { dice.below(5 * levels) } else { 0 };
    for _ in 0..steps {
        if let Some(halves) = boxes.halves(&parts, dice.below(levels) as usize) {
            parts = dice.of(&halves);
        }
    }
    Some(parts)
}

/// A box of one design.
fn random_design(boxes: &Boxes, dice: &mut Dice) -> Option<PartsBox> {
    let mut parts = boxes.root()?;
    for level in 0..boxes.options(&parts).len() {
        while let Some(halves) = boxes.halves(&parts, level) {
            parts = dice.of(&halves);
        }
    }
    Some(parts)
}

fn random_member(boxes: &Boxes, parts: &PartsBox, sizes: &[u32], dice: &mut Dice) -> u128 {
    let options: Vec<u32> = boxes.options(parts).iter().map(|options| dice.of(options)).collect();
    number(sizes, &options)
}

/// A design that holds, by the full model.
fn judged(study: &Study, problem: &ArmProblem, number: u128) -> Option<Objectives> {
    let Evaluated { objectives, .. } = evaluate(problem, number)?;
    (!study.space.constraints.broken(&objectives).contains(&true)).then_some(objectives)
}

/// The judge builds the arm of a design on its own, and comes to what the search's full model says: the same bits.
#[test]
fn a_design_is_judged_as_by_the_full_model_of_the_search() {
    let (mut holding, mut others) = (0, 0);
    for seed in 0..studies() {
        let catalogs = catalogs(seed);
        let study = read(&random_study(seed), &catalogs);
        let problem = ArmProblem::new(&study.space, &catalogs);
        let question = question(&study.space);
        let (boxes, judge) = (Boxes::new(&question, &catalogs), Judge::new(&question, &catalogs));
        let dice = &mut Dice(seed);
        for _ in 0..30 {
            let Some(root) = boxes.root() else { break };
            let options: Vec<u32> = boxes.options(&root).iter().map(|options| dice.of(options)).collect();
            let number = number(problem.level_sizes(), &options);
            let by_search = judged(&study, &problem, number);
            let own = judge.judge(&judge.picks(&options));
            let what = format!("seed {seed}, design {number}");
            assert_eq!(own.as_ref().map(|own| own.objectives), by_search, "{what}");
            if let Some(own) = own {
                let named: Option<Vec<Pick>> = picks(&problem, &catalogs, number);
                assert_eq!(Some(&own.picks), named.as_ref(), "{what}");
                assert_eq!(judge.judge(&own.picks).as_ref(), Some(&own), "{what}");
            }
            *(if by_search.is_some() { &mut holding } else { &mut others }) += 1;
        }
    }
    println!("{holding} designs hold, {others} do not");
    assert!(holding > 5 * studies() && others > studies(), "{holding} {others}");
}

#[test]
fn no_member_of_a_box_is_better_than_its_ceiling() {
    let mut members = 0;
    for seed in 0..studies() {
        let catalogs = catalogs(seed);
        let study = read(&random_study(seed), &catalogs);
        let problem = ArmProblem::new(&study.space, &catalogs);
        let boxes = Boxes::new(&question(&study.space), &catalogs);
        let dice = &mut Dice(seed);
        for _ in 0..40 {
            let Some(parts) = random_box(&boxes, dice) else { break };
            for _ in 0..4 {
                let number = random_member(&boxes, &parts, problem.level_sizes(), dice);
                let Some(found) = judged(&study, &problem, number) else { continue };
                let what = format!("seed {seed}, design {number}: {found:?}");
                let ceiling = boxes.least_mass_and_deflection(&parts);
                let [mass_kg, tip_m] = ceiling.unwrap_or_else(|| panic!("cut, but holds: {what}"));
                assert!(mass_kg <= found.mass_kg * (1.0 + ROUNDING), "{mass_kg} kg: {what}");
                assert!(tip_m <= found.tip_deflection_m * (1.0 + ROUNDING), "{tip_m} m: {what}");
                let slower_hz = found.lowest_mode_hz * (1.0 - ROUNDING);
                assert!(
                    !slower_hz.is_finite() || !boxes.proves_none_faster(&parts, slower_hz),
                    "mode: {what}"
                );
                members += 1;
            }
        }
    }
    println!("{members} members below their ceilings");
    assert!(members > 25 * studies(), "{members}");
}

#[test]
fn the_ceiling_of_a_single_design_is_close_to_it() {
    let mut singles = 0;
    for seed in 0..studies() {
        let catalogs = catalogs(seed);
        let text = random_study(seed);
        if text.to_string().contains("80000") {
            // a curve that softens is bounded by one that does not
            continue;
        }
        let study = read(&text, &catalogs);
        let problem = ArmProblem::new(&study.space, &catalogs);
        let boxes = Boxes::new(&question(&study.space), &catalogs);
        let dice = &mut Dice(seed);
        for _ in 0..15 {
            let Some(parts) = random_design(&boxes, dice) else { break };
            let number = random_member(&boxes, &parts, problem.level_sizes(), dice);
            let Some(found) = judged(&study, &problem, number) else { continue };
            let [mass_kg, tip_m] = boxes.least_mass_and_deflection(&parts).expect("it holds");
            let what = format!("seed {seed}, design {number}: {found:?}, {mass_kg} kg, {tip_m} m");
            assert!((mass_kg / found.mass_kg - 1.0).abs() < 1e-9, "{what}");
            assert!((tip_m - found.tip_deflection_m).abs() <= 1e-7 * found.tip_deflection_m, "{what}");
            let above_hz = found.lowest_mode_hz * 1.01;
            assert!(!above_hz.is_finite() || boxes.proves_none_faster(&parts, above_hz), "mode: {what}");
            singles += 1;
        }
    }
    assert!(singles > 2 * studies(), "{singles}");
}

#[test]
fn a_design_is_cut_exactly_if_it_is_too_weak() {
    let mut designs = 0;
    for seed in 0..studies() {
        let catalogs = catalogs(seed);
        let mut study = read(&random_study(seed), &catalogs);
        study.space.constraints = Constraints::default();
        let dice = &mut Dice(seed);
        let drawn = random_design(&Boxes::new(&question(&study.space), &catalogs), dice);
        let problem = ArmProblem::new(&study.space, &catalogs);
        let safety = drawn.and_then(|parts| {
            let boxes = Boxes::new(&question(&study.space), &catalogs);
            let options: Vec<u32> = boxes.options(&parts).into_iter().map(|options| options[0]).collect();
            let safety = problem.stress_safety_factor(&problem.walk(&options, |_, _| {}).ok()?)?;
            Some((parts, safety))
        });
        let Some((parts, safety)) = safety else { continue };
        for (asked, holds) in [(safety * (1.0 - 1e-8), true), (safety * 1.001, false)] {
            study.space.constraints.stress_safety_factor_min = Some(asked);
            let found = Boxes::new(&question(&study.space), &catalogs).least_mass_and_deflection(&parts);
            assert_eq!(found.is_some(), holds, "seed {seed}: asked for {asked} of {safety}");
        }
        designs += 1;
    }
    assert!(4 * designs > studies(), "{designs}");
}

/// Largest space that is visited.
const MOST_DESIGNS: u128 = 50_000;

/// The front by visiting every design.
fn true_front(study: &Study, catalogs: &Catalogs) -> Vec<Evaluated> {
    let problem = ArmProblem::new(&study.space, catalogs);
    let sweep = Sweep::new(&problem, study.space.constraints, &AtomicBool::new(false)).run();
    let judged: Vec<Evaluated> = sweep.front.iter().filter_map(|c| evaluate(&problem, c.number)).collect();
    let points: Vec<_> = judged.iter().map(|d| d.objectives.minimized()).collect();
    let kept = nondominated(&points).expect("numbers").into_iter().flatten();
    kept.map(|i| judged[i].clone()).collect()
}

fn look(study: &Study, catalogs: &Catalogs, front: &[&Evaluated], by: Settings) -> Looked {
    let objectives: Vec<Objectives> = front.iter().map(|d| d.objectives).collect();
    let question = question(&study.space);
    let judge = Judge::new(&question, catalogs);
    judge.missing(&objectives, by, &AtomicBool::new(false), None)
}

/// Numbers of the designs that were found, by the search's numbering.
fn numbers(study: &Study, catalogs: &Catalogs, looked: &Looked) -> Vec<u128> {
    let problem = ArmProblem::new(&study.space, catalogs);
    let number = |design: &Judged| {
        number_of_picks(&problem, catalogs, problem.level_sizes(), &design.picks)
            .expect("a design of the study")
    };
    looked.candidates.iter().map(number).collect()
}

/// Region by region, however small the space.
const BY_REGIONS: Settings = Settings { regions_from: 1, boxes_to: 60.0, apart: 0.0 };

/// Largest space that is searched region by region here: where nearly every design is on the front regions gain little.
const MOST_BY_REGIONS: u128 = 2_500;

/// Whether a design is as good as another in everything, or nearly so.
fn nearly_covers(a: &Evaluated, b: &Evaluated) -> bool {
    let (a, b) = (&a.objectives, &b.objectives);
    a.mass_kg <= b.mass_kg * (1.0 + 2.0 * ROUNDING)
        && a.tip_deflection_m <= b.tip_deflection_m * (1.0 + 2.0 * ROUNDING)
        && a.lowest_mode_hz >= b.lowest_mode_hz * (1.0 - 2.0 * ROUNDING)
}

/// Asserts of the random studies of no more designs that nothing is missing beside their fronts, and that what is dropped
/// from one is found; at least one study in so many is to have a front.
fn finds_what_is_dropped(by: Settings, most_designs: u128, one_in: u64) {
    let (mut fronts, mut dropped, mut boxes) = (0, 0, 0);
    for seed in 0..studies() {
        let catalogs = catalogs(seed);
        let study = read(&random_study(seed), &catalogs);
        if study.space.designs(&catalogs).is_none_or(|designs| designs > most_designs) {
            continue;
        }
        conditions(&question(&study.space)).expect("a duty cycle that its bounds know");
        let front = true_front(&study, &catalogs);
        let all: Vec<&Evaluated> = front.iter().collect();
        let looked = look(&study, &catalogs, &all, by);
        assert_eq!(looked.open, 0);
        let numbers_found = numbers(&study, &catalogs, &looked);
        let added: Vec<_> = numbers_found.iter().filter(|n| !front.iter().any(|d| d.number == **n)).collect();
        assert!(added.is_empty(), "seed {seed}: {added:?} beside {} rows", front.len());
        (fronts, boxes) = (fronts + u64::from(!front.is_empty()), boxes + looked.boxes);
        let step = front.len().div_ceil(4).max(1);
        for lost in front.iter().skip(step / 2).step_by(step) {
            let rest: Vec<&Evaluated> = all.iter().copied().filter(|d| d.number != lost.number).collect();
            if rest.iter().any(|row| nearly_covers(row, lost)) {
                continue;
            }
            let found = numbers(&study, &catalogs, &look(&study, &catalogs, &rest, by));
            assert!(found.contains(&lost.number), "seed {seed}: {lost:?} is not found");
            dropped += 1;
        }
    }
    println!("{fronts} fronts, {boxes} boxes, {dropped} designs dropped and found");
    assert!(fronts * one_in > studies() && dropped > fronts, "{fronts} fronts, {dropped} dropped");
}

#[test]
fn nothing_is_missing_beside_a_true_front_and_what_is_dropped_is_found() {
    finds_what_is_dropped(Settings::default(), MOST_DESIGNS, 3);
}

#[test]
fn region_by_region_nothing_is_missing_and_what_is_dropped_is_found() {
    finds_what_is_dropped(BY_REGIONS, MOST_BY_REGIONS, 8);
}

#[test]
fn the_answer_is_the_same_with_one_thread_and_says_what_is_left_if_stopped() {
    let catalogs = Catalogs::builtin();
    let small = |seed: &u64| {
        let space = read(&random_study(*seed), &catalogs).space;
        space.designs(&catalogs).is_some_and(|designs| (1_000..MOST_DESIGNS).contains(&designs))
    };
    let seed = (0..).find(small).expect("a small study");
    let study = read(&random_study(seed), &catalogs);
    let front = true_front(&study, &catalogs);
    let some: Vec<&Evaluated> = front.iter().skip(1).collect();
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    let one = alone.install(|| look(&study, &catalogs, &some, Settings::default()));
    assert_eq!(one, look(&study, &catalogs, &some, Settings::default()));
    let question = question(&study.space);
    let judge = Judge::new(&question, &catalogs);
    let stopped = judge.missing(&[], Settings::default(), &AtomicBool::new(false), Some(Instant::now()));
    assert!(stopped.open > 0 && stopped.candidates.is_empty());
}

#[test]
fn what_the_bounds_do_not_see_is_refused_in_words() {
    let catalogs = Catalogs::builtin();
    let mut study = read(&random_study(3), &catalogs);
    study.space.motion.duty_cycle.phases.retain(|phase| phase.kind != PhaseKind::Accelerate);
    let refused = conditions(&question(&study.space)).expect_err("refused");
    assert!(refused.contains("decelerates longer"), "{refused}");
}
