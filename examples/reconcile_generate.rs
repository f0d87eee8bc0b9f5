//! Makes campaigns with hidden effects from the independent witness.
//!
//! `cargo run --release --example reconcile_generate -- OUT SEED COUNT plain|hard|none|pair`
//!
//! or one campaign in the folder OUT of a six-axis arm file, j1 to j6, with the effects of a JSON list:
//!
//! `cargo run --release --example reconcile_generate -- OUT SEED arm ARM.json EFFECTS.json`

use serde_json::Value;
use std::path::Path;

#[path = "../tests/reconcile_generator/mod.rs"]
mod reconcile_generator;
#[path = "../tests/witness/mod.rs"]
mod witness;

use reconcile_generator::{Dice, Plan, arm, effect, everything, write};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [out, seed, word, arm, effects] = arguments.as_slice()
        && word == "arm"
    {
        return measured(Path::new(out), seed, arm, effects);
    }
    let [out, seed, count, class] = arguments.as_slice() else {
        eprintln!("give OUT SEED COUNT plain|hard|none|pair, or OUT SEED arm ARM.json EFFECTS.json");
        std::process::exit(2)
    };
    let (seed, count) = (seed.parse::<u64>().expect("seed"), count.parse::<usize>().expect("count"));
    let out = Path::new(out);
    std::fs::create_dir_all(out.join("keys")).expect("folder");
    let all = everything();
    for i in 0..count {
        let mut dice = Dice(seed.wrapping_mul(1000).wrapping_add(i as u64));
        let arm = arm(&mut dice);
        let plan = match class.as_str() {
            "hard" => Plan::hard(&mut dice),
            _ => Plan::plain(),
        };
        let mut hidden = Vec::new();
        let effects = match class.as_str() {
            "none" => 0,
            "pair" => 2,
            _ => 1,
        };
        for k in 0..effects {
            let (name, at) = all[(i + k * (7 + i % 11)) % all.len()];
            hidden.push(effect(&mut dice, &arm, name, at, plan.size));
        }
        let name = format!("{class}-{seed}-{i:03}");
        let key = out.join("keys").join(format!("{name}.json"));
        write(&mut dice, &out.join("campaigns").join(&name), &key, &arm, &hidden, &plan);
    }
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
    write(dice, out, &key, &arm, hidden.as_array().expect("a list"), &plan);
}
