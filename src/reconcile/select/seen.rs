//! Leaves out the effects that no reading of a campaign can show.

use crate::reconcile::fit::descent::{change, evaluate};
use crate::reconcile::fit::weights::Weights;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::model::calibration::Nuisance;
use crate::reconcile::model::parameters::{Candidate, Model};

/// An effect of its usual size is left out if it changes no reading by more than this \[standard deviations\]. The
/// largest size that is sought is at most a thousand times the usual one. So even an effect of the largest size would
/// not be seen.
const UNSEEN_SIGMAS: f64 = 1e-6;

/// Fraction of its range by which a parameter is changed to find out whether readings change.
const RANGE_STEP: f64 = 0.01;

/// Those of the `candidates` that change at least one reading. A bench, for example, shows no payload, base or mass.
/// An effect that changes no reading fits as well as calibration alone, and would be listed as an alternative of
/// every finding.
pub(crate) fn seen(forward: &Forward, nuisance: &Nuisance, mut candidates: Vec<Candidate>) -> Vec<Candidate> {
    let inverse = forward.data.iter().map(|d| 1.0 / d.sigma).collect();
    let weights = Weights { inverse, smooth_only: false };
    let baseline = Model::baseline(nuisance);
    let here = evaluate(forward, &baseline, &vec![0.0; baseline.len()], &weights);
    // if the nominal arm lacks a measured mode, its change cannot be computed to first order, so no candidate is left
    // out
    let lists = forward.modal.iter().zip(&here.solved);
    if lists.clone().any(|(test, solved)| solved.len() < test.mode_count()) {
        return candidates;
    }
    candidates.retain(|candidate| {
        let model = baseline.with(candidate);
        sizes(candidate).iter().any(|own| {
            let u = [here.u.as_slice(), own].concat();
            let moved = change(forward, &model, &here, &u);
            moved.iter().zip(&weights.inverse).any(|(delta, weight)| (delta * weight).abs() > UNSEEN_SIGMAS)
        })
    });
    candidates
}

/// The values of `u` at which a candidate is tried for a change of readings. They are the starts of its fits, and
/// each start with one parameter changed, because some fits start where the effect is absent.
fn sizes(candidate: &Candidate) -> Vec<Vec<f64>> {
    let further = |start: &Vec<f64>, p: usize| {
        let parameter = &candidate.free_parameters[p];
        let step = RANGE_STEP * (parameter.high - parameter.low);
        let mut out = start.clone();
        out[p] += if out[p] + step > parameter.high { -step } else { step };
        out
    };
    let of_start = |start: &Vec<f64>| -> Vec<Vec<f64>> {
        let moved = (0..start.len()).map(|p| further(start, p));
        std::iter::once(start.clone()).chain(moved).collect()
    };
    candidate.starts.iter().flat_map(of_start).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalog::Catalogs;
    use crate::reconcile::model::candidates::candidates;
    use crate::reconcile::readings::campaign::Campaign;
    use std::path::Path;

    fn labels(change: impl FnOnce(&mut Campaign)) -> Vec<String> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/campaigns/plain-0251e");
        let mut campaign = Campaign::read(&folder, &Catalogs::default()).expect("sound");
        change(&mut campaign);
        let forward = Forward::new(&campaign);
        let nuisance = Nuisance::new(&campaign.arm, &campaign.statement.tolerance);
        seen(&forward, &nuisance, candidates(&forward)).iter().map(Candidate::label).collect()
    }

    #[test]
    fn a_bench_sees_neither_payload_nor_base_nor_masses() {
        let on_the_bench = labels(|campaign| {
            campaign.statics.clear();
            campaign.modal.clear();
        });
        let joint = campaign_joint();
        assert!(on_the_bench.contains(&format!("connection_compliance@{joint}")), "{on_the_bench:?}");
        for blind in ["payload", "base_compliance", "extra_mass", "immersion", "bearing_tilt", "harness"] {
            assert!(!on_the_bench.iter().any(|label| label.starts_with(blind)), "{blind}: {on_the_bench:?}");
        }
        let with_all = labels(|_| ());
        // a gain, a drift and a payload's centre are fitted from where they are absent
        for shown in
            ["base_compliance@base", "sensor_gain@static", "drift@static", "payload_cg_error@payload"]
        {
            assert!(with_all.iter().any(|label| label == shown), "{shown}: {with_all:?}");
        }
    }

    /// Name of a joint that the campaign had on the bench.
    fn campaign_joint() -> String {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/campaigns/plain-0251e");
        let campaign = Campaign::read(&folder, &Catalogs::default()).expect("sound");
        campaign.windup.first().expect("a bench test").joint.clone()
    }
}
