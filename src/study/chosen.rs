//! One design of a study, either named or with links of median mass, and the reason if its drives do not meet the
//! demand.

use super::definition::Study;
use super::gear_remarks::life_remarks;
use super::given_tube_remarks::given_tube_remarks_on;
use super::guide_remarks::guide_remarks_on;
use super::joint_obstacle::{first_fit_at, obstacle_at};
use super::limit::Quantity;
use super::load::refuse_empty;
use super::motor_remarks::{heat_remark_on, stop_remark_on};
use super::reaction_remarks::reaction_remark_on;
use super::refusal::Refusal;
use super::stated_bearing_remarks::stated_bearing_remarks_on;
use super::table::sizing_rows;
use crate::arm::load::LoadCase;
use crate::arm::{Arm, Link};
use crate::catalog::Catalogs;
use crate::sizing::checks::checks;
use crate::sizing::demand::JointDemand;
use crate::sizing::sheet::JointSizingRow;
use crate::space::constraint::Constraints;
use crate::space::design::number_of;
use crate::space::design_space::{DesignSpace, LinkChoice, SpacePiece};
use crate::space::problem::{ArmProblem, Partial};
use crate::space::slot::SizedJoint;

/// The design with this number in the study: the arm with every part resolved to numbers, and the cases in which it is
/// judged. `None` if the study has no such design.
pub(crate) fn arm_of_number(
    study: &Study,
    number: u128,
    catalogs: &Catalogs,
) -> Option<(Arm, Vec<LoadCase>)> {
    let space = study.space.excerpt(catalogs, &[number])?;
    let problem = ArmProblem::new(&space, catalogs);
    let arm = problem.arm(&problem.options_of_whole(number)?)?;
    Some((arm, problem.load_cases()))
}

/// The design with the `design_id` given as `id`: the arm with every part resolved to numbers, and the cases in which
/// it is judged.
///
/// # Errors
/// The study has no design with this id.
pub fn arm_of_design(study: &Study, id: &str, catalogs: &Catalogs) -> Result<(Arm, Vec<LoadCase>), Refusal> {
    let found = number_of(id).and_then(|number| arm_of_number(study, number, catalogs));
    let (arm, cases) = found.ok_or_else(|| no_design(id, study))?;
    Ok((Arm { name: format!("{} {id}", study.name), ..arm }, cases))
}

/// The sizing of every joint of a design, tip first: the rows of `armwright size --json`. Without a `design_id`, the
/// design has links of median mass.
///
/// # Errors
/// The study has nothing to choose from, or no design with this id, or no drive meets the demand at some joint.
pub fn sizing_of(study: &Study, id: Option<&str>, catalogs: &Catalogs) -> Result<Sizing, Refusal> {
    let (space, chosen) = chosen_design(study, id, catalogs)?;
    sizing_in(study, &ArmProblem::new(&space, catalogs), &chosen, catalogs)
}

/// The sizing of the joints of one design.
#[derive(Debug, Clone, PartialEq)]
pub struct Sizing {
    /// The joints with a drive from the catalogs, tip first.
    pub rows: Vec<JointSizingRow>,
    /// Remarks in sentences: on the question, on the lives of the gears, on bearings and guides that the study states,
    /// on what joints hold while others move, and on motors that cannot make the emergency stop of their joint or
    /// would overheat at the representative efficiency of their gears.
    pub remarks: Vec<String>,
}

/// The sizing of the design of `problem` with the options `chosen`, one for each level, tip first. `study` is the study
/// to which the problem belongs.
///
/// # Errors
/// A joint that no drive holds, or a limit that the arm breaks.
pub(crate) fn sizing_in(
    study: &Study,
    problem: &ArmProblem,
    chosen: &[u32],
    catalogs: &Catalogs,
) -> Result<Sizing, Refusal> {
    let rows = sizing_rows(problem, catalogs, chosen)
        .map_err(|slot| why_not_held(problem, chosen, slot, catalogs))?;
    let of_lives = life_remarks(rows.iter().map(|row| row.gear.as_str()), catalogs);
    let of_reactions = reaction_remark_on(problem, catalogs, chosen, "in the sizing cases");
    let of_bearings = stated_bearing_remarks_on(problem, catalogs, chosen);
    let of_guides = guide_remarks_on(problem, chosen);
    let of_tubes = given_tube_remarks_on(problem, chosen);
    let of_study = study.remarks.iter().cloned();
    let of_stops = stop_remark_on(problem, catalogs, chosen, "in the sizing cases");
    let of_motion = of_reactions.into_iter().chain(of_stops).chain(heat_remark_on(&rows));
    let of_structure = of_guides.into_iter().chain(of_tubes);
    let remarks = of_study.chain(of_lives).chain(of_bearings).chain(of_structure).chain(of_motion).collect();
    Ok(Sizing { rows, remarks })
}

/// Largest number of options of a link among which the option of median mass is chosen.
const MOST_OPTIONS: u32 = 4096;

/// A design space and the options of one design in it, one for each open piece, tip first. It is the design with the
/// `design_id` given as `id`, or without an id a design with links of median mass.
///
/// # Errors
/// The study has nothing to choose from, no design with this id, or leaves values of springs or counterweights open.
pub(crate) fn chosen_design(
    study: &Study,
    id: Option<&str>,
    catalogs: &Catalogs,
) -> Result<(DesignSpace, Vec<u32>), Refusal> {
    refuse_empty(study, catalogs)?;
    let Some(id) = id else {
        let space = study.space.middle(MOST_OPTIONS);
        let chosen = middle(&ArmProblem::new(&space, catalogs));
        return Ok((space, chosen));
    };
    let none = || no_design(id, study);
    let number = number_of(id).ok_or_else(none)?;
    let space = study.space.excerpt(catalogs, &[number]).ok_or_else(none)?;
    let chosen = ArmProblem::new(&space, catalogs).options_of_whole(number).ok_or_else(none)?;
    Ok((space, chosen))
}

fn no_design(id: &str, study: &Study) -> Refusal {
    Refusal::Unknown(format!("the study \"{}\" has no design \"{id}\"", study.name))
}

/// The options of a design with links of median mass, tip first: for every open link the option of median mass, and for
/// every joint with `all_fits` the lightest drive that meets the demand.
fn middle(problem: &ArmProblem) -> Vec<u32> {
    let mut out = Vec::new();
    for (piece, what) in problem.space().pieces.iter().enumerate().rev() {
        match (what, problem.sized_joint(piece)) {
            (SpacePiece::Choice(choice), _) => {
                out.push(nearest_to_median(problem, &out, piece, &choice.by_mass()));
            }
            (_, Some(sized)) if sized.is_level() => out.push(first_fit_at(problem, &out, piece)),
            _ => {}
        }
    }
    out
}

/// The option that is nearest to the median one in the order of mass and meets the link's own limits, or the median
/// option if none does. `by_mass` lists the options of the link `piece` from the lightest to the heaviest; `outboard`
/// are the options chosen outboard of it.
fn nearest_to_median(problem: &ArmProblem, outboard: &[u32], piece: usize, by_mass: &[u32]) -> u32 {
    let median = by_mass.len() / 2;
    let mut order: Vec<usize> = (0..by_mass.len()).collect();
    order.sort_by_key(|&rank| rank.abs_diff(median));
    let holds = |&option: &u32| match problem.walk(&[outboard, &[option]].concat(), |_, _| {}) {
        Ok(_) => true,
        Err(slot) => problem.piece_of_slot(slot) != piece,
    };
    order.into_iter().map(|rank| by_mass[rank]).find(holds).unwrap_or(by_mass[median])
}

/// The reason why the options `chosen` give no design. [`ArmProblem::walk`] builds the arm from the tip inward; `slot`
/// is the place at which it ended: a joint whose drive does not hold, or a part with which the arm breaks a limit.
pub(crate) fn why_not_held(
    problem: &ArmProblem,
    chosen: &[u32],
    slot: usize,
    catalogs: &Catalogs,
) -> Refusal {
    let mut last = Partial::default();
    let _ = problem.walk(chosen, |_, partial| last = partial.clone());
    let piece = problem.piece_of_slot(slot);
    let sized = problem.piece_in_slot(slot).and_then(|_| problem.sized_joint(piece));
    let of_drive = sized.and_then(|sized| {
        let demand = problem.demand_at(&last, slot);
        obstacle_at(&sized.table, &demand).or_else(|| too_weak(problem, chosen, piece, sized, &demand))
    });
    Refusal::Infeasible(match of_drive {
        Some(why) => format!("with these links, {why}"),
        None => broken_limits(problem, chosen, slot, catalogs),
    })
}

/// The limits that the arm with the options `chosen` breaks as far as the part in `slot`, in words.
fn broken_limits(problem: &ArmProblem, chosen: &[u32], slot: usize, catalogs: &Catalogs) -> String {
    let limits = &problem.space().constraints;
    let lax = DesignSpace { constraints: Constraints::default(), ..problem.space().clone() };
    let lax = ArmProblem::new(&lax, catalogs);
    let mut built: Option<Partial> = None;
    let whole = lax.walk(chosen, |next, partial| {
        if next > slot && built.is_none() {
            built = Some(partial.clone());
        }
    });
    let arm = built.or(whole.ok());
    let reached = |quantity: Quantity| Some((quantity, quantity.of_part(&lax, arm.as_ref()?)?));
    let broken = Quantity::OF_PARTS.into_iter().filter_map(reached);
    let broken = broken.filter(|(quantity, reached)| quantity.is_broken(limits, *reached));
    let (asked, enough): (Vec<String>, Vec<String>) = broken
        .map(|(quantity, reached)| {
            (quantity.broken_words(limits, reached), quantity.enough_words(limits, reached))
        })
        .unzip();
    let part = match problem.piece_in_slot(slot) {
        Some(SpacePiece::Link(Link { name, .. }) | SpacePiece::Choice(LinkChoice { name, .. })) => {
            format!("link {name}")
        }
        Some(joint) => format!("the arm from the tip to joint {}", joint.name()),
        None => "the arm".into(),
    };
    match asked.is_empty() {
        // a limit that is broken by less than the rounding of its words
        true => format!(
            "{part} breaks a limit on stress, wall slenderness, cost or mass: name another design with --design"
        ),
        false => format!(
            "{part} breaks a limit: {}. Change {}, or name another design with --design",
            asked.join(", and "),
            enough.join(" and ")
        ),
    }
}

/// The reason why the drive chosen at the joint `piece` does not meet `demand`. `None` unless the joint has a choice of
/// drives and another drive would meet the demand.
fn too_weak(
    problem: &ArmProblem,
    chosen: &[u32],
    piece: usize,
    sized: &SizedJoint,
    demand: &JointDemand,
) -> Option<String> {
    let table = &sized.table;
    table.first_fit(demand).filter(|_| sized.is_level())?;
    let is_level = |p: usize| match &problem.space().pieces[p] {
        SpacePiece::Choice(_) => true,
        _ => problem.sized_joint(p).is_some_and(SizedJoint::is_level),
    };
    let outboard = (piece + 1..problem.space().pieces.len()).filter(|&p| is_level(p)).count();
    let drive = table.drive(*chosen.get(outboard)? as usize);
    let failing = checks(&drive, table.motion(), demand).into_iter().find(|check| !check.holds())?;
    Some(format!(
        "joint {joint}: {} with {}, the drive of this design, does not hold: {failing}; `--all-fits {joint}` lists \
         those that do",
        drive.gear.id,
        drive.motor.id,
        joint = table.joint(),
    ))
}
