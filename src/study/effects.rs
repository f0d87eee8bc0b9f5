//! The effects of a study: checks that they are possible in its arm, and applies the corrections of a measured arm.
//!
//! A study asks which arm to build; a campaign measured an arm that was built. The effects found in the measured arm
//! are expected in the next arm too, at the joints and links of the same name. Calibrated values within tolerance
//! belong to the individual parts that were measured. They apply only where the study gives the same part, which is a
//! joint with a given drive. A drive or a tube that the study chooses is another part and keeps its catalog ratings.

use super::definition::Study;
use crate::arm::effect::entry::Effect;
use crate::arm::effect::kind::Removes;
use crate::arm::effect::validate::EffectFault;
use crate::arm::joint_law::Curve;
use crate::arm::{Arm, LinkModel};
use crate::input::json::Object;
use crate::report::number::significant;
use crate::space::design_space::DesignSpace;
use crate::space::design_space::{DriveChoice, SpaceJoint, SpacePiece};
use serde_json::{Value, json};

/// One correction of a measured arm, and whether it applies to a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Correction {
    /// Name of the correction, such as `bearing_tilt at j3` or `j2.stiffness x 1.02`.
    pub what: String,
    /// Whether the correction applies to the study.
    pub applied: bool,
    /// The change that the correction makes, or the reason why it does not apply.
    pub words: String,
}

/// A study to which corrections of a measured arm were applied.
#[derive(Debug, Clone, PartialEq)]
pub struct CorrectedStudy {
    /// The file of the study with the corrections written into it. It can be read like any other study.
    pub file: Value,
    /// Every correction, applied or not.
    pub corrections: Vec<Correction>,
}

/// The effects that every design of the study has, in a sentence; `None` if there are none. Effects of a test do not
/// change the arm and are left out.
pub(super) fn effects_remark(space: &DesignSpace) -> Option<String> {
    let of_arm = space.effects.iter().filter(|effect| !effect.is_of_test());
    let words: Vec<String> = of_arm.map(in_words).collect();
    (!words.is_empty())
        .then(|| format!("In every number: the effects that the study states, {}.", words.join("; ")))
}

/// An effect with its numbers: `connection_compliance at elbow (stiffness_nm_per_rad 58070)`.
fn in_words(effect: &Effect) -> String {
    let numbers = |list: &[f64]| list.iter().map(|x| significant(*x, 4)).collect::<Vec<_>>().join(", ");
    let parameters = effect.parameters.iter().map(|(name, list)| format!("{name} {}", numbers(list)));
    format!("{} ({})", effect.label(), parameters.collect::<Vec<_>>().join("; "))
}

/// Records a fault for each effect that is not possible in the study. Returns `None` after recording a fault.
pub(super) fn check_effects(space: &DesignSpace, root: &Object) -> Option<()> {
    let Some(node) = root.optional("effects") else { return Some(()) };
    let mut sound = true;
    for (effect, node) in space.effects.iter().zip(node.array()?) {
        if let Some(EffectFault { field, problem, hint }) = unfit(space, effect) {
            sound = false;
            node.fault_below::<()>(&field, problem, &hint);
        }
    }
    sound.then_some(())
}

/// The reason why an effect is not possible in the arm of a study; `None` if it is possible.
fn unfit(space: &DesignSpace, effect: &Effect) -> Option<EffectFault> {
    if let Some(fault) = effect.faults(&space.nominal_structure()).into_iter().next() {
        return Some(fault);
    }
    let at_joint = space.pieces.iter().find_map(|piece| match piece {
        SpacePiece::Joint(joint) if joint.name == effect.at => Some(joint),
        _ => None,
    });
    let traits = &effect.kind()?.traits;
    match at_joint.map(|joint| &joint.drive) {
        Some(DriveChoice::FirstFit(_) | DriveChoice::AllFits(_)) if traits.is_gear_curve => {
            Some(EffectFault {
                field: "effect".into(),
                problem: format!(
                    "soft_windup is the torsion curve of one drive, and the study chooses the drive of {} from the \
                 catalogs, each with a curve of its own",
                    effect.at
                ),
                hint:
                    "give the joint its drive in the study (gear and motor, or windup), or remove the effect"
                        .into(),
            })
        }
        Some(DriveChoice::Given { mass_kg, .. })
            if traits.removes == Some(Removes::JointMass) && takes_too_much(space, effect, *mass_kg) =>
        {
            Some(EffectFault {
                field: "parameters.delta_kg".into(),
                problem: format!("takes more off {} than the {mass_kg} kg it weighs", effect.at),
                hint: "give the joint its mass_kg, or a smaller loss".into(),
            })
        }
        _ if effect.is_of_bending() && space.links == LinkModel::Rigid => Some(EffectFault {
            field: "effect".into(),
            problem: format!(
                "{} changes how a link bends, and the study holds its links rigid",
                effect.effect
            ),
            hint: "set \"links\" of \"models\" to \"full\", or remove the effect".into(),
        }),
        _ => None,
    }
}

/// Whether `effect`, a negative extra mass, removes more than there is: together with all other extra masses at the
/// same place it exceeds `mass_kg`, the mass at this place.
fn takes_too_much(space: &DesignSpace, effect: &Effect, mass_kg: f64) -> bool {
    let added_kg = |effects: Vec<Effect>| DesignSpace { effects, ..space.clone() }.effects_mass_kg();
    let of_place = |other: &&Effect| other.effect == effect.effect && other.at == effect.at;
    added_kg(vec![effect.clone()]) < 0.0
        && mass_kg + added_kg(space.effects.iter().filter(of_place).cloned().collect()) < 0.0
}

/// The effects that the study itself has and that describe a test, as corrections that are not applied. They have no
/// influence on its results.
pub fn left_out(study: &Study) -> Vec<Correction> {
    let of_test = study.space.effects.iter().filter(|effect| effect.is_of_test());
    of_test.map(|effect| Correction { what: effect.label(), applied: false, words: OF_TEST.into() }).collect()
}

/// The corrections as JSON: what each one is, whether it was applied, and why. Files have this list under the key
/// `carried_over`.
pub fn corrections_json(corrections: &[Correction]) -> Value {
    corrections.iter().map(|c| json!({"what": c.what, "carried": c.applied, "words": c.words})).collect()
}

const OF_TEST: &str = "it describes how the arm was tested, not the arm";

const CHOSEN_DRIVE: &str = "the study chooses this joint's drive: it keeps its catalog ratings";

/// Applies the corrections of a measured arm to the file of a study. They are the effects of `arm`, and the factors in
/// `calibrated`, such as `("j2.stiffness", 1.02)`.
pub fn apply_corrections(
    file: &Value,
    study: &Study,
    arm: &Arm,
    calibrated: &[(String, f64)],
) -> CorrectedStudy {
    let mut out = CorrectedStudy { file: file.clone(), corrections: Vec::new() };
    arm.effects.iter().for_each(|effect| out.effect(&study.space, effect));
    calibrated.iter().for_each(|(name, factor)| out.calibration(&study.space, name, *factor));
    out
}

impl CorrectedStudy {
    /// Notes a correction that is applied. `words` says what it changes.
    fn applies(&mut self, what: String, words: impl Into<String>) {
        self.corrections.push(Correction { what, applied: true, words: words.into() });
    }

    /// Notes a correction that is not applied. `words` says why.
    fn leaves_out(&mut self, what: String, words: impl Into<String>) {
        self.corrections.push(Correction { what, applied: false, words: words.into() });
    }

    fn effect(&mut self, space: &DesignSpace, effect: &Effect) {
        let what = effect.label();
        if effect.is_of_test() {
            return self.leaves_out(what, OF_TEST);
        }
        if let Some(EffectFault { problem, hint, .. }) = unfit(space, effect) {
            return self.leaves_out(what, format!("{problem}; {hint}"));
        }
        match &mut self.file["effects"] {
            Value::Array(list) => list.push(effect.to_json()),
            none => *none = json!([effect.to_json()]),
        }
        self.applies(what, parameters(effect));
    }

    fn calibration(&mut self, space: &DesignSpace, name: &str, factor: f64) {
        let what = format!("{name} x {factor:.4}");
        let (part, quantity) = name.rsplit_once('.').unwrap_or((name, ""));
        if !matches!(quantity, "stiffness" | "mass" | "bearing_stiffness" | "guide_stiffness") {
            let words =
                "it belongs to the measured arm; the study keeps its geometry and the catalog's materials";
            return self.leaves_out(what, words);
        }
        let found = space.pieces.iter().enumerate().find_map(|(index, piece)| match piece {
            SpacePiece::Joint(joint) if joint.name == part => Some((index, joint)),
            _ => None,
        });
        let slides = |piece: &SpacePiece| matches!(piece, SpacePiece::Prismatic(s) if s.joint.name == part);
        if let Some(index) = space.pieces.iter().position(slides) {
            return self.calibrate_prismatic(&space.pieces[index], index, quantity, factor, what);
        }
        match found {
            None => self.leaves_out(what, format!("the study has no joint {part}")),
            Some((_, SpaceJoint { drive: DriveChoice::FirstFit(_) | DriveChoice::AllFits(_), .. })) => {
                self.leaves_out(what, CHOSEN_DRIVE);
            }
            Some((index, SpaceJoint { drive: DriveChoice::Given { curve, mass_kg, .. }, bearing, .. })) => {
                let entry = &mut self.file["chain"][index];
                match (quantity, bearing.stated()) {
                    ("stiffness", _) => write_curve(entry, &curve.stiffened(factor)),
                    ("mass", _) => entry["mass_kg"] = json!(mass_kg * factor),
                    (_, Some(bearing)) => entry["bearing"] = bearing.stiffened(factor).to_json(),
                    _ => return self.leaves_out(what, "the bearing of this joint is rigid in the study"),
                }
                self.applies(what, "the study gives this joint's drive: its value is calibrated");
            }
        }
    }
}

impl CorrectedStudy {
    /// Writes the calibrated value of a prismatic joint, which is its number in the study times `factor`, into the
    /// file. `index` is the place of the joint in the chain; `quantity` names the number; `what` is the label of the
    /// correction.
    fn calibrate_prismatic(
        &mut self,
        piece: &SpacePiece,
        index: usize,
        quantity: &str,
        factor: f64,
        what: String,
    ) {
        let SpacePiece::Prismatic(slide) = piece else { return };
        let mut joint = slide.joint.clone();
        // the measured stiffness and mass are those of the drive that was built
        if slide.drive.is_some() && quantity != "guide_stiffness" {
            return self.leaves_out(what, CHOSEN_DRIVE);
        }
        let key = match quantity {
            "stiffness" => {
                let Some(stiffness) = joint.stiffness_n_per_m else {
                    return self.leaves_out(what, "the drive of this joint is rigid in the study");
                };
                joint.stiffness_n_per_m = Some(stiffness * factor);
                "stiffness_n_per_m"
            }
            "mass" => {
                joint.mass_kg *= factor;
                "mass_kg"
            }
            _ => {
                joint.guide = joint.guide.stiffened(factor);
                "guide"
            }
        };
        self.file["chain"][index][key] = joint.to_json()[key].take();
        self.applies(what, "the study gives this joint: its value is calibrated");
    }
}

/// The parameters of an effect in words, such as `stiffness_nm_per_rad = 200000`.
fn parameters(effect: &Effect) -> String {
    let numbers = |list: &[f64]| list.iter().map(|x| significant(*x, 4)).collect::<Vec<_>>();
    let each = effect.parameters.iter().map(|(name, list)| format!("{name} = {}", numbers(list).join(", ")));
    each.collect::<Vec<_>>().join("; ")
}

/// Writes the torsion curve `curve` into `entry`, the entry of a joint in a study file, in place of the stiffness
/// there.
fn write_curve(entry: &mut Value, curve: &Curve) {
    if let Some(entry) = entry.as_object_mut() {
        entry.shift_remove("stiffness_nm_per_rad");
        entry.shift_remove("windup");
    }
    let (key, value) = curve.to_json();
    entry[key] = value;
}
