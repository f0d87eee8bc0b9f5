//! A joint whose stiffness varies with its angle, as positions show it: the amplitudes, and the search together with
//! transmission errors, which follow the angle too.

use super::analysis::Positions;
use super::dependence::Dependence;
use super::fitted::Fitted;
use super::search::TIE;
use super::shape::{Shape, Waves};
use super::transmission;
use crate::arm::effect::{connection_compliance, joint_compliance, stiffness_waves};
use crate::arm::joint_law::Curve;
use crate::arm::structure::Piece;
use crate::reconcile::model::calibration::Calibration;
use crate::reconcile::model::estimate::{Estimate, Z_95};
use crate::reconcile::readings::campaign::Campaign;
use std::f64::consts::PI;

/// The compliance of a joint must vary by less than this fraction of its mean over all angles.
const MOST: f64 = 0.9;

impl Positions {
    /// Finds the one addition that raises the likelihood most: a stiffness that varies with a joint's angle, or a
    /// transmission error. Adds it if the rise is worth its price and held-out poses confirm it. Returns whether one
    /// was added.
    pub(super) fn add_periodic(&mut self, campaign: &Campaign) -> bool {
        let uneven = self.best_transmission(campaign);
        let base = &self.fitted;
        let varies = |c: usize| self.candidates[c].shape.waves().is_some();
        let tried = self.best_additions(base, varies, |c| self.least_rise(base, c)).into_iter();
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

    /// Compliance of the joint `at` about its axis in the fit `fitted`, the mean over all angles \[rad/(N m)\]; `None` if it
    /// is not proportional to the torque.
    pub(super) fn mean_rad_per_nm(&self, fitted: &Fitted, at: &str) -> Option<f64> {
        let joint = self.tree.pieces.iter().find_map(|piece| match piece {
            Piece::Joint(joint) if joint.name == at => Some(joint),
            _ => None,
        })?;
        let gear = match joint.law.curve {
            Curve::Rigid => 0.0,
            Curve::Linear(nm_per_rad) => 1.0 / nm_per_rad,
            Curve::Windup(_) | Curve::WindupK1(_) => return None,
        };
        let factors = self.dependences.iter().zip(&fitted.geometry.dependences);
        let factor = factors.filter_map(|(dependence, x)| match dependence {
            Dependence::Tolerance(Calibration::Stiffness(name), _) if name == at => {
                Some(dependence.value(*x))
            }
            _ => None,
        });
        let springs = fitted.effects.iter().zip(&fitted.compliances);
        let springs = springs.filter(|(e, _)| {
            let candidate = &self.candidates[**e];
            let names = [joint_compliance::KIND.name, connection_compliance::KIND.name];
            candidate.at == at && names.contains(&candidate.effect)
        });
        let further: f64 = springs.map(|(_, own)| own[0]).sum();
        Some(gear / factor.product::<f64>() + joint.law.connection_rad_per_nm + further)
    }

    /// Whether the candidate can be added to the model `fitted`. A stiffness that varies with the angle needs a joint
    /// that has a compliance in the model. True for all other candidates.
    pub(super) fn can_vary(&self, fitted: &Fitted, candidate: usize) -> bool {
        let candidate = &self.candidates[candidate];
        candidate.shape.waves().is_none()
            || self.mean_rad_per_nm(fitted, &candidate.at).is_some_and(|c| c > 0.0)
    }

    /// Whether, in the fit `fitted`, the compliance of each joint varies by less than [`MOST`] of its mean.
    pub(super) fn has_possible_waves(&self, fitted: &Fitted) -> bool {
        fitted.effects.iter().zip(&fitted.compliances).all(|(&e, sizes)| {
            let candidate = &self.candidates[e];
            let mean = self.mean_rad_per_nm(fitted, &candidate.at).unwrap_or_default();
            let amplitudes = sizes.chunks(2).map(|size| libm::hypot(size[0], size[1]));
            candidate.shape.waves().is_none() || amplitudes.sum::<f64>() < MOST * mean
        })
    }

    /// The parameters of `stiffness_waves` that is effect number `position` of the model, with their 95 % intervals.
    pub(super) fn wave_parameters(&self, position: usize, waves: Waves) -> Vec<(String, Vec<Estimate>)> {
        let at = &self.candidates[self.fitted.effects[position]].at;
        let mean = self.mean_rad_per_nm(&self.fitted, at).unwrap_or_default();
        let (sizes, deviations) = (&self.fitted.compliances[position], &self.fitted.deviations[position]);
        let own =
            sizes.chunks(2).zip(deviations.chunks(2)).map(|(size, deviation)| wave(size, deviation, mean));
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

    /// Driven joints whose transmission error would fit as well in the place of effect number `position`, if that is a
    /// stiffness that varies. `without` is the fit without this effect.
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

    /// Joints whose stiffness, if it varied, would fit as well as the transmission error of the driven joint `joint`.
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

/// Amplitude and phase, with their 95 % intervals, of a compliance that varies by `size` (coefficients of sine and cosine) about
/// the mean `mean`, both in rad/(N m).
fn wave(size: &[f64], deviation: &[f64], mean: f64) -> [Estimate; 2] {
    let [sin, cos] = [size[0], size[1]];
    let length = libm::hypot(sin, cos);
    // the deviation along the wave, and that across it
    let along = libm::hypot(sin * deviation[0], cos * deviation[1]) / length;
    let across = libm::hypot(cos * deviation[0], sin * deviation[1]) / length;
    let phase = libm::atan2(cos, sin);
    let turn = Z_95 * across / length;
    let end = |x: f64| Some(x).filter(|_| turn < PI);
    [
        Estimate {
            value: length / mean,
            low: Some(((length - Z_95 * along) / mean).max(0.0)).filter(|x| x.is_finite()),
            high: Some((length + Z_95 * along) / mean).filter(|x| x.is_finite()),
        },
        Estimate { value: phase, low: end(phase - turn), high: end(phase + turn) },
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

    #[test]
    fn amplitude_and_phase_are_those_of_the_law() {
        // 2e-6 (0.3 sin(q + 0.8)) has the coefficients of sin q and cos q below
        let (mean, size, phase): (f64, f64, f64) = (2e-6, 0.3, 0.8);
        let sizes = [mean * size * phase.cos(), mean * size * phase.sin()];
        let [found, turned] = wave(&sizes, &[1e-8, 1e-8], mean);
        assert!((found.value - size).abs() < 1e-12 && (turned.value - phase).abs() < 1e-12);
        // equal deviations of both coefficients are a circle about the wave
        assert!((found.high.expect("bounded") - size - Z_95 * 1e-8 / mean).abs() < 1e-12);
        assert!((turned.high.expect("bounded") - phase - Z_95 * 1e-8 / (mean * size)).abs() < 1e-12);
        let stated = as_parameters(Waves::Twice, &sizes, mean);
        assert_eq!((stated[0].0.as_str(), stated[1].1[0]), ("twice", 0.0));
        assert!((stated[0].1[0] - size).abs() < 1e-12 && (stated[1].1[1] - phase).abs() < 1e-12);
    }
}
