//! The fronts of reduced studies against a slow, separately written search (see `brute`). `brute_studies` has the studies.
//!
//! Each study runs through the `armwright` program; its files are all that is compared.

use crate::brute::arm::{Chosen, Tube, arm_file};
use crate::brute::catalog::Catalog;
use crate::brute::demand::Demand;
use crate::brute::design::{
    Design, Searched, chains, joint_that_nothing_holds, link_key, meets, objectives, search,
};
use crate::brute::front::{Place, SLACK, are_tied, exact_front_size, places};
use crate::brute::program::{
    FrontRow, Results, armwright_fails, armwright_ok, read_json, run_study, run_study_with, word,
};
use crate::brute::study::Study;
use crate::brute_studies::{
    ALUMINIUM, CFRP, STEEL, boxes, compare_materials, flat_with_effects, free_second_drive, limited,
    six_axes, sold, spatial, stout, with_effects,
};
use crate::exact_support::write_listed;
use crate::witness::LoadCase;
use nalgebra::Vector3;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::Path;

// Both programs solve the same equations, the one by compliances, the other by finite elements.
const DEFLECTION_TOLERANCE: f64 = 1e-9;
const MODE_TOLERANCE: f64 = SLACK;
const MASS_TOLERANCE: f64 = 1e-9;
const MARGIN_TOLERANCE: f64 = 1e-9;

/// What is compared about a study, and how well the two agree.
#[derive(Debug, Default)]
pub struct Agreement {
    pub designs: usize,
    pub front: usize,
    close_calls: usize,
    worst_mass: f64,
    worst_deflection: f64,
    worst_mode: f64,
}

/// Runs a study with both and compares everything.
pub fn assert_same(study_json: &Value) -> Agreement {
    assert_same_in(tempfile::tempdir().expect("a temporary folder").path(), study_json)
}

/// As [`assert_same`]; and some designs of the front are given as arm files that analyze to the same numbers.
fn assert_same_and_taken_out(study_json: &Value) -> Agreement {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let agreement = assert_same_in(dir.path(), study_json);
    let front = Results::read(&dir.path().join("results")).front;
    for row in front.iter().step_by(front.len().div_ceil(3)) {
        assert_taken_out_is_the_same(dir.path(), row);
    }
    agreement
}

/// Runs a study with both in a folder and compares everything.
fn assert_same_in(dir: &Path, study_json: &Value) -> Agreement {
    let results = run_study(dir, study_json);
    let study = Study::from_json(study_json, &Catalog::built_in());
    let searched = search(&study);
    assert_counts(&results, &searched, study_json);
    let all: Vec<&Design> = searched.designs.iter().collect();
    let mut agreement = assert_same_front("front.csv", study_json, &study, &results.front, &all);
    agreement.designs = all.len();
    for (material, front) in &results.by_material {
        let of_material: Vec<&Design> =
            all.iter().copied().filter(|design| design.only_material() == Some(material)).collect();
        let part = assert_same_front(material, study_json, &study, front, &of_material);
        agreement.worst_deflection = agreement.worst_deflection.max(part.worst_deflection);
        agreement.worst_mode = agreement.worst_mode.max(part.worst_mode);
    }
    println!("{}: {agreement:?}", study_json["name"]);
    agreement
}

fn assert_counts(results: &Results, searched: &Searched, study_json: &Value) {
    let [total, evaluated, excluded] =
        ["designs_total", "designs_evaluated", "designs_excluded"].map(|key| results.count(key));
    assert_eq!(evaluated + excluded, total, "every design is evaluated or excluded");
    assert_eq!(results.count("front_size"), results.front.len());
    assert!(!searched.designs.is_empty(), "a study without designs shows nothing");
    let has_free_drive =
        study_json["chain"].as_array().expect("a chain").iter().any(|p| p["drive"] == "all_fits");
    if has_free_drive {
        assert_eq!(total % searched.link_choices, 0, "every drive is offered to every choice of links");
    } else {
        assert_eq!(total, searched.link_choices, "designs_total");
    }
    let has_limits = study_json["constraints"].is_object();
    match has_limits {
        true => assert!(
            evaluated >= searched.designs.len(),
            "{evaluated} evaluated, {} meet",
            searched.designs.len()
        ),
        false => assert_eq!(evaluated, searched.designs.len(), "designs_evaluated"),
    }
}

/// The same designs on a front, up to those whose place depends on the last millionth, with the same parts and objectives.
fn assert_same_front(
    what: &str,
    study_json: &Value,
    study: &Study,
    front: &[FrontRow],
    designs: &[&Design],
) -> Agreement {
    let rows: HashMap<String, &FrontRow> = front.iter().map(|row| (row.key(study_json), row)).collect();
    assert_eq!(rows.len(), front.len(), "{what}: no design stands on a front twice");
    let mut agreement = Agreement::default();
    let mut matched = 0;
    for (design, place) in designs.iter().zip(places(designs)) {
        let key = design.key(study);
        match (place, rows.get(&key)) {
            (Place::On, None) => panic!("{what}: {key} is missing, {}", told(design)),
            (Place::Off, Some(_)) => panic!("{what}: {key} is dominated, {}", told(design)),
            (_, Some(row)) => {
                matched += 1;
                assert_same_design(row, design, &mut agreement);
            }
            _ => {}
        }
        agreement.close_calls += usize::from(place == Place::Close);
    }
    agreement.front = front.len();
    assert_ties_are_kept(what, study, &rows, designs);
    assert_eq!(matched, front.len(), "{what}: every design of the front is one of the study's");
    println!("  {what}: {} by the program, {} by all pairs", front.len(), exact_front_size(designs));
    agreement
}

/// A design that is as good as one on the front in everything is on the front too.
fn assert_ties_are_kept(what: &str, study: &Study, rows: &HashMap<String, &FrontRow>, designs: &[&Design]) {
    let (on, off): (Vec<&Design>, Vec<&Design>) =
        designs.iter().partition(|design| rows.contains_key(&design.key(study)));
    for left_out in off {
        let tied = on.iter().find(|design| are_tied(design, left_out));
        let [kept, left_out] =
            [tied.copied(), Some(left_out)].map(|d| d.map_or(String::new(), |d| d.key(study)));
        assert!(tied.is_none(), "{what}: {kept} is on the front, {left_out} is not");
    }
}

fn told(design: &Design) -> String {
    let Design { tip_deflection_mm, mass_kg, lowest_mode_hz, .. } = design;
    format!("{tip_deflection_mm} mm, {mass_kg} kg, {lowest_mode_hz} Hz, {:?}", design.drives())
}

fn assert_same_design(row: &FrontRow, design: &Design, agreement: &mut Agreement) {
    for (joint, gear, motor) in design.drives() {
        let chosen = [row.text(&format!("{joint}_gear")), row.text(&format!("{joint}_motor"))];
        assert_eq!(chosen, [gear, motor], "drive of {joint} in {}", row.text("design_id"));
    }
    let compare = |column: &str, ours: f64, tolerance: f64| {
        let theirs = row.number(column);
        let off = (theirs / ours - 1.0).abs();
        assert!(off <= tolerance, "{column} of {}: {theirs}, brute force {ours}", row.text("design_id"));
        off
    };
    let mass = compare("mass_kg", design.mass_kg, MASS_TOLERANCE);
    let deflection = compare("tip_deflection_mm", design.tip_deflection_mm, DEFLECTION_TOLERANCE);
    let mode = compare("lowest_mode_hz", design.lowest_mode_hz, MODE_TOLERANCE);
    if let Some(factor) = design.stress_safety_factor {
        compare("stress_safety_factor", factor, MARGIN_TOLERANCE);
    }
    if let Some(cost) = design.material_cost_eur {
        compare("material_cost_eur", cost, MARGIN_TOLERANCE);
    }
    agreement.worst_mass = agreement.worst_mass.max(mass);
    agreement.worst_deflection = agreement.worst_deflection.max(deflection);
    agreement.worst_mode = agreement.worst_mode.max(mode);
}

#[test]
fn finds_the_same_front_of_an_arm_with_effects() {
    let agreement = assert_same_and_taken_out(&with_effects());
    assert!(agreement.front > 3, "{agreement:?}");
    let agreement = assert_same(&flat_with_effects());
    assert!(agreement.front > 10, "{agreement:?}");
}

#[test]
fn finds_the_same_fronts_of_a_six_axis_arm_in_three_materials() {
    let agreement = assert_same_and_taken_out(&compare_materials());
    assert!(agreement.front > 10, "{agreement:?}");
}

#[test]
fn finds_the_same_front_when_every_drive_that_holds_is_a_choice() {
    let agreement = assert_same_and_taken_out(&free_second_drive());
    assert!(agreement.front > 10, "{agreement:?}");
}

#[test]
fn finds_the_same_front_within_limits() {
    let study_json = limited();
    assert_every_limit_bites(&study_json);
    let agreement = assert_same(&study_json);
    assert!(agreement.front > 3, "{agreement:?}");
}

/// Without any one of the limits more designs are left; and no design is so close to a limit that rounding decides.
fn assert_every_limit_bites(study_json: &Value) {
    let limits = study_json["constraints"].as_object().expect("limits").clone();
    let mut study = Study::from_json(study_json, &Catalog::built_in());
    study.constraints = json!({});
    let all = search(&study).designs;
    let mut number_within = |constraints: Value| {
        study.constraints = constraints;
        all.iter().filter(|design| meets(&study, design)).count()
    };
    let within = number_within(study_json["constraints"].clone());
    for (key, limit) in &limits {
        let others = limits.iter().filter(|(k, _)| *k != key).map(|(k, v)| (k.clone(), v.clone())).collect();
        assert!(number_within(others) > within, "{key} excludes nothing");
        let factor = if key.contains("_max") { 1.0 + 1e-5 } else { 1.0 - 1e-5 };
        for nearby in [factor, 1.0 / factor] {
            let mut moved = study_json["constraints"].clone();
            moved[key] = json!(limit.as_f64().expect("a number") * nearby);
            assert_eq!(number_within(moved), within, "a design is as good as at {key}");
        }
    }
}

#[test]
fn finds_the_same_front_in_folded_and_twisted_poses() {
    let agreement = assert_same_and_taken_out(&spatial());
    assert!(agreement.front > 3, "{agreement:?}");
}

#[test]
fn finds_the_same_front_with_thick_walls_bars_and_a_fibre_that_is_weak_in_compression() {
    let study = stout();
    assert_every_limit_bites(&study);
    let agreement = assert_same_and_taken_out(&study);
    assert!(agreement.front > 3, "{agreement:?}");
    // the verifier computes strengths, stresses and stiffnesses by itself and finds nothing missing, but what is taken away
    let dir = tempfile::tempdir().expect("a temporary folder");
    let results = dir.path().join("results");
    let exact = run_study_with(dir.path(), &study, &["--search", "exact", "--gap", "0%"]);
    assert_eq!(exact.front.len(), agreement.front);
    armwright_ok(&["front", "check", word(&results)]);
    let front = std::fs::read_to_string(results.join("front.csv")).expect("a front");
    let fewer: Vec<&str> = front.lines().enumerate().filter(|(i, _)| *i != 2).map(|(_, line)| line).collect();
    write_listed(&results, "front.csv", &(fewer.join("\n") + "\n"));
    assert_eq!(armwright_fails(&["front", "check", word(&results)]).0, 9);
}

#[test]
fn finds_the_same_front_with_round_tubes_and_catalog_profiles() {
    let agreement = assert_same_and_taken_out(&sold());
    assert!(agreement.front > 10, "{agreement:?}");
}

/// Links that offer different materials, and the same ones in another order.
#[test]
fn finds_the_same_front_of_each_material_when_links_offer_different_ones() {
    let mut study = compare_materials();
    study["name"] = json!("brute-mixed-materials");
    study["chain"][3]["choose"]["materials"] = json!([STEEL, ALUMINIUM, CFRP]);
    study["chain"][5]["choose"]["materials"] = json!([CFRP, "Titanium Ti-6Al-4V", STEEL]);
    assert_same(&study);
}

/// Not only the front: the drives and the mass of every design of a study, good or bad.
#[test]
fn sizes_every_design_of_a_study_alike() {
    let study_json = spatial();
    let dir = tempfile::tempdir().expect("a temporary folder");
    let results = run_study(dir.path(), &study_json);
    let study = Study::from_json(&study_json, &Catalog::built_in());
    let sized = chains(&study);
    let ours: HashMap<String, &[Chosen]> =
        sized.iter().map(|chain| (arm_key(&arm_file(0.0, chain)), &chain[..])).collect();
    assert_eq!(ours.len(), results.count("designs_total"));
    // every third: taking a design out is a run of the program
    for number in (0..ours.len()).step_by(3) {
        let id = format!("x{}", base_36(number));
        let out = dir.path().join("taken");
        armwright_ok(&["design", word(&dir.path().join("results")), &id, "--out", word(&out)]);
        let arm = read_json(&out.join("arm.json"));
        let chain = ours.get(&arm_key(&arm)).unwrap_or_else(|| panic!("design {id} is none of ours"));
        for (piece, entry) in chain.iter().zip(arm["chain"].as_array().expect("a chain")) {
            let Chosen::Joint(joint) = piece else { continue };
            let parts = [&entry["gear"], &entry["motor"]].map(|part| part.as_str().unwrap_or_default());
            assert_eq!(parts, [&joint.gear, &joint.motor], "drive of {} in design {id}", joint.name);
        }
        let (theirs_kg, ours_kg) = (arm_mass_kg(&arm), chain.iter().map(Chosen::mass_kg).sum::<f64>());
        assert!(
            (theirs_kg / ours_kg - 1.0).abs() < MASS_TOLERANCE,
            "{id}: {theirs_kg} kg, brute force {ours_kg} kg"
        );
    }
}

/// Material and section of every link of an arm file.
fn arm_key(arm: &Value) -> String {
    let link = |piece: &Value| {
        let tube = piece["section"].is_object().then(|| Tube::from_json(&piece["section"]))?;
        let [width, height, wall] = [tube.width_m, tube.height_m, tube.wall_m].map(|m| 1e3 * m);
        Some(link_key(piece["material"].as_str().expect("a material"), "", width, height, wall))
    };
    arm["chain"].as_array().expect("a chain").iter().filter_map(link).collect::<Vec<_>>().join("; ")
}

/// A design's number as its id: digits, then small letters.
fn base_36(number: usize) -> String {
    let digit = char::from_digit((number % 36) as u32, 36).expect("below 36");
    let rest = if number < 36 { String::new() } else { base_36(number / 36) };
    format!("{rest}{digit}")
}

/// `design`, then `analyze`, then the witness on the arm file.
fn assert_taken_out_is_the_same(dir: &Path, row: &FrontRow) {
    let id = row.text("design_id");
    let out = dir.join(format!("taken-{id}"));
    armwright_ok(&["design", word(&dir.join("results")), id, "--out", word(&out)]);
    let (arm, cases) = (out.join("arm.json"), out.join("cases.json"));
    let printed = armwright_ok(&["analyze", word(&arm), "--cases", word(&cases), "--json"]);
    let analyzed: Value = serde_json::from_str(&printed).expect("JSON");
    let analyzed = analyzed.as_array().expect("one object a case");
    let norm_mm = |case: &Value| {
        let squares = case["tip_displacement_m"].as_array().expect("a vector").iter();
        1e3 * squares.map(|x| x.as_f64().expect("a number").powi(2)).sum::<f64>().sqrt()
    };
    let deflection_mm = analyzed.iter().map(norm_mm).fold(0.0, f64::max);
    let first_hz = |case: &Value| case["modes"][0]["frequency_hz"].as_f64().expect("a frequency");
    let mode_hz = analyzed.iter().map(first_hz).fold(f64::INFINITY, f64::min);
    let off = (row.number("tip_deflection_mm") / deflection_mm - 1.0).abs();
    assert!(
        off < 1e-12,
        "design {id}: front {} mm, analyze {deflection_mm} mm",
        row.text("tip_deflection_mm")
    );
    assert_eq!(row.number("lowest_mode_hz"), mode_hz, "lowest mode of design {id}, front and analyze");

    let arm = read_json(&arm);
    let cases = read_json(&cases);
    let cases: Vec<LoadCase> = cases.as_array().expect("cases").iter().map(LoadCase::from_json).collect();
    let (witness_mm, witness_hz) = objectives(&arm, cases.iter());
    assert!(
        (deflection_mm / witness_mm - 1.0).abs() < DEFLECTION_TOLERANCE,
        "{id}: {deflection_mm} {witness_mm} mm"
    );
    assert!((mode_hz / witness_hz - 1.0).abs() < MODE_TOLERANCE, "{id}: {mode_hz} {witness_hz} Hz");
    let mass_kg = arm_mass_kg(&arm);
    assert!(
        (row.number("mass_kg") / mass_kg - 1.0).abs() < MASS_TOLERANCE,
        "{id}: {mass_kg} kg in the arm file"
    );
}

/// A joint with its bearing and extras, or an offset.
fn piece_mass_kg(piece: &Value) -> f64 {
    let extras = piece["extras"].as_object().into_iter().flat_map(|extras| extras.values());
    let masses = [&piece["mass_kg"], &piece["bearing"]["mass_kg"]].into_iter().chain(extras);
    masses.filter_map(Value::as_f64).sum()
}

/// Joints, offsets and tubes of an arm file.
fn arm_mass_kg(arm: &Value) -> f64 {
    let mass = |piece: &Value| {
        let Some(material) = piece["material"].as_str() else {
            return piece_mass_kg(piece);
        };
        let length_m =
            Vector3::from([0, 1, 2].map(|i| piece["vector_m"][i].as_f64().expect("a number"))).norm();
        let density_kg_m3 = arm["materials"][material]["density_kg_m3"].as_f64().expect("a density");
        density_kg_m3 * Tube::from_json(&piece["section"]).area_m2 * length_m
    };
    arm["chain"].as_array().expect("a chain").iter().map(mass).sum()
}

#[test]
fn writes_the_same_bytes_for_any_number_of_threads() {
    for study in [compare_materials(), free_second_drive()] {
        let fronts = ["1", "3"].map(|threads| {
            let dir = tempfile::tempdir().expect("a temporary folder");
            let results = run_study_with(dir.path(), &study, &["--threads", threads]);
            let slugs = results.run["materials"].as_array().expect("materials").iter();
            let by_material = slugs.map(|m| format!("front.{}.csv", m["slug"].as_str().expect("a slug")));
            let names = std::iter::once("front.csv".to_owned()).chain(by_material);
            let read = |name: String| std::fs::read(dir.path().join("results").join(name)).expect("written");
            names.map(read).collect::<Vec<_>>()
        });
        assert!(fronts[0] == fronts[1], "{}", study["name"]);
    }
}

#[test]
fn says_how_much_less_torque_or_speed_a_joint_that_nothing_holds_could_take() {
    let mut study = compare_materials();
    study["chain"] = six_axes(
        boxes(&[STEEL], json!(140), json!(140), json!(5)),
        boxes(&[STEEL], json!(100), json!(100), json!(4)),
    );
    for (payload_kg, life_h) in [(400.0, 10_000.0), (60.0, 3e7), (2500.0, 5_000.0)] {
        study["payload"]["mass_kg"] = json!(payload_kg);
        study["motion"]["life_h"] = json!(life_h);
        assert_smallest_relaxation(&study);
    }
}

/// At the percentages that the message gives for torque and for speed some drive holds, and a percent above none does.
fn assert_smallest_relaxation(study_json: &Value) {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let file = dir.path().join("study.json");
    std::fs::write(&file, study_json.to_string()).expect("written");
    let out = dir.path().join("results");
    let (code, said) = armwright_fails(&["run", word(&file), "--out", word(&out)]);
    assert_eq!(code, 6, "{said}");
    let study = Study::from_json(study_json, &Catalog::built_in());
    let (joint, bearing, asked) = joint_that_nothing_holds(&study).expect("nothing holds");
    assert!(said.contains(&format!("joint {joint}:")), "{joint} is not named in {said}");
    let holds =
        |demand: &Demand| study.drives.iter().any(|drive| drive.holds(&bearing, demand, &study.motion));
    let by_torque = largest_factor(&|factor| holds(&asked.with_torques_times(factor)));
    let by_speed = largest_factor(&|factor| holds(&asked.with_speed_times(factor)));
    let stated = |what: &str| {
        let words = said.split(what).nth(1)?.split("down to ").nth(1)?;
        words.split(" %").next()?.parse::<f64>().ok().map(|percent| percent / 100.0)
    };
    let (torque, speed) =
        (stated("torque on the joint"), stated("speed, acceleration and emergency deceleration"));
    println!("{joint}: torque {by_torque:?}, said {torque:?}; speed {by_speed:?}, said {speed:?}");
    for (what, ours, theirs) in [("torque", by_torque, torque), ("speed", by_speed, speed)] {
        match (ours, theirs) {
            (Some(ours), Some(theirs)) => {
                assert!(theirs <= ours + 1e-9, "{what} down to {theirs} is not enough, {ours} is: {said}");
                assert!(
                    theirs >= ours - 0.0101,
                    "{what} need not go down to {theirs}, only to {ours}: {said}"
                );
            }
            (Some(ours), None) => panic!("{what} down to {ours} would help: {said}"),
            (None, Some(theirs)) => panic!("{what} down to {theirs} does not help: {said}"),
            (None, None) => {}
        }
    }
}

/// The largest factor, at least 1 %, that helps.
fn largest_factor(helps: &dyn Fn(f64) -> bool) -> Option<f64> {
    (100..10_000).rev().map(|step| f64::from(step) / 1e4).find(|factor| helps(*factor))
}
