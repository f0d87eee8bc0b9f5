//! Studies that no design meets: the program names what is in the way, by how much it fails, and which value is enough,
//! with every search method. The tests try this value, which must be enough, and a slightly smaller one, which must
//! not.

use crate::running::armwright;
use serde_json::{Value, json};

/// Two links of two tubes each on two joints that are sized: few designs, all kinds of limits.
fn study() -> Value {
    let link = |name: &str| {
        json!({"type": "link", "name": name, "vector_m": [0.4, 0, 0], "choose": {
            "materials": ["Structural steel S355"],
            "sections": [{"shape": "round_tube", "diameter_mm": [60, 90], "wall_mm": [2, 4]}]}})
    };
    let joint = |name: &str| json!({"type": "joint", "name": name, "axis": [0, 1, 0], "drive": "first_fit"});
    json!({"name": "small", "chain": [joint("j1"), link("upper"), joint("j2"), link("fore")],
        "payload": {"mass_kg": 5},
        "drives": {"gear_series": ["CSG"], "motors": ["electric"]},
        "motion": {"tip_speed_m_s": 0.5, "ramp_time_s": 0.5, "life_h": 7000},
        "poses": [{"name": "out", "pose_deg": [0, 0]}, {"name": "bent", "pose_deg": [-30, 60]}]})
}

/// What a run of the study says with each of the two searches: the same.
fn refused(study: &Value) -> String {
    let here = tempfile::tempdir().expect("a folder");
    std::fs::write(here.path().join("study.json"), study.to_string()).expect("written");
    let said = ["exact", "exhaustive"].map(|search| {
        let (code, said) =
            armwright(here.path(), &["run", "study.json", "--search", search, "--out", "x", "-q"]);
        assert_eq!(code, 6, "{search}: {said}");
        assert!(!here.path().join("x").exists(), "an infeasible run writes nothing");
        said
    });
    assert_eq!(said[0], said[1], "both searches say the same");
    assert!(!said[0].contains("e0 designs"), "{}", said[0]);
    said[0].clone()
}

fn code_of(study: &Value) -> i32 {
    let here = tempfile::tempdir().expect("a folder");
    std::fs::write(here.path().join("study.json"), study.to_string()).expect("written");
    armwright(here.path(), &["run", "study.json", "--out", "x"]).0
}

/// The value to which a message relaxes a key.
fn enough(said: &str, key: &str) -> f64 {
    let after = said.split(&format!("\"{key}\" to ")).nth(1).unwrap_or_else(|| panic!("{key}: {said}"));
    let word = after.split_whitespace().next().map(|word| word.trim_end_matches(','));
    word.and_then(|word| word.parse().ok()).expect("a number")
}

#[test]
fn each_limit_is_named_with_the_value_that_lets_the_first_design_in_and_no_less_does() {
    // a part in ten thousand: values are rounded to five digits, and the bisection ends sooner
    for (key, asked, a_little_less) in [
        ("tip_deflection_max_mm", 1e-4, 0.9999),
        ("mass_max_kg", 0.5, 0.9999),
        ("lowest_mode_min_hz", 5000.0, 1.0001),
        ("stress_safety_factor_min", 1e5, 1.0001),
        ("wall_slenderness_max", 2.0, 0.9999),
    ] {
        let with = |value: f64| {
            let mut study = study();
            study["constraints"] = json!({key: value});
            study
        };
        let said = refused(&with(asked));
        assert!(said.contains("short by") && said.contains("of 16"), "{said}");
        let value = enough(&said, key);
        assert_eq!(code_of(&with(value)), 0, "{key} {value}: {said}");
        assert_eq!(code_of(&with(value * a_little_less)), 6, "{key} {value}: {said}");
    }
}

#[test]
fn sizing_names_the_part_that_breaks_a_limit_and_the_value_that_lets_it_in() {
    let size = |constraints: &Value| {
        let mut study = study();
        study["constraints"] = constraints.clone();
        let here = tempfile::tempdir().expect("a folder");
        std::fs::write(here.path().join("study.json"), study.to_string()).expect("written");
        armwright(here.path(), &["size", "study.json"])
    };
    for (key, asked, a_little_less) in [
        ("stress_safety_factor_min", 1e5, 1.0001),
        ("wall_slenderness_max", 2.0, 0.9999),
        ("material_cost_max_eur", 0.01, 0.9999),
        ("mass_max_kg", 0.1, 0.9999),
    ] {
        let (mut value, mut named) = (asked, Vec::new());
        // from the tip inward, each part may need more than the one before
        while let (6, said) = size(&json!({key: value})) {
            let parts = ["link fore", "joint j2", "link upper", "joint j1"].into_iter();
            named.extend(parts.filter(|part| said.contains(&format!("{part} breaks a limit: "))));
            value = enough(&said, key);
            // of the inner link, another size can be taken that meets a limit a little below
            let is_outer = named.len() == 1;
            let is_refused = !is_outer || size(&json!({key: value * a_little_less})).0 == 6;
            assert!(is_refused, "{key} {value}: {said}");
            assert!(named.len() <= 4, "{key}: {said}");
        }
        assert_eq!(named[0], "link fore", "{key}");
        assert!(named.len() > 1 || key != "mass_max_kg", "{named:?}");
        assert_eq!(size(&json!({key: value})).0, 0, "{key} {value}");
    }
    let (code, said) = size(&json!({"stress_safety_factor_min": 1e5, "wall_slenderness_max": 2.0}));
    assert!(
        code == 6 && said.contains("stress_safety_factor_min") && said.contains("wall_slenderness_max"),
        "{said}"
    );
}

#[test]
fn limits_that_stand_in_the_way_together_are_relaxed_together() {
    let with = |tip_mm: f64, mass_kg: f64| {
        let mut study = study();
        study["constraints"] = json!({"tip_deflection_max_mm": tip_mm, "mass_max_kg": mass_kg});
        study
    };
    let said = refused(&with(1e-4, 0.5));
    assert!(said.contains("together"), "{said}");
    let [tip_mm, mass_kg] = ["tip_deflection_max_mm", "mass_max_kg"].map(|key| enough(&said, key));
    assert_eq!(code_of(&with(tip_mm, mass_kg)), 0, "{said}");
    assert_eq!(code_of(&with(tip_mm, 0.9999 * mass_kg)), 6, "{said}");
    assert_eq!(code_of(&with(0.9999 * tip_mm, mass_kg)), 6, "{said}");
}

#[test]
fn joints_that_no_drive_turns_fast_enough_are_all_named() {
    let mut study = study();
    for joint in [0, 2] {
        study["chain"][joint]["max_speed_rad_s"] = json!(90.0);
    }
    // whichever way the drive is chosen
    study["chain"][0]["drive"] = json!("all_fits");
    let said = refused(&study);
    for joint in ["j1", "j2"] {
        assert!(said.contains(&format!("joint {joint}: 90.00 rad/s needed")), "{said}");
    }
    assert!(said.contains("allowed by the fastest drive"), "{said}");
    let needed = said.split("slow the joint to ").nth(1).and_then(|s| s.split(' ').next());
    let slow: f64 = needed.and_then(|word| word.parse().ok()).expect("a speed");
    let here = tempfile::tempdir().expect("a folder");
    std::fs::write(here.path().join("study.json"), study.to_string()).expect("written");
    let (code, of_size) = armwright(here.path(), &["size", "study.json"]);
    assert!(code == 6 && of_size.contains("joint j2: 90.00 rad/s needed"), "{of_size}");
    for joint in [0, 2] {
        study["chain"][joint]["max_speed_rad_s"] = json!(slow * 1.001);
    }
    assert!(refused(&study).contains("allowed by the fastest drive"));
}

#[test]
fn a_joint_that_no_drive_is_strong_enough_for_is_named_with_its_shortfall() {
    let mut study = study();
    study["payload"]["mass_kg"] = json!(2000);
    let said = refused(&study);
    assert!(said.contains("joint j2: no drive holds") && said.contains("joint j1: no drive holds"), "{said}");
    assert!(said.contains("short by") && said.contains("down to"), "{said}");
}

#[test]
fn a_study_without_a_choice_is_empty_in_every_verb() {
    let mut study = study();
    study["drives"] = json!({"gear_series": ["CSG"], "ratios": [30]});
    let here = tempfile::tempdir().expect("a folder");
    std::fs::write(here.path().join("study.json"), study.to_string()).expect("written");
    for words in [
        &["run", "study.json", "--search", "exact"][..],
        &["run", "study.json", "--search", "exhaustive"],
        &["run", "study.json", "--time-limit", "5"],
        &["size", "study.json"],
        &["size", "study.json", "--explain", "j1"],
        &["size", "study.json", "--all-fits", "j1"],
        &["size", "study.json", "--design", "0"],
    ] {
        let (code, said) = armwright(here.path(), words);
        assert!(code == 5 && said.contains("joint j1") && said.contains("widen"), "{words:?}: {code} {said}");
    }
}

#[test]
fn a_passage_that_no_gear_has_is_refused_with_what_is_missing_and_actuators_let_cables_through() {
    let mut study = study();
    study["drives"]["gear_series"] = json!(["CSG", "SHG"]);
    study["fit"] = json!({"cable_bore_min_mm": 25});
    let said = refused(&study);
    for piece in [
        "bore 25.0 mm needed, 0.0 allowed",
        "SHG-25-50, SHG-25-80, SHG-25-100 and 29 more: ",
        "no average_input_speed_limit_rpm (mean input speed)",
        "--catalogs DIR",
        "\"actuators\": [\"CHA-25A-30\"",
    ] {
        assert!(said.contains(piece), "{piece} in {said}");
    }
    assert!(!said.contains("CHA-20A"), "its passage is 18 mm wide: {said}");
    study["drives"] = json!({"actuators": "all"});
    let here = tempfile::tempdir().expect("a folder");
    std::fs::write(here.path().join("study.json"), study.to_string()).expect("written");
    let (code, said) = armwright(here.path(), &["run", "study.json", "--out", "x"]);
    assert_eq!(code, 0, "{said}");
    // their rated torque holds at standstill, and their tilting stiffness is that of a gear unit
    let unseen =
        "The rated torque or the tilting stiffness of CHA-20A-30, CHA-20A-50, CHA-20A-80 and 30 more is not";
    assert!(said.split_whitespace().collect::<Vec<_>>().join(" ").contains(unseen), "{said}");
    let front = std::fs::read_to_string(here.path().join("x/front.csv")).expect("a front");
    let column =
        front.lines().next().expect("a header").split(',').position(|c| c == "j1_gear").expect("a gear");
    let gears: Vec<&str> = front.lines().skip(1).filter_map(|row| row.split(',').nth(column)).collect();
    assert!(!gears.is_empty() && gears.iter().all(|gear| gear.starts_with("CHA-")), "{front}");
}
