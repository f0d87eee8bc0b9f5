//! Reports what the calibration of positions adjusted: factors within tolerance, effects on the nominal deflection,
//! joint zeros that moved far, and joints that hardly turned.

use super::analysis::Positions;
use super::dependence::{Dependence, parameter};
use super::fitted::Fitted;
use super::kinematics::Number;
use crate::arm::Arm;
use crate::reconcile::model::estimate::{Estimate, Finding, Z_95};
use crate::reconcile::verdict::correct::calibrate;
use crate::reconcile::verdict::outcome::Calibrated;

/// A zero that moved by more than this many standard deviations of its prior is mentioned.
const FAR_SIGMAS: f64 = 3.0;
/// A joint whose angles in all poses differ by less than this hardly turns \[rad\].
const STILL_RAD: f64 = 0.09;

impl Positions {
    /// The factor, or the parameter of the effect, that the dependence `dependence` has in the fit, with its 95 %
    /// interval. `number` is the fitted number of this dependence. `None` if the model does not have this number.
    fn estimate(&self, fitted: &Fitted, number: &Number, dependence: &Dependence) -> Option<Estimate> {
        let at = self.numbers.iter().position(|n| n == number)?;
        let (x, sd) = (*fitted.moved.get(at)?, fitted.number_deviations[at]);
        let ends =
            [x - Z_95 * sd, x + Z_95 * sd].map(|end| Some(dependence.value(end)).filter(|e| e.is_finite()));
        // a parameter whose reciprocal is fitted falls as the fitted number rises
        let falls = dependence.value(1.0) < dependence.value(0.5);
        let [low, high] = if falls { [ends[1], ends[0]] } else { ends };
        Some(Estimate { value: dependence.value(x), low, high })
    }

    /// The calibrated factors within tolerance, with the values of the fit `fitted`.
    pub(super) fn adjusted(&self, fitted: &Fitted) -> Vec<Calibrated> {
        let of = |(k, dependence): (usize, &Dependence)| {
            let Dependence::Tolerance(calibration, _) = dependence else { return None };
            let number = Number::Tolerance(k);
            let at = self.numbers.iter().position(|n| *n == number)?;
            Some(Calibrated {
                name: calibration.name(),
                factor: self.estimate(fitted, &number, dependence)?,
                learnt: fitted.number_deviations[at].min(1.0),
            })
        };
        self.dependences.iter().enumerate().filter_map(of).collect()
    }

    /// For each factor of [`adjusted`](Self::adjusted), the standard deviation of its logarithm that follows from the
    /// tolerance.
    pub(super) fn tolerances(&self) -> impl Iterator<Item = f64> + '_ {
        self.dependences.iter().filter_map(|dependence| match dependence {
            Dependence::Tolerance(_, sd) => Some(*sd),
            Dependence::Effect(..) => None,
        })
    }

    /// Multiplies the properties of an arm by the calibrated factors of the fit `fitted`.
    pub(super) fn adjust(&self, fitted: &Fitted, arm: &mut Arm) {
        for (dependence, x) in self.dependences.iter().zip(&fitted.geometry.dependences) {
            if let Dependence::Tolerance(calibration, _) = dependence {
                calibrate(arm, calibration, dependence.value(*x));
            }
        }
    }

    /// The finding for the dependence with index `k`, which must be an effect on the nominal deflection.
    pub(super) fn dependence_finding(&self, k: usize) -> Finding {
        let dependence = &self.dependences[k];
        let (kind, at) = dependence.effect().expect("only effects are named");
        let estimate = self.estimate(&self.fitted, &Number::Effect(k), dependence);
        Finding {
            effect: kind.name.into(),
            at: at.into(),
            parameters: vec![(parameter(kind).name.into(), estimate.into_iter().collect())],
            indistinguishable_from: self.instead_of_dependence(k),
        }
    }

    /// A sentence on the joint zeros that calibration moved by more than [`FAR_SIGMAS`] standard deviations of their
    /// prior; `None` if there are none.
    pub(super) fn moved_zeros(&self) -> Option<String> {
        let numbers = self.numbers.iter().zip(&self.fitted.moved);
        let far = numbers.filter_map(|(number, moved)| match number {
            Number::Zero(j) if moved.abs() > FAR_SIGMAS * number.prior() => {
                Some(format!("that of {} by {:+.2} deg", self.tree.driven[*j], moved.to_degrees()))
            }
            _ => None,
        });
        let far: Vec<String> = far.collect();
        (!far.is_empty()).then(|| {
            format!(
                "calibration moves the zeros of joints further than zeros usually are off: {}; check the angles in the file",
                far.join(", ")
            )
        })
    }

    /// A sentence on the driven joints that hardly turn in all poses, so that their compliance can hide in the placement;
    /// `None` if there are none.
    pub(super) fn still_joints(&self) -> Option<String> {
        let range_rad = |j: usize| {
            let angles = self.samples.iter().filter_map(|s| Some(s.pose.turns().get(j)?.rad));
            let (low, high) =
                angles.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), a| (l.min(a), h.max(a)));
            high - low
        };
        let still = (0..self.tree.driven.len()).filter(|&j| range_rad(j) < STILL_RAD);
        let still: Vec<&str> = still.map(|j| self.tree.driven[j].as_str()).collect();
        (!still.is_empty()).then(|| {
            format!(
                "these joints hardly turn in any pose, so that the positions say little about them: {}",
                still.join(", ")
            )
        })
    }
}
