//! Answers questions about designs of a study, for optimizers that are written elsewhere.
//!
//! `cargo run --release --example design_objectives -- STUDY` first prints one line: the number of options of every
//! level, tip first. Then it reads lines from standard input. A line is a design: the index of an option for each
//! level, tip first. An empty line sends the answers off.
//!
//! The answer to a design is a line of four numbers. If the arm can be completed, they are the deflection \[mm\], the
//! mass \[kg\], the lowest mode \[Hz\], and how many of the study's limits on these three are broken. If a part fails
//! while the arm is built up from the tip, the answer is `1e9 1e9 0` and a number above 1. This number is larger the
//! nearer to the tip the part is.

use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::space::ArmProblem;
use armwright::space::OutwardIn;
use armwright::study::named;
use armwright::study::read_study;
use std::io::{BufRead, Write};

fn main() -> std::io::Result<()> {
    let study = std::env::args().nth(1).unwrap_or_else(|| "compare-materials".into());
    let text = match named(&study) {
        Some(text) => text.to_string(),
        None => std::fs::read_to_string(&study)?,
    };
    let catalogs = Catalogs::builtin();
    let document = Document::parse(&study, &text).expect("a study is JSON");
    let study = read_study(document, &catalogs).expect("a sound study");
    let problem = ArmProblem::new(&study.space, &catalogs);
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    let sizes: Vec<String> = problem.level_sizes().iter().map(u32::to_string).collect();
    writeln!(out, "{}", sizes.join(" "))?;
    out.flush()?;
    for line in std::io::stdin().lock().lines() {
        let options: Vec<u32> = line?.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        if options.is_empty() {
            out.flush()?;
            continue;
        }
        let slots = sizes.len() as f64;
        match problem.walk(&options, |_, _| {}) {
            Err(slot) => writeln!(out, "1e9 1e9 0 {}", 1.0 + slots / (1.0 + slot as f64))?,
            Ok(complete) => {
                let o = problem.objectives(&complete).expect("a complete arm has objectives");
                let broken = study.space.constraints.broken(&o).into_iter().filter(|b| *b).count();
                let (mm, kg, hz) = (1e3 * o.tip_deflection_m, o.mass_kg, o.lowest_mode_hz);
                writeln!(out, "{mm:e} {kg:e} {hz:e} {broken}")?;
            }
        }
    }
    out.flush()
}
