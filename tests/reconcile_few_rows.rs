//! What three frequencies can say: the paper's own, as if measured on the arm of its Table 1.

use armwright::catalog::Catalogs;
use armwright::reconcile::{Campaign, Verdict, reconcile};
use std::path::Path;

#[test]
fn the_papers_frequencies_want_more_mass_at_the_wrist_than_its_table_has() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/paper-frequencies");
    let outcome = reconcile(&Campaign::read(&folder, &Catalogs::default()).expect("sound"));
    assert_eq!(outcome.verdict, Verdict::InsufficientData, "{}", outcome.to_text());
    assert!(outcome.effects.is_empty());
    let sentence = outcome.reasons.iter().find(|r| r.contains("missing at and beyond wrist"));
    let sentence = sentence.unwrap_or_else(|| panic!("{}", outcome.to_text()));
    assert!(sentence.contains("2.24 kg") && sentence.contains("13.78 kg"), "{sentence}");
    assert!(outcome.kept_out.is_none(), "one pose cannot be predicted from none");
}
