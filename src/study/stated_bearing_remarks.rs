//! Remarks on the output bearings of joints whose drives are given and are not checked as a whole. Checks of such a
//! bearing exclude no design, so a reader must be told where it carries too much.

use super::picked::options_of_picks;
use crate::catalog::Catalogs;
use crate::report::front_table::FrontTable;
use crate::report::number::significant;
use crate::sizing::bearing_checks::{BlankRatings, bearing_margin};
use crate::sizing::check::{Check, CheckState};
use crate::space::design_space::SpaceJoint;
use crate::space::problem::ArmProblem;

/// An output bearing, with its checks in the design in which its margin is the smallest.
struct Worst {
    joint: String,
    checks: [Check; 4],
}

impl Worst {
    /// The margin of the bearing; infinite if no check could be made or nothing loads it.
    fn margin(&self) -> f64 {
        bearing_margin(&self.checks).unwrap_or(f64::INFINITY)
    }

    /// The bearing with the checks that it fails, in words; `None` if it fails none.
    fn fails(&self) -> Option<String> {
        let failed = self.checks.iter().filter(|check| check.state == CheckState::Fails);
        let failed: Vec<String> = failed.map(Check::to_string).collect();
        (!failed.is_empty()).then(|| format!("{} ({})", self.joint, failed.join("; ")))
    }
}

/// Sentences on these bearings in the design with the options `chosen`, one for each level, tip first.
pub(super) fn stated_bearing_remarks_on(
    problem: &ArmProblem,
    catalogs: &Catalogs,
    chosen: &[u32],
) -> Vec<String> {
    let mut out = sentences(in_design(problem, catalogs, chosen), "in the sizing cases");
    out.extend(unchecked_bearings(problem, catalogs));
    out
}

/// Sentences on these bearings in the picks of a front.
pub(super) fn stated_bearing_remarks(
    problem: &ArmProblem,
    catalogs: &Catalogs,
    front: &FrontTable,
) -> Vec<String> {
    let picked = options_of_picks(problem, front);
    let all = picked.iter().flat_map(|chosen| in_design(problem, catalogs, chosen));
    let mut out = sentences(all.collect(), "in the sizing cases of the picks");
    out.extend(of_passive_joints(problem));
    out
}

/// Sentences on the bearings of given drives that are not checked, or not in full: those that lack ratings, and those of
/// passive joints.
pub(super) fn unchecked_bearings(problem: &ArmProblem, catalogs: &Catalogs) -> Vec<String> {
    let blank = |(_, joint): (usize, &SpaceJoint)| {
        let bearing = joint.bearing.stated().filter(|_| joint.has_bearing_of_its_own(catalogs))?;
        let whose = format!("the bearing of {}", joint.name);
        Some(format!("Output {}.", BlankRatings::of_stated(bearing)?.words(&[&whose])))
    };
    problem.space().joints().filter_map(blank).chain(of_passive_joints(problem)).collect()
}

/// A sentence that names the passive joints whose stated bearings are not checked; `None` if there are none.
fn of_passive_joints(problem: &ArmProblem) -> Option<String> {
    let is_passive = |joint: &SpaceJoint| joint.coupled.is_some() && joint.bearing.stated().is_some();
    let passive = problem.space().joints().filter(|(_, joint)| is_passive(joint));
    let names: Vec<&str> = passive.map(|(_, joint)| joint.name.as_str()).collect();
    (!names.is_empty())
        .then(|| format!("Output bearing not checked in {}: the joint turns with others.", names.join(", ")))
}

fn in_design(problem: &ArmProblem, catalogs: &Catalogs, chosen: &[u32]) -> Vec<Worst> {
    let mut out = Vec::new();
    // a design that breaks a limit has no remarks
    let _ = problem.walk(chosen, |slot, outboard| {
        let cases = &problem.space().sizing_cases;
        if let Some(checks) = problem.stated_bearing_checks(cases, outboard, slot, catalogs) {
            let joint = problem.space().pieces[problem.piece_of_slot(slot)].name().to_string();
            out.push(Worst { joint, checks });
        }
    });
    out
}

/// Sentences on the bearings `all`, each named in the design with its smallest margin. `whose` are words that
/// say which designs were examined.
fn sentences(all: Vec<Worst>, whose: &str) -> Vec<String> {
    let mut worst: Vec<Worst> = Vec::new();
    for bearing in all {
        match worst.iter_mut().find(|known| known.joint == bearing.joint) {
            Some(known) if bearing.margin() < known.margin() => *known = bearing,
            Some(_) => {}
            None => worst.push(bearing),
        }
    }
    let weak: Vec<String> = worst.iter().filter_map(Worst::fails).collect();
    let of_weak = (!weak.is_empty()).then(|| {
        format!(
            "Output bearings of joints whose drives are given carry too much {whose}: {}. Their checks exclude no design.",
            weak.join("; ")
        )
    });
    let holding = worst.iter().filter(|bearing| bearing.fails().is_none() && bearing.margin().is_finite());
    let holding: Vec<String> = holding
        .map(|bearing| format!("{} (margin {})", bearing.joint, significant(bearing.margin(), 3)))
        .collect();
    let of_holding = (!holding.is_empty()).then(|| {
        format!(
            "Output bearings of joints whose drives are given hold {whose}, as far as they are rated: {}.",
            holding.join(", ")
        )
    });
    of_weak.into_iter().chain(of_holding).collect()
}
