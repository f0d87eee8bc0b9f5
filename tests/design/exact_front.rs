//! The exact search against visiting every design, on random small studies.
//!
//! Studies differ in poses (stretched, folded back, straight up, every joint turned), payloads and tip
//! forces, counterweights behind the shoulder, water, link models, three-segment gears that are given,
//! sized or chosen, and constraints. The two fronts must hold the same designs.
//!
//! `ARMWRIGHT_EXACT_STUDIES=500 cargo test --release --test design exact_front` runs more of them.

use crate::bodies::add_bodies;
use crate::dice::Dice;
use crate::exact_support::{agree, agrees, judged, read};
use crate::prismatic::add_prismatic;
use crate::transmissions::add_stages;
use armwright::catalog::Catalogs;
use armwright::exact::{DomainReduction, Exact};
use armwright::input::Document;
use armwright::pareto::Objectives;
use armwright::pareto::front::nondominated;
use armwright::relax::Relaxation;
use armwright::search::Sweep;
use armwright::search::sweep::Candidate;
use armwright::space::ArmProblem;
use armwright::space::OutwardIn;
use armwright::space::design::options;
use armwright::space::evaluate;
use armwright::study::named;
use armwright::study::read_study;
use serde_json::{Value, json};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

const MATERIALS: [&str; 4] = [
    "Structural steel S355",
    "Aluminium 6061-T6",
    "Titanium Ti-6Al-4V",
    "CFRP T300/5208 (standard modulus) quasi-isotropic",
];

/// Some of a list, at least the first `least` of it.
fn some<T: Clone>(dice: &mut Dice, list: &[T], least: usize) -> Vec<T> {
    let kept: Vec<T> = list.iter().filter(|_| dice.below(2) == 0).cloned().collect();
    if kept.len() < least { list[..least].to_vec() } else { kept }
}

fn link(dice: &mut Dice, name: &str, vector_m: [f64; 3]) -> Value {
    let sizes = some(dice, &[50, 70, 90, 120, 150], 2);
    let walls = some(dice, &[2.0, 3.0, 5.0], 1);
    let section = match dice.below(3) == 0 {
        true => json!({"shape": "round_tube", "diameter_mm": sizes, "wall_mm": walls}),
        false => {
            json!({"shape": "rectangular_tube", "width_mm": sizes, "height_mm": some(dice, &[60, 80, 110, 140], 1),
            "wall_mm": walls})
        }
    };
    json!({"type": "link", "name": name, "vector_m": vector_m,
        "choose": {"materials": some(dice, &MATERIALS, 1), "sections": [section]}})
}

fn joint(dice: &mut Dice, name: &str, axis: [f64; 3], open: &mut usize) -> Value {
    let drives = json!({"gear_series": [dice.of(&["CSG", "HFUC"])], "ratios": [100], "motors": ["electric"]});
    match dice.below(5) {
        0 | 1 if *open > 0 => {
            *open -= 1;
            let motors = dice.of(&[["ILM70x18", "ILM85x26"], ["ILM50x14", "ILM85x26"]]);
            let drives =
                json!({"gear_series": [dice.of(&["CSG", "HFUC"])], "ratios": [100], "motor_models": motors});
            json!({"type": "joint", "name": name, "axis": axis, "drive": "all_fits", "drives": drives})
        }
        2 => {
            json!({"type": "joint", "name": name, "axis": axis, "gear": dice.of(&["CSG-32-100", "CSG-40-100"]),
            "mass_kg": dice.within(1.0, 6.0)})
        }
        _ => json!({"type": "joint", "name": name, "axis": axis, "drive": "first_fit", "drives": drives}),
    }
}

fn pose(dice: &mut Dice) -> Value {
    let angles = match dice.below(6) {
        0 | 1 => vec![0.0; 4],
        2 => vec![0.0, -45.0, 90.0, 45.0],
        // folded back over the shoulder, and straight up
        3 => vec![0.0, -30.0, 150.0, 20.0],
        4 => vec![0.0, -90.0, 0.0, 0.0],
        _ => (0..4).map(|_| dice.within(-120.0, 120.0)).collect(),
    };
    json!({"pose_deg": angles})
}

pub fn random_study(seed: u64) -> Value {
    let dice = &mut Dice(seed);
    let mut open = 2;
    let (k4, k3) =
        (joint(dice, "j4", [0.0, 1.0, 0.0], &mut open), joint(dice, "j3", [0.0, 1.0, 0.0], &mut open));
    let (k2, k1) =
        (joint(dice, "j2", [0.0, 1.0, 0.0], &mut open), joint(dice, "j1", [0.0, 0.0, 1.0], &mut open));
    let mut chain = vec![k1, json!({"type": "link", "name": "shoulder", "vector_m": [0, 0, 0.3]}), k2];
    if dice.below(3) == 0 {
        // a counterweight: behind the shoulder, and back again
        chain.push(json!({"type": "link", "name": "back", "vector_m": [-0.5, 0, 0], "mass_kg": dice.within(5.0, 40.0)}));
        chain.push(json!({"type": "link", "name": "front", "vector_m": [0.5, 0, 0]}));
    }
    let (upper_m, fore_m) = (dice.within(0.5, 0.9), dice.within(0.3, 0.6));
    chain.push(link(dice, "upper_arm", [upper_m, 0.0, 0.0]));
    chain.push(k3);
    let side = dice.of(&[0.0, 0.0, 0.08]);
    chain.push(link(dice, "forearm", [fore_m, side, 0.0]));
    chain.push(k4);
    chain.push(json!({"type": "link", "name": "flange", "vector_m": [0.1, 0, 0]}));
    let poses: Vec<Value> = (0..1 + dice.below(2)).map(|_| pose(dice)).collect();
    let mut study = json!({"name": format!("random-{seed}"), "chain": chain, "poses": poses,
        "payload": {"mass_kg": dice.within(1.0, 8.0), "cg_m": [0.03, dice.of(&[0.0, 0.05]), 0.02]},
        "models": {"links": dice.of(&["full", "full", "full", "bending"]),
                   "joints": dice.of(&["three_segment", "three_segment", "three_segment_k1", "k2"])}});
    if dice.below(4) == 0 {
        study["tip_force_n"] = json!([dice.within(-30.0, 30.0), 0.0, dice.within(-50.0, 120.0)]);
    }
    if dice.below(5) == 0 {
        study["environments"] = json!([{"name": "dry"}, {"name": "sea", "water": {"density_kg_m3": 1025}}]);
    }
    let mut constraints = json!({});
    if dice.below(2) == 0 {
        constraints["stress_safety_factor_min"] = json!(dice.within(1.5, 6.0));
    }
    if dice.below(3) == 0 {
        constraints["tip_deflection_max_mm"] = json!(dice.within(0.5, 3.0));
    }
    if dice.below(4) == 0 {
        constraints["lowest_mode_min_hz"] = json!(dice.within(5.0, 12.0));
    }
    if dice.below(4) == 0 {
        constraints["mass_max_kg"] = json!(dice.within(25.0, 60.0));
    }
    study["constraints"] = constraints;
    if seed % 4 == 3 {
        add_bodies(&mut study, seed);
    }
    study
}

#[test]
fn the_exact_front_is_the_front_of_every_design() {
    let studies: u64 =
        std::env::var("ARMWRIGHT_EXACT_STUDIES").ok().and_then(|n| n.parse().ok()).unwrap_or(10);
    let (catalogs, stop) = (Catalogs::builtin(), AtomicBool::new(false));
    let (mut points, mut feasible, mut boxes) = (0, 0, [0; 2]);
    for seed in 0..studies {
        let mut text = random_study(seed);
        if seed % 8 == 5 {
            add_prismatic(&mut text, seed);
        }
        if seed % 8 == 6 {
            add_stages(&mut text, seed);
        }
        let study = read(&text, &catalogs);
        let problem = ArmProblem::new(&study.space, &catalogs);
        let sweep = Sweep::new(&problem, study.space.constraints, &stop).run();
        let exact = Exact::new(&study.space, &catalogs, &stop, None).run(&[]);
        assert_eq!((exact.boxes_open, exact.gap), (0, Some(0.0)));
        let what = format!("seed {seed}, {} designs: {text}", sweep.designs_total);
        let listed = agrees(&problem, &exact.front, &sweep.front, &what);
        // regions are for spaces far larger: they take long on small ones
        if seed % 8 == 0 {
            let by_regions = Exact::new(&study.space, &catalogs, &stop, None).by_regions_from(100.0).run(&[]);
            agrees(&problem, &by_regions.front, &sweep.front, &what);
            boxes[0] += exact.boxes;
            boxes[1] += by_regions.boxes;
        }
        points += listed;
        feasible += u64::from(listed > 0);
    }
    println!(
        "{studies} studies, {feasible} feasible, {points} front designs, the same in both; boxes {boxes:?}"
    );
    assert_ne!(boxes[0], boxes[1], "no study is searched region by region");
    assert!(feasible * 2 > studies, "only {feasible} of {studies} studies are feasible");
    assert!(points as u64 > 10 * feasible, "fronts are too small to say much: {points} designs");
}

/// An arm with many drives at three joints, most of which a lighter one makes pointless, in poses in which a
/// heavier part pulls every joint the same way. Some break points lie where the torques are.
fn study_of_many_drives(seed: u64) -> Value {
    let dice = &mut Dice(seed);
    let drives = |dice: &mut Dice, ratios: &[u32]| {
        json!({"gear_series": ["CSG", "HFUC"], "ratios": ratios,
            "motor_models": some(dice, &["ILM50x14", "ILM70x18", "ILM85x26"], 2)})
    };
    let upper_m = dice.within(0.5, 0.9);
    let open = |name: &str, drives: Value| json!({"type": "joint", "name": name, "axis": [0, 1, 0], "drive": "all_fits", "drives": drives});
    let chain = json!([
        {"type": "joint", "name": "j1", "axis": [0, 0, 1], "gear": "CSG-40-100", "mass_kg": 8},
        {"type": "link", "name": "shoulder", "vector_m": [0, 0, 0.3]},
        open("j2", drives(dice, &[100])),
        link(dice, "upper_arm", [upper_m, 0.0, 0.0]),
        open("j3", drives(dice, &[100, 120])),
        {"type": "link", "name": "forearm", "vector_m": [0.4, 0, 0], "mass_kg": 2},
        open("j4", drives(dice, &[80, 100])),
        {"type": "link", "name": "flange", "vector_m": [0.1, 0, 0]}]);
    let bent = json!({"pose_deg": [0, -30, 60, dice.of(&[0, 60])]});
    let poses = if dice.below(2) == 0 {
        json!([{"pose_deg": [0, 0, 0, 0]}])
    } else {
        json!([{"pose_deg": [0, 0, 0, 0]}, bent])
    };
    json!({"name": format!("drives-{seed}"), "chain": chain, "poses": poses,
        "payload": {"mass_kg": dice.within(1.0, 8.0), "cg_m": [0.03, 0, 0.02]},
        "models": {"joints": dice.of(&["three_segment", "three_segment", "three_segment_k1"])},
        "constraints": {"stress_safety_factor_min": 1.5}})
}

#[test]
fn fronts_are_whole_where_most_drives_are_pointless() {
    let points: usize = (0..8).map(|seed| agree(&study_of_many_drives(seed), seed % 3 == 0)).sum();
    println!("{points} designs, the same in both");
    assert!(points > 200, "{points}");
}

/// An arm whose heavier wrist drives press joint 2 into a stiffer segment of its gear.
fn ballast_study() -> Value {
    let wrist = json!({"gear_series": ["CSG"], "ratios": [100], "motors": ["electric"]});
    json!({"name": "ballast", "chain": [
        {"type": "joint", "name": "j2", "axis": [0, 1, 0], "mass_kg": 10,
            "windup": {"k1_nm_per_rad": 2e5, "k2_nm_per_rad": 3.6e5, "k3_nm_per_rad": 4.4e5, "t1_nm": 90, "t2_nm": 130}},
        {"type": "link", "name": "arm", "vector_m": [0.8, 0, 0], "choose": {"materials": ["Aluminium 6061-T6"],
            "sections": [{"shape": "rectangular_tube", "width_mm": [80, 100, 120], "height_mm": [100, 140], "wall_mm": [3, 5]}]}},
        {"type": "joint", "name": "j3", "axis": [0, 1, 0], "drive": "all_fits", "drives": wrist},
        {"type": "link", "name": "flange", "vector_m": [0.2, 0, 0]}],
        "payload": {"mass_kg": 3}, "poses": [{"pose_deg": [0, 0]}]})
}

/// Designs without those whose drive another drive beats in mass, in every slope and in every break point.
fn without_dominated_drives(problem: &ArmProblem, numbers: impl Iterator<Item = u128>) -> Vec<u128> {
    let sized = problem.sized_joint(2).expect("joint 3 is sized");
    let merits = |drive: usize| {
        let gear = sized.table.drive(drive).gear;
        let slopes = [gear.k1_nm_per_rad, gear.k2_nm_per_rad, gear.k3_nm_per_rad].map(|k| k.unwrap_or(0.0));
        (sized.table.mass_kg(drive), slopes, *sized.table.limits(drive))
    };
    let beats = |a: usize, b: usize| {
        let ((mass_a, slopes_a, limits_a), (mass_b, slopes_b, limits_b)) = (merits(a), merits(b));
        mass_a < mass_b && slopes_a.iter().zip(slopes_b).all(|(a, b)| *a >= b) && limits_a.cover(&limits_b)
    };
    let drives = sized.table.len();
    let kept: Vec<bool> = (0..drives).map(|b| !(0..drives).any(|a| beats(a, b))).collect();
    numbers.filter(|&n| kept[options(problem.level_sizes(), n).expect("in range")[0] as usize]).collect()
}

#[test]
fn dropping_dominated_drives_would_lose_designs_that_the_exact_search_keeps() {
    let (catalogs, stop) = (Catalogs::builtin(), AtomicBool::new(false));
    let study = read(&ballast_study(), &catalogs);
    let problem = ArmProblem::new(&study.space, &catalogs);
    let sweep = Sweep::new(&problem, study.space.constraints, &stop).run();
    let exact = Exact::new(&study.space, &catalogs, &stop, None).run(&[]);
    let front = judged(&problem, &exact.front);
    assert_eq!(front, judged(&problem, &sweep.front));
    let total = u64::try_from(sweep.designs_total).expect("a small study");
    let kept = without_dominated_drives(&problem, 0..u128::from(total));
    let all: Vec<_> = kept.into_iter().filter_map(|n| evaluate(&problem, n)).collect();
    let points: Vec<_> = all.iter().map(|d| d.objectives.minimized()).collect();
    let naive: Vec<u128> =
        nondominated(&points).expect("numbers").into_iter().flatten().map(|i| all[i].number).collect();
    let lost = front.iter().filter(|n| !naive.contains(n)).count();
    assert!(lost > 0, "the example no longer shows what dropping dominated drives loses");
    println!("{lost} of {} designs of the front are lost when dominated drives are dropped", front.len());
}

#[test]
fn a_rectangular_tube_bent_about_both_axes_is_as_weak_as_in_the_sweep() {
    let study = |safety: f64| {
        json!({"name": "rolled", "chain": [
            {"type": "joint", "name": "j1", "axis": [0, 1, 0], "stiffness_nm_per_rad": 2e5, "mass_kg": 3},
            {"type": "joint", "name": "j2", "axis": [1, 0, 0], "stiffness_nm_per_rad": 2e5, "mass_kg": 2},
            {"type": "link", "name": "arm", "vector_m": [0.9, 0, 0], "choose": {"materials": ["Aluminium 6061-T6", "Structural steel S355"],
                "sections": [{"shape": "rectangular_tube", "width_mm": [40, 50, 60, 80], "height_mm": [40, 60, 80, 100], "wall_mm": [1, 2, 3]},
                             {"shape": "round_tube", "diameter_mm": [50, 70], "wall_mm": [1, 2, 3]}]}}],
            "payload": {"mass_kg": 12}, "poses": [{"pose_deg": [0, 45]}],
            "constraints": {"stress_safety_factor_min": safety}})
    };
    let sizes: Vec<usize> = (4..40).map(|k| agree(&study(0.5 * f64::from(k)), k % 4 == 0)).collect();
    assert!(sizes[0] > sizes[sizes.len() - 1], "the limit binds: {sizes:?}");
}

#[test]
fn a_gear_that_softens_under_load_is_bounded_too() {
    let study = |t1: f64| {
        json!({"name": "softening", "chain": [
            {"type": "joint", "name": "j1", "axis": [0, 1, 0], "mass_kg": 3,
                "windup": {"k1_nm_per_rad": 4e5, "k2_nm_per_rad": 1e5, "k3_nm_per_rad": 2e5, "t1_nm": t1, "t2_nm": 1.5 * t1}},
            {"type": "link", "name": "arm", "vector_m": [0.9, 0, 0], "choose": {"materials": ["Aluminium 6061-T6", "Structural steel S355"],
                "sections": [{"shape": "rectangular_tube", "width_mm": [40, 60, 80, 120], "height_mm": [40, 60, 80, 120], "wall_mm": [2, 3, 5]}]}}],
            "payload": {"mass_kg": 6}, "poses": [{"pose_deg": [0]}]})
    };
    assert!((50..130).step_by(5).map(|t| agree(&study(f64::from(t)), t % 20 == 0)).sum::<usize>() > 100);
}

#[test]
fn a_search_that_is_stopped_says_by_how_much_it_may_be_bettered_and_is_right() {
    let (catalogs, stop) = (Catalogs::builtin(), AtomicBool::new(false));
    let study = read(&random_study(1), &catalogs);
    let whole = Exact::new(&study.space, &catalogs, &stop, None).run(&[]);
    assert!(!whole.front.is_empty());
    // the deadline passes at once: what is found is little, and it says so
    let cut = Exact::new(&study.space, &catalogs, &stop, Some(Instant::now())).run(&[]);
    assert!(cut.boxes_open > 0 && cut.boxes < whole.boxes);
    let Some(gap) = cut.gap else { return };
    for design in &whole.front {
        let o = &design.objectives;
        let within = cut.front.iter().any(|c| {
            let f = &c.objectives;
            f.mass_kg <= o.mass_kg * (1.0 + gap)
                && f.tip_deflection_m <= o.tip_deflection_m * (1.0 + gap)
                && f.lowest_mode_hz * (1.0 + gap) >= o.lowest_mode_hz
        });
        assert!(within, "{o:?} is further than {gap} from what was found");
    }
}

#[test]
fn a_front_with_a_design_dropped_is_found_out_by_searching_from_it() {
    let (catalogs, stop) = (Catalogs::builtin(), AtomicBool::new(false));
    let study = read(&random_study(1), &catalogs);
    let problem = ArmProblem::new(&study.space, &catalogs);
    let whole = Exact::new(&study.space, &catalogs, &stop, None).run(&[]);
    let front = judged(&problem, &whole.front);
    let known = |numbers: &[u128]| -> Vec<Objectives> {
        numbers.iter().map(|&n| evaluate(&problem, n).expect("a design of the front").objectives).collect()
    };
    let found_beside = |known: &[Objectives]| -> Vec<u128> {
        let again = Exact::new(&study.space, &catalogs, &stop, None).run(known);
        again.front.iter().map(|c| c.number).collect()
    };
    let again = found_beside(&known(&front));
    assert!(front.iter().all(|n| again.contains(n)), "what is known is found again: it ties with itself");
    let dropped = front[front.len() / 2];
    let lacking: Vec<u128> = front.iter().copied().filter(|&n| n != dropped).collect();
    assert!(found_beside(&known(&lacking)).contains(&dropped));
}

#[test]
fn what_is_further_than_a_slack_from_known_designs_is_found() {
    const SLACK: f64 = 0.03;
    let (catalogs, stop) = (Catalogs::builtin(), AtomicBool::new(false));
    let is_near = |row: &Objectives, design: &Objectives| {
        row.mass_kg <= design.mass_kg * (1.0 + SLACK)
            && row.tip_deflection_m <= design.tip_deflection_m * (1.0 + SLACK)
            && row.lowest_mode_hz * (1.0 + SLACK) >= design.lowest_mode_hz
    };
    let mut far = 0;
    for seed in 0..16 {
        let study = read(&random_study(seed), &catalogs);
        let search = || Exact::new(&study.space, &catalogs, &stop, None);
        let front: Vec<Objectives> = search().run(&[]).front.iter().map(|c| c.objectives).collect();
        let known: Vec<Objectives> = front.iter().step_by(5).copied().collect();
        let is_far = |design: &Objectives| !known.iter().any(|row| is_near(row, design));
        far += front.iter().filter(|design| is_far(design)).count();
        for search in [search(), search().by_regions_from(100.0)] {
            let found = search.to_gap(SLACK).run(&known);
            let rows: Vec<Objectives> =
                found.front.iter().map(|c| c.objectives).chain(known.iter().copied()).collect();
            let missed = front.iter().find(|design| !rows.iter().any(|row| is_near(row, design)));
            assert!(missed.is_none(), "seed {seed}: {missed:?}");
            assert!(found.boxes_open == 0 && (known.is_empty() || found.gap == Some(SLACK)));
        }
    }
    println!("{far} designs were further than the slack from what was known");
    assert!(far > 50, "{far} designs say too little");
}

/// Whether a design is no worse than what is asked, in all three objectives.
fn is_as_good(design: &Objectives, asked: &Objectives) -> bool {
    design.mass_kg <= asked.mass_kg
        && design.tip_deflection_m <= asked.tip_deflection_m
        && design.lowest_mode_hz >= asked.lowest_mode_hz
}

#[test]
fn every_design_as_good_as_a_known_one_is_made_of_the_parts_in_reach() {
    let (catalogs, stop) = (Catalogs::builtin(), AtomicBool::new(false));
    let mut dice = Dice(11);
    let (mut as_good, mut parts, mut in_reach) = (0, 0, 0);
    for seed in 0..24 {
        let text = random_study(seed);
        let study = read(&text, &catalogs);
        let problem = ArmProblem::new(&study.space, &catalogs);
        let sizes = problem.level_sizes();
        let front = Sweep::new(&problem, study.space.constraints, &stop).run().front;
        let Some(reach) = DomainReduction::new(&study.space, &catalogs) else { continue };
        for known in front.iter().step_by(1 + front.len() / 8) {
            // loosened, so that several designs do
            let loosened = dice.within(1.0, 1.1);
            let asked = Objectives {
                mass_kg: known.objectives.mass_kg * loosened,
                tip_deflection_m: known.objectives.tip_deflection_m * loosened,
                lowest_mode_hz: known.objectives.lowest_mode_hz / loosened,
            };
            let lists = reach.options_as_good(&asked).expect("the known design is as good");
            let good: Vec<&Candidate> = front.iter().filter(|c| is_as_good(&c.objectives, &asked)).collect();
            for design in &good {
                let options = options(sizes, design.number).expect("a design");
                let is_in = options.iter().zip(&lists).all(|(option, list)| list.contains(option));
                assert!(is_in, "seed {seed}: {options:?} is not in {lists:?}: {text}");
            }
            as_good += good.len();
            parts += sizes.iter().map(|&n| n as usize).sum::<usize>();
            in_reach += lists.iter().map(Vec::len).sum::<usize>();
            // so a bound from these parts alone is one of all
            let space = study.space.of_options(&lists).expect("a list a level");
            let few = ArmProblem::new(&space, &catalogs);
            let options = few.options_of_whole(known.number).expect("it is in reach");
            let bound = Relaxation::new(&few).mass_lower_bound(&options, &asked).expect("it holds");
            let lightest_kg = good.iter().map(|c| c.objectives.mass_kg).fold(f64::INFINITY, f64::min);
            assert!(
                bound.mass_lower_bound_kg <= lightest_kg * (1.0 + 1e-9),
                "seed {seed}: {bound:?} {lightest_kg}"
            );
        }
    }
    println!("{as_good} designs as good as asked; {in_reach} of {parts} parts in reach");
    assert!(as_good > 400 && 3 * in_reach < 2 * parts, "{as_good} designs, {in_reach} of {parts} parts");
}

#[test]
fn few_of_the_parts_of_the_whole_catalog_reach_as_far_as_a_good_design() {
    let catalogs = Catalogs::builtin();
    let text = named("full-catalog").expect("it is built in");
    let study = read_study(Document::parse("full-catalog", text).expect("JSON"), &catalogs).expect("whole");
    // a knee that `armwright run full-catalog` finds, loosened by a percent
    let asked = Objectives { mass_kg: 36.3, tip_deflection_m: 1.621e-3, lowest_mode_hz: 15.29 };
    let reach = DomainReduction::new(&study.space, &catalogs).expect("no level is empty");
    let lists = reach.options_as_good(&asked).expect("it was found");
    let left = study.space.of_options(&lists).expect("a list a level").link_options();
    println!("{left} of {} tubes", study.space.link_options());
    assert!(left > 0 && left < 10_000 && study.space.link_options() > 400_000);
}

/// A random study whose arm has one to four effects.
fn study_with_effects(seed: u64) -> Value {
    let mut study = random_study(seed);
    let dice = &mut Dice(seed + 1_000);
    let stiffness = |dice: &mut Dice| 10f64.powf(dice.within(4.3, 5.8));
    let spring = |dice: &mut Dice, effect: &str, at: &str| json!({"effect": effect, "at": at, "parameters": {"stiffness_nm_per_rad": stiffness(dice)}});
    let all = [
        spring(dice, "bearing_tilt", "j2"),
        spring(dice, "bearing_tilt", "j4"),
        spring(dice, "base_compliance", "base"),
        spring(dice, "connection_compliance", "j2"),
        spring(dice, "connection_compliance", "j3"),
        json!({"effect": "extra_mass", "at": "j3", "parameters": {"delta_kg": dice.within(0.5, 4.0)}}),
        json!({"effect": "harness_mass", "at": "forearm", "parameters": {"kg_per_m": dice.within(0.5, 6.0)}}),
        json!({"effect": "harness_mass", "at": "shoulder", "parameters": {"kg_per_m": dice.within(0.5, 6.0)}}),
        json!({"effect": "harness_mass", "at": "flange", "parameters": {"kg_per_m": dice.within(0.5, 6.0)}}),
        json!({"effect": "modulus_error", "at": "upper_arm", "parameters": {"factor": dice.within(0.5, 1.2)}}),
        json!({"effect": "link_flexibility", "at": "forearm", "parameters": {"factor": dice.within(0.3, 2.0)}}),
        json!({"effect": "frame_compliance", "at": "upper_arm", "parameters": {
            "diagonal_rad_per_nm": [3e-6, 5e-6, 2e-6], "coupling_rad_per_nm": [1e-6, 0.0, -1e-6]}}),
        json!({"effect": "immersion", "at": "arm",
            "parameters": {"water_density_kg_m3": 1000, "added_mass_coefficient": 1.1}}),
    ];
    let mut places: Vec<usize> = (0..=dice.below(4)).map(|_| dice.below(all.len() as u64) as usize).collect();
    places.sort_unstable();
    places.dedup();
    study["effects"] = places.into_iter().map(|i| all[i].clone()).collect();
    // a curve of its own is for a joint whose gear is given
    if let Some(joint) = study["chain"].as_array().expect("chain").iter().find(|p| p["gear"].is_string()) {
        let (at, t1_nm) = (joint["name"].clone(), dice.within(40.0, 120.0));
        let curve = json!({"k1_nm_per_rad": 1.5e5, "k2_nm_per_rad": 2.6e5, "k3_nm_per_rad": 3.4e5, "t1_nm": t1_nm,
            "t2_nm": 2.0 * t1_nm});
        let soft = json!({"effect": "soft_windup", "at": at, "parameters": curve});
        study["effects"].as_array_mut().expect("effects").push(soft);
    }
    study
}

#[test]
fn effects_of_the_study_are_bounded_too() {
    // seeds that do not take long
    let points: usize =
        [1, 8, 13].map(|seed| agree(&study_with_effects(seed), seed % 4 == 1)).into_iter().sum();
    // a link far stiffer than its section says
    let mut stiffer = random_study(1);
    stiffer["effects"] =
        json!([{"effect": "link_flexibility", "at": "forearm", "parameters": {"factor": 0.2}}]);
    let points = points + agree(&stiffer, true);
    println!("{points} designs, the same in all searches");
    assert!(points > 100, "{points}");
}

/// A random study whose joints may have play: lost motion, friction or both.
fn study_with_play(seed: u64) -> Value {
    let mut study = random_study(seed);
    let dice = &mut Dice(seed + 2_000);
    let joints: Vec<Value> =
        study["chain"].as_array().expect("chain").iter().filter(|p| p["type"] == "joint").cloned().collect();
    let mut effects = Vec::new();
    for joint in joints {
        let lost = json!({"half_width_rad": 10f64.powf(dice.within(-5.0, -3.3)), "torque_nm": 10f64.powf(dice.within(0.0, 2.5))});
        let friction = json!({"half_width_rad": 10f64.powf(dice.within(-5.0, -3.3))});
        let kinds = [("lost_motion", lost), ("hysteresis", friction)];
        for (effect, parameters) in kinds {
            if dice.below(3) == 0 {
                effects.push(json!({"effect": effect, "at": joint["name"], "parameters": parameters}));
            }
        }
    }
    study["effects"] = json!(effects);
    study
}

#[test]
fn play_of_the_joints_is_bounded_too() {
    // seeds that do not take long
    let seeds = [5, 12, 47];
    let mut points: usize = seeds.map(|seed| agree(&study_with_play(seed), seed % 3 == 0)).into_iter().sum();
    // weight outboard closes play, and so stiffens a joint; or friction holds more back the more it carries
    let softer =
        json!({"k1_nm_per_rad": 2e5, "k2_nm_per_rad": 2e5, "k3_nm_per_rad": 6e5, "t1_nm": 20, "t2_nm": 30});
    let straight = json!({"k1_nm_per_rad": 3.6e5, "k2_nm_per_rad": 3.6e5, "k3_nm_per_rad": 3.6e5, "t1_nm": 20, "t2_nm": 30});
    let lost = |half_width_rad: f64, torque_nm: f64| json!({"effect": "lost_motion", "at": "j2", "parameters": {"half_width_rad": half_width_rad, "torque_nm": torque_nm}});
    let friction = json!({"effect": "hysteresis", "at": "j2", "parameters": {"half_width_rad": 5e-3}});
    let plays = [
        (&straight, lost(2e-3, 25.0)),
        (&straight, lost(5e-4, 15.0)),
        (&straight, lost(4e-3, 35.0)),
        (&softer, lost(1e-3, 30.0)),
        (&softer, friction),
    ];
    for (k, (windup, play)) in plays.into_iter().enumerate() {
        let mut study = ballast_study();
        study["chain"][0]["windup"] = windup.clone();
        study["effects"] = json!([play]);
        points += agree(&study, k % 2 == 0);
    }
    // a joint that twists by nothing else
    let chain = |axis: [f64; 3]| {
        json!([{"type": "joint", "name": "j1", "axis": axis, "stiffness_nm_per_rad": null, "mass_kg": 3},
            {"type": "link", "name": "arm", "vector_m": [0.9, 0, 0], "choose": {"materials": ["Aluminium 6061-T6", "Structural steel S355"],
                "sections": [{"shape": "rectangular_tube", "width_mm": [40, 60, 80, 120], "height_mm": [40, 60, 80, 120], "wall_mm": [2, 3, 5]}]}}])
    };
    for (axis, torque_nm) in [([0.0, 1.0, 0.0], 20.0), ([0.0, 1.0, 0.0], 0.05), ([0.0, 0.0, 1.0], 20.0)] {
        let lost = json!({"half_width_rad": 1e-4, "torque_nm": torque_nm});
        let effects = [("lost_motion", lost), ("hysteresis", json!({"half_width_rad": 2e-4}))];
        points += agree(
            &json!({"name": "rigid", "chain": chain(axis), "payload": {"mass_kg": 6}, "poses": [{"pose_deg": [0]}],
            "effects": effects.map(|(effect, parameters)| json!({"effect": effect, "at": "j1", "parameters": parameters}))}),
            true,
        );
    }
    println!("{points} designs, the same in all searches");
    assert!(points > 150, "{points}");
}
