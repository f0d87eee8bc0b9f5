//! The largest payload that `capacity` finds against `size`, which must hold just below it and fail just above it.

use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Output};

fn armwright(args: &[&str], dir: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_armwright"))
        .args(args)
        .current_dir(dir)
        .output()
        .expect("the program starts")
}

fn joint(name: &str, axis: [f64; 3], gear: &str, motor: &str) -> Value {
    json!({"type": "joint", "name": name, "axis": axis, "drive": "first_fit", "extras": "none",
        "drives": {"gears": [gear], "motor_models": [motor]}})
}

/// Five arms, each with the only drives that its joints may have.
fn studies() -> Vec<Value> {
    let link = |name: &str, length_m: f64, kg: f64| json!({"type": "link", "name": name, "vector_m": [length_m, 0, 0], "mass_kg": kg});
    let y = [0.0, 1.0, 0.0];
    let study = |chain: Value, poses: Value| {
        json!({"name": "loaded", "chain": chain, "poses": poses, "payload": {"mass_kg": 0.5, "cg_m": [0.05, 0, 0.02]},
            "motion": {"tip_speed_m_s": 0.5, "ramp_time_s": 0.3}})
    };
    let big = || joint("j1", y, "CSG-40-100", "ILM85x26");
    let small = || joint("j2", y, "CSG-25-100", "ILM70x18");
    let mut hanging = study(
        json!([big(), link("a", 0.5, 2.0), small(), link("b", 0.3, 1.0)]),
        json!([{"pose_deg": [0, 0]}]),
    );
    hanging["gravity_m_s2"] = json!([9.81, 0, 0]);
    let mut with_body = study(
        json!([big(), link("a", 0.5, 0.0), small(), link("b", 0.3, 1.0)]),
        json!([{"pose_deg": [-20, 30]}]),
    );
    with_body["chain"][1]["bodies"] = json!([{"mass_kg": 3, "cg_m": [0.2, 0, 0], "inertia_kgm2": [[0.01, 0, 0], [0, 0.05, 0], [0, 0, 0.05]]}]);
    let mut linked = study(
        json!([big(), link("a", 0.4, 1.0),
            {"type": "joint", "name": "par", "axis": y, "stiffness_nm_per_rad": 1e7, "coupled": {"j1": -1}},
            small(), link("b", 0.3, 1.0)]),
        json!([{"pose_deg": [-40, 20]}]),
    );
    linked["payload"] = json!({"mass_kg": 1});
    vec![
        study(json!([big(), link("a", 0.6, 2.0)]), json!([{"pose_deg": [0]}])),
        study(
            json!([big(), link("a", 0.5, 2.0), small(), link("b", 0.3, 1.0)]),
            json!([{"name": "out", "pose_deg": [0, 0]}, {"name": "up", "pose_deg": [-60, 40]}]),
        ),
        hanging,
        with_body,
        linked,
    ]
}

#[test]
fn the_capacity_is_where_sizing_begins_to_fail() {
    let dir = tempfile::tempdir().expect("a folder");
    for (number, study) in studies().into_iter().enumerate() {
        let write =
            |study: &Value| std::fs::write(dir.path().join("s.json"), study.to_string()).expect("written");
        write(&study);
        let output = armwright(&["capacity", "s.json", "--json"], dir.path());
        let said = String::from_utf8_lossy(&output.stderr).to_string();
        assert!(output.status.success(), "study {number}: {said}");
        let found: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let payload_kg = found["payload_kg"].as_f64().unwrap_or_else(|| panic!("study {number}: {found}"));
        assert!(payload_kg > 0.0 && found["joint"].as_str().is_some_and(|j| j.starts_with('j')), "{found}");
        assert!(!found["check"].as_str().expect("a check").is_empty());
        let rows = found["table"].as_array().expect("rows");
        assert_eq!(rows.len(), study["poses"].as_array().expect("poses").len());
        assert!(rows.iter().all(|row| row["payload_kg"].as_f64().expect("kg") >= payload_kg * (1.0 - 1e-9)));
        for (times, code) in [(1.0 - 1e-6, 0), (1.0 + 1e-6, 6)] {
            let mut loaded = study.clone();
            loaded["payload"]["mass_kg"] = json!(payload_kg * times);
            write(&loaded);
            let sized = armwright(&["size", "s.json"], dir.path());
            let said = String::from_utf8_lossy(&sized.stderr).to_string();
            assert_eq!(
                sized.status.code(),
                Some(code),
                "study {number}, {payload_kg} kg times {times}: {said}"
            );
        }
        println!("study {number}: {payload_kg} kg, {} {}", found["joint"], found["check"]);
    }
}

#[test]
fn an_arm_file_whose_joints_have_no_limit_is_refused_with_what_to_give() {
    let dir = tempfile::tempdir().expect("a folder");
    let arm = json!({"name": "a", "chain": [{"type": "joint", "name": "j", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4}]});
    std::fs::write(dir.path().join("arm.json"), arm.to_string()).expect("written");
    let output = armwright(&["capacity", "arm.json"], dir.path());
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("give --limits FILE"));
}

/// A vertical first joint whose bearing holds the moment of everything outboard: 2 kg at 0.5 m and the payload at 1 m. The bearing's
/// lever of 0.1 m does not count for a force along the axis.
#[test]
fn the_capacity_of_an_arm_file_ends_where_an_output_bearing_is_overloaded() {
    let dir = tempfile::tempdir().expect("a folder");
    let bearing = json!({"tilt_stiffness_nm_per_rad": 1e5, "permissible_moment_nm": 40, "offset_m": 0.1,
        "pitch_diameter_m": 0.05, "static_load_rating_n": 9000});
    let mut arm = json!({"name": "a", "chain": [
        {"type": "joint", "name": "waist", "axis": [0, 0, 1], "stiffness_nm_per_rad": 1e4, "bearing": bearing},
        {"type": "link", "name": "l", "vector_m": [1, 0, 0], "mass_kg": 2}]});
    let capacity = |arm: &Value| -> Value {
        std::fs::write(dir.path().join("arm.json"), arm.to_string()).expect("written");
        let output = armwright(&["capacity", "arm.json", "--json"], dir.path());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).expect("JSON")
    };
    let gravity_m_s2 = 9.81;
    let by_moment = capacity(&arm);
    let expected_kg = 40.0 / gravity_m_s2 - 1.0;
    assert!((by_moment["payload_kg"].as_f64().expect("kg") - expected_kg).abs() < 1e-9, "{by_moment}");
    assert_eq!((&by_moment["joint"], &by_moment["check"]), (&json!("waist"), &json!("bearing moment")));

    // static safety 3 against C0: 2 M / d_p + 0.44 F_a = C0 / 3
    arm["chain"][0]["bearing"]["permissible_moment_nm"] = json!(400);
    let by_safety = capacity(&arm);
    let (across, along) = (40.0, 0.44);
    let expected_kg = (3000.0 / gravity_m_s2 - across - 2.0 * along) / (across + along);
    assert!((by_safety["payload_kg"].as_f64().expect("kg") - expected_kg).abs() < 1e-9, "{by_safety}");
    assert_eq!(by_safety["check"], "bearing static safety");

    arm["chain"][0]["bearing"]["permissible_moment_nm"] = json!(5);
    assert_eq!(capacity(&arm)["payload_kg"], 0.0);
}
