//! Tests of the plan with simulated passes whose growth in time is known.

use super::*;

/// Simulates the passes of a search up to a time limit \[s\]. A pass with a slack of 1 takes the time `first_s` \[s\].
/// The smaller the slack, the longer a pass takes, with the exponent `growth`. Returns the slack of each completed pass
/// and the time at which it was done \[s\].
fn planned(gap: f64, growth: f64, first_s: f64, limit_s: Option<f64>) -> Vec<(f64, f64)> {
    let plan = Plan::new(gap, true);
    let (mut done, mut out, mut now_s) = (Vec::<Pass>::new(), Vec::new(), 0.0);
    while let Some(slack) = plan.next(&done, limit_s.map(|limit_s| limit_s - now_s)) {
        // A pass without slack takes as long as a pass with a slack of 0.1 %.
        let took_s = first_s * libm::pow(slack.max(1e-3), -growth);
        now_s += took_s;
        if limit_s.is_some_and(|limit_s| now_s > limit_s) {
            break;
        }
        done.push(Pass { slack, took_s });
        out.push((slack, now_s));
    }
    out
}

#[test]
fn without_a_time_limit_the_slacks_do_not_depend_on_the_times() {
    let slacks = |first_s: f64, gap: f64| -> Vec<f64> {
        planned(gap, 3.0, first_s, None).into_iter().map(|(slack, _)| slack).collect()
    };
    assert_eq!(slacks(1e-3, 0.02), [1.0, 0.12, 0.02]);
    assert_eq!(slacks(1e3, 0.02), [1.0, 0.12, 0.02]);
    assert_eq!(slacks(1e-3, 0.0), [1.0, 0.3, 0.09, 0.035, 0.01, 0.0025, 0.0]);
    assert_eq!(slacks(1e-3, 0.4), [1.0, 0.4]);
}

#[test]
fn a_long_time_limit_changes_no_slack() {
    for gap in [0.0, 0.02] {
        let without = planned(gap, 3.3, 1e-6, None);
        assert_eq!(planned(gap, 3.3, 1e-6, Some(1e9)), without);
    }
}

#[test]
fn a_time_limit_proves_nearly_the_gap_that_a_single_pass_of_that_time_would() {
    for (growth, factor) in [(2.0, 1.4), (2.5, 1.25), (3.0, 1.2), (3.3, 1.2), (3.6, 1.2), (4.0, 1.2)] {
        for limit_s in (1..300).map(f64::from) {
            let first_s: f64 = 2e-3;
            let best = libm::pow(first_s / limit_s, 1.0 / growth);
            let done = planned(0.0, growth, first_s, Some(limit_s));
            let (proved, at_s) = done.last().copied().expect("a pass is done");
            assert!(proved <= factor * best, "exponent {growth}, {limit_s} s: {proved} and not {best}");
            assert!(at_s <= limit_s);
        }
    }
}

#[test]
fn a_longer_time_limit_never_proves_a_much_larger_gap() {
    let proved = |limit_s: f64| planned(0.02, 3.3, 2e-3, Some(limit_s)).last().map(|(slack, _)| *slack);
    let mut before = f64::INFINITY;
    for limit_s in (1..2000).map(f64::from) {
        let now = proved(limit_s).expect("a pass is done");
        assert!(now <= 1.1 * before, "{limit_s} s prove {now}, a second less {before}");
        before = before.min(now);
    }
    assert_eq!(before, 0.02);
}

#[test]
fn the_exponent_is_measured_between_the_last_two_passes() {
    let pass = |slack: f64, took_s: f64| Pass { slack, took_s };
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
    near(growth(&[pass(1.0, 9.0), pass(0.2, 1.0), pass(0.1, 8.0)]), 3.0);
    near(growth(&[pass(0.2, 1.0), pass(0.1, 1.1)]), LEAST_GROWTH);
    near(growth(&[pass(0.2, 0.0), pass(0.1, 1.0)]), GROWTH_EXPONENT);
    near(least_slack_within(&[pass(0.2, 1.0), pass(0.1, 8.0)], 64.0), 0.05);
    near(step_to(0.05, 0.2), 0.1);
    near(step_to(0.08, 0.2), 0.08);
    near(step_to(0.3, 0.2), 0.19);
}
