//! Every result must state what its numbers leave out, in the terminal, the summary, the page and `run.json`.

use crate::links::{armwright, folder_with};
use serde_json::{Value, json};

const RIGID: &str = "Rigid output bearing without mass in shoulder";
const BARE: &str = "Nothing is weighed beyond gear, motor and bearing in shoulder";
const HEAT: &str = "Motor heat not checked";
const ALWAYS: &str = "Left out of every number: the compliance of the connections";
const STATED: &str = "Left out of every number: what the stated stiffness of a joint does not contain, such as its connections";

/// An arm of one joint and one open tube.
fn study(joint: Value, motion: Value) -> Value {
    let mut joint = joint;
    joint["type"] = json!("joint");
    joint["name"] = json!("shoulder");
    joint["axis"] = json!([0, 1, 0]);
    let choose = json!({"materials": ["Aluminium 6061-T6"],
        "sections": [{"shape": "rectangular_tube", "width_mm": [60, 80], "wall_mm": [2, 3]}]});
    json!({"name": "one joint", "question": "?", "payload": {"mass_kg": 2}, "motion": motion,
        "chain": [joint, {"type": "link", "name": "arm", "vector_m": [0.5, 0, 0], "choose": choose}],
        "poses": [{"name": "level", "pose_deg": [0]}]})
}

/// Which of the sentences terminal, summary, page and `run.json` say; all four must agree.
fn said(joint: Value, motion: Value) -> Vec<&'static str> {
    let here = folder_with("study.json", &study(joint, motion));
    let (code, terminal) = armwright(here.path(), &["run", "study.json", "--out", "out"]);
    assert_eq!(code, 0, "{terminal}");
    let read = |file: &str| std::fs::read_to_string(here.path().join("out").join(file)).expect(file);
    let texts = [terminal, read("summary.md"), read("report.html"), read("run.json")].map(|text| {
        let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
        [RIGID, BARE, HEAT, ALWAYS, STATED]
            .into_iter()
            .filter(|sentence| words.contains(sentence))
            .collect::<Vec<_>>()
    });
    assert!(texts.iter().all(|text| *text == texts[0]), "{texts:?}");
    texts[0].clone()
}

#[test]
fn a_whole_joint_leaves_out_only_what_no_study_can_bring_in() {
    assert_eq!(said(json!({"drive": "first_fit"}), json!({})), [ALWAYS]);
}

#[test]
fn a_joint_without_bearing_extras_and_heat_is_named() {
    let joint = json!({"drive": "first_fit", "bearing": null, "extras": "none"});
    assert_eq!(said(joint, json!({"check_motor_heat": false})), [RIGID, BARE, HEAT, ALWAYS]);
}

#[test]
fn a_gear_in_numbers_has_a_bearing_too() {
    assert_eq!(said(json!({"gear": "CSG-25-100", "mass_kg": 3.0}), json!({})), [ALWAYS]);
    assert_eq!(
        said(json!({"gear": "CSG-25-100", "mass_kg": 3.0, "bearing": null}), json!({})),
        [RIGID, ALWAYS]
    );
}

#[test]
fn a_result_without_gears_says_what_it_leaves_out_and_nothing_of_gears() {
    assert_eq!(said(json!({"stiffness_nm_per_rad": 1e5, "mass_kg": 3.0}), json!({})), [STATED]);
}

/// The sizes in the sentence are those of the row "together" of the table.
#[test]
fn the_size_of_what_is_left_out_is_that_of_the_table() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = std::fs::read_to_string(root.join("docs/left-out.md")).expect("the page");
    let row = page.lines().find(|line| line.starts_with("| **together** |")).expect("the row");
    let numbers: Vec<f64> = row
        .split('|')
        .skip(3)
        .filter_map(|cell| cell.trim().replace('\u{2212}', "-").parse().ok())
        .map(|percent: f64| percent.abs().round())
        .collect();
    let [tip, mode, mass] = [0, 1, 2].map(|i| [numbers[i], numbers[i + 3]]);
    let here = folder_with("study.json", &study(json!({"drive": "first_fit"}), json!({})));
    let (_, said) = armwright(here.path(), &["run", "study.json", "--out", "out"]);
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    let sentence = format!(
        "the starred rows of docs/left-out.md together add {} to {} % to the deflection and {} to {} % to the mass, and take {} to {} % \
         from the lowest mode.",
        tip[0], tip[1], mass[0], mass[1], mode[0], mode[1]
    );
    assert!(said.contains(&sentence), "{sentence}: {said}");
}

/// Connections and cables are among the rows whose sizes are added up, so a study that states one of them has no use for the
/// sum.
/// The JSON of `size` is the list of joints; the sentences stand on standard error, as those of the table do.
#[test]
fn the_list_of_sizes_says_on_standard_error_what_it_leaves_out() {
    let here = folder_with("study.json", &study(json!({"drive": "first_fit", "bearing": null}), json!({})));
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_armwright"))
        .args(["size", "study.json", "--json"])
        .current_dir(here.path())
        .output()
        .expect("the program starts");
    let joints: Value = serde_json::from_slice(&output.stdout).expect("JSON alone on standard output");
    assert_eq!(joints[0]["joint"], "shoulder");
    let notes = String::from_utf8_lossy(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(notes.contains(RIGID) && notes.contains(ALWAYS), "{notes}");
}

#[test]
fn a_study_that_states_connections_or_cables_is_not_told_their_size_again() {
    let of = |key: &str, value: Value| {
        let mut study = study(json!({"drive": "first_fit"}), json!({}));
        study[key] = value;
        let here = folder_with("study.json", &study);
        let (code, said) = armwright(here.path(), &["size", "study.json"]);
        assert_eq!(code, 0, "{said}");
        said.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let softer = json!([{"effect": "connection_compliance", "at": "shoulder", "parameters": {"stiffness_nm_per_rad": 1e5}}]);
    for (key, value) in
        [("connection_share", json!(0.2)), ("harness_kg_per_m", json!(0.3)), ("effects", softer)]
    {
        let said = of(key, value);
        assert!(said.contains("How much each of these may be: docs/left-out.md."), "{key}: {said}");
        assert!(!said.contains("starred rows"), "{key}: {said}");
        if key == "effects" {
            assert!(
                said.contains("between links and joints (except at shoulder, where the study states it)"),
                "{said}"
            );
            let stated = "the effects that the study states, connection_compliance at shoulder (stiffness_nm_per_rad 100000)";
            assert!(said.contains(stated), "{said}");
        }
    }
    assert!(of("gravity_m_s2", json!(9.81)).contains("starred rows"), "nothing stated");
}
