//! Times the exact search of a study, and compares it with the sweep where that is small enough.
use armwright::catalog::Catalogs;
use armwright::fault::Document;
use armwright::search::exact::Exact;
use armwright::search::front::nondominated;
use armwright::search::{ArmProblem, Sweep, evaluate};
use armwright::study::{named, read_study};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

fn main() {
    let name = std::env::args().nth(1).expect("a study");
    let text = named(&name).map_or_else(|| std::fs::read_to_string(&name).expect("a file"), str::to_string);
    let catalogs = Catalogs::builtin();
    let document = Document::parse(&name, &text).unwrap_or_else(|e| panic!("{e}"));
    let study = read_study(document, &catalogs).unwrap_or_else(|e| panic!("{e}"));
    let stop = AtomicBool::new(false);
    let started = Instant::now();
    let exact = Exact::new(&study.space, &catalogs, &stop, None);
    let finished = AtomicBool::new(false);
    let outcome = std::thread::scope(|scope| {
        scope.spawn(|| {
            while !finished.load(std::sync::atomic::Ordering::Relaxed) {
                std::thread::sleep(std::time::Duration::from_secs(2));
                eprintln!("{:.0} s: {}", started.elapsed().as_secs_f64(), exact.boxes());
            }
        });
        let outcome = exact.run(&[]);
        finished.store(true, std::sync::atomic::Ordering::Relaxed);
        outcome
    });
    let seconds = started.elapsed().as_secs_f64();
    let points: Vec<_> = outcome.front.iter().map(|c| c.objectives.minimized()).collect();
    let front = nondominated(&points);
    println!(
        "{name}: {:e} designs, {} boxes, {} judged, {} kept, front {} in {seconds:.2} s",
        outcome.designs_total as f64,
        outcome.boxes,
        outcome.designs_evaluated,
        outcome.front.len(),
        front.len()
    );
    if outcome.designs_total > 50_000_000 || std::env::args().nth(2).is_some() {
        return;
    }
    let problem = ArmProblem::new(&study.space, &catalogs);
    let started = Instant::now();
    let sweep = Sweep::new(&problem, study.space.constraints, &stop).run();
    let judged: Vec<_> = sweep.front.iter().filter_map(|c| evaluate(&problem, c.number)).collect();
    let theirs: Vec<_> = judged.iter().map(|d| d.objectives.minimized()).collect();
    let groups = nondominated(&theirs);
    println!("sweep: front {} in {:.2} s", groups.len(), started.elapsed().as_secs_f64());
    let numbers = |groups: &[Vec<usize>], of: &dyn Fn(usize) -> u128| {
        let mut all: Vec<u128> = groups.iter().flatten().map(|&i| of(i)).collect();
        all.sort_unstable();
        all
    };
    let mine = numbers(&front, &|i| outcome.front[i].number);
    let swept = numbers(&groups, &|i| judged[i].number);
    println!("same designs: {}", mine == swept);
    for n in swept.iter().filter(|n| !mine.contains(n)).take(5) {
        let d = judged.iter().find(|d| d.number == *n).expect("judged");
        println!("  missed {n}: {:?}", d.objectives);
    }
    for n in mine.iter().filter(|n| !swept.contains(n)).take(5) {
        let d = outcome.front.iter().find(|d| d.number == *n).expect("kept");
        println!("  extra {n}: {:?}", d.objectives);
    }
}
