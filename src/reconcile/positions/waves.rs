//! Finds joints whose stiffness varies with their angle, and states the amplitudes. They are searched together with
//! transmission errors, which also follow the angle.

use super::analysis::Positions;
use super::dependence::Dependence;
use super::fitted::Fitted;
use super::intervals::within;
use super::kinematics::Number;
use super::search::TIE;
use super::shape::{Shape, Waves};
use super::transmission;
use crate::arm::effect::{connection_compliance, joint_compliance, stiffness_waves};
use crate::arm::joint_law::Curve;
use crate::arm::structure::Piece;
use crate::reconcile::model::calibration::Calibration;
use crate::reconcile::model::estimate::Estimate;
use crate::reconcile::readings::campaign::Campaign;
use std::f64::consts::PI;

/// The compliance of a joint must vary by less than this fraction of its mean over all angles.
const LARGEST_VARIATION: f64 = 0.9;

impl Positions {
    /// Finds the one addition that raises the likelihood most: a stiffness that varies with a joint's angle, or a
    /// transmission error. Adds it if the rise is worth its price and held-out poses confirm it. If a varying stiffness
    /// is not confirmed, the best transmission error is tried in its place. Returns whether one was added.
    pub(super) fn add_periodic(&mut self, campaign: &Campaign) -> bool {
        let uneven = self.best_transmission();
        let base = &self.fitted;
        let varies = |c: usize| self.candidates[c].shape.waves().is_some();
        let tried = self.best_additions(base, varies, |c| self.required_rise(base, c)).into_iter();
        let gain = |f: &Fitted| {
            f.ln_likelihood - self.prices(&f.effects) - (base.ln_likelihood - self.prices(&base.effects))
        };
        let possible = tried.filter(|(_, f)| self.has_possible_waves(f));
        let varying = possible.map(|(c, f)| (gain(&f), c, f)).filter(|(gain, ..)| *gain > 0.0);
        let varying = varying.max_by(|a, b| a.0.total_cmp(&b.0));
        match (varying, uneven) {
            (Some((gain, c, fitted)), uneven) if uneven.as_ref().is_none_or(|(other, _)| gain > *other) => {
                let next = Self { fitted, ..self.clone() };
                self.take_if_confirmed(campaign, next, self.label(c))
                    || uneven
                        .is_some_and(|(_, (joint, fitted))| self.take_transmission(campaign, joint, fitted))
            }
            (_, Some((_, (joint, fitted)))) => self.take_transmission(campaign, joint, fitted),
            _ => false,
        }
    }

    /// Compliance of the joint `at` about its axis in the fit `fitted`, averaged over all angles \[rad/(N m)\]. `None`
    /// if there is no such joint, or if its twist is not proportional to the torque.
    pub(super) fn mean_rad_per_nm(&self, fitted: &Fitted, at: &str) -> Option<f64> {
        let [gear, connection] = self.nominal_rad_per_nm(at)?;
        let factor = self.stiffness_factors(fitted, at).map(|(_, factor, _)| factor).product::<f64>();
        let further: f64 = self.springs_about(fitted, at).map(|i| fitted.compliances[i][0]).sum();
        Some(gear / factor + connection + further)
    }

    /// Derivatives of the mean compliance of the joint `at` with respect to the numbers of the model: the factor on its
    /// stiffness and its compliances.
    fn mean_slopes(&self, at: &str) -> Vec<(usize, f64)> {
        let Some([gear, _]) = self.nominal_rad_per_nm(at) else { return Vec::new() };
        let fitted = &self.fitted;
        let all = self.stiffness_factors(fitted, at).map(|(_, factor, _)| factor).product::<f64>();
        // the compliance gear / factor is linear in the number, with the factor 1 / (1 - sd x)
        let factors = self.stiffness_factors(fitted, at).filter_map(|(k, factor, sd)| {
            let number = self.numbers.iter().position(|n| *n == Number::Tolerance(k))?;
            Some((number, -gear / all * sd * factor))
        });
        let springs = self.springs_about(fitted, at).map(|i| (self.first_compliance(i), 1.0));
        factors.chain(springs).collect()
    }

    /// Compliance of the gear of the joint `at`, and compliance of its connection, as in the arm file \[rad/(N m)\].
    /// `None` if there is no such joint, or if the twist of its gear is not proportional to the torque.
    fn nominal_rad_per_nm(&self, at: &str) -> Option<[f64; 2]> {
        let joint = self.tree.pieces.iter().find_map(|piece| match piece {
            Piece::Joint(joint) if joint.name == at => Some(joint),
            _ => None,
        })?;
        let gear = match joint.law.curve {
            Curve::Rigid => 0.0,
            Curve::Linear(nm_per_rad) => 1.0 / nm_per_rad,
            Curve::Windup(_) | Curve::WindupK1(_) => return None,
        };
        Some([gear, joint.law.connection_rad_per_nm])
    }

    /// The factors on the stiffness of the joint `at` in the fit `fitted`: index among the dependences, factor, and
    /// standard deviation of its logarithm that follows from the tolerance.
    fn stiffness_factors(&self, fitted: &Fitted, at: &str) -> impl Iterator<Item = (usize, f64, f64)> {
        let all = self.dependences.iter().zip(&fitted.geometry.dependences).enumerate();
        all.filter_map(move |(k, (dependence, x))| match dependence {
            Dependence::Tolerance(Calibration::Stiffness(name), sd) if name == at => {
                Some((k, dependence.value(*x), *sd))
            }
            _ => None,
        })
    }

    /// Positions, among the effects of the fit `fitted`, of the springs about the axis of the joint `at`.
    fn springs_about(&self, fitted: &Fitted, at: &str) -> impl Iterator<Item = usize> {
        let is_own = move |effect: usize| {
            let candidate = &self.candidates[effect];
            let names = [joint_compliance::KIND.name, connection_compliance::KIND.name];
            candidate.at == at && names.contains(&candidate.effect)
        };
        (0..fitted.effects.len()).filter(move |i| is_own(fitted.effects[*i]))
    }

    /// Whether the candidate can be added to the model `fitted`. A stiffness that varies with the angle needs a joint
    /// that has a compliance in the model. True for all other candidates.
    pub(super) fn can_vary(&self, fitted: &Fitted, candidate: usize) -> bool {
        let candidate = &self.candidates[candidate];
        candidate.shape.waves().is_none()
            || self.mean_rad_per_nm(fitted, &candidate.at).is_some_and(|c| c > 0.0)
    }

    /// Whether, in the fit `fitted`, the compliance of each joint varies by less than [`LARGEST_VARIATION`] of its mean.
    pub(super) fn has_possible_waves(&self, fitted: &Fitted) -> bool {
        fitted.effects.iter().zip(&fitted.compliances).all(|(&e, sizes)| {
            let candidate = &self.candidates[e];
            let mean = self.mean_rad_per_nm(fitted, &candidate.at).unwrap_or_default();
            let amplitudes = sizes.chunks(2).map(|size| libm::hypot(size[0], size[1]));
            candidate.shape.waves().is_none() || amplitudes.sum::<f64>() < LARGEST_VARIATION * mean
        })
    }

    /// The parameters, with their 95 % intervals, of effect number `position` of the model, which must be
    /// `stiffness_waves`.
    pub(super) fn wave_parameters(&self, position: usize, waves: Waves) -> Vec<(String, Vec<Estimate>)> {
        let at = &self.candidates[self.fitted.effects[position]].at;
        let mean = self.mean_rad_per_nm(&self.fitted, at).unwrap_or_default();
        let slopes = self.mean_slopes(at);
        let sizes = &self.fitted.compliances[position];
        let first = self.first_compliance(position);
        let own = sizes.chunks(2).enumerate().map(|(k, size)| {
            let reaches = slopes_of_wave(size, mean).map(|[sin, cos, by_mean]| {
                let of_mean = slopes.iter().map(|(number, slope)| (*number, by_mean * slope));
                let own = [(first + 2 * k, sin), (first + 2 * k + 1, cos)];
                self.reach(&own.into_iter().chain(of_mean).collect::<Vec<_>>())
            });
            wave(size, mean, reaches)
        });
        let known = waves.range().step_by(2).map(|k| k / 2).zip(own);
        let mut parameters = Vec::new();
        let none = Estimate { value: 0.0, low: None, high: None };
        let mut phases = vec![none; 2];
        for (k, [size, phase]) in known {
            parameters.push((["once", "twice"][k].to_string(), vec![size]));
            phases[k] = phase;
        }
        parameters.push(("phases_rad".into(), phases));
        parameters
    }

    /// Driven joints whose transmission error would fit as well in the place of effect number `position`, if this
    /// effect is a stiffness that varies with the angle. `without` is the fit without this effect.
    pub(super) fn transmissions_instead(&self, position: usize, without: &Fitted) -> Vec<(String, String)> {
        if self.candidates[self.fitted.effects[position]].shape.waves().is_none() {
            return Vec::new();
        }
        let missing = self.missing(without);
        let without = Self { fitted: without.clone(), ..self.clone() };
        let tried = without.best_transmissions(missing).into_iter();
        let good = tried.filter(|(_, f)| f.ln_likelihood > self.fitted.ln_likelihood - TIE);
        good.map(|(j, _)| (transmission::EFFECT.to_string(), self.tree.driven[j].clone())).collect()
    }

    /// Joints: a stiffness of one of them that varies with the angle would fit as well as the transmission error of the
    /// driven joint `joint`.
    pub(super) fn waves_instead(&self, joint: usize) -> Vec<(String, String)> {
        let without = self.without_transmission(joint);
        let varies = |c: usize| self.candidates[c].shape.waves().is_some();
        let tried = without.best_additions(&without.fitted, varies, |_| self.missing(&without.fitted));
        let is_good =
            |f: &Fitted| f.ln_likelihood > self.fitted.ln_likelihood - TIE && self.has_possible_waves(f);
        let good = tried.into_iter().filter(|(_, f)| is_good(f));
        good.map(|(c, _)| (stiffness_waves::KIND.name.to_string(), self.candidates[c].at.clone())).collect()
    }
}

/// Derivatives of the amplitude `a = hypot(S, C)/m` and of the phase `atan2(C, S)` of a wave with respect to the coefficients
/// of sine `S` and cosine `C` and to the mean compliance `m`.
fn slopes_of_wave(size: &[f64], mean: f64) -> [[f64; 3]; 2] {
    let [sin, cos] = [size[0], size[1]];
    let length = libm::hypot(sin, cos);
    [
        [sin / (length * mean), cos / (length * mean), -length / (mean * mean)],
        [-cos / (length * length), sin / (length * length), 0.0],
    ]
}

/// Amplitude and phase of a wave with the coefficients `size` about the mean compliance `mean` \[rad/(N m)\], with
/// their 95 % intervals. `reaches` has, for both, the distances of the ends of the interval from the value, divided by
/// 1.96 (see [`within`]).
fn wave(size: &[f64], mean: f64, reaches: [[f64; 2]; 2]) -> [Estimate; 2] {
    let (amplitude, phase) = (libm::hypot(size[0], size[1]) / mean, libm::atan2(size[1], size[0]));
    let size = within(amplitude, reaches[0]);
    let turned = within(phase, reaches[1]);
    let is_known = turned.low.zip(turned.high).is_some_and(|(low, high)| high - low < 2.0 * PI);
    let end = |x: Option<f64>| x.filter(|_| is_known);
    [
        Estimate { low: size.low.map(|low| low.max(0.0)), ..size },
        Estimate { low: end(turned.low), high: end(turned.high), ..turned },
    ]
}

/// The amplitudes and phases of `stiffness_waves` for the coefficients `sizes` about the mean compliance `mean`, both in
/// rad/(N m): `once`, `twice` and `phases_rad`.
pub(super) fn as_parameters(waves: Waves, sizes: &[f64], mean: f64) -> Vec<(String, Vec<f64>)> {
    let mut parameters = Vec::new();
    let mut phases = vec![0.0; 2];
    for (k, size) in waves.range().step_by(2).map(|k| k / 2).zip(sizes.chunks(2)) {
        parameters.push((["once", "twice"][k].to_string(), vec![libm::hypot(size[0], size[1]) / mean]));
        phases[k] = libm::atan2(size[1], size[0]);
    }
    parameters.push(("phases_rad".into(), phases));
    parameters
}

/// The waves of a shape; `None` if it has none.
pub(super) fn of(shape: Shape) -> Option<Waves> {
    match shape {
        Shape::Waves(waves) => Some(waves),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reconcile::model::estimate::Z_95;
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};

    /// The scatter of amplitudes and phases over many draws agrees with the derivatives. Coefficients and mean are
    /// correlated: they are drawn as linear combinations of three independent numbers.
    #[test]
    fn amplitude_and_phase_scatter_with_the_coefficients_and_with_the_mean() {
        const DRAWS: usize = 40_000;
        let (size, mean) = ([3e-7, -4e-7], 2e-6);
        let by = [[1e-8, 0.0, 0.0], [5e-9, 1e-8, 0.0], [-2e-8, 3e-8, 6e-8]];
        let mut dice = Xoshiro256PlusPlus::seed_from_u64(5);
        // uniform, with the standard deviation 1
        let mut next = || ((dice.next_u64() >> 11) as f64 / (1u64 << 53) as f64 - 0.5) * 12f64.sqrt();
        let draws: Vec<[f64; 2]> = (0..DRAWS)
            .map(|_| {
                let own = [next(), next(), next()];
                let off = by.map(|row| row.iter().zip(own).map(|(b, x)| b * x).sum::<f64>());
                let (sin, cos) = (size[0] + off[0], size[1] + off[1]);
                [libm::hypot(sin, cos) / (mean + off[2]), libm::atan2(cos, sin)]
            })
            .collect();
        for (k, slopes) in slopes_of_wave(&size, mean).into_iter().enumerate() {
            let center = draws.iter().map(|d| d[k]).sum::<f64>() / DRAWS as f64;
            let drawn = (draws.iter().map(|d| (d[k] - center).powi(2)).sum::<f64>() / DRAWS as f64).sqrt();
            let per_number = |c: usize| (0..3).map(|row| slopes[row] * by[row][c]).sum::<f64>();
            let said = (0..3).map(|c| per_number(c).powi(2)).sum::<f64>().sqrt();
            assert!((drawn / said - 1.0).abs() < 0.02, "{k}: {drawn} drawn, {said} said");
        }
    }

    #[test]
    fn amplitude_and_phase_are_those_of_the_law() {
        // 2e-6 (0.3 sin(q + 0.8)) has the coefficients of sin q and cos q below
        let (mean, size, phase): (f64, f64, f64) = (2e-6, 0.3, 0.8);
        let sizes = [mean * size * phase.cos(), mean * size * phase.sin()];
        let [found, turned] = wave(&sizes, mean, [[0.02, 0.01], [0.04, 0.02]]);
        assert!((found.value - size).abs() < 1e-12 && (turned.value - phase).abs() < 1e-12);
        assert!((found.high.expect("bounded") - size - Z_95 * 0.01).abs() < 1e-12);
        assert!((found.low.expect("bounded") - size + Z_95 * 0.02).abs() < 1e-12);
        assert!((turned.high.expect("bounded") - phase - Z_95 * 0.02).abs() < 1e-12);
        let stated = as_parameters(Waves::Twice, &sizes, mean);
        assert_eq!((stated[0].0.as_str(), stated[1].1[0]), ("twice", 0.0));
        assert!((stated[0].1[0] - size).abs() < 1e-12 && (stated[1].1[1] - phase).abs() < 1e-12);
    }
}
