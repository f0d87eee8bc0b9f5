//! temporary probe
use armwright::catalog::Catalogs;
use armwright::reconcile::campaign::Campaign;
use armwright::reconcile::forward::Forward;
use armwright::reconcile::model::{Nuisance, candidates};
use armwright::reconcile::noise::Noise;
use armwright::reconcile::select::Search;
use std::path::Path;
fn main() {
    let mut total = std::time::Duration::ZERO;
    for name in std::env::args().skip(1) {
        let t = std::time::Instant::now();
        let campaign = Campaign::read(Path::new(&name), &Catalogs::default()).unwrap();
        let forward = Forward::new(&campaign);
        let nuisance = Nuisance::new(&campaign.arm, &campaign.statement.tolerance);
        let candidates = candidates(&forward);
        let t1 = t.elapsed();
        let mut noise = Noise::default();
        let (mut s, mut w);
        let mut passes = 0;
        loop {
            w = noise.weights(&forward);
            let search =
                Search { forward: &forward, nuisance: &nuisance, candidates: &candidates, weights: &w };
            s = search.run();
            passes += 1;
            let fit = search.fit(&s.best.effects, &s.best.u, Default::default());
            let next = Noise::from_fit(&forward, &fit);
            if passes == 4 || next.agrees(&noise) {
                let lof = armwright::reconcile::lack_of_fit::lack_of_fit(&campaign, &forward, &fit, &w);
                println!(
                    "   {} chi2/dof {:.2} {:?} scale {:?} out {}",
                    if lof.fails { "FAILS" } else { "ok" },
                    lof.chi2_per_dof,
                    lof.structures
                        .iter()
                        .take(2)
                        .map(|s| format!("{} {} {:.1}", s.channel.word(), s.follows, s.ln_p / 2.3))
                        .collect::<Vec<_>>(),
                    noise.scale,
                    noise.outliers.len()
                );
                break;
            }
            noise = next;
        }
        let label = |e: &[usize]| e.iter().map(|i| candidates[*i].label()).collect::<Vec<_>>().join("+");
        println!(
            "{} p{passes} n {} bare {:.0} best {:.0} ({:.2}/dof) score +{:.1} {}  [{} ms, {} ms]",
            campaign.statement.name,
            forward.data.len(),
            s.bare.objective,
            s.best.objective,
            s.best.objective / forward.data.len() as f64,
            s.best.score - s.bare.score,
            label(&s.best.effects),
            t1.as_millis(),
            t.elapsed().as_millis()
        );
        for o in s.others.iter().filter(|o| o.effects != s.best.effects).take(3) {
            println!("        {:.1} {:.0} {}", o.score - s.best.score, o.objective, label(&o.effects));
        }
        total += t.elapsed();
    }
    println!("{total:?}");
}
