//! Records against time: of joints made by an independent simulator, and of an industrial robot.

use super::generator::Dice;
use super::record_simulator::{Joint, Test, record};
use armwright::catalog::Catalogs;
use armwright::reconcile::records::finding::{JointRecord, State};
use armwright::reconcile::{Campaign, Outcome, Verdict, reconcile};
use serde_json::json;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A campaign with one record of a joint `j1` whose nominal stiffness is as given, `None` for a rigid one.
fn campaign(joint: &Joint, test: &Test, nominal: Option<f64>, dice: &mut Dice) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let arm = json!({"name": "one-joint", "effects": [], "chain": [
        {"type": "joint", "name": "j1", "axis": [0, 1, 0], "stiffness_nm_per_rad": nominal, "mass_kg": 1.0},
        {"type": "link", "name": "l1", "vector_m": [1.0, 0, 0], "mass_kg": 1.0}]});
    let statement = json!({"name": "one-joint", "links": "rigid", "tolerance": {"joint_stiffness": 0.1},
        "ratio": {"j1": joint.ratio}, "torque_at": "output"});
    std::fs::write(folder.path().join("arm.json"), arm.to_string()).expect("written");
    std::fs::write(folder.path().join("campaign.json"), statement.to_string()).expect("written");
    std::fs::write(folder.path().join("record.csv"), record(joint, test, dice)).expect("written");
    folder
}

fn outcome(folder: &Path) -> Outcome {
    let campaign = Campaign::read(folder, &Catalogs::default()).unwrap_or_else(|e| panic!("{e}"));
    reconcile(&campaign)
}

fn test() -> Test {
    Test {
        rows: 9000,
        step_s: 2e-3,
        amplitude_rad: 0.7,
        noise_rad: 2e-6,
        resolution_rad: 5e-6,
        torque_noise_nm: 1.0,
        moving_part: 1.0,
    }
}

/// What a record says of one thing: its state, and its first number with both ends.
fn number(joint: &JointRecord, what: &str) -> Option<(f64, f64, f64)> {
    let stated = joint.found(what)?;
    let estimate = stated.parameters.first()?.1[0];
    Some((estimate.value, estimate.low.unwrap_or(f64::NEG_INFINITY), estimate.high.unwrap_or(f64::INFINITY)))
}

#[test]
fn intervals_of_random_joints_hold() {
    // 40 joints of four numbers each; at 92 % a right 95 % interval fails with a probability of about 5 %
    const JOINTS: usize = 40;
    let (mut held, mut asked) = (0, 0);
    for seed in 0..JOINTS as u64 {
        let mut dice = Dice(900 + seed);
        let joint = Joint::random(&mut dice);
        let folder = campaign(&joint, &test(), None, &mut dice);
        let outcome = outcome(folder.path());
        let found = &outcome.records[0];
        let truths = [
            ("time_shift", joint.shift_s),
            ("compliance", joint.stiffness_nm_per_rad),
            ("coulomb_friction", joint.coulomb_nm),
            ("viscous_friction", joint.viscous_nms_per_rad),
        ];
        for (what, truth) in truths {
            let Some((value, low, high)) = number(found, what) else {
                println!("{seed} {what} {truth}: not found");
                continue;
            };
            let holds = low <= truth && truth <= high;
            println!("{seed} {what} {truth:.6}: {value:.6} ({low:.6} to {high:.6}) {holds}");
            asked += 1;
            held += usize::from(holds);
        }
        for what in ["torsion_curve", "hysteresis", "lost_motion", "transmission_error"] {
            if found.found(what).is_some() {
                println!("{seed}: FALSE {what}");
            }
        }
    }
    println!("{held} of {asked} intervals of 95 % hold");
    assert!(asked >= 3 * JOINTS, "{asked} numbers found");
    assert!(held as f64 >= 0.92 * asked as f64, "{held} of {asked}");
}
