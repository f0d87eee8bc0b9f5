//! Campaigns of absolute positions from a simulator that shares nothing with this library or its tests, written from
//! the documentation alone. Each of these campaigns got a wrong verdict in an earlier version.

use armwright::catalog::Catalogs;
use armwright::reconcile::Campaign;
use armwright::reconcile::Outcome;
use armwright::reconcile::Verdict;
use armwright::reconcile::reconcile;
use std::path::Path;

fn outcome_of(name: &str) -> Outcome {
    let folder =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/positions_other_simulator").join(name);
    reconcile(&Campaign::read(&folder, &Catalogs::builtin()).expect("sound"))
}

fn is_explained_by(name: &str, effects: &[&str]) -> Outcome {
    let outcome = outcome_of(name);
    assert_eq!(outcome.verdict, Verdict::Explained, "{name}: {}", outcome.to_text());
    let mut named: Vec<String> = outcome.effects.iter().map(|f| f.label()).collect();
    named.sort();
    assert_eq!(named, effects, "{name}: {}", outcome.to_text());
    outcome
}

#[test]
fn a_list_of_effects_that_leaves_out_the_joints_is_no_trouble() {
    let outcome = outcome_of("an-effects-list");
    assert_eq!(outcome.verdict, Verdict::NoGap, "{}", outcome.to_text());
}

/// A joint has an uneven transmission, and the campaign's list leaves transmission errors out.
#[test]
fn an_effect_that_the_list_leaves_out_is_no_alternative_either() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/positions_other_simulator/uneven-and-nothing-else");
    let mut campaign = Campaign::read(&folder, &Catalogs::builtin()).expect("sound");
    campaign.statement.effects = Some(vec!["joint_compliance".into(), "stiffness_waves".into()]);
    let outcome = reconcile(&campaign);
    assert!(!outcome.to_text().contains("transmission_error"), "{}", outcome.to_text());
}

#[test]
fn points_of_one_name_on_two_arms_are_two_points() {
    let names = ["joint_compliance@l2", "joint_compliance@r3"];
    let outcome = is_explained_by("one-point-name-on-two-arms", &names);
    let of_r3 = outcome.effects.iter().find(|f| f.at == "r3").expect("named");
    let stiffness = &of_r3.parameters[0].1[0];
    // 1003 N m/rad is what was hidden
    assert!(stiffness.low < Some(1003.0) && stiffness.high > Some(1003.0), "{stiffness:?}");
}

#[test]
fn an_axis_off_the_vertical_changes_what_gravity_does() {
    let outcome = outcome_of("first-axis-off-the-vertical");
    assert_eq!(outcome.verdict, Verdict::NoGap, "{}", outcome.to_text());
}

#[test]
fn an_effect_that_has_become_needless_is_not_named() {
    is_explained_by("uneven-and-nothing-else", &["transmission_error@k3"]);
}

#[test]
fn a_fit_of_parallel_axes_does_not_run_away() {
    is_explained_by("parallel-axes", &["transmission_error@j1"]);
}

#[test]
fn a_base_that_yields_more_one_way_than_the_other_is_one_frame() {
    is_explained_by("a-base-that-yields-unevenly", &["frame_compliance@base"]);
}

#[test]
fn what_is_left_far_above_the_noise_is_not_explained() {
    let outcome = outcome_of("wrong-coupling");
    assert_eq!(outcome.verdict, Verdict::Unexplained, "{}", outcome.to_text());
}
