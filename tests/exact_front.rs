//! The exact search against visiting every design, on random small studies.
//!
//! Studies differ in poses (stretched, folded back, straight up, every joint turned), payloads and tip
//! forces, counterweights behind the shoulder, water, link models, three-segment gears that are given,
//! sized or chosen, and constraints. The two fronts must hold the same designs.
//!
//! `ARMWRIGHT_EXACT_STUDIES=500 cargo test --release --test exact_front` runs more of them.

use armwright::catalog::Catalogs;
use armwright::fault::Document;
use armwright::search::exact::Exact;
use armwright::search::front::nondominated;
use armwright::search::{ArmProblem, Sweep, evaluate};
use armwright::study::{Study, read_study};
use serde_json::{Value, json};
use std::sync::atomic::AtomicBool;

/// A small generator with a recorded seed.
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn chance(&mut self, one_in: u64) -> bool {
        self.next() % one_in == 0
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn of<T: Clone>(&mut self, list: &[T]) -> T {
        list[(self.next() % list.len() as u64) as usize].clone()
    }

    fn some<T: Clone>(&mut self, list: &[T], least: usize) -> Vec<T> {
        let kept: Vec<T> = list.iter().filter(|_| self.0 != 0 && self.chance(2)).cloned().collect();
        if kept.len() < least { list[..least].to_vec() } else { kept }
    }
}

const MATERIALS: [&str; 4] = [
    "Structural steel S355",
    "Aluminium 6061-T6",
    "Titanium Ti-6Al-4V",
    "CFRP T300/5208 (standard modulus) quasi-isotropic",
];

fn link(dice: &mut Dice, name: &str, vector_m: [f64; 3]) -> Value {
    let sizes = dice.some(&[50, 70, 90, 120, 150], 2);
    let walls = dice.some(&[2.0, 3.0, 5.0], 1);
    let section = match dice.chance(3) {
        true => json!({"shape": "round_tube", "diameter_mm": sizes, "wall_mm": walls}),
        false => {
            json!({"shape": "rectangular_tube", "width_mm": sizes, "height_mm": dice.some(&[60, 80, 110, 140], 1),
            "wall_mm": walls})
        }
    };
    json!({"type": "link", "name": name, "vector_m": vector_m,
        "choose": {"materials": dice.some(&MATERIALS, 1), "sections": [section]}})
}

fn joint(dice: &mut Dice, name: &str, axis: [f64; 3], open: &mut usize) -> Value {
    let drives = json!({"gear_series": [dice.of(&["CSG", "HFUC"])], "ratios": [100], "motors": ["electric"]});
    match dice.next() % 5 {
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
    let angles = match dice.next() % 6 {
        0 | 1 => vec![0.0; 4],
        2 => vec![0.0, -45.0, 90.0, 45.0],
        // folded back over the shoulder, and straight up
        3 => vec![0.0, -30.0, 150.0, 20.0],
        4 => vec![0.0, -90.0, 0.0, 0.0],
        _ => (0..4).map(|_| dice.within(-120.0, 120.0)).collect(),
    };
    json!({"pose_deg": angles})
}

fn random_study(seed: u64) -> Value {
    let dice = &mut Dice(seed);
    let mut open = 2;
    let (k4, k3) =
        (joint(dice, "j4", [0.0, 1.0, 0.0], &mut open), joint(dice, "j3", [0.0, 1.0, 0.0], &mut open));
    let (k2, k1) =
        (joint(dice, "j2", [0.0, 1.0, 0.0], &mut open), joint(dice, "j1", [0.0, 0.0, 1.0], &mut open));
    let mut chain = vec![k1, json!({"type": "link", "name": "shoulder", "vector_m": [0, 0, 0.3]}), k2];
    if dice.chance(3) {
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
    let poses: Vec<Value> = (0..1 + dice.next() % 2).map(|_| pose(dice)).collect();
    let mut study = json!({"name": format!("random-{seed}"), "chain": chain, "poses": poses,
        "payload": {"mass_kg": dice.within(1.0, 8.0), "cg_m": [0.03, dice.of(&[0.0, 0.05]), 0.02]},
        "models": {"links": dice.of(&["full", "full", "full", "bending"]),
                   "joints": dice.of(&["three_segment", "three_segment", "three_segment", "k2"])}});
    if dice.chance(4) {
        study["tip_force_n"] = json!([dice.within(-30.0, 30.0), 0.0, dice.within(-50.0, 120.0)]);
    }
    if dice.chance(5) {
        study["environments"] = json!([{"name": "dry"}, {"name": "sea", "water": {"density_kg_m3": 1025}}]);
    }
    let mut constraints = json!({});
    if dice.chance(2) {
        constraints["stress_safety_factor_min"] = json!(dice.within(1.5, 6.0));
    }
    if dice.chance(3) {
        constraints["tip_deflection_max_mm"] = json!(dice.within(0.5, 3.0));
    }
    if dice.chance(4) {
        constraints["lowest_mode_min_hz"] = json!(dice.within(5.0, 12.0));
    }
    if dice.chance(4) {
        constraints["mass_max_kg"] = json!(dice.within(25.0, 60.0));
    }
    study["constraints"] = constraints;
    study
}

fn read(study: &Value, catalogs: &Catalogs) -> Study {
    let text = study.to_string();
    let document = Document::parse("random study", &text).unwrap_or_else(|e| panic!("{e}"));
    read_study(document, catalogs).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// Designs of the front by the exact search.
fn exact_front(study: &Study, catalogs: &Catalogs) -> Vec<u128> {
    let stop = AtomicBool::new(false);
    let outcome = Exact::new(&study.space, catalogs, &stop, None).run(&[]);
    let points: Vec<_> = outcome.front.iter().map(|c| c.objectives.minimized()).collect();
    let mut numbers: Vec<u128> =
        nondominated(&points).into_iter().flatten().map(|i| outcome.front[i].number).collect();
    numbers.sort_unstable();
    numbers
}

/// Designs of the front by visiting every one, and how many there are.
fn swept_front(study: &Study, catalogs: &Catalogs) -> (Vec<u128>, u64) {
    let stop = AtomicBool::new(false);
    let problem = ArmProblem::new(&study.space, catalogs);
    let sweep = Sweep::new(&problem, study.space.constraints, &stop).run();
    let judged: Vec<_> = sweep.front.iter().filter_map(|c| evaluate(&problem, c.number)).collect();
    let points: Vec<_> = judged.iter().map(|d| d.objectives.minimized()).collect();
    let mut numbers: Vec<u128> =
        nondominated(&points).into_iter().flatten().map(|i| judged[i].number).collect();
    numbers.sort_unstable();
    (numbers, sweep.designs_evaluated)
}

#[test]
fn the_exact_front_is_the_front_of_every_design() {
    let studies: u64 =
        std::env::var("ARMWRIGHT_EXACT_STUDIES").ok().and_then(|n| n.parse().ok()).unwrap_or(40);
    let catalogs = Catalogs::builtin();
    let (mut points, mut feasible) = (0, 0);
    for seed in 0..studies {
        let text = random_study(seed);
        let study = read(&text, &catalogs);
        let (swept, evaluated) = swept_front(&study, &catalogs);
        let exact = exact_front(&study, &catalogs);
        assert_eq!(exact, swept, "seed {seed}, {evaluated} designs: {text}");
        points += swept.len();
        feasible += u64::from(!swept.is_empty());
    }
    println!("{studies} studies, {feasible} feasible, {points} front designs, the same in both");
    assert!(feasible * 2 > studies, "only {feasible} of {studies} studies are feasible");
    assert!(points as u64 > 10 * feasible, "fronts are too small to say much: {points} designs");
}
