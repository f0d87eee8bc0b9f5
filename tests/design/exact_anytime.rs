//! What an exact search says while it runs, and when it is stopped: a gap that holds and that never rises.

use armwright::catalog::Catalogs;
use armwright::exact::{Exact, ExactOutcome, Known};
use armwright::input::Document;
use armwright::pareto::Objectives;
use armwright::space::design_space::SpacePiece;
use armwright::study::named;
use armwright::study::{Study, read_study};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// The study `light-arm` with one of its materials.
fn light_arm(catalogs: &Catalogs) -> Study {
    let document = Document::parse("light-arm", named("light-arm").expect("a named study")).expect("JSON");
    let mut study = read_study(document, catalogs).expect("a named study is whole");
    for piece in &mut study.space.pieces {
        if let SpacePiece::Choice(choice) = piece {
            choice.options =
                choice.options.iter().filter(|option| option.material_index == 0).cloned().collect();
        }
    }
    study
}

/// Searches a study by regions to a gap, and returns every different state that another thread saw. The search is stopped at
/// the first state for which `enough` is true.
fn watched(
    study: &Study,
    catalogs: &Catalogs,
    gap: f64,
    enough: impl Fn(&Known) -> bool + Sync,
) -> (ExactOutcome, Vec<Known>) {
    let (stop, ended) = (AtomicBool::new(false), AtomicBool::new(false));
    let search = Exact::new(&study.space, catalogs, &stop, None).by_regions_from(1e3).to_gap(gap);
    let search = search.with_ties_up_to(0);
    let watch = || {
        let mut seen: Vec<Known> = Vec::new();
        loop {
            let last = ended.load(Ordering::Relaxed);
            let known = search.known();
            if seen.last() != Some(&known) {
                seen.push(known);
            }
            if enough(&known) {
                stop.store(true, Ordering::Relaxed);
            }
            if last {
                return seen;
            }
            std::thread::sleep(Duration::from_micros(200));
        }
    };
    std::thread::scope(|scope| {
        let seen = scope.spawn(watch);
        let outcome = search.run(&[]);
        ended.store(true, Ordering::Relaxed);
        (outcome, seen.join().expect("the watcher ends"))
    })
}

/// The least factor, less one, by which the designs of a front have to be improved so that one of them is no worse than a
/// design.
fn shortfall(front: &[Objectives], design: &Objectives) -> f64 {
    let of = |o: &Objectives| {
        (o.mass_kg / design.mass_kg)
            .max(o.tip_deflection_m / design.tip_deflection_m)
            .max(design.lowest_mode_hz / o.lowest_mode_hz)
    };
    front.iter().map(of).fold(f64::INFINITY, f64::min) - 1.0
}

fn objectives(outcome: &ExactOutcome) -> Vec<Objectives> {
    outcome.front.iter().map(|candidate| candidate.objectives).collect()
}

#[test]
fn the_gap_that_a_search_tells_never_rises_and_ends_at_what_was_asked_for_and_its_first_designs_change_no_front()
 {
    const GAP: f64 = 0.05;
    let catalogs = Catalogs::builtin();
    let study = light_arm(&catalogs);
    let (outcome, seen) = watched(&study, &catalogs, GAP, |_| false);
    let gaps: Vec<f64> = seen.iter().filter_map(|known| known.gap).collect();
    assert!(gaps.windows(2).all(|pair| pair[1] <= pair[0]), "{gaps:?}");
    assert!(gaps[0] > GAP, "a gap is told before the search is done: {gaps:?}");
    assert_eq!((gaps.last(), outcome.gap), (Some(&GAP), Some(GAP)));
    let first = seen.iter().position(|known| known.gap.is_some());
    assert!(seen[first.expect("a gap")..].iter().all(|known| known.front_size > 0), "{seen:?}");
    assert!(seen.windows(2).all(|pair| pair[0].boxes <= pair[1].boxes && pair[0].designs <= pair[1].designs));
    // the search of one material tells of nothing while it runs, so it needs no first gap; here it is all there is
    let stop = AtomicBool::new(false);
    let untold = Exact::new(&study.space, &catalogs, &stop, None).by_regions_from(1e3).to_gap(GAP);
    let untold = untold.with_ties_up_to(0);
    assert_eq!(untold.run_of_material(0), outcome);
    assert_eq!(untold.known().gap, None);
}

#[test]
fn the_gap_of_a_search_that_is_stopped_early_holds_for_every_design_of_the_whole_front() {
    let catalogs = Catalogs::builtin();
    let study = light_arm(&catalogs);
    let stop = AtomicBool::new(false);
    let whole = objectives(&Exact::new(&study.space, &catalogs, &stop, None).run(&[]));
    // in the dives, and after the first passes
    for enough in [f64::INFINITY, 0.2] {
        let (stopped, seen) =
            watched(&study, &catalogs, 0.0, |known| known.gap.is_some_and(|gap| gap <= enough));
        let gap = stopped.gap.expect("a gap was told before the search was stopped");
        assert!(seen.iter().filter_map(|known| known.gap).all(|told| gap <= told), "{gap} {seen:?}");
        let front = objectives(&stopped);
        let worst = whole.iter().map(|design| shortfall(&front, design)).fold(0.0, f64::max);
        assert!(worst <= gap * (1.0 + 1e-9), "some design is {worst} better, and the gap is {gap}");
    }
}
