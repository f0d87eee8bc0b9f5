//! Makes campaigns with hidden effects from the independent witness.
//!
//! `cargo run --release --example reconcile_generate -- OUT SEED COUNT plain|hard|static|modal|windup|varied|geared one|two|none|later|unknown|further [SIGMA]`
//!
//! `plain` and `hard` are six-axis arms, `static`, `modal` and `windup` the same with one kind of readings, `varied` is arms of four to seven joints of any size, on floor, wall or ceiling;
//! all joints of those of `geared` have torsion curves.
//! With `SIGMA` an effect that departs by less from what calibration within tolerance can imitate is made
//! larger until it does not: one that nobody could see is no question. Or one campaign in the folder OUT of
//! a six-axis arm file, j1 to j6, with the effects of a JSON list:
//!
//! `cargo run --release --example reconcile_generate -- OUT SEED arm ARM.json EFFECTS.json`

use armwright::catalog::Catalogs;
use armwright::reconcile::Campaign;
use serde_json::Value;
use std::path::Path;

#[path = "../tests/reconcile/scoring/detectability.rs"]
mod detectability;
#[path = "../tests/reconcile/generator/mod.rs"]
mod reconcile_generator;
#[path = "../tests/witness/mod.rs"]
mod witness;

use reconcile_generator::{Dice, Plan, Specimen, write};

/// Most steps by which an effect is made larger.
const MOST_STEPS: i32 = 8;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [out, seed, word, arm, effects] = arguments.as_slice()
        && word == "arm"
    {
        measured(Path::new(out), seed, arm, effects);
        return Ok(());
    }
    let [out, seed, count, set, class, sigma @ ..] = arguments.as_slice() else {
        return Err("give OUT SEED COUNT plain|hard|static|modal|windup|varied|geared one|two|none|later|unknown|further [SIGMA]".into());
    };
    let out = Path::new(out);
    let (seed, count) = (seed.parse::<u64>()?, count.parse::<usize>()?);
    let least = sigma.first().map_or(Ok(0.0), |s| s.parse::<f64>())?;
    for number in 0..count {
        for eased in 0..MOST_STEPS {
            let (name, hidden) = reconcile_generator::make(out, set, class, seed, number, eased);
            let campaign = Campaign::read(&out.join("campaigns").join(name), &Catalogs::default())?;
            let seen = detectability::detectable_sigmas(&campaign, &hidden);
            if hidden.is_empty()
                || ["unknown", "further"].contains(&class.as_str())
                || seen.unwrap_or(0.0) >= least
            {
                break;
            }
        }
    }
    Ok(())
}

/// A campaign of a given arm with given effects; the key is written beside the folder.
fn measured(out: &Path, seed: &str, arm: &str, effects: &str) {
    let read = |file: &str| -> Value {
        let text = std::fs::read_to_string(file).unwrap_or_else(|e| panic!("{file}: {e}"));
        serde_json::from_str(&text).expect("JSON")
    };
    let (arm, hidden) = (read(arm), read(effects));
    let plan = Plan { static_poses: 24, modal_poses: 8, ..Plan::plain() };
    let dice = &mut Dice(seed.parse().expect("seed"));
    let key = out.with_extension("key.json");
    write(dice, out, &key, &Specimen::six_axis_of(arm), hidden.as_array().expect("a list"), &plan);
}
