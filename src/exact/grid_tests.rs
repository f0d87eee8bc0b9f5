//! Tests of the grid that thins designs out.

use super::*;
use proptest::prelude::*;

fn designs() -> impl Strategy<Value = Vec<Objectives>> {
    let design =
        (1.0f64..3.0, 1.0f64..3.0, 1.0f64..3.0).prop_map(|(mass_kg, tip_deflection_m, lowest_mode_hz)| {
            Objectives { tip_deflection_m, mass_kg, lowest_mode_hz }
        });
    prop::collection::vec(design, 1..60)
}

proptest! {
    #[test]
    fn for_every_design_one_is_kept_that_is_no_worse_by_more_than_a_step(all in designs(), step in 0.02f64..0.6) {
        let kept = thinned(all.clone(), step, |o| o);
        let most = libm::exp(step) * (1.0 + 1e-12);
        for o in &all {
            prop_assert!(kept.iter().any(|k| k.mass_kg <= o.mass_kg * most
                && k.tip_deflection_m <= o.tip_deflection_m * most
                && k.lowest_mode_hz * most >= o.lowest_mode_hz));
        }
        let cells = kept.iter().map(|o| [o.mass_kg, o.tip_deflection_m].map(|x| (libm::log(x) / step).floor() as i64));
        let columns: std::collections::BTreeSet<[i64; 2]> = cells.collect();
        prop_assert_eq!(columns.len(), kept.len(), "two in one column of cells");
    }
}
