//! Makes campaigns with hidden effects from the independent witness.
//!
//! `cargo run --release --example reconcile_generate -- OUT SEED COUNT plain|hard one|two|none|unknown [SIGMA]`
//!
//! With `SIGMA` an effect that departs by less from what calibration within tolerance can imitate is made
//! larger until it does not: one that nobody could see is no question.

use armwright::catalog::Catalogs;
use armwright::reconcile::Campaign;
use std::path::Path;

#[path = "../tests/reconcile_scoring/detectability.rs"]
mod detectability;
#[path = "../tests/reconcile_generator/mod.rs"]
mod reconcile_generator;
#[path = "../tests/witness/mod.rs"]
mod witness;

/// Most steps by which an effect is made larger.
const MOST_STEPS: i32 = 8;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [out, seed, count, set, class, sigma @ ..] = arguments.as_slice() else {
        return Err("give OUT SEED COUNT plain|hard one|two|none|unknown [SIGMA]".into());
    };
    let out = Path::new(out);
    let (seed, count) = (seed.parse::<u64>()?, count.parse::<usize>()?);
    let least = sigma.first().map_or(Ok(0.0), |s| s.parse::<f64>())?;
    for number in 0..count {
        for eased in 0..MOST_STEPS {
            let (name, hidden) = reconcile_generator::make(out, set, class, seed, number, eased);
            let campaign = Campaign::read(&out.join("campaigns").join(name), &Catalogs::default())?;
            let seen = detectability::detectable_sigmas(&campaign, &hidden);
            if hidden.is_empty() || class == "unknown" || seen.unwrap_or(0.0) >= least {
                break;
            }
        }
    }
    Ok(())
}
