//! Long campaigns of displacements: effects are sought in a part of the rows, and the model that is found is fitted to all.
//!
//! The readings are of an arm with two joints and rigid links, computed in closed form: each joint turns by its torque over its
//! stiffness, and the second one also tilts across its axis by the moment over the stiffness of its bearing.

use crate::generator::Dice;
use armwright::catalog::Catalogs;
use armwright::reconcile::{Campaign, Outcome, Verdict, reconcile};
use nalgebra::{Rotation3, Vector3};
use serde_json::json;

const ROWS: usize = 5_100;
const LOADS: usize = 5;
const SIGMA_MM: f64 = 0.01;
const K1_NM_PER_RAD: f64 = 60_000.0;
const K2_NM_PER_RAD: f64 = 20_000.0;
/// Stiffness of the bearing that the arm file lacks.
const TILT_NM_PER_RAD: f64 = 150_000.0;

/// Displacement of the tip under a force at the tip \[mm\].
fn displacement_mm(pose_deg: [f64; 2], force_n: Vector3<f64>) -> Vector3<f64> {
    let first = Rotation3::from_axis_angle(&Vector3::z_axis(), pose_deg[0].to_radians());
    let second = first * Rotation3::from_axis_angle(&Vector3::y_axis(), pose_deg[1].to_radians());
    let joint_m = first * Vector3::new(0.2, 0.0, 0.3);
    let arm_m = second * Vector3::new(0.6, 0.0, 0.0);
    let moment_nm = arm_m.cross(&force_n);
    let axis = first * Vector3::y();
    let about = axis * axis.dot(&moment_nm);
    let turned = about / K2_NM_PER_RAD + (moment_nm - about) / TILT_NM_PER_RAD;
    let tip_m = joint_m + arm_m;
    let base = Vector3::z() * (tip_m.cross(&force_n).z / K1_NM_PER_RAD);
    1e3 * (turned.cross(&arm_m) + base.cross(&tip_m))
}

/// The campaign with these readings. `read` is what the instrument makes of a displacement \[mm\].
fn campaign(read: &dyn Fn(f64) -> f64) -> Campaign {
    let mut dice = Dice(11);
    let mut text =
        "test,q_j1_deg,q_j2_deg,payload_kg,force_x_n,force_y_n,force_z_n,dx_mm,dy_mm,dz_mm,sigma_mm\n"
            .to_string();
    let mut pose_deg = [0.0; 2];
    for row in 0..ROWS {
        if row % LOADS == 0 {
            pose_deg = [dice.rounded(-150.0, 150.0, 1), dice.rounded(-80.0, 80.0, 1)];
        }
        let payload_kg = [2.0, 4.0, 0.0, 0.0, 0.0][row % LOADS];
        let pull = |dice: &mut Dice| if payload_kg > 0.0 { 0.0 } else { dice.rounded(-60.0, 60.0, 1) };
        let force_n = Vector3::from_fn(|_, _| pull(&mut dice));
        let d = displacement_mm(pose_deg, force_n - Vector3::z() * (9.81 * payload_kg));
        let [x, y, z] = [d.x, d.y, d.z].map(|d| read(d) + SIGMA_MM * dice.normal());
        let [q1, q2] = pose_deg;
        let [fx, fy, fz] = [force_n.x, force_n.y, force_n.z];
        text.push_str(&format!(
            "{},{q1},{q2},{payload_kg},{fx},{fy},{fz},{x:.4},{y:.4},{z:.4},{SIGMA_MM}\n",
            row + 1
        ));
    }
    let arm = json!({"name": "long", "gravity_m_s2": 9.81, "chain": [
        {"type": "joint", "name": "j1", "axis": [0, 0, 1], "stiffness_nm_per_rad": K1_NM_PER_RAD, "mass_kg": 1},
        {"type": "link", "name": "upper", "vector_m": [0.2, 0, 0.3], "mass_kg": 2},
        {"type": "joint", "name": "j2", "axis": [0, 1, 0], "stiffness_nm_per_rad": K2_NM_PER_RAD, "mass_kg": 1},
        {"type": "link", "name": "fore", "vector_m": [0.6, 0, 0], "mass_kg": 1}
    ]});
    let tolerance = json!({"joint_stiffness": 0.1, "modulus": 0.05, "joint_mass": 0.05});
    let folder = tempfile::tempdir().expect("temporary folder");
    let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text).expect("written");
    write("arm.json", arm.to_string());
    write("campaign.json", json!({"name": "long", "tolerance": tolerance}).to_string());
    write("static.csv", text);
    Campaign::read(folder.path(), &Catalogs::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn says(outcome: &Outcome, words: &str) -> bool {
    outcome
        .reasons
        .iter()
        .any(|reason| reason.contains("effects were sought in 25") && reason.contains(words))
}

#[test]
fn an_effect_that_a_part_of_the_rows_shows_is_measured_by_all_of_them() {
    let outcome = reconcile(&campaign(&|d| d));
    assert_eq!(outcome.verdict, Verdict::Explained, "{}", outcome.to_text());
    let labels: Vec<String> = outcome.effects.iter().map(|f| f.label()).collect();
    assert_eq!(labels, ["bearing_tilt@j2"]);
    let estimate = outcome.effects[0].parameters[0].1[0];
    let (low, high) = (estimate.low.expect("bounded"), estimate.high.expect("bounded"));
    assert!(low < TILT_NM_PER_RAD && TILT_NM_PER_RAD < high, "{low} to {high}");
    assert!(
        says(&outcome, "of the 5100 displacements and then fitted to all of them"),
        "{:?}",
        outcome.reasons
    );
    assert_eq!(outcome.residuals.len(), 3 * ROWS);
    let held_out = outcome.held_out.as_ref().expect("many poses");
    assert!(held_out.count > 3 * ROWS * 9 / 10, "{}", held_out.count);
    assert!((held_out.rms_declared_after - 1.0).abs() < 0.03, "{}", held_out.rms_declared_after);
}

#[test]
fn where_a_part_of_the_rows_is_not_explained_all_of_them_are_searched() {
    let outcome = reconcile(&campaign(&|d| d + 0.4 * d * d.abs()));
    assert_eq!(outcome.verdict, Verdict::Unexplained, "{}", outcome.to_text());
    assert!(!says(&outcome, ""), "{:?}", outcome.reasons);
    assert_eq!(outcome.residuals.len(), 3 * ROWS);
}
