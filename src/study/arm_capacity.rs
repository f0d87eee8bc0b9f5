//! The largest payload of an arm file at rest, in each pose: with it no joint exceeds its torque limit, and no output
//! bearing its load limits.
//!
//! An arm file says nothing of motion and duty, so only static loads are judged. The payload keeps the centre of
//! gravity that the case states. Torques are affine in the mass of the payload. A file such as the `import.json` of a
//! robot may state the torque limit of a joint. If none does, the average torque of the gear and the continuous torque
//! of the motor are the limits, as far as the catalogs have them. An output bearing is limited by its permissible
//! moment and by its static safety at rest, if it has these ratings.

use super::capacity::{AtPose, Capacity, Limit};
use crate::arm::keys::POSITIVE_OR_NULL;
use crate::arm::load::LoadCase;
use crate::arm::{Arm, Bearing};
use crate::catalog::Catalogs;
use crate::input::json::{Document, Faults, Node};
use crate::input::key::{Kind, Shape, optional, required};
use crate::input::schema::FileKind;
use crate::mechanics::chain::Chain;
use crate::mechanics::statics::JointLoad;
use crate::sizing::bearing::BearingLimits;
use crate::space::bearing_loads::{at_centre, bearings_of};

/// The largest torque that a joint may have at rest.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TorqueLimit {
    /// Name of the joint.
    pub joint: String,
    /// Name of the limit, such as the continuous torque of the motor.
    pub check: &'static str,
    /// Largest permitted torque \[N m\].
    pub most_nm: f64,
}

/// The format of a file with torque limits.
pub(crate) const LIMITS_FILE: FileKind = FileKind {
    name: "limits",
    about: "What `armwright capacity --limits` takes: the largest torques of joints. `import.json` is such a file.",
    root: Kind::Object(&LIMITS),
};

static LIMITS: Shape = Shape {
    name: "limits",
    about: "Torque limits; other keys are not read.",
    keys: &[required("joints", Kind::List(&Kind::Object(&LIMIT)), "-", "The joints with limits.")],
    rules: &[],
    others: Some(&Kind::Anything),
};

static LIMIT: Shape = Shape {
    name: "limit",
    about: "The limit of a joint.",
    keys: &[
        required("name", Kind::Text, "-", "Name of the joint."),
        optional("max_torque_nm", POSITIVE_OR_NULL, "N m", "none", "Largest torque at rest."),
    ],
    rules: &[],
    others: Some(&Kind::Anything),
};

/// Reads the torque limits of a file with `{"joints": [{"name": "j1", "max_torque_nm": 87}]}`, such as `import.json`.
/// Joints without a number have no limit.
///
/// # Errors
/// All faults of the file at once.
pub(crate) fn read_limits(document: Document) -> Result<Vec<TorqueLimit>, Faults> {
    let root = document.root();
    let limits = match root.value().get("joints") {
        Some(_) => joints(&root),
        None => {
            root.fault("has no \"joints\"", "write {\"joints\": [{\"name\": \"j1\", \"max_torque_nm\": 87}]}")
        }
    };
    document.finish(limits)
}

fn joints(root: &Node) -> Option<Vec<TorqueLimit>> {
    let (_, node) = root.entries()?.into_iter().find(|(key, _)| *key == "joints")?;
    let read: Vec<Option<Option<TorqueLimit>>> = node
        .array()?
        .iter()
        .map(|joint| {
            let entries = joint.entries()?;
            let of = |key: &str| entries.iter().find(|(k, _)| *k == key).map(|(_, node)| node);
            let Some(name) = of("name") else {
                return joint.fault("lacks \"name\"", "name the joint");
            };
            let joint = name.string()?.to_string();
            match of("max_torque_nm").filter(|node| !node.is_null()) {
                None => Some(None),
                Some(node) => {
                    Some(Some(TorqueLimit { joint, check: "torque limit", most_nm: node.positive()? }))
                }
            }
        })
        .collect();
    Some(read.into_iter().collect::<Option<Vec<_>>>()?.into_iter().flatten().collect())
}

/// The torque limits of joints at rest that follow from the ratings of the gears and motors that an arm names.
pub(crate) fn limits_of_parts(arm: &Arm, catalogs: &Catalogs) -> Vec<TorqueLimit> {
    let of_joint = |joint: &crate::arm::Joint| {
        let gear = joint.gear.as_ref().and_then(|name| catalogs.gear(name).ok());
        let motor = joint.motor.as_ref().and_then(|name| catalogs.motor(name).ok());
        let average_nm = gear.and_then(|gear| Some(gear.average_torque_limit_nm? * joint.stages.after.ratio));
        let continuous_nm = gear.zip(motor).and_then(|(gear, motor)| {
            let stages = &joint.stages;
            let efficiency =
                stages.before.efficiency * gear.efficiency.unwrap_or(1.0) * stages.after.efficiency;
            Some(motor.rated_torque_nm? * stages.whole_ratio(gear.ratio) * efficiency)
        });
        let limit = |check, most_nm: Option<f64>| {
            most_nm.map(|most_nm| TorqueLimit { joint: joint.name.clone(), check, most_nm })
        };
        [
            limit("average torque of the gear", average_nm),
            limit("continuous torque of the motor", continuous_nm),
        ]
    };
    arm.joints().filter(|joint| joint.coupled.is_none()).flat_map(of_joint).flatten().collect()
}

/// The largest payload of an arm at rest, in each of its cases and in all of them, with which no joint exceeds its
/// limit in `limits` and no output bearing exceeds its ratings.
pub(crate) fn arm_capacity(arm: &Arm, cases: &[LoadCase], limits: &[TorqueLimit]) -> Capacity {
    let mut table: Vec<AtPose> = cases
        .iter()
        .map(|case| {
            let structure = arm.structure_in(case);
            let tip_m = Chain::new(&structure, case.links).pose(case).tip_m;
            AtPose {
                pose: case.name.clone(),
                reach_m: (tip_m - arm.down * arm.down.dot(&tip_m)).norm(),
                limit: limit(arm, case, limits),
            }
        })
        .collect();
    table.sort_by(|a, b| a.reach_m.total_cmp(&b.reach_m));
    let least = table.iter().min_by(|a, b| a.limit.payload_kg.total_cmp(&b.limit.payload_kg));
    let (limit, pose) = match least {
        Some(at) => (at.limit.clone(), at.pose.clone()),
        None => {
            (Limit { payload_kg: f64::INFINITY, piece: String::new(), check: String::new() }, String::new())
        }
    };
    Capacity { limit, pose, table }
}

/// The largest payload in one case, and the joint that limits it. The torques are affine in the payload's mass, so it
/// is enough to compute them for two masses.
fn limit(arm: &Arm, case: &LoadCase, limits: &[TorqueLimit]) -> Limit {
    let chain = Chain::new(&arm.structure_in(case), case.links);
    let torques_nm = |payload_kg: f64| {
        let mut loaded = case.clone();
        loaded.payload.mass_kg = payload_kg;
        chain.pose(&loaded).statics().joint_torques_nm
    };
    let (empty, one_kg) = (torques_nm(0.0), torques_nm(1.0));
    let mut least = limit_of_bearings(arm, case);
    for limit in limits {
        let Some(index) = empty.iter().position(|(name, _)| *name == limit.joint) else { continue };
        let (without_nm, per_kg) = (empty[index].1, one_kg[index].1 - empty[index].1);
        let payload_kg = match without_nm.abs() > limit.most_nm {
            true => 0.0,
            false if per_kg == 0.0 => f64::INFINITY,
            false => (limit.most_nm.copysign(per_kg) - without_nm) / per_kg,
        };
        if payload_kg < least.payload_kg {
            least = Limit { payload_kg, piece: limit.joint.clone(), check: limit.check.into() };
        }
    }
    least
}

/// Ratio of the load on a bearing at rest to the load that is allowed, for each of the two checks at rest, with the
/// name of the check. `load` is the load on the joint of the bearing.
fn uses(bearing: &Bearing, load: &JointLoad) -> [(f64, &'static str); 2] {
    let (limits, load) = (limits_at_rest(bearing), at_centre(load, bearing));
    [
        (limits.moment_nm(&load) / limits.running_moment_nm, "bearing moment"),
        (limits.static_load_n(&load) / limits.at_rest_n, "bearing static safety"),
    ]
}

/// The limits of a bearing at rest. Speed and life are set to 0, because they limit only the load on a bearing that
/// turns, and an arm file says nothing of motion.
fn limits_at_rest(bearing: &Bearing) -> BearingLimits {
    BearingLimits::of(Some(bearing), 0.0, 0.0)
}

/// Whether any output bearing of an arm has a rating that limits its load at rest.
pub(crate) fn has_rated_bearings(arm: &Arm) -> bool {
    bearings_of(arm).any(|(_, bearing)| {
        let limits = limits_at_rest(&bearing);
        limits.running_moment_nm.min(limits.at_rest_n).is_finite()
    })
}

/// The largest payload in a case with which all output bearings pass their checks at rest. The loads are norms of
/// forces and moments that are affine in the payload's mass, so they are convex functions of this mass. If the bearings
/// pass without payload and with some payload, they therefore pass with every payload in between.
fn limit_of_bearings(arm: &Arm, case: &LoadCase) -> Limit {
    let chain = Chain::new(&arm.structure_in(case), case.links);
    let bearings: Vec<(&str, Bearing)> = bearings_of(arm).collect();
    let worst = |payload_kg: f64| {
        let mut loaded = case.clone();
        loaded.payload.mass_kg = payload_kg;
        let statics = chain.pose(&loaded).statics();
        let loads = statics.joint_torques_nm.iter().zip(&statics.bearing_loads);
        loads
            .filter_map(|((name, _), load)| Some((bearings.iter().find(|(joint, _)| joint == name)?, load)))
            .flat_map(|((joint, bearing), load)| {
                uses(bearing, load).map(|(part, check)| (part, *joint, check))
            })
            .max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let none = Limit { payload_kg: f64::INFINITY, piece: String::new(), check: String::new() };
    let fails = |payload_kg: f64| worst(payload_kg).is_some_and(|(part, ..)| part > 1.0);
    let (mut held_kg, mut failed_kg) = (0.0, 1.0);
    if fails(0.0) {
        failed_kg = 0.0;
    } else {
        while !fails(failed_kg) {
            (held_kg, failed_kg) = (failed_kg, 2.0 * failed_kg);
            if failed_kg > MOST_PAYLOAD_KG {
                return none;
            }
        }
        while failed_kg - held_kg > SAME_PAYLOAD * failed_kg {
            let middle_kg = 0.5 * (held_kg + failed_kg);
            if fails(middle_kg) { failed_kg = middle_kg } else { held_kg = middle_kg }
        }
    }
    match worst(failed_kg) {
        Some((_, joint, check)) => Limit { payload_kg: held_kg, piece: joint.into(), check: check.into() },
        None => none,
    }
}

/// If the bearings still pass with about this payload \[kg\], they count as no limit on the payload.
const MOST_PAYLOAD_KG: f64 = 1e9;

/// The search for the largest payload that the bearings allow ends when its interval is this narrow, relative to the
/// payload.
const SAME_PAYLOAD: f64 = 1e-13;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::file::read_arm_document;
    use crate::arm::load::read_load_cases;

    #[test]
    fn a_lever_holds_what_its_torque_allows() {
        // 2 kg in the middle of 1 m and m at its end, with a limit of 50 N m: m = (50/9.81 - 1)/1; folded up, nothing
        // limits m
        let text = r#"{"chain": [{"type": "joint", "name": "j", "axis": [0, 1, 0], "stiffness_nm_per_rad": null},
            {"type": "link", "name": "l", "vector_m": [1, 0, 0], "mass_kg": 2}]}"#;
        let arm = read_arm_document(Document::parse("a", text).expect("JSON"), &Catalogs::default())
            .expect("an arm");
        let cases = r#"[{"name": "out", "pose_deg": [0]}, {"name": "half", "pose_deg": [-60]}]"#;
        let cases = Document::parse("c", cases).expect("JSON");
        let cases = read_load_cases(cases, &arm.driven_joints()).expect("cases");
        let limits = r#"{"robot": "r", "joints": [{"name": "j", "max_torque_nm": 50}, {"name": "k", "max_torque_nm": null}]}"#;
        let limits = read_limits(Document::parse("l", limits).expect("JSON")).expect("limits");
        let found = arm_capacity(&arm, &cases, &limits);
        let out_kg = 50.0 / 9.81 - 1.0;
        assert!((found.limit.payload_kg - out_kg).abs() < 1e-9 && found.pose == "out", "{found:?}");
        assert!((found.table[0].limit.payload_kg - (100.0 / 9.81 - 1.0)).abs() < 1e-9, "{found:?}");
        assert_eq!((found.limit.piece.as_str(), found.limit.check.as_str()), ("j", "torque limit"));
        let faulty = r#"{"joints": [{"name": "j", "max_torque_nm": -5}, {"max_torque_nm": 5}]}"#;
        assert_eq!(
            read_limits(Document::parse("l", faulty).expect("JSON")).expect_err("two faults").0.len(),
            2
        );
    }
}
