//! Reads the motion that a study asks for: speeds and ramps, the duty cycle that every joint repeats, and the duty of
//! a single joint.

use super::keys::{MOTION, PHASE, STATED_PHASE};
use crate::input::json::{Node, Object};
use crate::report::number::significant;
use crate::sizing::duty::{DutyCycle, Phase, PhaseKind};
use crate::sizing::requirement::MotionRequirement;
use crate::sizing::rpm_from_rad_s;
use crate::sizing::stated::{StatedDuty, StatedPhase};
use crate::space::design_space::{DesignSpace, SpaceJoint};
use crate::space::station::reaches_m;

/// Reads the motion of the tip. Keys that are missing have the paper's values. Returns `None` after recording a fault.
pub(super) fn read_motion(node: &Node) -> Option<MotionRequirement> {
    let object = node.shaped(&MOTION)?;
    let default = MotionRequirement::default();
    let speed = object.or("tip_speed_m_s", default.tip_speed_m_s, Node::positive);
    let ramp = object.or("ramp_time_s", default.ramp_time_s, Node::positive);
    let stop = object.or("emergency_deceleration_m_s2", None, |n| n.positive().map(Some));
    let lever = object.or("min_lever_m", default.min_lever_m, Node::positive);
    let life = object.or("life_h", default.life_h, Node::positive);
    let ramp_time_s = ramp?;
    let cycle = object.or("cycle", DutyCycle::move_and_rest(ramp_time_s), read_cycle);
    let stops = object.or("emergency_stops", None, |n| n.positive().map(Some));
    let heat = object.or("check_motor_heat", default.checks_motor_heat, Node::boolean);
    Some(MotionRequirement {
        tip_speed_m_s: speed?,
        ramp_time_s,
        emergency_deceleration_m_s2: stop?,
        min_lever_m: lever?,
        life_h: life?,
        duty_cycle: cycle?,
        emergency_stops: stops?,
        checks_motor_heat: heat?,
        ..default
    })
}

/// A remark if a ramp of the cycle takes another time than the ramp for which drives are sized; otherwise `None`.
pub(super) fn ramp_remark(motion: &MotionRequirement) -> Option<String> {
    let stated_s = motion.ramp_time_s;
    motion.duty_cycle.other_ramp_s(stated_s).map(|ramp_s| {
        format!(
            "A ramp of the cycle takes {ramp_s} s, and ramp_time_s is {stated_s} s: the torque of a ramp is that of {stated_s} s, \
             and mean torque, life and motor heat count it for {ramp_s} s. State the same time in both."
        )
    })
}

/// Remarks on the joints with a stated duty: where it is slower than the speed that the study asks of the tip, and
/// where it has no ramps.
pub(super) fn duty_remarks(space: &DesignSpace) -> Vec<String> {
    let sizing = space.sizing_cases.iter().map(|&i| &space.cases[i]);
    let remark = |((_, joint), reach_m): ((usize, &SpaceJoint), f64)| {
        joint.duty.as_ref()?;
        let of_tip_rad_s = space.motion.joint_motion(reach_m, joint.max_speed_rad_s).speed_rad_s;
        let of_duty_rad_s = joint.motion(&space.motion, reach_m).speed_rad_s;
        (of_duty_rad_s < of_tip_rad_s * (1.0 - SAME_SPEED)).then(|| {
            format!(
                "Joint {} is sized for the {} rpm of its duty, not for the {} rpm of tip_speed_m_s.",
                joint.name,
                rpm_words(of_duty_rad_s),
                rpm_words(of_tip_rad_s)
            )
        })
    };
    let slower = space.joints().zip(reaches_m(space, sizing)).filter_map(remark);
    let ramps = space.joints().filter_map(|(_, joint)| {
        let numbers: Vec<String> = joint.duty.as_ref()?.ramps().iter().map(usize::to_string).collect();
        let (phases, count) =
            if numbers.len() == 1 { ("phase", "counts as a ramp") } else { ("phases", "count as ramps") };
        (!numbers.is_empty())
            .then(|| format!("Joint {}: {phases} {} of its duty {count}.", joint.name, numbers.join(", ")))
    });
    let has_no_ramps = |joint: &&SpaceJoint| joint.duty.as_ref().is_some_and(StatedDuty::moves_without_ramps);
    let without_ramps = space.joints().map(|(_, joint)| joint).filter(has_no_ramps).map(|joint| {
        format!(
            "Joint {}: no phase of its duty has the mean of two different speeds before and after it, so that none is a ramp. Motor heat leaves out the \
             inertia of the rotor, and speeds count as constant in each phase. Give ramps at their mean speed, and between a ramp up \
             and a ramp down a short phase at the speed that they reach.",
            joint.name
        )
    });
    slower.chain(ramps).chain(without_ramps).collect()
}

/// Speeds that differ by less than this fraction count as equal: they were converted between units.
const SAME_SPEED: f64 = 1e-6;

/// A speed in rpm with one decimal, or with two digits below 1 rpm.
fn rpm_words(speed_rad_s: f64) -> String {
    let rpm = rpm_from_rad_s(speed_rad_s);
    if rpm < 1.0 { significant(rpm, 2) } else { format!("{rpm:.1}") }
}

/// Reads the duty cycle that every joint repeats, a list of phases. Returns `None` after recording a fault.
fn read_cycle(node: &Node) -> Option<DutyCycle> {
    let read: Vec<Option<Phase>> = node.array()?.iter().map(read_phase).collect();
    let cycle = DutyCycle { phases: read.into_iter().collect::<Option<_>>()? };
    if cycle.phases.iter().all(|phase| phase.duration_s == 0.0) {
        return node.fault("takes no time", "give at least one phase with \"time_s\" above 0");
    }
    if let Some([up_s, down_s]) = cycle.unequal_ramps_s() {
        return node.fault(
            format!("speeds up for {up_s} s and slows down for {down_s} s"),
            "give both the same time: they happen at one acceleration, and the joint comes back to rest",
        );
    }
    Some(cycle)
}

fn read_phase(node: &Node) -> Option<Phase> {
    let object = node.shaped(&PHASE)?;
    let duration = object.required("time_s").and_then(|n| n.non_negative());
    let kind = object.required("phase").and_then(|n| read_kind(&n, &object));
    Some(Phase { duration_s: duration?, kind: kind? })
}

fn read_kind(node: &Node, phase: &Object) -> Option<PhaseKind> {
    let kind = match node.string()? {
        "accelerate" => PhaseKind::Accelerate,
        "constant" => PhaseKind::Constant,
        "decelerate" => PhaseKind::Decelerate,
        "rest" => PhaseKind::Rest,
        "fraction" => {
            let share = |key| phase.required(key).and_then(|n| read_fraction(&n));
            let (torque, speed) = (share("of_static_torque"), share("of_speed"));
            return Some(PhaseKind::Fraction { of_static_torque: torque?, of_speed: speed? });
        }
        other => {
            return node.fault(
                format!("\"{other}\" is not known"),
                "choose one of: accelerate, constant, decelerate, rest, fraction",
            );
        }
    };
    for key in ["of_static_torque", "of_speed"].into_iter().filter_map(|key| phase.optional(key)) {
        key.fault::<()>("belongs to a phase \"fraction\"", "remove it, or make the phase a \"fraction\"");
    }
    Some(kind)
}

/// Reads a fraction of the static torque or of the largest speed. A fraction above 1 is a fault, because no check would
/// see the larger torque or speed. Returns `None` after recording a fault.
fn read_fraction(node: &Node) -> Option<f64> {
    match node.non_negative()? {
        part if part <= 1.0 => Some(part),
        part => node.fault(
            format!("= {part} is more than the whole"),
            "state the largest payload and the largest speed in the study, or give the joint a \"duty\" in numbers",
        ),
    }
}

/// Reads the duty of one joint in numbers, as in a vendor's worked example. Returns `None` after recording a fault.
pub(super) fn read_duty(node: &Node) -> Option<StatedDuty> {
    let read: Vec<Option<StatedPhase>> = node.array()?.iter().map(read_stated_phase).collect();
    let duty = StatedDuty { phases: read.into_iter().collect::<Option<_>>()? };
    let moves = |phase: &StatedPhase| phase.time_s > 0.0 && phase.speed_rpm > 0.0;
    if !duty.phases.iter().any(moves) {
        return node.fault(
            "has no phase of motion",
            "give at least one phase with \"time_s\" and \"speed_rpm\" above 0",
        );
    }
    Some(duty)
}

fn read_stated_phase(node: &Node) -> Option<StatedPhase> {
    let object = node.shaped(&STATED_PHASE)?;
    let torque = object.required("torque_nm").and_then(|n| n.number());
    let time = object.required("time_s").and_then(|n| n.non_negative());
    let speed = object.required("speed_rpm").and_then(|n| n.non_negative());
    Some(StatedPhase { torque_nm: torque?, time_s: time?, speed_rpm: speed? })
}

#[cfg(test)]
mod tests {
    use crate::catalog::Catalogs;
    use crate::input::json::Document;
    use crate::study::read::read_study;
    use serde_json::{Value, json};

    /// Remarks on a study of one joint with this motion.
    fn remarks(motion: Value) -> String {
        let study = json!({"name": "s", "motion": motion, "chain": [
            {"type": "joint", "name": "j", "axis": [0, 1, 0], "drive": "first_fit"},
            {"type": "link", "name": "arm", "vector_m": [0.3, 0, 0], "mass_kg": 1}],
            "poses": [{"pose_deg": [0]}]});
        let document = Document::parse("s.json", &study.to_string()).unwrap();
        read_study(document, &Catalogs::builtin()).unwrap().remarks.join(" ")
    }

    /// A cycle of ramps up and down that take these times \[s\], and a rest.
    fn cycle(ramps_s: &[f64]) -> Value {
        let ramp =
            |phase: &str| ramps_s.iter().map(|s| json!({"phase": phase, "time_s": s})).collect::<Vec<_>>();
        let still = json!({"phase": "rest", "time_s": 1.0});
        Value::Array([ramp("accelerate"), ramp("decelerate"), vec![still]].concat())
    }

    #[test]
    fn a_cycle_whose_ramps_contradict_the_ramp_time_is_remarked() {
        let said = remarks(json!({"ramp_time_s": 0.2, "cycle": cycle(&[0.5])}));
        assert!(said.contains("A ramp of the cycle takes 0.5 s, and ramp_time_s is 0.2 s"), "{said}");
        let unstated = remarks(json!({"cycle": cycle(&[0.5])}));
        assert!(unstated.contains("ramp_time_s is 0.2 s"), "the default counts: {unstated}");
        for agreeing in [
            json!({"ramp_time_s": 0.3}),
            json!({"ramp_time_s": 0.5, "cycle": cycle(&[0.5])}),
            json!({"ramp_time_s": 0.5, "cycle": cycle(&[0.2, 0.3])}),
            json!({"cycle": [{"phase": "fraction", "time_s": 4, "of_static_torque": 0.5, "of_speed": 0.5}]}),
        ] {
            let said = remarks(agreeing.clone());
            assert!(!said.contains("ramp of the cycle"), "{agreeing}: {said}");
        }
    }
}
