//! The reason why no design meets a study, and the smallest change of its limits that would help. A search and the
//! joining of shards state it if they find no design.

use super::definition::Study;
use super::joint_obstacle::joint_obstacles;
use super::limit::Quantity;
use super::relaxed_limits::{Limited, Relaxation};
use crate::catalog::Catalogs;
use crate::space::constraint::Constraints;
use crate::space::design_space::{DesignSpace, DriveChoice, SpaceJoint, SpacePiece};
use crate::space::joints::TabulatedJoints;
use crate::space::prismatic::SpacePrismatic;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Longest time that is spent on the search for changes of the limits.
const LONGEST: Duration = Duration::from_secs(60);

/// The reason why no design meets the study, in words. If at some joint no drive meets the demand, it names every such
/// joint. Otherwise it names every limit that by itself excludes all designs, with a value that would suffice. If there
/// is no such limit, it names the smallest sets of limits that together exclude all designs.
///
/// This takes several searches. They end at the deadline, after a minute, or when `stop` is set; the words then say
/// so.
pub fn why_infeasible(
    study: &Study,
    catalogs: &Catalogs,
    stop: &AtomicBool,
    deadline: Option<Instant>,
) -> String {
    let latest = Instant::now() + LONGEST;
    let deadline = deadline.map_or(latest, |deadline| deadline.min(latest));
    let joints = TabulatedJoints::new(&study.space, catalogs);
    let designs = study.space.designs_with(&joints);
    let limited = Limited { space: &study.space, catalogs, joints, stop, deadline };
    let without_limits = DesignSpace { constraints: Constraints::default(), ..study.space.clone() };
    let reasons = match study.space.beyond_exact() {
        Some(unknown) => obstacles_alone(&study.space, &without_limits, catalogs, &unknown),
        None => reasons(&limited, &without_limits),
    };
    let head = match designs {
        Some(0) => format!("no design meets the study \"{}\"", study.name),
        Some(designs) => format!("no design of {designs} meets the study \"{}\"", study.name),
        None => format!("no design of more than 1e38 meets the study \"{}\"", study.name),
    };
    format!("{head}\n  {}", reasons.join("\n  "))
}

/// The joints at which no drive meets the demand, in words, and a note that the limits were not examined. It stands in
/// the place of [`reasons`] for a space that the exact search does not cover; `unknown` names the property of the study
/// that it does not cover.
fn obstacles_alone(
    space: &DesignSpace,
    without_limits: &DesignSpace,
    catalogs: &Catalogs,
    unknown: &str,
) -> Vec<String> {
    let mut reasons = joint_obstacles(without_limits, catalogs);
    if space.constraints != Constraints::default() {
        reasons.push(format!(
            "which limits stand in the way is not looked for in a study with {unknown}: leave limits away one by one"
        ));
    }
    reasons
}

/// The reasons why no design is feasible, in words: joints at which no drive meets the demand, or else the limits that
/// exclude all designs. `without_limits` is the space with all limits removed.
fn reasons(limited: &Limited, without_limits: &DesignSpace) -> Vec<String> {
    let catalogs = limited.catalogs;
    match limited.holds_without_limits() {
        Some(true) => limits_in_the_way(limited),
        Some(false) => joint_obstacles(without_limits, catalogs),
        None => {
            let mut reasons = joint_obstacles(without_limits, catalogs);
            reasons.push(OUT_OF_TIME.into());
            reasons
        }
    }
}

const OUT_OF_TIME: &str = "the search for the smallest relaxation was stopped before it was done; a smaller one, or \
                           another, may help too";

/// The limits that have to be changed so that a design is feasible, in words.
fn limits_in_the_way(limited: &Limited) -> Vec<String> {
    let constraints = &limited.space.constraints;
    let (relaxations, is_all) = limited.relaxations();
    let mut reasons: Vec<String> = relaxations.iter().map(|r| relaxation_words(r, constraints)).collect();
    if reasons.is_empty() && is_all {
        // no limit excludes all designs by more than rounding, and yet no design meets all limits at once
        reasons
            .push("every limit is within the rounding of what a design reaches; relax one a little".into());
    }
    if !is_all || relaxations.iter().any(|r| !r.is_smallest) {
        reasons.push(OUT_OF_TIME.into());
    }
    reasons
}

/// The amount that is missing at each limit of a relaxation, and the values of the limits that suffice, in words.
fn relaxation_words(relaxation: &Relaxation, constraints: &Constraints) -> String {
    let words = |(quantity, reached): &(Quantity, f64)| {
        let missing = quantity.shortfall_words(constraints, *reached);
        (missing, quantity.enough_words(constraints, *reached))
    };
    let (missing, enough): (Vec<_>, Vec<_>) = relaxation.limits.iter().map(words).unzip();
    let together = match relaxation.limits.len() {
        1 => "",
        _ => "no fewer limits stand in the way than these together: ",
    };
    format!("{together}{}; relaxing {} is enough", missing.join("; "), enough.join(" and "))
}

/// The pieces for which the study leaves no option, in words; empty if every piece has one.
pub fn empty_pieces(space: &DesignSpace, catalogs: &Catalogs) -> Vec<String> {
    let words = |piece: &SpacePiece| match piece {
        SpacePiece::Choice(choice) if choice.options.is_empty() => Some(format!(
            "link {}: no section has a wall under half its outer size (all sizes are in mm), or no profile is sold in these \
             materials; change its \"sections\" or \"materials\"",
            choice.name
        )),
        SpacePiece::Joint(joint) => no_drive_offered(joint, catalogs),
        SpacePiece::Prismatic(slide) => no_motor_offered(slide, catalogs),
        _ => None,
    };
    space.pieces.iter().filter_map(words).collect()
}

/// Largest number of pairs of gear and motor of all joints together. The tables of so many pairs take about a gigabyte
/// of memory.
const MOST_PAIRS: usize = 3_000_000;

/// The reason why a space is too large to compute, in words; `None` if it is not.
pub(crate) fn too_large(space: &DesignSpace, catalogs: &Catalogs) -> Option<String> {
    let pairs = space.pieces.iter().filter_map(|piece| match piece {
        SpacePiece::Joint(joint) => {
            parts_offered(joint, catalogs).map(|[gears, motors]| gears.saturating_mul(motors))
        }
        _ => None,
    });
    let pairs = pairs.fold(0, usize::saturating_add);
    (pairs > MOST_PAIRS).then(|| {
        format!("the joints have {pairs} pairs of gear and motor to choose from, and the limit is {MOST_PAIRS}; narrow \"drives\"")
    })
}

/// Number of gears and number of motors that a joint may use; `None` if its drive is given.
fn parts_offered(joint: &SpaceJoint, catalogs: &Catalogs) -> Option<[usize; 2]> {
    let (DriveChoice::FirstFit(filter) | DriveChoice::AllFits(filter)) = &joint.drive else { return None };
    let gears = catalogs.gears.iter().filter(|gear| filter.allows_gear(gear));
    let motors = catalogs.motors.iter().filter(|motor| filter.allows_motor(motor));
    Some([gears.count(), motors.count()])
}

/// A message if the study leaves no motor for the drive of the rail `slide`; otherwise `None`.
fn no_motor_offered(slide: &SpacePrismatic, catalogs: &Catalogs) -> Option<String> {
    let drive = slide.drive.as_ref()?;
    let offered = catalogs.motors.iter().any(|motor| drive.motors.allows_motor(motor));
    (!offered)
        .then(|| format!("joint {}: \"drives\" leaves no motor of the catalogs; widen it", slide.joint.name))
}

/// A message if the study leaves no gear or no motor for the drive of `joint`; otherwise `None`.
fn no_drive_offered(joint: &SpaceJoint, catalogs: &Catalogs) -> Option<String> {
    let [gears, motors] = parts_offered(joint, catalogs)?;
    (gears == 0 || motors == 0).then(|| {
        format!(
            "joint {}: \"drives\" leaves {gears} gears and {motors} motors of the catalogs; widen it",
            joint.name
        )
    })
}
