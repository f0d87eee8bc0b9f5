//! Joints that no drive can move, whatever the limits of the study: which check fails, by how much, and what would help.

use super::limit::{short, toward};
use crate::arm::joint_law::Curve;
use crate::catalog::Catalogs;
use crate::sizing::demand::JointDemand;
use crate::sizing::explain::Shortfall;
use crate::sizing::rpm_from_rad_s;
use crate::sizing::select::DriveTable;
use crate::space::design_space::{DesignSpace, DriveChoice, SpacePiece};
use crate::space::problem::{ArmProblem, Partial};
use crate::space::slot::SizedJoint;

/// Most sections of a link that are tried for the one that asks least of a joint.
const MOST_SECTIONS: u32 = 64;

/// Every joint for which no drive holds, from the tip inward, in words. Each is judged with the lightest links, and with
/// the sections of single links that ask least of it. A joint without a drive is taken as rigid and without mass for those
/// inboard of it.
pub(super) fn joint_obstacles(space: &DesignSpace, catalogs: &Catalogs) -> Vec<String> {
    let mut space = few_sections(space);
    let mut found = Vec::new();
    while let Some((piece, words)) = first_obstacle(&space, catalogs) {
        found.push(words);
        match &mut space.pieces[piece] {
            SpacePiece::Joint(joint) => {
                joint.drive =
                    DriveChoice::Given { curve: Curve::Rigid, mass_kg: 0.0, gear: None, motor: None };
                joint.motor_place = None;
            }
            SpacePiece::Prismatic(slide) => slide.drive = None,
            SpacePiece::Link(_) | SpacePiece::Choice(_) => {}
        }
    }
    if found.is_empty() {
        found.push(
            "no single joint stands in the way with the lightest links and drives; `armwright size STUDY --explain JOINT` \
             lists what each asks for"
                .into(),
        );
    }
    found
}

/// The space with at most [`MOST_SECTIONS`] sections for each link, from the lightest to the heaviest.
fn few_sections(space: &DesignSpace) -> DesignSpace {
    let mut out = space.clone();
    for piece in &mut out.pieces {
        if let SpacePiece::Choice(choice) = piece {
            choice.spread(MOST_SECTIONS);
        }
    }
    out.renumber_materials();
    out
}

/// The outermost joint for which no drive holds: its piece, and why.
fn first_obstacle(space: &DesignSpace, catalogs: &Catalogs) -> Option<(usize, String)> {
    let problem = ArmProblem::new(space, catalogs);
    let mut sections = lightest_sections(space);
    loop {
        let stuck = stuck_at(&problem, &sections)?;
        let table = &problem.sized_joint(stuck.piece)?.table;
        if table.is_empty() {
            return Some((stuck.piece, no_legal_drive(table, &stuck.demand)));
        }
        match easier_sections(&problem, &sections, &stuck, table) {
            Ok(further) => sections = further,
            Err(nearest) => {
                let is_lightest = *nearest == stuck.demand;
                let links = if is_lightest {
                    "even with the lightest links"
                } else {
                    "with the links that ask least of it"
                };
                let words = obstacle_at(table, &nearest).unwrap_or_default();
                return Some((stuck.piece, format!("{links}, {words}")));
            }
        }
    }
}

/// The lightest section of every link, by piece; 0 for what is no choice.
fn lightest_sections(space: &DesignSpace) -> Vec<u32> {
    let lightest = |piece: &SpacePiece| match piece {
        SpacePiece::Choice(choice) => choice.by_mass().first().copied().unwrap_or_default(),
        _ => 0,
    };
    space.pieces.iter().map(lightest).collect()
}

/// The first joint on the way inward at which no drive holds.
struct Stuck {
    slot: usize,
    piece: usize,
    demand: JointDemand,
}

/// Builds the arm with these sections and the lightest drives that hold; `None` if all hold.
fn stuck_at(problem: &ArmProblem, sections: &[u32]) -> Option<Stuck> {
    let mut options = Vec::new();
    for (piece, what) in problem.space().pieces.iter().enumerate().rev() {
        match what {
            SpacePiece::Choice(_) => options.push(sections[piece]),
            _ if problem.sized_joint(piece).is_some_and(SizedJoint::is_level) => {
                options.push(first_fit_at(problem, &options, piece));
            }
            _ => {}
        }
    }
    let mut last = Partial::default();
    let slot = problem.walk(&options, |_, arm| last.clone_from(arm)).err()?;
    Some(Stuck { slot, piece: problem.piece_of_slot(slot), demand: problem.demand_at(&last, slot) })
}

/// The lightest drive that holds at a joint behind an arm; the first drive if none holds.
pub(crate) fn first_fit_at(problem: &ArmProblem, outboard: &[u32], piece: usize) -> u32 {
    let mut index = 0;
    let _ = problem.walk(outboard, |slot, arm| {
        if problem.piece_of_slot(slot) == piece
            && let Some(sized) = problem.sized_joint(piece)
        {
            index = sized.table.first_fit(&problem.demand_at(arm, slot)).unwrap_or(0) as u32;
        }
    });
    index
}

/// Sections with which the arm gets further; one link at a time takes each of its sections.
///
/// # Errors
/// The demand to which some drive comes nearest, if no such sections are found.
fn easier_sections(
    problem: &ArmProblem,
    sections: &[u32],
    stuck: &Stuck,
    table: &DriveTable,
) -> Result<Vec<u32>, Box<JointDemand>> {
    let (mut nearest, mut margin) = (stuck.demand, table.nearest_margin(&stuck.demand));
    for (piece, what) in problem.space().pieces.iter().enumerate().skip(stuck.piece) {
        let SpacePiece::Choice(choice) = what else { continue };
        for option in 0..choice.options.len() as u32 {
            let mut other = sections.to_vec();
            other[piece] = option;
            match stuck_at(problem, &other) {
                None => return Ok(other),
                Some(later) if later.slot > stuck.slot => return Ok(other),
                Some(same) if same.slot == stuck.slot => {
                    let of_same = table.nearest_margin(&same.demand);
                    if of_same > margin {
                        (nearest, margin) = (same.demand, of_same);
                    }
                }
                Some(_) => {}
            }
        }
    }
    Err(Box::new(nearest))
}

/// Why no drive is strong enough at a joint, in words; `None` if one is.
pub(crate) fn obstacle_at(table: &DriveTable, demand: &JointDemand) -> Option<String> {
    match table.is_empty() {
        true => Some(no_legal_drive(table, demand)),
        false if table.first_fit(demand).is_some() => None,
        false => Some(
            table
                .smallest_shortfall(demand)
                .map_or_else(|| no_legal_drive(table, demand), |s| in_words(table, &s)),
        ),
    }
}

/// The reason if no drive is legal: none turns the joint fast enough, none fits, or all lack a rating.
fn no_legal_drive(table: &DriveTable, demand: &JointDemand) -> String {
    let joint = table.joint();
    let needed_rad_s = table.motion().speed_rad_s;
    match fastest(table).filter(|(rad_s, _)| *rad_s < needed_rad_s) {
        Some((rad_s, drive)) => format!(
            "joint {joint}: {} rad/s needed, {} allowed by the fastest drive, {drive} (short by {} rad/s); slow \
             the joint to {} rad/s (tip_speed_m_s, min_lever_m, max_speed_rad_s) or widen \"drives\"{}",
            short(needed_rad_s),
            short(rad_s),
            short(needed_rad_s - rad_s),
            toward(rad_s, false),
            missing_words(table),
        ),
        None => table.smallest_shortfall(demand).map_or_else(
            || {
                let missing = table.missing_figures();
                let missing = missing.unwrap_or_else(|| "\"drives\" leaves no gear or no motor".into());
                format!(
                    "joint {joint}: no drive of the catalogs can be checked in full: {missing}; `armwright size STUDY --explain \
                     {joint}` says more"
                )
            },
            |shortfall| in_words(table, &shortfall),
        ),
    }
}

/// A shortfall, and the figures that other parts lack.
fn in_words(table: &DriveTable, shortfall: &Shortfall) -> String {
    format!("{shortfall}{}", missing_words(table))
}

/// The figures that parts lack, as the end of a sentence.
fn missing_words(table: &DriveTable) -> String {
    let missing = table.also_missing_figures();
    missing.map(|missing| format!("; not checked: {missing}")).unwrap_or_default()
}

/// The largest speed that a drive of a table allows \[rad/s\], and the names of the drive.
fn fastest(table: &DriveTable) -> Option<(f64, String)> {
    let pairs = table.gears().iter().flat_map(|gear| table.motors().iter().map(move |motor| (gear, motor)));
    let speeds = pairs.filter(|(gear, motor)| gear.goes_with(motor)).filter_map(|(gear, motor)| {
        let no_limit = gear.kind.has_no_ratings_of_its_own().then_some(f64::INFINITY);
        let input_rpm =
            gear.max_input_speed_rpm.or(no_limit)?.min(motor.max_speed_rpm.or(motor.rated_speed_rpm)?);
        Some((input_rpm / gear.ratio / rpm_from_rad_s(1.0), gear, motor))
    });
    let (rad_s, gear, motor) = speeds.max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some((rad_s, table.pair(gear, motor).name()))
}
