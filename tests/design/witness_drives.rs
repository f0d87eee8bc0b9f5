//! The verifier works out which drives hold on its own: a drive that the search lacks, and one number of a drive that the
//! search has wrong, are found.
//!
//! The search is misled by what it reads (a filter, a catalog), the verifier reads the truth.

use armwright::catalog::Catalogs;
use armwright::catalog::Gear;
use armwright::catalog::Motor;
use armwright::input::Document;
use armwright::pareto::Objectives;
use armwright::pareto::front::nondominated;
use armwright::search::Sweep;
use armwright::space::design_space::{DriveChoice, SpacePiece};
use armwright::space::{ArmProblem, Evaluated, evaluate};
use armwright::study::question::{picks, question};
use armwright::study::{Study, read_study};
use armwright::verify::{Judge, Pick, Settings};
use std::collections::BTreeSet;
use std::sync::atomic::AtomicBool;

const STUDY: &str = r#"{"name": "drives", "chain": [
  {"type": "joint", "name": "base", "axis": [0, 0, 1], "drive": "first_fit", "drives": {"motors": ["electric"]}},
  {"type": "joint", "name": "shoulder", "axis": [0, 1, 0], "drive": "all_fits",
   "drives": {"gear_series": ["CSG", "HFUC"], "ratios": [100], "motor_models": ["ILM70x18", "ILM85x26"]}},
  {"type": "link", "name": "upper", "vector_m": [0.5, 0, 0], "choose": {
    "materials": ["Aluminium 6061-T6"],
    "sections": [{"shape": "round_tube", "diameter_mm": [60, 80, 110], "wall_mm": [2, 4]}]}},
  {"type": "joint", "name": "elbow", "axis": [0, 1, 0], "drive": "first_fit",
   "drives": {"gear_series": ["CSG", "HFUC"], "motors": ["electric"]}},
  {"type": "link", "name": "fore", "vector_m": [0.4, 0, 0], "choose": {
    "materials": ["Aluminium 6061-T6"],
    "sections": [{"shape": "round_tube", "diameter_mm": [50, 70], "wall_mm": [2]}]}}],
  "payload": {"mass_kg": 4}, "poses": [{"pose_deg": [0, 0, 0]}, {"pose_deg": [0, -40, 90]}],
  "motion": {"life_h": 30000}}"#;

fn study(catalogs: &Catalogs) -> Study {
    let document = Document::parse("drives", STUDY).unwrap_or_else(|e| panic!("{e}"));
    read_study(document, catalogs).unwrap_or_else(|e| panic!("{e}"))
}

/// A design of a front, by its parts.
pub type Row = (Vec<Pick>, Objectives);

/// The front that the sweep finds with some catalogs; parts by their places in the true ones.
pub fn front(study: &Study, read: &Catalogs, truth: &Catalogs) -> Vec<Row> {
    let problem = ArmProblem::new(&study.space, read);
    let sweep = Sweep::new(&problem, study.space.constraints, &AtomicBool::new(false)).run();
    let judged: Vec<Evaluated> = sweep.front.iter().filter_map(|c| evaluate(&problem, c.number)).collect();
    let points: Vec<_> = judged.iter().map(|d| d.objectives.minimized()).collect();
    let kept = nondominated(&points).expect("numbers").into_iter().flatten();
    let row = |i: usize| (picks(&problem, truth, judged[i].number).expect("it holds"), judged[i].objectives);
    kept.map(row).collect()
}

/// What the verifier finds fault with: rows that do not hold or have other objectives, and designs that are missing.
pub fn faults(study: &Study, truth: &Catalogs, rows: &[Row]) -> [usize; 2] {
    let question = question(&study.space);
    let judge = Judge::new(&question, truth);
    let is_wrong =
        |(picks, objectives): &&Row| judge.judge(picks).map(|own| own.objectives) != Some(*objectives);
    let wrong = rows.iter().filter(is_wrong).count();
    let objectives: Vec<Objectives> = rows.iter().map(|row| row.1).collect();
    let looked = judge.missing(&objectives, Settings::default(), &AtomicBool::new(false), None);
    let listed: BTreeSet<&Vec<Pick>> = rows.iter().map(|row| &row.0).collect();
    let missing = looked.candidates.iter().filter(|design| !listed.contains(&design.picks)).count();
    [wrong, missing]
}

/// Names of the gears that the rows of a front have at the shoulder.
fn gears_of(rows: &[Row], catalogs: &Catalogs) -> BTreeSet<String> {
    let gears = rows.iter().filter_map(|(picks, _)| match picks[1] {
        Pick::Drive { gear, .. } => Some(catalogs.gears[gear].id.clone()),
        _ => None,
    });
    gears.collect()
}

#[test]
fn a_true_front_is_found_to_be_right() {
    let catalogs = Catalogs::builtin();
    let study = study(&catalogs);
    let rows = front(&study, &catalogs, &catalogs);
    assert!(rows.len() > 20, "{} rows", rows.len());
    assert_eq!(faults(&study, &catalogs, &rows), [0, 0]);
}

#[test]
fn a_drive_that_the_tables_of_the_search_lack_is_found() {
    let catalogs = Catalogs::builtin();
    let truth = study(&catalogs);
    let gears = gears_of(&front(&truth, &catalogs, &catalogs), &catalogs);
    assert!(gears.len() > 3, "{gears:?}");
    for pruned in &gears {
        let mut misled = truth.clone();
        for piece in &mut misled.space.pieces {
            if let SpacePiece::Joint(joint) = piece
                && let DriveChoice::AllFits(filter) = &mut joint.drive
            {
                let others = catalogs.gears.iter().filter(|gear| gear.id != *pruned);
                filter.gear_ids = Some(others.map(|gear| gear.id.clone()).collect());
            }
        }
        let [wrong, missing] = faults(&truth, &catalogs, &front(&misled, &catalogs, &catalogs));
        assert!(wrong == 0 && missing > 0, "{pruned}: {wrong} rows are wrong, {missing} designs are missing");
    }
}

#[test]
fn a_drive_that_the_catalogs_of_the_search_lack_is_found() {
    let catalogs = Catalogs::builtin();
    let truth = study(&catalogs);
    for lacking in gears_of(&front(&truth, &catalogs, &catalogs), &catalogs) {
        let mut fewer = catalogs.clone();
        fewer.gears.retain(|gear| gear.id != lacking);
        let faults = faults(&truth, &catalogs, &front(&truth, &fewer, &catalogs));
        assert!(faults[1] > 0, "{lacking}: {faults:?}");
    }
}

/// One number of a catalog that a threshold is made of, and how to make it wrong.
pub type Spoil = fn(&mut Gear, &mut Motor, f64);

pub fn times(number: &mut Option<f64>, factor: f64) {
    number.iter_mut().for_each(|number| *number *= factor);
}

const THRESHOLDS: [(&str, Spoil); 8] = [
    ("gear peak", |gear, _, by| times(&mut gear.repeated_peak_torque_nm, by)),
    ("gear mean", |gear, _, by| times(&mut gear.average_torque_limit_nm, by)),
    ("gear stop", |gear, _, by| times(&mut gear.momentary_peak_torque_nm, by)),
    ("gear life", |gear, _, by| times(&mut gear.rated_torque_nm, by)),
    ("motor hold", |_, motor, by| times(&mut motor.rated_torque_nm, by)),
    ("motor rms, by speed", |_, motor, by| times(&mut motor.rated_speed_rpm, 0.3 * by)),
    ("motor rms, by inertia", |gear, _, by| times(&mut gear.inertia_input_kgm2, 5.0 * by)),
    ("motor peak", |_, motor, by| times(&mut motor.peak_torque_nm, by)),
];

/// Catalogs with a number of every part wrong by a factor.
pub fn spoiled(catalogs: &Catalogs, spoil: Spoil, factor: f64) -> Catalogs {
    let mut spoiled = catalogs.clone();
    for place in 0..spoiled.gears.len().max(spoiled.motors.len()) {
        // numbers of parts that are not there are spoiled in vain
        let mut gear = spoiled.gears[place.min(catalogs.gears.len() - 1)].clone();
        let mut motor = spoiled.motors[place.min(catalogs.motors.len() - 1)].clone();
        spoil(&mut gear, &mut motor, factor);
        if place < catalogs.gears.len() {
            spoiled.gears[place] = gear;
        }
        if place < catalogs.motors.len() {
            spoiled.motors[place] = motor;
        }
    }
    spoiled
}

#[test]
fn one_wrong_threshold_of_a_drive_is_found() {
    let catalogs = Catalogs::builtin();
    let study = study(&catalogs);
    let true_front = front(&study, &catalogs, &catalogs);
    for (name, spoil) in THRESHOLDS {
        for factor in [0.3, 1.0 / 0.7] {
            let rows = front(&study, &spoiled(&catalogs, spoil, factor), &catalogs);
            let found = faults(&study, &catalogs, &rows);
            println!("{name} times {factor:.2}: {} rows, faults {found:?}", rows.len());
            assert_eq!(found == [0, 0], rows == true_front, "{name} times {factor}: {found:?}");
        }
    }
}
