//! Absolute positions of arms whose arm file has compliances. The true arm differs from its file by a mass, cables, a
//! modulus or a spring, and by stiffnesses within their tolerance. The readings are made by the independent model, and
//! lengths differ by millimetres.
//!
//! `ARMWRIGHT_POSITIONS` is the number of arms of each kind. The test prints a table.

use super::generator::{self, Dice, Plan, Specimen};
use armwright::catalog::Catalogs;
use armwright::reconcile::{Campaign, Outcome, Verdict, reconcile};
use serde_json::{Value, json};
use std::path::Path;
use tempfile::TempDir;

fn plan() -> Plan {
    let positions = 80;
    Plan { static_poses: 0, modal_poses: 0, bench: false, positions, lengths_m: 3e-3, ..Plan::plain() }
}

fn write(folder: &Path, seed: u64, hidden: &[Value]) {
    let mut dice = Dice(seed);
    let arm = Specimen::six_axis(&mut dice);
    generator::write(&mut dice, folder, &folder.with_extension("key"), &arm, hidden, &plan());
}

fn made(seed: u64, hidden: &[Value]) -> (TempDir, Campaign) {
    let folder = tempfile::tempdir().expect("temporary folder");
    let own = folder.path().join("made");
    write(&own, seed, hidden);
    let campaign = Campaign::read(&own, &Catalogs::default()).unwrap_or_else(|e| panic!("{e}"));
    (folder, campaign)
}

fn arms(otherwise: u64) -> u64 {
    std::env::var("ARMWRIGHT_POSITIONS").ok().and_then(|n| n.parse().ok()).unwrap_or(otherwise)
}

fn effect(name: &str, at: &str, parameter: &str, value: f64) -> Value {
    json!({"effect": name, "at": at, "parameters": {parameter: value}})
}

/// Whether the outcome names the hidden effect alone, or an effect of which it is an alternative; or says that something
/// is missing without a name for it. A wrong name is neither.
fn is_right(outcome: &Outcome, hidden: &Value) -> bool {
    let is_hidden = |effect: &str, at: &str| hidden["effect"] == effect && hidden["at"] == at;
    match outcome.verdict {
        Verdict::Explained => outcome.effects.iter().all(|f| {
            let is_alternative = f.indistinguishable_from.iter().any(|(e, at)| is_hidden(e, at));
            outcome.effects.len() == 1 && (is_hidden(&f.effect, &f.at) || is_alternative)
        }),
        Verdict::NoGap => false,
        _ => true,
    }
}

#[test]
fn masses_moduli_and_springs_are_told_apart_or_not_named() {
    let kinds = [
        effect("extra_mass", "j5", "delta_kg", 3.0),
        effect("extra_mass", "j3", "delta_kg", 6.0),
        effect("harness_mass", "forearm", "kg_per_m", 30.0),
        effect("modulus_error", "upper_arm", "factor", 0.12),
        effect("connection_compliance", "j3", "stiffness_nm_per_rad", 1.5e5),
        effect("bearing_tilt", "j3", "stiffness_nm_per_rad", 5e4),
    ];
    let (mut right, mut all) = (0, 0);
    for hidden in &kinds {
        for seed in 0..arms(1) {
            let outcome = reconcile(&made(300 + seed, std::slice::from_ref(hidden)).1);
            let named: Vec<String> = outcome.effects.iter().map(|f| f.label()).collect();
            let is_right = is_right(&outcome, hidden);
            println!(
                "{} {}@{}: {} {named:?} {}",
                seed,
                hidden["effect"],
                hidden["at"],
                outcome.verdict.word(),
                if is_right { "" } else { "WRONG" }
            );
            (right, all) = (right + usize::from(is_right), all + 1);
        }
    }
    println!("{right} of {all}");
    assert!(right * 20 >= all * 19, "{right} of {all}");
}

#[test]
fn a_joint_that_is_soft_within_its_tolerance_is_calibrated_and_no_gap() {
    for seed in 0..arms(2) {
        let (folder, _) = made(400 + seed, &[]);
        let own = folder.path().join("made");
        // the file states the joint a quarter too stiff, and that it may be
        edit(&own.join("arm.json"), |arm| {
            let chain = arm["chain"].as_array_mut().expect("chain");
            let joint = chain.iter_mut().find(|part| part["name"] == "j2").expect("j2");
            let k = joint["stiffness_nm_per_rad"].as_f64().expect("a number");
            joint["stiffness_nm_per_rad"] = json!(1.25 * k);
        });
        edit(&own.join("campaign.json"), |campaign| campaign["tolerance"]["joint_stiffness"] = json!(0.4));
        let outcome = reconcile(&Campaign::read(&own, &Catalogs::default()).expect("sound"));
        assert_eq!(outcome.verdict, Verdict::NoGap, "{}", outcome.to_text());
        let softened = outcome.calibrated.iter().find(|c| c.name == "j2.stiffness").expect("calibrated");
        let factor = softened.factor;
        assert!(
            factor.low.is_some_and(|low| low < 0.87) && factor.high.is_some_and(|high| high > 0.72),
            "{factor:?}"
        );
        assert!(factor.value < 0.95 && softened.learnt < 0.8, "{softened:?}");
    }
}

fn edit(file: &Path, change: impl FnOnce(&mut Value)) {
    let mut value: Value = serde_json::from_str(&std::fs::read_to_string(file).expect("text")).expect("JSON");
    change(&mut value);
    std::fs::write(file, value.to_string()).expect("written");
}

#[test]
fn campaigns_of_one_arm_from_two_set_ups_are_one() {
    let hidden = [effect("connection_compliance", "j3", "stiffness_nm_per_rad", 1.0e5)];
    let (_first, one) = made(500, &hidden);
    let (second, _) = made(500, &hidden);
    // the instrument stands a metre away and looks from another side
    let file = second.path().join("made/positions.csv");
    let text = std::fs::read_to_string(&file).expect("text");
    let turned = |line: &str| {
        let mut cells: Vec<String> = line.split(',').map(str::to_string).collect();
        let at = cells.len() - 4;
        let [x, y] = [0, 1].map(|c| cells[at + c].parse::<f64>().expect("number"));
        (cells[at], cells[at + 1]) = (format!("{:.4}", 1100.0 - y), format!("{:.4}", x - 300.0));
        cells.join(",")
    };
    let lines = text.lines().enumerate().map(|(i, l)| if i == 0 { l.to_string() } else { turned(l) });
    std::fs::write(&file, lines.collect::<Vec<_>>().join("\n") + "\n").expect("written");
    let two = Campaign::read(&second.path().join("made"), &Catalogs::default()).expect("sound");
    let outcome = reconcile(&one.join(vec![two]).expect("of one arm"));
    println!("{}", outcome.to_text());
    assert!(outcome.reasons.iter().any(|r| r.contains("turned by 90.") || r.contains("turned by 89.")));
    assert!(is_right(&outcome, &hidden[0]) && outcome.verdict == Verdict::Explained, "{}", outcome.to_text());
}
