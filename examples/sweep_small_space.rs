//! Sweeps a small design space and prints two designs of its Pareto front: the lightest and the one with the highest
//! lowest mode.
//!
//! Run: cargo run --example sweep_small_space

use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::space::ArmProblem;
use armwright::space::design::{Part, id_of, options};
use armwright::study::read_study;
use armwright::study::run_study;
use std::sync::atomic::AtomicBool;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let catalogs = Catalogs::builtin();
    let text = include_str!("bench-arm.json");
    let study = read_study(Document::parse("bench-arm.json", text)?, &catalogs)?;
    let stop = AtomicBool::new(false);
    let outcome = run_study(&study, &catalogs, &stop, |_total, _visited, _finished| {});
    println!(
        "{}: {} designs, {} evaluated, {} excluded by a limit, {} on the front",
        study.name,
        outcome.sweep.designs_total,
        outcome.sweep.designs_evaluated,
        outcome.sweep.designs_excluded,
        outcome.front.len()
    );
    let problem = ArmProblem::new(&study.space, &catalogs);
    let lightest = outcome.front.first().ok_or("no design meets the constraints")?;
    let by_mode = |d: &&armwright::study::Judged| d.design.objectives.lowest_mode_hz;
    let highest = outcome
        .front
        .iter()
        .max_by(|a, b| by_mode(a).total_cmp(&by_mode(b)))
        .expect("a front with a lightest design has a highest mode");
    for (what, judged) in [("lightest", lightest), ("highest mode", highest)] {
        let o = judged.design.objectives;
        println!(
            "{what} {}: {:.2} kg, {:.3} mm, {:.2} Hz",
            id_of(judged.design.number),
            o.mass_kg,
            o.tip_deflection_m * 1e3,
            o.lowest_mode_hz
        );
        let chosen = options(armwright::space::OutwardIn::level_sizes(&problem), judged.design.number);
        for part in problem.parts(&chosen.ok_or("a design of the space")?).ok_or("a design that holds")? {
            match part {
                Part::Link(option) => println!("  {} {:?}", option.material_name, option.section),
                Part::Drive(drive) => println!("  {}", drive.name()),
                Part::Given => {}
            }
        }
    }
    Ok(())
}
