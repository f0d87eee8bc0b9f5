//! Laws without a name of what stands or hangs elsewhere than stated, against closed forms: the zero of an angle, a twist
//! under the torque of a neighbour or by play, a payload that slips, an instrument that moves. The arm has two joints that turn about
//! y, rigid links, and a point mass at its tip.

use armwright::arm::JointModel;
use armwright::catalog::Catalogs;
use armwright::reconcile::Campaign;
use armwright::reconcile::forward::Forward;
use armwright::reconcile::model::direct::Direct;
use serde_json::{Value, json};
use std::process::Command;

const K: [f64; 2] = [4e4, 1e4];
const LENGTH_M: [f64; 2] = [0.5, 0.4];
const PAYLOAD_KG: f64 = 6.0;
const GRAVITY: f64 = 9.81;
/// Poses of the rows, two rows each \[deg\].
const POSES: [[f64; 2]; 3] = [[10.0, 20.0], [-35.0, 50.0], [60.0, -80.0]];

/// What differs from the arm file, in one row.
#[derive(Clone, Copy, Default)]
struct Moved {
    zero_rad: [f64; 2],
    /// Of j1 per torque of j2, of j2 per torque of j1.
    neighbours: [f64; 2],
    /// Of j2: size and torque.
    play: [f64; 2],
    slip_m: [f64; 2],
    shift_mm: [f64; 2],
}

/// Vectors in the plane of the arm (x and z) from each joint to the tip, and the direction of the last link.
fn levers(pose_deg: [f64; 2], zero_rad: [f64; 2]) -> ([[f64; 2]; 2], [f64; 2]) {
    let first = pose_deg[0].to_radians() + zero_rad[0];
    let second = first + pose_deg[1].to_radians() + zero_rad[1];
    let along = |angle: f64, length: f64| [length * angle.cos(), -length * angle.sin()];
    let (upper, lower) = (along(first, LENGTH_M[0]), along(second, LENGTH_M[1]));
    ([[upper[0] + lower[0], upper[1] + lower[1]], lower], [second.cos(), -second.sin()])
}

/// Displacement of the tip along x and z under the payload \[mm\]. A turn about y by an angle moves a point at (x, z) by the
/// angle times (z, -x).
fn displacement_mm(pose_deg: [f64; 2], moved: Moved) -> [f64; 2] {
    let (levers, along) = levers(pose_deg, moved.zero_rad);
    // the last frame: its x along the link, its z across
    let further_m = moved.slip_m[0] * along[0] - moved.slip_m[1] * along[1];
    let torques = levers.map(|lever| PAYLOAD_KG * GRAVITY * (lever[0] + further_m));
    let [size_rad, torque_nm] = moved.play;
    let play_rad = if size_rad == 0.0 { 0.0 } else { size_rad * (torques[1] / torque_nm).tanh() };
    let twist = [
        torques[0] / K[0] + moved.neighbours[0] * torques[1],
        torques[1] / K[1] + moved.neighbours[1] * torques[0] + play_rad,
    ];
    let sum = |f: &dyn Fn(usize) -> f64| 1e3 * (f(0) + f(1));
    [
        sum(&|j| twist[j] * levers[j][1]) + moved.shift_mm[0],
        sum(&|j| -twist[j] * levers[j][0]) + moved.shift_mm[1],
    ]
}

/// The two frequencies of the arm with its payload \[Hz\]: those of `det(K - w M) = 0` with `M = m JᵀJ`.
fn frequencies_hz(pose_deg: [f64; 2], moved: Moved) -> [f64; 2] {
    let (levers, along) = levers(pose_deg, moved.zero_rad);
    let cg = |j: usize| {
        let across = [-along[1], along[0]];
        [0, 1].map(|c| levers[j][c] + moved.slip_m[0] * along[c] + moved.slip_m[1] * across[c])
    };
    let dot = |a: [f64; 2], b: [f64; 2]| PAYLOAD_KG * (a[0] * b[0] + a[1] * b[1]);
    let (m11, m12, m22) = (dot(cg(0), cg(0)), dot(cg(0), cg(1)), dot(cg(1), cg(1)));
    let (a, b, c) = (m11 * m22 - m12 * m12, -(K[0] * m22 + K[1] * m11), K[0] * K[1]);
    let root = (b * b - 4.0 * a * c).sqrt();
    [-b - root, -b + root].map(|twice| (twice / (2.0 * a)).sqrt() / std::f64::consts::TAU)
}

/// The campaign of the arm with the law `law` in its file.
fn campaign(law: &Value) -> (tempfile::TempDir, Campaign) {
    let joint = |name: &str, k: f64| json!({"type": "joint", "name": name, "axis": [0, 1, 0], "stiffness_nm_per_rad": k});
    let link = |name: &str, l: f64| json!({"type": "link", "name": name, "vector_m": [l, 0, 0]});
    let arm = json!({"name": "two", "gravity_m_s2": GRAVITY, "effects": [law], "chain": [
        joint("j1", K[0]), link("upper", LENGTH_M[0]), joint("j2", K[1]), link("lower", LENGTH_M[1])]});
    let mut statics = String::from("q_j1_deg,q_j2_deg,payload_kg,dx_mm,dy_mm,dz_mm,sigma_mm\n");
    let mut modal = String::from("q_j1_deg,q_j2_deg,payload_kg,mode,frequency_hz,sigma_hz\n");
    for (i, [a, b]) in POSES.into_iter().enumerate() {
        for row in 0..2 {
            statics +=
                &format!("{a},{b},{PAYLOAD_KG},{},0.1,-0.{}7,0.01\n", 0.1 * (i + 1) as f64, row + 2 * i + 1);
            modal += &format!("{a},{b},{PAYLOAD_KG},{},{},0.01\n", row + 1, 3 + 9 * row + i);
        }
    }
    let folder = tempfile::tempdir().expect("temporary folder");
    let tolerance = json!({"joint_stiffness": 0.1, "joint_mass": 0.02, "modulus": 0.03});
    let statement = json!({"arm": "arm.json", "links": "rigid", "tolerance": tolerance});
    let files = [
        ("arm.json", arm.to_string()),
        ("campaign.json", statement.to_string()),
        ("static.csv", statics),
        ("modal.csv", modal),
    ];
    files
        .into_iter()
        .for_each(|(name, text)| std::fs::write(folder.path().join(name), text).expect("written"));
    let campaign = Campaign::read(folder.path(), &Catalogs::default()).expect("sound");
    (folder, campaign)
}

/// Compares mechanics, and the prepared model of an arm file with the law, with the closed forms. `moved` says what differs
/// in a row of the static and of the modal file.
fn is_closed_form(law: Value, moved: &dyn Fn(&str, usize) -> Moved) {
    let (_folder, campaign) = campaign(&law);
    let subject = campaign.arm.subject(JointModel::ThreeSegment);
    let (direct, forward) = (Direct::new(&subject), Forward::new(&campaign));
    let statics = direct.statics_mm(&campaign.statics);
    let modal = direct.frequencies_hz(&campaign.modal);
    let prepared = forward.predict(&forward.coefficients(&forward.nominal));
    let displacements = forward.displacements_mm(&forward.coefficients(&forward.nominal));
    for row in 0..2 * POSES.len() {
        let expected = displacement_mm(POSES[row / 2], moved("static", row));
        for own in [statics[row], displacements[row]] {
            let off = (own[0] - expected[0]).abs() + own[1].abs() + (own[2] - expected[1]).abs();
            assert!(off < 1e-10, "{law}, row {row}: {own:?} and {expected:?}");
        }
        // both modes of a list have the payload of its first row
        let expected = frequencies_hz(POSES[row / 2], moved("modal", row - row % 2))[row % 2];
        for own in [modal[row].expect("mode"), prepared[forward.starts[1] + row]] {
            assert!((own / expected - 1.0).abs() < 1e-9, "{law}, row {row}: {own} and {expected} Hz");
        }
    }
}

fn law(at: &str, parameters: Value) -> Value {
    json!({"effect": "empirical", "at": at, "parameters": parameters})
}

#[test]
fn an_arm_without_a_law_is_the_closed_form() {
    is_closed_form(law("j1", json!({})), &|_, _| Moved::default());
}

#[test]
fn the_zero_of_an_angle_puts_the_arm_into_another_pose() {
    let zero_rad = |joint: &str, rad: f64| law(joint, json!({"zero_rad": rad}));
    is_closed_form(zero_rad("j1", 0.04), &|_, _| Moved { zero_rad: [0.04, 0.0], ..Moved::default() });
    is_closed_form(zero_rad("j2", -0.07), &|_, _| Moved { zero_rad: [0.0, -0.07], ..Moved::default() });
}

#[test]
fn a_joint_twists_under_the_torques_of_its_neighbours_and_has_play_in_static_tests() {
    let twist =
        |joint: &str, rad_per_nm: [f64; 2]| law(joint, json!({"neighbour_twist_rad_per_nm": rad_per_nm}));
    let moved = |channel: &str, neighbours: [f64; 2]| match channel {
        "static" => Moved { neighbours, ..Moved::default() },
        _ => Moved::default(),
    };
    is_closed_form(twist("j1", [7e-6, 3e-6]), &|channel, _| moved(channel, [3e-6, 0.0]));
    is_closed_form(twist("j2", [-5e-6, 0.0]), &|channel, _| moved(channel, [0.0, -5e-6]));
    let play = law("j2", json!({"load_play_rad": 3e-4, "load_play_nm": 5.0}));
    is_closed_form(play, &|channel, _| match channel {
        "static" => Moved { play: [3e-4, 5.0], ..Moved::default() },
        _ => Moved::default(),
    });
}

#[test]
fn a_payload_slips_and_an_instrument_moves_in_the_file_in_which_it_happened() {
    let slip = |file: usize| {
        law(
            "payload",
            json!({"slip_m": [0.03, 0.0, -0.02], "static_slip_from_row": 4, "static_slip_file": file,
                "modal_slip_from_row": 3, "modal_slip_file": file}),
        )
    };
    let slipped = |happened: bool| match happened {
        true => Moved { slip_m: [0.03, -0.02], ..Moved::default() },
        false => Moved::default(),
    };
    is_closed_form(slip(0), &|channel, row| slipped(row >= if channel == "static" { 3 } else { 2 }));
    // in a file with another mark it did not happen
    is_closed_form(slip(7), &|_, _| slipped(false));
    let shift = |file: usize| {
        law("static", json!({"shift_mm": [0.2, 0.0, -0.3], "base_turn_from_row": 3, "base_turn_file": file}))
    };
    let shifted = |happened: bool| match happened {
        true => Moved { shift_mm: [0.2, -0.3], ..Moved::default() },
        false => Moved::default(),
    };
    is_closed_form(shift(0), &|_, row| shifted(row >= 2));
    is_closed_form(shift(5), &|_, _| shifted(false));
}

/// Runs the program and returns its exit code and everything that it said.
fn said(arguments: &[&str]) -> (i32, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_armwright")).args(arguments).output().expect("it runs");
    let text =
        [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
    (output.status.code().unwrap_or(-1), text)
}

#[test]
fn an_arm_file_with_these_laws_is_checked_analysed_and_predicts() {
    let (folder, _) =
        campaign(&law("j2", json!({"zero_rad": 0.05, "neighbour_twist_rad_per_nm": [1e-6, 0]})));
    let arm = folder.path().join("arm.json");
    let path = arm.to_str().expect("text");
    assert_eq!(said(&["check", path]).0, 0, "{}", said(&["check", path]).1);
    let (code, text) = said(&["analyze", path]);
    assert!(code == 0 && text.contains("empirical at j2"), "it says what it leaves out: {text}");
    let statics = folder.path().join("static.csv");
    let statement = folder.path().join("campaign.json");
    let [statics, statement] = [&statics, &statement].map(|path| path.to_str().expect("text"));
    let (code, table) = said(&["predict", path, statics, "--campaign", statement, "-q"]);
    let first = table.lines().nth(1).expect("a row").split(',').collect::<Vec<_>>();
    let expected = displacement_mm(
        POSES[0],
        Moved { zero_rad: [0.0, 0.05], neighbours: [0.0, 1e-6], ..Moved::default() },
    );
    let z_mm: f64 = first.last().expect("a cell").parse().expect("a number");
    assert!(code == 0 && (z_mm - expected[1]).abs() < 1e-6, "{table}");
    // a joint that others turn has no angle of its own
    let text = std::fs::read_to_string(&arm).expect("text");
    let mut coupled: Value = serde_json::from_str(&text).expect("JSON");
    coupled["chain"][2]["coupled"] = json!({"j1": -1});
    std::fs::write(&arm, coupled.to_string()).expect("written");
    let (code, text) = said(&["check", path]);
    assert!(code != 0 && text.contains("j2 has no angle of its own"), "{text}");
}
