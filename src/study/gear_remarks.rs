//! Remarks on the gears of a result. They name lives that come from a usual value because the row of the catalog states
//! none, lives that are not checked, and the play that the deflection leaves out.
//!
//! The play β of a gear is the whole angle between its two stops. It leaves the tip loose by β ρ, where ρ is the
//! largest displacement of the tip per radian of the joint in the judged cases. Unless the joint drives other joints, ρ
//! is the distance of the tip from the axis. A screw or rack leaves the tip loose by its own play along the travel.

use super::bearing_remarks::gears_of;
use crate::arm::effect::lost_motion::KIND as LOST_MOTION;
use crate::catalog::Catalogs;
use crate::catalog::gear::{Gear, GearKind};
use crate::catalog::lookup::first_names;
use crate::report::front_table::FrontTable;
use crate::report::number::significant;
use crate::report::picks::{Pick, designs, picks};
use crate::space::design_space::{DesignSpace, DriveChoice, SpaceJoint, SpacePiece};
use crate::space::station::reaches_m;

/// Largest number of gears that one sentence names.
const MOST_NAMES: usize = 4;
/// Play is not reported if it moves the tip by less than this fraction of the deflection of every pick.
const LEAST_SHARE: f64 = 0.02;

/// Lists of names of gears. Each list has the gears on which the same remark is made. The lists are in the order of
/// their first names.
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

/// Remarks on the kind and the life of the gears in a front (see [`life_remarks`]): of every gear that some design has
/// at a joint whose drive is checked.
pub(crate) fn life_remarks_on(space: &DesignSpace, catalogs: &Catalogs, front: &FrontTable) -> Vec<String> {
    let is_checked = |joint: &SpaceJoint| !matches!(joint.drive, DriveChoice::Given { motor: None, .. });
    let joints = space.joints().map(|(_, joint)| joint).filter(|joint| is_checked(joint));
    life_remarks(joints.flat_map(|joint| gears_of(front, joint)), catalogs)
}

/// Remarks, in sentences, on those of the gears with these names whose kind or life is uncertain. The rows of these
/// gears leave the kind or the life blank. A remark says which usual value is taken for a blank cell, or that the life
/// is not checked because no usual value exists.
pub(crate) fn life_remarks<'n>(names: impl Iterator<Item = &'n str>, catalogs: &Catalogs) -> Vec<String> {
    let mut said = ByWords(Vec::new());
    for gear in names.filter_map(|name| catalogs.gear(name).ok()) {
        for words in of_row(gear, catalogs) {
            said.add(words, gear);
        }
    }
    said.sentences(|words, names| format!("{names}: {words}."))
}

/// The remarks on the kind and the life of one gear, which follow from the blank cells of its row; empty if no needed
/// cell is blank.
fn of_row(gear: &Gear, catalogs: &Catalogs) -> Vec<String> {
    let row = catalogs.printed_row(&gear.provenance);
    let is_blank =
        |column: &str| !row.is_empty() && !row.iter().any(|(name, cell)| *name == column && !cell.is_empty());
    // a blank cell means a strain-wave gear; every built-in row with a blank cell is one, but a user may have forgotten
    // to state another kind
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

/// Remarks, in sentences, on the play of the picks' gears, screws and racks where it moves the tip by more than
/// [`LEAST_SHARE`] of the deflection. A joint at which the study states play itself (effect `lost_motion`) is left out.
pub(crate) fn play_remarks(space: &DesignSpace, catalogs: &Catalogs, front: &FrontTable) -> Vec<String> {
    let picked = picks(&designs(front));
    let judged = space.judged_cases.iter().map(|&i| &space.cases[i]);
    let models_play =
        |joint: &SpaceJoint| space.effects.iter().any(|e| e.effect == LOST_MOTION.name && e.at == joint.name);
    let of_joint = |((_, joint), reach_m): ((usize, &SpaceJoint), f64)| {
        let gear = |name: &str| catalogs.gear(name).ok();
        said_of(&joint.name, reach_m, &picked, front, gear)
    };
    let of_rail = |piece: &SpacePiece| {
        let SpacePiece::Prismatic(rail) = piece else { return Vec::new() };
        let Some(drive) = &rail.drive else { return Vec::new() };
        // the tip travels exactly as far as the rail, so its displacement is 1 m per metre of travel
        said_of(&rail.joint.name, 1.0, &picked, front, |name| drive.gears.iter().find(|gear| gear.id == name))
    };
    let joints = space.joints().zip(reaches_m(space, judged)).filter(|((_, joint), _)| !models_play(joint));
    joints.flat_map(of_joint).chain(space.pieces.iter().flat_map(of_rail)).collect()
}

/// The remarks on the play of the gears that the picks have at one joint. `reach_m` is the displacement of the tip per
/// radian of the joint \[m\], or per metre of a rail \[-\]. `gear` finds a gear by its name.
fn said_of<'g>(
    joint: &str,
    reach_m: f64,
    picked: &[Pick],
    front: &FrontTable,
    gear: impl Fn(&str) -> Option<&'g Gear>,
) -> Vec<String> {
    let Some(column) = front.column(&format!("{joint}_gear")) else { return Vec::new() };
    let mut said = ByWords(Vec::new());
    for pick in picked {
        let gear = gear(&front.rows[pick.design.row][column]);
        let Some((gear, play)) = gear.and_then(|gear| Some((gear, Play::of(gear)?))) else { continue };
        if play.loose_mm(reach_m) > LEAST_SHARE * pick.design.tip_deflection_mm {
            said.add(play, gear);
        }
    }
    said.sentences(|play, names| {
        format!(
            "{joint}: {names} with {} of {}: the tip is loose by up to {} mm from stop to stop, which is not in the deflection.",
            play.amount(),
            play.word,
            significant(play.loose_mm(reach_m), 2)
        )
    })
}

/// The play of a gear: the larger of the backlash and the lost motion that its row states.
#[derive(Debug, PartialEq)]
struct Play {
    /// The play as an angle \[arcmin\]. For a screw or rack it is a travel, converted as if a metre were a radian.
    arcmin: f64,
    word: &'static str,
    slides: bool,
}

impl Play {
    /// `None` if the row states no play, or none above zero.
    fn of(gear: &Gear) -> Option<Self> {
        let slides = gear.kind.slides();
        let stated = [(gear.backlash_arcmin, "backlash"), (gear.lost_motion_arcmin, "lost motion")];
        let plays =
            stated.into_iter().filter_map(|(arcmin, word)| Some(Self { arcmin: arcmin?, word, slides }));
        plays.filter(|play| play.arcmin > 0.0).reduce(|a, b| if b.arcmin > a.arcmin { b } else { a })
    }

    /// The play in words, with the unit in which its row states it.
    fn amount(&self) -> String {
        match self.slides {
            true => format!("{} mm", significant(self.loose_mm(1.0), 3)),
            false => format!("{} arcmin", self.arcmin),
        }
    }

    /// How far the tip moves from one stop to the other \[mm\]. `reach_m` is the displacement of the tip per radian of
    /// the joint \[m\].
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

    /// The remarks on the play of a front of one design, which deflects by `tip_deflection_mm` and has [`GEAR`] at a
    /// joint 0.5 m away from the tip.
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

    /// The remarks on the play of a front of one design on a rail with a rack of the backlash `backlash_mm`.
    fn remarks_on_rail(backlash_mm: f64) -> Vec<String> {
        let rack = json!({"name": "R2", "pinion_radius_mm": 20, "stiffness_n_per_m": 2e7, "backlash_mm": backlash_mm});
        let study = json!({"name": "s", "poses": [{"pose": {"rail_mm": 100}}], "chain": [
            {"type": "prismatic", "name": "rail", "axis": [1, 0, 0], "mass_kg": 3, "drive": "first_fit", "racks": [rack]},
            {"type": "link", "name": "boom", "vector_m": [0, 0.5, 0], "mass_kg": 1}]});
        let catalogs = Catalogs::builtin();
        let study = read_study(Document::parse("s.json", &study.to_string()).unwrap(), &catalogs).unwrap();
        let columns = ["design_id", "rail_gear", "tip_deflection_mm", "mass_kg", "lowest_mode_hz"];
        let front = FrontTable {
            columns: columns.map(String::from).to_vec(),
            rows: vec![["x0", "R2", "1", "4", "20"].map(String::from).to_vec()],
        };
        play_remarks(&study.space, &catalogs, &front)
    }

    #[test]
    fn the_play_of_a_rail_is_said_in_millimetres() {
        let words = "rail: R2 with 0.150 mm of backlash: the tip is loose by up to 0.15 mm from stop to stop, which is not \
                     in the deflection.";
        assert_eq!(remarks_on_rail(0.15), [words]);
        assert_eq!(remarks_on_rail(0.01), [""; 0], "too little to matter");
        assert_eq!(remarks_on_rail(0.0), [""; 0]);
    }
}
