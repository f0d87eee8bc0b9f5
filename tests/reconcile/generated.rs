//! New campaigns made by the independent model and reconciled without their answer keys. docs/reconcile.md has the
//! rates over hundreds of campaigns; here a few of each class must be right.

use crate::detectability;
use crate::generator;
use crate::scoring::{self, Score};
use armwright::catalog::Catalogs;
use armwright::reconcile::Campaign;
use armwright::reconcile::reconcile;
use std::path::Path;

/// Smallest departure that a hidden effect must cause to be a fair question \[standard deviations\].
const FAIR: f64 = 4.0;

/// Makes and reconciles the numbered campaigns of a set and class.
fn score(set: &str, class: &str, seed: u64, numbers: impl Iterator<Item = usize>) -> Score {
    let folder = tempfile::tempdir().expect("temporary folder");
    let mut names = Vec::new();
    for number in numbers {
        let (name, campaign) = fair_campaign(folder.path(), set, class, seed, number);
        reconcile(&campaign).write(&folder.path().join("verdicts").join(&name)).expect("written");
        names.push(name);
    }
    let score =
        scoring::score(&names, &folder.path().join("verdicts"), &folder.path().join("keys")).expect("scored");
    println!("{}\n{}", score.table(), score.confusion_csv());
    score
}

/// A campaign whose hidden effect, if the library has it, is large enough to be seen at all.
fn fair_campaign(out: &Path, set: &str, class: &str, seed: u64, number: usize) -> (String, Campaign) {
    let mut last = None;
    for eased in 0..8 {
        let (name, hidden) = generator::make(out, set, class, seed, number, eased);
        let campaign =
            Campaign::read(&out.join("campaigns").join(&name), &Catalogs::default()).expect("sound");
        let seen = detectability::detectable_sigmas(&campaign, &hidden);
        last = Some((name, campaign));
        if hidden.is_empty() || class == "unknown" || seen.is_some_and(|s| s >= FAIR) {
            break;
        }
    }
    last.expect("one was made")
}

fn right_of(score: &Score) -> (usize, usize) {
    score.classes.values().fold((0, 0), |sum, (right, all)| (sum.0 + right, sum.1 + all))
}

#[test]
fn four_of_five_small_effects_in_few_bad_readings_are_named() {
    let score = score("hard", "one", 71, (0..30).step_by(6));
    let (right, all) = right_of(&score);
    assert!(right * 5 >= all * 4, "{right} of {all}\n{}", score.table());
    assert!(score.covered.0 * 10 >= score.covered.1 * 8, "{}", score.table());
}

/// The third segment of the curve is hardly to be seen: where it begins must be left open, not put where the noise
/// suits it best.
#[test]
fn a_break_point_that_readings_hardly_show_is_left_open() {
    let score = score("hard", "one", 122, [31].into_iter());
    assert_eq!(score.covered, (5, 5), "{}", score.table());
    let t2 = score.intervals.iter().find(|line| line.contains(",t2_nm,")).expect("a curve is named");
    assert!(t2.ends_with(",,true"), "{t2}");
}

/// At little torque a soft gear moves a few first modes by twenty standard deviations: they are no slips.
#[test]
fn frequencies_that_a_break_point_moves_are_not_left_out() {
    let score = score("hard", "one", 622, [1].into_iter());
    assert_eq!(right_of(&score), (1, 1), "{}", score.table());
}

/// The frequencies' steps stop a descent to the curve; no further effect may be named to make that good.
#[test]
fn a_curve_is_fitted_to_the_end_before_a_further_effect_is_named() {
    let score = score("hard", "one", 722, [1].into_iter());
    assert_eq!(right_of(&score), (1, 1), "{}", score.table());
}

/// A descent that lets the two break points meet must find them apart again: no further effect, and no law without
/// a name, may be named to make that good.
#[test]
fn a_curve_whose_break_points_meet_on_the_way_is_opened_again() {
    let score = score("hard", "one", 822, [1].into_iter());
    assert_eq!(right_of(&score), (1, 1), "{}", score.table());
}

/// A further effect that moves the torques must not carry the break points of a curve into another valley.
#[test]
fn a_further_effect_is_found_beside_a_curve() {
    let score = score("hard", "two", 263, [23].into_iter());
    assert_eq!(right_of(&score), (1, 1), "{}", score.table());
}

/// Arms of four to seven joints of any size, on floor, wall or ceiling, with instruments of their own.
#[test]
fn what_an_arm_of_any_kind_hides_is_named() {
    let score = score("varied", "one", 57, (1..80).step_by(26));
    assert_eq!(right_of(&score), (4, 4), "{}", score.table());
}

/// Every gear has a torsion curve, so that the frequencies step wherever a torque crosses a break point.
#[test]
fn what_an_arm_of_curved_gears_hides_is_named() {
    let score = score("geared", "one", 11, (0..16).step_by(10));
    assert_eq!(right_of(&score), (2, 2), "{}", score.table());
}

/// One of each effect that came later to the library: a mass in modal tests, a servo, links that warm up, a stiffness that
/// varies with the angle, feet that lift off; a torque on a joint only shows where gears have curves.
#[test]
fn an_effect_that_came_later_is_named_and_its_intervals_hold() {
    let plain = score("plain", "later", 91, [0, 1, 3, 4, 5].into_iter());
    assert_eq!(right_of(&plain), (5, 5), "{}", plain.table());
    // seven numbers have intervals of 95 %; those of links that warm up leave out the sag of the arm itself
    assert!(plain.covered.0 + 2 >= plain.covered.1 && plain.covered.1 >= 7, "{}", plain.table());
    let geared = score("geared", "later", 92, [2, 8].into_iter());
    assert_eq!(right_of(&geared), (2, 2), "{}", geared.table());
}

#[test]
fn an_honest_arm_has_no_gap() {
    for set in ["plain", "hard", "varied", "geared"] {
        let score = score(set, "none", 72, 0..2);
        assert!(score.each.iter().all(|(_, _, right)| *right), "{}", score.table());
    }
}

#[test]
fn physics_that_the_library_lacks_is_called_unexplained_and_no_effect_is_named() {
    let score = score("plain", "unknown", 73, [1].into_iter());
    assert!(score.each.iter().all(|(_, _, right)| *right), "{}", score.table());
}

#[test]
fn a_hardening_joint_and_a_bent_sensor_of_a_third_the_size_get_no_name_of_the_library() {
    let score = score("hard", "unknown", 43, [4, 10, 14].into_iter());
    assert!(score.each.iter().all(|(_, _, right)| *right), "{}", score.table());
}
