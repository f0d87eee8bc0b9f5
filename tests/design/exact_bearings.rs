//! Output bearings in the exact search: how they tilt and what they carry.
//!
//! The gears of these catalogs have bearings of any stiffness, so gears of one size differ, and some are rigid. Ratings are
//! so low that some of them bind. Bearings are those of the gears, stated, those of other gears, or rigid. A third of the arms
//! have rails, whose ramps load the bearings too.

use crate::dice::Dice;
use crate::exact_front::random_study;
use crate::exact_support::{both_searches, read};
use crate::prismatic::add_prismatic;
use armwright::catalog::Catalogs;
use armwright::exact::Exact;
use armwright::space::{ArmProblem, OutwardIn};
use serde_json::{Value, json};
use std::sync::atomic::AtomicBool;

/// Gives every gear another bearing: some rigid, others a tenth to three times as stiff.
pub fn change_bearings(catalogs: &mut Catalogs, seed: u64) {
    let dice = &mut Dice(seed + 3_000);
    for gear in &mut catalogs.gears {
        let times = 10f64.powf(dice.within(-1.0, 0.5));
        let stiffness = gear.tilting_stiffness_nm_per_rad.map(|k| k * times);
        gear.tilting_stiffness_nm_per_rad = stiffness.filter(|_| dice.below(6) > 0);
        let rated = dice.within(0.15, 1.2);
        gear.permissible_tilting_moment_nm = gear.permissible_tilting_moment_nm.map(|moment| moment * rated);
        gear.bearing.static_load_rating_n = gear.bearing.static_load_rating_n.map(|load| load * rated);
    }
}

/// Gives the sized joints of a study bearings of all kinds.
pub fn add_bearings(study: &mut Value, seed: u64) {
    let dice = &mut Dice(seed + 4_000);
    let joints =
        study["chain"].as_array_mut().expect("a chain").iter_mut().filter(|p| p["drive"].is_string());
    for joint in joints {
        match dice.below(8) {
            0 => joint["bearing"] = Value::Null,
            1 => {
                joint["bearing"] = json!({"tilt_stiffness_nm_per_rad": 10f64.powf(dice.within(4.3, 5.8)),
                    "permissible_moment_nm": dice.within(60.0, 900.0), "mass_kg": dice.of(&[0.0, 0.8]),
                    "offset_m": dice.of(&[0.0, 0.05])});
            }
            2 => {
                joint["drives"]["gear_mass"] = json!("component_set");
                joint["bearing"] = json!(dice.of(&["HFUC-25-100", "CSG-32-100"]));
            }
            _ => {}
        }
    }
    let tilt = |at: &str, c: f64| json!({"effect": "bearing_tilt", "at": at, "parameters": {"stiffness_nm_per_rad": c}});
    study["effects"] = match dice.below(3) {
        0 => json!([tilt(dice.of(&["j1", "j2", "j3", "j4"]), 10f64.powf(dice.within(4.3, 5.8)))]),
        _ => json!([]),
    };
}

/// Designs of a study with drives that a bearing alone excludes, at the joints that are levels.
fn excluded_by_bearings(problem: &ArmProblem) -> usize {
    let mut rigid = 0;
    let sizes = problem.level_sizes();
    let total: u64 = sizes.iter().map(|n| u64::from(*n)).product();
    for number in (0..total).step_by(1 + total as usize / 50) {
        let options = armwright::space::design::options(sizes, u128::from(number)).expect("in range");
        let _ = problem.walk(&options, |slot, outboard| {
            let Some(sized) = problem.sized_joint(problem.piece_of_slot(slot)) else { return };
            let demand = problem.demand_at(outboard, slot);
            let unloaded = demand.with_bearing(Default::default());
            rigid += usize::from(sized.table.first_fit(&demand) != sized.table.first_fit(&unloaded));
        });
    }
    rigid
}

#[test]
fn the_exact_front_is_whole_with_bearings_that_tilt_and_limit() {
    let studies: u64 =
        std::env::var("ARMWRIGHT_EXACT_STUDIES").ok().and_then(|n| n.parse().ok()).unwrap_or(9);
    let (mut points, mut feasible, mut excluded) = (0, 0, 0);
    for seed in 0..studies {
        let (mut text, mut catalogs) = (random_study(seed), Catalogs::builtin());
        add_bearings(&mut text, seed);
        if seed % 3 == 1 {
            add_prismatic(&mut text, seed);
        }
        change_bearings(&mut catalogs, seed);
        let study = read(&text, &catalogs);
        let problem = ArmProblem::new(&study.space, &catalogs);
        let what = format!("seed {seed}: {text}");
        let (_, listed) = both_searches(&study, &catalogs, seed.is_multiple_of(4), &what);
        points += listed;
        feasible += u64::from(listed > 0);
        excluded += usize::from(excluded_by_bearings(&problem) > 0);
    }
    println!(
        "{studies} studies, {feasible} feasible, {points} front designs; bearings ask for a heavier drive in {excluded}"
    );
    assert!(feasible * 5 > 2 * studies, "only {feasible} of {studies} studies are feasible");
    assert!(points as u64 > 8 * feasible, "fronts are too small to say much: {points} designs");
    assert!(excluded as u64 * 5 > studies, "ratings bind in {excluded} of {studies} studies only");
}

/// The gears of these catalogs have rigid bearings without ratings.
fn rigid_bearings() -> Catalogs {
    let mut catalogs = Catalogs::builtin();
    for gear in &mut catalogs.gears {
        gear.tilting_stiffness_nm_per_rad = None;
        gear.permissible_tilting_moment_nm = None;
        gear.bearing = Default::default();
    }
    catalogs
}

/// Deflection, mass and mode of a front, in the order of its designs.
fn objectives(study: &Value, catalogs: &Catalogs) -> Vec<(u128, [f64; 3])> {
    let study = read(study, catalogs);
    let stop = AtomicBool::new(false);
    let mut front: Vec<(u128, [f64; 3])> = Exact::new(&study.space, catalogs, &stop, None)
        .run(&[])
        .front
        .iter()
        .map(|design| (design.number, design.objectives.minimized()))
        .collect();
    front.sort_by_key(|(number, _)| *number);
    front
}

#[test]
fn a_tilt_is_the_same_as_a_spring_of_its_own_and_as_coordinates_of_its_joint() {
    let catalogs = rigid_bearings();
    let mut designs = 0;
    for seed in 0..8 {
        // as coordinates: the gear decides, and its rigid bearing is in series with the effect
        let mut of_gear = random_study(seed);
        let dice = &mut Dice(seed + 5_000);
        let tilt = |at: &str, c: f64| json!({"effect": "bearing_tilt", "at": at, "parameters": {"stiffness_nm_per_rad": c}});
        of_gear["effects"] = ["j1", "j2", "j3", "j4"]
            .map(|at| tilt(at, 10f64.powf(dice.within(4.3, 5.8))))
            .into_iter()
            .filter(|_| dice.below(4) > 0)
            .collect();
        // as springs: the study says that the gear's bearing is rigid
        let mut stated = of_gear.clone();
        for piece in stated["chain"].as_array_mut().expect("a chain") {
            if piece["drive"].is_string() {
                piece["bearing"] = Value::Null;
            }
        }
        let [by_gear, by_spring] = [&of_gear, &stated].map(|study| objectives(study, &catalogs));
        assert_eq!(by_gear.len(), by_spring.len(), "{of_gear}");
        for ((number, a), (other, b)) in by_gear.iter().zip(&by_spring) {
            assert_eq!(number, other, "{of_gear}");
            let off = a.iter().zip(b).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
            assert!(off < 1e-9, "{a:?} as coordinates, {b:?} as springs: {of_gear}");
        }
        designs += by_gear.len();
    }
    println!("{designs} designs, the same in both");
    assert!(designs > 80, "{designs}");
}
