//! Compliance of the connections between gears and links, as a fraction of the compliance of the gears.
//!
//! Rivin counts the connections of motor to gear and of gear to arm among the sources of compliance of a robot:
//! flanges that are bolted together deflect about as much as the parts that they join. Without a drawing, nothing
//! more exact than a fraction of the gear's own compliance can be stated.

use crate::arm::bearing::BearingSource;
use crate::input::json::Object;
use crate::report::number::significant;
use crate::space::design_space::{DesignSpace, DriveChoice, SpacePiece};

/// Adds the compliance of connections, as the fraction `share` of the catalog compliance, to a given gear and to the
/// bearing. Stiffnesses that the study states in numbers are taken to include this compliance. If the search chooses
/// the gear, the compliance is added later, when the gear is known.
pub(super) fn with_connections(
    share: f64,
    object: &Object,
    drive: DriveChoice,
    bearing: BearingSource,
) -> (DriveChoice, BearingSource) {
    let factor = 1.0 / (1.0 + share);
    let in_numbers = object.has("stiffness_nm_per_rad") || object.has("windup");
    let drive = match drive {
        DriveChoice::Given { curve, mass_kg, gear: Some(gear), motor } if !in_numbers => {
            DriveChoice::Given { curve: curve.stiffened(factor), mass_kg, gear: Some(gear), motor }
        }
        other => other,
    };
    let is_object = object.optional("bearing").is_some_and(|node| node.value().is_object());
    let bearing = match bearing {
        BearingSource::Stated(Some(bearing)) if !is_object => {
            BearingSource::Stated(Some(bearing.stiffened(factor)))
        }
        other => other,
    };
    (drive, bearing)
}

/// The compliance of connections as a fraction of the compliance of the gear, for the joint of the study where this
/// fraction is largest. 0 if all connections are rigid.
pub(super) fn connection_share(space: &DesignSpace) -> f64 {
    let shares = space.pieces.iter().map(|piece| match piece {
        SpacePiece::Joint(joint) => joint.connection_share,
        _ => 0.0,
    });
    shares.fold(0.0, f64::max)
}

/// The effect of connections on the results, in a sentence; `None` if they are rigid. No compliance grows by more
/// than the factor `1 + share`, so no natural frequency falls by more than the square root of this factor.
pub(super) fn connections_remark(space: &DesignSpace) -> Option<String> {
    let share = connection_share(space);
    let percent = |part: f64| significant(100.0 * part, 2);
    (share > 0.0).then(|| {
        format!(
            "Connections add {} % to the compliance of each gear and bearing (representative). With rigid ones the part of the joints in the \
             deflection would be {} % smaller, and no mode more than {} % higher.",
            percent(share),
            percent(share / (1.0 + share)),
            percent((1.0 + share).sqrt() - 1.0),
        )
    })
}

#[cfg(test)]
mod tests {
    use crate::catalog::Catalogs;
    use crate::input::json::Document;
    use crate::pareto::objectives::Objectives;
    use crate::space::evaluate;
    use crate::space::problem::ArmProblem;
    use crate::study::read::read_study;
    use serde_json::{Value, json};

    /// Objectives and remarks of an arm with one rigid link on one joint, in a study with the fraction `share` for
    /// connections. `joint` has further keys of the joint.
    fn arm(share: f64, joint: Value) -> (Objectives, String) {
        let mut study = json!({"name": "one joint", "connection_share": share,
            "chain": [{"type": "joint", "name": "j1", "axis": [0, 1, 0]},
                {"type": "link", "name": "arm", "vector_m": [0.6, 0, 0], "mass_kg": 1}],
            "payload": {"mass_kg": 3}, "poses": [{"pose_deg": [0]}], "models": {"links": "rigid", "joints": "k2"}});
        study["chain"][0].as_object_mut().unwrap().extend(joint.as_object().unwrap().clone());
        let catalogs = Catalogs::builtin();
        let study = read_study(Document::parse("study", &study.to_string()).unwrap(), &catalogs).unwrap();
        let problem = ArmProblem::new(&study.space, &catalogs);
        (evaluate(&problem, 0).unwrap().objectives, study.remarks.join(" "))
    }

    #[test]
    fn an_arm_that_yields_in_its_joint_alone_sags_by_the_share_more_and_swings_by_its_root_slower() {
        for joint in [
            json!({"drive": "first_fit", "bearing": null}),
            json!({"drive": "first_fit"}),
            json!({"gear": "CSG-32-100", "motor": "ILM85x26", "mass_kg": 4}),
        ] {
            let ((rigid, said), (soft, words)) = (arm(0.0, joint.clone()), arm(0.25, joint));
            assert!((soft.tip_deflection_m / rigid.tip_deflection_m - 1.25).abs() < 1e-9);
            assert!((soft.lowest_mode_hz * 1.25f64.sqrt() / rigid.lowest_mode_hz - 1.0).abs() < 1e-9);
            assert!(
                said.contains("the compliance of the connections")
                    && !words.contains("the compliance of the connections")
            );
            assert!(words.contains("Connections add 25 % to the compliance of each gear"), "{words}");
        }
    }

    #[test]
    fn a_stiffness_in_numbers_has_its_connections_already() {
        let joint = || json!({"stiffness_nm_per_rad": 2e5, "mass_kg": 4});
        assert_eq!(arm(0.25, joint()).0, arm(0.0, joint()).0);
    }
}
