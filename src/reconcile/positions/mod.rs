//! Absolute positions: base placement, tool offsets, joint zeros and geometry are calibrated, what yields
//! is found effect by effect, each stage judged on poses kept out of the fit.

pub mod fit;
pub mod kinematics;

use super::campaign::Campaign;
use super::correct;
use super::kept_out::KeptOut;
use super::noise::Noise;
use super::stats::median;
use super::verdict::{Estimate, Evidence, Finding, Outcome, Verdict};
use crate::arm::effect::{Channel, Effect};
use crate::arm::{Curve, JointModel, LinkModel, Piece, Structure};
use crate::mechanics::Chain;
use fit::{Fitted, Sample, align, fit};
use kinematics::{Geometry, Number, numbers};
use nalgebra::Vector3;
use rayon::prelude::*;
use serde_json::json;

/// Hands the poses are dealt into; one is kept out at a time.
const HANDS: usize = 5;
/// Errors beyond this many scales are gross.
const GROSS: f64 = 8.0;
/// Fewest positions that can speak.
const FEWEST: usize = 20;

/// What yields, as a candidate.
#[derive(Debug, Clone, PartialEq)]
pub struct Yielding {
    /// Effect.
    pub effect: &'static str,
    /// Place.
    pub at: String,
}

/// How well a model predicts positions.
#[derive(Debug, Clone, PartialEq)]
pub struct Stage {
    /// What was added to the stage before.
    pub added: String,
    /// Median error of the poses it was fitted to \[mm\].
    pub fitted_median_mm: f64,
    /// Median error of poses kept out of the fit \[mm\].
    pub median_mm: f64,
    /// Their mean error \[mm\].
    pub mean_mm: f64,
}

/// Everything a positions campaign tells.
pub struct Positions {
    /// The table of errors, effect by effect.
    pub stages: Vec<Stage>,
    /// Candidates.
    pub candidates: Vec<Yielding>,
    /// The final fit.
    pub fitted: Fitted,
    /// Rows that are gross errors, from 0, with their error \[mm\].
    pub gross: Vec<(usize, f64)>,
    samples: Vec<Sample>,
    numbers: Vec<Number>,
}

/// Calibrates and finds what yields.
pub fn analyze(campaign: &Campaign) -> Positions {
    let mut nominal = campaign.arm.structure(JointModel::ThreeSegment);
    if campaign.statement.rigid_links {
        nominal.pieces.iter_mut().for_each(|p| {
            if let Piece::Link(link) = p
                && let Some(beam) = &mut link.beam
            {
                beam.flexibility = 0.0;
            }
        });
    }
    let points = points(campaign);
    let driven = campaign.arm.driven_joint_names().len();
    let candidates = candidates(&nominal);
    let samples = samples(campaign, &nominal, &points, &candidates);
    let numbers = numbers(&nominal, &campaign.statement.positions, points.len(), driven);
    let mut geometry = Geometry::nominal(&nominal, points.len(), driven);
    let all: Vec<&Sample> = samples.iter().collect();
    if campaign.statement.positions.base_placement {
        align(&all, &mut geometry);
    }
    let start = Fitted {
        geometry,
        effects: Vec::new(),
        compliances: Vec::new(),
        deviations: Vec::new(),
        scale_m: 0.01,
        ln_likelihood: 0.0,
    };
    let mut fitted = fit(&all, &numbers, &[], &start);
    let mut out = Positions {
        stages: vec![stage("calibrated geometry", &samples, &numbers, &fitted)],
        candidates,
        fitted: fitted.clone(),
        gross: Vec::new(),
        samples,
        numbers,
    };
    // joints first, then what yields across them: each class one effect at a time
    for class in [["joint_compliance", "connection_compliance"], ["bearing_tilt", "base_compliance"]] {
        while let Some((added, next)) = out.add(&fitted, &class) {
            fitted = next;
            let label = format!("{}@{}", out.candidates[added].effect, out.candidates[added].at);
            out.stages.push(stage(&label, &out.samples, &out.numbers, &fitted));
        }
    }
    out.gross = gross(&out.samples, &fitted);
    out.fitted = fitted;
    out
}

impl Positions {
    /// The effect of a class that raises the evidence most, if one does.
    fn add(&self, base: &Fitted, class: &[&str]) -> Option<(usize, Fitted)> {
        let all: Vec<&Sample> = self.samples.iter().collect();
        let penalty = 0.5 * (3.0 * all.len() as f64).ln() + (self.candidates.len() as f64).ln() + 3.0;
        (0..self.candidates.len())
            .into_par_iter()
            .filter(|i| class.contains(&self.candidates[*i].effect) && !base.effects.contains(i))
            .map(|i| {
                let effects = [base.effects.as_slice(), &[i]].concat();
                (i, fit(&all, &self.numbers, &effects, base))
            })
            .filter(|(_, f)| f.ln_likelihood > base.ln_likelihood + penalty)
            .collect::<Vec<_>>()
            .into_iter()
            .max_by(|a, b| a.1.ln_likelihood.total_cmp(&b.1.ln_likelihood))
    }
}

fn points(campaign: &Campaign) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for row in &campaign.positions {
        if !out.contains(&row.point) {
            out.push(row.point.clone());
        }
    }
    out
}

fn candidates(nominal: &Structure) -> Vec<Yielding> {
    let mut out = Vec::new();
    for joint in nominal.joints() {
        let effect = if joint.law.is_rigid() { "joint_compliance" } else { "connection_compliance" };
        out.push(Yielding { effect, at: joint.name.clone() });
        out.push(Yielding { effect: "bearing_tilt", at: joint.name.clone() });
    }
    out.push(Yielding { effect: "base_compliance", at: "base".into() });
    out
}

/// Poses with what mechanics says of each: the displacement the model has, and that of each candidate at
/// unit compliance.
fn samples(
    campaign: &Campaign,
    nominal: &Structure,
    points: &[String],
    candidates: &[Yielding],
) -> Vec<Sample> {
    let known = Chain::new(nominal, LinkModel::Full);
    let mut unit = nominal.clone();
    unit.base_tilt_rad_per_nm = 1.0;
    for piece in &mut unit.pieces {
        if let Piece::Joint(joint) = piece {
            joint.law = Curve::Linear(1.0).into();
            joint.tilt_rad_per_nm = 1.0;
        }
    }
    let unit = Chain::new(&unit, LinkModel::Full);
    let share_name = |c: &Yielding| match c.effect {
        "bearing_tilt" => format!("{}.bearing_tilt", c.at),
        _ => c.at.clone(),
    };
    campaign
        .positions
        .iter()
        .map(|row| {
            let pose_rad: Vec<f64> = row.pose_deg.iter().map(|a| a.to_radians()).collect();
            let zero = Vector3::zeros();
            let shares = unit.pose_rad(&pose_rad, &row.payload, zero).statics().shares_m;
            let share = |name: String| shares.iter().find(|(n, _)| *n == name).map_or(zero, |(_, s)| *s);
            Sample {
                known_m: known.pose_rad(&pose_rad, &row.payload, zero).statics().tip_displacement_m,
                signatures: candidates.iter().map(|c| share(share_name(c))).collect(),
                point: points.iter().position(|p| *p == row.point).unwrap_or_default(),
                measured_m: Vector3::from(row.position_mm) / 1e3,
                pose_rad,
            }
        })
        .collect()
}

fn stage(added: &str, samples: &[Sample], numbers: &[Number], fitted: &Fitted) -> Stage {
    let kept_out = kept_out_errors_mm(samples, numbers, fitted);
    Stage {
        added: added.into(),
        fitted_median_mm: median(samples.iter().map(|s| 1e3 * fitted.error(s).norm()).collect()),
        mean_mm: kept_out.iter().sum::<f64>() / kept_out.len().max(1) as f64,
        median_mm: median(kept_out),
    }
}

/// Error of every position when its hand is kept out \[mm\].
fn kept_out_errors_mm(samples: &[Sample], numbers: &[Number], fitted: &Fitted) -> Vec<f64> {
    let hands: Vec<Vec<f64>> = (0..HANDS)
        .into_par_iter()
        .map(|hand| {
            let rest: Vec<&Sample> =
                samples.iter().enumerate().filter(|(i, _)| i % HANDS != hand).map(|(_, s)| s).collect();
            let again = fit(&rest, numbers, &fitted.effects, fitted);
            let own = samples.iter().skip(hand).step_by(HANDS);
            own.map(|s| 1e3 * again.error(s).norm()).collect()
        })
        .collect();
    hands.concat()
}

fn gross(samples: &[Sample], fitted: &Fitted) -> Vec<(usize, f64)> {
    let errors = samples.iter().enumerate().map(|(i, s)| (i, fitted.error(s).norm()));
    errors.filter(|(_, e)| *e > GROSS * fitted.scale_m).map(|(i, e)| (i, 1e3 * e)).collect()
}

/// Reconciles a campaign of absolute positions.
pub fn reconcile(campaign: &Campaign) -> Outcome {
    let few = campaign.positions.len() < FEWEST;
    let found = analyze(campaign);
    let findings: Vec<Finding> = (0..found.fitted.effects.len()).map(|i| found.finding(i)).collect();
    let (first, last) = (&found.stages[0], &found.stages[found.stages.len() - 1]);
    let verdict = match () {
        () if few => Verdict::InsufficientData,
        () if findings.is_empty() => Verdict::NoGap,
        () if last.median_mm > first.median_mm => Verdict::InsufficientData,
        () => Verdict::Explained,
    };
    let mut reasons: Vec<String> = found
        .stages
        .iter()
        .map(|s| {
            format!(
                "with {}: {:.2} mm median, {:.2} mm mean on poses kept out of the fit ({:.2} mm fitted)",
                s.added, s.median_mm, s.mean_mm, s.fitted_median_mm
            )
        })
        .collect();
    if few {
        reasons
            .insert(0, format!("{} positions are too few: give at least {FEWEST}", campaign.positions.len()));
    }
    let (effects, suspects) =
        if verdict == Verdict::Explained { (findings, Vec::new()) } else { (Vec::new(), findings) };
    let scale_mm = 1e3 * found.fitted.scale_m;
    let mut corrected = campaign.arm.clone();
    corrected.effects.extend(effects.iter().map(|f| found.effect(campaign, f)));
    let sigma = campaign.positions.first().map_or(1.0, |r| r.sigma_mm);
    Outcome {
        campaign: campaign.statement.name.clone(),
        hash: campaign.hash.clone(),
        verdict,
        reasons,
        suspects,
        kept_out: Some(KeptOut {
            rms_before: first.median_mm / scale_mm / 1.538,
            rms_after: last.median_mm / scale_mm / 1.538,
            rms_declared_after: last.median_mm / sigma / 1.538,
            count: campaign.positions.len(),
        }),
        located: Vec::new(),
        next_tests: Vec::new(),
        noise: Noise {
            scale: [1.0; 3],
            outliers: found.gross.iter().map(|(row, mm)| (Channel::Positions, *row, mm / scale_mm)).collect(),
        },
        lack_of_fit: None,
        calibrated: Vec::new(),
        evidence: found.evidence(),
        residuals: Vec::new(),
        provenance: correct::provenance(campaign, verdict, Vec::new()),
        corrected,
        effects,
    }
}

impl Positions {
    fn finding(&self, i: usize) -> Finding {
        let candidate = &self.candidates[self.fitted.effects[i]];
        let (c, sd) = (self.fitted.compliances[i], self.fitted.deviations[i]);
        let stiffness = |c: f64| (c > 0.0).then(|| 1.0 / c);
        let value = stiffness(c).unwrap_or(1e15);
        let estimate = Estimate { value, low: stiffness(c + 1.96 * sd), high: stiffness(c - 1.96 * sd) };
        Finding {
            effect: candidate.effect.into(),
            at: candidate.at.clone(),
            parameters: vec![("stiffness_nm_per_rad".into(), vec![estimate])],
            indistinguishable_from: Vec::new(),
        }
    }

    fn effect(&self, campaign: &Campaign, finding: &Finding) -> Effect {
        let parameters = finding
            .parameters
            .iter()
            .map(|(name, list)| (name.clone(), list.iter().map(|e| e.value).collect()))
            .collect();
        let source = json!({"campaign": campaign.statement.name, "campaign_blake3": campaign.hash});
        Effect { effect: finding.effect.clone(), at: finding.at.clone(), parameters, source: Some(source) }
    }

    fn evidence(&self) -> Vec<Evidence> {
        let best = self.stages.last().map_or(0.0, |s| s.median_mm);
        self.stages
            .iter()
            .map(|s| Evidence { model: s.added.clone(), score: best - s.median_mm, objective: s.median_mm })
            .collect()
    }
}
