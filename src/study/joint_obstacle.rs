//! Joints at which no drive meets the demand, whatever the limits of the study: the failing check, by how much it
//! fails, and what would help.

use super::limit::{rounded_down, short};
use crate::arm::joint_law::Curve;
use crate::catalog::Catalogs;
use crate::catalog::gear::{Gear, GearKind, GearMass};
use crate::sizing::check::WITH_ROUNDING;
use crate::sizing::demand::JointDemand;
use crate::sizing::explain::Shortfall;
use crate::sizing::rpm_from_rad_s;
use crate::sizing::select::DriveTable;
use crate::space::design_space::{DesignSpace, DriveChoice, SpacePiece};
use crate::space::problem::{ArmProblem, Partial};
use crate::space::slot::SizedJoint;

/// Largest number of actuators that a message names.
const MOST_NAMED: usize = 4;
/// Largest number of sections of a link that are tried to find the one with which the demand on a joint is least.
const MOST_SECTIONS: u32 = 64;

/// Messages for every joint at which no drive meets the demand, from the tip inward. Each joint is examined with the
/// lightest links. Then links are given other sections one at a time, to find those with which the demand on the joint
/// is least. While the joints inboard of it are examined, a joint without a drive is taken as rigid, with the least mass
/// that a drive of the study has there. So every message is true of any drive.
pub(super) fn joint_obstacles(space: &DesignSpace, catalogs: &Catalogs) -> Vec<String> {
    let mut space = few_sections(space);
    let mut found = Vec::new();
    while let Some(Obstacle { piece, words, least_kg }) = first_obstacle(&space, catalogs) {
        found.push(words);
        match &mut space.pieces[piece] {
            SpacePiece::Joint(joint) => {
                joint.drive =
                    DriveChoice::Given { curve: Curve::Rigid, mass_kg: least_kg, gear: None, motor: None };
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

/// The space with at most [`MOST_SECTIONS`] sections for each link, spread from the lightest to the heaviest.
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

/// A joint at which no drive meets the demand.
struct Obstacle {
    /// Index of the joint among the pieces of the arm.
    piece: usize,
    /// The reason, in words.
    words: String,
    /// Least mass of a drive at the joint, without a motor that stands elsewhere \[kg\]; 0 if the joint has no legal drive.
    least_kg: f64,
}

/// The outermost joint at which no drive meets the demand; `None` if every joint gets a drive.
fn first_obstacle(space: &DesignSpace, catalogs: &Catalogs) -> Option<Obstacle> {
    let problem = ArmProblem::new(space, catalogs);
    let mut sections = lightest_sections(space);
    loop {
        let stuck = stuck_at(&problem, &sections)?;
        let sized = problem.sized_joint(stuck.piece)?;
        let table = &sized.table;
        if table.is_empty() {
            let advice = passage_advice(table, catalogs);
            let words = no_legal_drive(table, &stuck.demand) + &advice;
            return Some(Obstacle { piece: stuck.piece, words, least_kg: 0.0 });
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
                let words = format!("{links}, {words}");
                return Some(Obstacle { piece: stuck.piece, words, least_kg: sized.least_kg_at_joint() });
            }
        }
    }
}

/// Index of the lightest section of every link, by piece; 0 for pieces that are no open link.
fn lightest_sections(space: &DesignSpace) -> Vec<u32> {
    let lightest = |piece: &SpacePiece| match piece {
        SpacePiece::Choice(choice) => choice.by_mass().first().copied().unwrap_or_default(),
        _ => 0,
    };
    space.pieces.iter().map(lightest).collect()
}

/// The first joint, from the tip inward, at which no drive meets the demand, with this demand.
struct Stuck {
    slot: usize,
    piece: usize,
    demand: JointDemand,
}

/// Builds the arm with the given sections (one index for each piece) and, at each joint, the lightest drive that meets
/// the demand. Returns the joint at which no drive does; `None` if every joint gets a drive.
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

/// Index of the lightest drive that meets the demand at the joint `piece`; 0 if no drive does. `outboard` are the
/// options of the pieces outboard of the joint, tip first.
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

/// Sections with which the joint at which the arm is `stuck` gets a drive, so that the arm can be built further inward.
/// Starting from the arm with `sections`, one link outboard of the joint at a time is given each of its other sections.
///
/// # Errors
/// No such sections were found. The error is a demand on this joint: of all demands that were tried, a drive comes
/// nearest to meeting this one.
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

/// The reason why no drive of a table meets `demand`, in words; `None` if a drive does.
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

/// The reason if the table has no legal drive: none is fast enough, none fits, or all lack a rating.
fn no_legal_drive(table: &DriveTable, demand: &JointDemand) -> String {
    let joint = table.joint();
    let needed = table.motion().speed_rad_s;
    let (unit, keys) = match table.gears().iter().any(|gear| gear.kind.slides()) {
        true => ("m/s", "tip_speed_m_s, max_speed_m_s"),
        false => ("rad/s", "tip_speed_m_s, min_lever_m, max_speed_rad_s"),
    };
    match fastest(table).filter(|(speed, _)| *speed * WITH_ROUNDING < needed) {
        Some((speed, drive)) => format!(
            "joint {joint}: {} {unit} needed, {} allowed by the fastest drive, {drive} (short by {} {unit}); slow \
             the joint to {} {unit} ({keys}) or widen \"drives\"{}",
            short(needed),
            short(speed),
            short(needed - speed),
            rounded_down(speed),
            missing_words(table),
        ),
        None => table.smallest_shortfall(demand).map_or_else(
            || {
                let missing = table.missing_figures().map(|missing| missing + OWN_CATALOG);
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

/// The shortfall of the drive that comes nearest to meeting the demand, in words, followed by the ratings that other
/// parts lack.
fn in_words(table: &DriveTable, shortfall: &Shortfall) -> String {
    format!("{shortfall}{}", missing_words(table))
}

/// The ratings that parts lack and where to state them, as the end of a sentence; empty if none are missing.
fn missing_words(table: &DriveTable) -> String {
    let missing = table.also_missing_figures();
    missing.map(|missing| format!("; not checked: {missing}{OWN_CATALOG}")).unwrap_or_default()
}

/// The end of a sentence that says where to state a rating that the catalogs lack.
const OWN_CATALOG: &str = " (state what you know of them in a catalog of your own, --catalogs DIR)";

/// The end of a sentence on cables. It names actuators of the catalogs that leave the passage for cables which the
/// study asks for, and that the study does not allow yet. Empty if there are none, or if the study asks for no passage.
fn passage_advice(table: &DriveTable, catalogs: &Catalogs) -> String {
    let fit = &table.motion().fit;
    if fit.cable_bore_min_m.is_none() {
        return String::new();
    }
    let is_offered = |gear: &Gear| table.gears().iter().any(|offered| offered.id == gear.id);
    let passes = |gear: &&Gear| {
        let own = catalogs.motors.iter().find(|motor| gear.goes_with(motor));
        gear.kind == GearKind::Actuator
            && gear.envelope.hollow_bore_m.is_some()
            && gear.lacks(GearMass::HousedUnit).is_empty()
            && own
                .is_some_and(|motor| motor.lacks().is_empty() && fit.allows(&gear.envelope, &motor.envelope))
            && !is_offered(gear)
    };
    let names: Vec<String> = catalogs.gears.iter().filter(passes).map(|gear| gear.id.clone()).collect();
    let named = &names[..names.len().min(MOST_NAMED)];
    let more = match names.len() - named.len() {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    match names.is_empty() {
        true => String::new(),
        false => format!(
            "; the catalogs have actuators with such a passage, which \"drives\" can offer: \"actuators\": [\"{}\"]{more}",
            named.join("\", \"")
        ),
    }
}

/// The largest joint speed that any pair of gear and motor allows \[rad/s\], and the names of this pair; `None` if no
/// pair has both speeds stated.
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
