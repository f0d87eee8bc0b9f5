//! Builds the corrected arm: calibrated values replace nominal ones and effects are added, each with its source.

use super::outcome::{Calibrated, Verdict};
use crate::arm::effect::kind::Place;
use crate::arm::{Arm, Element, LinkBody};
use crate::reconcile::fit::descent::Fit;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::model::calibration::Calibration;
use crate::reconcile::model::estimate::Finding;
use crate::reconcile::readings::campaign::Campaign;
use serde_json::{Value, json};

/// The corrected arm, and the provenance of its values as JSON. The arm is calibrated as in `fit` and gets its
/// effects, each with its interval from `findings`. Without a fit the arm stays as it was given.
pub(crate) fn corrected(
    campaign: &Campaign,
    forward: &Forward,
    fit: Option<&Fit>,
    findings: &[Finding],
    calibrated: &[Calibrated],
    verdict: Verdict,
) -> (Arm, Value) {
    let mut arm = campaign.arm.clone();
    let mut values = Vec::new();
    if let Some(fit) = fit {
        for ((calibration, _), c) in fit.model.nuisance.numbers.iter().zip(calibrated) {
            calibrate(&mut arm, calibration, c.factor.value);
            values.push(json!({
                "value": c.name, "factor": c.factor.value, "low": c.factor.low, "high": c.factor.high,
                "source": "calibrated within tolerance",
            }));
        }
        add_effects(campaign, forward, fit, findings, &mut arm);
    }
    let provenance = provenance(campaign, verdict, values);
    (arm, provenance)
}

/// The provenance of a corrected arm as JSON: the campaign, the program, the verdict and the calibrated values.
pub(crate) fn provenance(campaign: &Campaign, verdict: Verdict, calibrated: Vec<Value>) -> Value {
    json!({
        "campaign": campaign.statement.name, "campaign_blake3": campaign.hash,
        "tool": format!("armwright {}", env!("CARGO_PKG_VERSION")),
        "verdict": verdict.word(), "calibrated": calibrated,
    })
}

fn add_effects(campaign: &Campaign, forward: &Forward, fit: &Fit, findings: &[Finding], arm: &mut Arm) {
    for (i, (candidate, finding)) in fit.model.effects.iter().zip(findings).enumerate() {
        let first = fit.model.first_parameter(i);
        let u = &fit.point.u[first..first + candidate.free_parameters.len()];
        // an infinite stiffness is no effect, and no arm file takes it
        if candidate.is_rigid(u) {
            continue;
        }
        let place = forward.nominal.structure.place(&candidate.at, candidate.kind.places);
        let mut effect = candidate.effect(u, place.unwrap_or(Place::Arm));
        let intervals: Vec<Value> = finding
            .parameters
            .iter()
            .map(|(name, list)| {
                json!({"parameter": name,
                       "low": list.iter().map(|e| e.low).collect::<Vec<_>>(),
                       "high": list.iter().map(|e| e.high).collect::<Vec<_>>()})
            })
            .collect();
        let source = json!({
            "campaign": campaign.statement.name, "campaign_blake3": campaign.hash, "interval_95": intervals,
        });
        effect.source = Some(source);
        arm.effects.push(effect);
    }
}

/// Multiplies a property of an arm by `factor`.
pub(crate) fn calibrate(arm: &mut Arm, calibration: &Calibration, factor: f64) {
    for element in &mut arm.chain {
        match (calibration, element) {
            (Calibration::Stiffness(name), Element::Joint(joint)) if joint.name == *name => {
                joint.curve = joint.curve.stiffened(factor);
            }
            (Calibration::Mass(name), Element::Joint(joint)) if joint.name == *name => {
                joint.mass_kg *= factor;
            }
            (Calibration::Bearing { joint: name, .. }, Element::Joint(joint)) if joint.name == *name => {
                joint.bearing = joint.bearing.map(|bearing| bearing.stiffened(factor));
            }
            (Calibration::Mass(name), Element::Prismatic(joint)) if joint.name == *name => {
                joint.mass_kg *= factor;
            }
            (Calibration::Drive { joint: name, .. }, Element::Prismatic(joint)) if joint.name == *name => {
                joint.stiffness_n_per_m = joint.stiffness_n_per_m.map(|k| k * factor);
            }
            (Calibration::Guide { joint: name, .. }, Element::Prismatic(joint)) if joint.name == *name => {
                joint.guide = joint.guide.stiffened(factor);
            }
            (Calibration::Modulus(name, _), Element::Link(link)) => {
                if let LinkBody::Tube { material_name, material, .. } = &mut link.body
                    && material_name == name
                {
                    material.youngs_modulus_pa *= factor;
                    material.shear_modulus_pa *= factor;
                }
            }
            _ => {}
        }
    }
}
