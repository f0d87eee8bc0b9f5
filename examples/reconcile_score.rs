//! temporary probe
use armwright::catalog::Catalogs;
use armwright::reconcile::campaign::Campaign;
use armwright::reconcile::fit::Weights;
use armwright::reconcile::forward::Forward;
use armwright::reconcile::model::{Nuisance, candidates};
use armwright::reconcile::select::Search;
use std::path::Path;
fn main() {
    let mut total = std::time::Duration::ZERO;
    for name in std::env::args().skip(1) {
        let t = std::time::Instant::now();
        let campaign = Campaign::read(Path::new(&name), &Catalogs::default()).unwrap();
        let forward = Forward::new(&campaign);
        let nuisance = Nuisance::new(&campaign.arm, &campaign.statement.tolerance);
        let weights = Weights { inverse: forward.data.iter().map(|d| 1.0 / d.sigma).collect() };
        let candidates = candidates(&forward);
        let search = Search { forward: &forward, nuisance: &nuisance, candidates: &candidates, weights: &weights };
        let t1 = t.elapsed();
        let s = search.run();
        let label = |e: &[usize]| e.iter().map(|i| candidates[*i].label()).collect::<Vec<_>>().join("+");
        println!("{} n {} bare {:.0} best {:.0} ({:.2}/dof) score +{:.1} {}  [{} ms, {} ms]", campaign.statement.name, forward.data.len(), s.bare.objective, s.best.objective, s.best.objective/forward.data.len() as f64, s.best.score - s.bare.score, label(&s.best.effects), t1.as_millis(), t.elapsed().as_millis());
        for o in s.others.iter().filter(|o| o.effects != s.best.effects).take(3) {
            println!("        {:.1} {:.0} {}", o.score - s.best.score, o.objective, label(&o.effects));
        }
        total += t.elapsed();
    }
    println!("{total:?}");
}
