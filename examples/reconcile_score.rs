//! Reconciles every campaign of a folder and scores the verdicts against a folder of keys, which are
//! opened only when all verdicts have been written.
//!
//! `cargo run --release --example reconcile_score -- CAMPAIGNS KEYS [OUT]`

use armwright::catalog::Catalogs;
use armwright::reconcile::{Campaign, reconcile};
use std::path::Path;
use std::time::Instant;

#[path = "../tests/reconcile_scoring/mod.rs"]
mod scoring;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [campaigns, keys, rest @ ..] = arguments.as_slice() else {
        return Err("give a folder of campaigns and a folder of keys".into());
    };
    let temporary = tempfile::tempdir()?;
    let out = rest.first().map_or(temporary.path(), |o| Path::new(o));
    let mut names: Vec<String> =
        std::fs::read_dir(campaigns)?.filter_map(|e| e.ok()?.file_name().into_string().ok()).collect();
    names.sort();
    let mut times = Vec::new();
    for name in &names {
        let start = Instant::now();
        let campaign = Campaign::read(&Path::new(campaigns).join(name), &Catalogs::default())?;
        let outcome = reconcile(&campaign);
        times.push(start.elapsed().as_secs_f64());
        outcome.write(&out.join(name))?;
        print!("[{:.2} s] {}", times[times.len() - 1], outcome.to_text());
    }
    let score = scoring::score(&names, out, Path::new(keys))?;
    print!("{}", score.table());
    let worst = times.iter().copied().fold(0.0, f64::max);
    println!("time: mean {:.2} s, worst {worst:.2} s", times.iter().sum::<f64>() / times.len() as f64);
    Ok(())
}
