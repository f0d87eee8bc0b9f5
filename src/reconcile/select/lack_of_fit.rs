//! Tests whether the residuals of the best model have a structure (lack of fit).
//!
//! The residuals of a correct model are noise. They do not depend on the order of the tests, a joint's angle, the load,
//! the branch or the torque. For each such quantity a few columns `X`, functions of it, are tested. The part of the
//! columns that the model itself could fit is removed. The statistic is then `zᵀ S⁻¹ z` with `z = Xᵀr` and
//! `S = XᵀX - XᵀJ (JᵀWJ)⁻¹ JᵀX`. Here `r` are the residuals and `J` the derivatives of the predicted readings with
//! respect to the parameters, both in standard deviations, and `(JᵀWJ)⁻¹` is the covariance matrix of the parameters.
//! The statistic follows a chi-squared distribution if there is no structure. The smooth laws of
//! [`unnamed`](super::unnamed) are tested too.

use super::structure::Structure;
use super::unnamed;
use super::waves::{order_functions, waves};
use crate::arm::effect::channel::Channel;
use crate::arm::pose::{DrivenJoint, Motion};
use crate::mechanics::product::transposed_product;
use crate::reconcile::fit::descent::Fit;
use crate::reconcile::fit::stats::ln_chi_squared_tail;
use crate::reconcile::fit::weights::Weights;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::model::calibration::Calibration;
use crate::reconcile::readings::campaign::Campaign;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// The results of all tests of the residuals.
#[derive(Debug, Clone, PartialEq)]
pub struct LackOfFit {
    /// One structure for each test, the most improbable first.
    pub structures: Vec<Structure>,
    /// Chi-squared per degree of freedom of all data, with the declared standard deviations.
    pub chi2_per_dof: f64,
    /// Whether the model fails the lack-of-fit test.
    pub fails: bool,
}

/// The model fails the test for lack of fit if chi-squared per degree of freedom exceeds this. Wrongly declared
/// standard deviations seldom explain a larger value.
const LARGEST_REDUCED_CHI_SQUARED: f64 = 2.5;
/// If a structure of the residuals is suspected, the model fails the test already above this chi-squared per degree
/// of freedom.
const SUSPICIOUS_REDUCED_CHI_SQUARED: f64 = 1.8;
/// A structure of the residuals is taken as real if chance gives it with a probability below this, after correction for
/// the number of tests.
const CERTAIN_PROBABILITY: f64 = 1e-3;
/// A structure of the residuals is suspected if chance gives it with a probability below this, after correction for the
/// number of tests.
const SUSPECTED_PROBABILITY: f64 = 0.02;
/// Largest number of structures that are described in words.
const STRUCTURES_NAMED: usize = 3;

impl LackOfFit {
    /// Sentences on up to three structures that are no chance result, the most improbable first. No quantity of a
    /// channel is mentioned twice.
    pub fn sentences(&self) -> Vec<String> {
        self.sentences_on(|s| s.ln_p < libm::log(CERTAIN_PROBABILITY))
    }

    /// The same as [`Self::sentences`], but the readings are taken to scatter as much as the residuals do, if that is
    /// more than declared. Only structures that are then still no chance result are described.
    pub(crate) fn sentences_beyond_scatter(&self) -> Vec<String> {
        let scatter = self.chi2_per_dof.max(1.0);
        self.sentences_on(|s| {
            let [declared, scattered] =
                [1.0, scatter].map(|variance| ln_chi_squared_tail(s.statistic / variance, s.dof));
            s.ln_p - declared + scattered < libm::log(CERTAIN_PROBABILITY)
        })
    }

    fn sentences_on(&self, is_no_chance: impl Fn(&Structure) -> bool) -> Vec<String> {
        let mut told: Vec<&Structure> = Vec::new();
        for structure in self.structures.iter().filter(|s| is_no_chance(s)) {
            if !told.iter().any(|t| t.channel == structure.channel && t.follows == structure.follows) {
                told.push(structure);
            }
        }
        told.into_iter().take(STRUCTURES_NAMED).map(Structure::sentence).collect()
    }
}

/// Tests the residuals of the model `fit` for structure, and decides whether the model fails.
pub(crate) fn lack_of_fit(campaign: &Campaign, forward: &Forward, fit: &Fit, weights: &Weights) -> LackOfFit {
    let tester = Tester::new(forward, fit, weights);
    let mut structures = Vec::new();
    for channel in [Channel::Static, Channel::Modal, Channel::Windup] {
        let range = forward.range(channel);
        if range.len() >= 8 {
            questions(campaign, forward, fit, weights, channel, &mut |follows, regressors| {
                structures.extend(tester.ask(channel, follows, &regressors));
            });
        }
    }
    // Bonferroni correction: with many tests one of them looks improbable by chance
    let asked = libm::log((structures.len() as f64).max(1.0));
    structures.iter_mut().for_each(|s| s.ln_p = (s.ln_p + asked).min(0.0));
    structures.extend(unnamed::law_questions(campaign, forward, fit, weights));
    structures.sort_by(|a, b| a.ln_p.total_cmp(&b.ln_p));
    let chi2_per_dof = tester.chi2_per_dof(forward, fit);
    let ln_p = structures.first().map_or(0.0, |s| s.ln_p);
    // a structure that is certain fails the test, and so does a very large chi-squared; a suspected structure does only
    // together with a large chi-squared
    let fails = ln_p < libm::log(CERTAIN_PROBABILITY)
        || chi2_per_dof > LARGEST_REDUCED_CHI_SQUARED
        || (ln_p < libm::log(SUSPECTED_PROBABILITY) && chi2_per_dof > SUSPICIOUS_REDUCED_CHI_SQUARED);
    LackOfFit { structures, chi2_per_dof, fails }
}

/// A linear combination of the columns of a test is dropped if the model already explains all but this fraction of its
/// sum of squares. The remainder would only show how well the fit converged.
const ABSORBED_FRACTION: f64 = 1e-3;

/// Scales every column of the matrix to length 1. A column of zeros stays.
fn unit_columns(mut x: DMatrix<f64>) -> DMatrix<f64> {
    for mut column in x.column_iter_mut() {
        let length = column.norm();
        if length > 0.0 {
            column /= length;
        }
    }
    x
}

struct Tester {
    residual: DVector<f64>,
    jacobian: DMatrix<f64>,
    covariance: DMatrix<f64>,
    weight: Vec<f64>,
    /// For each datum, the part of its variance that the fitted parameters absorb.
    leverages: Vec<f64>,
}

impl Tester {
    fn new(forward: &Forward, fit: &Fit, weights: &Weights) -> Self {
        // limited, so that a gross error does not look like a structure
        let residual = DVector::from_vec(fit.residuals(forward, weights)).map(|r| r.clamp(-5.0, 5.0));
        let mut jacobian = fit.jacobian.clone();
        for (mut row, w) in jacobian.row_iter_mut().zip(&weights.inverse) {
            row *= *w;
        }
        let n = fit.curvature.nrows();
        let covariance = fit.curvature.clone().try_inverse().unwrap_or_else(|| DMatrix::zeros(n, n));
        let leverages = fit.leverages(weights);
        Self { residual, jacobian, covariance, weight: weights.inverse.clone(), leverages }
    }

    fn ask(&self, channel: Channel, follows: String, regressors: &[Vec<f64>]) -> Option<Structure> {
        let n = self.residual.len();
        let x =
            DMatrix::from_fn(
                n,
                regressors.len(),
                |i, k| {
                    if self.weight[i] > 0.0 { regressors[k][i] } else { 0.0 }
                },
            );
        // all columns have length 1, so that a small eigenvalue shows linear dependence and not a difference of units
        let x = unit_columns(x);
        let z = x.tr_mul(&self.residual);
        let xj = transposed_product(&x, &self.jacobian);
        let s = transposed_product(&x, &x) - &xj * &self.covariance * xj.transpose();
        let eigen = SymmetricEigen::new((&s + s.transpose()) * 0.5);
        let largest = eigen.eigenvalues.max();
        let (mut statistic, mut dof) = (0.0, 0.0);
        for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            if *value > ABSORBED_FRACTION * largest && *value > 1e-9 {
                statistic += vector.dot(&z).powi(2) / value;
                dof += 1.0;
            }
        }
        (dof > 0.0).then(|| Structure {
            channel: Some(channel),
            follows,
            statistic,
            dof,
            ln_p: ln_chi_squared_tail(statistic, dof),
        })
    }

    /// Chi-squared of the readings per degree of freedom, in declared standard deviations. A parameter that its prior
    /// determines takes no degree of freedom, and one that the readings determine takes one.
    fn chi2_per_dof(&self, forward: &Forward, fit: &Fit) -> f64 {
        let (mut chi2, mut freedom) = (0.0, 0.0);
        for (i, datum) in forward.data.iter().enumerate() {
            if self.weight[i] > 0.0 {
                chi2 += ((datum.value - fit.point.predicted[i]) / datum.sigma).powi(2);
                freedom += 1.0 - self.leverages[i];
            }
        }
        chi2 / freedom.max(1.0)
    }
}

/// A function that carries out one test. Its arguments are the quantity that the residuals may follow, in words, and
/// the columns of the test. Tests are made one by one, because the columns of all tests together would need much
/// memory.
type Ask<'a> = &'a mut dyn FnMut(String, Vec<Vec<f64>>);

/// Makes all tests of the residuals of the channel `channel`. The columns of a test are zero outside the channel.
fn questions(
    campaign: &Campaign,
    forward: &Forward,
    fit: &Fit,
    weights: &Weights,
    channel: Channel,
    ask: Ask,
) {
    match channel {
        Channel::Static => static_questions(campaign, forward, fit, ask),
        Channel::Modal => modal_questions(campaign, forward, ask),
        _ => return windup_questions(campaign, forward, ask),
    }
    stiffness_questions(campaign, forward, fit, weights, channel, ask);
    change_questions(forward, fit, weights, channel, ask);
}

/// Tests whether the size of an effect, or the modulus of a material, changes in the course of the tests of a
/// channel. The columns are the derivatives of the readings with respect to this number, times functions of the order
/// of the rows.
fn change_questions(forward: &Forward, fit: &Fit, weights: &Weights, channel: Channel, ask: Ask) {
    let range = forward.range(channel);
    let part = |i: usize| (i - range.start) as f64 / range.len() as f64;
    let ordered = |p: usize, k: usize| -> Vec<f64> {
        let mut column = vec![0.0; forward.data.len()];
        for i in range.clone() {
            column[i] = fit.jacobian[(i, p)] * weights.inverse[i] * order_functions(part(i))[k];
        }
        column
    };
    let mut question = |what: String, numbers: std::ops::Range<usize>| {
        let columns = numbers.flat_map(|p| [0, 2].map(|k| (p, k))).map(|(p, k)| ordered(p, k)).collect();
        ask(format!("{what} that changes with the order of the tests"), columns);
    };
    for (p, (calibration, _)) in fit.model.nuisance.numbers.iter().enumerate() {
        if let Calibration::Modulus(material, _) = calibration {
            question(format!("a modulus of {material}"), p..p + 1);
        }
    }
    // an effect without parameters, a wrong unit, has no size
    let sized = fit.model.effects.iter().enumerate().filter(|(_, of)| !of.free_parameters.is_empty());
    for (effect, of) in sized {
        let first = fit.model.first_parameter(effect);
        question(format!("a size of {}", of.label()), first..first + of.free_parameters.len());
    }
}

/// Tests whether a joint's stiffness changes with its angle, its torque or the order of the tests of a channel. The
/// columns are the derivatives of the readings with respect to the stiffness, times functions of these quantities.
fn stiffness_questions(
    campaign: &Campaign,
    forward: &Forward,
    fit: &Fit,
    weights: &Weights,
    channel: Channel,
    ask: Ask,
) {
    let torques = forward.torques_nm(&fit.point.coefficients);
    let names: Vec<String> = campaign.arm.joints().map(|j| j.name.clone()).collect();
    let driven = campaign.arm.driven_joint_names();
    let count = forward.range(channel).len() as f64;
    for (p, (calibration, _)) in fit.model.nuisance.numbers.iter().enumerate() {
        let Calibration::Stiffness(name) = calibration else { continue };
        let Some(joint) = names.iter().position(|n| n == name) else { continue };
        let largest = torques.iter().map(|t| t[joint].abs()).fold(1e-9, f64::max);
        let times = |f: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let mut column = vec![0.0; forward.data.len()];
            for i in forward.range(channel) {
                column[i] = fit.jacobian[(i, p)] * weights.inverse[i] * f(i);
            }
            column
        };
        if let Some(j) = driven.iter().position(|n| n == name) {
            let pose = |i: usize| match channel {
                Channel::Static => &campaign.statics[forward.data[i].index].pose_deg,
                _ => &campaign.modal[i - forward.starts[1]].pose_deg,
            };
            let angle = (0..4).map(|k| times(&|i| waves(pose(i)[j])[k])).collect();
            ask(format!("a stiffness of {name} that changes with its angle"), angle);
        }
        let first = forward.range(channel).start;
        let part = |i: usize| (i - first) as f64 / count;
        let order = (0..4).map(|k| times(&|i| order_functions(part(i))[k])).collect();
        ask(format!("a stiffness of {name} that changes with the order of the tests"), order);
        let law: [fn(f64) -> f64; 4] = [|t| t.abs(), |t| t * t, |t| t.signum(), |t| t];
        let torque = law.iter().map(|f| times(&|i| f(torques[i][joint] / largest))).collect();
        ask(format!("a stiffness of {name} that changes with its torque"), torque);
    }
}

/// A column of a test that has `value` at the data of the channel, and zero elsewhere. `value` receives the index of
/// the datum and its component.
fn spread(forward: &Forward, channel: Channel, value: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    let mut out = vec![0.0; forward.data.len()];
    for i in forward.range(channel) {
        out[i] = value(i, forward.data[i].component);
    }
    out
}

fn static_questions(campaign: &Campaign, forward: &Forward, fit: &Fit, ask: Ask) {
    let rows = &campaign.statics;
    let row = |i: usize| forward.data[i].index;
    let count = rows.len() as f64;
    let channel = Channel::Static;
    // columns for each component, and one along the predicted displacement, as a change of stiffness would give
    let vary = |f: &dyn Fn(usize) -> f64| -> Vec<Vec<f64>> {
        let mut out: Vec<Vec<f64>> = (0..3)
            .map(|c| spread(forward, channel, |i, component| if component == c { f(row(i)) } else { 0.0 }))
            .collect();
        out.push(spread(forward, channel, |i, _| {
            f(row(i)) * fit.point.predicted[i] / forward.data[i].sigma / 30.0
        }));
        out
    };
    let order: Vec<Vec<f64>> = (0..6).flat_map(|k| vary(&|r| order_functions(r as f64 / count)[k])).collect();
    ask("the order of the tests".to_string(), order);
    for (j, joint) in campaign.arm.driven_joints().iter().enumerate() {
        let along = positions_of(joint, rows.iter().map(|row| row.pose_deg[j]));
        let entry: Vec<Vec<f64>> = (0..4).flat_map(|k| vary(&|r| along[r][k])).collect();
        ask(format!("the {} of {}", entry_word(joint), joint.name), entry);
    }
    let load: Vec<Vec<f64>> = [
        vary(&|r| rows[r].payload.mass_kg / 10.0),
        vary(&|r| (rows[r].payload.mass_kg / 10.0).powi(2)),
        vary(&|r| rows[r].force_n.norm() / 100.0),
    ]
    .concat();
    ask("the load".to_string(), load);
    let branch = vary(&|r| if rows[r].branch == "unloading" { 1.0 } else { 0.0 });
    ask("loading or unloading".to_string(), branch);
}

/// Four functions of the position of a joint at each row: waves of its angle, or smooth functions of its travel.
/// `entries` gives the joint's entry in the pose of each row.
fn positions_of(joint: &DrivenJoint, entries: impl Iterator<Item = f64>) -> Vec<[f64; 4]> {
    let entries: Vec<f64> = entries.collect();
    let (low, high) =
        entries.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), e| (l.min(*e), h.max(*e)));
    let of = |entry: &f64| match joint.motion {
        Motion::Turns => waves(*entry),
        Motion::Slides if high > low => {
            let [linear, square, sine, cosine, ..] = order_functions((entry - low) / (high - low));
            [linear, square, sine, cosine]
        }
        Motion::Slides => [0.0; 4],
    };
    entries.iter().map(of).collect()
}

/// Word for what a joint's entry in a pose is: angle or travel.
fn entry_word(joint: &DrivenJoint) -> &'static str {
    match joint.motion {
        Motion::Turns => "angle",
        Motion::Slides => "travel",
    }
}

fn modal_questions(campaign: &Campaign, forward: &Forward, ask: Ask) {
    let rows = &campaign.modal;
    let first = forward.starts[1];
    let count = rows.len() as f64;
    let function = |f: &dyn Fn(usize) -> f64| spread(forward, Channel::Modal, |i, _| f(i - first));
    let order = (0..6).map(|k| function(&|r| order_functions(r as f64 / count)[k])).collect();
    ask("the order of the tests".to_string(), order);
    for (j, joint) in campaign.arm.driven_joints().iter().enumerate() {
        let along = positions_of(joint, rows.iter().map(|row| row.pose_deg[j]));
        let low = |r: usize, k: usize| if rows[r].mode <= 2 { along[r][k] } else { 0.0 };
        let entry = (0..4).flat_map(|k| [function(&|r| along[r][k]), function(&|r| low(r, k))]).collect();
        ask(format!("the {} of {}", entry_word(joint), joint.name), entry);
    }
    let load = vec![function(&|r| rows[r].payload.mass_kg / 10.0), function(&|_| 1.0)];
    ask("the payload".to_string(), load);
    let modes = (1..=6).map(|m| function(&|r| if rows[r].mode == m { 1.0 } else { 0.0 })).collect();
    ask("the number of the mode".to_string(), modes);
}

fn windup_questions(campaign: &Campaign, forward: &Forward, ask: Ask) {
    let rows = &campaign.windup;
    let first = forward.starts[2];
    let names: Vec<&str> = campaign.arm.joints().map(|j| j.name.as_str()).collect();
    for name in names.into_iter().filter(|name| rows.iter().filter(|r| r.joint == *name).count() >= 6) {
        let largest = rows.iter().filter(|r| r.joint == name).map(|r| r.torque_nm.abs()).fold(1e-9, f64::max);
        let function = |f: &dyn Fn(f64, f64) -> f64| {
            spread(forward, Channel::Windup, |i, _| {
                let row = &rows[i - first];
                let side = if row.branch == "unloading" { 1.0 } else { -1.0 };
                if row.joint == name { f(row.torque_nm / largest, side) } else { 0.0 }
            })
        };
        let mut regressors: Vec<Vec<f64>> = (0..6).map(|k| function(&|t, _| t.powi(k))).collect();
        regressors.extend((0..3).map(|k| function(&|t, side| side * t.powi(k))));
        ask(format!("the torque on {name}"), regressors);
    }
}
