//! Proposes what to measure next: the pose in which the model differs most from the competing models. If no pose tells
//! them apart, or if no effect of the library fits, another kind of test is proposed.

use super::analysis::{Positions, samples};
use super::fitted::Fitted;
use super::points::Point;
use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::select::lack_of_fit::LackOfFit;
use crate::reconcile::verdict::next_test::{LEAST_SIGMAS, readings_needed, spread_pose};
use crate::reconcile::verdict::outcome::{NextTest, Verdict};
use std::collections::HashSet;

/// Number of poses, for each point, among which the next test is chosen.
const PROPOSED_POSES: usize = 60;

impl Positions {
    /// For each competing model, the test that separates it best from this model. The test with the largest expected
    /// difference comes first. `competitors` lists, for each effect of this model, the candidates that fit as well in
    /// its place. If the verdict is `unexplained`, the only test is one that helps to find the unknown cause.
    pub(crate) fn next_tests(
        &self,
        campaign: &Campaign,
        verdict: Verdict,
        left: &LackOfFit,
        competitors: &[Vec<(usize, Fitted)>],
    ) -> Vec<NextTest> {
        if verdict == Verdict::Unexplained {
            return self.after_unexplained(campaign, left).into_iter().collect();
        }
        let proposed = self.proposals(campaign);
        let known = || competitors.iter().enumerate().flat_map(|(i, list)| list.iter().map(move |r| (i, r)));
        let mut out: Vec<NextTest> = known()
            .filter_map(|(i, (candidate, fitted))| {
                let names = [self.label(self.fitted.effects[i]), self.label(*candidate)];
                self.telling_pose(&proposed, fitted, names)
            })
            .collect();
        if out.is_empty() && !self.stages.is_empty() {
            let model: Vec<String> = self.fitted.effects.iter().map(|&e| self.label(e)).collect();
            let model = if model.is_empty() { "calibration only".into() } else { model.join(" + ") };
            out.extend(self.telling_pose(&proposed, &self.rigid, [model, "calibration only".into()]));
        }
        out.sort_by(|a, b| b.expected_sigmas.total_cmp(&a.expected_sigmas));
        out
    }

    /// The pose among `proposed` in which this model and the model `competitor` predict the most different positions,
    /// as a test. `names` are the labels of the two models. If the difference is too small in every pose, the test is a
    /// sentence that says so, or `None` if the two names are equal.
    fn telling_pose(&self, proposed: &Campaign, competitor: &Fitted, names: [String; 2]) -> Option<NextTest> {
        let own = samples(proposed, &self.tree, &self.fitted.geometry, &self.candidates, &self.points);
        let sigma_mm =
            proposed.positions.iter().map(|r| r.sigma_mm()).fold(1e3 * self.fitted.scale_m, f64::max);
        let gap = own
            .iter()
            .map(|s| 1e3 * (self.fitted.predicted_m(s) - competitor.predicted_m(s)).norm() / sigma_mm);
        let (best, sigmas) = gap.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let row = &proposed.positions[best];
        let [a, b] = &names;
        if sigmas < LEAST_SIGMAS {
            let separates = format!(
                "no position separates {a} from {b}, in a hundred readings: load the tip sideways and measure the turn on both sides \
                 of each place with dial gauges or an inclinometer"
            );
            return (a != b).then(|| NextTest::of_another_kind(separates));
        }
        Some(NextTest {
            kind: "positions".into(),
            description: format!("position of {}", row.point),
            pose_deg: Some(row.pose_deg.clone()),
            // campaigns of positions have no joint that slides
            joints: Vec::new(),
            payload_kg: row.payload.mass_kg,
            force_n: [0.0; 3],
            joint: None,
            separates: names.to_vec(),
            expected_sigmas: sigmas,
            readings_needed: readings_needed(sigmas),
        })
    }

    /// A campaign with proposed poses in place of the measured ones. The proposed joint angles lie within the range of
    /// the measured ones, and the payload is the largest that was measured.
    fn proposals(&self, campaign: &Campaign) -> Campaign {
        let mut out = campaign.clone();
        let range = |j: usize| {
            let angles = || campaign.positions.iter().map(move |r| r.pose_deg[j]);
            (angles().fold(f64::INFINITY, f64::min), angles().fold(f64::NEG_INFINITY, f64::max))
        };
        let ranges: Vec<(f64, f64)> = (0..self.tree.driven.len()).map(range).collect();
        let heaviest =
            campaign.positions.iter().map(|r| r.payload).max_by(|a, b| a.mass_kg.total_cmp(&b.mass_kg));
        out.positions.clear();
        for point in &self.points {
            let Some(like) = campaign.positions.iter().find(|r| Point::of(r) == *point) else { continue };
            for index in 1..=PROPOSED_POSES {
                let mut row = like.clone();
                row.pose_deg = spread_pose(&ranges, index);
                row.payload = heaviest.unwrap_or_default();
                out.positions.push(row);
            }
        }
        out
    }

    /// Proposes a test if no effect of the library fits, so that no pose can separate models. The kind of test depends
    /// on the quantity that the errors follow (`left` lists such quantities). The test is made in the pose in which the
    /// best model has its largest error, gross errors excepted.
    fn after_unexplained(&self, campaign: &Campaign, left: &LackOfFit) -> Option<NextTest> {
        let gross: HashSet<usize> = self.gross.iter().map(|(row, _)| *row).collect();
        let errors = self.errors_m().into_iter().map(|error_m| error_m.norm()).enumerate();
        let worst = errors.filter(|(i, _)| !gross.contains(i)).max_by(|a, b| a.1.total_cmp(&b.1))?.0;
        let row = &campaign.positions[worst];
        let follows = left.structures.iter().find(|s| self.is_material(s)).map(|s| s.follows.as_str());
        let what = match follows.and_then(|f| f.rsplit_once(' ')) {
            Some(("the angle of", joint)) => format!(
                "from this pose turn {joint} alone through its range and back, a reading every few degrees: what \
                 repeats is the gear or the axis, what differs between the directions is play"
            ),
            Some(("the torque on", joint)) => {
                format!("repeat this pose with several payloads, rising and falling: the twist of {joint} against its torque")
            }
            Some(("the order of the", _)) => {
                "repeat this pose after every ten others: what changes is the instrument, the reflector or the base".into()
            }
            _ => "repeat this pose, which the best model misses most, from both sides, on another day".into(),
        };
        let description = format!("no further pose alone separates anything, because no model fits: {what}");
        Some(NextTest {
            pose_deg: Some(row.pose_deg.clone()),
            payload_kg: row.payload.mass_kg,
            ..NextTest::of_another_kind(description)
        })
    }
}
