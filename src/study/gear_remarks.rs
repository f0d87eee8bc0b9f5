//! Remarks on the gears of a result: on lives that rest on a figure which the catalog's row does not have or that are not
//! checked, and on the play that the deflection leaves out.
//!
//! A gear with a play of β (the whole angle between its two stops) leaves the tip loose by β ρ, where ρ is the largest
//! displacement of the tip per radian of the joint in the judged cases: the distance of the tip from the axis, unless
//! the joint drives others.

use super::bearing_remarks::gears_of;
use crate::arm::effect::lost_motion::KIND as LOST_MOTION;
use crate::catalog::Catalogs;
use crate::catalog::gear::{Gear, GearKind};
use crate::catalog::lookup::first_names;
use crate::report::front_table::FrontTable;
use crate::report::number::significant;
use crate::report::picks::{designs, picks};
use crate::space::design_space::{DesignSpace, DriveChoice, SpaceJoint};
use crate::space::station::reaches_m;

/// Largest number of gears that one sentence names.
const MOST_NAMES: usize = 4;
/// Play that moves the tip by less than this fraction of the deflection of every pick is not said.
const LEAST_SHARE: f64 = 0.02;

/// Names of gears, grouped by what is to be said of them, in the order of the first name.
struct ByWords<W>(Vec<(W, Vec<String>)>);

impl<W: PartialEq> ByWords<W> {
    fn add(&mut self, words: W, gear: &Gear) {
        match self.0.iter_mut().find(|(other, _)| *other == words) {
            Some((_, names)) if names.contains(&gear.id) => {}
            Some((_, names)) => names.push(gear.id.clone()),
            None => self.0.push((words, vec![gear.id.clone()])),
        }
    }

    fn sentences(&self, sentence: impl Fn(&W, &str) -> String) -> Vec<String> {
        self.0.iter().map(|(words, names)| sentence(words, &first_names(names, MOST_NAMES))).collect()
    }
}

/// Remarks on the lives of the gears in a front: those of [`life_remarks`] on every gear that some design has at a joint
/// whose drive is checked.
pub(crate) fn life_remarks_on(space: &DesignSpace, catalogs: &Catalogs, front: &FrontTable) -> Vec<String> {
    let is_checked = |joint: &SpaceJoint| !matches!(joint.drive, DriveChoice::Given { motor: None, .. });
    let joints = space.joints().map(|(_, joint)| joint).filter(|joint| is_checked(joint));
    life_remarks(joints.flat_map(|joint| gears_of(front, joint)), catalogs)
}

/// Remarks, in sentences, on the gears with these names: a kind or a life that their rows do not state, so that the usual
/// one stands for it, and a life that is not checked because no row states it.
pub(crate) fn life_remarks<'n>(names: impl Iterator<Item = &'n str>, catalogs: &Catalogs) -> Vec<String> {
    let mut said = ByWords(Vec::new());
    for gear in names.filter_map(|name| catalogs.gear(name).ok()) {
        for words in of_row(gear, catalogs) {
            said.add(words, gear);
        }
    }
    said.sentences(|words, names| format!("{names}: {words}."))
}

/// What is to be said of the kind and the life of a gear, by the cells of its row that are blank.
fn of_row(gear: &Gear, catalogs: &Catalogs) -> Vec<String> {
    let row = catalogs.printed_row(&gear.provenance);
    let is_blank =
        |column: &str| !row.is_empty() && !row.iter().any(|(name, cell)| *name == column && !cell.is_empty());
    // the built-in strain-wave gears leave the column blank and are what it means
    let kind = (gear.kind == GearKind::StrainWave && !gear.provenance.is_built_in() && is_blank("kind"))
        .then(|| "taken as a strain-wave gear (column kind is blank)".to_string());
    let usual_rpm = gear.life.rated_speed_rpm.map_or(String::new(), |rpm| format!(" at {rpm} rpm"));
    let life = match (gear.kind, gear.life.rated_h, is_blank("rated_life_h")) {
        (GearKind::Actuator, None, _) => Some("life not checked: actuators.csv has no column for it".into()),
        (GearKind::Belt, None, true) => Some("life not checked: lacks rated_life_h".into()),
        (_, Some(hours), true) => Some(format!(
            "no rated_life_h in the catalog: the usual {hours} h{usual_rpm} of strain-wave gears stand for it"
        )),
        (GearKind::StrainWave, Some(_), false) if is_blank("rated_life_speed_rpm") => Some(format!(
            "no rated_life_speed_rpm in the catalog: its life is taken as stated{usual_rpm}, as is usual for strain-wave gears"
        )),
        _ => None,
    };
    kind.into_iter().chain(life).collect()
}

/// Remarks, in sentences, on the play of the picks' gears where it moves the tip by more than [`LEAST_SHARE`] of the
/// deflection. A joint at which the study states play itself (effect `lost_motion`) is left out.
pub(crate) fn play_remarks(space: &DesignSpace, catalogs: &Catalogs, front: &FrontTable) -> Vec<String> {
    let picked = picks(&designs(front));
    let judged = space.judged_cases.iter().map(|&i| &space.cases[i]);
    let models_play =
        |joint: &SpaceJoint| space.effects.iter().any(|e| e.effect == LOST_MOTION.name && e.at == joint.name);
    let of_joint = |((_, joint), reach_m): ((usize, &SpaceJoint), f64)| {
        let mut said = ByWords(Vec::new());
        let column = front.column(&format!("{}_gear", joint.name)).filter(|_| !models_play(joint));
        for pick in column.iter().flat_map(|_| &picked) {
            let gear = column.and_then(|column| catalogs.gear(&front.rows[pick.design.row][column]).ok());
            let Some((gear, play)) = gear.and_then(|gear| Some((gear, Play::of(gear)?))) else { continue };
            if play.loose_mm(reach_m) > LEAST_SHARE * pick.design.tip_deflection_mm {
                said.add(play, gear);
            }
        }
        said.sentences(|play, names| {
            format!(
                "{}: {names} with {} arcmin of {}: the tip is loose by up to {} mm from stop to stop, which is not in the \
                 deflection.",
                joint.name,
                play.arcmin,
                play.word,
                significant(play.loose_mm(reach_m), 2)
            )
        })
    };
    space.joints().zip(reaches_m(space, judged)).flat_map(of_joint).collect()
}

/// The play of a gear: the larger of the backlash and the lost motion that its row states.
#[derive(Debug, PartialEq)]
struct Play {
    arcmin: f64,
    word: &'static str,
}

impl Play {
    /// `None` if the row states no play, or none above zero.
    fn of(gear: &Gear) -> Option<Self> {
        let stated = [(gear.backlash_arcmin, "backlash"), (gear.lost_motion_arcmin, "lost motion")];
        let plays = stated.into_iter().filter_map(|(arcmin, word)| Some(Self { arcmin: arcmin?, word }));
        plays.filter(|play| play.arcmin > 0.0).reduce(|a, b| if b.arcmin > a.arcmin { b } else { a })
    }

    /// How far the tip moves from one stop to the other \[mm\], if it moves by `reach_m` \[m\] per radian of the joint.
    fn loose_mm(&self, reach_m: f64) -> f64 {
        1e3 * reach_m * (self.arcmin / 60.0).to_radians()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::json::Document;
    use crate::study::read::read_study;
    use serde_json::{Value, json};

    const GEAR: &str = "TPMF-10-4";

    /// The remarks on the play of a front of one design with [`GEAR`] at a joint 0.5 m away from the tip, whose
    /// deflection is this \[mm\].
    fn remarks(tip_deflection_mm: f64, effects: Value) -> Vec<String> {
        let study = json!({"name": "s", "effects": effects, "poses": [{"pose_deg": [0]}], "chain": [
            {"type": "joint", "name": "j", "axis": [0, 1, 0], "gear": GEAR, "motor": "ILM70x10", "mass_kg": 3},
            {"type": "link", "name": "arm", "vector_m": [0.5, 0, 0], "mass_kg": 1}]});
        let catalogs = Catalogs::builtin();
        let study = read_study(Document::parse("s.json", &study.to_string()).unwrap(), &catalogs).unwrap();
        let columns = ["design_id", "j_gear", "tip_deflection_mm", "mass_kg", "lowest_mode_hz"];
        let row = ["x0".to_string(), GEAR.into(), tip_deflection_mm.to_string(), "4".into(), "20".into()];
        let front = FrontTable { columns: columns.map(String::from).to_vec(), rows: vec![row.to_vec()] };
        play_remarks(&study.space, &catalogs, &front)
    }

    #[test]
    fn play_is_said_where_it_matters_and_is_not_in_the_numbers_already() {
        let arcmin = Catalogs::builtin().gear(GEAR).unwrap().backlash_arcmin.unwrap();
        let loose_mm = 500.0 * (arcmin / 60.0).to_radians();
        let said = remarks(1.0, json!([]));
        let words = format!(
            "j: {GEAR} with {arcmin} arcmin of backlash: the tip is loose by up to {} mm",
            significant(loose_mm, 2)
        );
        assert!(said.len() == 1 && said[0].starts_with(&words), "{words}: {said:?}");
        assert_eq!(remarks(loose_mm / LEAST_SHARE * 1.01, json!([])), [""; 0], "too little to matter");
        let modelled = json!([{"effect": LOST_MOTION.name, "at": "j",
            "parameters": {"half_width_rad": 5e-4, "torque_nm": 1.0}}]);
        assert_eq!(remarks(1.0, modelled), [""; 0]);
    }
}
