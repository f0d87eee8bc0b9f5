//! Campaigns made by an independent model. They are reconciled without their answer keys, which are read only after all
//! verdicts have been written.

use crate::scoring;
use armwright::catalog::Catalogs;
use armwright::reconcile::Campaign;
use armwright::reconcile::reconcile;
use std::path::{Path, PathBuf};

fn data(folder: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(folder)
}

#[test]
fn made_campaigns_are_named_as_their_keys_say() {
    let out = tempfile::tempdir().expect("temporary folder");
    let mut names: Vec<String> = std::fs::read_dir(data("campaigns"))
        .expect("campaigns")
        .map(|entry| entry.expect("entry").file_name().into_string().expect("name"))
        .collect();
    names.sort();
    for name in &names {
        let campaign = Campaign::read(&data("campaigns").join(name), &Catalogs::default()).expect("sound");
        reconcile(&campaign).write(&out.path().join(name)).expect("written");
    }
    let score = scoring::score(&names, out.path(), &data("campaign_keys")).expect("scored");
    println!("{}\n{}", score.table(), score.confusion_csv());
    assert!(score.classes.values().all(|(right, all)| right == all), "{}", score.table());
    assert!(score.covered.0 * 10 >= score.covered.1 * 8, "{}", score.table());
    let limit = |name: &str| if name.starts_with("hard") { 1.45 } else { 1.1 };
    assert!(score.kept_out.iter().all(|(name, rms)| *rms < limit(name)), "{}", score.table());
}

#[test]
fn the_verdict_is_the_same_for_any_number_of_threads() {
    let campaign =
        Campaign::read(&data("campaigns").join("hard-d6dfd"), &Catalogs::default()).expect("sound");
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("pool");
        pool.install(|| reconcile(&campaign).files())
    };
    assert_eq!(with(1), with(3));
}
