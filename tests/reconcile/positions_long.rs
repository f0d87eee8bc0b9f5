//! Long campaigns of absolute positions: effects are screened on a part of the rows, and everything else uses all rows.

use crate::positions_maker::{Made, Truth, in_poses};
use armwright::catalog::Catalogs;
use armwright::reconcile::{Campaign, Outcome, Verdict, reconcile};

/// Number of rows of a campaign that is searched on all of its rows, of one that is screened, and three times as many.
const SHORT: usize = 1_000;
const LONG: usize = 5_200;
const LONGER: usize = 15_600;

fn reconciled(rows: usize, truth: &dyn Fn(&Made, &[f64; 3], usize) -> Truth) -> Outcome {
    let folder = in_poses(rows).write(truth);
    reconcile(&Campaign::read(folder.path(), &Catalogs::default()).unwrap_or_else(|e| panic!("{e}")))
}

fn with_threads(threads: usize, work: impl FnOnce() -> Outcome + Send) -> Outcome {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads").install(work)
}

fn labels(outcome: &Outcome) -> Vec<String> {
    let mut out: Vec<String> = outcome.effects.iter().map(|f| f.label()).collect();
    out.sort();
    out
}

/// Low end, value and high end of the stiffness of an effect.
fn interval(outcome: &Outcome, label: &str) -> [f64; 3] {
    let finding = outcome.effects.iter().find(|f| f.label() == label).expect("found");
    let estimate = finding.parameters[0].1[0];
    [estimate.low.expect("bounded"), estimate.value, estimate.high.expect("bounded")]
}

fn says_that_it_was_screened(outcome: &Outcome) -> bool {
    outcome
        .reasons
        .iter()
        .any(|reason| reason.contains(" positions, and once more on all") && reason.contains("screened"))
}

#[test]
fn three_times_the_rows_name_the_same_effects_with_intervals_that_hold_and_are_no_wider() {
    let short = reconciled(SHORT, &Made::sagging);
    let long = with_threads(2, || reconciled(LONG, &Made::sagging));
    let longer = reconciled(LONGER, &Made::sagging);
    assert_eq!(longer.verdict, Verdict::Explained, "{}", longer.to_text());
    assert_eq!([labels(&long), labels(&longer)], [labels(&short), labels(&short)], "{}", longer.to_text());
    assert!(says_that_it_was_screened(&longer) && !says_that_it_was_screened(&short), "{:?}", longer.reasons);
    let made = in_poses(LONGER);
    for finding in &longer.effects {
        let [[low, value, high], [few_low, few_value, few_high]] =
            [&longer, &long].map(|outcome| interval(outcome, &finding.label()));
        let truth = made.stiffness_nm_per_rad(&finding.at, &finding.effect).expect("one that the arm has");
        assert!(low < truth && truth < high, "{}: {truth} in {low} to {high}", finding.label());
        let part = (high - low) / value / ((few_high - few_low) / few_value);
        // what the tolerances of masses and links leave open does not shrink with the rows
        assert!(part < 1.02, "{}: {part}", finding.label());
    }
    assert_eq!(longer.residuals.len(), 3 * LONGER, "residuals of all rows");
    assert!(longer.residuals.iter().all(|r| r.held_out.is_some()), "all rows were held out");
    let alone = with_threads(1, || reconciled(LONG, &Made::sagging));
    let [alone, long] = [alone, long].map(|outcome| {
        let folder = tempfile::tempdir().expect("a folder");
        outcome.write(folder.path()).expect("written");
        let bytes = |name: &str| std::fs::read(folder.path().join(name)).expect(name);
        ["verdict.json", "residuals.csv", "arm.corrected.json"].map(bytes)
    });
    assert!(alone == long, "one thread and two write the same bytes");
}

/// A session needs five rows on either side. Of the seven before this boundary the screening takes about three.
#[test]
fn a_session_that_the_screened_rows_cannot_show_is_found() {
    let outcome = reconciled(LONG, &Made::put_back_soon);
    let found = outcome.reasons.iter().any(|r| r.contains("tip sat 3.2") && r.contains("before row 8"));
    assert!(found, "{}", outcome.to_text());
}
