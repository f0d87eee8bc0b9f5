//! What the exact search finds is the same whoever is quicker: for any number of threads, with a gap too, where one front
//! of many is found.

use armwright::catalog::Catalogs;
use armwright::exact::{Exact, ExactOutcome};
use armwright::input::Document;
use armwright::study::named;
use armwright::study::{Study, read_study};
use std::sync::atomic::AtomicBool;

fn study(name: &str, catalogs: &Catalogs) -> Study {
    let document = Document::parse(name, named(name).expect("a named study")).expect("JSON");
    read_study(document, catalogs).expect("a named study is whole")
}

/// Searches a study on one thread and on several, and returns what both found.
fn on_any_threads(study: &Study, catalogs: &Catalogs, of: impl Fn(Exact) -> Exact + Sync) -> ExactOutcome {
    let stop = AtomicBool::new(false);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| of(Exact::new(&study.space, catalogs, &stop, None)).run(&[]))
    };
    let one = on(1);
    let several = on(3);
    assert_eq!(several.boxes, one.boxes, "boxes of {} on three threads", study.name);
    assert!(several == one, "another front of {} on three threads", study.name);
    one
}

#[test]
fn a_front_by_boxes_is_the_same_for_any_number_of_threads() {
    let catalogs = Catalogs::builtin();
    let study = study("light-arm", &catalogs);
    let whole = on_any_threads(&study, &catalogs, |search| search);
    let with_gap = on_any_threads(&study, &catalogs, |search| search.to_gap(0.02));
    assert!(with_gap.front != whole.front && with_gap.boxes < whole.boxes, "the gap makes no difference");
}

#[test]
fn a_front_by_regions_is_the_same_for_any_number_of_threads() {
    let catalogs = Catalogs::builtin();
    let mut study = study("full-catalog", &catalogs);
    study.space.constraints.mass_max_kg = Some(13.75);
    // the front with a gap is one of many, so it says more than the only one without
    let with_gap = on_any_threads(&study, &catalogs, |search| search.with_ties_up_to(0).to_gap(0.003));
    assert!(with_gap.gap == Some(0.003) && !with_gap.front.is_empty());
}
