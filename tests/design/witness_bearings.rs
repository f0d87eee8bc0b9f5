//! The verifier works out on its own how bearings tilt and what they hold: a design that the search lost to a wrong number
//! of a bearing is found, and a row that such a number made is refused.
//!
//! The search is misled by the catalog that it reads, the verifier reads the true one.

use crate::witness_drives::{Row, Spoil, faults, front, spoiled, times};
use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::pareto::Objectives;
use armwright::study::question::question;
use armwright::study::{Study, read_study};
use armwright::verify::{Judge, Settings};
use serde_json::{Value, json};
use std::sync::atomic::AtomicBool;

/// A waist that hardly twists, a shoulder and an elbow, each with a choice of gears; the waist carries the moment of the
/// whole arm.
fn study(motion: Value, waist: Value, catalogs: &Catalogs) -> Study {
    read(&text(motion, waist), catalogs)
}

fn read(text: &Value, catalogs: &Catalogs) -> Study {
    let document = Document::parse("bearings", &text.to_string()).expect("JSON");
    read_study(document, catalogs).unwrap_or_else(|fault| panic!("{fault}"))
}

fn text(motion: Value, waist: Value) -> Value {
    let tubes = |diameters_mm: Value| {
        json!({"materials": ["Aluminium 6061-T6"],
            "sections": [{"shape": "round_tube", "diameter_mm": diameters_mm, "wall_mm": [3]}]})
    };
    let few = json!({"gear_series": ["CSG"], "ratios": [100], "motor_models": ["ILM70x18", "ILM85x26"]});
    let mut text = json!({
        "name": "bearings", "question": "which bearings decide?",
        "chain": [
            {"type": "joint", "name": "waist", "axis": [0, 0, 1], "drive": "all_fits", "drives": few},
            {"type": "link", "name": "column", "vector_m": [0, 0, 0.3]},
            {"type": "joint", "name": "shoulder", "axis": [0, 1, 0], "drive": "all_fits", "drives": few},
            {"type": "link", "name": "upper", "vector_m": [0.5, 0, 0], "choose": tubes(json!([90, 120]))},
            {"type": "joint", "name": "elbow", "axis": [0, 1, 0], "drive": "first_fit", "drives": few},
            {"type": "link", "name": "fore", "vector_m": [0.4, 0, 0], "choose": tubes(json!([60, 90]))}],
        "payload": {"mass_kg": 6, "cg_m": [0.05, 0.03, 0]},
        "poses": [{"pose_deg": [0, 0, 0]}, {"pose_deg": [0, -40, 90]}],
        "motion": motion,
    });
    if let Some(fields) = waist.as_object() {
        text["chain"][0].as_object_mut().expect("a joint").extend(fields.clone());
    }
    text
}

/// Swift ramps load bearings as they run, stops as they stop, long lives as they rest.
fn motions() -> [(&'static str, Value); 3] {
    [
        ("ramp", json!({"ramp_time_s": 0.15, "emergency_deceleration_m_s2": 7})),
        ("stop", json!({"ramp_time_s": 0.5, "emergency_deceleration_m_s2": 40})),
        ("life", json!({"ramp_time_s": 0.5, "emergency_deceleration_m_s2": 2, "life_h": 60000})),
    ]
}

/// One number of a bearing each.
const NUMBERS: [(&str, Spoil); 6] = [
    ("permissible moment", |gear, _, by| times(&mut gear.permissible_tilting_moment_nm, by)),
    ("static rating", |gear, _, by| times(&mut gear.bearing.static_load_rating_n, by)),
    ("dynamic rating", |gear, _, by| times(&mut gear.bearing.dynamic_load_rating_n, by)),
    ("pitch diameter", |gear, _, by| times(&mut gear.bearing.pitch_diameter_m, by)),
    // the offset is short, so a factor has to be large to decide
    ("flange offset", |gear, _, by| times(&mut gear.bearing.offset_m, by.powi(6))),
    ("tilting stiffness", |gear, _, by| times(&mut gear.tilting_stiffness_nm_per_rad, by)),
];

#[test]
fn one_wrong_number_of_bearings_is_found_and_each_decides_somewhere() {
    let catalogs = Catalogs::builtin();
    let mut decides = [false; NUMBERS.len()];
    for (what, motion) in motions() {
        let study = study(motion, Value::Null, &catalogs);
        let true_front = front(&study, &catalogs, &catalogs);
        assert_eq!(faults(&study, &catalogs, &true_front), [0, 0], "{what}");
        for ((name, spoil), decides) in NUMBERS.iter().zip(&mut decides) {
            for factor in [0.6, 1.7] {
                let rows = front(&study, &spoiled(&catalogs, *spoil, factor), &catalogs);
                let found = faults(&study, &catalogs, &rows);
                println!("{what}, {name} times {factor}: {} rows, faults {found:?}", rows.len());
                assert_eq!(found == [0, 0], rows == true_front, "{what}, {name} times {factor}: {found:?}");
                *decides |= rows != true_front;
            }
        }
    }
    let idle: Vec<&str> =
        NUMBERS.iter().zip(decides).filter(|(_, d)| !d).map(|((name, _), _)| *name).collect();
    assert!(idle.is_empty(), "no study depends on {idle:?}");
}

/// The ramp of a rail under the waist loads the waist's bearing: with a quicker rail the front changes, search and
/// verifier agree on both fronts, and each finds fault with the other's.
#[test]
fn the_speed_of_a_rail_decides_and_a_front_of_another_speed_is_refused() {
    let catalogs = Catalogs::builtin();
    let at = |speed_m_s: f64| {
        let mut text = text(json!({"ramp_time_s": 0.25, "emergency_deceleration_m_s2": 10}), Value::Null);
        let rail = json!({"type": "prismatic", "name": "rail", "axis": [1, 0, 0], "stiffness_n_per_m": 1e8,
            "max_speed_m_s": speed_m_s});
        text["chain"].as_array_mut().expect("a chain").insert(0, rail);
        text["poses"] = json!([{"pose": {"rail_mm": 0, "waist_deg": 0, "shoulder_deg": 0, "elbow_deg": 0}},
            {"pose": {"rail_mm": 0, "waist_deg": 0, "shoulder_deg": -40, "elbow_deg": 90}}]);
        read(&text, &catalogs)
    };
    let [slow, fast] = [at(0.1), at(12.0)];
    let fronts = [&slow, &fast].map(|study| front(study, &catalogs, &catalogs));
    assert_ne!(fronts[0], fronts[1], "the rail decides nothing");
    for (study, rows) in [&slow, &fast].into_iter().zip(&fronts) {
        assert_eq!(faults(study, &catalogs, rows), [0, 0]);
    }
    assert_ne!(faults(&fast, &catalogs, &fronts[0]), [0, 0]);
    assert_ne!(faults(&slow, &catalogs, &fronts[1]), [0, 0]);
}

/// Search and verifier have the same formula of life: at no life of a ladder do they disagree, and the ladder is fine
/// enough to cross what bearings allow.
#[test]
fn the_lives_that_bearings_decide_are_those_of_the_search() {
    let catalogs = Catalogs::builtin();
    let mut fronts: Vec<Vec<Row>> = Vec::new();
    for step in 0..10 {
        let life_h = 15_000.0 * 1.3f64.powi(step);
        let motion = json!({"ramp_time_s": 0.5, "emergency_deceleration_m_s2": 2, "life_h": life_h});
        let study = study(motion, Value::Null, &catalogs);
        let rows = front(&study, &catalogs, &catalogs);
        assert_eq!(faults(&study, &catalogs, &rows), [0, 0], "{life_h} h");
        fronts.push(rows);
    }
    let rigid = json!({"bearing": null});
    let changes = fronts.windows(2).filter(|pair| pair[0] != pair[1]).count();
    let of_teeth = (0..10).map(|step| {
        let motion = json!({"ramp_time_s": 0.5, "emergency_deceleration_m_s2": 2,
            "life_h": 15_000.0 * 1.3f64.powi(step)});
        front(&study(motion, rigid.clone(), &catalogs), &catalogs, &catalogs)
    });
    let of_teeth: Vec<Vec<Row>> = of_teeth.collect();
    let of_teeth = of_teeth.windows(2).filter(|pair| pair[0] != pair[1]).count();
    assert!(changes > of_teeth, "{changes} steps change the front, {of_teeth} without the waist's bearing");
}

/// The designs that the verifier misses beside some rows.
fn missing(study: &Study, catalogs: &Catalogs, rows: &[Row], by: Settings) -> Vec<Objectives> {
    let question = question(&study.space);
    let objectives: Vec<Objectives> = rows.iter().map(|row| row.1).collect();
    let looked = Judge::new(&question, catalogs).missing(&objectives, by, &AtomicBool::new(false), None);
    assert_eq!(looked.open, 0);
    let is_listed = |design: &Objectives| objectives.contains(design);
    looked.candidates.into_iter().map(|c| c.objectives).filter(|design| !is_listed(design)).collect()
}

#[test]
fn a_dropped_row_is_found_where_bearings_decide() {
    let catalogs = Catalogs::builtin();
    let by_regions = Settings { regions_from: 1, boxes_to: 60.0, apart: 0.0 };
    for (what, motion) in motions() {
        let with = study(motion.clone(), Value::Null, &catalogs);
        let rows = front(&with, &catalogs, &catalogs);
        let rigid = study(motion, json!({"bearing": null}), &catalogs);
        assert!(rows.len() > 5 && rows != front(&rigid, &catalogs, &catalogs), "{what}: {} rows", rows.len());
        for dropped in (0..rows.len()).step_by(3) {
            let mut rest = rows.clone();
            let (_, lost) = rest.remove(dropped);
            if rest.iter().any(|row| row.1 == lost) {
                continue;
            }
            for by in [Settings::default(), by_regions] {
                let found = missing(&with, &catalogs, &rest, by);
                assert!(found.contains(&lost), "{what}: {lost:?} is not found");
            }
        }
    }
}

#[test]
fn stated_bearings_weigh_yield_and_limit_in_the_verifier_as_in_the_search() {
    let catalogs = Catalogs::builtin();
    let motion = || json!({"ramp_time_s": 0.15});
    let bearing = |moment_nm: f64, mass_kg: f64| {
        json!({"bearing": {"tilt_stiffness_nm_per_rad": 2e5, "permissible_moment_nm": moment_nm, "mass_kg": mass_kg,
            "offset_m": 0.02}})
    };
    let of = |waist: Value| {
        let study = study(motion(), waist, &catalogs);
        let rows = front(&study, &catalogs, &catalogs);
        assert_eq!(faults(&study, &catalogs, &rows), [0, 0]);
        (study, rows)
    };
    let (_, strong) = of(bearing(400.0, 0.5));
    let (heavier, rows) = of(bearing(400.0, 1.25));
    assert!(!strong.is_empty());
    // rows of one study are wrong in another that differs in the bearing's mass, stiffness or strength alone
    let [wrong, _] = faults(&heavier, &catalogs, &strong);
    assert_eq!(wrong, strong.len(), "mass counts");
    for (a, b) in strong.iter().zip(&rows) {
        assert!((b.1.mass_kg - a.1.mass_kg - 0.75).abs() < 1e-9, "{} {}", a.1.mass_kg, b.1.mass_kg);
    }
    let (weak, none) = of(bearing(40.0, 1.25));
    assert!(none.is_empty(), "{} rows", none.len());
    assert_eq!(faults(&weak, &catalogs, &rows)[0], rows.len(), "strength counts");
}
