//! The limits of a study on the sizes of parts, and the remarks on them in results.

use super::keys::FIT;
use crate::catalog::Catalogs;
use crate::catalog::gear::GearMass;
use crate::catalog::motor::{Motor, MotorKind};
use crate::input::json::{Node, Object};
use crate::report::number::significant;
use crate::sizing::fit::{FitRequirement, MotorPlace};
use crate::sizing::select::DriveFilter;
use crate::space::design_space::{DesignSpace, DriveChoice, SpaceJoint, SpacePiece};
use crate::space::fit::{carried_length_m, joints_without_link};

/// Reads the key `fit` of a study or of a joint. Keys that are missing are taken from `usual`; `null` means no limits.
/// Returns `None` after recording a fault.
pub(super) fn read_fit(object: &Object, usual: FitRequirement) -> Option<FitRequirement> {
    object.or("fit", usual, |node| match node.is_null() {
        true => Some(FitRequirement::default()),
        false => read_requirement(node, usual),
    })
}

fn read_requirement(node: &Node, usual: FitRequirement) -> Option<FitRequirement> {
    let object = node.shaped(&FIT)?;
    let number =
        |key: &str, usual: Option<f64>, per_unit: f64| {
            object.or(key, usual, |n| {
                if n.is_null() { Some(None) } else { n.positive().map(|x| Some(x / per_unit)) }
            })
        };
    let gear_to_link_max = number("gear_to_link_max", usual.gear_to_link_max, 1.0);
    let cable_bore_min_m = number("cable_bore_min_mm", usual.cable_bore_min_m, 1e3);
    let drive_length_max_m = number("drive_length_max_mm", usual.drive_length_max_m, 1e3);
    let motor = object.or("motor", usual.motor, read_motor_place);
    Some(FitRequirement {
        gear_to_link_max: gear_to_link_max?,
        motor: motor?,
        cable_bore_min_m: cable_bore_min_m?,
        drive_length_max_m: drive_length_max_m?,
        link_length_m: None,
    })
}

fn read_motor_place(node: &Node) -> Option<MotorPlace> {
    match node.string()? {
        "behind" => Some(MotorPlace::Behind),
        "in_link" => Some(MotorPlace::InLink),
        "beside" => Some(MotorPlace::Beside),
        other => node.fault(
            format!("\"{other}\" is not known"),
            "choose one of: behind (the gear, on its axis), in_link (in the hollow of the link), beside (not checked)",
        ),
    }
}

/// Stores in every joint whose motor is mounted in the link that the joint carries the length of this link, as the
/// largest length of the motor.
pub(super) fn measure_links(pieces: &mut [SpacePiece]) {
    for place in 0..pieces.len() {
        let length_m = carried_length_m(pieces, place);
        if let SpacePiece::Joint(joint) = &mut pieces[place] {
            joint.fit.link_length_m = length_m.filter(|_| joint.fit.motor == MotorPlace::InLink);
        }
    }
}

/// Remarks: the limits on sizes, the joints at which they cannot be checked, and the number of parts whose size the
/// catalogs leave blank. Empty if the study sets no such limits.
pub(super) fn fit_remarks(space: &DesignSpace, catalogs: &Catalogs) -> Vec<String> {
    let asking: Vec<&SpaceJoint> = joints_that_ask(space).collect();
    if asking.is_empty() {
        return Vec::new();
    }
    let asked = format!("Fit is checked: {}.", phrases(&asking).join("; "));
    let without = joints_without_link(&space.pieces);
    let no_link = (!without.is_empty()).then(|| {
        format!(
            "Gear and motor are not compared with a link in {}: there is none before the next joint.",
            without.join(", ")
        )
    });
    let sentences = [
        Some(asked),
        no_link,
        component_sets(&asking),
        unknown_sizes(&asking, catalogs),
        recalled_sizes(&asking, catalogs),
    ];
    sentences.into_iter().flatten().collect()
}

/// A sentence that names the joints whose gears are component sets, because the catalogs have no sizes of these; `None`
/// if there are none.
fn component_sets(asking: &[&SpaceJoint]) -> Option<String> {
    let is_set = |joint: &&&SpaceJoint| match &joint.drive {
        DriveChoice::FirstFit(filter) | DriveChoice::AllFits(filter) => {
            filter.gear_mass == GearMass::ComponentSet
        }
        DriveChoice::Given { .. } => false,
    };
    let names: Vec<&str> = asking.iter().filter(is_set).map(|joint| joint.name.as_str()).collect();
    (!names.is_empty()).then(|| {
        format!(
            "The gears of {} are not checked for fit: the sizes of component sets are not in the catalogs, which have those of \
             housed units.",
            names.join(", ")
        )
    })
}

/// The joints with chosen drives for which the study limits the sizes of parts.
pub(super) fn joints_that_ask(space: &DesignSpace) -> impl Iterator<Item = &SpaceJoint> {
    space.pieces.iter().filter_map(|piece| match piece {
        SpacePiece::Joint(joint) if joint.drive.is_sized() && joint.fit.is_asked() => Some(joint),
        _ => None,
    })
}

/// The limits on sizes in words, each with the names of the joints to which it applies.
fn phrases(asking: &[&SpaceJoint]) -> Vec<String> {
    let mm = |m: f64| significant(m * 1e3, 4);
    let mut phrases: Vec<(String, Vec<&str>)> = Vec::new();
    for joint in asking {
        let fit = &joint.fit;
        let behind = if fit.motor == MotorPlace::Behind { " and of the motor behind it" } else { "" };
        let of_joint = [
            fit.gear_to_link_max
                .map(|factor| format!("gear no wider than {factor} times the link that the joint carries")),
            (fit.motor == MotorPlace::InLink)
                .then(|| "motor in the hollow of that link and no longer than it".to_string()),
            fit.cable_bore_min_m.map(|m| format!("bore of the gear{behind} at least {} mm", mm(m))),
            fit.drive_length_max_m.map(|m| format!("length of the gear{behind} at most {} mm", mm(m))),
        ];
        for phrase in of_joint.into_iter().flatten() {
            match phrases.iter_mut().find(|(other, _)| *other == phrase) {
                Some((_, names)) => names.push(&joint.name),
                None => phrases.push((phrase, vec![&joint.name])),
            }
        }
    }
    phrases.into_iter().map(|(phrase, names)| format!("{phrase} ({})", names.join(", "))).collect()
}

/// Whether `holds` is true for at least one of the joints, given its limits on sizes and its filter of parts.
fn by_any(asking: &[&SpaceJoint], holds: &dyn Fn(&FitRequirement, &DriveFilter) -> bool) -> bool {
    asking.iter().any(|joint| joint.drive.filter().is_some_and(|filter| holds(&joint.fit, filter)))
}

/// Words on how many allowed gears have an uncertain size: a size that the study limits and whose catalog value was not
/// seen in a document. `None` if there are none.
fn recalled_sizes(asking: &[&SpaceJoint], catalogs: &Catalogs) -> Option<String> {
    let gears = catalogs.gears.iter().filter(|gear| {
        by_any(asking, &|fit, filter| {
            let size = gear.envelope_as(filter.gear_mass);
            let counts = [
                (fit.gear_to_link_max.is_some(), size.outer_diameter_m, "outer_diameter_mm"),
                (fit.cable_bore_min_m.is_some(), size.hollow_bore_m, "hollow_bore_mm"),
                (fit.drive_length_max_m.is_some(), size.length_m, "length_mm"),
            ];
            let is_unseen = |column: &str| gear.provenance.is_unverified(column);
            filter.allows_gear(gear)
                && counts
                    .iter()
                    .any(|(asked, size_m, column)| *asked && size_m.is_some() && is_unseen(column))
        })
    });
    let gears = gears.count();
    (gears > 0).then(|| {
        format!(
            "Sizes that were recalled and not seen in a document count like others: that is so of {gears} gears that these joints \
             may have (unverified_fields in `armwright catalog show --part NAME`)."
        )
    })
}

/// Number of allowed parts for which the catalogs lack a size that is limited, in words; `None` if there are none.
fn unknown_sizes(asking: &[&SpaceJoint], catalogs: &Catalogs) -> Option<String> {
    let is_blank = |asked: bool, size_m: Option<f64>| asked && size_m.is_none();
    let gears = catalogs.gears.iter().filter(|gear| {
        by_any(asking, &|fit, filter| {
            let size = gear.envelope_as(filter.gear_mass);
            filter.allows_gear(gear)
                && (is_blank(fit.gear_to_link_max.is_some(), size.outer_diameter_m)
                    || is_blank(fit.cable_bore_min_m.is_some(), size.hollow_bore_m)
                    || is_blank(fit.drive_length_max_m.is_some(), size.length_m))
        })
    });
    let motors = catalogs.motors.iter().filter(|motor| {
        let size = &motor.envelope;
        by_any(asking, &|fit, filter| {
            let behind = fit.motor == MotorPlace::Behind;
            // the size of an actuator is counted with its gear
            filter.allows_motor(motor)
                && motor.kind != MotorKind::OfActuator
                && (is_blank(fit.motor == MotorPlace::InLink, size.outer_diameter_m)
                    || is_blank(fit.link_length_m.is_some(), size.length_m)
                    || is_blank(behind && fit.cable_bore_min_m.is_some(), size.hollow_bore_m)
                    || is_blank(behind && fit.drive_length_max_m.is_some(), size.length_m))
        })
    });
    let (gears, motors) = (gears.count(), motors.count());
    let all_gears =
        catalogs.gears.iter().filter(|gear| by_any(asking, &|_, filter| filter.allows_gear(gear)));
    let is_motor = |motor: &&Motor| motor.kind != MotorKind::OfActuator;
    let all_motors = catalogs.motors.iter().filter(is_motor);
    let all_motors = all_motors.filter(|motor| by_any(asking, &|_, filter| filter.allows_motor(motor)));
    let counts = format!(
        "{gears} of the {} gears and {motors} of the {} motors that these joints may have lack a size in the catalogs, and that \
         size is not checked.",
        all_gears.count(),
        all_motors.count()
    );
    (gears + motors > 0).then_some(counts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalog::gear::Gear;
    use crate::input::json::Document;
    use crate::study::definition::Study;
    use crate::study::read::read_study;
    use serde_json::{Value, json};

    fn read(fit: Value, elbow: Value) -> Result<Study, String> {
        let mut study = json!({"name": "fits", "fit": fit, "chain": [
            {"type": "joint", "name": "shoulder", "axis": [0, 1, 0], "drive": "first_fit", "drives": {"motor_models": ["ILM85x26"]}},
            {"type": "link", "name": "upper", "vector_m": [0.5, 0, 0], "material": "Aluminium 6061-T6",
                "section": {"shape": "round_tube", "diameter_m": 0.12, "wall_m": 0.004}},
            {"type": "joint", "name": "elbow", "axis": [0, 1, 0], "drive": "first_fit"},
            {"type": "link", "name": "fore", "vector_m": [0.3, 0, 0]}],
            "poses": [{"pose_deg": [0, 0]}]});
        study["chain"][2].as_object_mut().unwrap().extend(elbow.as_object().unwrap().clone());
        let document = Document::parse("study", &study.to_string()).unwrap();
        read_study(document, &Catalogs::builtin()).map_err(|faults| faults.to_string())
    }

    fn of_joints(study: &Study) -> Vec<FitRequirement> {
        let joint = |piece: &SpacePiece| match piece {
            SpacePiece::Joint(joint) => Some(joint.fit),
            _ => None,
        };
        study.space.pieces.iter().filter_map(joint).collect()
    }

    #[test]
    fn a_joint_has_the_wishes_of_the_study_but_for_those_of_its_own() {
        let all = json!({"gear_to_link_max": 1.2, "motor": "in_link", "cable_bore_min_mm": 12, "drive_length_max_mm": 150});
        let [usual, own] = of_joints(
            &read(all.clone(), json!({"fit": {"cable_bore_min_mm": null, "drive_length_max_mm": 90}}))
                .unwrap(),
        )[..] else {
            panic!("two joints")
        };
        assert_eq!(usual.cable_bore_min_m, Some(0.012));
        let expected = FitRequirement {
            cable_bore_min_m: None,
            drive_length_max_m: Some(0.09),
            // the forearm is an offset, and has no hollow
            link_length_m: None,
            ..usual
        };
        assert_eq!(own, expected);
        assert_eq!(of_joints(&read(all, json!({"fit": null})).unwrap())[1], FitRequirement::default());
    }

    #[test]
    fn results_say_what_is_asked_where_it_cannot_be_and_what_the_catalogs_lack() {
        let all = json!({"gear_to_link_max": 1.2, "motor": "behind", "drive_length_max_mm": 150});
        let study = read(all, json!({"fit": {"motor": "in_link"}})).unwrap();
        let asking: Vec<&SpaceJoint> = joints_that_ask(&study.space).collect();
        let catalogs = Catalogs::builtin();
        let is_allowed = |gear: &&Gear| by_any(&asking, &|_, filter| filter.allows_gear(gear));
        let allowed = catalogs.gears.iter().filter(is_allowed).count();
        assert!(allowed < catalogs.gears.len());
        let remarks = study.remarks.join(" ");
        for words in [
            "Fit is checked: gear no wider than 1.2 times the link that the joint carries (shoulder, elbow); length of the gear \
             and of the motor behind it at most 150.0 mm (shoulder); motor in the hollow of that link and no longer than it \
             (elbow)",
            "not compared with a link in elbow: there is none before the next joint",
            " motors that these joints may have lack a size in the catalogs, and that size is not checked",
            &format!(" of the {allowed} gears and "),
            "Sizes that were recalled and not seen in a document count like others",
        ] {
            assert!(remarks.contains(words), "{words}\n{remarks}");
        }
        assert!(!remarks.contains("whether the parts fit"), "{remarks}");
        let nothing = read(json!({}), json!({})).unwrap().remarks.join(" ");
        assert!(
            nothing.contains("whether the parts fit into each other") && !nothing.contains("Fit is checked")
        );
    }

    #[test]
    fn an_unknown_place_of_the_motor_is_a_fault() {
        let fault = read(json!({"motor": "somewhere"}), json!({})).unwrap_err();
        assert!(fault.contains("fit.motor") && fault.contains("behind"), "{fault}");
    }
}
