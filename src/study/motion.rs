//! Reads the motion that a study asks for: speeds and ramps, the duty cycle that every joint repeats, and the duty of
//! a single joint.

use super::keys::{MOTION, PHASE, STATED_PHASE};
use crate::input::json::{Node, Object};
use crate::sizing::duty::{DutyCycle, Phase, PhaseKind};
use crate::sizing::requirement::MotionRequirement;
use crate::sizing::stated::{StatedDuty, StatedPhase};

/// Relative difference up to which the times of speeding up and of slowing down in a duty cycle count as equal.
const SAME_TIME: f64 = 1e-9;

/// Reads the motion of the tip. Keys that are missing have the paper's values.
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

/// Reads the duty cycle that every joint repeats, a list of phases.
fn read_cycle(node: &Node) -> Option<DutyCycle> {
    let read: Vec<Option<Phase>> = node.array()?.iter().map(read_phase).collect();
    let cycle = DutyCycle { phases: read.into_iter().collect::<Option<_>>()? };
    if cycle.phases.iter().all(|phase| phase.duration_s == 0.0) {
        return node.fault("takes no time", "give at least one phase with \"time_s\" above 0");
    }
    let [up_s, down_s] = cycle.ramps_s();
    if (up_s - down_s).abs() > SAME_TIME * (up_s + down_s) {
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
            let share = |key| phase.required(key).and_then(|n| n.non_negative());
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

/// Reads the duty of one joint in numbers, as in a vendor's worked example.
pub(super) fn read_duty(node: &Node) -> Option<StatedDuty> {
    let read: Vec<Option<StatedPhase>> = node.array()?.iter().map(read_stated_phase).collect();
    let duty = StatedDuty { phases: read.into_iter().collect::<Option<_>>()? };
    if duty.duration_s() == 0.0 || duty.fastest_rpm() == 0.0 {
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
