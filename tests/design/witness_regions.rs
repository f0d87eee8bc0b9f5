//! Fronts of spaces far too large to visit, checked region by region by the verifier, which shares no code with the search.

use armwright::catalog::Catalogs;
use armwright::exact::Exact;
use armwright::input::Document;
use armwright::pareto::Objectives;
use armwright::study::named;
use armwright::study::question::question;
use armwright::study::{Study, read_study};
use armwright::verify::{Judge, Looked, Settings};
use std::sync::atomic::AtomicBool;

fn full_catalog(catalogs: &Catalogs, up_to_kg: f64) -> Study {
    let document = Document::parse("full-catalog", named("full-catalog").expect("a named study"));
    let mut study = read_study(document.expect("JSON"), catalogs).expect("a named study is whole");
    study.space.constraints.mass_max_kg = Some(up_to_kg);
    study
}

fn look(study: &Study, catalogs: &Catalogs, rows: &[Objectives], apart: f64) -> Looked {
    let by = Settings { apart, ..Settings::default() };
    let question = question(&study.space);
    let looked = Judge::new(&question, catalogs).missing(rows, by, &AtomicBool::new(false), None);
    assert_eq!(looked.open, 0);
    looked
}

/// Whether two designs differ by no more than a part in each objective.
fn is_within(part: f64, a: &Objectives, b: &Objectives) -> bool {
    let near = |a: f64, b: f64| (a / b - 1.0).abs() <= part;
    near(a.mass_kg, b.mass_kg)
        && near(a.tip_deflection_m, b.tip_deflection_m)
        && near(a.lowest_mode_hz, b.lowest_mode_hz)
}

/// A hand more than rounding.
const SAME: f64 = 1e-6;

#[test]
fn of_the_light_arms_of_the_whole_catalog_none_is_missing_and_what_is_dropped_is_found() {
    let (catalogs, stop) = (Catalogs::builtin(), AtomicBool::new(false));
    let study = full_catalog(&catalogs, 13.70);
    let front = Exact::new(&study.space, &catalogs, &stop, None).with_ties_up_to(0).run(&[]).front;
    let rows: Vec<Objectives> = front.iter().map(|c| c.objectives).collect();
    assert!(rows.len() > 20, "{} rows", rows.len());
    let found = |rows: &[Objectives]| -> Vec<Objectives> {
        look(&study, &catalogs, rows, 0.0).candidates.into_iter().map(|design| design.objectives).collect()
    };
    for design in found(&rows) {
        assert!(rows.iter().any(|row| is_within(SAME, row, &design)), "{design:?} is beside the rows");
    }
    let mut rest = rows.clone();
    let dropped = [rows.len() - 1, rows.len() / 2].map(|row| rest.remove(row));
    let found = found(&rest);
    for lost in dropped {
        assert!(found.iter().any(|design| is_within(SAME, design, &lost)), "{lost:?} is not found");
    }
}

#[test]
fn a_gap_is_proved_and_one_that_is_claimed_too_small_is_found_out() {
    const GAP: f64 = 0.01;
    let (catalogs, stop) = (Catalogs::builtin(), AtomicBool::new(false));
    let study = full_catalog(&catalogs, 13.8);
    let search = Exact::new(&study.space, &catalogs, &stop, None).with_ties_up_to(0).to_gap(GAP);
    let rows: Vec<Objectives> = search.run(&[]).front.iter().map(|c| c.objectives).collect();
    let taken_for_better = |gap: f64| -> Vec<Objectives> {
        let factor = 1.0 + gap + SAME;
        let better = |row: &Objectives| Objectives {
            mass_kg: row.mass_kg / factor,
            tip_deflection_m: row.tip_deflection_m / factor,
            lowest_mode_hz: row.lowest_mode_hz * factor,
        };
        rows.iter().map(better).collect()
    };
    let looked = look(&study, &catalogs, &taken_for_better(GAP), 0.45 * GAP);
    assert_eq!(looked.candidates, [], "of {} rows", rows.len());
    let looked = look(&study, &catalogs, &taken_for_better(GAP / 8.0), 0.0);
    assert!(!looked.candidates.is_empty(), "an eighth of the gap is proved by {} rows", rows.len());
}
