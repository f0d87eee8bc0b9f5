//! Remarks on parts that a study allows and that its joints are not offered, because their rows leave figures blank.

use crate::catalog::Catalogs;
use crate::catalog::gear::{Gear, GearKind, GearMass};
use crate::catalog::lookup::first_names;
use crate::catalog::motor::{Motor, MotorKind};
use crate::catalog::needs::Lack;
use crate::sizing::select::DriveFilter;
use crate::space::design_space::{DesignSpace, SpacePiece};
use std::cmp::Reverse;

/// Largest number of figures that a remark names for one kind of parts.
const FIGURES_NAMED: usize = 4;

/// The parts of one kind that a study allows, and those among them that lack figures.
struct Blank {
    /// The kind of parts, in the plural.
    kind: &'static str,
    allowed: usize,
    lacking: usize,
    /// The figures that are missing, each with the number of parts that lack it, the most frequent first.
    figures: Vec<(&'static str, usize)>,
}

impl Blank {
    /// `parts` has one list of missing figures for each part; it is empty for a part that lacks none.
    fn new(kind: &'static str, parts: impl Iterator<Item = Vec<Lack>>) -> Self {
        let mut out = Self { kind, allowed: 0, lacking: 0, figures: Vec::new() };
        for lacks in parts {
            out.allowed += 1;
            out.lacking += usize::from(!lacks.is_empty());
            let mut figures: Vec<&'static str> = lacks.iter().map(|lack| lack.figure).collect();
            figures.sort_unstable();
            figures.dedup();
            for figure in figures {
                match out.figures.iter_mut().find(|(known, _)| *known == figure) {
                    Some((_, parts)) => *parts += 1,
                    None => out.figures.push((figure, 1)),
                }
            }
        }
        out.figures.sort_by_key(|&(figure, parts)| (Reverse(parts), figure));
        out
    }

    /// `19 of 52 actuators were not offered: no k1_nm_per_rad (19)`; `None` if no part lacks a figure.
    fn words(&self) -> Option<String> {
        let Self { kind, allowed, lacking, figures } = self;
        let figures: Vec<String> =
            figures.iter().map(|(figure, parts)| format!("no {figure} ({parts})")).collect();
        let were = if *lacking == 1 { "was" } else { "were" };
        let figures = first_names(&figures, FIGURES_NAMED);
        (*lacking > 0).then(|| format!("{lacking} of {allowed} {kind} {were} not offered: {figures}"))
    }
}

/// Sentences on the parts that joints are not offered because figures are blank. Joints to which the same words apply
/// share a sentence, which names them unless they are all of the joints whose drive is chosen.
pub(super) fn blank_remarks(space: &DesignSpace, catalogs: &Catalogs) -> Vec<String> {
    let mut joints = 0;
    let mut said: Vec<(String, Vec<&str>)> = Vec::new();
    for piece in &space.pieces {
        let Some(words) = words_of(piece, catalogs) else { continue };
        joints += 1;
        match said.iter_mut().find(|(known, _)| *known == words) {
            Some((_, names)) => names.push(piece.name()),
            None => said.push((words, vec![piece.name()])),
        }
    }
    let sentence = |(words, names): (String, Vec<&str>)| {
        let whose = if names.len() == joints { String::new() } else { format!("{}: ", names.join(", ")) };
        (!words.is_empty()).then(|| format!("{whose}{words} (`armwright catalog check` lists them)."))
    };
    said.into_iter().filter_map(sentence).collect()
}

/// The remark on the parts of one joint without its name, empty if all parts are offered. `None` if the joint's drive is
/// not chosen.
fn words_of(piece: &SpacePiece, catalogs: &Catalogs) -> Option<String> {
    let blanks = match piece {
        SpacePiece::Joint(joint) => blank_parts(joint.drive.filter()?, catalogs),
        // the screws and racks of a rail are stated by the study
        SpacePiece::Prismatic(rail) => vec![blank_motors(&rail.drive.as_ref()?.motors, catalogs)],
        SpacePiece::Link(_) | SpacePiece::Choice(_) => return None,
    };
    Some(blanks.iter().filter_map(Blank::words).collect::<Vec<_>>().join("; "))
}

/// The gears, actuators and motors that `filter` allows. Motors are left out if it allows no gear that needs one.
fn blank_parts(filter: &DriveFilter, catalogs: &Catalogs) -> Vec<Blank> {
    let which = filter.gear_mass;
    let allowed: Vec<&Gear> = catalogs.gears.iter().filter(|gear| filter.allows_gear(gear)).collect();
    let (actuators, gears): (Vec<&Gear>, Vec<&Gear>) =
        allowed.into_iter().partition(|gear| gear.kind == GearKind::Actuator);
    let of_actuator = |gear: &&Gear| {
        let own = catalogs.motors.iter().find(|motor| gear.goes_with(motor));
        [gear.lacks(which), own.map(Motor::lacks).unwrap_or_default()].concat()
    };
    let mut out = vec![Blank::new("actuators", actuators.iter().map(of_actuator))];
    if !gears.is_empty() {
        let sold = gears.iter().filter(|gear| is_sold_as(gear, which));
        out.push(Blank::new("gears", sold.map(|gear| gear.lacks(which))));
        out.push(blank_motors(filter, catalogs));
    }
    out
}

/// Whether a gear is sold as `which`, as a component set or as a housed unit. A gear of which only the mass of the other
/// one is known is not: it is excluded by the study's `gear_mass` and not by a blank figure.
fn is_sold_as(gear: &Gear, which: GearMass) -> bool {
    gear.mass_kg(which).is_some()
        || (gear.mass_component_set_kg.is_none() && gear.mass_housed_unit_kg.is_none())
}

/// The motors that `filter` allows, without those of actuators.
fn blank_motors(filter: &DriveFilter, catalogs: &Catalogs) -> Blank {
    let motors = catalogs.motors.iter().filter(|motor| motor.kind != MotorKind::OfActuator);
    Blank::new("motors", motors.filter(|motor| filter.allows_motor(motor)).map(Motor::lacks))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::json::Document;
    use crate::study::read::read_study;
    use serde_json::{Value, json};

    /// The remarks on blank figures of a study of joints with these `drives`, one after another.
    fn remarks(drives: &[Value]) -> Vec<String> {
        let mut chain: Vec<Value> = Vec::new();
        for (i, drives) in drives.iter().enumerate() {
            chain.push(json!({"type": "joint", "name": format!("j{i}"), "axis": [0, 1, 0], "drive": "first_fit", "drives": drives}));
            chain.push(
                json!({"type": "link", "name": format!("l{i}"), "vector_m": [0.3, 0, 0], "mass_kg": 1}),
            );
        }
        let poses = json!([{"pose_deg": vec![0; drives.len()]}]);
        let study = json!({"name": "s", "poses": poses, "chain": chain});
        let catalogs = Catalogs::builtin();
        let study = read_study(Document::parse("s.json", &study.to_string()).unwrap(), &catalogs).unwrap();
        study.remarks.into_iter().filter(|said| said.contains("not offered")).collect()
    }

    /// The counts are those of the cells that actuators.csv leaves blank.
    #[test]
    fn actuators_without_a_needed_figure_are_counted_once_for_all_joints() {
        let all = json!({"actuators": "all"});
        let words = "19 of 52 actuators were not offered: no k1_nm_per_rad (19), no inertia_output_kgm2 (14), no peak_torque_nm \
                     (2), no max_speed_rpm (1) (`armwright catalog check` lists them).";
        assert_eq!(remarks(&[all.clone(), all.clone()]), [words]);
        let whole = json!({"actuators": ["CHA-20A-100"]});
        assert_eq!(remarks(std::slice::from_ref(&whole)), [""; 0]);
        assert_eq!(remarks(&[all.clone(), whole, all]), [format!("j0, j2: {words}")]);
    }

    /// Of the two gears SHG-14-100 lacks the limit of the mean speed; of the two motors TBM2G-06826C lacks its inertia.
    #[test]
    fn gears_and_motors_that_lack_a_figure_are_counted_with_it() {
        let drives =
            json!({"gears": ["SHG-14-100", "CSG-14-100"], "motor_models": ["TBM2G-06826C", "ILM70x10"]});
        let words = "1 of 2 gears was not offered: no average_input_speed_limit_rpm (1); 1 of 2 motors was not offered: no \
                     rotor_inertia_kgm2 (1) (`armwright catalog check` lists them).";
        assert_eq!(remarks(&[drives]), [words]);
    }

    #[test]
    fn a_part_that_lacks_a_figure_twice_counts_once_and_rare_figures_are_only_counted() {
        let lack = |figure| Lack { figure, purpose: "life" };
        let parts = [
            vec![lack("a"), lack("a"), lack("b")],
            vec![lack("b")],
            Vec::new(),
            vec![lack("c"), lack("d"), lack("e")],
        ];
        let blank = Blank::new("gears", parts.into_iter());
        let words = "3 of 4 gears were not offered: no b (2), no a (1), no c (1), no d (1) and 1 more";
        assert_eq!(blank.words().as_deref(), Some(words));
    }

    #[test]
    fn a_gear_that_is_sold_in_the_other_form_only_is_not_blank() {
        let mut gear = Catalogs::builtin().gear("CSG-14-100").unwrap().clone();
        gear.mass_housed_unit_kg = None;
        assert!(!is_sold_as(&gear, GearMass::HousedUnit) && is_sold_as(&gear, GearMass::ComponentSet));
        gear.mass_component_set_kg = None;
        assert!(is_sold_as(&gear, GearMass::HousedUnit), "its mass is blank");
    }
}
