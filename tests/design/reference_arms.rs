//! Arms solved by other programs: FEDEM, CalculiX, Pinocchio, MuJoCo (planar) and an independent beam chain (spatial).
//!
//! `tests/data/planar-arms.json` and `tests/data/spatial-arms.json` say what was solved, by whom, and to what tolerance
//! agreement may be asked for.

use crate::witness::{self, Answer, LoadCase, MassShape, Options};
use serde_json::Value;

/// Deviations from one set of expected numbers, in percent.
#[derive(Debug, Default)]
struct Deviation {
    frequency_pct: f64,
    tip_pct: f64,
    torque_pct: f64,
}

impl Deviation {
    fn worst_pct(&self) -> f64 {
        self.frequency_pct.max(self.tip_pct).max(self.torque_pct)
    }

    fn widened(self, other: &Self) -> Self {
        Self {
            frequency_pct: self.frequency_pct.max(other.frequency_pct),
            tip_pct: self.tip_pct.max(other.tip_pct),
            torque_pct: self.torque_pct.max(other.torque_pct),
        }
    }
}

/// A component of the tip displacement smaller than this is compared with this.
const TIP_FLOOR_MM: f64 = 0.01;

fn data(name: &str) -> Value {
    let path = format!("{}/tests/data/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
    serde_json::from_str(&text).expect("the reference is JSON")
}

fn numbers(list: &Value) -> Vec<f64> {
    list.as_array().expect("a list").iter().map(|number| number.as_f64().expect("a number")).collect()
}

fn deviation_pct(found: f64, expected: f64, floor: f64) -> f64 {
    100.0 * (found - expected).abs() / expected.abs().max(floor)
}

fn worst_pct(found: &[f64], expected: &[f64], floor: f64) -> f64 {
    assert!(found.len() >= expected.len(), "{found:?} against {expected:?}");
    let each = found.iter().zip(expected).map(|(found, expected)| deviation_pct(*found, *expected, floor));
    each.fold(0.0, f64::max)
}

fn compared(answer: &Answer, frequencies_hz: &[f64], expected: &Value) -> Deviation {
    let tip_mm: Vec<f64> = answer.tip_displacement_m.iter().map(|component_m| component_m * 1e3).collect();
    Deviation {
        frequency_pct: worst_pct(frequencies_hz, &numbers(&expected["frequency_hz"]), 0.0),
        tip_pct: worst_pct(&tip_mm, &numbers(&expected["tip_mm"]), TIP_FLOOR_MM),
        torque_pct: torque_deviation_pct(answer, &expected["joint_torque_nm"]),
    }
}

/// Worst torque deviation, in percent of the case's largest torque.
///
/// Not of each torque: the reference's rigid and flexible columns, which statics wants equal, differ by up to 0.004 N m
/// (its springs' torques come out of a stiff solve), and the smallest torque is 0.01 N m.
fn torque_deviation_pct(answer: &Answer, expected: &Value) -> f64 {
    let torques = expected.as_object().into_iter().flatten();
    let pairs: Vec<(f64, f64)> = torques
        .map(|(joint, torque_nm)| (answer.torque_nm(joint), torque_nm.as_f64().expect("a number")))
        .collect();
    let largest_nm = pairs.iter().map(|(_, expected_nm)| expected_nm.abs()).fold(0.0, f64::max);
    pairs.iter().map(|(found, expected)| deviation_pct(*found, *expected, largest_nm)).fold(0.0, f64::max)
}

/// The worst deviation over all cases of a file, in one class of expected numbers.
fn worst_of_class(
    file: &Value,
    expected_key: &str,
    class: &str,
    frequencies_hz: impl Fn(&Answer) -> Vec<f64>,
    options: &Options,
) -> Deviation {
    let cases = file["cases"].as_array().expect("cases");
    let deviations = cases.iter().map(|case| {
        let answer = witness::analyze(&case["arm"], &LoadCase::from_json(case), options);
        let deviation = compared(&answer, &frequencies_hz(&answer), &case[expected_key][class]);
        println!("{} {class}: {deviation:?}", case["id"]);
        deviation
    });
    let worst = deviations.fold(Deviation::default(), |worst, deviation| worst.widened(&deviation));
    println!("worst {class}: {worst:?}");
    worst
}

fn assert_within_suggested(file: &Value, class: &str, deviation: &Deviation) {
    let tolerance_pct = file["suggested_tolerance_pct"][class].as_f64().expect("a tolerance");
    assert!(deviation.worst_pct() <= tolerance_pct, "{class}: {deviation:?} beyond {tolerance_pct} %");
}

#[test]
fn the_witness_agrees_with_the_reference_arms() {
    the_witness_agrees_with_the_planar_arms();
    the_witness_agrees_with_the_spatial_arms();
}

fn the_witness_agrees_with_the_planar_arms() {
    let file = data("planar-arms.json");
    let flexible = Options::default().with_modes(16);
    for (class, options) in [
        ("rigid_links", Options::rigid_links()),
        ("flexible_links_fedem", flexible.clone()),
        ("flexible_links_calculix_3d", flexible),
    ] {
        let worst = worst_of_class(&file, "expected_in_plane", class, Answer::xz_frequencies_hz, &options);
        assert_within_suggested(&file, class, &worst);
    }
}

fn the_witness_agrees_with_the_spatial_arms() {
    let file = data("spatial-arms.json");
    let all = Answer::frequencies_hz;
    let flexible = |options: &Options| worst_of_class(&file, "expected", "flexible_links", all, options);

    let rigid = worst_of_class(&file, "expected", "rigid_links", all, &Options::rigid_links());
    assert_within_suggested(&file, "rigid_links", &rigid);
    assert_within_suggested(&file, "flexible_links", &flexible(&as_the_spatial_reference_did()));
    let timoshenko = flexible(&Options::default());
    assert!(timoshenko.worst_pct() <= SPATIAL_TIMOSHENKO_PCT, "{timoshenko:?}");
    let lowest_five = |answer: &Answer| answer.frequencies_hz()[..5].to_vec();
    let lowest =
        worst_of_class(&shortened(&file, 5), "expected", "flexible_links", lowest_five, &Options::default());
    assert_within_suggested(&file, "flexible_links", &lowest);
}

/// What the spatial reference turns out to have done: eight elements a link, and a mass matrix from Euler-Bernoulli
/// shapes, with which all its numbers come back to 0.03 %.
fn as_the_spatial_reference_did() -> Options {
    Options { elements_per_link: 8, mass_shape: MassShape::EulerBernoulli, ..Options::default() }
}

/// Suggested are 0.2 %, but for its mass matrix (see `MassShape::EulerBernoulli`) the reference has the sixth mode of S01
/// 0.253 % too low; the five lowest modes of all arms stay within 0.06 %. The planar arms by FEDEM and the exact solution
/// of a stout cantilever (`tests/design/closed_forms.rs`) side with the Timoshenko shapes.
const SPATIAL_TIMOSHENKO_PCT: f64 = 0.3;

/// The file with only the lowest expected frequencies.
fn shortened(file: &Value, count: usize) -> Value {
    let mut file = file.clone();
    for case in file["cases"].as_array_mut().expect("cases") {
        let list = &mut case["expected"]["flexible_links"]["frequency_hz"];
        list.as_array_mut().expect("frequencies").truncate(count);
    }
    file
}
