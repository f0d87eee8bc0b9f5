//! A stiffness, modulus or mass on which the deflection of the nominal arm depends.

use crate::arm::effect::kind::{Kind, Parameter, Scale};
use crate::arm::effect::subject::Subject;
use crate::arm::effect::{extra_mass, harness_mass, modulus_error};
use crate::arm::{Arm, JointModel};
use crate::reconcile::model::calibration::{Calibration, Nuisance};
use crate::reconcile::readings::campaign::Campaign;

/// The effects that change the nominal deflection.
const EFFECTS: [&Kind; 3] = [&extra_mass::KIND, &harness_mass::KIND, &modulus_error::KIND];
/// Smallest factor on a compliance or a mass that calibration can ask for.
const LEAST: f64 = 0.02;

/// Something on which the nominal deflection depends, described by one number that is 0 for the nominal arm.
#[derive(Clone)]
pub(crate) enum Dependence {
    /// A factor on a property of the arm, and the standard deviation of its logarithm that follows from the tolerance.
    /// The number is the relative increase of a mass, or the relative decrease of a compliance, in these standard
    /// deviations. For small changes it is also the change of the logarithm.
    Tolerance(Calibration, f64),
    /// An effect with one parameter, and its place. The number is the parameter, or its reciprocal less 1 if the
    /// parameter is a factor.
    Effect(&'static Kind, String),
}

impl Dependence {
    /// Changes an arm by the number `x`.
    pub(super) fn change(&self, x: f64, subject: &mut Subject) {
        match self {
            Self::Tolerance(calibration, sd) => {
                Nuisance { numbers: vec![(calibration.clone(), *sd)] }.apply(&[x], subject);
            }
            Self::Effect(kind, at) => (kind.apply)(&[self.value(x)], at, subject),
        }
    }

    /// The factor, or the parameter of the effect, for the number `x`.
    pub(crate) fn value(&self, x: f64) -> f64 {
        match self {
            // the deflection is linear in the number, so the number is proportional to the change of a compliance or a
            // mass
            Self::Tolerance(Calibration::Mass(_), sd) => (1.0 + sd * x).max(LEAST),
            Self::Tolerance(_, sd) => 1.0 / (1.0 - sd * x).max(LEAST),
            Self::Effect(kind, _) if parameter(kind).scale == Scale::Reciprocal => 1.0 / (1.0 + x),
            Self::Effect(..) => x,
        }
    }

    /// Whether the parameter of the effect can have the value for the number `x`.
    pub(super) fn is_possible(&self, x: f64) -> bool {
        match self {
            Self::Tolerance(..) => true,
            Self::Effect(kind, _) => parameter(kind).allows(self.value(x)),
        }
    }

    /// Name of the factor or effect in result files.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::Tolerance(calibration, _) => calibration.name(),
            Self::Effect(kind, at) => format!("{}@{at}", kind.name),
        }
    }

    /// Name of the effect and its place; `None` for a factor within tolerance.
    pub(crate) fn effect(&self) -> Option<(&'static Kind, &str)> {
        match self {
            Self::Tolerance(..) => None,
            Self::Effect(kind, at) => Some((kind, at)),
        }
    }
}

/// The only parameter of an effect.
pub(crate) fn parameter(kind: &Kind) -> &'static Parameter {
    &(kind.parameters)(kind.places[0])[0]
}

/// Everything on which the nominal deflection of the campaign's arms may depend.
pub(super) fn dependences(campaign: &Campaign) -> Vec<Dependence> {
    let mut out: Vec<Dependence> = Vec::new();
    for arm in campaign.arms() {
        for (calibration, sd) in Nuisance::new(arm, &campaign.statement.tolerance).numbers {
            add_tolerance(&mut out, calibration, sd);
        }
        for kind in EFFECTS.iter().filter(|kind| campaign.statement.considers(kind.name)) {
            for at in places(arm, kind) {
                // the trunk belongs to every arm
                let is_known =
                    out.iter().filter_map(Dependence::effect).any(|(k, a)| k.name == kind.name && a == at);
                if !is_known {
                    out.push(Dependence::Effect(kind, at));
                }
            }
        }
    }
    out
}

/// Adds a factor within tolerance to the list. If the list already has the factor, because arms share a part or a
/// material, the links of the material are added to its links.
fn add_tolerance(list: &mut Vec<Dependence>, calibration: Calibration, sd: f64) {
    let known = list.iter_mut().find_map(|one| match one {
        Dependence::Tolerance(known, _) if known.name() == calibration.name() => Some(known),
        _ => None,
    });
    match (known, calibration) {
        (Some(Calibration::Modulus(_, links)), Calibration::Modulus(_, more)) => links.extend(more),
        (Some(_), _) => {}
        (None, calibration) => list.push(Dependence::Tolerance(calibration, sd)),
    }
}

fn places(arm: &Arm, kind: &Kind) -> Vec<String> {
    let structure = arm.structure(JointModel::ThreeSegment);
    kind.places.iter().flat_map(|place| structure.places(*place)).collect()
}
