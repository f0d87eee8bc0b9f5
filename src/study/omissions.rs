//! Omissions: physics and checks that the results of a study do not include. They are printed with the results.

use super::connections::connection_share;
use super::fit::joints_that_ask;
use super::harness::has_harness;
use crate::arm::bearing::BearingSource;
use crate::arm::effect::base_compliance::KIND as BASE;
use crate::arm::effect::connection_compliance::KIND as CONNECTION;
use crate::arm::extras::ExtrasSource;
use crate::arm::transmission::Stages;
use crate::catalog::Catalogs;
use crate::catalog::gear::{Gear, GearKind};
use crate::catalog::lookup::first_names;
use crate::space::design_space::{DesignSpace, DriveChoice, SpaceJoint, SpacePiece};

/// Sentences on the physics and the checks that the results of a study do not include.
pub(super) fn omissions(space: &DesignSpace) -> Vec<String> {
    let with_gear: Vec<&SpaceJoint> = joints(space).filter(|joint| has_gear(joint)).collect();
    if with_gear.is_empty() && !has_sized_rail(space) {
        return vec![left_out_without_gears(space)];
    }
    let named = |wanted: fn(&SpaceJoint) -> bool| {
        let names: Vec<&str> =
            with_gear.iter().filter(|joint| wanted(joint)).map(|joint| joint.name.as_str()).collect();
        (!names.is_empty()).then(|| names.join(", "))
    };
    let rigid = named(|joint| joint.bearing == BearingSource::Stated(None)).map(|names| {
        format!(
            "Rigid output bearing without mass in {names}: the study states none there, so that no bearing tilts, \
             is checked or is weighed."
        )
    });
    let bare = named(|joint| joint.drive.is_sized() && joint.extras == ExtrasSource::NONE).map(|names| {
        format!(
            "Nothing is weighed beyond gear, motor and bearing in {names}: the study states no extras there."
        )
    });
    let bare_given = named(|joint| !joint.drive.is_sized() && joint.extras == ExtrasSource::NONE).map(|names| {
        format!(
            "Nothing is weighed beyond the drive that is given and its bearing in {names}: the extras of a study are those of \
             its sized joints, and a joint with a given drive has what it states itself (\"extras\")."
        )
    });
    let heat = (!space.motion.checks_motor_heat && with_gear.iter().any(|joint| joint.drive.is_sized()))
        .then(|| {
            "Motor heat not checked: the study turns it off (check_motor_heat in its motion).".to_string()
        });
    [rigid, bare, bare_given, heat, Some(left_out_everywhere(space))].into_iter().flatten().collect()
}

/// Columns of the ratings of actuators that decide whether an actuator meets a demand and how far the arm deflects.
const OF_ACTUATORS: [&str; 2] = ["rated_torque_nm", "tilting_stiffness_nm_per_rad"];
/// Number of actuators that the remark on their ratings names.
const ACTUATORS_NAMED: usize = 3;

/// A sentence that names the actuators that the joints may have and whose ratings in [`OF_ACTUATORS`] were not all read
/// in a document; `None` if there are none.
pub(super) fn actuators_remark(space: &DesignSpace, catalogs: &Catalogs) -> Option<String> {
    let is_unseen = |gear: &Gear| OF_ACTUATORS.iter().any(|column| gear.provenance.is_unverified(column));
    let actuators = catalogs.gears.iter().filter(|gear| gear.kind == GearKind::Actuator);
    let names: Vec<&str> = actuators
        .filter(|gear| may_have(space, gear) && is_unseen(gear))
        .map(|gear| gear.id.as_str())
        .collect();
    (!names.is_empty()).then(|| {
        format!(
            "The rated torque or the tilting stiffness of {} is not the vendor's figure for this use: motor heat and \
             deflection may be worse. Their notes say why (armwright catalog show --part NAME).",
            first_names(&names, ACTUATORS_NAMED)
        )
    })
}

/// A sentence on the life of gears with roller bearings; `None` if no joint may have one whose life is checked.
///
/// The mean torque is the cubic mean for every gear. Full torque for half of the time, or for a tenth of it, has a mean
/// with the power 10/3 that is higher by 2 % or 8 %.
pub(super) fn roller_life_remark(space: &DesignSpace, catalogs: &Catalogs) -> Option<String> {
    let has_rollers = |gear: &&Gear| {
        gear.life.exponent != GearKind::StrainWave.usual_life_exponent() && gear.life.rated_h.is_some()
    };
    catalogs.gears.iter().filter(has_rollers).any(|gear| may_have(space, gear)).then(|| {
        "The mean torque is the cubic mean. For gears with roller bearings (cycloidal, planetary, spur) some makers take the \
         power 10/3, and their lives are then shorter: by 23 % where full torque acts a tenth of the time (docs/sizing.md)."
            .to_string()
    })
}

/// Whether a joint of the study has a gear or may get it.
fn may_have(space: &DesignSpace, gear: &Gear) -> bool {
    joints(space).any(|joint| match &joint.drive {
        DriveChoice::Given { gear: name, .. } => name.as_ref() == Some(&gear.id),
        open => open.filter().is_some_and(|filter| filter.allows_gear(gear)),
    })
}

/// A sentence on given drives that are not checked because the study does not name both gear and motor; `None` if there
/// are none. An actuator has both.
pub(super) fn unchecked_remark(space: &DesignSpace, catalogs: &Catalogs) -> Option<String> {
    let names_gear = |drive: &DriveChoice| matches!(drive, DriveChoice::Given { gear: Some(_), .. });
    let is_unchecked =
        |joint: &&SpaceJoint| names_gear(&joint.drive) && joint.drive.named_parts(catalogs).is_none();
    let names: Vec<&str> = joints(space).filter(is_unchecked).map(|joint| joint.name.as_str()).collect();
    (!names.is_empty()).then(|| {
        format!(
            "The drive of {} is not checked: the study names its gear and not its motor (\"motor\", a part of the catalogs).",
            names.join(", ")
        )
    })
}

/// Physics and checks that no number of a study includes in which no joint has a gear and no rail is sized, as a sentence.
/// Stiffness and mass of its joints are stated.
fn left_out_without_gears(space: &DesignSpace) -> String {
    let has_joints = joints(space).next().is_some();
    let of_joints = |words: &str| has_joints.then(|| words.to_string());
    let connected = except(&places_of(space, CONNECTION.name));
    let list = [
        has_joints.then(|| {
            format!(
                "what the stated stiffness of a joint does not contain, such as its connections{connected} and (where no \
                 bearing is stated) its tilt"
            )
        }),
        of_joints("the strength and the heat of the drives"),
        (!has_harness(space)).then(|| "the cables along the links".into()),
        Some("end plates and castings at the ends of tubes".into()),
        of_joints("the friction of the joints"),
        has_stages(space).then(|| "the pull and the strength of belts and stages".into()),
        guide_words(space).map(String::from),
        places_of(space, BASE.name).is_empty().then(|| "the floor".into()),
        Some("whether the parts fit into each other".into()),
    ];
    let words = list.into_iter().flatten().collect::<Vec<_>>().join(", ");
    format!(
        "Left out of every number: {words}, and temperature. How much some of these may be: docs/left-out.md."
    )
}

/// Words that exclude the places at which the study states an effect; empty if it states it nowhere.
fn except(places: &[&str]) -> String {
    match places {
        [] => String::new(),
        places => format!(" (except at {}, where the study states it)", places.join(", ")),
    }
}

/// Whether some joint has a stage before or behind its gear.
fn has_stages(space: &DesignSpace) -> bool {
    joints(space).any(|joint| joint.stages != Stages::default())
}

/// Physics that no number of a study with gears or a sized rail includes, such as temperature, as a sentence.
fn left_out_everywhere(space: &DesignSpace) -> String {
    let fits = joints_that_ask(space).next().is_some();
    let rigid = connection_share(space) == 0.0;
    let connected = places_of(space, CONNECTION.name);
    let tilts = places_of(space, BASE.name);
    let words_of = |words: &str| Some(words.to_string());
    let list = [
        rigid.then(|| {
            format!("the compliance of the connections between links and joints{}", except(&connected))
        }),
        (!has_harness(space)).then(|| "the cables along the links".into()),
        words_of("end plates and castings between gears and tubes"),
        words_of("the scatter and the friction of gears"),
        has_stages(space).then(|| "the pull and the strength of belts and stages".into()),
        has_sized_rail(space).then(|| "the friction of guides".into()),
        guide_words(space).map(String::from),
        tilts.is_empty().then(|| "the floor".into()),
        (!fits).then(|| "whether the parts fit into each other".into()),
    ];
    let words = list.into_iter().flatten().collect::<Vec<_>>().join(", ");
    let stated = !rigid || has_harness(space) || !connected.is_empty() || !tilts.is_empty();
    let size = if stated { SIZES_ONE_BY_ONE } else { SIZE_OF_ALL_TOGETHER };
    format!("Left out of every number: {words}, and temperature. {size}")
}

/// The places where the study states the effect of this name.
fn places_of<'a>(space: &'a DesignSpace, effect: &str) -> Vec<&'a str> {
    space.effects.iter().filter(|e| e.effect == effect).map(|e| e.at.as_str()).collect()
}

/// The properties of guides that no number of the study includes, in words; `None` if no joint slides. If the study
/// states all limits of all guides, strength is not among these properties.
fn guide_words(space: &DesignSpace) -> Option<&'static str> {
    let guide = |piece: &SpacePiece| match piece {
        SpacePiece::Prismatic(rail) => Some(rail.joint.guide.limits.unknown().is_empty()),
        _ => None,
    };
    let are_all_known = space.pieces.iter().filter_map(guide).reduce(|all, known| all && known)?;
    Some(if are_all_known { "the life of guides" } else { "the strength and life of guides" })
}

/// Whether a screw or rack and its motor are chosen for some prismatic joint.
fn has_sized_rail(space: &DesignSpace) -> bool {
    space.pieces.iter().any(|piece| matches!(piece, SpacePiece::Prismatic(rail) if rail.drive.is_some()))
}

/// A sentence that states by how much a built arm may differ from the computed one because of all omissions together.
/// Its numbers are those of the row "together" of docs/left-out.md.
const SIZE_OF_ALL_TOGETHER: &str = "How much this may be: on the knees of two named studies, the starred rows of docs/left-out.md \
    together add 77 to 79 % to the deflection and 40 to 47 % to the mass, and take 18 to 22 % from the lowest mode. They \
    are gears and bearings 20 % softer, connections, a compliant floor, drives 1.5 times as heavy (31 to 34 % of the mass), \
    end plates, cables and moduli 3 % low; friction, castings, fit and temperature are not among them.";

/// The sentence that replaces [`SIZE_OF_ALL_TOGETHER`] in a study that states connections or cables. The numbers in
/// that sentence include both, so they do not hold for such a study.
const SIZES_ONE_BY_ONE: &str = "How much each of these may be: docs/left-out.md.";

fn joints(space: &DesignSpace) -> impl Iterator<Item = &SpaceJoint> {
    space.pieces.iter().filter_map(|piece| match piece {
        SpacePiece::Joint(joint) => Some(joint),
        _ => None,
    })
}

fn has_gear(joint: &SpaceJoint) -> bool {
    !matches!(joint.drive, DriveChoice::Given { gear: None, .. })
}
