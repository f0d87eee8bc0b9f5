//! The result of a reconciliation, and its JSON and CSV files.

use super::files::{CORRECTED_FILE, corrected_files};
use super::joint_record::JointRecord;
use super::stage::Stage;
use crate::arm::Arm;
use crate::arm::effect::channel::Channel;
use crate::arm::pose::{DrivenJoint, pose_json};
use crate::reconcile::fit::held_out::HeldOut;
use crate::reconcile::fit::noise::Noise;
use crate::reconcile::model::estimate::{Estimate, Finding};
use crate::reconcile::select::lack_of_fit::LackOfFit;
use serde_json::{Value, json};

/// Verdict on the readings of a campaign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// No gap: noise and calibration within tolerance explain all readings.
    NoGap,
    /// The effects that were found explain the readings.
    Explained,
    /// No effect of the library explains the readings.
    Unexplained,
    /// The readings are too few, or too ambiguous, to decide.
    InsufficientData,
}

impl Verdict {
    /// Word for the verdict in `verdict.json`.
    pub fn word(self) -> &'static str {
        match self {
            Verdict::NoGap => "no_gap",
            Verdict::Explained => "explained",
            Verdict::Unexplained => "unexplained",
            Verdict::InsufficientData => "insufficient_data",
        }
    }
}

/// A calibrated property of the arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibrated {
    /// Name of the property: `j2.stiffness`, `steel.modulus`, `j2.mass`.
    pub name: String,
    /// Factor on the nominal value, with its interval.
    pub factor: Estimate,
    /// Standard deviation of the logarithm of the factor after the readings, divided by its standard deviation before
    /// them (from the tolerance). The value 1 means that the readings say nothing about the property.
    pub learnt: f64,
}

/// Size of the residuals of one part of the readings, before and after the effects.
#[derive(Debug, Clone, PartialEq)]
pub struct Located {
    /// Name of the part: `static`, `static, unloading`, `modal, mode 2`, `windup, j3`.
    pub part: String,
    /// Number of measured values in the part.
    pub count: usize,
    /// Root mean square of the residuals with the calibrated nominal model \[standard deviations\].
    pub rms_before: f64,
    /// Root mean square of the residuals with the effects \[standard deviations\].
    pub rms_after: f64,
}

/// A proposed test.
#[derive(Debug, Clone, PartialEq)]
pub struct NextTest {
    /// Kind of the test: `static`, `modal`, `windup`, `positions` or `another kind`.
    pub kind: String,
    /// Description of the test in words.
    pub description: String,
    /// Pose, if the test has one: angles \[deg\] and travels \[mm\].
    pub pose_deg: Option<Vec<f64>>,
    /// The driven joints, in the order of the entries of the pose.
    pub joints: Vec<DrivenJoint>,
    /// Payload of the test \[kg\].
    pub payload_kg: f64,
    /// Force at the tip in the test, in the directions of the world \[N\].
    pub force_n: [f64; 3],
    /// Name of the joint, for a test on the bench; `None` otherwise.
    pub joint: Option<String>,
    /// Names of the models that the test tells apart.
    pub separates: Vec<String>,
    /// Expected difference between the predictions of the models \[standard deviations\].
    pub expected_sigmas: f64,
    /// Number of such readings after which the difference reaches four standard deviations of their mean.
    pub readings_needed: usize,
}

/// One measured value, and what the models without and with effects predict for it.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadingResidual {
    /// Channel of the reading.
    pub channel: Channel,
    /// Row in the file of the channel, counted from 1 without the header.
    pub row: usize,
    /// Index of the row among the rows of its channel in the campaign, from 0.
    pub index: usize,
    /// Component, 0 to 2, of a vector; 0 for a single value.
    pub component: usize,
    /// Name of the quantity: `dx_mm`, `frequency_hz` ...
    pub quantity: &'static str,
    /// Measured value, in the unit of the quantity.
    pub measured: f64,
    /// Declared standard deviation, in the unit of the quantity.
    pub sigma: f64,
    /// Prediction of the arm as given, calibrated within tolerance, in the unit of the quantity.
    pub before: f64,
    /// Prediction of the model with the effects, in the unit of the quantity.
    pub after: f64,
    /// Residual, measured minus predicted with the pose held out of the fit \[declared standard deviations\]; `None`
    /// if the reading is never held out.
    pub held_out: Option<f64>,
    /// Whether the row was taken as a gross error and left out of the fit.
    pub gross: bool,
}

/// A model that was compared, with its score. For absolute positions, a row stands for a stage of the fit, and both
/// numbers are in mm.
#[derive(Debug, Clone, PartialEq)]
pub struct Evidence {
    /// The model: its effects joined by `+`.
    pub model: String,
    /// Score of the model (logarithm of the evidence less the price of its effects) minus the score of the best model.
    /// For positions: median held-out error of the last stage minus that of this stage \[mm\].
    pub score: f64,
    /// Value of the objective of the fit, which behaves like chi-squared. For positions: median held-out error \[mm\].
    pub objective: f64,
}

/// A law without a name that is in the corrected arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Law {
    /// Place and parameters of the law, with their intervals.
    pub finding: Finding,
    /// Description of the law in words.
    pub law: String,
    /// Possible physical causes, as a sentence.
    pub may_be: &'static str,
}

/// A model that the corrected arm could have, with its error on held-out readings.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Description of the model in words.
    pub model: String,
    /// Root mean square of the residuals that the model leaves on held-out readings \[standard deviations\].
    pub kept_out_rms_sigma: f64,
    /// Whether this model was chosen for `arm.corrected.json`.
    pub is_written: bool,
}

impl Row {
    /// The entry of the model in `verdict.json`.
    pub(crate) fn json(&self) -> Value {
        json!({
            "model": self.model, "kept_out_rms_sigma": self.kept_out_rms_sigma, "is_written": self.is_written,
        })
    }
}

/// Everything that `reconcile` found.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// Name of the campaign.
    pub campaign: String,
    /// blake3 hash of the campaign's files.
    pub hash: String,
    /// Verdict on the readings.
    pub verdict: Verdict,
    /// Reasons for the verdict, one sentence each.
    pub reasons: Vec<String>,
    /// Named effects, if they explain the readings; otherwise empty.
    pub effects: Vec<Finding>,
    /// Suspected effects, which the readings do not suffice to name; empty if there are none.
    pub suspects: Vec<Finding>,
    /// The laws without a name in the corrected arm.
    pub empirical: Vec<Law>,
    /// For the verdict `unexplained`: the models that the corrected arm could have, each with its error on held-out
    /// poses. Empty for other verdicts.
    pub models: Vec<Row>,
    /// Root mean square residuals on held-out poses without and with the effects; `None` if nothing was held out.
    pub held_out: Option<HeldOut>,
    /// Root mean square residuals of each part of the readings, which show where the discrepancy is.
    pub located: Vec<Located>,
    /// Proposed tests, the best first.
    pub next_tests: Vec<NextTest>,
    /// Quality of the readings: gross errors, and factors on the declared standard deviations.
    pub noise: Noise,
    /// Test of the best model's residuals for structure; `None` if it was not made.
    pub lack_of_fit: Option<LackOfFit>,
    /// Calibrated properties of the arm.
    pub calibrated: Vec<Calibrated>,
    /// The models that were compared, each with its score.
    pub evidence: Vec<Evidence>,
    /// Absolute positions: the errors after each stage of the fit. Empty for other readings.
    pub stages: Vec<Stage>,
    /// Records against time: the results for each joint. Empty for other readings.
    pub records: Vec<JointRecord>,
    /// All readings with their predictions and residuals.
    pub residuals: Vec<ReadingResidual>,
    /// The corrected arm.
    pub corrected: Arm,
    /// The other corrected arms on the same trunk.
    pub other_corrected: Vec<Arm>,
    /// Provenance of the corrected arm's values.
    pub provenance: Value,
}

impl NextTest {
    /// A test of another kind, described in words. How well it would separate models is not predicted.
    pub fn of_another_kind(description: String) -> Self {
        Self {
            kind: "another kind".into(),
            description,
            pose_deg: None,
            joints: Vec::new(),
            payload_kg: 0.0,
            force_n: [0.0; 3],
            joint: None,
            separates: Vec::new(),
            expected_sigmas: 0.0,
            readings_needed: 0,
        }
    }

    fn json(&self) -> Value {
        let (key, pose) = match &self.pose_deg {
            Some(pose) => pose_json(&self.joints, pose),
            None => ("pose_deg", Value::Null),
        };
        json!({
            "kind": self.kind, "description": self.description, key: pose,
            "payload_kg": self.payload_kg, "force_n": self.force_n, "joint": self.joint,
            "separates": self.separates, "expected_sigmas": self.expected_sigmas,
            "readings_needed": self.readings_needed,
        })
    }
}

impl Outcome {
    /// Content of `verdict.json`.
    pub fn to_json(&self) -> Value {
        let held_out = self.held_out.map(|k| {
            json!({"rms_sigma_before": k.rms_before, "rms_sigma_after": k.rms_after, "rms_declared_sigma_after": k.rms_declared_after, "readings": k.count})
        });
        let located: Vec<Value> = self
            .located
            .iter()
            .map(|l| {
                json!({"part": l.part, "readings": l.count, "rms_sigma_before": l.rms_before, "rms_sigma_after": l.rms_after})
            })
            .collect();
        let next = self.next_tests.first().map_or(json!({}), NextTest::json);
        json!({
            "schema": 1,
            "campaign": self.campaign,
            "campaign_blake3": self.hash,
            "tool_version": env!("CARGO_PKG_VERSION"),
            "verdict": self.verdict.word(),
            "reasons": self.reasons,
            "effects": self.effects.iter().map(Finding::json).collect::<Vec<_>>(),
            "suspects": self.suspects.iter().map(Finding::json).collect::<Vec<_>>(),
            "empirical": self.empirical_json(),
            "corrected_models": self.models.iter().map(Row::json).collect::<Vec<_>>(),
            "kept_out": held_out.unwrap_or(json!({})),
            "located": {"parts": located},
            "next_test": next,
            "further_tests": self.next_tests.iter().skip(1).map(NextTest::json).collect::<Vec<_>>(),
            "readings": self.noise_json(),
            "lack_of_fit": self.lack_of_fit_json(),
            "calibrated": self.calibrated.iter().map(|c| json!({
                "name": c.name, "factor": c.factor.json(), "learnt": c.learnt,
            })).collect::<Vec<_>>(),
            "records": self.records.iter().map(JointRecord::json).collect::<Vec<_>>(),
            "stages": self.stages.iter().map(Stage::json).collect::<Vec<_>>(),
            "evidence": self.evidence.iter().map(|e| json!({
                "model": e.model, "score": e.score, "chi_squared": e.objective,
            })).collect::<Vec<_>>(),
        })
    }

    /// The entry `empirical` of `verdict.json`: the laws without a name in the corrected arm, each with the held-out
    /// error of the model that contains it.
    fn empirical_json(&self) -> Vec<Value> {
        let written = self.models.iter().find(|row| row.is_written);
        let laws = self.empirical.iter().map(|law| {
            let mut out = law.finding.json();
            out["law"] = json!(law.law);
            out["may_be"] = json!(law.may_be);
            out["kept_out"] = written.map_or(json!(null), Row::json);
            out
        });
        laws.collect()
    }

    fn noise_json(&self) -> Value {
        let outliers: Vec<Value> = self
            .noise
            .outliers
            .iter()
            .map(|o| json!({"channel": o.channel.word(), "row": o.row + 1, "sigmas": o.sigmas}))
            .collect();
        let [s, m, w] = self.noise.scale;
        json!({"gross_errors": outliers, "sigma_scale": {"static": s, "modal": m, "windup": w}})
    }

    fn lack_of_fit_json(&self) -> Value {
        let Some(l) = &self.lack_of_fit else { return json!({}) };
        let structures: Vec<Value> = l
            .structures
            .iter()
            .take(5)
            .map(|s| {
                json!({"channel": s.channel.map_or("all", |c| c.word()), "follows": s.follows, "chi_squared": s.statistic,
                       "degrees_of_freedom": s.dof, "log10_probability": s.ln_p / std::f64::consts::LN_10})
            })
            .collect();
        json!({"chi_squared_per_degree_of_freedom": l.chi2_per_dof, "fails": l.fails, "structures": structures})
    }

    /// Content of `residuals.csv`.
    pub fn residuals_csv(&self) -> String {
        let mut out = String::from(
            "channel,row,quantity,measured,sigma,model_before,model_after,kept_out_residual_sigma,gross_error\n",
        );
        for r in &self.residuals {
            let held_out = r.held_out.map_or(String::new(), |k| format!("{k:.4}"));
            out.push_str(&format!(
                "{},{},{},{},{},{:.6},{:.6},{},{}\n",
                r.channel.word(),
                r.row,
                r.quantity,
                r.measured,
                r.sigma,
                r.before,
                r.after,
                held_out,
                r.gross
            ));
        }
        out
    }

    /// Content of the file of the corrected arm `arm`, one of the other arms on the trunk, with its placement.
    pub fn other_json(&self, arm: &Arm) -> Value {
        let mut out = arm.to_json();
        out["provenance"] = self.provenance.clone();
        out["provenance"]["placement"] = self.provenance["other_placements"][&arm.name].clone();
        let files = corrected_files(&self.other_corrected);
        let others = self.other_corrected.iter().zip(files).filter(|(other, _)| other.name != arm.name);
        let others = others.map(|(_, file)| file);
        out["provenance"]["other_arms"] =
            json!(std::iter::once(CORRECTED_FILE.to_string()).chain(others).collect::<Vec<_>>());
        out
    }

    /// Content of `arm.corrected.json`.
    pub fn corrected_json(&self) -> Value {
        let mut arm = self.corrected.to_json();
        arm["provenance"] = self.provenance.clone();
        if !self.other_corrected.is_empty() {
            arm["provenance"]["other_arms"] = json!(corrected_files(&self.other_corrected));
        }
        arm
    }
}
