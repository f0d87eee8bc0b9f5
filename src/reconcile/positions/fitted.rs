//! A measured position with the effect of gravity on it, and a fitted model of geometry and compliances.

use super::deflection::Deflection;
use super::kinematics::{Geometry, Placer, Placing};
use super::kinematics_lanes::EightPlacer;
use super::pose::Pose;
use crate::mechanics::lanes::LANES;
use nalgebra::Vector3;
use rayon::prelude::*;
use std::sync::Arc;

/// Degrees of freedom ν of the Student distribution of the errors.
pub(crate) const NU: f64 = 4.0;
/// Number of samples whose errors one thread computes.
const PORTION: usize = 4096;

/// One measured position (sample), with its pose and its deflection.
#[derive(Debug, Clone)]
pub(crate) struct Sample {
    /// Angles of the driven joints, with their sines and cosines.
    pub pose: Pose,
    /// Index of the arm to which the point belongs.
    pub arm: usize,
    /// Index of the measured point among all points on tools.
    pub point: usize,
    /// Index of the session that sets the arm's place in the instrument's frame (station).
    pub station: usize,
    /// Where the row is in its file, from 0 for the first to 1 for the last.
    pub part: f64,
    /// Index of this sample, which is the index of its row in the campaign.
    pub index: usize,
    /// Number of the pose, counted over different poses. Samples of one pose are held out together.
    pub group: usize,
    /// Measured position in the instrument's frame \[m\]; zero where a coordinate was not measured.
    pub measured_m: Vector3<f64>,
    /// Weight of each coordinate's error, from 0.1 to 1: 0 if the coordinate was not measured, 1 if it has the
    /// smallest standard deviation of its row.
    pub precision: Vector3<f64>,
    /// How this position deflects under gravity: the known deflection, and what each candidate would add.
    pub deflection: Arc<Deflection>,
    /// Change of the known deflection per unit of each dependence of it, in the level frame \[m\].
    pub nominal_m: Arc<[Vector3<f64>]>,
    /// Difference between the true displacement by the whole model and the linear one, in the level frame \[m\]. It was
    /// computed with the model of the fit before the present one.
    pub second_order_m: Vector3<f64>,
}

impl Sample {
    /// Arm, pose, point and session of the sample, from which its position without deflection is computed.
    pub(crate) fn placing(&self) -> Placing<'_> {
        Placing { arm: self.arm, pose: &self.pose, point: self.point, station: self.station }
    }

    /// Number of coordinates of this position that were measured, 0 to 3.
    pub(crate) fn readings(&self) -> usize {
        self.precision.iter().filter(|p| **p > 0.0).count()
    }

    /// Error of this sample for the predicted position `predicted_m`, measured minus predicted \[m\]. It is zero
    /// where a coordinate was not measured.
    pub(crate) fn error(&self, predicted_m: Vector3<f64>) -> Vector3<f64> {
        (self.measured_m - predicted_m).zip_map(&self.precision, |e, p| if p > 0.0 { e } else { 0.0 })
    }

    /// The error `error_m` of this sample, with each coordinate multiplied by its weight for the fit.
    pub(crate) fn miss(&self, error_m: &Vector3<f64>) -> Miss {
        Miss { scaled_m: error_m.component_mul(&self.precision), readings: self.readings() as f64 }
    }
}

/// The error of a sample (a measured position), with each coordinate multiplied by its weight for the fit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Miss {
    /// Measured minus predicted position, times the weight of each coordinate \[m\].
    pub scaled_m: Vector3<f64>,
    /// Number of coordinates that were measured.
    pub readings: f64,
}

/// Number of measured coordinates, summed over all samples.
pub(crate) fn readings(samples: &[Sample]) -> usize {
    samples.iter().map(Sample::readings).sum()
}

/// A fitted model of geometry and compliances.
#[derive(Debug, Clone)]
pub(crate) struct Fitted {
    /// The calibrated geometry.
    pub geometry: Geometry,
    /// Change of each freed number of the geometry from its nominal value, in the number's unit.
    pub moved: Vec<f64>,
    /// Standard deviations of the freed numbers of the geometry, in the numbers' units.
    pub number_deviations: Vec<f64>,
    /// Indices of the candidates that the model contains as effects.
    pub effects: Vec<usize>,
    /// The compliances of each effect, in the order of `effects` \[rad/(N m)\]; the half width for play \[rad\].
    pub compliances: Vec<Vec<f64>>,
    /// Standard deviations of the compliances, in the order and units of `compliances`.
    pub deviations: Vec<Vec<f64>>,
    /// Sandwich factor: ratio of the standard deviations of the robust fit to those of the weighted curvature alone.
    pub robust_factor: f64,
    /// Scale of the Student distribution of the position errors \[m\].
    pub scale_m: f64,
    /// Natural logarithm of the likelihood of all measured positions.
    pub ln_likelihood: f64,
}

impl Fitted {
    /// A model of `geometry` without effects, whose position errors have the scale `scale_m`.
    pub(crate) fn rigid(geometry: Geometry, scale_m: f64) -> Self {
        Self {
            geometry,
            moved: Vec::new(),
            number_deviations: Vec::new(),
            effects: Vec::new(),
            compliances: Vec::new(),
            deviations: Vec::new(),
            robust_factor: 1.0,
            scale_m,
            ln_likelihood: 0.0,
        }
    }

    /// Predicted position of a sample, in the instrument's frame \[m\].
    pub(crate) fn predicted_m(&self, sample: &Sample) -> Vector3<f64> {
        self.predicted_by(&mut self.geometry.placer(), sample)
    }

    /// Predicted position of a sample, in the instrument's frame \[m\]. `placer` must belong to this model's
    /// geometry; it is passed in because that is faster for many samples.
    pub(crate) fn predicted_by(&self, placer: &mut Placer, sample: &Sample) -> Vector3<f64> {
        let rigid = placer.place_m(sample.placing());
        rigid + self.geometry.level_to_instrument() * self.displacement(sample) + self.drifted_m(sample)
    }

    /// How far a sample has drifted since the first row, in the instrument's frame \[m\].
    pub(crate) fn drifted_m(&self, sample: &Sample) -> Vector3<f64> {
        self.geometry.drift_m * sample.part
    }

    /// Displacement of the measured point of a sample by gravity, in the level frame \[m\]: the known deflection, plus
    /// the deflection by the effects of the model, plus the part that linear statics lack.
    pub(crate) fn displacement(&self, sample: &Sample) -> Vector3<f64> {
        let gravity = &self.geometry.gravity;
        let [by_x, by_y] = &sample.deflection.known_slopes_m;
        // most dependences are zero; reading them all from memory would take longer than the sum
        let dependent = self.geometry.dependences.iter().zip(sample.nominal_m.iter());
        let dependent = dependent.filter(|(x, _)| **x != 0.0);
        let known_m = dependent.fold(sample.deflection.known_m, |sum, (x, by)| sum + by * *x);
        let without_effects_m = known_m + by_x * gravity.x + by_y * gravity.y + sample.second_order_m;
        without_effects_m + self.displaced_m(sample, gravity)
    }

    /// How far the effects of the model let the measured point of a sample move under gravity along the direction
    /// `gravity`, in the level frame \[m\]. The effects deflect elastically or close their play.
    pub(crate) fn displaced_m(&self, sample: &Sample, gravity: &Vector3<f64>) -> Vector3<f64> {
        let effects = self.effects.iter().zip(&self.compliances);
        effects.fold(Vector3::zeros(), |sum, (&effect, compliances)| {
            sum + sample.deflection.displaced_m(effect, compliances, gravity)
        })
    }

    /// Derivative of the displacement of a sample with respect to the component of gravity with the index `axis`, in the
    /// level frame \[m\]. The unit vector of gravity keeps its length as the component changes.
    pub(crate) fn leaning_m(&self, sample: &Sample, axis: usize) -> Vector3<f64> {
        let gravity = &self.geometry.gravity;
        let by = Vector3::ith(axis, 1.0) - gravity * gravity[axis];
        let [by_x, by_y] = &sample.deflection.known_slopes_m;
        let effects = self.effects.iter().zip(&self.compliances);
        effects.fold(by_x * by.x + by_y * by.y, |sum, (&effect, compliances)| {
            sum + sample.deflection.leaning_m(effect, compliances, gravity, &by)
        })
    }

    /// Weight of a sample with the error `miss` in the normal equations \[1/m²\].
    pub(crate) fn weight(&self, miss: &Miss) -> f64 {
        weight(miss, self.scale_m) / (self.scale_m * self.scale_m)
    }
}

/// Errors of the samples with the model `fitted`, each coordinate multiplied by its weight for the fit.
pub(crate) fn misses(samples: &[&Sample], fitted: &Fitted) -> Vec<Miss> {
    samples.iter().zip(errors_m(samples, fitted)).map(|(sample, error_m)| sample.miss(&error_m)).collect()
}

/// Errors of the samples with the model `fitted`, measured minus predicted position \[m\]; zero where a coordinate was not
/// measured.
pub(super) fn errors_m(samples: &[&Sample], fitted: &Fitted) -> Vec<Vector3<f64>> {
    samples.iter().zip(predictions_m(samples, fitted)).map(|(sample, at_m)| sample.error(at_m)).collect()
}

/// Predicted positions of the samples, in the instrument's frame \[m\].
pub(super) fn predictions_m(samples: &[&Sample], fitted: &Fitted) -> Vec<Vector3<f64>> {
    let order = by_arm(samples);
    let portions = order.par_chunks(PORTION).map(|portion| predictions_of(portion, samples, fitted));
    let portions: Vec<Vec<Vector3<f64>>> = portions.collect();
    let mut out = vec![Vector3::zeros(); samples.len()];
    order.iter().zip(portions.into_iter().flatten()).for_each(|(&i, at_m)| out[i] = at_m);
    out
}

/// Predicted positions of those samples that have the indices `portion`, arm by arm \[m\].
fn predictions_of(portion: &[usize], samples: &[&Sample], fitted: &Fitted) -> Vec<Vector3<f64>> {
    let mut placer = EightPlacer::new(&fitted.geometry);
    let from_level = fitted.geometry.level_to_instrument();
    let mut out = Vec::with_capacity(portion.len());
    for eight in eights(portion, samples) {
        let asked: Vec<Placing> = eight.iter().map(|&i| samples[i].placing()).collect();
        for (&i, rigid_m) in eight.iter().zip(placer.place_m(&asked)) {
            let displaced_m = from_level * fitted.displacement(samples[i]);
            out.push(rigid_m + displaced_m + fitted.drifted_m(samples[i]));
        }
    }
    out
}

/// The indices of the samples, sorted by arm. Blocks of samples of one arm have many columns of zeros, because the
/// numbers of one arm move no point of another.
pub(crate) fn by_arm(samples: &[&Sample]) -> Vec<usize> {
    let mut out: Vec<usize> = (0..samples.len()).collect();
    out.sort_by_key(|&i| samples[i].arm);
    out
}

/// Divides the indices `order` of samples into groups of up to eight samples of one arm each, in their order.
pub(crate) fn eights<'a>(order: &'a [usize], samples: &'a [&Sample]) -> impl Iterator<Item = &'a [usize]> {
    let arms = order.chunk_by(|a, b| samples[*a].arm == samples[*b].arm);
    arms.flat_map(|own| own.chunks(LANES))
}

/// Weight of a sample with the error `miss` in the fit, without unit. It is more than 1 for errors well below the
/// scale `scale_m`, and falls as the error grows.
pub(crate) fn weight(miss: &Miss, scale_m: f64) -> f64 {
    (NU + miss.readings) / (NU + miss.scaled_m.norm_squared() / (scale_m * scale_m))
}
