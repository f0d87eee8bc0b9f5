//! Campaigns on arms with prismatic joints. The readings are those of the full model of a true arm, with noise. The arm
//! file has the stated numbers instead of the true ones.

use crate::generator::Dice;
use armwright::arm::{Arm, JointModel, LinkModel, Payload, pose_si, read_arm_document};
use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::mechanics::Chain;
use armwright::reconcile::reconcile;
use armwright::reconcile::{Campaign, Outcome, Verdict};
use nalgebra::Vector3;
use serde_json::{Value, json};
use std::fmt::Write;
use std::fs;

const SIGMA_MM: f64 = 0.002;
const SIGMA_HZ: f64 = 0.01;

/// A rail, a shoulder and a quill: two joints slide and two turn.
fn arm(drive_n_per_m: f64, quill_pitch_nm_per_rad: f64) -> Value {
    json!({"name": "rail-and-quill", "chain": [
        {"type": "prismatic", "name": "rail", "axis": [0, 1, 0], "stiffness_n_per_m": drive_n_per_m, "mass_kg": 30,
         "guide": {"roll_nm_per_rad": 6e5, "pitch_nm_per_rad": 8e5, "yaw_nm_per_rad": 8e5}},
        {"type": "link", "name": "post", "vector_m": [0, 0, 0.5], "mass_kg": 6},
        {"type": "joint", "name": "shoulder", "axis": [0, 1, 0], "stiffness_nm_per_rad": 3e5, "mass_kg": 8},
        {"type": "link", "name": "boom", "vector_m": [0.6, 0, 0], "material": "Structural steel S355",
         "section": {"shape": "rectangular_tube", "width_m": 0.1, "height_m": 0.1, "wall_m": 0.006}},
        {"type": "prismatic", "name": "quill", "axis": [1, 0, 0], "stiffness_n_per_m": 2e7, "moves": "ram", "mass_kg": 4,
         "guide": {"roll_nm_per_rad": 2e5, "pitch_nm_per_rad": quill_pitch_nm_per_rad, "yaw_nm_per_rad": 2e5}},
        {"type": "joint", "name": "roll", "axis": [1, 0, 0], "stiffness_nm_per_rad": 4e4, "mass_kg": 2},
        {"type": "link", "name": "hand", "vector_m": [0.1, 0, 0], "mass_kg": 1}]})
}

fn read(arm: &Value) -> Arm {
    let document = Document::parse("arm.json", &arm.to_string()).expect("JSON");
    read_arm_document(document, &Catalogs::builtin()).unwrap_or_else(|faults| panic!("{faults}"))
}

/// Reconciles the stated arm with readings of the true one.
fn outcome(stated: &Value, truth: &Value) -> Outcome {
    outcome_in_each_pose(stated, |_| truth.clone())
}

/// Reconciles the stated arm with readings of another arm in each pose. `truth_at` returns the true arm from the
/// positions of the joints \[mm and deg\].
fn outcome_in_each_pose(stated: &Value, truth_at: impl Fn(&[f64; 4]) -> Value) -> Outcome {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (dice, arm) = (&mut Dice(5), read(stated));
    let driven = arm.driven_joints();
    let columns: Vec<String> = driven.iter().map(|joint| format!("q_{}", joint.key())).collect();
    assert_eq!(columns, ["q_rail_mm", "q_shoulder_deg", "q_quill_mm", "q_roll_deg"]);
    let mut statics = format!(
        "test,{},payload_kg,force_x_n,force_y_n,force_z_n,dx_mm,dy_mm,dz_mm,sigma_mm\n",
        columns.join(",")
    );
    let mut modal = format!("test,{},payload_kg,mode,frequency_hz,sigma_hz\n", columns.join(","));
    for pose in 0..16 {
        let entries = [
            dice.between(-900.0, 900.0),
            dice.between(-60.0, 30.0),
            dice.between(0.0, 400.0),
            dice.between(-120.0, 120.0),
        ];
        let entries = entries.map(|entry| entry.round());
        let words = entries.map(|entry| entry.to_string()).join(",");
        let pose_si = pose_si(&driven, &entries);
        let truth = read(&truth_at(&entries));
        let chain = Chain::new(&truth.structure(JointModel::ThreeSegment), LinkModel::Full);
        let moved = |payload_kg: f64, force_n: Vector3<f64>| {
            let payload = Payload { mass_kg: payload_kg, ..Payload::default() };
            chain.pose_rad(&pose_si, &payload, force_n).statics().tip_displacement_m
        };
        let rest = moved(0.0, Vector3::zeros());
        for (kg, force) in [(10.0, [0.0; 3]), (0.0, [0.0, 200.0, 0.0]), (0.0, [150.0, 0.0, 80.0])] {
            let read = (moved(kg, force.into()) - rest).map(|m| 1e3 * m + SIGMA_MM * dice.normal());
            let [fx, fy, fz] = force;
            writeln!(
                statics,
                "s{pose}-{kg}-{fy},{words},{kg},{fx},{fy},{fz},{},{},{},{SIGMA_MM}",
                read.x, read.y, read.z
            )
            .expect("text");
        }
        if pose % 2 == 0 {
            let posed = chain.pose_rad(&pose_si, &Payload::default(), Vector3::zeros());
            for (k, mode) in posed.modes(&posed.statics(), 4).iter().enumerate() {
                let hz = mode.frequency_hz + SIGMA_HZ * dice.normal();
                writeln!(modal, "m{pose},{words},0,{},{hz},{SIGMA_HZ}", k + 1).expect("text");
            }
        }
    }
    let campaign = json!({"name": "rail", "arm": "arm.json",
        "tolerance": {"joint_stiffness": 0.1, "joint_mass": 0.02, "modulus": 0.03, "bearing_stiffness": 0.1}});
    for (name, text) in [
        ("arm.json", stated.to_string()),
        ("campaign.json", campaign.to_string()),
        ("static.csv", statics),
        ("modal.csv", modal),
    ] {
        fs::write(folder.path().join(name), text).expect("written");
    }
    let read = Campaign::read(folder.path(), &Catalogs::builtin());
    let outcome = reconcile(&read.unwrap_or_else(|faults| panic!("{faults}")));
    println!("{}", outcome.to_text());
    outcome
}

#[test]
fn a_rail_within_tolerance_is_calibrated() {
    let outcome = outcome(&arm(4e7, 3e5), &arm(4.2e7, 3e5));
    assert_eq!(outcome.verdict, Verdict::NoGap);
    let factor = outcome.calibrated.iter().find(|c| c.name == "rail.stiffness").expect("calibrated").factor;
    assert!((factor.value - 1.05).abs() < 0.01, "{factor:?}");
}

/// 4e7 N/m stated, 2.4e7 true: 6e7 in series.
#[test]
fn a_rail_that_is_softer_than_stated_is_named() {
    let outcome = outcome(&arm(4e7, 3e5), &arm(2.4e7, 3e5));
    assert_eq!(outcome.verdict, Verdict::Explained);
    let labels: Vec<String> = outcome.effects.iter().map(|found| found.label()).collect();
    assert_eq!(labels, ["travel_compliance@rail"]);
    let estimate = outcome.effects[0].parameters[0].1[0];
    assert!((estimate.value / 6e7 - 1.0).abs() < 0.15, "{estimate:?}");
}

/// The guide of the quill tilts beyond what is stated: equal springs of 2e5 N m/rad about its three axes.
#[test]
fn a_guide_that_tilts_is_named() {
    let mut truth = arm(4e7, 3e5);
    truth["effects"] =
        json!([{"effect": "guide_tilt", "at": "quill", "parameters": {"stiffness_nm_per_rad": 2e5}}]);
    let outcome = outcome(&arm(4e7, 3e5), &truth);
    assert_eq!(outcome.verdict, Verdict::Explained);
    let labels: Vec<String> = outcome.effects.iter().map(|found| found.label()).collect();
    assert_eq!(labels, ["guide_tilt@quill"]);
    let estimate = outcome.effects[0].parameters[0].1[0];
    assert!((estimate.value / 2e5 - 1.0).abs() < 0.15, "{estimate:?}");
}

/// A rail that is screwed down badly in its middle: within 300 mm of it the pitch stiffness of the guide falls to as
/// little as 40 %. No effect of the library is of this kind.
#[test]
fn a_guide_that_is_soft_in_a_part_of_its_travel_has_a_gap_without_a_name() {
    let stated = arm(4e7, 3e5);
    let outcome = outcome_in_each_pose(&stated, |[rail_mm, ..]| {
        let mut truth = stated.clone();
        let softer = 1.5 * (-(rail_mm / 300.0).powi(2)).exp();
        truth["chain"][0]["guide"]["pitch_nm_per_rad"] = json!(8e5 / (1.0 + softer));
        truth
    });
    assert_eq!(outcome.verdict, Verdict::Unexplained);
    let text = outcome.to_text();
    assert!(text.contains("a guide of rail whose stiffness changes with its position"), "{text}");
}

/// Readings that are not computed on such an arm are refused in words.
#[test]
fn positions_of_an_arm_that_slides_are_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("arm.json"), arm(4e7, 3e5).to_string()).expect("written");
    fs::write(folder.path().join("campaign.json"), json!({"name": "p", "arm": "arm.json"}).to_string())
        .expect("written");
    let table =
        "test,q_rail_mm,q_shoulder_deg,q_quill_mm,q_roll_deg,x_mm,y_mm,z_mm,sigma_mm\na,0,0,0,0,1,2,3,0.1\n";
    fs::write(folder.path().join("positions.csv"), table).expect("written");
    let fault = Campaign::read(folder.path(), &Catalogs::builtin()).expect_err("refused").to_string();
    assert!(fault.contains("prismatic joints, which are not computed"), "{fault}");
}
