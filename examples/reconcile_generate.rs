//! Makes campaigns with hidden effects from the independent witness.
//!
//! `cargo run --release --example reconcile_generate -- OUT SEED COUNT plain|hard one|two|none|unknown`

use std::path::Path;

#[path = "../tests/reconcile_generator/mod.rs"]
mod reconcile_generator;
#[path = "../tests/witness/mod.rs"]
mod witness;

use reconcile_generator::make;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [out, seed, count, set, class] = arguments.as_slice() else {
        eprintln!("give OUT SEED COUNT plain|hard one|two|none|unknown");
        std::process::exit(2)
    };
    let (seed, count) = (seed.parse::<u64>().expect("seed"), count.parse::<usize>().expect("count"));
    for number in 0..count {
        make(Path::new(out), set, class, seed, number);
    }
}
