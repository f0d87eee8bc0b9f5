//! `armwright capacity` checked by `armwright size`: the drives must hold just below the largest payload and speed that
//! `capacity` finds, and fail just above.

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
fn the_largest_speed_is_where_sizing_begins_to_fail() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut studies = studies();
    // a joint with a speed of its own
    studies[1]["chain"][2]["max_speed_rad_s"] = json!(3.0);
    // a stop that does not become harder with the speed
    studies[3]["motion"]["emergency_deceleration_m_s2"] = json!(4.0);
    for (number, study) in studies.into_iter().enumerate() {
        let write =
            |study: &Value| std::fs::write(dir.path().join("s.json"), study.to_string()).expect("written");
        write(&study);
        let output = armwright(&["capacity", "s.json", "--json"], dir.path());
        let found: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let speed = &found["largest_speed"];
        let factor = speed["factor"].as_f64().unwrap_or_else(|| panic!("study {number}: {found}"));
        assert!(speed["joint"].as_str().is_some_and(|joint| joint.starts_with('j')), "{speed}");
        assert!((speed["tip_speed_m_s"].as_f64().expect("m/s") - 0.5 * factor).abs() < 1e-12);
        for (times, code) in [(1.0 - 1e-6, 0), (1.0 + 1e-6, 6)] {
            let mut fast = study.clone();
            fast["motion"]["tip_speed_m_s"] = json!(0.5 * factor * times);
            if number == 1 {
                fast["chain"][2]["max_speed_rad_s"] = json!(3.0 * factor * times);
            }
            write(&fast);
            let sized = armwright(&["size", "s.json"], dir.path());
            let said = String::from_utf8_lossy(&sized.stderr).to_string();
            assert_eq!(sized.status.code(), Some(code), "study {number}, {factor} times {times}: {said}");
            if code != 0 {
                assert!(
                    said.contains(speed["joint"].as_str().expect("name")),
                    "study {number}: {speed}\n{said}"
                );
            }
        }
        println!("study {number}: {speed}");
    }
}

/// The torques of a duty in numbers belong to one payload; `capacity` says that it does not scale them.
#[test]
fn a_duty_in_numbers_is_said_not_to_grow_with_the_payload() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut study = studies().swap_remove(0);
    study["chain"][0]["duty"] = json!([{"torque_nm": 20, "time_s": 0.3, "speed_rpm": 3},
        {"torque_nm": 15, "time_s": 1, "speed_rpm": 6}, {"torque_nm": 5, "time_s": 0.3, "speed_rpm": 3}]);
    std::fs::write(dir.path().join("s.json"), study.to_string()).expect("written");
    let output = armwright(&["capacity", "s.json"], dir.path());
    let said = String::from_utf8_lossy(&output.stdout).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        said.contains("The duty of j1 is stated in numbers and is taken for every payload and speed"),
        "{said}"
    );
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

/// A lever of 0.6 m whose joint has one drive, and a counterweight behind it.
fn balanced(poses: Value) -> Value {
    json!({"name": "balanced", "payload": {"mass_kg": 12}, "poses": poses, "chain": [
            joint("j1", [0.0, 1.0, 0.0], "CSG-20-100", "ILM70x18"),
            {"type": "link", "name": "a", "vector_m": [0.6, 0, 0], "mass_kg": 2}],
        "counterweights": [{"at": "a", "point_m": [-0.3, 0, 0], "mass_kg": 30}],
        "motion": {"tip_speed_m_s": 0.2, "ramp_time_s": 1}})
}

#[test]
fn a_balanced_arm_has_a_smallest_payload_below_which_sizing_fails() {
    let dir = tempfile::tempdir().expect("a folder");
    let study = balanced(json!([{"name": "out", "pose_deg": [0]}]));
    let write =
        |study: &Value| std::fs::write(dir.path().join("s.json"), study.to_string()).expect("written");
    write(&study);
    let found = armwright(&["capacity", "s.json", "--json"], dir.path());
    assert!(found.status.success(), "{}", String::from_utf8_lossy(&found.stderr));
    let found: Value = serde_json::from_slice(&found.stdout).expect("JSON");
    let ends = ["least_payload_kg", "payload_kg"].map(|key| found[key].as_f64().expect("kg"));
    assert!(0.0 < ends[0] && ends[0] < 12.0 && 12.0 < ends[1], "{found}");
    assert_eq!((&found["least_joint"], &found["least_pose"]), (&json!("j1"), &json!("out")));
    for (payload_kg, holds) in ends.into_iter().zip([[false, true], [true, false]]) {
        for (times, holds) in [1.0 - 1e-6, 1.0 + 1e-6].into_iter().zip(holds) {
            let mut loaded = study.clone();
            loaded["payload"]["mass_kg"] = json!(payload_kg * times);
            write(&loaded);
            let code = armwright(&["size", "s.json"], dir.path()).status.code();
            assert_eq!(code, Some(if holds { 0 } else { 6 }), "{payload_kg} kg times {times}");
        }
    }
    write(&study);
    let text = armwright(&["capacity", "s.json"], dir.path());
    let text = String::from_utf8_lossy(&text.stdout).to_string();
    let says = format!("balanced holds from {:.3} to {:.3} kg in all of its poses", ends[0], ends[1]);
    assert!(text.starts_with(&says) && text.contains("It does not hold the empty arm"), "{text}");
}

#[test]
fn a_pose_that_states_its_own_payload_keeps_it_and_is_named() {
    let dir = tempfile::tempdir().expect("a folder");
    let capacity = |study: &Value| -> Value {
        std::fs::write(dir.path().join("s.json"), study.to_string()).expect("written");
        let found = armwright(&["capacity", "s.json", "--json"], dir.path());
        assert!(found.status.success(), "{}", String::from_utf8_lossy(&found.stderr));
        serde_json::from_slice(&found.stdout).expect("JSON")
    };
    let out = json!({"name": "out", "pose_deg": [0]});
    let alone = capacity(&balanced(json!([out])));
    // a push at the tip, which the joint bears with the payload of this pose and would not bear with the largest one
    let own = json!({"name": "own", "pose_deg": [0], "payload": {"mass_kg": 8}, "tip_force_n": [0, 0, -20]});
    let with_own = capacity(&balanced(json!([out, own])));
    let [a, b] = [&alone, &with_own].map(|found| found["payload_kg"].as_f64().expect("kg"));
    assert!((a - b).abs() < 1e-9, "{alone} {with_own}");
    assert_eq!(with_own["table"].as_array().expect("rows").len(), 1, "{with_own}");
    let remarks = with_own["remarks"].to_string();
    assert!(
        remarks.contains("Poses that keep the payload that they state: \u{201c}own\u{201d}."),
        "{remarks}"
    );
}

#[test]
fn an_actuator_that_is_named_as_the_gear_alone_limits_by_its_motor() {
    let dir = tempfile::tempdir().expect("a folder");
    let arm = json!({"name": "a", "chain": [
        {"type": "joint", "name": "j1", "axis": [0, 1, 0], "gear": "CHA-20A-100"},
        {"type": "link", "name": "l", "vector_m": [0.5, 0, 0], "mass_kg": 1},
        {"type": "joint", "name": "j2", "axis": [0, 1, 0], "stiffness_nm_per_rad": null}]});
    std::fs::write(dir.path().join("arm.json"), arm.to_string()).expect("written");
    let found = armwright(&["capacity", "arm.json", "--json"], dir.path());
    let found: Value = serde_json::from_slice(&found.stdout).expect("JSON");
    // the data sheet of the actuator states 49 N m at its output
    let by_hand_kg = (49.0 - 0.25 * 9.81) / (0.5 * 9.81);
    assert!((found["payload_kg"].as_f64().expect("kg") - by_hand_kg).abs() < 1e-9, "{by_hand_kg} in {found}");
    assert_eq!(found["check"], "continuous torque of the motor");
    assert!(found["remarks"][0].as_str().expect("a remark").ends_with("not judged: j2."), "{found}");
    std::fs::write(dir.path().join("l.json"), r#"{"joints": [{"name": "J1", "max_torque_nm": 5}]}"#)
        .expect("written");
    let refused = armwright(&["capacity", "arm.json", "--limits", "l.json"], dir.path());
    let said = String::from_utf8_lossy(&refused.stderr).to_string();
    assert!(refused.status.code() == Some(3) && said.contains("did you mean \"j1\"?"), "{said}");
}

/// With every joint at zero, the elbow and the wrist of this robot are beyond their ranges.
#[test]
fn poses_beyond_the_ranges_of_an_imported_robot_are_named() {
    let dir = tempfile::tempdir().expect("a folder");
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/urdf/panda.urdf");
    let urdf = urdf.to_str().expect("text");
    let imported = armwright(&["import", urdf, "--tip", "panda_link8", "--out", "panda"], dir.path());
    assert!(imported.status.success());
    let said = |words: &[&str]| {
        let output = armwright(&[&["capacity", "panda/arm.json"], words].concat(), dir.path());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let zero = said(&[]);
    assert!(zero.contains("cannot take every pose") && zero.contains("panda_joint4 at 0 deg"), "{zero}");
    std::fs::write(dir.path().join("poses.json"), r#"[{"pose_deg": [0, 0, 0, -90, 0, 90, 0]}]"#)
        .expect("written");
    let bent = said(&["--cases", "poses.json"]);
    assert!(!bent.contains("cannot take"), "{bent}");
}

#[test]
fn a_link_without_sections_is_refused_as_size_and_run_refuse_it() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut study = studies().swap_remove(1);
    study["chain"][1] = json!({"type": "link", "name": "upper", "vector_m": [0.5, 0, 0], "choose": {
        "materials": ["Structural steel S355"],
        "sections": [{"shape": "round_tube", "diameter_mm": [60, 90], "wall_mm": []}]}});
    std::fs::write(dir.path().join("s.json"), study.to_string()).expect("written");
    let said: Vec<String> =
        [&["size", "s.json"][..], &["capacity", "s.json"], &["capacity", "s.json", "--design", "x0"]]
            .iter()
            .map(|words| {
                let output = armwright(words, dir.path());
                assert_eq!(output.status.code(), Some(5), "{words:?}: {output:?}");
                String::from_utf8_lossy(&output.stderr).into_owned()
            })
            .collect();
    assert!(said[0].contains("has nothing to choose from") && said[0].contains("link upper"), "{}", said[0]);
    assert!(said.iter().all(|other| *other == said[0]), "{said:#?}");
}

#[test]
fn a_file_that_is_no_json_is_refused_with_its_line_whatever_the_flags() {
    let dir = tempfile::tempdir().expect("a folder");
    let text = "{\"name\": \"a\",\n \"chain\": [{\"type\": \"joint\", \"name\": \"j\", \"axis\": [0, 1, 0],";
    std::fs::write(dir.path().join("arm.json"), text).expect("written");
    for file in ["c.json", "l.json"] {
        std::fs::write(dir.path().join(file), "[]").expect("written");
    }
    for flags in
        [&[][..], &["--cases", "c.json", "--limits", "l.json"], &["--limits", "l.json"], &["--design", "x1"]]
    {
        let output = armwright(&[&["capacity", "arm.json"], flags].concat(), dir.path());
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{flags:?}: {said}");
        assert!(said.contains("arm.json:2: column 60: not valid JSON"), "{flags:?}: {said}");
    }
    // a study that can be read still says that these flags are not for it
    std::fs::write(dir.path().join("s.json"), studies()[0].to_string()).expect("written");
    let output = armwright(&["capacity", "s.json", "--cases", "c.json"], dir.path());
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && said.contains("are for arm files"), "{said}");
}
