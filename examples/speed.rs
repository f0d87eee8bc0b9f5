//! Measures the speed of the exhaustive sweep, and whether its memory stays constant as the space grows.
//!
//! `cargo run --release --example speed -- simple 1e6 1e7 1e8` sweeps an arm with two links and given joints (rigid
//! links, one pose) over 1e6, 1e7 and 1e8 designs. `-- compare-materials` sweeps the named study (full link model,
//! gears with three segments, six sized joints, three poses), and `-- FILE.json` sweeps the study in a file. The sweep
//! runs on one thread. Rates are in designs per second of processor time.

#[path = "../benches/common/mod.rs"]
mod common;

use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::search::Sweep;
use armwright::space::ArmProblem;
use armwright::study::named;
use armwright::study::{Study, read_study};
use std::sync::atomic::AtomicBool;

fn main() {
    let mut words = std::env::args().skip(1);
    let study = words.next().unwrap_or_else(|| "simple".into());
    let catalogs = Catalogs::builtin();
    let text = match study.ends_with(".json") {
        true => Some(std::fs::read_to_string(&study).expect("a file that can be read")),
        false => named(&study).map(String::from),
    };
    if let Some(text) = text {
        let document = Document::parse(&study, &text).unwrap_or_else(|faults| panic!("{faults}"));
        report(&read_study(document, &catalogs).unwrap_or_else(|faults| panic!("{faults}")), &catalogs);
        return;
    }
    let sizes: Vec<f64> = words.filter_map(|w| w.parse().ok()).collect();
    for designs in if sizes.is_empty() { vec![1e6, 1e7, 1e8] } else { sizes } {
        report(&common::simple(designs.sqrt().round() as u32, &catalogs), &catalogs);
    }
}

fn report(study: &Study, catalogs: &Catalogs) {
    let problem = ArmProblem::new(&study.space, catalogs);
    let stop = AtomicBool::new(false);
    let sweep = Sweep::new(&problem, study.space.constraints, &stop);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread can be had");
    let before = processor_s();
    let outcome = pool.install(|| sweep.run());
    let spent_s = processor_s() - before;
    let lightest = outcome.front.iter().map(|c| c.objectives).min_by(|a, b| a.mass_kg.total_cmp(&b.mass_kg));
    println!(
        "{}: {} designs, {} evaluated, {spent_s:.2} s of one core, {:.3e} designs/s/core, {} candidates, peak {} MB",
        study.name,
        outcome.designs_total,
        outcome.designs_evaluated,
        outcome.designs_evaluated as f64 / spent_s,
        outcome.front.len(),
        peak_mb()
    );
    if let Some(o) = lightest {
        let (kg, mm, hz) = (o.mass_kg, 1e3 * o.tip_deflection_m, o.lowest_mode_hz);
        println!("  lightest {kg:.6} kg, {mm:.6} mm, {hz:.6} Hz");
    }
}

/// Processor time of this process so far \[s\]. Other processes do not count.
fn processor_s() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = stat.rsplit(')').next().unwrap_or_default();
    let ticks: f64 =
        after_name.split_whitespace().skip(11).take(2).filter_map(|t| t.parse::<f64>().ok()).sum();
    ticks / 100.0
}

/// Largest resident memory of this process so far \[MB\].
fn peak_mb() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|l| l.starts_with("VmHWM")).unwrap_or_default();
    line.split_whitespace().nth(1).and_then(|kb| kb.parse::<u64>().ok()).unwrap_or(0) / 1024
}
