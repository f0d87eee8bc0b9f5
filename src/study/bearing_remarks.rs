//! Remarks on output bearings of a front that are overloaded or could not be checked. They are printed with the
//! front.

use crate::arm::bearing::BearingSource;
use crate::catalog::Catalogs;
use crate::report::front_table::FrontTable;
use crate::report::words::capital;
use crate::sizing::bearing_checks::{BlankRatings, RigidBearing};
use crate::space::design_space::{DesignSpace, DriveChoice, SpaceJoint, SpacePiece};

/// Largest number of names in one sentence.
const MOST_NAMES: usize = 4;

/// Names of bearings, grouped by what they lack: certain ratings, or a tilting stiffness. Each entry is what is
/// lacking, with the names of the bearings that lack it, in the order of the chain.
struct ByLack<L>(Vec<(L, Vec<String>)>);

impl<L: PartialEq> ByLack<L> {
    fn add(&mut self, blank: L, whose: String) {
        match self.0.iter_mut().find(|(other, _)| *other == blank) {
            Some((_, names)) if names.contains(&whose) => {}
            Some((_, names)) => names.push(whose),
            None => self.0.push((blank, vec![whose])),
        }
    }

    fn sentences(&self, words: impl Fn(&L, &[&str]) -> String) -> Vec<String> {
        let sentence = |(blank, names): &(L, Vec<String>)| {
            let more = format!("and {} more", names.len().saturating_sub(MOST_NAMES));
            let mut whose: Vec<&str> = names.iter().take(MOST_NAMES).map(String::as_str).collect();
            whose.extend((names.len() > MOST_NAMES).then_some(more.as_str()));
            format!("{}.", words(blank, &whose))
        };
        self.0.iter().map(sentence).collect()
    }
}

/// Remarks on the output bearings of the designs of a front, in sentences. They name three kinds of bearings: those that
/// count as rigid because no stiffness is known; those that lack ratings; and those of drives that are given by the
/// names of gear and motor and overload them.
pub(crate) fn bearing_remarks(space: &DesignSpace, catalogs: &Catalogs, front: &FrontTable) -> Vec<String> {
    let joints = || {
        space.pieces.iter().filter_map(|piece| match piece {
            SpacePiece::Joint(joint) => Some(joint),
            _ => None,
        })
    };
    let rigid = rigid(joints(), catalogs, front).sentences(|rigid, whose| capital(&rigid.words(whose)));
    let blank = unchecked(joints(), catalogs, front)
        .sentences(|blank, whose| format!("Output {}", blank.words(whose)));
    rigid.into_iter().chain(blank).chain(joints().filter_map(|joint| overloaded(joint, front))).collect()
}

/// A remark if the output bearing of a given drive is overloaded in some design of the front, which is possible because
/// the checks of a given drive exclude no design. `None` if it is overloaded in none.
fn overloaded(joint: &SpaceJoint, front: &FrontTable) -> Option<String> {
    let margins = front.numbers(&format!("{}_bearing_margin", joint.name)).into_iter().flatten();
    let margins: Vec<f64> = margins.filter(|margin| *margin < 1.0).collect();
    let least = margins.iter().copied().reduce(f64::min)?;
    Some(format!(
        "The output bearing of {} carries too much in {} of {} designs of the front, down to a margin of {least:.2}: its drive \
         is given, so that its checks exclude nothing.",
        joint.name,
        margins.len(),
        front.rows.len(),
    ))
}

/// The bearings of `joints` that lack ratings in some design of the front, so that a check could not be made.
fn unchecked<'s>(
    joints: impl Iterator<Item = &'s SpaceJoint>,
    catalogs: &Catalogs,
    front: &FrontTable,
) -> ByLack<BlankRatings> {
    let mut unchecked = ByLack(Vec::new());
    for joint in joints {
        match &joint.drive {
            DriveChoice::FirstFit(filter) | DriveChoice::AllFits(filter) => {
                for gear in gears_of(front, joint).filter_map(|id| catalogs.gear(id).ok()) {
                    if let Some(blank) = BlankRatings::of(&joint.bearing, gear, filter.gear_mass) {
                        let is_stated = joint.bearing.stated().is_some();
                        let whose = if is_stated { bearing_of(joint) } else { gear.id.clone() };
                        unchecked.add(blank, whose);
                    }
                }
            }
            DriveChoice::Given { gear, .. } => {
                let gear = gear.as_ref().and_then(|gear| catalogs.gear(gear).ok());
                let blank = joint.bearing.stated().and_then(|bearing| BlankRatings::of_given(&bearing, gear));
                if let Some((blank, whose)) = blank {
                    unchecked.add(blank, whose.map_or_else(|| bearing_of(joint), String::from));
                }
            }
        }
    }
    unchecked
}

/// The bearings that count as rigid, because their tilting stiffness is not known.
fn rigid<'s>(
    joints: impl Iterator<Item = &'s SpaceJoint>,
    catalogs: &Catalogs,
    front: &FrontTable,
) -> ByLack<RigidBearing> {
    let mut rigid = ByLack(Vec::new());
    for joint in joints {
        match (&joint.drive, joint.bearing) {
            (DriveChoice::FirstFit(filter) | DriveChoice::AllFits(filter), BearingSource::OfGear) => {
                for gear in gears_of(front, joint).filter_map(|id| catalogs.gear(id).ok()) {
                    let of_gear = RigidBearing::of(&joint.bearing, gear, filter.gear_mass);
                    of_gear.into_iter().for_each(|bearing| rigid.add(bearing, gear.id.clone()));
                }
            }
            (drive, BearingSource::Stated(Some(bearing))) => {
                let gear = match drive {
                    DriveChoice::Given { gear: Some(gear), .. } => catalogs.gear(gear).ok(),
                    _ => None,
                };
                if let Some((given, whose)) = RigidBearing::of_given(&bearing, gear) {
                    rigid.add(given, whose.map_or_else(|| bearing_of(joint), String::from));
                }
            }
            _ => {}
        }
    }
    rigid
}

fn bearing_of(joint: &SpaceJoint) -> String {
    format!("the bearing of {}", joint.name)
}

/// Names of the gears that the designs of a front have at a joint, each once.
pub(super) fn gears_of<'f>(
    front: &'f FrontTable,
    joint: &SpaceJoint,
) -> impl Iterator<Item = &'f str> + use<'f> {
    let column = front.column(&format!("{}_gear", joint.name));
    let mut ids: Vec<&str> =
        column.map_or(Vec::new(), |c| front.rows.iter().map(|row| row[c].as_str()).collect());
    ids.sort_unstable();
    ids.dedup();
    ids.into_iter()
}
