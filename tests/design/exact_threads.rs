//! What the exact search finds is the same whoever is quicker: for any number of threads, with a gap too, where one front
//! of many is found; and for any number of shards.

use armwright::catalog::Catalogs;
use armwright::exact::{Exact, ExactOutcome, refuse_holes};
use armwright::input::Document;
use armwright::search::sweep::{Candidate, Shard};
use armwright::study::named;
use armwright::study::{Study, read_study};
use serde_json::json;
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
    let with_gap = on_any_threads(&study, &catalogs, |search| search.with_ties_up_to(0).to_gap(0.01));
    assert!(with_gap.gap == Some(0.01) && !with_gap.front.is_empty());
}

/// A study of some thousand designs whose joints and links are choices.
fn small(catalogs: &Catalogs) -> Study {
    let tube = |from: u32| {
        json!({"materials": ["Structural steel S355", "Aluminium 6061-T6"], "sections": [
            {"shape": "round_tube", "diameter_mm": [from, from + 10, from + 30], "wall_mm": [2, 2.5, 3, 4]}]})
    };
    let joint = |name: &str| {
        json!({"type": "joint", "name": name, "axis": [0, 1, 0], "drive": "all_fits",
            "drives": {"gears": ["CSG-32-100", "CSG-40-100"], "motor_models": ["ILM85x26"]}})
    };
    let text = json!({"name": "small", "payload": {"mass_kg": 3}, "chain": [
        joint("shoulder"), {"type": "link", "name": "upper", "vector_m": [0.5, 0, 0], "choose": tube(60)},
        joint("elbow"), {"type": "link", "name": "fore", "vector_m": [0.4, 0, 0], "choose": tube(50)}],
        "poses": [{"name": "out", "pose_deg": [0, 0]}, {"name": "up", "pose_deg": [-40, 90]}]});
    read_study(Document::parse("small", &text.to_string()).expect("JSON"), catalogs).expect("a sound study")
}

#[test]
fn shards_join_to_the_front_of_one_machine_by_boxes_and_by_regions() {
    let (catalogs, stop) = (Catalogs::builtin(), AtomicBool::new(false));
    let study = small(&catalogs);
    for regions_from in [f64::INFINITY, 100.0] {
        let search = || Exact::new(&study.space, &catalogs, &stop, None).by_regions_from(regions_from);
        for material in [None, Some(1)] {
            let whole = material.map_or_else(|| search().run(&[]), |index| search().run_of_material(index));
            assert!(whole.front.len() > 3, "a front of {} shows nothing", whole.front.len());
            let first = search().to_gap(0.2).of_shard(Shard::WHOLE).found(material, &[]);
            for (of, given) in [(1, vec![]), (3, vec![]), (4, vec![first])] {
                let found: Vec<_> = (1..=of)
                    .map(|number| search().of_shard(Shard { number, of }).found(material, &given))
                    .collect();
                let subtrees = found.iter().flat_map(|found| &found.subtrees).map(String::as_str).collect();
                assert_eq!(refuse_holes(subtrees), Ok(()), "{of} shards");
                let joined = search().joined(material, &found);
                assert_eq!((joined.boxes_open, joined.gap), (0, Some(0.0)));
                // objectives may differ in the last bit: they come by another way of boxes
                let numbers = |front: &[Candidate]| front.iter().map(|c| c.number).collect::<Vec<_>>();
                assert_eq!(
                    numbers(&joined.front),
                    numbers(&whole.front),
                    "{of} shards from {regions_from} designs on"
                );
                let mut fewer = found.iter().flat_map(|found| &found.subtrees).map(String::as_str);
                fewer.next();
                assert!(refuse_holes(fewer.collect()).is_err(), "a subtree that is missing is not found");
            }
        }
    }
}
