//! The contents of exported files: torques, tangent stiffnesses, backlash, names and masses of an arm.
//!
//! Most arms here have one joint, so that the right content of a file can be computed by hand.

use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn armwright(words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_armwright")).args(words).output().expect("it runs")
}

/// Exports an arm in a folder of its own; the flags begin with the form. Gives the record and the folder of the files.
fn export(folder: &Path, arm: &Value, flags: &[&str]) -> (Value, PathBuf) {
    let file = folder.join("arm-file.json");
    fs::write(&file, arm.to_string()).expect("written");
    let out = folder.join(flags[0]);
    let (file, into) = (file.display().to_string(), out.display().to_string());
    let words = [&["export", &file, "--out", &into, "--to"], flags].concat();
    let output = armwright(&words);
    assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
    (serde_json::from_str(&text(&out, "export.json")).expect("JSON"), out)
}

fn text(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn close(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{found} and not {expected}");
}

fn notes(record: &Value) -> String {
    record["notes"].to_string()
}

/// The value of an attribute of the first element of an XML text with this name that has the attribute.
fn attribute(xml: &str, name: &str, key: &str) -> String {
    let mut named = xml.lines().filter(|line| line.contains(&format!(" name=\"{name}\"")));
    let after = named.find_map(|line| line.split(&format!(" {key}=\"")).nth(1));
    let after = after.unwrap_or_else(|| panic!("no {name} with {key} in {xml}"));
    after.split('"').next().expect("a value").into()
}

/// Weight of the lever at its joint \[N m\]: 10 kg at 1 m.
const WEIGHT_NM: f64 = 98.1;
/// Twist of the lever's gear under its weight \[rad\]: 20 N m at 1e4, 40 at 2e4, and the rest at 4e4 N m/rad.
const TWIST_RAD: f64 = 20.0 / 1e4 + 40.0 / 2e4 + (WEIGHT_NM - 60.0) / 4e4;

/// A lever of 2 m with 10 kg in its middle, on a gear with three slopes.
fn lever() -> Value {
    json!({"name": "lever", "chain": [
        {"type": "joint", "name": "j", "axis": [0, 1, 0], "windup":
            {"k1_nm_per_rad": 1e4, "k2_nm_per_rad": 2e4, "k3_nm_per_rad": 4e4, "t1_nm": 20, "t2_nm": 60}},
        {"type": "link", "name": "l", "vector_m": [2, 0, 0], "mass_kg": 10}]})
}

/// The lever with a spring that holds 90 of its 98.1 N m, so that its gear works on the first slope.
fn balanced_lever() -> Value {
    let mut arm = lever();
    arm["springs"] = json!([{"name": "balancer", "joint": "j", "stiffness_nm_per_rad": 270.0 / std::f64::consts::PI, "free_deg": -60}]);
    arm
}

/// Frequency of the lever on its first slope \[Hz\].
fn first_slope_hz() -> f64 {
    (1e4f64 / 10.0).sqrt() / std::f64::consts::TAU
}

#[test]
fn torques_on_joints_are_left_out_by_name_with_their_share() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut arm = lever();
    arm["effects"] = json!([{"effect": "joint_torque", "at": "j", "parameters": {"offset_nm": -90}}]);
    for form in ["mjcf", "urdf"] {
        let (record, _) = export(folder.path(), &arm, &[form]);
        close(number(&record["expected"]["joint_torque_nm"]["j"]), WEIGHT_NM, 1e-12);
        let left = record["left_out"].as_array().expect("a list");
        let torque = left.iter().find(|item| item["what"] == "joint_torque").expect("it is named");
        assert_eq!(torque["at"], "j");
        // without it the file deflects more than the arm, by 90 of 8.1 N m on one slope
        if form == "mjcf" {
            close(number(&torque["tip_share"]), -90.0 / (WEIGHT_NM - 90.0), 1e-9);
        }
    }
    // the decks of CalculiX have the torque
    let (record, _) = export(folder.path(), &arm, &["calculix"]);
    assert_eq!(record["left_out"], json!([]));
    close(number(&record["expected"]["tip_displacement_m"][2]), -2.0 * (WEIGHT_NM - 90.0) / 1e4, 1e-9);
}

#[test]
fn tangents_are_those_of_the_arm_as_it_stands() {
    let folder = tempfile::tempdir().expect("a folder");
    // MuJoCo: one spring, whose rest is where the curve's first slope begins
    let (record, out) = export(folder.path(), &balanced_lever(), &["mjcf"]);
    let xml = text(&out, "arm.xml");
    close(attribute(&xml, "j.gear", "stiffness").parse().expect("a number"), 1e4, 1e-9);
    let expected = &record["expected"];
    close(number(&expected["frequencies_hz"][0]), first_slope_hz(), 1e-9);
    close(number(&expected["tip_displacement_m"][2]), -2.0 * WEIGHT_NM / 1e4, 1e-9);
    let deflected = attribute(&xml, "deflected", "qpos");
    let gear: f64 = deflected.split(' ').nth(1).expect("two hinges").parse().expect("a number");
    close(gear, WEIGHT_NM / 1e4, 1e-9);
    assert!(notes(&record).contains("the arm as it stands"), "{record}");
    // CalculiX: the secant of the weight for the deflection, and the tangent of the balanced arm for the frequency
    let (record, out) = export(folder.path(), &balanced_lever(), &["calculix"]);
    let expected = &record["expected"];
    close(number(&expected["frequencies_hz"][0]), first_slope_hz(), 1e-9);
    close(number(&expected["tip_displacement_m"][2]), -2.0 * TWIST_RAD, 1e-9);
    let stiffness = |deck: &str| -> f64 {
        let after = text(&out, deck).split("** hinge j").nth(1).expect("the hinge").to_string();
        after.lines().nth(5).expect("the stiffness").parse().expect("a number")
    };
    close(stiffness("static.inp"), WEIGHT_NM / TWIST_RAD, 1e-9);
    close(stiffness("modes.inp"), 1e4, 1e-9);
}

#[test]
fn a_force_at_the_tip_moves_the_tangents_of_a_simulator() {
    let folder = tempfile::tempdir().expect("a folder");
    let cases = folder.path().join("cases.json");
    fs::write(&cases, json!([{"pose_deg": [0], "tip_force_n": [0, 0, 45]}]).to_string()).expect("written");
    let (record, out) = export(folder.path(), &lever(), &["mjcf", "--cases", &cases.display().to_string()]);
    // 45 N at 2 m lift 90 of the 98.1 N m
    close(attribute(&text(&out, "arm.xml"), "j.gear", "stiffness").parse().expect("a number"), 1e4, 1e-9);
    close(number(&record["expected"]["frequencies_hz"][0]), first_slope_hz(), 1e-9);
    let shares: f64 =
        record["left_out"].as_array().expect("a list").iter().map(|l| number(&l["tip_share"])).sum();
    let whole_m = -2.0 * (WEIGHT_NM - 90.0) / 1e4;
    close(number(&record["expected"]["tip_displacement_m"][2]) / whole_m + shares, 1.0, 1e-9);
}

/// Frequencies that `ccx` finds from the deck `modes.inp` \[Hz\]; `None` if it is not installed.
fn ccx_frequencies(folder: &Path) -> Option<Vec<f64>> {
    Command::new("ccx").arg("-v").output().ok()?;
    let run = Command::new("ccx").arg("modes").current_dir(folder).env("OMP_NUM_THREADS", "1").output();
    let said = String::from_utf8_lossy(&run.expect("it runs").stdout).into_owned();
    assert!(!said.contains("*ERROR"), "{said}");
    let data = text(folder, "modes.dat");
    let table = data.split("P A R T I C I P A T I O N").next().expect("a table");
    let rows = table.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
    let modes = rows.filter(|row| row.len() == 5 && row[0].parse::<u32>().is_ok());
    Some(modes.map(|row| row[3].parse().expect("Hz")).collect())
}

#[test]
fn decks_of_few_hinges_have_equations_enough_for_the_solver() {
    let folder = tempfile::tempdir().expect("a folder");
    let (record, out) = export(folder.path(), &lever(), &["calculix"]);
    let deck = text(&out, "modes.inp");
    // one frequency of one hinge: four equations are missing
    assert!(deck.contains("** not of the arm: 4 nodes") && deck.contains("*FREQUENCY\n1\n"), "{deck}");
    assert!(!text(&out, "static.inp").contains("not of the arm"));
    match ccx_frequencies(&out) {
        Some(found) => close(found[0], number(&record["expected"]["frequencies_hz"][0]), 1e-6),
        None => eprintln!("SKIPPED: no ccx on the PATH"),
    }
    let mut rigid = lever();
    let joint = rigid["chain"][0].as_object_mut().expect("a joint");
    joint.remove("windup");
    joint.insert("stiffness_nm_per_rad".into(), Value::Null);
    let (record, _) = export(folder.path(), &rigid, &["calculix"]);
    let files = json!(["static.inp"]);
    assert!(record["files"] == files && !notes(&record).contains("ccx modes"), "{record}");
}

/// An arm whose gear has backlash and whose hand a linkage keeps level.
fn playing_arm() -> Value {
    json!({"name": "play", "chain": [
        {"type": "joint", "name": "lift", "axis": [0, 1, 0], "gear": "TPMF-4-5", "motor": "ILM85x26"},
        {"type": "link", "name": "upper", "vector_m": [0.4, 0, 0], "mass_kg": 2},
        {"type": "joint", "name": "level", "axis": [0, 1, 0], "coupled": {"lift": -1}, "stiffness_nm_per_rad": null},
        {"type": "link", "name": "hand", "vector_m": [0.1, 0, 0], "mass_kg": 1}]})
}

/// A Python that has MuJoCo: `ARMWRIGHT_PYTHON`, that of `scripts/test`, or the system's.
fn python() -> Option<String> {
    let own =
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("target/mujoco/bin/python").display().to_string();
    let candidates = [std::env::var("ARMWRIGHT_PYTHON").ok(), Some(own), Some("python3".into())];
    candidates.into_iter().flatten().find(|python| {
        let output = Command::new(python).args(["-c", "import mujoco"]).output();
        output.is_ok_and(|output| output.status.success())
    })
}

/// Loads a model into MuJoCo and lets it fall for 20 steps.
const STEPS: &str = "import sys, mujoco
m = mujoco.MjModel.from_xml_path(sys.argv[1])
d = mujoco.MjData(m)
for _ in range(20): mujoco.mj_step(m, d)
assert not any(w.number for w in d.warning), 'MuJoCo warns'
assert abs(d.qacc).max() < 1e6, d.qacc";

fn steps(model: &Path) {
    let Some(python) = python() else { return eprintln!("SKIPPED: no Python with mujoco") };
    let output = Command::new(python).args(["-c", STEPS]).arg(model).output().expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn a_backlash_has_an_armature_a_stop_and_moves_what_follows() {
    let folder = tempfile::tempdir().expect("a folder");
    let (record, out) = export(folder.path(), &playing_arm(), &["mjcf", "--backlash"]);
    let xml = text(&out, "arm.xml");
    let of = |name: &str, key: &str| attribute(&xml, name, key).parse::<f64>().expect("a number");
    // on the spring of the gear it turns by at most a radian of its vibration in a time step of 0.1 ms
    let steady_kgm2 = of("lift.gear", "stiffness") * 1e-8;
    let least_kgm2 = of("lift", "armature") / 1e3;
    close(of("lift.backlash", "armature"), steady_kgm2.max(least_kgm2), 1e-9);
    assert!(notes(&record).contains("lift") && notes(&record).contains("small armature"), "{record}");
    let coupling =
        xml.split("level.coupling").nth(1).expect("a tendon").split("</fixed>").next().expect("its end");
    for joint in ["lift", "lift.backlash", "lift.gear"] {
        assert!(coupling.contains(&format!("joint=\"{joint}\" coef=\"1\"")), "{joint} in {coupling}");
    }
    // the weight turns the joint about +y, so the backlash stands at its upper stop
    let range = attribute(&xml, "lift.backlash", "range");
    let upper = range.split(' ').nth(1).expect("two ends").to_string();
    assert!(attribute(&xml, "deflected", "qpos").split(' ').any(|entry| entry == upper));
    assert!(attribute(&xml, "pose", "qpos").split(' ').all(|entry| entry == "0"));
    steps(&out.join("arm.xml"));
}

/// A motor of 0.1 kg m² on the spring of a joint, and 2 kg at 0.5 m behind it: they vibrate against each other. A light
/// body between two stiff springs vibrates far faster.
#[test]
fn the_time_step_follows_the_highest_frequency_of_the_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let joint = json!({"type": "joint", "name": "j", "axis": [0, 0, 1], "stiffness_nm_per_rad": 1e6});
    let beam = json!({"type": "link", "name": "beam", "vector_m": [1, 0, 0], "mass_kg": 2});
    let step_of = |chain: Value| {
        let (record, out) = export(folder.path(), &json!({"name": "a", "chain": chain}), &["mjcf"]);
        let xml = text(&out, "arm.xml");
        let words = xml.split("timestep=\"").nth(1).expect("a step");
        let step: f64 = words.split('"').next().expect("a number").parse().expect("a number");
        (step, notes(&record).contains("the time step is"), xml)
    };
    let (step_s, is_noted, xml) = step_of(json!([joint, beam]));
    let rad_per_s = (1e6f64 * (1.0 / 0.1 + 1.0 / (2.0 * 0.25))).sqrt();
    assert!(step_s * rad_per_s <= 1.0 && (step_s + 1e-5) * rad_per_s > 1.0, "{step_s} s, {rad_per_s} rad/s");
    assert!(!is_noted && xml.contains(&format!("f = {:.0} Hz", rad_per_s / std::f64::consts::TAU)), "{xml}");
    let mut light = joint.clone();
    (light["name"], light["mass_kg"]) = (json!("k"), json!(1e-3));
    let (short_s, is_noted, _) = step_of(json!([joint, light, beam]));
    assert!(is_noted && short_s < 1e-6, "{short_s} s");
    // nothing vibrates on rigid joints
    let mut rigid = joint.clone();
    rigid["stiffness_nm_per_rad"] = Value::Null;
    assert_eq!(step_of(json!([rigid, beam])).0, 1e-3);
}

#[test]
fn a_motor_behind_a_gear_in_numbers_has_its_armature() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut arm = lever();
    let joint = arm["chain"][0].as_object_mut().expect("a joint");
    joint.insert("motor".into(), json!("ILM70x18"));
    joint.insert("gear_ratio".into(), json!(50));
    joint.insert("transmission".into(), json!([{"ratio": 2, "inertia_kgm2": 1e-5}]));
    let (record, out) = export(folder.path(), &arm, &["mjcf"]);
    let xml = text(&out, "arm.xml");
    // the catalog's rotor has 3.4e-5 kg m2, its peak is 3.9 N m
    close(attribute(&xml, "j", "armature").parse().expect("a number"), 100.0 * 100.0 * (3.4e-5 + 1e-5), 1e-9);
    assert!(xml.contains("ctrlrange=\"-390 390\""), "{xml}");
    assert!(!notes(&record).contains("armature"), "{record}");
    // the ratio comes through an arm file that the program writes
    let (_, out) = export(folder.path(), &arm, &["json"]);
    let written: Value = serde_json::from_str(&text(&out, "arm.json")).expect("JSON");
    assert_eq!(written["chain"][0]["gear_ratio"], 50.0);
    // without it, the note gives the right reason
    let joint = arm["chain"][0].as_object_mut().expect("a joint");
    joint.remove("gear_ratio");
    joint.remove("transmission");
    let (record, _) = export(folder.path(), &arm, &["mjcf"]);
    assert!(notes(&record).contains("ratio of the gear is not known (key gear_ratio): j"), "{record}");
}

#[test]
fn names_that_the_files_use_themselves_are_no_trouble() {
    let folder = tempfile::tempdir().expect("a folder");
    let joint =
        |name: &str| json!({"type": "joint", "name": name, "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4});
    let link = |name: &str| json!({"type": "link", "name": name, "vector_m": [0.2, 0, 0], "mass_kg": 1});
    let joints = ["base", "world", "tip", "tip_frame", "j1.gear", "j1", "base_link"];
    let chain: Vec<Value> =
        joints.iter().enumerate().flat_map(|(i, name)| [joint(name), link(&format!("l{i}"))]).collect();
    let arm = json!({"name": "names", "chain": chain});
    let (_, out) = export(folder.path(), &arm, &["mjcf"]);
    let xml = text(&out, "arm.xml");
    for kind in ["body", "joint"] {
        let begin = format!("<{kind} name=\"");
        let names: Vec<&str> =
            xml.lines().filter_map(|line| line.trim().strip_prefix(&begin)?.split('"').next()).collect();
        let different: BTreeSet<&&str> = names.iter().collect();
        assert!(names.len() > joints.len() && different.len() == names.len(), "{kind}: {names:?}");
        assert!(kind != "body" || !names.contains(&"world"), "{names:?}");
    }
    steps(&out.join("arm.xml"));
    let (record, out) = export(folder.path(), &arm, &["urdf"]);
    let robot = urdf_rs::read_from_string(&text(&out, "arm.urdf")).expect("a URDF");
    let links = robot.links.iter().map(|link| link.name.clone());
    let names: Vec<String> = links.chain(robot.joints.iter().map(|joint| joint.name.clone())).collect();
    assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), names.len(), "{names:?}");
    assert!(notes(&record).contains("tip_link_link"), "{record}");
    // it comes back with the joints that it had
    let [file, back] = ["urdf/arm.urdf", "back"].map(|name| folder.path().join(name).display().to_string());
    let output = armwright(&["import", &file, "--tip", "tip_link_link", "--out", &back]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let import: Value =
        serde_json::from_str(&text(&folder.path().join("back"), "import.json")).expect("JSON");
    let back: Vec<&str> =
        import["joints"].as_array().expect("joints").iter().filter_map(|j| j["name"].as_str()).collect();
    assert_eq!(back, joints);
}

#[test]
fn a_body_with_inertia_and_no_mass_is_in_the_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let inertia = json!([[0.05, 0, 0], [0, 0.05, 0], [0, 0, 0.05]]);
    let arm = json!({"name": "wheel", "chain": [
        {"type": "joint", "name": "lift", "axis": [0, 1, 0], "stiffness_nm_per_rad": 2e4, "mass_kg": 1},
        {"type": "link", "name": "a", "vector_m": [0.3, 0, 0], "mass_kg": 1},
        {"type": "joint", "name": "roll", "axis": [1, 0, 0], "stiffness_nm_per_rad": 5e3},
        {"type": "link", "name": "b", "vector_m": [0.2, 0, 0], "bodies": [{"mass_kg": 0, "inertia_kgm2": inertia}]}]});
    let (_, out) = export(folder.path(), &arm, &["urdf"]);
    let robot = urdf_rs::read_from_string(&text(&out, "arm.urdf")).expect("a URDF");
    let roll = robot.links.iter().find(|link| link.name == "roll_link").expect("the link");
    close(roll.inertial.inertia.ixx, 0.05, 1e-12);
    assert!(roll.inertial.mass.value > 0.0 && roll.inertial.mass.value < 1e-6);
    let (record, out) = export(folder.path(), &arm, &["calculix"]);
    let roll_hz = (5e3f64 / 0.05).sqrt() / std::f64::consts::TAU;
    let expected = record["expected"]["frequencies_hz"].as_array().expect("frequencies");
    close(number(&expected[0]), roll_hz, 1e-9);
    assert!(record["left_out"] == json!([]) && text(&out, "static.inp").matches("TYPE=MASS").count() == 8);
    let Some(found) = ccx_frequencies(&out) else { return eprintln!("SKIPPED: no ccx on the PATH") };
    // the far point masses have 2 g, and the springs that hold them to the ground 0.6 N m/rad
    for (found, expected) in found.iter().zip(expected) {
        close(*found, number(expected), 2e-3);
    }
}

#[test]
fn an_arm_of_grams_keeps_its_inertia() {
    let folder = tempfile::tempdir().expect("a folder");
    let arm = json!({"name": "grams", "chain": [
        {"type": "joint", "name": "a", "axis": [0, 1, 0], "stiffness_nm_per_rad": 0.3},
        {"type": "link", "name": "l", "vector_m": [0.01, 0, 0],
         "bodies": [{"mass_kg": 2e-4, "inertia_kgm2": [[1e-9, 0, 0], [0, 2e-9, 0], [0, 0, 1.5e-9]]}]}]});
    let (_, out) = export(folder.path(), &arm, &["mjcf"]);
    let xml = text(&out, "arm.xml");
    let after = xml.split("fullinertia=\"").nth(2).expect("the second body");
    let moments: Vec<f64> =
        after.split(['"', ' ']).take(3).map(|number| number.parse().expect("a number")).collect();
    for (found, stated) in moments.iter().zip([1e-9, 2e-9, 1.5e-9]) {
        close(*found, stated, 1e-3);
    }
}

#[test]
fn gravity_that_a_urdf_cannot_state_is_noted() {
    let folder = tempfile::tempdir().expect("a folder");
    let (record, _) = export(folder.path(), &lever(), &["urdf"]);
    assert!(!notes(&record).contains("gravity"), "{record}");
    let mut moon = lever();
    moon["gravity_m_s2"] = json!(1.62);
    let (record, _) = export(folder.path(), &moon, &["urdf"]);
    assert!(notes(&record).contains("0 0 -1.62 m/s2"), "{record}");
}

#[test]
fn masses_of_effects_and_what_tables_lack_are_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut arm = balanced_lever();
    arm["effects"] = json!([{"effect": "extra_mass", "at": "j", "parameters": {"delta_kg": 2}}]);
    for form in ["mjcf", "bom", "csv"] {
        let (record, _) = export(folder.path(), &arm, &[form]);
        close(number(&record["mass_kg"]), 10.0, 1e-12);
        close(number(&record["effects_mass_kg"]), 2.0, 1e-12);
        let said = notes(&record);
        assert!(form == "csv" || said.contains("2 kg"), "{form}: {said}");
        assert!(
            form == "mjcf" || (said.contains("balancer") && said.contains("extra_mass at j")),
            "{form}: {said}"
        );
    }
    let (record, _) = export(folder.path(), &lever(), &["csv"]);
    assert_eq!(record["notes"], json!([]));
}

#[test]
fn a_bill_knows_motors_that_sit_elsewhere_and_materials_with_factors() {
    let folder = tempfile::tempdir().expect("a folder");
    let tube = json!({"shape": "rectangular_tube", "width_m": 0.08, "height_m": 0.08, "wall_m": 0.004});
    let arm = json!({"name": "belt", "chain": [
        {"type": "joint", "name": "a", "axis": [0, 1, 0], "gear": "CSG-32-100", "motor": "ILM85x23"},
        {"type": "link", "name": "upper", "vector_m": [0.4, 0, 0], "material": "Structural steel S355", "section": tube,
         "stiffness_factor": 0.9, "mass_factor": 0.95},
        {"type": "joint", "name": "c", "axis": [0, 1, 0], "gear": "CSG-25-100", "motor": "ILM70x18", "motor_at": "base",
         "transmission": [{"ratio": 2, "mass_kg": 0.5}]},
        {"type": "link", "name": "fore", "vector_m": [0.3, 0, 0], "mass_kg": 1}]});
    let (record, out) = export(folder.path(), &arm, &["bom"]);
    let mut table = csv::Reader::from_path(out.join("bom.csv")).expect("a table");
    let rows: Vec<csv::StringRecord> = table.records().map(|row| row.expect("a row")).collect();
    let row = |part: &str| {
        rows.iter().find(|row| row[2].starts_with(part)).unwrap_or_else(|| panic!("{part} in {rows:#?}"))
    };
    let motor = row("ILM70x18");
    assert_eq!((&motor[3], &motor[4], &motor[9]), ("motor", "0.34", "c"));
    assert!(motor[6].len() > 10 && &motor[7] != "stated", "{motor:?}");
    let gear = row("CSG-25-100");
    assert!(&gear[3] == "gear" && !gear[2].contains('+'), "{gear:?}");
    let steel = row("tube");
    assert!(steel[6].len() > 10 && &steel[7] != "stated" && !steel[8].is_empty(), "{steel:?}");
    let mass_kg: f64 = rows.iter().map(|row| row[4].parse::<f64>().expect("kg")).sum();
    close(mass_kg, number(&record["mass_kg"]), 1e-12);
}

#[test]
fn check_and_schema_know_the_files_of_imports_and_exports() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name).display().to_string();
    for form in ["urdf", "bom", "csv", "json"] {
        export(folder.path(), &lever(), &[form]);
    }
    let output = armwright(&["import", &at("urdf/arm.urdf"), "--tip", "tip", "--out", &at("back")]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    fs::write(at("limits.json"), json!({"joints": [{"name": "j", "max_torque_nm": 90}]}).to_string())
        .expect("written");
    let kinds = [
        ("urdf/export.json", "export"),
        ("urdf/stiffness.json", "stiffness of an import"),
        ("urdf/arm.urdf", "robot"),
        ("bom/bom.csv", "bill of materials"),
        ("csv/design.csv", "design table"),
        ("back/import.json", "import"),
        ("back/stiffness.json", "stiffness of an import"),
        ("limits.json", "limits of joints"),
        ("urdf", "export"),
        ("back", "arm"),
    ];
    for (name, kind) in kinds {
        let output = armwright(&["check", &at(name), "--json"]);
        let found: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert_eq!(
            (&found[0]["kind"], &found[0]["state"]),
            (&json!(kind), &json!("sound")),
            "{name}: {found}"
        );
    }
    // a joint that the arm does not have, and a record that lacks a key
    fs::write(at("back/stiffness.json"), json!({"joints": {"k": {"stiffness_nm_per_rad": 1}}}).to_string())
        .expect("written");
    fs::write(at("export.json"), json!({"to": "urdf", "files": [], "left_out": [], "notes": []}).to_string())
        .expect("written");
    for (name, fault) in
        [("back/stiffness.json", "\"k\" is no moving joint"), ("export.json", "without arm, mass_kg")]
    {
        let output = armwright(&["check", &at(name)]);
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.code() == Some(3) && said.contains(fault), "{said}");
    }
    // the schemas take what the program writes
    for (kind, file) in
        [("stiffness", "urdf/stiffness.json"), ("import", "back/import.json"), ("limits", "back/import.json")]
    {
        let schema: Value = serde_json::from_slice(&armwright(&["schema", kind]).stdout).expect("JSON");
        let (mut schemas, mut compiler) = (boon::Schemas::new(), boon::Compiler::new());
        compiler.add_resource("http://localhost/x.json", schema).expect("a resource");
        let root = compiler.compile("http://localhost/x.json", &mut schemas).expect("a schema");
        let value = serde_json::from_str(&text(folder.path(), file)).expect("JSON");
        schemas.validate(&value, root).unwrap_or_else(|e| panic!("{kind}: {e:#}"));
    }
    let script = armwright(&["completions", "bash"]).stdout;
    let script = String::from_utf8_lossy(&script).into_owned();
    for words in ["calculix mjcf urdf json csv bom", "rigid bending full", "stiffness limits"] {
        assert!(script.contains(words), "{words} are not proposed");
    }
}
