//! What three frequencies can say: the paper's own, as if measured on the arm of its Table 1.

use armwright::catalog::Catalogs;
use armwright::reconcile::verdict::Finding;
use armwright::reconcile::{Campaign, Outcome, Verdict, reconcile};
use std::path::Path;

fn outcome() -> Outcome {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/paper-frequencies");
    reconcile(&Campaign::read(&folder, &Catalogs::default()).expect("sound"))
}

fn suspect<'a>(outcome: &'a Outcome, label: &str) -> &'a Finding {
    let found = outcome.suspects.iter().find(|f| f.label() == label);
    found.unwrap_or_else(|| panic!("{label} is no suspect: {}", outcome.to_text()))
}

#[test]
fn the_papers_frequencies_want_more_mass_at_the_wrist_than_its_table_has() {
    let outcome = outcome();
    assert_eq!(outcome.verdict, Verdict::InsufficientData, "{}", outcome.to_text());
    assert!(outcome.effects.is_empty());
    let mass = suspect(&outcome, "extra_mass@wrist").parameters[0].1[0];
    assert!((1.8..3.2).contains(&mass.value), "{mass:?}");
    assert!(mass.low.expect("bounded") > 1.0, "{mass:?}");
    let sentence = outcome.reasons.iter().find(|r| r.contains("missing at and beyond wrist"));
    let sentence = sentence.unwrap_or_else(|| panic!("{}", outcome.to_text()));
    assert!(sentence.contains("13.78 kg"), "{sentence}");
}

#[test]
fn the_papers_third_spring_cannot_be_identified_from_three_frequencies() {
    let outcome = outcome();
    assert!(
        outcome.reasons.iter().any(|r| r.contains("stiffness of wrist cannot be identified")),
        "{}",
        outcome.to_text()
    );
    let spring = suspect(&outcome, "connection_compliance@wrist").parameters[0].1[0];
    assert_eq!(spring.high, None, "it may not be there at all");
}
