//! What three natural frequencies can show: the paper's own, taken as if they were measured on the arm of its Table 1.

use armwright::catalog::Catalogs;
use armwright::reconcile::Campaign;
use armwright::reconcile::Verdict;
use armwright::reconcile::reconcile;
use std::path::Path;

#[test]
fn the_papers_frequencies_want_more_mass_at_the_wrist_than_its_table_has_and_leave_its_spring_open() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/paper-frequencies");
    let outcome = reconcile(&Campaign::read(&folder, &Catalogs::default()).expect("sound"));
    assert_eq!(outcome.verdict, Verdict::InsufficientData, "{}", outcome.to_text());
    assert!(outcome.effects.is_empty());
    let says = |words: &str| {
        let found = outcome.reasons.iter().find(|r| r.contains(words));
        found.unwrap_or_else(|| panic!("{words}: {}", outcome.to_text()))
    };
    let sentence = says("the masses cannot give the readings");
    assert!(sentence.contains("extra_mass@wrist with 2.24 kg"), "{sentence}");
    let extra = outcome.suspects.iter().find(|s| s.label() == "extra_mass@wrist").expect("a suspect");
    let (low, high) = (extra.parameters[0].1[0].low, extra.parameters[0].1[0].high);
    assert!(low.expect("bounded") > 1.5 && high.expect("bounded") < 3.5, "{}", outcome.to_text());
    let third = says("the stiffness of wrist cannot be identified");
    let numbers: Vec<f64> = third.split(' ').filter_map(|word| word.parse().ok()).collect();
    assert!(numbers[0] < 0.65 * 108e3 && numbers[1] > 2.0 * 108e3, "{third}");
    assert!(outcome.held_out.is_none(), "one pose cannot be predicted from none");
}
