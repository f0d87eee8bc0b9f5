//! Makes campaigns with hidden effects. The readings are computed by the independent witness in `tests/witness`.
//!
//! `cargo run --release --example reconcile_generate -- OUT SEED COUNT plain|hard|static|modal|windup|varied|geared
//! one|two|none|later|unknown|further [SIGMA]`
//!
//! This makes COUNT campaigns below the folder OUT. The next word says which arms and readings they have:
//!
//! - `plain` and `hard`: six-axis arms with all kinds of readings. In `hard` the readings are few, the effects are
//!   small, and some readings are gross errors.
//! - `static`, `modal` and `windup`: six-axis arms with one kind of readings.
//! - `varied`: arms of four to seven joints of any size, on a floor, a wall or a ceiling.
//! - `geared`: the same as `varied`, but every joint has a torsion curve.
//!
//! The word after it says what is hidden: one effect, two effects, nothing, an effect that was added to the library
//! later, unknown physics, or unknown physics that was added later.
//!
//! SIGMA is the least size of a hidden effect: how many standard deviations the readings differ from what calibration
//! within tolerance can imitate. A smaller effect is made larger, in at most eight steps, because nobody could find it.
//! Unknown physics keeps its size.
//!
//! `cargo run --release --example reconcile_generate -- OUT SEED arm ARM.json EFFECTS.json`
//!
//! This makes one campaign in the folder OUT. It is of the six-axis arm in ARM.json, whose joints are called j1 to j6,
//! with the effects of the JSON list in EFFECTS.json.

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

/// Greatest number of sizes that are tried for a hidden effect. Each size is larger than the one before.
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

/// Makes a campaign of the arm in the file `arm` with the effects in the file `effects`. The key, which tells what is
/// hidden, is written next to the folder `out`.
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
