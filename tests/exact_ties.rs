//! Drives of equal mass and curve are one option of the exact search: every one of them that holds is listed all the same.

mod dice;
mod exact_support;

use armwright::catalog::Catalogs;
use armwright::search::exact::Exact;
use armwright::search::{ArmProblem, Sweep};
use dice::Dice;
use exact_support::{agree, read};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::sync::atomic::AtomicBool;

/// Two joints that may have all ratios of both series. What holds is now the motor, which asks for a high ratio, now
/// the gear's life or its speed, which ask for a low one: of drives that weigh and twist alike some hold.
fn study_of_ties(seed: u64) -> Value {
    let dice = &mut Dice(seed);
    let motors = ["ILM50x14", "ILM70x10", "ILM70x18", "ILM85x26", "MF0060008 48V", "MF0076008 48V"];
    let drives = |dice: &mut Dice| {
        let kept: Vec<&str> = motors.iter().copied().filter(|_| dice.below(2) == 0).collect();
        json!({"gear_series": ["CSG", "HFUC"], "ratios": [50, 80, 100, 120, 160],
            "motor_models": if kept.len() < 2 { &motors[2..4] } else { &kept[..] }})
    };
    let open = |name: &str, drives: Value| json!({"type": "joint", "name": name, "axis": [0, 1, 0], "drive": "all_fits", "drives": drives});
    let chain = json!([
        open("shoulder", drives(dice)),
        {"type": "link", "name": "upper_arm", "vector_m": [dice.within(0.3, 0.8), 0, 0],
            "choose": {"materials": ["Structural steel S355", "Aluminium 6061-T6"], "sections":
                [{"shape": "rectangular_tube", "width_mm": [60, 90, 120], "wall_mm": [2, 4]}]}},
        open("elbow", drives(dice)),
        {"type": "link", "name": "forearm", "vector_m": [dice.within(0.2, 0.5), 0, 0], "mass_kg": 1}]);
    json!({"name": format!("ties-{seed}"), "chain": chain,
        "poses": [{"pose_deg": [0, 0]}, {"pose_deg": [-40, dice.of(&[80, 150])]}],
        "payload": {"mass_kg": dice.within(0.5, 8.0), "cg_m": [0.03, 0, 0.02]},
        "motion": {"tip_speed_m_s": dice.within(0.5, 1.5), "ramp_time_s": 0.2, "life_h": dice.of(&[5000, 20000])},
        "drives": {"gear_mass": dice.of(&["housed_unit", "component_set"])}})
}

#[test]
fn every_tie_of_drives_that_weigh_and_twist_alike_is_listed() {
    let catalogs = Catalogs::builtin();
    let (mut designs, mut points) = (0, 0);
    for seed in 0..10 {
        let text = study_of_ties(seed);
        designs += agree(&text);
        let study = read(&text, &catalogs);
        let sweep = Sweep::new(
            &ArmProblem::new(&study.space, &catalogs),
            study.space.constraints,
            &AtomicBool::new(false),
        )
        .run();
        let of = |o: [f64; 3]| o.map(|x| (x.abs().ln() * 1e7).round() as i64);
        points += sweep.front.iter().map(|c| of(c.objectives.minimized())).collect::<BTreeSet<_>>().len();
    }
    println!("{designs} designs of {points} points, the same in both");
    assert!(points > 300 && designs > 2 * points, "{designs} designs of {points} points");
}

#[test]
fn ties_that_are_too_many_to_list_have_one_design_each_that_holds() {
    let catalogs = Catalogs::builtin();
    let stop = AtomicBool::new(false);
    let study = read(&study_of_ties(3), &catalogs);
    let search = || Exact::new(&study.space, &catalogs, &stop, None);
    let (all, few) = (search().run(&[]), search().with_ties_up_to(0).run(&[]));
    assert!(all.ties_listed && !few.ties_listed);
    assert!(few.front.len() < all.front.len(), "{} of {}", few.front.len(), all.front.len());
    let point = |o: &armwright::search::Objectives| o.minimized().map(f64::to_bits);
    let points: BTreeSet<[u64; 3]> = all.front.iter().map(|c| point(&c.objectives)).collect();
    assert_eq!(points, few.front.iter().map(|c| point(&c.objectives)).collect());
    assert!(few.front.iter().all(|c| all.front.iter().any(|other| other.number == c.number)));
}
