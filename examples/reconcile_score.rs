//! Reconciles every campaign of a folder and scores the verdicts. The keys tell what is hidden in each campaign; they
//! are opened only when all verdicts have been written.
//!
//! `cargo run --release --example reconcile_score -- CAMPAIGNS KEYS [OUT]`
//!
//! CAMPAIGNS is a folder of campaigns, and KEYS a folder of their keys. Three files are written to the folder OUT:
//!
//! - `confusion.csv` has the number of campaigns for each pair of hidden effects and named effects.
//! - `campaigns.csv` has a line for each campaign: whether the verdict is right, by how many standard deviations the
//!   hidden effect can be seen at all, and the elapsed time and processor time \[s\].
//! - `intervals.csv` has a line for each parameter: true value, estimate, and the ends of its interval.

use armwright::catalog::Catalogs;
use armwright::reconcile::Campaign;
use armwright::reconcile::reconcile;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

#[path = "../tests/reconcile/scoring/detectability.rs"]
mod detectability;
#[path = "../tests/reconcile/scoring/mod.rs"]
mod scoring;

/// Processor time of this process with all of its threads so far \[s\]; 0 if the system does not tell it.
fn processor_s() -> f64 {
    const TICKS_PER_S: f64 = 100.0;
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = stat.rsplit(')').next().unwrap_or_default();
    let ticks = after_name.split_whitespace().skip(11).take(2).filter_map(|t| t.parse::<f64>().ok());
    ticks.sum::<f64>() / TICKS_PER_S
}

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
        let (start, before_s) = (Instant::now(), processor_s());
        let outcome = reconcile(&read(name)?);
        let (wall_s, cpu_s) = (start.elapsed().as_secs_f64(), processor_s() - before_s);
        times.push((wall_s, cpu_s));
        outcome.write(&out.join(name))?;
        print!("[{wall_s:.2} s, processor {cpu_s:.2} s] {}", outcome.to_text());
    }
    let score = scoring::score(&names, out, Path::new(keys))?;
    print!("{}", score.table());
    let mut lines = String::from("campaign,hidden,right,detectable_sigma,seconds,processor_seconds\n");
    let mut bands = BTreeMap::<&str, (usize, usize)>::new();
    for ((name, hidden, right), (wall_s, cpu_s)) in score.each.iter().zip(&times) {
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
        writeln!(lines, "{name},{},{right},{seen},{wall_s:.2},{cpu_s:.2}", list.join(" + "))?;
    }
    std::fs::write(out.join("campaigns.csv"), lines)?;
    std::fs::write(out.join("intervals.csv"), intervals_csv(&score.intervals))?;
    std::fs::write(out.join("confusion.csv"), score.confusion_csv())?;
    println!("by how many sigma the hidden effect can be seen at all: right, of");
    bands.iter().for_each(|(band, (right, all))| println!("  {band:<42} {right:>3} {all:>3}"));
    summarise("time by the clock", times.iter().map(|t| t.0).collect());
    summarise("time of the processor", times.iter().map(|t| t.1).collect());
    Ok(())
}

fn intervals_csv(lines: &[String]) -> String {
    format!("campaign,effect,at,parameter,true,value,low,high,holds\n{}\n", lines.join("\n"))
}

fn summarise(what: &str, mut seconds: Vec<f64>) {
    seconds.sort_by(f64::total_cmp);
    let mean = seconds.iter().sum::<f64>() / seconds.len().max(1) as f64;
    let at = |part: f64| seconds.get((part * seconds.len() as f64) as usize).or(seconds.last()).copied();
    let (middle, worst) = (at(0.5).unwrap_or(0.0), at(1.0).unwrap_or(0.0));
    println!("{what}: mean {mean:.2} s, median {middle:.2} s, worst {worst:.2} s");
}
