//! Import of robots from URDF files, and export of arms and designs to other programs. The arm must be mechanically the
//! same on both sides.
//!
//! `tests/data/urdf` has five public robots that were written from published figures, and an invented one with
//! everything that a URDF file may have in addition to a plain chain. `simulators.rs` compares with CalculiX and
//! MuJoCo.

use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The robots and their tips.
pub(crate) const ROBOTS: [(&str, &str); 6] = [
    ("ur5e", "tool0"),
    ("ur10e", "tool0"),
    ("panda", "panda_hand_tcp"),
    ("iiwa14", "tool0"),
    ("irb120", "tool0"),
    ("mixed", "flange"),
];

/// Poses in which the torques of a robot are compared.
const POSES: usize = 50;

pub(crate) fn project() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

pub(crate) fn urdf(name: &str) -> PathBuf {
    project().join(format!("tests/data/urdf/{name}.urdf"))
}

fn armwright(words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_armwright")).args(words).output().expect("it runs")
}

fn done(words: &[&str]) -> String {
    let output = armwright(words);
    assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

fn read(path: impl AsRef<Path>) -> Value {
    let text =
        fs::read_to_string(path.as_ref()).unwrap_or_else(|e| panic!("{}: {e}", path.as_ref().display()));
    serde_json::from_str(&text).expect("JSON")
}

fn write(path: &Path, value: &Value) -> String {
    fs::write(path, value.to_string()).expect("written");
    path.display().to_string()
}

/// Numbers from -1 to 1 that are the same everywhere.
fn numbers() -> impl FnMut() -> f64 {
    let mut state = 12345u64;
    move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// The torques of gravity on the joints of a robot, from its file alone: every link is placed by the joints above it, and a joint
/// holds the weight of everything that it moves. `angles` are those of the joints that an arm to the tip has; others stand at zero.
fn torques_nm(robot: &urdf_rs::Robot, angles: &BTreeMap<String, f64>) -> BTreeMap<String, f64> {
    let place = |pose: &urdf_rs::Pose| {
        let [roll, pitch, yaw] = pose.rpy.0;
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw)
            * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), pitch)
            * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), roll);
        Isometry3::from_parts(Translation3::from(Vector3::from(pose.xyz.0)), turn)
    };
    // angle of a joint, and its slope with respect to each joint of `angles`
    fn angle(
        robot: &urdf_rs::Robot,
        name: &str,
        angles: &BTreeMap<String, f64>,
    ) -> (f64, BTreeMap<String, f64>) {
        let joint = robot.joints.iter().find(|j| j.name == name).expect("a joint");
        if let Some(mimic) = &joint.mimic {
            let factor = mimic.multiplier.unwrap_or(1.0);
            let (value, slopes) = angle(robot, &mimic.joint, angles);
            let slopes = slopes.into_iter().map(|(n, s)| (n, factor * s)).collect();
            return (factor * value + mimic.offset.unwrap_or(0.0), slopes);
        }
        match angles.get(name) {
            Some(value) => (*value, BTreeMap::from([(name.to_string(), 1.0)])),
            None => (0.0, BTreeMap::new()),
        }
    }
    let mut out: BTreeMap<String, f64> = angles.keys().map(|name| (name.clone(), 0.0)).collect();
    for link in &robot.links {
        // the joints above the link, from the root
        let mut above = Vec::new();
        let mut at = link.name.as_str();
        while let Some(joint) = robot.joints.iter().find(|j| j.child.link == at) {
            above.push(joint);
            at = &joint.parent.link;
        }
        let mut frame = Isometry3::identity();
        let mut axes = Vec::new();
        for joint in above.iter().rev() {
            frame *= place(&joint.origin);
            let axis = Unit::new_normalize(Vector3::from(joint.axis.xyz.0));
            let turns =
                matches!(joint.joint_type, urdf_rs::JointType::Revolute | urdf_rs::JointType::Continuous);
            if turns {
                let (value, slopes) = angle(robot, &joint.name, angles);
                axes.push((frame.rotation * axis.into_inner(), frame.translation.vector, slopes));
                frame *= UnitQuaternion::from_axis_angle(&axis, value);
            }
        }
        let centre = (frame * place(&link.inertial.origin)).translation.vector;
        let weight_n = Vector3::new(0.0, 0.0, -9.81 * link.inertial.mass.value);
        for (axis, at, slopes) in axes {
            for (joint, slope) in slopes {
                *out.get_mut(&joint).expect("a joint of the arm") +=
                    slope * axis.dot(&(centre - at).cross(&weight_n));
            }
        }
    }
    out
}

#[test]
fn imported_robots_have_the_torques_of_their_files() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, tip) in ROBOTS {
        let out = folder.path().join(name);
        let file = urdf(name).display().to_string();
        done(&["import", &file, "--tip", tip, "--out", &out.display().to_string()]);
        let report = read(out.join("import.json"));
        let joints: Vec<String> = report["joints"]
            .as_array()
            .expect("joints")
            .iter()
            .filter(|joint| joint["coupled"].is_null())
            .map(|joint| joint["name"].as_str().expect("a name").to_string())
            .collect();
        assert!(joints.len() >= 4, "{name}: {joints:?}");
        let mut random = numbers();
        let poses: Vec<Vec<f64>> =
            (0..POSES).map(|_| joints.iter().map(|_| 150.0 * random()).collect()).collect();
        let cases = json!(poses.iter().map(|pose| json!({"pose_deg": pose})).collect::<Vec<_>>());
        let cases = write(&out.join("cases.json"), &cases);
        let arm = out.join("arm.json").display().to_string();
        let found: Value =
            serde_json::from_str(&done(&["analyze", &arm, "--cases", &cases, "--json"])).expect("JSON");
        let robot = urdf_rs::read_file(urdf(name)).expect("a URDF");
        let whole: f64 = robot.links.iter().map(|link| link.inertial.mass.value).sum();
        assert!((report["mass_kg"].as_f64().expect("kg") / whole - 1.0).abs() < 1e-12, "{name}: mass");
        for (pose, found) in poses.iter().zip(found.as_array().expect("cases")) {
            let angles = joints.iter().cloned().zip(pose.iter().map(|deg| deg.to_radians())).collect();
            for (joint, nm) in torques_nm(&robot, &angles) {
                let ours = found["joint_torque_nm"][&joint].as_f64().expect("a torque");
                // both are sums of some hundred products of doubles
                assert!((ours - nm).abs() < 1e-9, "{name}, {joint}: {ours} and {nm} Nm");
            }
        }
    }
}

#[test]
fn what_an_import_lumps_guesses_and_leaves_rigid_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().display().to_string();
    let file = urdf("mixed").display().to_string();
    let said = done(&["import", &file, "--tip", "flange", "--out", &out]);
    assert!(said.contains("left rigid"), "{said}");
    let report = read(folder.path().join("import.json"));
    let names = |key: &str, field: &str| {
        let items = report[key].as_array().expect("a list").iter();
        items.map(|item| item[field].as_str().expect("a name").to_string()).collect::<Vec<_>>()
    };
    assert_eq!(names("joined", "joint"), ["stand", "arm_bolts", "follows_camera"]);
    assert_eq!(names("lumped", "link"), ["camera", "lens"]);
    assert_eq!(report["joints"][3]["coupled"], json!({"elbow": -0.8}));
    assert_eq!(report["joints"][4]["coupled"], json!({"elbow": -0.4}));
    let guessed = report["guessed"].to_string();
    for part in ["turn: continuous", "camera_tilt: beside the way to the tip, held at zero, which is outside"]
    {
        assert!(guessed.contains(part), "{part} in {guessed}");
    }
    // the stiffness file comes back filled in
    let stiffness = folder.path().join("stiffness.json");
    let mut given = read(&stiffness);
    given["joints"]["elbow"] = json!({"gear": "CSG-20-100", "motor": "ILM70x18", "bearing": null});
    given["joints"]["lift"] = json!({"stiffness_nm_per_rad": 2e4});
    let given = write(&stiffness, &given);
    done(&["import", &file, "--tip", "flange", "--stiffness", &given, "--out", &out]);
    let arm = read(folder.path().join("arm.json"));
    let elbow =
        arm["chain"].as_array().expect("a chain").iter().find(|e| e["name"] == "elbow").expect("the elbow");
    assert!(elbow["windup"]["k1_nm_per_rad"].as_f64().is_some_and(|k| k > 0.0));
    assert_eq!(elbow["mass_kg"], 0.0);
    let solved: Value =
        serde_json::from_str(&done(&["analyze", &format!("{out}/arm.json"), "--json"])).expect("JSON");
    assert!(solved["modes"][0]["frequency_hz"].as_f64().is_some_and(|hz| hz > 1.0));
}

#[test]
fn faults_of_an_import_are_said_with_what_to_try() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out").display().to_string();
    let fails = |words: &[&str], exit: i32, parts: &[&str]| {
        let output = armwright(words);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(exit), "{words:?}: {said}");
        for part in parts {
            assert!(said.contains(part), "{part} in {said}");
        }
    };
    let panda = urdf("panda").display().to_string();
    let tip = |tip: &'static str| ["import", &panda, "--tip", tip, "--out", &out].map(str::to_string);
    let words = tip("flange");
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    fails(&words, 3, &["\"flange\" is no link", "panda_link8", "panda_hand_tcp"]);
    let floating =
        fs::read_to_string(urdf("panda")).expect("a robot").replace("\"prismatic\"", "\"floating\"");
    let file = folder.path().join("floating.urdf").display().to_string();
    fs::write(&file, floating).expect("written");
    let words = ["import", &file, "--tip", "panda_leftfinger", "--out", &out];
    fails(&words, 3, &["panda_finger_joint1", "floating", "--tip"]);
    let given = write(
        &folder.path().join("given.json"),
        &json!({"joints": {"panda_joint9": {"stiffness_nm_per_rad": 1e4}, "panda_joint1": {"stiffness_nm_per_rad": -1}}}),
    );
    let words = ["import", &panda, "--tip", "panda_hand", "--stiffness", &given, "--out", &out];
    fails(
        &words,
        3,
        &["2 faults", "\"panda_joint9\" is no moving joint", "panda_joint1.stiffness_nm_per_rad"],
    );
    fails(&["import", "no.urdf", "--tip", "a", "--out", &out], 7, &["no.urdf"]);
    assert!(!folder.path().join("out").exists());
}

/// A rail along the world's y, and on it a quill that travels down with 3 kg, 0.2 m further along the rail.
const GANTRY: &str = r#"<robot name="gantry"><link name="base"/>
    <joint name="rail" type="prismatic"><parent link="base"/><child link="bridge"/><axis xyz="1 0 0"/>
        <origin xyz="0 0 1" rpy="0 0 1.5707963267948966"/><limit lower="-0.5" upper="1.5" effort="900" velocity="2"/></joint>
    <link name="bridge"><inertial><mass value="10"/>
        <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <joint name="quill" type="prismatic"><parent link="bridge"/><child link="tool"/><axis xyz="0 0 1"/>
        <origin xyz="0.2 0 0" rpy="3.141592653589793 0 0"/><limit lower="0" upper="0.3" effort="200" velocity="1"/></joint>
    <link name="tool"><inertial><mass value="3"/>
        <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"#;

#[test]
fn prismatic_joints_come_in_with_ranges_and_given_springs() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name).display().to_string();
    fs::write(at("gantry.urdf"), GANTRY).expect("written");
    let springs = json!({"joints": {"quill": {"stiffness_n_per_m": 1e6},
        "rail": {"stiffness_n_per_m": null, "guide": {"pitch_nm_per_rad": 1e5}}}});
    let given = write(&folder.path().join("given.json"), &springs);
    let words = ["import", &at("gantry.urdf"), "--tip", "tool", "--stiffness", &given, "--out", &at("arm")];
    done(&words);
    let import = read(folder.path().join("arm/import.json"));
    let rail = &import["joints"][0];
    assert_eq!((&rail["lower_mm"], &rail["upper_mm"]), (&json!(-500.0), &json!(1500.0)));
    assert_eq!((&rail["type"], &rail["max_force_n"]), (&json!("prismatic"), &json!(900.0)));
    let words = ["analyze", &at("arm/arm.json"), "--pose", "quill_mm=100,rail_mm=400", "--json"];
    let solved: Value = serde_json::from_str(&done(&words)).expect("JSON");
    let close = |a: &Value, b: f64| (a.as_f64().expect("a number") - b).abs() < 1e-12;
    // the quill holds the weight; the rail pitches under its moment, at 0.2 m beside and 0.1 m below
    let weight_n = 3.0 * 9.81;
    let tilt_rad = 0.2 * weight_n / 1e5;
    assert!((solved["joint_force_n"]["quill"].as_f64().expect("N") - weight_n).abs() < 1e-9, "{solved}");
    let tip_m = &solved["tip_displacement_m"];
    assert!(close(&tip_m[0], 0.0) && close(&tip_m[1], -0.1 * tilt_rad), "{tip_m}");
    assert!(close(&tip_m[2], -weight_n / 1e6 - 0.2 * tilt_rad), "{tip_m}");
}

/// A robot whose third joint slides.
pub(crate) const SCARA: (&str, &str) = ("irb910sc", "tool0");

#[test]
fn a_scara_comes_in_and_its_quill_alone_holds_weight() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name).display().to_string();
    let file = urdf(SCARA.0).display().to_string();
    done(&["import", &file, "--tip", SCARA.1, "--out", &at("rigid")]);
    // the file to fill in asks for the springs that each kind of joint has
    let mut given = read(folder.path().join("rigid/stiffness.json"));
    assert_eq!(given["joints"]["axis_3"], json!({"stiffness_n_per_m": null, "guide": {}}));
    let springs = json!({"stiffness_n_per_m": 4e5, "guide": {"roll_nm_per_rad": 4e3, "pitch_nm_per_rad": 9e3}, "moves": "ram"});
    given["joints"]["axis_3"] = springs;
    for (joint, nm_per_rad) in [("axis_1", 2e4), ("axis_2", 1e4)] {
        given["joints"][joint] = json!({"stiffness_nm_per_rad": nm_per_rad});
    }
    let given = write(&folder.path().join("given.json"), &given);
    let words = ["import", &file, "--tip", SCARA.1, "--stiffness", &given, "--out", &at("arm")];
    done(&words);
    assert!(
        (read(folder.path().join("arm/import.json"))["mass_kg"].as_f64().expect("kg") - 24.5).abs() < 1e-9
    );
    let pose = "axis_1_deg=40,axis_2_deg=-70,axis_3_mm=-120,axis_4_deg=30";
    let words = ["analyze", &at("arm/arm.json"), "--pose", pose, "--payload-kg", "3", "--json"];
    let solved: Value = serde_json::from_str(&done(&words)).expect("JSON");
    // what the quill holds: itself, the spindle and the payload; joints with vertical axes hold no weight
    let weight_n = 9.81 * (1.0 + 0.2 + 3.0);
    assert!((solved["joint_force_n"]["axis_3"].as_f64().expect("N") + weight_n).abs() < 1e-9, "{solved}");
    for joint in ["axis_1", "axis_2", "axis_4"] {
        assert!(solved["joint_torque_nm"][joint].as_f64().expect("Nm").abs() < 1e-9, "{solved}");
    }
    // the tip goes down by what the drive yields: the guide holds no moment but that of the spindle's small offset
    let down_m = solved["tip_displacement_m"][2].as_f64().expect("m");
    assert!((down_m + weight_n / 4e5).abs() < 1e-7, "{down_m}");
    // it goes out to a simulator and back
    done(&[
        "export",
        &at("arm/arm.json"),
        "--pose",
        pose,
        "--payload-kg",
        "3",
        "--to",
        "urdf",
        "--out",
        &at("out"),
    ]);
    let again = [
        "import",
        &at("out/arm.urdf"),
        "--tip",
        "tip",
        "--stiffness",
        &at("out/stiffness.json"),
        "--out",
        &at("back"),
    ];
    done(&again);
    let words = ["analyze", &at("back/arm.json"), "--pose", pose, "--payload-kg", "3", "--json"];
    let back: Value = serde_json::from_str(&done(&words)).expect("JSON");
    for axis in 0..3usize {
        let [a, b] = [&solved, &back].map(|value| value["tip_displacement_m"][axis].as_f64().expect("m"));
        assert!((a - b).abs() < 1e-12, "{a} and {b} m");
    }
    let hz = |value: &Value| value["modes"][0]["frequency_hz"].as_f64().expect("Hz");
    assert!((hz(&solved) / hz(&back) - 1.0).abs() < 1e-9, "{} and {} Hz", hz(&solved), hz(&back));
    let words = ["export", &at("arm/arm.json"), "--to", "calculix", "--out", &at("fe")];
    let output = armwright(&words);
    assert!(
        output.status.code() == Some(2) && String::from_utf8_lossy(&output.stderr).contains("axis_3"),
        "{output:?}"
    );
}

#[test]
fn the_capacity_of_an_imported_robot_takes_a_joint_to_its_limit() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().display().to_string();
    done(&["import", &urdf("ur5e").display().to_string(), "--tip", "tool0", "--out", &out]);
    let cases = json!([{"name": "out", "pose_deg": [0, 0, 0, 0, 0, 0]}, {"name": "bent", "pose_deg": [10, -70, 100, -30, 20, 0]}]);
    let cases = write(&folder.path().join("cases.json"), &cases);
    let arm = format!("{out}/arm.json");
    let found: Value =
        serde_json::from_str(&done(&["capacity", &arm, "--cases", &cases, "--json"])).expect("JSON");
    assert_eq!((found["pose"].as_str(), found["check"].as_str()), (Some("out"), Some("torque limit")));
    let payload_kg = found["payload_kg"].as_f64().expect("kg");
    assert!(payload_kg > 3.0 && payload_kg < 30.0, "{payload_kg}");
    let analyzed = done(&["analyze", &arm, "--payload-kg", &payload_kg.to_string(), "--json"]);
    let analyzed: Value = serde_json::from_str(&analyzed).expect("JSON");
    let joint = found["joint"].as_str().expect("a joint");
    let limit_nm = if joint.starts_with("wrist") { 28.0 } else { 150.0 };
    let torque_nm = analyzed["joint_torque_nm"][joint].as_f64().expect("Nm");
    assert!((torque_nm.abs() - limit_nm).abs() < 1e-9, "{joint}: {torque_nm} Nm");
    // the description of the IRB 120 has no torques
    let other = folder.path().join("irb120").display().to_string();
    done(&["import", &urdf("irb120").display().to_string(), "--tip", "tool0", "--out", &other]);
    let output = armwright(&["capacity", &format!("{other}/arm.json")]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("--limits"));
}

/// An arm with a curve, bearings, tubes, a body, extras, a coupled joint and effects.
fn arm() -> Value {
    json!({"name": "every kind", "materials": {"steel": {"youngs_modulus_pa": 2.1e11, "shear_modulus_pa": 8.1e10, "density_kg_m3": 7850}},
      "chain": [
        {"type": "joint", "name": "j1", "axis": [0, 0, 1], "gear": "CSG-32-100", "motor": "ILM85x23", "gear_mass": "housed_unit",
         "extras": {"housing_kg": 0.5, "brake_kg": 0.2}},
        {"type": "link", "name": "column", "vector_m": [0, 0, 0.3], "mass_kg": 2},
        {"type": "joint", "name": "j2", "axis": [0, 1, 0], "gear": "CSG-32-100", "motor": "ILM85x23", "gear_mass": "housed_unit"},
        {"type": "link", "name": "upper", "vector_m": [0.6, 0, 0], "material": "steel",
         "section": {"shape": "round_tube", "diameter_m": 0.1, "wall_m": 0.004},
         "bodies": [{"mass_kg": 0.8, "cg_m": [0.3, 0.05, 0], "inertia_kgm2": [[0.002, 0, 0], [0, 0.002, 0], [0, 0, 0.001]]}]},
        {"type": "joint", "name": "j3", "axis": [0, 1, 0], "stiffness_nm_per_rad": 4e4, "mass_kg": 3,
         "bearing": {"tilt_stiffness_nm_per_rad": 1e5, "mass_kg": 0.4}},
        {"type": "link", "name": "fore", "vector_m": [0.5, 0, 0], "material": "Structural steel S355",
         "section": {"shape": "rectangular_tube", "width_m": 0.08, "height_m": 0.08, "wall_m": 0.004}},
        {"type": "joint", "name": "level", "axis": [0, 1, 0], "stiffness_nm_per_rad": null, "mass_kg": 0.5, "coupled": {"j3": -1}},
        {"type": "link", "name": "hand", "vector_m": [0.1, 0, 0]}],
      "effects": [{"effect": "immersion", "at": "arm", "parameters": {"water_density_kg_m3": 1000, "added_mass_coefficient": 1}}]})
}

/// Exports the arm in a pose, and gives the folder's record.
fn exported(folder: &Path, form: &str, flags: &[&str]) -> Value {
    let file = write(&folder.join("arm.json"), &arm());
    let out = folder.join(form).display().to_string();
    let words =
        ["export", &file, "--pose-deg", "20,-30,70", "--payload-kg", "6", "--to", form, "--out", &out];
    done(&[words.as_slice(), flags].concat());
    read(folder.join(form).join("export.json"))
}

#[test]
fn a_bill_of_materials_weighs_what_the_arm_weighs() {
    let folder = tempfile::tempdir().expect("a folder");
    let record = exported(folder.path(), "bom", &[]);
    let mut table = csv::Reader::from_path(folder.path().join("bom/bom.csv")).expect("a table");
    let header: Vec<String> = table.headers().expect("a header").iter().map(String::from).collect();
    let first = ["item", "count", "part", "kind", "mass_kg", "length_m", "source", "confidence", "cost_eur"];
    assert_eq!(header[..9], first);
    let rows: Vec<csv::StringRecord> = table.records().map(|row| row.expect("a row")).collect();
    let mass_kg: f64 = rows.iter().map(|row| row[4].parse::<f64>().expect("kg")).sum();
    assert!((mass_kg - record["mass_kg"].as_f64().expect("kg")).abs() < 1e-12 * mass_kg, "{mass_kg}");
    let of = |kind: &str| rows.iter().filter(|row| &row[3] == kind).collect::<Vec<_>>();
    // the two equal gears are one row, and the motors another
    assert_eq!((of("gear").len(), &of("gear")[0][1], &of("gear")[0][9]), (1, "2", "j1 j2"));
    assert_eq!((of("motor").len(), &of("motor")[0][1]), (1, "2"));
    assert!(of("gear")[0][2].contains("CSG-32-100") && of("gear")[0][6].len() > 3);
    for kind in ["housing", "brake", "bearing", "drive", "offset", "link", "body"] {
        assert!(!of(kind).is_empty(), "no {kind}");
    }
    assert!(
        of("link").iter().any(|row| &row[5] == "0.5" && !row[8].is_empty()),
        "a link with length and cost"
    );
}

#[test]
fn what_is_left_out_and_what_stays_make_the_whole_deflection() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("arm.json").display().to_string();
    for (form, flags, left) in [
        ("mjcf", [].as_slice(), vec!["water", "link_compliance", "link_compliance"]),
        ("mjcf", ["--flexible", "4"].as_slice(), vec!["water"]),
        ("calculix", [].as_slice(), vec!["water"]),
    ] {
        let record = exported(folder.path(), form, flags);
        let words = ["analyze", &file, "--pose-deg", "20,-30,70", "--payload-kg", "6", "--json"];
        let whole: Value = serde_json::from_str(&done(&words)).expect("JSON");
        let vector =
            |value: &Value| Vector3::from_iterator((0..3).map(|i| value[i].as_f64().expect("a number")));
        let whole = vector(&whole["tip_displacement_m"]);
        let stays = vector(&record["expected"]["tip_displacement_m"]).dot(&whole) / whole.norm_squared();
        let items = record["left_out"].as_array().expect("a list");
        let kinds: Vec<&str> = items.iter().map(|item| item["what"].as_str().expect("a word")).collect();
        assert_eq!(kinds, left, "{form}");
        let shares: f64 = items.iter().map(|item| item["tip_share"].as_f64().expect("a share")).sum();
        assert!((stays + shares - 1.0).abs() < 1e-9, "{form}: {stays} and {shares}");
        assert!(shares.abs() > 1e-3, "{form}: something was left out");
    }
}

/// A motor at the base and a belt of ratio 1 without a gear: while the motor stands, the forearm stays level. A file of MuJoCo has
/// no such motor.
#[test]
fn a_joint_that_turns_with_others_is_left_out_by_name_with_its_share() {
    let folder = tempfile::tempdir().expect("a folder");
    let joint =
        |name: &str| json!({"type": "joint", "name": name, "axis": [0, 1, 0], "stiffness_nm_per_rad": 5e4});
    let link = |name: &str| json!({"type": "link", "name": name, "vector_m": [0.4, 0, 0], "mass_kg": 2});
    let mut elbow = joint("elbow");
    elbow["turns_with"] = json!({"shoulder": -1});
    let arm = json!({"name": "level", "chain": [joint("shoulder"), link("upper"), elbow, link("fore")]});
    let file = write(&folder.path().join("arm.json"), &arm);
    for form in ["mjcf", "urdf"] {
        let out = folder.path().join(form).display().to_string();
        done(&["export", &file, "--to", form, "--out", &out]);
        let record = read(Path::new(&out).join("export.json"));
        let items = record["left_out"].as_array().expect("a list");
        let item = items.iter().find(|item| item["what"] == "turns_with").expect("it is named");
        assert_eq!(item["at"], "elbow");
        assert!(item["tip_share"].as_f64().expect("a share").abs() > 0.01, "{item}");
    }
}

#[test]
fn an_arm_that_goes_out_as_urdf_comes_back_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut dry = arm();
    dry["effects"] = json!([]);
    let file = write(&folder.path().join("dry.json"), &dry);
    let back = folder.path().join("back");
    let out = folder.path().join("out").display().to_string();
    let into = back.display().to_string();
    done(&["export", &file, "--to", "urdf", "--out", &out]);
    let (urdf, stiffness) = (format!("{out}/arm.urdf"), format!("{out}/stiffness.json"));
    done(&["import", &urdf, "--tip", "tip", "--stiffness", &stiffness, "--out", &into]);
    let again = back.join("arm.json").display().to_string();
    let mut random = numbers();
    for _ in 0..5 {
        let pose = [0; 3].map(|_| format!("{}", 150.0 * random())).join(",");
        let solve = |file: &str| -> Value {
            let words =
                ["analyze", file, "--pose-deg", &pose, "--payload-kg", "6", "--links", "rigid", "--json"];
            serde_json::from_str(&done(&words)).expect("JSON")
        };
        let (before, after) = (solve(&file), solve(&again));
        for joint in ["j1", "j2", "j3"] {
            let nm = |value: &Value| value["joint_torque_nm"][joint].as_f64().expect("Nm");
            assert!((nm(&before) - nm(&after)).abs() < 1e-9, "{joint}: {} {}", nm(&before), nm(&after));
        }
        let modes = |value: &Value| {
            let modes = value["modes"].as_array().expect("modes").iter();
            modes.map(|mode| mode["frequency_hz"].as_f64().expect("Hz")).collect::<Vec<_>>()
        };
        let (before, after) = (modes(&before), modes(&after));
        assert_eq!(before.len(), after.len());
        for (a, b) in before.iter().zip(&after) {
            assert!((a / b - 1.0).abs() < 1e-9, "{a} {b} Hz");
        }
    }
}

#[test]
fn exports_have_the_same_bytes_and_refuse_what_they_cannot() {
    let folder = tempfile::tempdir().expect("a folder");
    for form in ["calculix", "mjcf", "urdf", "json", "csv", "bom"] {
        let bytes = || {
            let record = exported(folder.path(), form, &[]);
            let names = record["files"].as_array().expect("files").iter();
            let file = |name: &Value| {
                fs::read(folder.path().join(form).join(name.as_str().expect("a name"))).expect("a file")
            };
            names.map(file).collect::<Vec<_>>()
        };
        let first = bytes();
        assert!(!first.is_empty() && first.iter().all(|file| !file.is_empty()));
        assert_eq!(first, bytes(), "{form}");
    }
    let file = folder.path().join("arm.json").display().to_string();
    let out = folder.path().join("x").display().to_string();
    for (words, exit, part) in [
        (vec!["--to", "step"], 2, "calculix, mjcf, urdf"),
        (vec!["--to", "urdf", "--flexible", "4"], 2, "are for mjcf"),
        (vec!["--to", "mjcf", "--pose-deg", "1,2"], 2, "3 driven joints: j1, j2, j3"),
        (vec!["--to", "mjcf", "--case", "up"], 2, "the cases are: case"),
    ] {
        let output = armwright(&[["export", &file, "--out", &out].as_slice(), words.as_slice()].concat());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(exit), "{words:?}: {said}");
        assert!(said.contains(part), "{part} in {said}");
    }
    let output = armwright(&["export", "results/none#abc", "--to", "bom", "--out", &out]);
    assert_eq!(output.status.code(), Some(7), "{}", String::from_utf8_lossy(&output.stderr));
}
