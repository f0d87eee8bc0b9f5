//! Campaign of DLR Agile Justin: two arms of seven joints on a torso of four joints, one of which is passive. Ceiling
//! cameras measured the position of a marker on each hand in 300 poses.
//!
//! Data: github.com/aidx-lab/2021-humanoids-elastic (Tenhumberg, Baeuml, Calibration of an Elastic Humanoid Upper Body
//! and Efficient Compensation for Motion Planning, Humanoids 2021, arXiv 2311.08333). Kinematics and masses are from
//! the authors' public code. The frames between chest and shoulders are not published, so the position and attitude of
//! each arm on the chest are left free (`mounts`).

use super::frames::Walk;
use super::{read_numbers, write};
use serde_json::{Value, json};
use std::io;
use std::path::Path;

/// One row of the table of modified Denavit-Hartenberg parameters, with mass and centre of gravity of the body that it
/// moves.
struct Row {
    d_m: f64,
    theta_deg: f64,
    r_m: f64,
    alpha_deg: f64,
    mass_kg: f64,
    cg_mm: [f64; 3],
}

const fn row(d_m: f64, theta_deg: f64, r_m: f64, alpha_deg: f64, mass_kg: f64, cg_mm: [f64; 3]) -> Row {
    Row { d_m, theta_deg, r_m, alpha_deg, mass_kg, cg_mm }
}

const TORSO: [Row; 4] = [
    row(0.1055, 0.0, 0.0, 0.0, 4.651, [1.33, 15.39, 7.43]),
    row(0.0, -90.0, 0.0, -90.0, 5.470, [218.59, -13.02, 6.22]),
    row(0.0, 0.0, 0.3, 0.0, 2.925, [153.20, -22.72, 1.93]),
    row(0.0, 0.0, 0.3, 0.0, 5.759, [53.67, 74.57, 0.68]),
];
const RIGHT: [Row; 7] = [
    row(0.0, 0.0, 0.0, 0.0, 2.637, [-0.41, 20.29, -45.94]),
    row(0.0, 0.0, 0.0, 90.0, 2.326, [-0.03, 114.07, 16.45]),
    row(0.4, -90.0, 0.0, -90.0, 2.239, [-0.03, 16.51, -113.29]),
    row(0.0, 0.0, 0.0, 90.0, 2.204, [-0.03, 113.74, 16.37]),
    row(0.39, -180.0, 0.0, -90.0, 1.101, [0.11, 21.90, -105.62]),
    row(0.0, 90.0, 0.0, 90.0, 1.641, [0.50, -7.85, -8.71]),
    row(0.0, -90.0, 0.0, 90.0, 0.675, [29.08, 78.11, 19.58]),
];
const LEFT: [Row; 7] = [
    row(0.0, 0.0, 0.0, 180.0, 2.637, [0.41, -20.29, 45.94]),
    row(0.0, 0.0, 0.0, 90.0, 2.326, [0.03, -114.07, 16.45]),
    row(-0.4, -90.0, 0.0, -90.0, 2.239, [0.03, -16.51, 113.29]),
    row(0.0, 0.0, 0.0, 90.0, 2.204, [-0.03, -113.74, -16.37]),
    row(-0.39, 0.0, 0.0, -90.0, 1.101, [-0.11, 21.90, 105.62]),
    row(0.0, 90.0, 0.0, -90.0, 1.641, [0.50, -7.85, 8.71]),
    row(0.0, -90.0, 0.0, -90.0, 0.675, [29.08, 78.11, -19.58]),
];
/// The head, which is a guess: mass \[kg\], and centre of gravity in the frame of the chest \[m\].
const HEAD: (f64, [f64; 3]) = (3.0, [0.35, 0.0, 0.0]);
/// Mass of a hand \[kg\]. The hand is a point mass on the way from the wrist to the approximate position of the marker.
const HAND_KG: f64 = 2.0;
/// Vector from chest to shoulder \[m\], a first guess. The last component is negative for the right arm and positive
/// for the left arm.
const SHOULDER_M: [f64; 3] = [0.2, 0.0, 0.2];
/// Approximate repeatability of the cameras for each coordinate, as a standard deviation \[mm\].
const SIGMA_MM: f64 = 0.5;
/// Letters with which the names of the joints begin: of the torso, of the right arm and of the left arm.
const NAMES: [&str; 3] = ["t", "r", "l"];

/// Adds one row of the table to the chain: a rotation by alpha about x, a shift by r along x, the joint, a rotation by
/// theta about z, a shift by d along z, and the body.
fn body(walk: &mut Walk, row: &Row, name: &str, coupled: Option<Value>) {
    walk.turn_x(row.alpha_deg);
    walk.shift(row.r_m, 0.0, 0.0);
    walk.link(&format!("before_{name}"), 0.0);
    walk.joint(name, coupled);
    walk.turn_z(row.theta_deg);
    walk.shift(0.0, 0.0, row.d_m);
    walk.mass(&format!("body_{name}"), row.mass_kg, row.cg_mm.map(|c| c / 1e3));
}

fn arm(name: &str, prefix: &str, rows: &[Row; 7], side: f64, hand_m: [f64; 3]) -> Value {
    let mut walk = Walk::new();
    for (i, row) in TORSO.iter().enumerate() {
        // The linkage keeps the chest upright.
        let coupled = (i == 3).then(|| json!({"t1": -1.0, "t2": -1.0}));
        body(&mut walk, row, &format!("t{i}"), coupled);
    }
    walk.mass("head", HEAD.0, HEAD.1);
    walk.shift(SHOULDER_M[0], SHOULDER_M[1], side * SHOULDER_M[2]);
    walk.link(&format!("{name}_shoulder"), 0.0);
    for (i, row) in rows.iter().enumerate() {
        body(&mut walk, row, &format!("{prefix}{}", i + 1), None);
    }
    walk.mass(&format!("{name}_hand"), HAND_KG, hand_m);
    walk.link(&format!("{name}_wrist"), 0.0);
    json!({"name": name, "chain": walk.chain})
}

/// Writes the campaign folder. `data` is the file `poses_300.csv` with the columns: pose, 19 angles \[rad\], x, y, z of
/// the right marker, x, y, z of the left marker \[m\].
///
/// # Errors
/// An error if the data cannot be read or the folder cannot be written.
pub fn campaign(data: &Path, folder: &Path) -> io::Result<()> {
    let joints: Vec<String> = (0..3)
        .map(|i| format!("q_{}{i}_deg", NAMES[0]))
        .chain(NAMES[1..].iter().flat_map(|p| (1..=7).map(move |i| format!("q_{p}{i}_deg"))))
        .collect();
    let mut positions = format!("test,{},arm,point,x_mm,y_mm,z_mm,sigma_mm\n", joints.join(","));
    for row in read_numbers(data)? {
        let angles: Vec<String> = row[1..18].iter().map(|q| q.to_degrees().to_string()).collect();
        for (name, at) in [("right", &row[20..23]), ("left", &row[23..26])] {
            let at: Vec<String> = at.iter().map(|x| (1e3 * x).to_string()).collect();
            positions.push_str(&format!(
                "{},{},{name},{name}_marker,{},{SIGMA_MM}\n",
                row[0],
                angles.join(","),
                at.join(",")
            ));
        }
    }
    let statement = json!({
        "name": "agile-justin",
        "arm": "right.json",
        "other_arms": ["left.json"],
        "positions": {
            "base_placement": true, "tool_offset": true, "joint_offsets": true, "geometry": true,
            "mounts": ["right_shoulder", "left_shoulder"],
        },
    });
    let right = arm("right", NAMES[1], &RIGHT, -1.0, [0.034, 0.091, 0.023]);
    let left = arm("left", NAMES[2], &LEFT, 1.0, [0.034, 0.091, -0.023]);
    write(
        folder,
        &[
            ("positions.csv", positions),
            ("right.json", right.to_string()),
            ("left.json", left.to_string()),
            ("campaign.json", statement.to_string()),
        ],
    )
}
