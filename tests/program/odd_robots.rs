//! Robots in URDF files with closed loops, with values that cannot be read, and with very many links.

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

/// What an import with faults says.
fn refused(urdf: &str, tip: &str) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let output = import(folder.path(), urdf, tip);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{said}");
    said
}

fn link(name: &str) -> String {
    format!(
        "<link name=\"{name}\"><inertial><mass value=\"1\"/>\
         <inertia ixx=\"0.01\" iyy=\"0.01\" izz=\"0.01\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\n"
    )
}

fn joint(name: &str, kind: &str, from: &str, to: &str) -> String {
    format!(
        "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{from}\"/><child link=\"{to}\"/><origin xyz=\"0.001 0 0\"/>\
         <axis xyz=\"0 1 0\"/><limit lower=\"-3\" upper=\"3\" effort=\"9\" velocity=\"1\"/></joint>\n"
    )
}

fn robot(parts: &[String]) -> String {
    format!("<robot name=\"odd\">\n{}</robot>", parts.concat())
}

/// A lever: the links `a` and `b` in lines 2 and 3, the joint `j` in line 4.
fn lever() -> String {
    robot(&[link("a"), link("b"), joint("j", "revolute", "a", "b")])
}

#[test]
fn closed_loops_of_joints_are_refused_by_name() {
    let turns = |name: &str, from: &str, to: &str| joint(name, "revolute", from, to);
    let ring = [
        link("a"),
        link("b"),
        link("tip"),
        turns("1", "a", "b"),
        turns("2", "b", "a"),
        turns("3", "b", "tip"),
    ];
    let said = refused(&robot(&ring), "tip");
    assert!(
        said.contains("robot.urdf:5: 1: is in a closed loop of joints: 1 (a to b), 2 (b to a); "),
        "{said}"
    );
    assert!(said.contains("remove the joint that closes the loop"), "{said}");
    let said = refused(&robot(&[link("a"), turns("1", "a", "a")]), "a");
    assert!(said.contains("robot.urdf:3: 1: is in a closed loop of joints: 1 (a to a)"), "{said}");
    // a loop that nothing connects to the root
    let apart = [link("base"), link("tip"), turns("j", "base", "tip")];
    let said = refused(&robot(&[&apart[..], &ring[..2], &ring[3..5]].concat()), "tip");
    assert!(said.contains("1 (a to b), 2 (b to a)") && said.contains("1 fault in the input"), "{said}");
    // a loop that begins at the root gives its first link two parents, which are named
    let said =
        refused(&robot(&[&apart[..], &ring[..2], &ring[3..5], &[turns("k", "base", "a")]].concat()), "tip");
    assert!(said.contains("a: is the child of 2 joints: 2, k"), "{said}");
}

#[test]
fn values_that_cannot_be_read_are_named_by_element_and_attribute() {
    let with = |from: &str, to: &str| lever().replacen(from, to, 1);
    let revolute = "type=\"revolute\"";
    for (urdf, parts) in [
        (
            with("mass value=\"1\"", "mass value=\"one\""),
            ["robot.urdf:2: link a: ", "<mass value=\"one\"> is no number"],
        ),
        (
            with("upper=\"3\"", "upper=\"3,1\""),
            ["robot.urdf:4: joint j: ", "<limit upper=\"3,1\"> is no number"],
        ),
        (with("iyy=\"0.01\"", ""), ["robot.urdf:2: link a: ", "<inertia> lacks the attribute iyy"]),
        (with("0 1 0", "0 1"), ["robot.urdf:4: joint j: ", "<axis xyz=\"0 1\"> is no list of three numbers"]),
        (
            with("0 1 0", "0 1 up 0"),
            ["robot.urdf:4: joint j: ", "<axis xyz=\"0 1 up 0\"> is no list of three numbers"],
        ),
        (with("<child link=\"b\"/>", ""), ["robot.urdf:4: joint j: ", "<joint> lacks the element <child>"]),
        (
            with(revolute, "type=\"hinge\""),
            ["robot.urdf:4: joint j: ", "type=\"hinge\" is none of revolute,"],
        ),
        (
            with("mass value=\"1\"", "mass value=\"inf\""),
            ["robot.urdf:2: a: ", "<mass value> = inf is not a finite number"],
        ),
        (
            with("mass value=\"1\"", "mass value=\"1e40\""),
            ["robot.urdf:2: a: ", "<mass value> = 1e40 is beyond 1e30"],
        ),
        (with("mass value=\"1\"", "mass value=\"-1\""), ["robot.urdf:2: a: ", "has a mass of -1 kg"]),
        (
            with("ixz=\"0\"", "ixz=\"nan\""),
            ["robot.urdf:2: a: ", "<inertia ixz> = NaN is not a finite number"],
        ),
        (with("name=\"j\"", "name=\"\""), ["robot.urdf:4: ", "a joint has an empty name"]),
        (with("name=\"a\"", "name=\"\""), ["robot.urdf:2: ", "a link has an empty name"]),
    ] {
        let said = refused(&urdf, "b");
        assert!(parts.iter().all(|part| said.contains(part)), "{parts:?} in {said}");
    }
    // all of them at once
    let said = refused(&with("upper=\"3\"", "upper=\"x\"").replacen("value=\"1\"", "value=\"y\"", 2), "b");
    assert!(said.contains("3 faults in the input"), "{said}");
}

#[test]
fn limits_that_no_joint_can_have_are_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let urdf =
        lever().replacen("effort=\"9\"", "effort=\"-9\"", 1).replacen("lower=\"-3\"", "lower=\"4\"", 1);
    let output = import(folder.path(), &urdf, "b");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report = fs::read_to_string(folder.path().join("arm/import.json")).expect("a file");
    let report: Value = serde_json::from_str(&report).expect("JSON");
    assert_eq!(report["joints"][0]["max_torque_nm"], Value::Null);
    let guessed: Vec<&str> =
        report["guessed"].as_array().expect("a list").iter().filter_map(Value::as_str).collect();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    for words in [
        "j: <limit effort=\"-9\"> is no largest value",
        "j: <limit lower=\"4\" upper=\"3\"> has its lower end above",
    ] {
        assert!(
            said.contains(words) && guessed.iter().any(|guess| guess.starts_with(words)),
            "{words} in {said}"
        );
    }
}

/// A side branch of 20,000 links in a row, and as many links on the root, take less than a second in a release build. If
/// the time grew with the square of their number, they would take minutes.
#[test]
fn robots_of_very_many_links_are_imported() {
    let folder = tempfile::tempdir().expect("a folder");
    let many = 20_000;
    let with = |parent: &dyn Fn(usize) -> String| {
        let side = (1..=many).flat_map(|i| {
            [link(&format!("s{i}")), joint(&format!("f{i}"), "fixed", &parent(i), &format!("s{i}"))]
        });
        let main = [link("s0"), link("tip"), joint("j", "revolute", "s0", "tip")];
        robot(&main.into_iter().chain(side).collect::<Vec<_>>())
    };
    let in_a_row = with(&|i| format!("s{}", i - 1));
    let on_the_root = with(&|_| "s0".into());
    for urdf in [in_a_row, on_the_root] {
        let output = import(folder.path(), &urdf, "tip");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(said.contains("links beside the way: 20000") && said.contains("20002.000 kg"), "{said}");
    }
}

/// An arm has at most 2000 joints and links. A robot of 1500 joints with a link behind each of them has 3001.
#[test]
fn a_way_with_more_joints_and_links_than_an_arm_may_have_is_refused() {
    let chain = |joints: usize| {
        let parts = (1..=joints).flat_map(|i| {
            [
                link(&format!("l{i}")),
                joint(&format!("j{i}"), "revolute", &format!("l{}", i - 1), &format!("l{i}")),
            ]
        });
        robot(&[link("l0")].into_iter().chain(parts).collect::<Vec<_>>())
    };
    let said = refused(&chain(1500), "l1500");
    assert!(said.contains("--tip: the arm has 3001 joints and links, and the limit is 2000"), "{said}");
    let folder = tempfile::tempdir().expect("a folder");
    let output = import(folder.path(), &chain(999), "l999");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
