//! What a fitted model states: its effects, its laws without a name and its calibrated factors, each with 95 %
//! intervals.

use super::outcome::{Calibrated, Law};
use crate::arm::effect::empirical::KIND;
use crate::reconcile::fit::descent::Fit;
use crate::reconcile::fit::interval::deviations;
use crate::reconcile::model::estimate::{Estimate, Finding, Interval, Z_95};
use crate::reconcile::model::fitted_parameters::fitted_parameters;
use crate::reconcile::select::empirical;

/// The effects of the model `fit` with their parameters. `ends` has the 95 % intervals of all parameters of
/// effects, in the order of the model. `competitors` has one list for each effect: names and places of the
/// effects that could replace it.
pub(crate) fn effects(fit: &Fit, ends: &[Interval], competitors: &[Vec<(String, String)>]) -> Vec<Finding> {
    let mut parameter = 0;
    let effects = fit.model.effects.iter().enumerate();
    effects
        .map(|(i, effect)| {
            let first = fit.model.first_parameter(i);
            let own = first..first + effect.free_parameters.len();
            let finding = Finding {
                effect: effect.kind.name.into(),
                at: effect.at.clone(),
                parameters: fitted_parameters(effect, &fit.point.u[own], &ends[parameter..]),
                indistinguishable_from: competitors.get(i).cloned().unwrap_or_default(),
            };
            parameter += effect.free_parameters.len();
            finding
        })
        .collect()
}

/// The laws without a name among the effects of the model `fit`, with their parameters. `findings` has one entry
/// for each effect of the model.
pub(crate) fn laws(fit: &Fit, findings: &[Finding]) -> Vec<Law> {
    let each = fit.model.effects.iter().zip(findings);
    each.filter(|(effect, _)| effect.kind.name == KIND.name)
        .map(|(effect, finding)| Law {
            finding: finding.clone(),
            law: empirical::in_words(effect),
            may_be: empirical::may_be(effect),
        })
        .collect()
}

/// For each calibrated factor, in the order of [`calibrated`], the standard deviation of its logarithm that follows
/// from the tolerance.
pub(crate) fn tolerances<'f>(fit: &'f Fit<'f>) -> impl Iterator<Item = f64> + 'f {
    fit.model.nuisance.numbers.iter().map(|(_, sd)| *sd)
}

/// The calibrated factors of the model `fit` on nominal values, with 95 % intervals. `learnt` is the standard deviation
/// that the readings leave, as a fraction of that of the tolerance.
pub(crate) fn calibrated(fit: &Fit) -> Vec<Calibrated> {
    let sds = deviations(fit);
    let numbers = fit.model.nuisance.numbers.iter().enumerate();
    numbers
        .map(|(i, (calibration, _))| {
            let factor = |u: f64| fit.model.nuisance.factor(i, u);
            let (u, sd) = (fit.point.u[i], sds[i].min(1.0));
            Calibrated {
                name: calibration.name(),
                factor: Estimate {
                    value: factor(u),
                    low: Some(factor(u - Z_95 * sd)),
                    high: Some(factor(u + Z_95 * sd)),
                },
                learnt: sd,
            }
        })
        .collect()
}
