//! Unusual robots in URDF files: joints that mimic each other, rounding in inertias, and a stiffness file that a user
//! has filled in.

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// Imports the text of a URDF file in a folder to `folder/arm`.
fn import(folder: &Path, urdf: &str, tip: &str) -> Output {
    let [file, out] = ["robot.urdf", "arm"].map(|name| folder.join(name).display().to_string());
    fs::write(&file, urdf).expect("written");
    let mut program = Command::new(env!("CARGO_BIN_EXE_armwright"));
    program.args(["import", &file, "--tip", tip, "--out", &out]).output().expect("it runs")
}

fn imported(folder: &Path, urdf: &str, tip: &str) -> (String, Value, Value) {
    let output = import(folder, urdf, tip);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let read = |name: &str| {
        let text = fs::read_to_string(folder.join("arm").join(name)).expect("a file");
        serde_json::from_str(&text).expect("JSON")
    };
    (String::from_utf8(output.stdout).expect("text"), read("arm.json"), read("import.json"))
}

fn link(name: &str, mass_kg: f64) -> String {
    format!(
        "<link name=\"{name}\"><inertial><mass value=\"{mass_kg}\"/>\
         <inertia ixx=\"0.01\" iyy=\"0.01\" izz=\"0.01\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>"
    )
}

/// A joint about y, 0.5 m outboard of the last one.
fn joint(name: &str, from: &str, to: &str, more: &str) -> String {
    format!(
        "<joint name=\"{name}\" type=\"revolute\"><parent link=\"{from}\"/><child link=\"{to}\"/><origin xyz=\"0.5 0 0\"/>\
         <axis xyz=\"0 1 0\"/><limit lower=\"-3\" upper=\"3\" effort=\"9\" velocity=\"1\"/>{more}</joint>"
    )
}

fn robot(parts: &[String]) -> String {
    format!("<robot name=\"odd\">{}</robot>", parts.join("\n"))
}

/// Two links on two joints.
fn two_joints(of_a: &str, of_b: &str) -> String {
    robot(&[
        link("base", 1.0),
        link("one", 2.0),
        link("two", 3.0),
        joint("a", "base", "one", of_a),
        joint("b", "one", "two", of_b),
    ])
}

#[test]
fn a_stiffness_file_with_values_is_kept() {
    let folder = tempfile::tempdir().expect("a folder");
    let urdf = two_joints("", "");
    imported(folder.path(), &urdf, "two");
    let stiffness = folder.path().join("arm/stiffness.json");
    // as it was written it may be written again
    let (said, ..) = imported(folder.path(), &urdf, "two");
    assert!(said.contains("fill in"), "{said}");
    let filled = fs::read_to_string(&stiffness).expect("a file").replacen("null", "20000", 1);
    for text in [filled.as_str(), "{\"joints\": {\"a\": {\"stiffness_nm_per_rad\": 2"] {
        fs::write(&stiffness, text).expect("written");
        let (said, ..) = imported(folder.path(), &urdf, "two");
        assert_eq!(fs::read_to_string(&stiffness).expect("a file"), text);
        assert!(said.contains("was kept") && said.contains("--stiffness"), "{said}");
    }
}

#[test]
fn joints_that_mimic_each_other_in_a_circle_are_refused_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let mimics = |joint: &str| format!("<mimic joint=\"{joint}\" multiplier=\"2\"/>");
    for (of_a, of_b, circle) in [
        (mimics("b"), mimics("a"), "a: mimics itself: a mimics b mimics a"),
        (String::new(), mimics("b"), "b: mimics itself: b mimics b"),
    ] {
        let output = import(folder.path(), &two_joints(&of_a, &of_b), "two");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(3), "{said}");
        assert!(said.contains(circle) && said.matches("mimics itself").count() == 1, "{said}");
    }
}

#[test]
fn a_side_branch_stands_where_its_mimic_puts_it() {
    let folder = tempfile::tempdir().expect("a folder");
    // a finger beside the way follows joint a with a constant of 90 degrees: its body hangs 0.5 m below and not outboard
    let quarter = std::f64::consts::FRAC_PI_2;
    let finger = "<link name=\"finger\"><inertial><origin xyz=\"0.5 0 0\"/><mass value=\"4\"/>\
        <inertia ixx=\"0.01\" iyy=\"0.01\" izz=\"0.01\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>";
    let mimic = format!("<mimic joint=\"a\" multiplier=\"0.5\" offset=\"{quarter}\"/>");
    let parts = [
        link("base", 1.0),
        link("one", 2.0),
        link("two", 3.0),
        finger.to_string(),
        joint("a", "base", "one", ""),
        joint("b", "one", "two", ""),
        joint("grip", "one", "finger", &mimic),
    ];
    let (_, arm, report) = imported(folder.path(), &robot(&parts), "two");
    let links = arm["chain"].as_array().expect("a chain").iter();
    let bodies: Vec<&Value> =
        links.flat_map(|item| item["bodies"].as_array().into_iter().flatten()).collect();
    let body = bodies.into_iter().find(|body| body["mass_kg"] == 4.0).expect("the finger");
    for (axis, at_m) in [0.5, 0.0, -0.5].into_iter().enumerate() {
        let found = body["cg_m"][axis].as_f64().expect("m");
        assert!((found - at_m).abs() < 1e-12, "{body}");
    }
    let guessed = report["guessed"].to_string();
    assert!(guessed.contains("grip") && guessed.contains("0.5 times as a does"), "{guessed}");
}

#[test]
fn rounding_of_inertias_far_from_an_origin_is_no_fault() {
    let folder = tempfile::tempdir().expect("a folder");
    // 2 kg at 3 m: what is left of the difference of two tensors of 18 kg m2
    let body = |least: f64| {
        format!(
            "<link name=\"two\"><inertial><origin xyz=\"3 0 0\"/><mass value=\"2\"/>\
             <inertia ixx=\"1e-15\" iyy=\"{least}\" izz=\"0\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>"
        )
    };
    let with = |least: f64| robot(&[link("base", 1.0), body(least), joint("a", "base", "two", "")]);
    imported(folder.path(), &with(-3e-15), "two");
    let output = import(folder.path(), &with(-1e-6), "two");
    assert!(String::from_utf8_lossy(&output.stderr).contains("negative principal moment"), "{output:?}");
}

#[test]
fn point_masses_far_from_the_base_go_out_and_come_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name).display().to_string();
    let joint = |name: &str| serde_json::json!({"type": "joint", "name": name, "axis": [0, 1, 0], "mass_kg": 0.3, "stiffness_nm_per_rad": 1e4});
    let link = |name: &str, x: f64| serde_json::json!({"type": "link", "name": name, "vector_m": [x, 0.07, 3.1], "mass_kg": 1.7});
    let chain = [joint("a"), link("l", 0.31), joint("b"), link("m", 0.17), joint("c"), link("n", 0.23)];
    fs::write(at("arm.json"), serde_json::json!({"name": "mast", "chain": chain}).to_string())
        .expect("written");
    for words in [
        ["export", &at("arm.json"), "--to", "urdf", "--out", &at("out")].as_slice(),
        ["import", &at("out/arm.urdf"), "--tip", "tip", "--out", &at("back")].as_slice(),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_armwright")).args(words).output().expect("it runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let urdf = urdf_rs::read_file(at("out/arm.urdf")).expect("a URDF");
    let last = urdf.links.iter().find(|link| link.name == "c_link").expect("the last link");
    // one point mass has no inertia, and none is made up of rounding
    assert_eq!([last.inertial.inertia.ixx, last.inertial.inertia.iyy, last.inertial.inertia.izz], [0.0; 3]);
}

#[test]
fn faults_of_a_urdf_that_its_parser_does_not_place_have_a_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let faulty = |bytes: &[u8]| {
        let [file, out] = ["robot.urdf", "arm"].map(|name| folder.path().join(name).display().to_string());
        fs::write(&file, bytes).expect("written");
        let mut program = Command::new(env!("CARGO_BIN_EXE_armwright"));
        let output =
            program.args(["import", &file, "--tip", "two", "--out", &out]).output().expect("it runs");
        assert_eq!(output.status.code(), Some(3), "{output:?}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let sound = two_joints("", "");
    // the first joint is in line 4
    let said = faulty(sound.replacen("0.5 0 0", "0,5 0 0", 1).as_bytes());
    assert!(said.contains("robot.urdf:4") && said.contains("xyz=\"0,5 0 0\""), "{said}");
    let said = faulty(b"<?xml version=\"1.0\"?>\n<robot name=\"empty\"></robot>");
    assert!(said.contains("robot.urdf:2"), "{said}");
    let mut latin1 = sound.replacen("name=\"one\"", "name=\"on?\"", 1).into_bytes();
    let at = latin1.iter().position(|byte| *byte == b'?').expect("the mark");
    latin1[at] = 0xe9;
    let said = faulty(&latin1);
    assert!(said.contains("robot.urdf:2") && said.contains("UTF-8"), "{said}");
}
