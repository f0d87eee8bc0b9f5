//! Duty cycles and motor heat: keys of a study, numbers of `armwright size`, columns of the front, and warnings.

use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Output};

fn armwright(folder: &Path, words: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_armwright"));
    command.current_dir(folder).args(words).output().expect("it runs")
}

/// Exit code, standard output and standard error of a command on a study.
fn on(study: &Value, words: &[&str]) -> (i32, String, String) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("study.json"), study.to_string()).expect("a file");
    let output = armwright(folder.path(), words);
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
    (output.status.code().expect("a code"), text(output.stdout), text(output.stderr))
}

fn sized(study: &Value) -> Vec<Value> {
    let (code, out, err) = on(study, &["size", "study.json", "--json"]);
    assert_eq!(code, 0, "{err}");
    serde_json::from_str(&out).expect("JSON")
}

/// One joint with 10 kg at 1 m, and a given pair of gear and motor.
fn one_joint(axis: [f64; 3], more: Value) -> Value {
    let mut joint = json!({"type": "joint", "name": "j", "axis": axis, "drive": "first_fit",
        "drives": {"gears": ["HFUC-40-120"], "motor_models": ["MF0150025 150V"]}});
    joint.as_object_mut().expect("a joint").extend(more.as_object().expect("keys").clone());
    json!({"name": "one joint", "chain": [joint, {"type": "link", "name": "l", "vector_m": [1, 0, 0]}],
        "payload": {"mass_kg": 10}, "poses": [{"pose_deg": [0]}], "motion": {"life_h": 7000}})
}

fn vendors_duty() -> Value {
    json!([{"torque_nm": 400, "time_s": 0.3, "speed_rpm": 7}, {"torque_nm": 320, "time_s": 3, "speed_rpm": 14},
        {"torque_nm": 200, "time_s": 0.4, "speed_rpm": 7}, {"torque_nm": 0, "time_s": 0.2, "speed_rpm": 0}])
}

/// Harmonic Drive, engineering data: the worked example of a selection, with the gear sold as CSF-40-120. Mean torque 319 N m,
/// mean input speed 1443 rpm, L10 of 7542 h with the rated torque of 294 N m, and 1190 collisions of 0.15 s at 1680 rpm.
#[test]
fn the_vendors_worked_example_of_a_selection_comes_out() {
    let rows = sized(&one_joint([0.0, 0.0, 1.0], json!({"duty": vendors_duty()})));
    let is = |key: &str, by_vendor: f64, apart: f64| {
        let ours = rows[0][key].as_f64().expect("a number");
        assert!((ours - by_vendor).abs() < apart, "{key}: {ours}, by the vendor {by_vendor}");
    };
    is("mean_torque_nm", 319.7, 0.05);
    is("mean_input_speed_rpm", 1443.0, 0.5);
    is("motor_speed_rpm", 1680.0, 1e-9);
    is("life_h", 7542.0, 0.5);
    is("emergency_stops_allowed", 1190.0, 0.5);
}

/// 1.5 m/s at 1 m are 14.3 rpm. A duty replaces this speed, and whoever reads 1.5 m/s in the heading must hear of it.
#[test]
fn a_duty_that_is_slower_than_the_tip_speed_asks_is_said_beside_the_result() {
    let told = |duty_rpm: f64, more: Value| {
        let phase = |torque_nm: f64, time_s: f64, speed_rpm: f64| json!({"torque_nm": torque_nm, "time_s": time_s, "speed_rpm": speed_rpm});
        let mut joint = json!({"duty": [phase(150.0, 0.25, duty_rpm / 2.0), phase(100.0, 1.5, duty_rpm),
            phase(80.0, 0.25, duty_rpm / 2.0), phase(100.0, 1.0, 0.0)]});
        joint.as_object_mut().expect("a joint").extend(more.as_object().expect("keys").clone());
        let mut study = one_joint([0.0, 1.0, 0.0], joint);
        study["motion"]["tip_speed_m_s"] = json!(1.5);
        let short = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        let words = "Joint j is sized for the 2.0 rpm of its duty, not for the 14.3 rpm of tip_speed_m_s.";
        [vec!["size", "study.json"], vec!["run", "study.json", "--out", "out"]].map(|command| {
            let (code, out, err) = on(&study, &command);
            assert_eq!(code, 0, "{err}");
            assert_eq!(short(&out).contains(words), short(&out).contains("rpm of its duty"), "{out}");
            short(&out).contains(words)
        })
    };
    assert_eq!(told(2.0, json!({})), [true, true]);
    assert_eq!(told(14.5, json!({})), [false, false], "faster than the tip speed asks");
    assert_eq!(told(2.0, json!({"max_speed_rad_s": 1.2})), [false, false], "sized for the stated speed");
}

#[test]
fn a_duty_may_stand_beside_the_chain_of_a_single_joint_only() {
    let mut study = one_joint([0.0, 0.0, 1.0], json!({}));
    study["duty"] = vendors_duty();
    assert_eq!(sized(&study), sized(&one_joint([0.0, 0.0, 1.0], json!({"duty": vendors_duty()}))));
    let mut second = study["chain"][0].clone();
    second["name"] = json!("k");
    study["chain"].as_array_mut().expect("a chain").push(second);
    study["poses"] = json!([{"pose_deg": [0, 0]}]);
    let (code, _, err) = on(&study, &["size", "study.json"]);
    assert_eq!(code, 3);
    assert!(err.contains("duty: stands beside 2 joints"), "{err}");
}

#[test]
fn a_cycle_without_rests_heats_the_motor_more_and_a_brake_less() {
    let rms = |cycle: Value, brake: bool| {
        let mut study = one_joint([0.0, 1.0, 0.0], json!({"brake": brake}));
        study["motion"]["cycle"] = cycle;
        sized(&study)[0]["motor_rms_torque_nm"].as_f64().expect("a number")
    };
    let phase = |phase: &str, time_s: f64| json!({"phase": phase, "time_s": time_s});
    let moves = [phase("accelerate", 0.2), phase("constant", 0.6), phase("decelerate", 0.2)];
    let rests = json!([moves[0], moves[1], moves[2], phase("rest", 1.0)]);
    let usual = sized(&one_joint([0.0, 1.0, 0.0], json!({})))[0]["motor_rms_torque_nm"].as_f64().unwrap();
    assert_eq!(rms(rests.clone(), false), usual, "the default cycle, stated");
    assert!(rms(json!(moves), false) > usual && usual > rms(rests, true));
}

#[test]
fn a_cycle_that_brakes_longer_than_it_accelerates_is_a_fault() {
    let mut study = one_joint([0.0, 1.0, 0.0], json!({}));
    study["motion"]["cycle"] = json!([{"phase": "accelerate", "time_s": 0.2}, {"phase": "decelerate", "time_s": 0.3}, {"phase": "halt", "time_s": 1}]);
    let (code, _, err) = on(&study, &["size", "study.json"]);
    assert_eq!(code, 3);
    assert!(err.contains("\"halt\" is not known"), "{err}");
    study["motion"]["cycle"].as_array_mut().unwrap().pop();
    let (_, _, err) = on(&study, &["size", "study.json"]);
    assert!(err.contains("motion.cycle: speeds up for 0.2 s and slows down for 0.3 s"), "{err}");
}

#[test]
fn a_gear_that_does_not_bear_the_stops_that_are_asked_for_is_rejected() {
    let mut study = one_joint([0.0, 0.0, 1.0], json!({"duty": vendors_duty()}));
    study["motion"]["emergency_stops"] = json!(1190);
    assert_eq!(sized(&study).len(), 1);
    study["motion"]["emergency_stops"] = json!(1191);
    let (code, _, err) = on(&study, &["size", "study.json"]);
    assert_eq!(code, 6);
    assert!(err.contains("number of stops 1191 stops needed, 1190 allowed"), "{err}");
}

/// A vertical axis under a wide swing: its motor has peak to spare and overheats.
fn swing(check: bool) -> Value {
    let link = json!({"type": "link", "name": "l", "vector_m": [0.7, 0, 0], "choose": {
        "materials": ["Aluminium 6061-T6"],
        "sections": [{"shape": "rectangular_tube", "width_mm": 100, "height_mm": 100, "wall_mm": [4, 6]}]}});
    let mut study = json!({"name": "swing", "chain": [
        {"type": "joint", "name": "j1", "axis": [0, 0, 1], "drive": "first_fit",
         "bearing": null, "drives": {"gears": ["CSG-20-100"], "motors": ["electric"]}}, link],
        "payload": {"mass_kg": 12}, "poses": [{"pose_deg": [0]}],
        "motion": {"tip_speed_m_s": 2, "ramp_time_s": 0.2, "life_h": 5000}});
    if !check {
        study["motion"]["check_motor_heat"] = json!(false);
    }
    study
}

#[test]
fn a_vertical_axis_gets_a_motor_that_stays_cool_unless_the_study_says_otherwise() {
    let (cool, hot) = (sized(&swing(true)), sized(&swing(false)));
    assert_ne!(cool[0]["motor"], hot[0]["motor"]);
    assert!(cool[0]["motor_rms_margin"].as_f64().unwrap() >= 1.0);
    assert!(hot[0]["motor_rms_margin"].is_null());
    let (_, table, _) = on(&swing(false), &["size", "study.json"]);
    assert!(table.contains("Motor heat not checked: the study turns it off"), "{table}");
    let (_, reasons, _) = on(&swing(true), &["size", "study.json", "--explain", "j1"]);
    let rejected = format!("{} behind CSG-20-100 rms ", hot[0]["motor"].as_str().unwrap());
    assert!(reasons.contains(&rejected), "{reasons}");
}

#[test]
fn a_run_has_margins_and_critical_speeds_and_says_what_was_not_checked() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let run = |study: &Value| {
        std::fs::write(folder.path().join("study.json"), study.to_string()).expect("a file");
        let output = armwright(folder.path(), &["run", "study.json", "--out", "out"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let file =
            |name: &str| std::fs::read_to_string(folder.path().join("out").join(name)).expect("a file");
        let said = String::from_utf8(output.stdout).expect("text");
        (said, file("front.csv"), file("summary.md"), file("run.json"))
    };
    let (said, front, summary, record) = run(&swing(true));
    let mut rows = csv::Reader::from_reader(front.as_bytes());
    let headers = rows.headers().unwrap().clone();
    let row = rows.records().next().unwrap().unwrap();
    let number = |name: &str| {
        let at = headers.iter().position(|h| h == name).unwrap_or_else(|| panic!("no column {name}"));
        row[at].parse::<f64>().expect("a number")
    };
    assert!(number("j1_motor_rms_margin") >= 1.0);
    assert!((number("j1_critical_rpm") / (30.0 * number("lowest_mode_hz")) - 1.0).abs() < 1e-12);
    assert!((number("j1_input_rpm") - 100.0 * 2.0 / 0.7 * 30.0 / std::f64::consts::PI).abs() < 1e-6);
    for text in [&said, &summary] {
        assert!(!text.contains("Motor heat not checked"));
    }
    assert!(!record.contains("Motor heat not checked"), "{record}");
    let (said, front, summary, record) = run(&swing(false));
    for text in [&said, &summary, &record] {
        assert!(text.contains("Motor heat not checked"), "{text}");
    }
    let blank = csv::Reader::from_reader(front.as_bytes()).records().all(|row| {
        let at = headers.iter().position(|h| h == "j1_motor_rms_margin").unwrap();
        row.unwrap()[at].is_empty()
    });
    assert!(blank, "{front}");
}

/// A joint that cruises at just the speed at which its gear excites the arm.
#[test]
fn a_pick_that_cruises_near_the_critical_speed_is_warned_of() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let warned = |max_speed_rad_s: f64| {
        let mut study = swing(false);
        study["chain"][0]["max_speed_rad_s"] = json!(max_speed_rad_s);
        std::fs::write(folder.path().join("study.json"), study.to_string()).expect("a file");
        let output = armwright(folder.path(), &["run", "study.json", "--out", "out"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let summary = std::fs::read_to_string(folder.path().join("out/summary.md")).expect("a file");
        let page = std::fs::read_to_string(folder.path().join("out/report.html")).expect("a page");
        let front = std::fs::read(folder.path().join("out/front.csv")).expect("a front");
        let mut rows = csv::Reader::from_reader(&front[..]);
        let at = rows.headers().unwrap().iter().position(|h| h == "lowest_mode_hz").unwrap();
        let mode_hz: f64 = rows.records().next().unwrap().unwrap()[at].parse().unwrap();
        let phrase = "at which its gear excites the lowest mode";
        assert_eq!(summary.contains(phrase), page.contains(phrase));
        (summary.contains(phrase), mode_hz)
    };
    let (_, mode_hz) = warned(0.5);
    let critical_rad_s = 30.0 * mode_hz / 100.0 * std::f64::consts::PI / 30.0;
    assert!(warned(critical_rad_s * 0.9).0, "10 % below");
    assert!(!warned(critical_rad_s * 0.8).0, "20 % below");
}
