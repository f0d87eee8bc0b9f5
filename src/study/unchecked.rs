//! Output bearings of a front that could not be checked, so that it can be said beside the front.

use crate::catalog::Catalogs;
use crate::report::front_table::FrontTable;
use crate::sizing::bearing_checks::BlankRatings;
use crate::space::design_space::{DesignSpace, DriveChoice, SpaceJoint, SpacePiece};

/// The most names in one sentence.
const MOST_NAMES: usize = 4;

/// Bearings by what they lack, in the order of the chain.
#[derive(Default)]
struct Unchecked(Vec<(BlankRatings, Vec<String>)>);

impl Unchecked {
    fn add(&mut self, blank: BlankRatings, whose: String) {
        match self.0.iter_mut().find(|(other, _)| *other == blank) {
            Some((_, names)) if names.contains(&whose) => {}
            Some((_, names)) => names.push(whose),
            None => self.0.push((blank, vec![whose])),
        }
    }

    fn sentences(&self) -> Vec<String> {
        let sentence = |(blank, names): &(BlankRatings, Vec<String>)| {
            let more = format!("and {} more", names.len().saturating_sub(MOST_NAMES));
            let mut whose: Vec<&str> = names.iter().take(MOST_NAMES).map(String::as_str).collect();
            whose.extend((names.len() > MOST_NAMES).then_some(more.as_str()));
            format!("Output {}.", blank.words(&whose))
        };
        self.0.iter().map(sentence).collect()
    }
}

/// The output bearings of the designs of a front whose ratings are blank, and those of joints whose drive is given without
/// the names of both parts, in sentences.
pub(crate) fn unchecked_bearings(
    space: &DesignSpace,
    catalogs: &Catalogs,
    front: &FrontTable,
) -> Vec<String> {
    let mut unchecked = Unchecked::default();
    let mut unnamed: Vec<&str> = Vec::new();
    for piece in &space.pieces {
        let SpacePiece::Joint(joint) = piece else { continue };
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
            DriveChoice::Given { gear: Some(_), motor: Some(_), .. } => {
                let blank = joint.bearing.stated().and_then(BlankRatings::of_stated);
                blank.into_iter().for_each(|blank| unchecked.add(blank, bearing_of(joint)));
            }
            DriveChoice::Given { .. } => unnamed.extend(joint.bearing.stated().map(|_| joint.name.as_str())),
        }
    }
    let mut out = unchecked.sentences();
    if !unnamed.is_empty() {
        out.push(format!(
            "Output bearing not checked in {}: the drive is given without the names of gear and motor.",
            unnamed.join(", ")
        ));
    }
    out
}

fn bearing_of(joint: &SpaceJoint) -> String {
    format!("the bearing of {}", joint.name)
}

/// The gears that the designs of a front have at a joint.
fn gears_of<'f>(front: &'f FrontTable, joint: &SpaceJoint) -> impl Iterator<Item = &'f str> {
    let column = front.column(&format!("{}_gear", joint.name));
    let mut ids: Vec<&str> =
        column.map_or(Vec::new(), |c| front.rows.iter().map(|row| row[c].as_str()).collect());
    ids.sort_unstable();
    ids.dedup();
    ids.into_iter()
}
