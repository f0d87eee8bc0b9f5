//! Why no design meets what is asked, and the smallest relaxation that would help.

use super::{Study, StudyOutcome};
use crate::catalog::Catalogs;
use crate::search::OutwardIn;
use crate::search::outward::{ArmProblem, Partial};
use crate::search::space::SpacePiece;
use std::fmt::Write;

/// The reason in words: the constraint that is missed most nearly, or the joint that no drive holds.
pub fn why_infeasible(study: &Study, catalogs: &Catalogs, outcome: &StudyOutcome) -> String {
    let total = outcome.sweep.designs_total;
    let mut text = format!("no design of {total} meets the study \"{}\"", study.name);
    let constraints = &study.space.constraints;
    let mut found = false;
    let limits = [
        ("tip deflection", "mm", constraints.tip_deflection_max_m.map(|m| m * 1e3), "tip_deflection_max_mm"),
        ("mass", "kg", constraints.mass_max_kg, "mass_max_kg"),
        (
            "lowest mode",
            "Hz",
            Some(constraints.required_mode_hz()),
            "lowest_mode_min_hz or servo_bandwidth_hz",
        ),
    ];
    for ((name, unit, limit, key), best) in limits.into_iter().zip(outcome.sweep.near_misses) {
        let (Some(limit), Some(best)) = (limit, best) else { continue };
        let reached = if unit == "mm" { best * 1e3 } else { best.abs() };
        found = true;
        let _ = write!(
            text,
            "\n  {name}: {limit:.4} {unit} asked, {reached:.4} {unit} reached by designs that meet all else \
             (short by {:.2} %); relaxing \"{key}\" to {reached:.4} is enough",
            100.0 * (reached / limit - 1.0).abs()
        );
    }
    if !found {
        let problem = ArmProblem::new(&study.space, catalogs);
        let _ = write!(text, "\n  {}", first_obstacle(&problem));
    }
    text
}

/// Follows the lightest option at every level until the arm cannot go on.
fn first_obstacle(problem: &ArmProblem) -> String {
    let lightest = lightest_options(problem);
    let mut last: Option<Partial> = None;
    let Err(slot) = problem.walk(&lightest, |_, partial| last = Some(partial.clone())) else {
        return "several limits work against each other: each design that meets one breaks at least two others; \
                relax the tightest of them"
            .into();
    };
    let piece = problem.piece_of_slot(slot);
    let partial = last.unwrap_or_default();
    match (&problem.space().pieces[piece], problem.sized_joint(piece)) {
        (SpacePiece::Joint(joint), Some(sized)) if sized.table.is_empty() => format!(
            "joint {}: no drive of the catalogs is fast enough at {:.2} rad/s with all figures known; slow the joint \
             (tip_speed_m_s, min_lever_m, max_speed_rad_s) or widen \"drives\"",
            joint.name,
            sized.table.motion().speed_rad_s
        ),
        (SpacePiece::Joint(joint), Some(sized)) => {
            let demand = problem.demand_at(&partial, slot);
            match sized.table.smallest_shortfall(&demand) {
                Some(shortfall) => format!("even with the lightest links, {shortfall}"),
                None => format!(
                    "joint {}: with the lightest links a drive holds, but the arm exceeds mass_max_kg = {} kg there",
                    joint.name,
                    problem.space().constraints.mass_max_kg.unwrap_or_default()
                ),
            }
        }
        (SpacePiece::Choice(choice), _) => format!(
            "link {}: its lightest section breaks a limit on stress, wall slenderness, material cost or mass; offer \
             larger sections or relax that limit",
            choice.name
        ),
        _ => "the arm exceeds mass_max_kg before its base is reached".into(),
    }
}

/// The lightest option a level that keeps within the wall-slenderness limit.
fn lightest_options(problem: &ArmProblem) -> Vec<u32> {
    let space = problem.space();
    let slenderest = space.constraints.wall_slenderness_max.unwrap_or(f64::INFINITY);
    let mut out: Vec<u32> = space
        .pieces
        .iter()
        .enumerate()
        .rev()
        .filter_map(|(i, piece)| match piece {
            SpacePiece::Choice(choice) => choice
                .options
                .iter()
                .enumerate()
                .filter(|(_, o)| o.wall_slenderness() <= slenderest)
                .min_by(|(_, a), (_, b)| a.mass_kg_per_m().total_cmp(&b.mass_kg_per_m()))
                .map(|(k, _)| k as u32)
                .or(Some(0)),
            SpacePiece::Joint(_) => problem.sized_joint(i).filter(|s| s.is_level()).map(|_| 0),
            SpacePiece::Link(_) => None,
        })
        .collect();
    out.resize(problem.level_sizes().len(), 0);
    out
}
