//! Capacity: the payloads that an arm holds with its drives unchanged, in each pose of a study and in all of them, and
//! the largest speed at which it holds the payloads of the study.
//!
//! The mass of the payload is varied from the one that the study states, upwards and downwards, until a drive, an
//! output bearing or the stress of a link exceeds its limit. The payload keeps its centre of gravity and its moments of
//! inertia. The checks are those of sizing. For all poses together, the largest static torque and the largest inertia
//! are combined, although they may come from different poses. A pose that states a payload of its own keeps this
//! payload.
//!
//! An arm that is balanced for its payload may hold the payload and fail without it. Its payloads then have a lower
//! limit too.

use super::chosen::{chosen_design, why_not_held};
use super::definition::Study;
use super::guide_remarks::guide_limits_remark;
use super::largest_speed::{LargestSpeed, largest_speed, with_these_drives};
use super::motor_remarks::stop_remark_on;
use super::overload::{Overload, overload};
use super::reaction_remarks::reaction_remark_on;
use super::refusal::Refusal;
use super::stated_bearing_remarks::unchecked_bearings;
use super::window::{Window, window_around};
use crate::arm::Arm;
use crate::arm::load::LoadCase;
use crate::catalog::Catalogs;
use crate::report::number::{fixed, significant};
use crate::space::design_space::{DesignSpace, SpacePiece};
use crate::space::full_model::full_objectives;
use crate::space::problem::ArmProblem;
use crate::space::station::Walk;
use nalgebra::Vector3;
use serde_json::{Value, json};

/// The payloads that the arm holds in one pose.
#[derive(Debug, Clone, PartialEq)]
pub struct AtPose {
    /// Name of the pose.
    pub pose: String,
    /// Reach of the tip \[m\]. If gravity points along the z axis of the base, it is the distance of the tip from the
    /// origin measured across gravity; otherwise, as on a wall, it is the whole distance.
    pub reach_m: f64,
    /// The least and the largest payload that the arm holds in this pose.
    pub window: Window,
}

/// The payloads that an arm holds, in all poses and in each of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Capacity {
    /// The least and the largest payload that the arm holds in all sizing poses together.
    pub window: Window,
    /// Name of the sizing pose whose largest payload is the smallest of all.
    pub pose: String,
    /// Name of the sizing pose whose smallest payload is the largest of all; empty if every pose holds the empty arm.
    pub least_pose: String,
    /// The payloads that the arm holds in each sizing pose, sorted by reach, shortest first. Poses that keep a payload
    /// of their own have no entry.
    pub table: Vec<AtPose>,
    /// The largest speed with the payloads of the study; `None` if even the study's speed is too large for them, if
    /// nothing limits the speed, or for an arm file, which states no motion.
    pub largest_speed: Option<LargestSpeed>,
    /// Remarks on what the numbers leave out, as sentences.
    pub remarks: Vec<String>,
}

impl Capacity {
    /// The capacity of an arm that holds the payloads `window` in all poses together. `table` has the payloads of each
    /// pose.
    pub(crate) fn new(window: Window, mut table: Vec<AtPose>, remarks: Vec<String>) -> Self {
        let most = table.iter().min_by(|a, b| a.window.most.payload_kg.total_cmp(&b.window.most.payload_kg));
        let least =
            table.iter().max_by(|a, b| a.window.least.payload_kg.total_cmp(&b.window.least.payload_kg));
        let pose = most.map_or(String::new(), |at| at.pose.clone());
        let least_pose = least.filter(|at| at.window.least.payload_kg > 0.0);
        let least_pose = least_pose.map_or(String::new(), |at| at.pose.clone());
        table.sort_by(|a, b| a.reach_m.total_cmp(&b.reach_m));
        Self { window, pose, least_pose, table, largest_speed: None, remarks }
    }

    /// The capacity as JSON, as `armwright capacity --json` prints it: the limits in all poses together, and one entry
    /// for each pose.
    pub fn to_json(&self) -> Value {
        let with = |window: &Window, further: Value| {
            let mut out = window.to_json();
            for (key, value) in further.as_object().into_iter().flatten() {
                out[key] = value.clone();
            }
            out
        };
        let row = |at: &AtPose| with(&at.window, json!({"reach_m": at.reach_m, "pose": at.pose}));
        let rows: Vec<Value> = self.table.iter().map(row).collect();
        let pose = if self.window.holds() { &self.pose } else { &self.least_pose };
        let speed = self.largest_speed.as_ref().map(LargestSpeed::to_json);
        let all = json!({"pose": pose, "least_pose": self.least_pose, "table": rows, "largest_speed": speed,
            "remarks": self.remarks});
        with(&self.window, all)
    }
}

/// Reach of a tip at `tip_m` from the origin \[m\]; `down` is the direction of gravity. Gravity along the z axis of the
/// base means an arm that stands or hangs. Its reach is the distance across gravity, the lever of its payload. The
/// reach of an arm on a wall is the whole distance.
pub(crate) fn reach_m(tip_m: &Vector3<f64>, down: &Vector3<f64>) -> f64 {
    let stands = down.x == 0.0 && down.y == 0.0;
    if stands { (tip_m - down * down.dot(tip_m)).norm() } else { tip_m.norm() }
}

/// The capacity of the design with the `design_id` given as `id`. Without an id, it is the capacity of a design with
/// links of median mass and the lightest drives.
///
/// # Errors
/// The study has nothing to choose from or no such design, or a drive of the design does not meet even the study's own payload.
pub fn capacity_of(study: &Study, id: Option<&str>, catalogs: &Catalogs) -> Result<Capacity, Refusal> {
    let (space, chosen) = chosen_design(study, id, catalogs)?;
    let problem = ArmProblem::new(&space, catalogs);
    let arm =
        problem.walk(&chosen, |_, _| {}).map_err(|slot| why_not_held(&problem, &chosen, slot, catalogs))?;
    let mut found = capacity(&space, catalogs, arm.slot_options(), &study.own_payloads);
    found.largest_speed = largest_speed(&problem, arm.slot_options(), catalogs);
    found.remarks.extend(duty_remark(&space));
    found.remarks.extend(unjudged_remark(&problem, catalogs));
    found.remarks.extend(unchecked_bearings(&problem, catalogs));
    found.remarks.extend(guide_limits_remark(&problem));
    found.remarks.extend(moving_remarks(&problem, arm.slot_options(), &study.own_payloads, &found, catalogs));
    let built = problem.arm_of(&arm);
    found.remarks.extend(built.and_then(|built| limits_remark(&space, &built, &study.own_payloads)));
    Ok(found)
}

/// The capacity of the design with these options, tip first. There is one option for each slot (joint or link, in the
/// order in which the arm is built), and `space` is the space to which the options belong. The cases with the indices
/// `own` state a payload of their own and keep it. If every sizing case is among them, the payload is varied in all of
/// them, and is the same in all.
fn capacity(space: &DesignSpace, catalogs: &Catalogs, options: &[u32], own: &[usize]) -> Capacity {
    let loaded = varied(space, own);
    let kept: Vec<usize> = space.sizing_cases.iter().copied().filter(|case| own.contains(case)).collect();
    let mut remarks = Vec::new();
    if !kept.is_empty() && kept.len() == space.sizing_cases.len() {
        remarks
            .push("Every pose states a payload of its own; all of them take the same payload here.".into());
    } else if !kept.is_empty() {
        let names: Vec<String> =
            kept.iter().map(|&case| format!("\u{201c}{}\u{201d}", space.cases[case].name)).collect();
        remarks.push(format!("Poses that keep the payload that they state: {}.", names.join(", ")));
    }
    let window = |cases: &[usize], vary: &[usize]| held_payloads(space, catalogs, options, cases, vary);
    let at_pose = |&case: &usize| AtPose {
        pose: space.cases[case].name.clone(),
        reach_m: reach_m(&Walk::new(space, &space.cases[case]).tip_m, &space.down),
        window: window(&[case], &[case]),
    };
    let table = loaded.iter().map(at_pose).collect();
    Capacity::new(window(&space.sizing_cases, &loaded), table, remarks)
}

/// Sentences on what the drives must hold while other joints move, and on the motors that cannot make the emergency stop
/// of their joint, with the largest payload of `found` in the cases in which the payload is varied. `options` are those
/// of the design, one for each slot. Empty if there is nothing to say, or if no payload is the largest.
fn moving_remarks(
    problem: &ArmProblem,
    options: &[u32],
    own: &[usize],
    found: &Capacity,
    catalogs: &Catalogs,
) -> Vec<String> {
    let most_kg = found.window.most.payload_kg;
    if !found.window.holds() || !most_kg.is_finite() {
        return Vec::new();
    }
    // with the drives that the design has, and not with those that first fit would take for the largest payload
    let (mut space, options) = with_these_drives(problem, options);
    for case in varied(&space, own) {
        space.cases[case].payload.mass_kg = most_kg;
    }
    let loaded = ArmProblem::new(&space, catalogs);
    let chosen: Vec<u32> = loaded.level_slots().iter().map(|&slot| options[slot]).collect();
    let whose = "in the sizing cases with the largest payload";
    let of_reactions = reaction_remark_on(&loaded, catalogs, &chosen, whose);
    of_reactions.into_iter().chain(stop_remark_on(&loaded, catalogs, &chosen, whose)).collect()
}

/// The sizing cases in which the payload is varied: all but those with the indices `own`, which state a payload of their
/// own. If every sizing case is among them, it is varied in all.
fn varied(space: &DesignSpace, own: &[usize]) -> Vec<usize> {
    let varied: Vec<usize> = space.sizing_cases.iter().copied().filter(|case| !own.contains(case)).collect();
    if varied.is_empty() { space.sizing_cases.clone() } else { varied }
}

/// A sentence that names the drives that are not judged; `None` if there are none. A given drive is not judged if the
/// study does not name its gear and motor from the catalogs, or if it is the drive of a rail.
fn unjudged_remark(problem: &ArmProblem, catalogs: &Catalogs) -> Option<String> {
    let pieces = problem.space().pieces.iter().enumerate();
    let unjudged = pieces.filter(|(piece, what)| match what {
        SpacePiece::Joint(joint) => {
            !joint.drive.is_sized()
                && joint.coupled.is_none()
                && problem.fixed_drive(*piece, catalogs).is_none()
        }
        SpacePiece::Prismatic(rail) => rail.drive.is_none(),
        SpacePiece::Link(_) | SpacePiece::Choice(_) => false,
    });
    let names: Vec<&str> = unjudged.map(|(_, what)| what.name()).collect();
    (!names.is_empty()).then(|| {
        format!(
            "The drive of {} is not judged: it is given, and not by names of the catalogs (gear and motor, or an actuator).",
            names.join(", ")
        )
    })
}

/// A sentence that names the joints whose duty the study states in numbers, and says that this duty is taken for every
/// payload and speed; `None` if there are none.
fn duty_remark(space: &DesignSpace) -> Option<String> {
    let stated: Vec<&str> =
        space.joints().filter(|(_, j)| j.duty.is_some()).map(|(_, joint)| joint.name.as_str()).collect();
    (!stated.is_empty()).then(|| {
        format!(
            "The duty of {} is stated in numbers and is taken for every payload and speed: its mean torque, its gear's life and its motor's heat \
             do not grow with them, and are not judged for more than the payload and the speed that the duty was made for.",
            stated.join(", ")
        )
    })
}

/// A sentence that states up to which payload the design `built` meets the study's limits on deflection and lowest mode
/// in the judged cases; `None` if the study has no such limits. They are judged separately, because the drives may hold
/// a payload with which the arm exceeds these limits. The cases with the indices `own` keep their payload, unless all
/// cases have one.
fn limits_remark(space: &DesignSpace, built: &Arm, own: &[usize]) -> Option<String> {
    let limits = &space.constraints;
    if limits.tip_deflection_max_m.is_none() && limits.required_mode_hz() <= 0.0 {
        return None;
    }
    let cases = &space.cases;
    let varied: Vec<usize> =
        (0..cases.len()).filter(|case| own.len() == cases.len() || !own.contains(case)).collect();
    let breaks = |payload_kg: f64| {
        let mut loaded = cases.clone();
        varied.iter().for_each(|&case| loaded[case].payload.mass_kg = payload_kg);
        let judged: Vec<LoadCase> =
            space.judged_cases.iter().map(|&case| space.load_case(&loaded[case])).collect();
        let [too_far, _, too_low] = limits.broken(&full_objectives(built, &judged));
        let check = match too_far {
            true => format!(
                "the tip deflects by more than {} mm",
                significant(1e3 * limits.tip_deflection_max_m.unwrap_or_default(), 4)
            ),
            false => format!("the lowest mode falls below {} Hz", significant(limits.required_mode_hz(), 4)),
        };
        (too_far || too_low).then(|| Overload { piece: "tip".into(), check })
    };
    let stated_kg = varied.iter().map(|&case| cases[case].payload.mass_kg).fold(0.0, f64::max);
    let judged = "Drives, output bearings, guides and the stress in links are judged.";
    Some(match breaks(stated_kg) {
        Some(broken) => format!(
            "{judged} The limits of the study are not met even at {} kg: {} in a judged pose.",
            fixed(stated_kg, 3),
            broken.check
        ),
        None => match window_around(stated_kg, &breaks).most {
            most if most.payload_kg.is_finite() => format!(
                "{judged} The limits of the study are met up to {} kg: with more, {} in a judged pose.",
                fixed(most.payload_kg, 3),
                most.check
            ),
            _ => format!(
                "{judged} The limits of the study on deflection and lowest mode are met by any payload."
            ),
        },
    })
}

/// Number of payloads below the stated one that are tried if the stated one is too much.
const SMALLER_PAYLOADS: u32 = 16;

/// The payloads that the arm holds in the cases with the indices `cases`, by bisection from the payload that the study
/// states. Only the payload of the cases `vary` changes. The other cases keep their payload, which the arm is known to
/// hold.
fn held_payloads(
    space: &DesignSpace,
    catalogs: &Catalogs,
    options: &[u32],
    cases: &[usize],
    vary: &[usize],
) -> Window {
    let overloaded = |payload_kg: f64| {
        let mut loaded = space.clone();
        for &case in vary {
            loaded.cases[case].payload.mass_kg = payload_kg;
        }
        overload(&loaded, catalogs, options, cases)
    };
    let mut stated_kg: Vec<f64> = vary.iter().map(|&case| space.cases[case].payload.mass_kg).collect();
    stated_kg.sort_by(|a, b| b.total_cmp(a));
    stated_kg.dedup();
    // a drive that the study gives may be too weak for the stated payload and hold a smaller one
    let largest_kg = stated_kg.first().copied().unwrap_or_default();
    stated_kg.extend(
        (0..SMALLER_PAYLOADS).rev().map(|part| largest_kg * f64::from(part) / f64::from(SMALLER_PAYLOADS)),
    );
    match stated_kg.iter().find(|&&payload_kg| overloaded(payload_kg).is_none()) {
        Some(&payload_kg) => window_around(payload_kg, &overloaded),
        None => Window::empty(overloaded(0.0).unwrap_or_default()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reach_of_an_arm_on_a_wall_is_its_whole_distance() {
        let tip_m = Vector3::new(0.9, 0.0, 0.4);
        assert_eq!(reach_m(&tip_m, &-Vector3::z()), 0.9);
        assert_eq!(reach_m(&tip_m, &Vector3::z()), 0.9);
        let on_a_wall_m = reach_m(&tip_m, &Vector3::x());
        assert!((on_a_wall_m - (0.81f64 + 0.16).sqrt()).abs() < 1e-15, "{on_a_wall_m}");
    }
}
