//! Tests whether the errors of the best model depend on any known quantity.
//!
//! For each quantity there are a few columns `X`, functions of it that the errors could follow. The part of the columns
//! that the model itself could fit is removed. The sum of squares that the columns explain, in units of the fitted
//! scale, then follows a chi-squared distribution if the errors do not depend on the quantity. A structure is material
//! if it explains more than a tenth of the sum of squares and is no chance result.

use super::analysis::Positions;
use super::fitted::{Sample, readings};
use super::normal::Factor;
use super::rows::normal;
use super::shape::Shape;
use crate::arm::effect::channel::Channel;
use crate::arm::effect::kind::ElasticRotation;
use crate::reconcile::fit::stats::{MEDIAN_OF_NORMAL, ln_chi_squared_tail, median};
use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::readings::rows::PositionRow;
use crate::reconcile::select::lack_of_fit::LackOfFit;
use crate::reconcile::select::structure::Structure;
use crate::reconcile::select::waves::{order_functions, waves};
use nalgebra::{DMatrix, SymmetricEigen, Vector3};

/// A structure in the errors is material only if it explains more than this fraction of their sum of squares.
pub(crate) const MATERIAL_PART: f64 = 0.1;
/// If the variance of the errors is below this multiple of the declared variance, the excess is ascribed to declared
/// standard deviations that are too small, and not to the model.
pub(crate) const MATERIAL_VARIANCE: f64 = 1.75;
/// A structure of the errors is taken as real if chance gives it with a probability below this, after correction for
/// the number of tests.
const IMPROBABLE: f64 = 1e-6;
/// Median length of a vector whose one, two or three components are standard normal deviates.
const MEDIAN_LENGTHS: [f64; 3] = [MEDIAN_OF_NORMAL, 1.1774, 1.538];

/// One test of the errors: the quantity that the errors would follow, in words, and the number of columns of the test.
type Question = (String, usize);

impl Positions {
    /// Tests whether the errors of the fitted model depend on the order of the readings, the joint angles, the joint
    /// torques or the payload.
    pub(crate) fn lack_of_fit(&self, campaign: &Campaign) -> LackOfFit {
        let all: Vec<&Sample> = self.samples.iter().collect();
        let asker = Asker::new(self, campaign);
        let normal = normal(&all, &self.numbers, &self.fitted, &|s, _, out| asker.columns(s, out));
        let own: Vec<usize> = (0..normal.own).collect();
        let mut structures = Vec::new();
        let mut at = normal.own;
        let factor = Factor::new(&normal.curvature, &own);
        for (follows, count) in &asker.questions {
            let block: Vec<usize> = (at..at + count).collect();
            at += count;
            let Some(factor) = &factor else { break };
            let cross = normal.curvature.view((0, block[0]), (normal.own, *count)).into_owned();
            // the part of the columns that the model itself could fit
            let answered = DMatrix::from_columns(
                &(0..*count).map(|k| factor.solve(&cross.column(k).into_owned())).collect::<Vec<_>>(),
            );
            let s =
                normal.curvature.view((block[0], block[0]), (*count, *count)) - cross.transpose() * &answered;
            let z = normal.gradient.rows(block[0], *count)
                - answered.transpose() * normal.gradient.rows(0, normal.own);
            let (statistic, dof) = squares(&s, &z.into_owned());
            if dof > 0.0 {
                let ln_p = ln_chi_squared_tail(statistic, dof);
                structures.push(Structure {
                    channel: Some(Channel::Positions),
                    follows: follows.clone(),
                    statistic,
                    dof,
                    ln_p,
                });
            }
        }
        // Bonferroni correction for the number of tests, as for the other readings
        let asked = libm::log((structures.len() as f64).max(1.0));
        structures.iter_mut().for_each(|s| s.ln_p = (s.ln_p + asked).min(0.0));
        structures.sort_by(|a, b| b.statistic.total_cmp(&a.statistic));
        let fails = structures.iter().any(|s| self.is_material(s));
        LackOfFit { structures, chi2_per_dof: self.variance_ratio(campaign), fails }
    }

    /// Fraction of the errors' sum of squares that the structure `structure` explains.
    pub(crate) fn part(&self, structure: &Structure) -> f64 {
        structure.statistic / readings(&self.samples) as f64
    }

    /// Whether the structure `structure` is no chance result and explains more than [`MATERIAL_PART`] of the errors'
    /// sum of squares.
    pub(crate) fn is_material(&self, structure: &Structure) -> bool {
        structure.ln_p < libm::log(IMPROBABLE) && self.part(structure) > MATERIAL_PART
    }

    /// Ratio of the variance of the errors to the declared variance. It is estimated from the median length of an
    /// error, so that a few gross errors hardly change it.
    fn variance_ratio(&self, campaign: &Campaign) -> f64 {
        let rows = campaign.positions.iter().zip(&self.samples).zip(self.errors_m());
        let lengths = rows.map(|((row, s), error_m)| declared_length(row, &error_m) / median_length(s));
        let free = (self.numbers.len() + self.fitted.compliances.iter().map(Vec::len).sum::<usize>()) as f64;
        let count = readings(&self.samples) as f64;
        median(lengths.collect()).powi(2) * count / (count - free).max(1.0)
    }
}

/// Length of the error of one position, with each measured coordinate divided by its declared standard deviation.
fn declared_length(row: &PositionRow, error_m: &Vector3<f64>) -> f64 {
    let parts = row.measured.iter().zip(error_m.iter());
    let squares = parts.filter_map(|(read, e)| Some((1e3 * e / (*read)?.sigma_mm).powi(2)));
    squares.sum::<f64>().sqrt()
}

/// Median length of a sample's error if each of its measured coordinates has the standard deviation 1 and no
/// systematic error.
fn median_length(sample: &Sample) -> f64 {
    MEDIAN_LENGTHS[sample.readings().clamp(1, 3) - 1]
}

/// Mean over the samples of the median length that `median_length` gives for each. It depends on how many coordinates
/// were measured.
pub(crate) fn mean_median_length(samples: &[Sample]) -> f64 {
    samples.iter().map(median_length).sum::<f64>() / samples.len().max(1) as f64
}

/// The statistic `zᵀ S⁻¹ z`, restricted to the directions in which the matrix `S` is not singular, and the number of
/// these directions.
pub(crate) fn squares(s: &DMatrix<f64>, z: &nalgebra::DVector<f64>) -> (f64, f64) {
    let eigen = SymmetricEigen::new((s + s.transpose()) * 0.5);
    let largest = eigen.eigenvalues.max();
    let (mut statistic, mut dof) = (0.0, 0.0);
    // directions that the model can already fit give no information
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > 1e-6 * largest && *value > 1e-9 {
            statistic += vector.dot(z).powi(2) / value;
            dof += 1.0;
        }
    }
    (statistic, dof)
}

/// Computes, for one sample at a time, the columns of every test \[m per unit\]: functions of the quantities that the
/// errors could follow.
struct Asker<'a> {
    found: &'a Positions,
    questions: Vec<Question>,
    /// For each joint, the index of the candidate that is a compliance about its axis, and the largest torque on the
    /// joint \[N m\].
    joints: Vec<(usize, f64)>,
    /// For each driven joint, the index of the candidate that is its compliance about the axis.
    driven: Vec<usize>,
    largest_payload_kg: f64,
    payloads_kg: Vec<f64>,
}

impl<'a> Asker<'a> {
    fn new(found: &'a Positions, campaign: &Campaign) -> Self {
        let joint = |c: &usize| {
            let candidate = &found.candidates[*c];
            candidate.rotation == ElasticRotation::AboutAxis && candidate.shape == Shape::Spring
        };
        let torque =
            |c: usize| found.samples.iter().map(|s| s.deflection.lever(c).1.abs()).fold(1e-9, f64::max);
        let joints: Vec<(usize, f64)> =
            (0..found.candidates.len()).filter(joint).map(|c| (c, torque(c))).collect();
        let at = |name: &String| joints.iter().find(|(c, _)| found.candidates[*c].at == *name).map(|j| j.0);
        let driven: Vec<usize> = found.tree.driven.iter().filter_map(at).collect();
        let payloads_kg: Vec<f64> = campaign.positions.iter().map(|r| r.payload.mass_kg).collect();
        let largest_payload_kg = payloads_kg.iter().copied().fold(0.0, f64::max);
        let mut questions = vec![("the order of the readings".to_string(), 18)];
        questions.extend(found.tree.driven.iter().map(|name| (format!("the angle of {name}"), 16)));
        questions
            .extend(joints.iter().map(|(c, _)| (format!("the torque on {}", found.candidates[*c].at), 2)));
        if largest_payload_kg > 0.0 {
            questions.push(("the payload".into(), 6));
        }
        Self { found, questions, joints, driven, largest_payload_kg, payloads_kg }
    }

    fn columns(&self, sample: &Sample, out: &mut Vec<Vector3<f64>>) {
        let along = |size: f64| (0..3).map(move |c| Vector3::ith(c, size));
        let index = sample.index;
        let order = order_functions(index as f64 / self.found.samples.len() as f64);
        out.extend(order.into_iter().flat_map(along));
        let from_level = self.found.fitted.geometry.level_to_instrument();
        for (j, &candidate) in self.driven.iter().enumerate() {
            let lever = from_level * sample.deflection.lever(candidate).0;
            for wave in waves(sample.pose.turns()[j].rad.to_degrees()) {
                out.extend(along(wave));
                out.push(lever * wave);
            }
        }
        for (candidate, largest_nm) in &self.joints {
            let (lever, torque_nm) = sample.deflection.lever(*candidate);
            let part = torque_nm / largest_nm;
            out.extend([libm::tanh(8.0 * part), part.powi(3)].map(|size| from_level * lever * size));
        }
        if self.largest_payload_kg > 0.0 {
            let part = self.payloads_kg[index] / self.largest_payload_kg;
            out.extend([part, part * part].into_iter().flat_map(along));
        }
    }
}
