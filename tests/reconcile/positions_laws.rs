//! Made campaigns of absolute positions: a base that lifts off, a stiffness that varies with the angle, a drift, and
//! physics that is not an effect in positions but looks like one.

use crate::positions_maker::{
    DRIFT_MM_PER_ROW, LIFT_RAD_PER_NM, LOST_RAD, Made, PRELOAD_NM, WAVE, WAVE_PHASE_RAD, standard, with_noise,
};

use armwright::catalog::Catalogs;
use armwright::reconcile::{Campaign, Outcome, Verdict, reconcile};
use std::path::Path;

fn outcome(folder: &Path) -> Outcome {
    reconcile(&Campaign::read(folder, &Catalogs::default()).unwrap_or_else(|e| panic!("{e}")))
}

fn labels(outcome: &Outcome) -> Vec<String> {
    outcome.effects.iter().map(|finding| finding.label()).collect()
}

/// Value and ends of the interval.
type Size = (f64, Option<f64>, Option<f64>);

fn only(outcome: &Outcome, label: &str, parameter: &str) -> Vec<Size> {
    let finding = outcome.effects.iter().find(|f| f.label() == label);
    let finding = finding.unwrap_or_else(|| panic!("{}", outcome.to_text()));
    let (_, estimates) = finding.parameters.iter().find(|(name, _)| name == parameter).expect("a parameter");
    estimates.iter().map(|estimate| (estimate.value, estimate.low, estimate.high)).collect()
}

/// Whether the interval contains the truth; the laws of the tests are those of rigid bodies that turn a little, so that a
/// part in a hundred is left.
fn holds((_, low, high): Size, truth: f64) -> bool {
    let (low, high) = (low.unwrap_or(f64::NEG_INFINITY), high.unwrap_or(f64::INFINITY));
    let slack = 0.01 * truth.abs();
    low - slack < truth && truth < high + slack
}

fn says(outcome: &Outcome, words: &str) -> bool {
    outcome.reasons.iter().any(|reason| reason.contains(words))
}

#[test]
fn a_base_that_lifts_off_beyond_its_preload_is_no_tilt_and_no_transmission_error() {
    let outcome = outcome(standard().write(&Made::lifting).path());
    assert_eq!(outcome.verdict, Verdict::Explained, "{}", outcome.to_text());
    assert_eq!(labels(&outcome), ["base_lift@base"], "{}", outcome.to_text());
    let stiffness = only(&outcome, "base_lift@base", "stiffness_nm_per_rad")[0];
    let preload = only(&outcome, "base_lift@base", "preload_nm")[0];
    assert!(holds(stiffness, 1.0 / LIFT_RAD_PER_NM), "{stiffness:?}");
    assert!(holds(preload, PRELOAD_NM), "{preload:?}");
    assert!(preload.1 > Some(0.8 * PRELOAD_NM) && preload.2 < Some(1.25 * PRELOAD_NM), "{preload:?}");
}

#[test]
fn a_stiffness_that_varies_with_the_angle_is_found_with_its_phase() {
    // an interval of 95 % may miss now and then
    let mut missed = 0;
    for seed in 1..=4 {
        let outcome = outcome(with_noise(seed).write(&Made::varying).path());
        assert_eq!(outcome.verdict, Verdict::Explained, "{}", outcome.to_text());
        let mut found = labels(&outcome);
        found.sort();
        assert_eq!(found, ["joint_compliance@q2", "joint_compliance@q3", "stiffness_waves@q3"]);
        let once = only(&outcome, "stiffness_waves@q3", "once")[0];
        let phase = only(&outcome, "stiffness_waves@q3", "phases_rad")[0];
        assert!(once.1 > Some(0.2) && once.2 < Some(0.7), "{once:?}");
        missed += usize::from(!holds(once, WAVE)) + usize::from(!holds(phase, WAVE_PHASE_RAD));
    }
    assert!(missed <= 1, "{missed} of 8 intervals miss");
}

#[test]
fn a_steady_drift_is_no_session() {
    let outcome = outcome(standard().write(&Made::drifting).path());
    assert_eq!(outcome.verdict, Verdict::Explained, "{}", outcome.to_text());
    assert_eq!(labels(&outcome), ["drift@positions"], "{}", outcome.to_text());
    let rates = only(&outcome, "drift@positions", "rate_mm_per_row");
    let length = rates.iter().map(|rate| rate.0.powi(2)).sum::<f64>().sqrt();
    assert!((length / DRIFT_MM_PER_ROW / 2f64.sqrt() - 1.0).abs() < 0.05, "{rates:?}");
    assert!(!says(&outcome, "before row"), "{}", outcome.to_text());
}

#[test]
fn a_joint_that_grows_stiffer_with_its_torque_has_no_lost_motion() {
    let outcome = outcome(standard().write(&Made::bent).path());
    assert_eq!(outcome.verdict, Verdict::Unexplained, "{}", outcome.to_text());
    // as a law that is better, or as what the residuals of the best model follow
    let is_told = ["a torsion of q2", "the torque on q2"].iter().any(|words| says(&outcome, words));
    assert!(is_told, "{}", outcome.to_text());
}

#[test]
fn lost_motion_is_named_with_its_half_width_and_no_bent_curve_in_its_place() {
    let outcome = outcome(standard().write(&Made::lagging).path());
    assert_eq!(outcome.verdict, Verdict::Explained, "{}", outcome.to_text());
    let half_width = only(&outcome, "lost_motion@q3", "half_width_rad")[0];
    assert!(holds(half_width, LOST_RAD), "{half_width:?}");
}
