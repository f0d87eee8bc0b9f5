//! Benchmarks of the sweep, and of the full model that evaluates a single arm. Run them with `cargo bench --bench
//! sweep`. Rates are in items (designs or arms) per second on one thread.

mod common;

use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::search::Sweep;
use armwright::space::ArmProblem;
use armwright::space::OutwardIn;
use armwright::space::design::full_objectives;
use armwright::study::named;
use armwright::study::{Study, read_study};
use divan::Bencher;
use divan::counter::ItemsCount;
use std::sync::atomic::AtomicBool;

fn main() {
    divan::main();
}

fn compare_materials(catalogs: &Catalogs) -> Study {
    let text = named("compare-materials").expect("built in");
    read_study(Document::parse("study", text).expect("JSON"), catalogs).expect("whole")
}

fn sweep(bencher: Bencher, study: &Study, catalogs: &Catalogs) {
    let problem = ArmProblem::new(&study.space, catalogs);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread can be had");
    let stop = AtomicBool::new(false);
    let run = || pool.install(|| Sweep::new(&problem, study.space.constraints, &stop).run());
    let evaluated = run().designs_evaluated;
    bencher.counter(ItemsCount::new(evaluated)).bench(run);
}

/// Sweeps an arm with rigid links and given joints in one pose. `options` is the number of options of each link.
#[divan::bench(args = [1000, 3162], sample_count = 5)]
fn simple_model(bencher: Bencher, options: u32) {
    let catalogs = Catalogs::builtin();
    sweep(bencher, &common::simple(options, &catalogs), &catalogs);
}

/// Sweeps the study `compare-materials` (full link model, gears with three segments, six sized joints) in its stretched
/// pose alone.
#[divan::bench(sample_count = 3)]
fn full_model_one_pose(bencher: Bencher) {
    let catalogs = Catalogs::builtin();
    let mut study = compare_materials(&catalogs);
    (study.space.judged_cases, study.space.sizing_cases) = (vec![0], vec![0]);
    study.space.cases.truncate(1);
    sweep(bencher, &study, &catalogs);
}

/// Sweeps the study `compare-materials` in all of its poses.
#[divan::bench(sample_count = 3)]
fn full_model_compare_materials(bencher: Bencher) {
    let catalogs = Catalogs::builtin();
    sweep(bencher, &compare_materials(&catalogs), &catalogs);
}

/// Evaluates one six-axis arm of the study `compare-materials` by the full model, in all poses of the study. `armwright
/// analyze` prints these numbers.
#[divan::bench]
fn analyze_six_axis_arm(bencher: Bencher) {
    let catalogs = Catalogs::builtin();
    let study = compare_materials(&catalogs);
    let problem = ArmProblem::new(&study.space, &catalogs);
    let middle: Vec<u32> = problem.level_sizes().iter().map(|n| n / 2).collect();
    let arm = problem.arm(&middle).expect("the arm in the middle of the space holds");
    let cases = problem.load_cases();
    bencher.counter(ItemsCount::new(1u32)).bench(|| full_objectives(&arm, &cases));
}
