//! Effects in studies: from the study file, from an arm file, and from a campaign.

use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// Exit code and what was said: standard output if it succeeds, standard error if not.
fn armwright(here: &Path, words: &[&str]) -> (i32, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_armwright"));
    let output = command.current_dir(here).args(words).output().expect("it runs");
    let said = if output.status.success() { output.stdout } else { output.stderr };
    (output.status.code().expect("a code"), String::from_utf8(said).expect("text"))
}

fn read(path: PathBuf) -> String {
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn read_json(path: PathBuf) -> Value {
    serde_json::from_str(&read(path)).expect("JSON")
}

/// A two-joint arm: the shoulder's drive is chosen, the elbow's is given.
fn study() -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/bench-arm.json");
    let mut study = read_json(path);
    study["chain"][2] = json!({"type": "joint", "name": "elbow", "axis": [0, 1, 0], "mass_kg": 2.0,
        "windup": {"k1_nm_per_rad": 1e4, "k2_nm_per_rad": 1.5e4, "k3_nm_per_rad": 2e4, "t1_nm": 5, "t2_nm": 20}});
    study["constraints"] = json!({});
    study
}

/// The same arm with few sections and drives: laws of joints are searched one design at a time.
fn small_study() -> Value {
    let mut study = study();
    study["chain"][1]["choose"]["sections"] =
        json!([{"shape": "rectangular_tube", "width_mm": [80], "height_mm": "=width", "wall_mm": [2, 5]}]);
    study["chain"][3]["choose"]["sections"] =
        json!([{"shape": "round_tube", "diameter_mm": [60], "wall_mm": [2]}]);
    study["drives"]["ratios"] = json!([100]);
    study
}

fn spring(effect: &str, at: &str) -> Value {
    json!({"effect": effect, "at": at, "parameters": {"stiffness_nm_per_rad": 2e4}})
}

fn measured_arm(effects: Value, calibrated: Value) -> Value {
    let joint =
        |name: &str| json!({"type": "joint", "name": name, "axis": [0, 1, 0], "stiffness_nm_per_rad": 1.4e4});
    let link = |name: &str| json!({"type": "link", "name": name, "vector_m": [0.5, 0, 0], "mass_kg": 1});
    json!({"name": "measured", "effects": effects, "provenance": {"calibrated": calibrated},
        "chain": [joint("shoulder"), link("upper_arm"), joint("elbow"), link("forearm"), joint("wrist")]})
}

fn write(here: &Path, name: &str, value: &Value) {
    std::fs::write(here.join(name), value.to_string()).expect("written");
}

/// The numbers of a column of a front, in order of the rows.
fn column(front: &str, name: &str) -> Vec<f64> {
    let mut rows = csv::Reader::from_reader(front.as_bytes());
    let at = rows.headers().expect("a header").iter().position(|c| c == name).expect("the column");
    rows.records().map(|r| r.expect("a row")[at].parse().expect("a number")).collect()
}

#[test]
fn a_design_of_a_study_with_effects_analyzes_to_the_numbers_of_its_front() {
    let here = folder();
    let mut with = study();
    with["effects"] = json!([spring("bearing_tilt", "elbow"), spring("base_compliance", "base"),
        {"effect": "hysteresis", "at": "shoulder", "parameters": {"half_width_rad": 1e-4}},
        {"effect": "harness_mass", "at": "forearm", "parameters": {"kg_per_m": 2.0}}]);
    write(here.path(), "study.json", &with);
    assert_eq!(armwright(here.path(), &["run", "study.json", "--out", "out"]).0, 0);
    let front = read(here.path().join("out/front.csv"));
    let id = front.lines().nth(2).expect("a design").split(',').next().expect("an id").to_string();
    assert_eq!(armwright(here.path(), &["design", "out", &id, "--out", "arm"]).0, 0);
    let words = ["analyze", "arm/arm.json", "--cases", "arm/cases.json", "--json"];
    let cases: Value = serde_json::from_str(&armwright(here.path(), &words).1).expect("JSON");
    let tip_mm = |case: &Value| {
        let tip = [0, 1, 2].map(|i| case["tip_displacement_m"][i].as_f64().expect("a number"));
        nalgebra::Vector3::from(tip).norm() * 1e3
    };
    let cases = cases.as_array().expect("cases");
    assert!(cases[0]["shares"].to_string().contains("elbow.bearing"), "the arm file has the effects");
    let worst_mm = cases.iter().map(tip_mm).fold(0.0, f64::max);
    assert_eq!(worst_mm, column(&front, "tip_deflection_mm")[1]);
    let lowest = |case: &Value| case["modes"][0]["frequency_hz"].as_f64().expect("a mode");
    assert_eq!(cases.iter().map(lowest).fold(f64::INFINITY, f64::min), column(&front, "lowest_mode_hz")[1]);
    let run = read_json(here.path().join("out/run.json"));
    assert_eq!(run["effects_mass_kg"].as_f64().expect("kg"), 2.0 * 0.4);
}

/// Laws that follow the angle of a joint or lift the base: a counterbalance, waves of a stiffness, feet, and a law without a name.
fn laws() -> Value {
    json!([
        {"effect": "joint_torque", "at": "shoulder", "parameters": {"offset_nm": 3.0, "sin_nm": 2.0, "cos_nm": -20.0}},
        {"effect": "stiffness_waves", "at": "elbow", "parameters": {"once": 0.2, "twice": 0.1, "phases_rad": [0.5, -1.0]}},
        {"effect": "base_lift", "at": "base", "parameters": {"stiffness_nm_per_rad": 5e4, "preload_nm": 8.0}},
        {"effect": "empirical", "at": "elbow", "parameters": {"odd_twist_rad": [2e-5, 0], "torque_nm": 10,
            "tilt_rad_per_nm": [2e-6, 7e-6]}}
    ])
}

#[test]
fn designs_of_a_study_with_laws_of_joints_and_base_analyzes_to_the_numbers_of_its_front() {
    let here = folder();
    let mut with = small_study();
    with["effects"] = laws();
    write(here.path(), "study.json", &with);
    assert_eq!(armwright(here.path(), &["run", "study.json", "--out", "out"]).0, 0);
    let front = read(here.path().join("out/front.csv"));
    let tips_mm = column(&front, "tip_deflection_mm");
    assert!(tips_mm.len() > 3, "{front}");
    let lines: Vec<&str> = front.lines().skip(1).collect();
    for row in [0, tips_mm.len() / 2, tips_mm.len() - 1] {
        let id = lines[row].split(',').next().expect("an id");
        assert_eq!(armwright(here.path(), &["design", "out", id, "--out", id]).0, 0);
        let words = ["analyze", &format!("{id}/arm.json"), "--cases", &format!("{id}/cases.json"), "--json"];
        let cases: Value = serde_json::from_str(&armwright(here.path(), &words).1).expect("JSON");
        let tip_mm = |case: &Value| {
            let tip = [0, 1, 2].map(|i| case["tip_displacement_m"][i].as_f64().expect("a number"));
            nalgebra::Vector3::from(tip).norm() * 1e3
        };
        let cases = cases.as_array().expect("cases");
        assert!(cases[0]["shares"].to_string().contains("base_lift"), "the arm file has the laws");
        assert_eq!(cases.iter().map(tip_mm).fold(0.0, f64::max), tips_mm[row], "{id}");
        let lowest = |case: &Value| case["modes"][0]["frequency_hz"].as_f64().expect("a mode");
        let lowest_hz = cases.iter().map(lowest).fold(f64::INFINITY, f64::min);
        assert_eq!(lowest_hz, column(&front, "lowest_mode_hz")[row], "{id}");
    }
}

#[test]
fn bounds_that_lack_a_law_are_refused_and_say_what_to_do() {
    let here = folder();
    let mut with = small_study();
    for law in laws().as_array().expect("a list") {
        with["effects"] = json!([law]);
        write(here.path(), "study.json", &with);
        let effect = law["effect"].as_str().expect("a name");
        let (code, said) = armwright(here.path(), &["run", "study.json", "--search", "exact", "--out", "no"]);
        assert!(code == 2 && said.contains(effect) && said.contains("every design is visited"), "{said}");
    }
    assert_eq!(armwright(here.path(), &["run", "study.json", "--out", "out"]).0, 0);
    let (code, said) = armwright(here.path(), &["front", "check", "out"]);
    assert!(code == 2 && said.contains("empirical at elbow"), "{code}: {said}");
    // no limit is looked for by bounds that lack the law
    with["constraints"] = json!({"mass_max_kg": 0.1});
    write(here.path(), "study.json", &with);
    let (code, said) = armwright(here.path(), &["run", "study.json", "--out", "none"]);
    assert!(code == 6 && said.contains("not looked for in a study with empirical"), "{code}: {said}");
}

#[test]
fn an_effect_that_does_not_fit_a_study_is_a_fault_of_its_file() {
    let here = folder();
    let curve =
        json!({"k1_nm_per_rad": 1e4, "k2_nm_per_rad": 2e4, "k3_nm_per_rad": 3e4, "t1_nm": 5, "t2_nm": 20});
    for (effect, field, words) in [
        (spring("bearing_tilt", "wrist"), "effects[0].at", "shoulder, elbow"),
        (spring("bearing_slop", "elbow"), "effects[0].effect", "known effects"),
        (
            json!({"effect": "soft_windup", "at": "shoulder", "parameters": curve}),
            "effects[0].effect",
            "catalogs",
        ),
        (
            json!({"effect": "extra_mass", "at": "elbow", "parameters": {"delta_kg": -3}}),
            "effects[0].parameters.delta_kg",
            "2 kg",
        ),
    ] {
        let mut with = study();
        with["effects"] = json!([effect]);
        write(here.path(), "study.json", &with);
        let (code, said) = armwright(here.path(), &["run", "study.json", "--out", "out"]);
        assert_eq!(code, 3, "{said}");
        assert!(said.contains(field) && said.contains(words), "{field}, {words}: {said}");
    }
}

#[test]
fn masses_taken_off_one_joint_count_together() {
    let here = folder();
    let extra =
        |delta_kg: f64| json!({"effect": "extra_mass", "at": "elbow", "parameters": {"delta_kg": delta_kg}});
    let run = |effects: Value| {
        let mut with = study();
        with["effects"] = effects;
        write(here.path(), "study.json", &with);
        armwright(here.path(), &["run", "study.json", "--out", "out"])
    };
    let (code, said) = run(json!([extra(-1.5), extra(-1.0), extra(0.2)]));
    assert_eq!(code, 3, "{said}");
    let faulty = ["effects[0]", "effects[1]", "effects[2]"].map(|effect| said.contains(effect));
    assert_eq!(faulty, [true, true, false], "only losses are to blame: {said}");
    assert_eq!(run(json!([extra(-1.5), extra(-1.0), extra(1.0)])).0, 0);
}

#[test]
fn what_of_an_arm_file_carries_over_to_a_study_is_said_one_by_one() {
    let here = folder();
    let mut with_bearing = study();
    with_bearing["chain"][2]["bearing"] = json!({"tilt_stiffness_nm_per_rad": 2e5});
    write(here.path(), "study.json", &with_bearing);
    let effects = json!([spring("connection_compliance", "elbow"), spring("bearing_tilt", "wrist"),
        {"effect": "payload_mass_error", "at": "payload", "parameters": {"delta_kg": 0.2}}]);
    let factor = |value: &str| json!({"value": value, "factor": 1.1, "low": 1.0, "high": 1.2});
    let calibrated = json!([
        factor("shoulder.stiffness"),
        factor("elbow.stiffness"),
        factor("elbow.mass"),
        factor("shoulder.bearing_stiffness"),
        factor("elbow.bearing_stiffness"),
        factor("steel.modulus")
    ]);
    write(here.path(), "arm.json", &measured_arm(effects, calibrated));
    let (code, said) = armwright(here.path(), &["run", "study.json", "--effects", "arm.json"]);
    assert_eq!(code, 0, "{said}");
    let out = here.path().join("results/bench-arm-with-effects");
    let run = read_json(out.join("run.json"));
    let carried: Vec<(&str, bool)> = run["carried_over"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|c| (c["what"].as_str().expect("text"), c["carried"].as_bool().expect("yes or no")))
        .collect();
    assert_eq!(
        carried,
        [
            ("connection_compliance at elbow", true),
            ("bearing_tilt at wrist", false),
            ("payload_mass_error at payload", false),
            ("shoulder.stiffness x 1.1000", false),
            ("elbow.stiffness x 1.1000", true),
            ("elbow.mass x 1.1000", true),
            ("shoulder.bearing_stiffness x 1.1000", false),
            ("elbow.bearing_stiffness x 1.1000", true),
            ("steel.modulus x 1.1000", false),
        ]
    );
    // lines are broken at 80 columns
    let in_one_line = said.split_whitespace().collect::<Vec<_>>().join(" ");
    for (what, _) in carried {
        assert!(in_one_line.contains(what), "{what} is not said: {said}");
    }
    // the study in the results is complete by itself
    let kept = read_json(out.join("study.json"));
    assert_eq!(kept["chain"][2]["windup"]["k2_nm_per_rad"], json!(1.5e4 * 1.1));
    assert_eq!(kept["chain"][2]["mass_kg"], json!(2.0 * 1.1));
    assert_eq!(kept["chain"][2]["bearing"]["tilt_stiffness_nm_per_rad"], json!(2e5 * 1.1));
    assert_eq!(kept["effects"], json!([spring("connection_compliance", "elbow")]));
    let again = ["run", "results/bench-arm-with-effects/study.json", "--out", "again"];
    assert_eq!(armwright(here.path(), &again).0, 0);
    assert_eq!(read(out.join("front.csv")), read(here.path().join("again/front.csv")));
}

#[test]
fn an_arm_file_that_changes_nothing_in_a_study_is_refused() {
    let here = folder();
    write(here.path(), "study.json", &study());
    for effects in [json!([]), json!([spring("bearing_tilt", "wrist")])] {
        write(here.path(), "arm.json", &measured_arm(effects, json!([])));
        let (code, said) =
            armwright(here.path(), &["run", "study.json", "--effects", "arm.json", "--out", "out"]);
        assert!(code == 2 && said.contains("changes nothing"), "{code}: {said}");
        assert!(!here.path().join("out").exists());
    }
}

#[test]
fn what_a_gantry_measured_of_a_screw_stays_with_it_and_what_it_measured_of_a_guide_does_not() {
    let here = folder();
    let gantry = read_json(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/arms/gantry.json"));
    write(here.path(), "study.json", &gantry);
    let slide = |name: &str, axis: Value| {
        json!({"type": "prismatic", "name": name, "axis": axis, "stiffness_n_per_m": 5e7, "mass_kg": 20,
               "guide": {"roll_nm_per_rad": 4e5, "pitch_nm_per_rad": 6e5, "yaw_nm_per_rad": 6e5}})
    };
    let calibrated = |name: &str| {
        let value = |what: &str| json!({"value": format!("{name}.{what}"), "factor": 0.9});
        ["stiffness", "mass", "guide_stiffness"].map(value)
    };
    let both = [calibrated("rail"), calibrated("column")].concat();
    let arm = json!({"name": "measured", "effects": [],
        "provenance": {"calibrated": both},
        "chain": [slide("rail", json!([1, 0, 0])), slide("column", json!([0, 0, 1])),
                  {"type": "link", "name": "boom", "vector_m": [0, 0.5, 0], "mass_kg": 2}]});
    write(here.path(), "arm.json", &arm);
    let words = ["run", "study.json", "--effects", "arm.json", "--out", "out"];
    let (exit, said) = armwright(here.path(), &words);
    assert_eq!(exit, 0, "{said}");
    let run = read_json(here.path().join("out/run.json"));
    let carried = run["carried_over"].as_array().expect("corrections");
    let applied = |what: &str| {
        let of = |c: &&Value| c["what"].as_str().is_some_and(|w| w.starts_with(what));
        carried.iter().find(of).expect("the correction")["carried"].as_bool()
    };
    for slide in ["rail", "column"] {
        assert_eq!(applied(&format!("{slide}.stiffness ")), Some(false));
        assert_eq!(applied(&format!("{slide}.mass ")), Some(false));
        assert_eq!(applied(&format!("{slide}.guide_stiffness ")), Some(true));
    }
}
