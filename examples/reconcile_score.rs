//! Reconciles every campaign of a folder and scores the verdicts against a folder of keys, which are
//! opened only when all verdicts have been written.
//!
//! `cargo run --release --example reconcile_score -- CAMPAIGNS KEYS [OUT]`
//!
//! `OUT/confusion.csv` counts what was said of what was hidden; `OUT/campaigns.csv` has a line a
//! campaign: right or not, by how many standard deviations the hidden effect can be seen at all, and the
//! time it took.

use armwright::catalog::Catalogs;
use armwright::reconcile::{Campaign, reconcile};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

#[path = "../tests/reconcile_scoring/detectability.rs"]
mod detectability;
#[path = "../tests/reconcile_scoring/mod.rs"]
mod scoring;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, keys, rest @ ..] = arguments.as_slice() else {
        return Err("give a folder of campaigns and a folder of keys".into());
    };
    let temporary = tempfile::tempdir()?;
    let out = rest.first().map_or(temporary.path(), |o| Path::new(o));
    let mut names: Vec<String> =
        std::fs::read_dir(folder)?.filter_map(|e| e.ok()?.file_name().into_string().ok()).collect();
    names.sort();
    let read = |name: &str| Campaign::read(&Path::new(folder).join(name), &Catalogs::default());
    let mut times = Vec::new();
    for name in &names {
        let start = Instant::now();
        let outcome = reconcile(&read(name)?);
        times.push(start.elapsed().as_secs_f64());
        outcome.write(&out.join(name))?;
        print!("[{:.2} s] {}", times[times.len() - 1], outcome.to_text());
    }
    let score = scoring::score(&names, out, Path::new(keys))?;
    print!("{}", score.table());
    let mut lines = String::from("campaign,hidden,right,detectable_sigma,seconds\n");
    let mut bands = BTreeMap::<&str, (usize, usize)>::new();
    for ((name, hidden, right), time) in score.each.iter().zip(&times) {
        let seen = detectability::detectable_sigmas(&read(name)?, hidden);
        let band = match seen {
            _ if hidden.is_empty() => "nothing hidden",
            None => "unknown, or in a channel without readings",
            Some(s) if s < 3.0 => "below 3 sigma",
            Some(s) if s < 5.0 => "3 to 5 sigma",
            Some(s) if s < 8.0 => "5 to 8 sigma",
            Some(_) => "above 8 sigma",
        };
        let entry = bands.entry(band).or_default();
        *entry = (entry.0 + usize::from(*right), entry.1 + 1);
        let seen = seen.map_or(String::new(), |s| format!("{s:.2}"));
        let list: Vec<String> = hidden.iter().map(scoring::label).collect();
        writeln!(lines, "{name},{},{right},{seen},{time:.2}", list.join(" + "))?;
    }
    std::fs::write(out.join("campaigns.csv"), lines)?;
    std::fs::write(out.join("confusion.csv"), score.confusion_csv())?;
    println!("by how many sigma the hidden effect can be seen at all: right, of");
    bands.iter().for_each(|(band, (right, all))| println!("  {band:<42} {right:>3} {all:>3}"));
    let worst = times.iter().copied().fold(0.0, f64::max);
    println!("time: mean {:.2} s, worst {worst:.2} s", times.iter().sum::<f64>() / times.len() as f64);
    Ok(())
}
