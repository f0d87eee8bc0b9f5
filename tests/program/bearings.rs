//! Output bearings and extras in the files and messages of the program: margins, moments, shares, reasons, masses, and
//! what could not be checked.

use crate::links::{armwright, folder_with};
use serde_json::{Value, json};
use std::path::Path;

/// A horizontal arm of 0.5 m without mass on a vertical joint, with a payload at its end.
fn study(payload_kg: f64, joint: Value) -> Value {
    let mut j1 = json!({"type": "joint", "name": "j1", "axis": [0, 0, 1], "drive": "all_fits"});
    j1.as_object_mut().expect("a joint").extend(joint.as_object().expect("keys").clone());
    json!({"name": "waist", "question": "?", "payload": {"mass_kg": payload_kg},
        "chain": [j1, {"type": "link", "name": "arm", "vector_m": [0.5, 0, 0]}],
        "poses": [{"name": "level", "pose_deg": [0]}]})
}

fn of_gears(gears: &[&str]) -> Value {
    json!({"drives": {"gears": gears, "motor_models": ["F11-5"]}})
}

/// What a run said, and the folder of its files.
fn run(study: &Value, more: &[&str]) -> (String, tempfile::TempDir) {
    let here = folder_with("study.json", study);
    let (code, said) = armwright(here.path(), &[&["run", "study.json", "--out", "out"][..], more].concat());
    assert_eq!(code, 0, "{said}");
    (said, here)
}

/// The rows of a table of results: a map from column to cell for each.
fn rows(folder: &Path, file: &str) -> Vec<std::collections::HashMap<String, String>> {
    let mut table = csv::Reader::from_path(folder.join("out").join(file)).expect("a table");
    table.deserialize().map(|row| row.expect("a row")).collect()
}

fn number(row: &std::collections::HashMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column}: {:?}", row.get(column)))
}

fn record(folder: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join("out/run.json")).expect("a record")).expect("JSON")
}

/// The vendor's procedure for a bearing of the catalog's CSG-20 under a payload at 0.5 m of a vertical joint: the tip ramps to 1 m/s
/// in 0.2 s and stops twice as fast, and the ramp pulls across the axis.
fn margin_of_csg_20(payload_kg: f64) -> f64 {
    let (permitted_nm, pitch_m, flange_m, c0_n, c_n) = (91.0, 0.05, 0.0095, 9000.0, 5780.0);
    let weight_n = payload_kg * 9.81;
    let moment_nm = |radial_n: f64| weight_n * 0.5 + flange_m * radial_n;
    let across_n = |radial_n: f64| radial_n + 2.0 / pitch_m * moment_nm(radial_n);
    let equivalent_n = |radial_n: f64| across_n(radial_n) + 0.44 * weight_n;
    let (ramp_n, stop_n) = (payload_kg * 5.0, payload_kg * 10.0);
    // 2 rad/s at full speed, 0.4 of that on average: 10000 h are this many million turns
    let million_turns = 0.8 / std::f64::consts::TAU * 3600.0 * 1e4 / 1e6;
    let dynamic_n = across_n(0.0) + 0.45 * weight_n;
    [
        permitted_nm / moment_nm(ramp_n),
        c0_n / 3.0 / equivalent_n(0.0),
        c0_n / 2.0 / equivalent_n(stop_n),
        c_n / (1.3 * dynamic_n * f64::powf(million_turns, 0.3)),
    ]
    .into_iter()
    .fold(f64::INFINITY, f64::min)
}

#[test]
fn the_front_has_the_margin_of_each_bearing_by_the_vendors_procedure() {
    let margin = |payload_kg: f64| {
        let (_, here) = run(&study(payload_kg, of_gears(&["CSG-20-100"])), &[]);
        number(&rows(here.path(), "front.csv")[0], "j1_bearing_margin")
    };
    for payload_kg in [2.0, 6.0, 10.0] {
        let (ours, by_hand) = (margin(payload_kg), margin_of_csg_20(payload_kg));
        assert!((ours / by_hand - 1.0).abs() < 1e-9, "{payload_kg} kg: {ours}, by hand {by_hand}");
    }
    assert!(margin(10.0) > 1.0 && margin_of_csg_20(15.0) < 1.0);
}

#[test]
fn the_margin_is_blank_where_there_is_no_bearing() {
    let mut rigid = of_gears(&["CSG-20-100"]);
    rigid["bearing"] = json!(null);
    let (_, here) = run(&study(6.0, rigid), &[]);
    assert_eq!(rows(here.path(), "front.csv")[0]["j1_bearing_margin"], "");
}

/// A waist of catalog gear under an elbow without a gear; 5 kg at the end of 0.8 m.
fn arm() -> Value {
    json!({"name": "arm", "chain": [
        {"type": "joint", "name": "j1", "axis": [0, 0, 1], "gear": "CSG-20-100", "mass_kg": 3},
        {"type": "link", "name": "column", "vector_m": [0, 0, 0.3], "mass_kg": 2},
        {"type": "joint", "name": "j2", "axis": [0, 1, 0], "stiffness_nm_per_rad": 5e4, "mass_kg": 1},
        {"type": "link", "name": "boom", "vector_m": [0.8, 0, 0], "mass_kg": 4}]})
}

fn analyzed(arm: &Value) -> (Value, String) {
    let here = folder_with("arm.json", arm);
    let flags = ["analyze", "arm.json", "--pose-deg", "0,0", "--payload-kg", "5", "--force-n", "0,30,0"];
    let (code, json) = armwright(here.path(), &[&flags[..], &["--json"]].concat());
    assert_eq!(code, 0, "{json}");
    (serde_json::from_str(&json).expect("JSON"), armwright(here.path(), &flags).1)
}

#[test]
fn an_analysis_has_the_moment_across_every_joint_by_hand_and_the_bearings_own_share() {
    let (found, text) = analyzed(&arm());
    // j1 carries the moment of the weights, and the force across at the height of the tip; the force's moment about its own axis
    // is torque
    let weights_nm: f64 = 9.81 * (4.0 * 0.4 + 5.0 * 0.8);
    let by_hand = weights_nm.hypot(30.0 * 0.3);
    let moment = |joint: &str| found["bearing_moment_nm"][joint].as_f64().expect("a number");
    assert!((moment("j1") / by_hand - 1.0).abs() < 1e-12, "{} {by_hand}", moment("j1"));
    // j2 has no bearing and still carries the force at 0.8 m
    assert!((moment("j2") - 30.0 * 0.8).abs() < 1e-9, "{}", moment("j2"));
    // the tilt is moment over stiffness, and the tip is 0.8 m out and 0.3 m up
    let share = found["shares"].as_array().unwrap().iter().find(|s| s["element"] == "j1.bearing");
    let moved = |i: usize| share.expect("a share")["tip_displacement_m"][i].as_f64().unwrap();
    let down = -weights_nm / 127_197.0 * 0.8;
    assert!((moved(2) / down - 1.0).abs() < 1e-9, "{} {down}", moved(2));
    assert!((moved(1) / (30.0 * 0.3 / 127_197.0 * 0.3) - 1.0).abs() < 1e-9);
    let energy: f64 = found["modes"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|m| m["strain_energy"]["j1.bearing"].as_f64())
        .sum();
    assert!(energy > 0.5, "{energy}");
    // at the bearing's centre the flange's offset counts, and the catalog permits 91 N m
    let centre = &found["bearings"]["j1"];
    let with_offset = by_hand + 0.0095 * 30.0;
    assert!(
        (centre["moment_with_offset_nm"].as_f64().unwrap() / with_offset - 1.0).abs() < 1e-12,
        "{centre}"
    );
    assert_eq!(centre["permissible_moment_nm"], 91.0);
    assert!((centre["axial_force_n"].as_f64().unwrap() / (9.81 * 12.0) - 1.0).abs() < 1e-12, "{centre}");
    let words: Vec<&str> =
        text.lines().find(|line| line.contains("91.0")).expect("a line").split_whitespace().collect();
    let shown = [format!("{by_hand:.3}"), format!("{with_offset:.3}")];
    assert_eq!(words, ["j1", &shown[0], &shown[1], "91.0"]);
}

#[test]
fn a_rigid_bearing_carries_the_same_moment_and_has_no_share() {
    let mut rigid = arm();
    rigid["chain"][0]["bearing"] = json!(null);
    let ((yields, _), (stands, text)) = (analyzed(&arm()), analyzed(&rigid));
    assert_eq!(yields["bearing_moment_nm"], stands["bearing_moment_nm"]);
    assert!(stands["bearings"].as_object().unwrap().is_empty() && !text.contains("at its centre"));
    assert_eq!((&stands["rigid_bearings"], &yields["rigid_bearings"]), (&json!(["j1"]), &json!([])));
    assert!(text.contains("rigid output bearing without mass: j1"), "{text}");
    assert!(!stands.to_string().contains("j1.bearing"));
}

#[test]
fn an_analysis_says_where_the_load_at_rest_alone_is_too_much_for_a_bearing() {
    let mut heavy = arm();
    heavy["chain"][3]["mass_kg"] = json!(20);
    assert!(!analyzed(&arm()).1.contains("too much"));
    assert!(analyzed(&heavy).1.contains("too much"));
}

#[test]
fn an_explanation_names_the_bearing_that_rejects_a_gear_with_number_limit_and_what_helps() {
    let mut study = study(15.0, of_gears(&["CSG-20-100", "CSG-25-100", "CSG-32-100"]));
    // so short a life that only static safety decides
    study["motion"] = json!({"life_h": 1000});
    let here = folder_with("study.json", &study);
    let (code, said) = armwright(here.path(), &["size", "study.json", "--explain", "j1"]);
    assert_eq!(code, 0, "{said}");
    // 3 (0.44 w + 20 w) N with w = 15 kg in weight, against 9000 N
    let reached: f64 = 9000.0 / (20.44 * 15.0 * 9.81);
    let rejected = format!("CSG-20-100 bearing safety at rest 3.00 needed, {reached:.2} reached");
    assert!(said.contains(&rejected), "{said}");
    assert!(
        said.contains("output bearings reject 1 of 3 gears, 1 for no other reason; nearest CSG-20-100"),
        "{said}"
    );
    let times = (100.0 * 3.0 / reached).ceil() / 100.0;
    let helps = format!(
        "or a bearing of the joint's own (\"bearing\") with static_load_rating_n at least {times} times as large"
    );
    assert!(said.contains(&helps), "{said}");
    let loads = "output bearing: at rest 73.6 N m, 0 N across and 147 N along the axis; in a ramp 73.6 N m, 75 N across";
    assert!(said.contains(loads), "{said}");
    let (code, table) = armwright(here.path(), &["size", "study.json"]);
    assert_eq!(code, 0, "{table}");
    assert!(table.contains("output bearings:\njoint moment allowed fs rest fs stop"), "{table}");
}

#[test]
fn a_study_that_no_bearing_holds_says_by_how_much_and_what_to_try() {
    let mut strong = of_gears(&["CSG-20-100", "CSG-25-100"]);
    // static ratings that hold anything, so that the moment decides
    strong["bearing"] = json!({"tilt_stiffness_nm_per_rad": 1e5, "permissible_moment_nm": 60});
    let here = folder_with("study.json", &study(15.0, strong));
    let (code, said) = armwright(here.path(), &["run", "study.json", "--out", "out"]);
    assert_eq!(code, 6, "{said}");
    let needed_nm: f64 = 15.0 * 9.81 * 0.5;
    let short = format!(
        "bearing moment {needed_nm:.1} N m needed, 60.0 allowed (short by {:.1} N m)",
        needed_nm - 60.0
    );
    assert!(said.contains(&short), "{said}");
    assert!(said.contains("smallest relaxation that helps: torque on the joint"), "{said}");
    let own = format!("with permissible_moment_nm of at least {}", needed_nm.ceil());
    assert!(said.contains(&own), "{said}");
}

/// The CSG-20-100 of the catalog without some of its figures, as a folder of own parts.
fn catalog_without(folder: &Path, blank: &[&str]) {
    let text = include_str!("../../catalogs/gears.csv");
    let mut table = csv::Reader::from_reader(text.as_bytes());
    let headers = table.headers().expect("headers").clone();
    let column = |name: &str| headers.iter().position(|h| h == name).expect("a column");
    let wanted = |row: &csv::StringRecord| {
        [("series", "CSG"), ("size", "20"), ("ratio", "100")]
            .iter()
            .all(|(name, cell)| &row[column(name)] == *cell)
    };
    let row = table.records().map(|row| row.expect("a row")).find(wanted).expect("CSG-20-100");
    let blanks: Vec<usize> = blank.iter().map(|name| column(name)).collect();
    let cells = row.iter().enumerate().map(|(i, cell)| if blanks.contains(&i) { "" } else { cell });
    std::fs::create_dir_all(folder.join("parts")).expect("a folder");
    let mut out = csv::Writer::from_path(folder.join("parts/gears.csv")).expect("a file");
    out.write_record(&headers).expect("written");
    out.write_record(cells).expect("written");
}

#[test]
fn a_bearing_that_lacks_ratings_is_named_beside_the_results_and_in_the_sizing() {
    let here = folder_with("study.json", &study(6.0, of_gears(&["CSG-20-100"])));
    let said_of = |blank: &[&str], words: &str| {
        catalog_without(here.path(), blank);
        let run = ["run", "study.json", "--out", "out", "--catalogs", "parts"];
        let (code, terminal) = armwright(here.path(), &run);
        assert_eq!(code, 0, "{terminal}");
        let read = |file: &str| std::fs::read_to_string(here.path().join("out").join(file)).expect(file);
        let sized = |more: &[&str]| {
            armwright(here.path(), &[&["size", "study.json", "--catalogs", "parts"], more].concat()).1
        };
        let of_run = [terminal, read("summary.md"), read("report.html"), read("run.json")];
        let of_size = [sized(&[]), sized(&["--json"]), sized(&["--explain", "j1"])];
        for text in of_run.iter().chain(&of_size) {
            let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(text.contains(words), "{words}: {text}");
        }
        rows(here.path(), "front.csv")[0]["j1_bearing_margin"].clone()
    };
    let (permitted, pitch) = ("permissible_tilting_moment_nm", "bearing_pitch_diameter_m");
    let loads = ["bearing_static_load_rating_n", "bearing_dynamic_load_rating_n"];
    let in_part = said_of(
        &loads,
        "bearing not checked in full: CSG-20-100 lacks bearing_static_load_rating_n, bearing_dynamic_load_rating_n",
    );
    // the moment alone is checked: 6 kg at 0.5 m, and the flange's offset times the ramp's force
    let by_hand = 91.0 / (6.0 * 9.81 * 0.5 + 0.0095 * 6.0 * 5.0);
    assert!((in_part.parse::<f64>().expect("a margin") / by_hand - 1.0).abs() < 1e-9, "{in_part}");
    let nothing =
        format!("bearing not checked: CSG-20-100 lacks {permitted}, {pitch}, {}, {}", loads[0], loads[1]);
    assert_eq!(said_of(&[permitted, pitch, loads[0], loads[1]], &nothing), "");
    // what loads it follows from the geometry, whether or not it is rated
    let (_, sized) = armwright(here.path(), &["size", "study.json", "--catalogs", "parts", "--json"]);
    let sized: Value = serde_json::from_str(&sized).expect("JSON");
    let moment_nm = sized[0]["bearing_moment_nm"].as_f64().expect("a number");
    assert!((moment_nm / (91.0 / by_hand) - 1.0).abs() < 1e-9, "{sized}");
    assert_eq!(sized[0]["bearing_moment_permissible_nm"], Value::Null);
    let rigid = "igid output bearing: CSG-20-100 lacks tilting_stiffness_nm_per_rad (the tip deflects more than printed)";
    said_of(&["tilting_stiffness_nm_per_rad"], rigid);
    let (_, checked) = armwright(here.path(), &["catalog", "check", "--catalogs", "parts"]);
    let line = "Output bearings that count as rigid (the tip deflects more than printed):";
    assert!(
        checked.contains(line) && checked.contains("CSG-20-100: no tilting_stiffness_nm_per_rad"),
        "{checked}"
    );
    std::fs::write(here.path().join("arm.json"), arm().to_string()).expect("written");
    let (_, analyzed) = armwright(here.path(), &["analyze", "arm.json", "--catalogs", "parts"]);
    assert!(
        analyzed.contains(
            "its tilting stiffness is unknown (the tip deflects more than printed): j1 (CSG-20-100)"
        )
    );
    catalog_without(here.path(), &[]);
    let (_, whole) = armwright(here.path(), &["size", "study.json", "--catalogs", "parts"]);
    assert!(!whole.contains("not checked") && !whole.contains("igid output bearing"), "{whole}");
}

#[test]
fn a_given_drive_says_what_is_not_weighed_and_each_check_that_it_fails() {
    let given = |payload_kg: f64, more: Value| {
        let mut given = study(payload_kg, json!({}));
        let joint = given["chain"][0].as_object_mut().expect("a joint");
        joint.remove("drive");
        joint.extend(
            json!({"axis": [0, 1, 0], "gear": "CSG-20-100", "motor": "ILM70x18"})
                .as_object()
                .expect("keys")
                .clone(),
        );
        joint.extend(more.as_object().expect("keys").clone());
        given["chain"][1] = json!({"type": "link", "name": "arm", "vector_m": [0.5, 0, 0], "choose": {
            "materials": ["Aluminium 6061-T6"],
            "sections": [{"shape": "rectangular_tube", "width_mm": [60, 80], "wall_mm": [2, 3]}]}});
        let (said, here) = run(&given, &[]);
        let remarks = record(here.path())["remarks"].to_string();
        (said.split_whitespace().collect::<Vec<_>>().join(" "), remarks)
    };
    let bare = "Nothing is weighed beyond the drive that is given and its bearing in j1";
    let weak = "The drive of j1 (CSG-20-100 + ILM70x18) is too weak in";
    let (said, record) = given(1.0, json!({}));
    for text in [&said, &record] {
        assert!(text.contains(bare) && !text.contains(weak), "{text}");
    }
    let (said, record) = given(30.0, json!({"extras": {"housing_kg": 0.4}}));
    for text in [&said, &record] {
        assert!(!text.contains(bare) && text.contains(weak), "{text}");
        // 30 kg at 0.5 m alone are 147 N m
        for part in ["at worst gear peak ", "gear mean ", "gear life ", "motor hold "] {
            assert!(text.contains(part), "{part}: {text}");
        }
    }
}

#[test]
fn an_explanation_says_what_the_numbers_leave_out() {
    let mut bare = study(6.0, of_gears(&["CSG-20-100"]));
    bare["chain"][0]["bearing"] = json!(null);
    bare["motion"] = json!({"check_motor_heat": false});
    let here = folder_with("study.json", &bare);
    for flag in ["--explain", "--all-fits"] {
        let (code, said) = armwright(here.path(), &["size", "study.json", flag, "j1"]);
        assert_eq!(code, 0, "{said}");
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
        for words in [
            "Rigid output bearing without mass in j1",
            "Motor heat not checked: the study turns it off",
            "whether the parts fit into each other",
        ] {
            assert!(said.contains(words), "{words}: {said}");
        }
    }
}

#[test]
fn the_mass_that_is_passed_inward_has_the_bearing_that_the_joint_states() {
    let inward = |bearing_kg: f64| {
        let mut stated = of_gears(&["CSG-20-100"]);
        stated["bearing"] = json!({"tilt_stiffness_nm_per_rad": 1e5, "mass_kg": bearing_kg});
        let here = folder_with("study.json", &study(6.0, stated));
        let (_, sized) = armwright(here.path(), &["size", "study.json", "--json"]);
        let sized: Value = serde_json::from_str(&sized).expect("JSON");
        sized[0]["mass_passed_inward_kg"].as_f64().expect("a number")
    };
    assert!((inward(0.8) - inward(0.0) - 0.8).abs() < 1e-12);
}

#[test]
fn a_stated_bearing_that_lacks_ratings_is_named_by_the_keys_of_the_file() {
    let mut stated = of_gears(&["CSG-20-100"]);
    stated["bearing"] = json!({"tilt_stiffness_nm_per_rad": 1e5, "permissible_moment_nm": 91});
    let (said, _) = run(&study(6.0, stated), &[]);
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    let words = "Output bearing not checked in full: the bearing of j1 lacks pitch_diameter_m, static_load_rating_n, \
                 dynamic_load_rating_n.";
    assert!(said.contains(words), "{said}");
}

#[test]
fn a_bearing_of_a_given_drive_is_checked_with_and_without_names() {
    let mut given = study(6.0, json!({}));
    given["chain"][0] =
        json!({"type": "joint", "name": "j1", "axis": [0, 0, 1], "gear": "CSG-20-100", "mass_kg": 3});
    given["chain"][1] = json!({"type": "link", "name": "arm", "vector_m": [0.5, 0, 0], "choose": {
        "materials": ["Aluminium 6061-T6"],
        "sections": [{"shape": "rectangular_tube", "width_mm": [60, 80], "wall_mm": [2, 3]}]}});
    let words = |study: &Value| run(study, &[]).0.split_whitespace().collect::<Vec<_>>().join(" ");
    let sentence = "Output bearings of joints whose drives are given hold in the sizing cases of the picks, as far as they are rated: j1 (margin";
    let said = words(&given);
    assert!(said.contains(sentence) && said.contains("The drive of j1 is not checked"), "{said}");
    given["payload"]["mass_kg"] = json!(30);
    let said = words(&given);
    assert!(said.contains("carry too much in the sizing cases of the picks: j1 ("), "{said}");
    given["payload"]["mass_kg"] = json!(6);
    given["chain"][0]["motor"] = json!("F11-5");
    let holds = words(&given);
    assert!(!holds.contains("whose drives are given") && !holds.contains("carries too much"), "{holds}");
    given["payload"]["mass_kg"] = json!(30);
    let too_much = "The output bearing of j1 carries too much in";
    assert!(words(&given).contains(too_much));
}

#[test]
fn the_extras_of_a_design_are_summed_in_the_front_and_the_record_and_written_resolved() {
    let (_, here) = run(&study(6.0, of_gears(&["CSG-20-100", "CSG-25-100"])), &[]);
    let record = record(here.path());
    for row in rows(here.path(), "front.csv") {
        let id = row["design_id"].as_str();
        let (code, said) = armwright(here.path(), &["design", "out", id, "--out", "design"]);
        assert_eq!(code, 0, "{said}");
        let text = std::fs::read(here.path().join("design/arm.json")).expect("an arm");
        let arm: Value = serde_json::from_slice(&text).expect("JSON");
        let joint = &arm["chain"][0];
        let extras = joint["extras"].as_object().expect("extras");
        let mut keys: Vec<&str> = extras.keys().map(String::as_str).collect();
        keys.sort_unstable();
        assert_eq!(keys, ["brake_kg", "cable_kg", "encoder_kg", "flange_kg", "housing_kg"]);
        let extras_kg: f64 = extras.values().map(|kg| kg.as_f64().unwrap()).sum();
        assert!(extras_kg > 0.2, "{joint}");
        assert!((number(&row, "extras_mass_kg") - extras_kg).abs() < 1e-9, "{row:?} {joint}");
        let mass_kg = joint["mass_kg"].as_f64().unwrap() + extras_kg;
        assert!((number(&row, "mass_kg") - mass_kg).abs() < 1e-9, "{row:?} {joint}");
        let picks = record["picks"].as_array().unwrap().iter();
        for pick in picks.filter(|pick| pick["design_id"] == id) {
            assert_eq!(pick["extras_mass_kg"].as_f64().unwrap(), number(&row, "extras_mass_kg"));
        }
    }
    let mut none = of_gears(&["CSG-20-100"]);
    none["extras"] = json!("none");
    let (_, here) = run(&study(6.0, none), &[]);
    assert_eq!(number(&rows(here.path(), "front.csv")[0], "extras_mass_kg"), 0.0);
}

#[test]
fn the_budget_has_a_row_for_each_bearing_with_the_share_of_the_analysis() {
    let (_, here) = run(&study(6.0, of_gears(&["CSG-20-100"])), &[]);
    let budget = rows(here.path(), "budget.csv");
    let share = |piece: &str| {
        let row =
            budget.iter().find(|row| row["piece"] == piece).unwrap_or_else(|| panic!("{piece}: {budget:?}"));
        (row["kind"].clone(), number(row, "share_of_deflection"), row["in_place_mm_per_kg"].clone())
    };
    // a vertical joint under weight alone does not twist: its bearing does all
    let (kind, tilt, blank) = share("j1.bearing");
    assert_eq!((kind.as_str(), blank.as_str()), ("bearing", ""));
    let (kind, torsion, in_place) = share("j1");
    assert_eq!(kind, "joint");
    assert!((tilt - 1.0).abs() < 1e-12 && torsion.abs() < 1e-12, "{tilt} {torsion}");
    // drive and bearing grow in proportion: the deflection falls by 1/mass a kilogram
    let (tip_mm, kg) = (6.0 * 9.81 * 0.5 / 127_197.0 * 0.5 * 1e3, number(&budget[0], "mass_kg"));
    let in_place: f64 = in_place.parse().expect("a number");
    assert!((in_place / (-tip_mm / kg) - 1.0).abs() < 1e-5, "{in_place} {tip_mm} {kg}");
}
