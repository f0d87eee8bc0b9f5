//! Arms whose nominal model has output bearings: the stiffness of a bearing within its tolerance is calibrated, and a
//! larger tilt is named as an effect. The independent model that makes the readings has one spring across each joint
//! and knows nothing of nominal bearings.

use crate::generator::{self, Dice, Plan, Specimen};
use armwright::arm::Element;
use armwright::catalog::Catalogs;
use armwright::reconcile::Campaign;
use armwright::reconcile::reconcile;
use armwright::reconcile::{Outcome, Verdict};
use serde_json::{Value, json};

/// Tilting stiffness of the nominal bearings.
const NOMINAL_NM_PER_RAD: f64 = 5e5;

/// A campaign of a six-axis arm whose joint `at` tilts by `true_nm_per_rad` in all, and whose drawing has the nominal bearing
/// there. Other bearings are rigid.
fn outcome(at: &str, true_nm_per_rad: f64, tolerance: Option<f64>) -> Outcome {
    let out = tempfile::tempdir().expect("temporary folder");
    let folder = out.path().join("c");
    let mut dice = Dice(21);
    let specimen = Specimen::six_axis(&mut dice);
    let tilt =
        json!({"effect": "bearing_tilt", "at": at, "parameters": {"stiffness_nm_per_rad": true_nm_per_rad}});
    let plan = Plan { static_poses: 20, modal_poses: 8, ..Plan::plain() };
    generator::write(&mut dice, &folder, &out.path().join("key.json"), &specimen, &[tilt], &plan);
    edit(&folder.join("arm.json"), |arm| {
        let chain = arm["chain"].as_array_mut().expect("a chain");
        let joint = chain.iter_mut().find(|part| part["name"] == at).expect("the joint");
        joint["bearing"] = json!({"tilt_stiffness_nm_per_rad": NOMINAL_NM_PER_RAD});
    });
    edit(&folder.join("campaign.json"), |campaign| {
        if let Some(tolerance) = tolerance {
            campaign["tolerance"]["bearing_stiffness"] = json!(tolerance);
        }
    });
    let outcome = reconcile(&Campaign::read(&folder, &Catalogs::default()).expect("sound"));
    println!("{}", outcome.to_text());
    outcome
}

fn edit(file: &std::path::Path, change: impl Fn(&mut Value)) {
    let text = std::fs::read_to_string(file).expect("text");
    let mut value: Value = serde_json::from_str(&text).expect("JSON");
    change(&mut value);
    std::fs::write(file, value.to_string()).expect("written");
}

/// The stiffness of two springs in series \[N m/rad\].
fn in_series(a_nm_per_rad: f64, b_nm_per_rad: f64) -> f64 {
    1.0 / (1.0 / a_nm_per_rad + 1.0 / b_nm_per_rad)
}

#[test]
fn a_bearing_as_drawn_is_no_gap() {
    assert_eq!(outcome("j3", NOMINAL_NM_PER_RAD, None).verdict, Verdict::NoGap);
}

#[test]
fn a_bearing_20_percent_soft_is_calibrated_within_a_tolerance_of_30_percent() {
    let outcome = outcome("j3", 0.8 * NOMINAL_NM_PER_RAD, Some(0.3));
    assert_eq!(outcome.verdict, Verdict::NoGap);
    let calibrated = outcome.calibrated.iter().find(|c| c.name == "j3.bearing_stiffness");
    let factor = calibrated.expect("calibrated").factor;
    assert!((factor.value - 0.8).abs() < 0.02, "{factor:?}");
    assert!(factor.low.expect("an end") < 0.81 && factor.high.expect("an end") > 0.79, "{factor:?}");
    let joint = outcome.corrected.joints().find(|joint| joint.name == "j3").expect("the joint");
    let stiffness = joint.bearing.and_then(|bearing| bearing.tilt_stiffness_nm_per_rad).expect("a bearing");
    assert_eq!(stiffness, NOMINAL_NM_PER_RAD * factor.value);
    let sources = outcome.provenance["calibrated"].as_array().expect("a list");
    let source = sources.iter().find(|c| c["value"] == "j3.bearing_stiffness").expect("its source");
    assert_eq!(source["source"], "calibrated within tolerance");
}

#[test]
fn a_bearing_20_percent_soft_is_missing_physics_without_a_tolerance() {
    let outcome = outcome("j3", 0.8 * NOMINAL_NM_PER_RAD, None);
    is_tilt(&outcome, "j3", 4.0 * NOMINAL_NM_PER_RAD);
    assert!(outcome.calibrated.iter().all(|c| !c.name.contains("bearing")));
}

#[test]
fn what_tilts_beyond_the_nominal_bearing_is_named_with_its_own_stiffness() {
    let beyond_nm_per_rad = 6e5;
    let outcome = outcome("j3", in_series(NOMINAL_NM_PER_RAD, beyond_nm_per_rad), Some(0.1));
    is_tilt(&outcome, "j3", beyond_nm_per_rad);
}

/// Asserts that a campaign is explained by one bearing that tilts beyond its nominal stiffness by this much. The corrected arm
/// keeps the nominal bearing and has the effect beside it.
fn is_tilt(outcome: &Outcome, at: &str, beyond_nm_per_rad: f64) {
    assert_eq!(outcome.verdict, Verdict::Explained);
    let labels: Vec<String> = outcome.effects.iter().map(|found| found.label()).collect();
    assert_eq!(labels, [format!("bearing_tilt@{at}")]);
    let estimate = outcome.effects[0].parameters[0].1[0];
    assert!((estimate.value / beyond_nm_per_rad - 1.0).abs() < 0.15, "{estimate:?}");
    let (low, high) = (estimate.low.unwrap_or(0.0), estimate.high.unwrap_or(f64::INFINITY));
    assert!(low < 1.02 * beyond_nm_per_rad && beyond_nm_per_rad < 1.02 * high, "{estimate:?}");
    assert_eq!(outcome.corrected.effects.len(), 1);
    let has_bearing =
        |element: &&Element| matches!(element, Element::Joint(joint) if joint.bearing.is_some());
    assert_eq!(outcome.corrected.chain.iter().filter(has_bearing).count(), 1);
}

#[test]
fn beyond_the_bearing_of_a_vertical_first_joint_the_tilt_of_the_base_is_the_same_thing() {
    let outcome = outcome("j1", in_series(NOMINAL_NM_PER_RAD, 6e5), None);
    assert_eq!(outcome.verdict, Verdict::Explained);
    let found = &outcome.effects[0];
    assert_eq!(found.label(), "base_compliance@base");
    let twins: Vec<(&str, &str)> =
        found.indistinguishable_from.iter().map(|(effect, at)| (effect.as_str(), at.as_str())).collect();
    assert!(twins.contains(&("bearing_tilt", "j1")), "{twins:?}");
    assert!((found.parameters[0].1[0].value / 6e5 - 1.0).abs() < 0.15, "{:?}", found.parameters);
}
