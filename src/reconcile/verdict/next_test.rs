//! Proposes the test that best separates models that the readings cannot yet tell apart.
//!
//! Poses come from a low-discrepancy sequence over the range of the campaign. In each pose, displacements are proposed
//! with the largest payload and with the largest tip force of the campaign, and frequencies with and without payload.
//! Each joint can also be tested on the bench. For every test, the predictions of the competing models are compared,
//! all fitted to the readings so far. The difference is given in expected standard deviations.

use super::outcome::{NextTest, Verdict};
use crate::arm::effect::subject::Subject;
use crate::arm::halton::halton;
use crate::arm::load::Payload;
use crate::arm::pose::Motion;
use crate::reconcile::model::direct::Direct;
use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::readings::components::{Component, Components};
use crate::reconcile::readings::rows::{ModalRow, StaticRow, WindupRow};
use nalgebra::Vector3;
use rayon::prelude::*;

/// The models that the next test is to separate, and the result so far.
pub(crate) struct Question<'a> {
    /// The campaign with the readings so far.
    pub campaign: &'a Campaign,
    /// The best model: its name, and the arm under test with its effects.
    pub best: (String, Subject),
    /// The competing models: for each its name, and the arm under test with its effects.
    pub competitors: Vec<(String, Subject)>,
    /// The pose in which the best model has its largest residuals \[deg, mm\]; `None` if there is none.
    pub residuals: Option<Vec<f64>>,
    /// The verdict on the readings so far.
    pub verdict: Verdict,
}

const STATIC_POSES: usize = 24;
const MODAL_POSES: usize = 4;
const PROPOSALS: usize = 4;
/// Difference of the predictions of two models that suffices to decide between them \[standard deviations\].
pub(crate) const DECIDING_SIGMAS: f64 = 4.0;
/// Smallest separation with which a test is proposed \[standard deviations\]. A hundred such readings reach
/// [`DECIDING_SIGMAS`], because the standard deviation of their mean is a tenth of that of one reading.
pub(crate) const LEAST_SIGMAS: f64 = DECIDING_SIGMAS / 10.0;
/// Largest number of readings that is printed.
const MOST_READINGS: f64 = 9999.0;
/// Standard deviation of a displacement that is assumed if the campaign has no displacements \[mm\].
const DEFAULT_SIGMA_MM: f64 = 0.01;
/// Standard deviation of a frequency that is assumed, as a fraction of the frequency.
const DEFAULT_SIGMA_PART: f64 = 0.003;
/// Standard deviation of a twist that is assumed if the campaign has no bench readings \[arcmin\].
const DEFAULT_SIGMA_ARCMIN: f64 = 0.05;
const MODES: usize = 4;

/// A test, as rows of the file in which its readings would be.
enum Test {
    Static(Vec<StaticRow>),
    Modal(Vec<ModalRow>),
    Bench(Vec<WindupRow>),
}

/// Up to four tests that separate the models of `question` best, the best first. If the verdict is `unexplained`, the
/// only test repeats the pose with the largest residuals.
pub(crate) fn propose(question: &Question) -> Vec<NextTest> {
    if question.verdict == Verdict::Unexplained {
        return question.residuals.iter().map(|pose| repeat(question.campaign, pose)).collect();
    }
    if question.competitors.is_empty() {
        return Vec::new();
    }
    let best = Direct::new(&question.best.1);
    let tests = tests(question.campaign, &best);
    let gaps: Vec<Vec<f64>> = tests
        .par_iter()
        .map(|test| {
            let own = predict(&best, test);
            let competitors = question.competitors.iter();
            competitors
                .map(|(_, competitor)| separation(test, &own, &predict(&Direct::new(competitor), test)))
                .collect()
        })
        .collect();
    // a competing model that no test separates cannot be ruled out by more readings
    let most = |competitor: usize| gaps.iter().map(|list| list[competitor]).fold(0.0, f64::max);
    let (open, twins): (Vec<usize>, Vec<usize>) =
        (0..question.competitors.len()).partition(|&competitor| most(competitor) >= LEAST_SIGMAS);
    if open.is_empty() {
        let names: Vec<&str> =
            twins.iter().map(|&competitor| question.competitors[competitor].0.as_str()).collect();
        return vec![nothing_tells(&question.best.0, &names)];
    }
    let mut out: Vec<NextTest> = tests
        .iter()
        .zip(&gaps)
        .map(|(test, list)| {
            let worst = open.iter().map(|&competitor| list[competitor]).fold(f64::INFINITY, f64::min);
            describe(question, test, worst, &open)
        })
        .collect();
    out.sort_by(|a, b| b.expected_sigmas.total_cmp(&a.expected_sigmas));
    let mut kinds: Vec<(String, usize)> = Vec::new();
    // at most two of a kind, so that the list offers a choice
    out.retain(|t| match kinds.iter_mut().find(|(k, _)| *k == t.kind) {
        Some((_, count)) => {
            *count += 1;
            *count <= 2
        }
        None => {
            kinds.push((t.kind.clone(), 1));
            true
        }
    });
    out.truncate(PROPOSALS);
    out
}

/// Number of readings that suffice to decide between two models whose predictions differ by `sigmas` standard
/// deviations in one reading.
pub(crate) fn readings_needed(sigmas: f64) -> usize {
    (DECIDING_SIGMAS / sigmas).powi(2).ceil().min(MOST_READINGS) as usize
}

/// A test in words, for the case that no reading of the arm separates the model `best` from the `competitors`.
fn nothing_tells(best: &str, competitors: &[&str]) -> NextTest {
    NextTest::of_another_kind(format!(
        "no displacement, frequency or bench reading separates {best} from {}: weigh the parts in question, or take them apart",
        competitors.join(" or ")
    ))
}

fn repeat(campaign: &Campaign, pose: &[f64]) -> NextTest {
    NextTest {
        kind: "static".into(),
        description:
            "repeat this pose, which the best model misses most, loading and unloading, on another day".into(),
        pose_deg: Some(pose.to_vec()),
        joints: campaign.arm.driven_joints(),
        payload_kg: largest_payload(campaign).mass_kg,
        force_n: [0.0; 3],
        joint: None,
        separates: Vec::new(),
        expected_sigmas: 0.0,
        readings_needed: 1,
    }
}

fn largest_payload(campaign: &Campaign) -> Payload {
    let statics = campaign.statics.iter().map(|r| r.payload);
    let modal = campaign.modal.iter().map(|r| r.payload);
    statics
        .chain(modal)
        .max_by(|a, b| a.mass_kg.total_cmp(&b.mass_kg))
        .filter(|p| p.mass_kg > 0.0)
        .unwrap_or(Payload { mass_kg: 5.0, cg_m: Vector3::new(0.05, 0.0, 0.0), ..Payload::default() })
}

/// Smallest and largest angle or travel of each joint in the poses of the campaign \[deg, mm\].
fn ranges(campaign: &Campaign) -> Vec<(f64, f64)> {
    let joints = campaign.arm.driven_joints();
    let poses =
        || campaign.statics.iter().map(|r| &r.pose_deg).chain(campaign.modal.iter().map(|r| &r.pose_deg));
    joints
        .iter()
        .enumerate()
        .map(|(j, joint)| {
            let low = poses().map(|p| p[j]).fold(f64::INFINITY, f64::min);
            let high = poses().map(|p| p[j]).fold(f64::NEG_INFINITY, f64::max);
            match joint.motion {
                _ if low < high => (low, high),
                Motion::Turns => (-90.0, 90.0),
                // the limits of a travel are not known
                Motion::Slides if low.is_finite() => (low, low),
                Motion::Slides => (0.0, 0.0),
            }
        })
        .collect()
}

/// Pose number `index` of Halton's sequence within the `ranges` of the joints' angles and travels, in whole degrees
/// and millimetres. The poses of the sequence fill the ranges evenly.
pub(crate) fn spread_pose(ranges: &[(f64, f64)], index: usize) -> Vec<f64> {
    ranges
        .iter()
        .enumerate()
        .map(|(j, (low, high))| (low + (high - low) * halton(index, j)).round())
        .collect()
}

fn tests(campaign: &Campaign, best: &Direct) -> Vec<Test> {
    let ranges = ranges(campaign);
    let pose = |index: usize| spread_pose(&ranges, index);
    let payload = largest_payload(campaign);
    let instrument = instrument(campaign);
    let force = campaign.statics.iter().map(|r| r.force_n.norm()).fold(0.0, f64::max).max(100.0).round();
    let mut out = Vec::new();
    for index in 1..=STATIC_POSES {
        let row = |row: usize, payload: Payload, force_n: Vector3<f64>| StaticRow {
            row,
            file: 0,
            pose_deg: pose(index),
            payload,
            temperature_c: None,
            force_n,
            branch: String::new(),
            measured: instrument,
        };
        out.push(Test::Static(vec![row(0, payload, Vector3::zeros())]));
        for axis in 0..3 {
            out.push(Test::Static(vec![row(0, Payload::default(), Vector3::ith(axis, force))]));
        }
        let half = Payload { mass_kg: 0.5 * payload.mass_kg, ..payload };
        let cycle = [half, payload, half];
        out.push(Test::Static(cycle.iter().enumerate().map(|(i, p)| row(i, *p, Vector3::zeros())).collect()));
    }
    for index in 1..=MODAL_POSES {
        for payload in [Payload::default(), payload] {
            let row = |mode| ModalRow {
                row: mode - 1,
                file: 0,
                pose_deg: pose(index),
                payload,
                temperature_c: None,
                mode,
                frequency_hz: 0.0,
                sigma_hz: 0.0,
            };
            out.push(Test::Modal((1..=MODES).map(row).collect()));
        }
    }
    out.extend(benches(campaign, best, &out));
    out
}

/// For each component x, y, z of a displacement, the standard deviation of its first reading in the campaign; `None`
/// if the instrument does not read the component.
fn instrument(campaign: &Campaign) -> Components {
    let first = |c: usize| campaign.statics.iter().find_map(|row| row.measured[c]);
    let read = |sigma_mm: f64| Some(Component { value_mm: 0.0, sigma_mm });
    match campaign.statics.is_empty() {
        true => [read(DEFAULT_SIGMA_MM); 3],
        false => [0, 1, 2].map(|c| first(c).and_then(|own| read(own.sigma_mm))),
    }
}

/// A bench cycle for each joint that has not been on the bench, up to the joint's largest torque in the proposed static
/// tests. A joint that was on the bench is not proposed again, because the models were already fitted to its readings.
fn benches(campaign: &Campaign, best: &Direct, statics: &[Test]) -> Vec<Test> {
    let mut largest: Vec<(String, f64)> = Vec::new();
    for row in statics.iter().filter_map(|t| if let Test::Static(rows) = t { rows.first() } else { None }) {
        for (joint, torque_nm) in best.torques_nm(row) {
            match largest.iter_mut().find(|(name, _)| *name == joint) {
                Some((_, most)) => *most = most.max(torque_nm.abs()),
                None => largest.push((joint, torque_nm.abs())),
            }
        }
    }
    let measured = |joint: &str| campaign.windup.iter().any(|r| r.joint == joint);
    let fresh = largest.into_iter().filter(|(joint, most)| *most > 0.0 && !measured(joint));
    fresh.map(|(joint, most)| bench(campaign, &joint, most.ceil())).collect()
}

fn bench(campaign: &Campaign, joint: &str, largest: f64) -> Test {
    let sigma_arcmin = campaign.windup.first().map_or(DEFAULT_SIGMA_ARCMIN, |r| r.sigma_arcmin);
    let up = (-4..=4).map(|k| k as f64 / 4.0 * largest);
    let torques: Vec<f64> = up.clone().chain(up.rev()).collect();
    let row = |(row, torque_nm): (usize, f64)| WindupRow {
        row,
        joint: joint.to_string(),
        torque_nm,
        branch: String::new(),
        windup_arcmin: 0.0,
        sigma_arcmin,
    };
    Test::Bench(torques.into_iter().enumerate().map(row).collect())
}

fn predict(exact: &Direct, test: &Test) -> Vec<f64> {
    match test {
        Test::Static(rows) => exact.statics_mm(rows).into_iter().flatten().collect(),
        Test::Modal(rows) => exact.frequencies_hz(rows).into_iter().map(|f| f.unwrap_or(f64::NAN)).collect(),
        Test::Bench(rows) => exact.windups_arcmin(rows),
    }
}

/// Difference of the predictions `a` and `b` of two models for the same test \[standard deviations\]: the root of the
/// sum of squares over the readings. Modes that only one of the models has are left out.
fn separation(test: &Test, a: &[f64], b: &[f64]) -> f64 {
    let sigma = |i: usize| match test {
        // a component that the instrument does not read separates nothing
        Test::Static(rows) => rows[0].measured[i % 3].map_or(f64::INFINITY, |read| read.sigma_mm),
        Test::Modal(_) => DEFAULT_SIGMA_PART * a[i].abs().max(1e-9),
        Test::Bench(rows) => rows[0].sigma_arcmin,
    };
    let squares = a.iter().zip(b).enumerate().map(|(i, (a, b))| ((a - b) / sigma(i)).powi(2));
    squares.filter(|s| s.is_finite()).sum::<f64>().sqrt()
}

fn describe(question: &Question, test: &Test, sigmas: f64, open: &[usize]) -> NextTest {
    let (kind, description, pose_deg, payload_kg, force_n, joint) = match test {
        Test::Static(rows) if rows.len() > 1 => {
            let row = &rows[1];
            (
                "static",
                "half load, full load, half load again",
                Some(row.pose_deg.clone()),
                row.payload.mass_kg,
                row.force_n,
                None,
            )
        }
        Test::Static(rows) => {
            let row = &rows[0];
            let what = if row.payload.mass_kg > 0.0 { "payload" } else { "tip force without payload" };
            ("static", what, Some(row.pose_deg.clone()), row.payload.mass_kg, row.force_n, None)
        }
        Test::Modal(rows) => {
            let row = &rows[0];
            (
                "modal",
                "the four lowest frequencies",
                Some(row.pose_deg.clone()),
                row.payload.mass_kg,
                Vector3::zeros(),
                None,
            )
        }
        Test::Bench(rows) => (
            "windup",
            "a closed cycle on the bench",
            None,
            0.0,
            Vector3::zeros(),
            Some(rows[0].joint.clone()),
        ),
    };
    NextTest {
        kind: kind.into(),
        description: description.into(),
        pose_deg,
        joints: question.campaign.arm.driven_joints(),
        payload_kg,
        force_n: force_n.into(),
        joint,
        separates: std::iter::once(question.best.0.clone())
            .chain(open.iter().map(|&competitor| question.competitors[competitor].0.clone()))
            .filter(|name| !name.is_empty())
            .collect(),
        expected_sigmas: sigmas,
        readings_needed: readings_needed(sigmas),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_test_is_worth_a_hundred_readings_at_most() {
        assert_eq!([DECIDING_SIGMAS, 0.5 * DECIDING_SIGMAS, LEAST_SIGMAS].map(readings_needed), [1, 4, 100]);
        assert_eq!(readings_needed(0.0), MOST_READINGS as usize, "models that do not differ");
    }
}
