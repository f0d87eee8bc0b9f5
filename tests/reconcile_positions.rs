//! Absolute positions of a real robot: a Motoman MA1400 on a turntable, measured by laser tracker.
//!
//! The measurements may not be redistributed: the folder that holds them is named by the environment
//! variable ARMWRIGHT_MEASURED, and the test says aloud when it is skipped.

use armwright::catalog::Catalogs;
use armwright::reconcile::Campaign;
use armwright::reconcile::positions::analyze;
use nalgebra::{Matrix4, Rotation3, Translation3, Vector3};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// a [m], d [m], alpha [deg], theta [deg], joint, mass of the body it moves [kg].
const MOTOMAN: [(f64, f64, f64, f64, &str, f64); 7] = [
    (0.0, -0.263, 15.0, -90.0, "E", 60.0),
    (0.15, 1.4159, -90.0, 0.0, "S", 45.0),
    (0.614, 0.0, 180.0, -90.0, "L", 25.0),
    (0.2, 0.0, -90.0, 0.0, "U", 25.0),
    (0.0, -0.64, 90.0, 0.0, "R", 20.0),
    (0.03, 0.0, 90.0, -90.0, "B", 5.0),
    (0.0, 0.2, 0.0, 0.0, "T", 3.0),
];
const TOOL: (f64, f64, f64) = (0.045, 0.245, -0.38);

fn turn(axis: nalgebra::Unit<Vector3<f64>>, angle: f64) -> Matrix4<f64> {
    Rotation3::from_axis_angle(&axis, angle).to_homogeneous()
}

/// Axes and origins of a standard DH table at q = 0, as a chain.
fn arm() -> Value {
    let shift = |x: f64, z: f64| Translation3::new(x, 0.0, z).to_homogeneous();
    let mut frame = Matrix4::identity();
    let mut chain = Vec::new();
    let at = |m: &Matrix4<f64>| m.fixed_view::<3, 1>(0, 3).into_owned();
    for (a, d, alpha, theta, name, mass) in MOTOMAN {
        let axis = frame.fixed_view::<3, 1>(0, 2).into_owned();
        chain.push(
            json!({"type": "joint", "name": name, "axis": axis.as_slice(), "stiffness_nm_per_rad": null}),
        );
        let next = frame
            * turn(Vector3::z_axis(), theta.to_radians())
            * shift(0.0, d)
            * shift(a, 0.0)
            * turn(Vector3::x_axis(), alpha.to_radians());
        let vector = at(&next) - at(&frame);
        chain.push(json!({"type": "link", "name": format!("after_{name}"), "vector_m": vector.as_slice(), "mass_kg": mass}));
        frame = next;
    }
    let end = frame * turn(Vector3::z_axis(), TOOL.2) * shift(TOOL.0, TOOL.1);
    let vector = at(&end) - at(&frame);
    chain.push(json!({"type": "link", "name": "tool", "vector_m": vector.as_slice(), "mass_kg": 2.0}));
    json!({"name": "motoman-ma1400", "chain": chain})
}

fn campaign(source: &Path, folder: &Path) {
    let text = std::fs::read_to_string(source).expect("measurements");
    let mut rows = String::from(
        "test,q_E_deg,q_S_deg,q_L_deg,q_U_deg,q_R_deg,q_B_deg,q_T_deg,point,x_mm,y_mm,z_mm,sigma_mm\n",
    );
    for line in text.lines().skip(1) {
        let cells: Vec<f64> = line.split(',').map(|c| c.parse().expect("number")).collect();
        let angles: Vec<String> = cells[1..8].iter().map(|q| q.to_degrees().to_string()).collect();
        let at: Vec<String> = cells[8..11].iter().map(|x| (1e3 * x).to_string()).collect();
        rows.push_str(&format!("{},{},reflector,{},0.008\n", cells[0], angles.join(","), at.join(",")));
    }
    std::fs::write(folder.join("positions.csv"), rows).expect("written");
    std::fs::write(folder.join("arm.json"), arm().to_string()).expect("written");
    let free = json!({"base_placement": true, "tool_offset": true, "joint_offsets": true, "geometry": true});
    let statement = json!({"name": "motoman", "positions": free});
    std::fs::write(folder.join("campaign.json"), statement.to_string()).expect("written");
}

#[test]
fn the_motoman_bends_in_its_joints_and_across_them() {
    let Some(measured) = std::env::var_os("ARMWRIGHT_MEASURED").map(PathBuf::from) else {
        eprintln!(
            "SKIPPED: set ARMWRIGHT_MEASURED to the folder that holds motoman_ma1400/poses_fit_352.csv"
        );
        return;
    };
    let folder = tempfile::tempdir().expect("temporary folder");
    campaign(&measured.join("motoman_ma1400/poses_fit_352.csv"), folder.path());
    let campaign = Campaign::read(folder.path(), &Catalogs::default()).expect("sound");
    let found = analyze(&campaign);
    println!("{:<28} {:>7} {:>7} {:>7}  [mm]", "added", "fitted", "median", "mean");
    for s in &found.stages {
        println!("{:<28} {:>7.3} {:>7.3} {:>7.3}", s.added, s.fitted_median_mm, s.median_mm, s.mean_mm);
    }
    println!("gross errors: {:?}", found.gross);
    let median = |word: &str| {
        let stage = found.stages.iter().rev().find(|s| s.added.contains(word)).expect("stage");
        stage.median_mm
    };
    assert!(median("geometry") < 1.6);
    assert!(median("joint_compliance") < 0.68);
    assert!(found.stages.last().expect("stages").median_mm < 0.58);
}
