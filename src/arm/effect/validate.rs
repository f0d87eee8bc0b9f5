//! Checks the effects of a file, and lists the effects that a calculation leaves out.

use super::catalogue::{KINDS, kind};
use super::empirical;
use super::entry::Effect;
use super::kind::{Kind, Needs, Parameter};
use super::subject::Subject;
use crate::arm::structure::{Piece, Structure};
use crate::arm::{Arm, JointModel};
use crate::input::json::closest;

/// One fault of an effect: the key, the problem, and the advice.
#[derive(Debug, Clone, PartialEq)]
pub struct EffectFault {
    /// The key at fault, relative to the effect: `effect`, `at` or `parameters.NAME`.
    pub field: String,
    /// Description of the fault, in words.
    pub problem: String,
    /// The allowed values, in words.
    pub hint: String,
}

impl Effect {
    /// All faults of the effect in the arm `structure`: an unknown name, a place where it cannot be, values out of
    /// their limits. Empty if there are none.
    pub fn faults(&self, structure: &Structure) -> Vec<EffectFault> {
        let Some(kind) = kind(&self.effect) else { return vec![self.unknown_kind()] };
        match structure.place(&self.at, kind.places) {
            None => vec![self.wrong_place(kind, structure)],
            Some(place) => {
                let mut faults = self.parameter_faults(kind, (kind.parameters)(place));
                faults.extend(self.zero_fault(structure));
                faults
            }
        }
    }

    /// The fault of an angle whose zero is off at a joint that other joints turn; `None` if there is none.
    fn zero_fault(&self, structure: &Structure) -> Option<EffectFault> {
        let is_zero = |name: &str| self.effect == empirical::KIND.name && name == empirical::ZERO;
        let (name, _) = self.parameters.iter().find(|(name, own)| is_zero(name) && *own != [0.0])?;
        let is_turned = structure.joints().any(|joint| joint.name == self.at && !joint.is_driven());
        is_turned.then(|| EffectFault {
            field: format!("parameters.{name}"),
            problem: format!("{} has no angle of its own: other joints turn it", self.at),
            hint: "give the zero of a joint that turns it".into(),
        })
    }

    fn unknown_kind(&self) -> EffectFault {
        let names: Vec<&str> = KINDS.iter().map(|k| k.name).collect();
        let hint = match closest(&self.effect, &names) {
            Some(name) => format!("did you mean \"{name}\"? known effects: {}", names.join(", ")),
            None => format!("known effects: {}", names.join(", ")),
        };
        EffectFault {
            field: "effect".into(),
            problem: format!("effect \"{}\" is not known", self.effect),
            hint,
        }
    }

    fn wrong_place(&self, kind: &Kind, structure: &Structure) -> EffectFault {
        let places: Vec<String> = kind.places.iter().flat_map(|p| structure.places(*p)).collect();
        EffectFault {
            field: "at".into(),
            problem: format!("{} cannot sit at \"{}\"", kind.name, self.at),
            hint: format!("its places in this arm: {}", places.join(", ")),
        }
    }

    fn parameter_faults(&self, kind: &Kind, parameters: &[Parameter]) -> Vec<EffectFault> {
        let mut faults = Vec::new();
        let names: Vec<&str> = parameters.iter().map(|p| p.name).collect();
        for (name, _) in self.parameters.iter().filter(|(n, _)| !names.contains(&n.as_str())) {
            faults.push(EffectFault {
                field: format!("parameters.{name}"),
                problem: "unknown parameter".into(),
                hint: format!("{} has: {}", self.effect, names.join(", ")),
            });
        }
        faults.extend(parameters.iter().filter_map(|p| self.parameter_fault(p)));
        if faults.is_empty()
            && let Some((problem, hint)) = (kind.traits.contradiction)(&self.numbers(parameters))
        {
            let field = "parameters".into();
            faults.push(EffectFault { field, problem: problem.into(), hint: hint.into() });
        }
        faults
    }

    fn parameter_fault(&self, parameter: &Parameter) -> Option<EffectFault> {
        let (problem, hint) = match self.parameters.iter().find(|(name, _)| name == parameter.name) {
            None if parameter.default.is_some() => return None,
            None => (format!("lacks \"{}\"", parameter.name), format!("add \"{}\": ...", parameter.name)),
            Some((_, numbers)) if parameter.count > 0 && numbers.len() != parameter.count => (
                format!("has {} numbers, not {}", numbers.len(), parameter.count),
                format!("give {}", parameter.count),
            ),
            Some((_, numbers)) if self.is_below_another(parameter, numbers[0]).is_some() => {
                let (name, least) = self.is_below_another(parameter, numbers[0])?;
                (format!("= {} is below {name} = {least}", numbers[0]), format!("give at least {name}"))
            }
            Some((_, numbers)) => {
                let outside = numbers.iter().find(|n| !parameter.allows(**n))?;
                let (low, high) = parameter.readable();
                (format!("= {outside} is out of bounds"), format!("give {low} to {high}"))
            }
        };
        Some(EffectFault { field: format!("parameters.{}", parameter.name), problem, hint })
    }

    /// Name and value of the parameter that is the lower limit of `parameter`, if `value` is below this limit.
    /// Otherwise `None`.
    fn is_below_another(&self, parameter: &Parameter, value: f64) -> Option<(&str, f64)> {
        let (name, numbers) =
            self.parameters.iter().find(|(name, _)| Some(name.as_str()) == parameter.not_below)?;
        numbers.first().filter(|least| value < **least).map(|least| (name.as_str(), *least))
    }
}

impl Arm {
    /// The effects of this arm that describe a test and not the product. `analyze` and studies leave them out.
    pub fn ignored_effects(&self) -> Vec<&Effect> {
        self.effects.iter().filter(|e| e.is_of_test()).collect()
    }

    /// The arm under test with all of its effects, including the effects of the payload and of the channels. If an
    /// effect brings a new torsion curve, this curve is simplified to the model `joints` in the same way as the curve
    /// of the arm itself.
    pub fn subject(&self, joints: JointModel) -> Subject {
        let mut subject = Subject::new(self.nominal_structure(joints));
        self.effects.iter().for_each(|effect| subject.apply(effect));
        for piece in &mut subject.structure.pieces {
            if let Piece::Joint(joint) = piece {
                joint.law.curve = joint.law.curve.reduced(joints);
            }
        }
        subject
    }
}

/// Whether an effect of this kind can be at the place `at` of this arm. `structure` is the arm without effects. An
/// effect that adds a missing compliance is possible only where the model is rigid, and an effect in series only where
/// there is compliance already.
pub fn fits_nominal(kind: &Kind, at: &str, structure: &Structure) -> bool {
    let rigid_joint = structure.joints().any(|j| j.name == at && j.law.is_rigid());
    let rigid_link = structure.links().any(|l| l.name == at && l.beam.is_some_and(|b| b.flexibility == 0.0));
    match kind.traits.needs {
        Needs::Nothing => true,
        Needs::RigidJoint => rigid_joint,
        Needs::TwistingJoint => !rigid_joint,
        Needs::DrivenTwist => !rigid_joint && structure.joints().any(|j| j.name == at && j.is_driven()),
        Needs::CurvedJoint => structure.joints().any(|j| j.name == at && j.is_driven() && j.law.is_curved()),
        Needs::RigidLink => rigid_link,
        // an effect of the whole arm needs at least one link that bends
        Needs::BendingLink if at == "arm" => {
            structure.links().any(|l| l.beam.is_some_and(|b| b.flexibility > 0.0))
        }
        Needs::BendingLink => !rigid_link,
    }
}

#[cfg(test)]
pub(crate) mod testing {
    use super::*;
    use crate::arm::file::read_arm_document;
    use crate::catalog::Catalogs;
    use crate::input::json::{Document, Faults};

    const CHAIN: &str = r#"{"name": "two",
      "materials": {"steel": {"youngs_modulus_pa": 2.1e11, "shear_modulus_pa": 8.1e10, "density_kg_m3": 7850}},
      "chain": [
       {"type": "joint", "name": "j1", "axis": [0,0,1], "stiffness_nm_per_rad": 1e5, "mass_kg": 5},
       {"type": "link", "name": "upper", "vector_m": [0.5,0,0], "material": "steel",
        "section": {"shape": "rectangular_tube", "width_m": 0.1, "height_m": 0.1, "wall_m": 0.005}},
       {"type": "joint", "name": "j2", "axis": [0,1,0], "stiffness_nm_per_rad": 5e4, "mass_kg": 3},
       {"type": "link", "name": "forearm", "vector_m": [0.5,0,0], "material": "steel",
        "section": {"shape": "rectangular_tube", "width_m": 0.1, "height_m": 0.1, "wall_m": 0.005}}],
      "effects": EFFECTS}"#;

    pub(crate) fn read_with(effects: &str) -> Result<Arm, Faults> {
        let text = CHAIN.replace("EFFECTS", effects);
        read_arm_document(Document::parse("arm.json", &text)?, &Catalogs::default())
    }

    pub(crate) fn two_link_subject() -> Subject {
        read_with("[]").expect("sound arm").subject(JointModel::ThreeSegment)
    }
}

#[cfg(test)]
mod tests {
    use super::testing::read_with;
    use super::*;

    #[test]
    fn a_sound_effect_changes_the_structure() {
        let arm = read_with(
            r#"[{"effect": "bearing_tilt", "at": "j2", "parameters": {"stiffness_nm_per_rad": 2e5}},
                {"effect": "sensor_gain", "at": "static", "parameters": {"gain": 1.1}}]"#,
        )
        .expect("sound arm");
        let mut structure = arm.structure(JointModel::ThreeSegment);
        assert_eq!(structure.joint_mut("j2").expect("j2").tilt_rad_per_nm, 1.0 / 2e5);
        assert_eq!(arm.ignored_effects().len(), 1);
        assert_eq!(arm.ignored_effects()[0].effect, "sensor_gain");
    }

    const CURVE: &str = r#"[{"effect": "soft_windup", "at": "j2", "parameters": {"k1_nm_per_rad": 1e4,
        "k2_nm_per_rad": 2e4, "k3_nm_per_rad": 3e4, "t1_nm": T1, "t2_nm": 30}}]"#;

    #[test]
    fn a_curve_that_an_effect_brings_is_reduced_to_its_middle_slope() {
        let arm = read_with(&CURVE.replace("T1", "10")).expect("sound arm");
        let curve = |model| arm.structure(model).joint_mut("j2").expect("j2").law.curve;
        assert_eq!(curve(JointModel::K2), crate::arm::joint_law::Curve::Linear(2e4));
        assert!(matches!(curve(JointModel::ThreeSegment), crate::arm::joint_law::Curve::Windup(_)));
    }

    #[test]
    fn break_points_in_the_wrong_order_are_a_fault_and_not_changed() {
        let faults = read_with(&CURVE.replace("T1", "40")).expect_err("a fault").0;
        assert_eq!(faults.len(), 1);
        assert_eq!(faults[0].field, "effects[0].parameters.t2_nm");
        assert!(faults[0].to_string().contains("= 30 is below t1_nm = 40"), "{}", faults[0]);
    }

    #[test]
    fn every_fault_of_the_effects_is_reported_at_once() {
        let faults = read_with(
            r#"[{"effect": "bearing_tlt", "at": "j2", "parameters": {}},
                {"effect": "bearing_tilt", "at": "upper", "parameters": {"stiffness_nm_per_rad": 2e5}},
                {"effect": "harness_mass", "at": "upper", "parameters": {"kg": 1}},
                {"effect": "lost_motion", "at": "j1", "parameters": {"half_width_rad": -1, "torque_nm": 5}}]"#,
        )
        .expect_err("faults")
        .0;
        let text: Vec<String> = faults.iter().map(|f| f.to_string()).collect();
        assert_eq!(faults.len(), 5, "{text:#?}");
        assert!(text[0].contains("did you mean \"bearing_tilt\""), "{}", text[0]);
        assert!(text[1].contains("its places in this arm: j1, j2"), "{}", text[1]);
        assert!(text[2].contains("unknown parameter") && text[3].contains("lacks \"kg_per_m\""));
        assert!(text[4].contains("-1 is out of bounds"), "{}", text[4]);
    }
}
