//! Every design of a study, one after the other.

use serde_json::{Value, json};

use super::arm::{Chosen, Joint, Link, LinkOption, arm_file};
use super::bearing::Source;
use super::demand::{Demand, demand};
use super::drive::Drive;
use super::stress::stress_safety_factor;
use super::study::{DriveChoice, Piece, Pose, Posed, Study};
use crate::witness;

/// Enough for the lowest mode to 1e-7 in these arms; statics do not depend on it.
const ELEMENTS_PER_LINK: usize = 6;

/// One complete choice and what it is worth.
pub struct Design {
    /// Base to tip.
    pub chain: Vec<Chosen>,
    pub tip_deflection_mm: f64,
    pub mass_kg: f64,
    pub lowest_mode_hz: f64,
    pub stress_safety_factor: Option<f64>,
    /// Of the open links, if every material has a price.
    pub material_cost_eur: Option<f64>,
}

/// All designs that hold, and how many there were to look at.
pub struct Searched {
    /// Product of the options of all links.
    pub link_choices: usize,
    pub designs: Vec<Design>,
}

/// Looks at every design of the study.
pub fn search(study: &Study) -> Searched {
    let options = study.pieces.iter().filter_map(|piece| match piece {
        Piece::Choice { options, .. } => Some(options.len()),
        _ => None,
    });
    let poses: Vec<(&Pose, Posed)> = study.poses.iter().map(|pose| (pose, study.posed(&pose.case))).collect();
    let sizing = sizing_poses(study);
    let mut searched = Searched { link_choices: options.product(), designs: Vec::new() };
    extend(study, &sizing, &[], &mut |chain| {
        let design = judged(study, &poses, chain);
        if meets(study, &design) {
            searched.designs.push(design);
        }
    });
    searched
}

/// Every arm whose joints all have a drive, base to tip.
pub fn chains(study: &Study) -> Vec<Vec<Chosen>> {
    let mut chains = Vec::new();
    extend(study, &sizing_poses(study), &[], &mut |chain| chains.push(chain.to_vec()));
    chains
}

fn sizing_poses(study: &Study) -> Vec<(&Pose, Posed)> {
    let sizing = study.poses.iter().filter(|pose| pose.sizes);
    sizing.map(|pose| (pose, study.posed(&pose.case))).collect()
}

/// Adds every choice for the next piece inboard of `outboard` (nearest first), down to the base.
fn extend(study: &Study, sizing: &[(&Pose, Posed)], outboard: &[Chosen], found: &mut dyn FnMut(&[Chosen])) {
    let Some(index) = (study.pieces.len() - outboard.len()).checked_sub(1) else {
        found(outboard);
        return;
    };
    for choice in choices(study, sizing, index, outboard) {
        let mut longer = vec![choice];
        longer.extend_from_slice(outboard);
        extend(study, sizing, &longer, found);
    }
}

fn choices(study: &Study, sizing: &[(&Pose, Posed)], index: usize, outboard: &[Chosen]) -> Vec<Chosen> {
    match &study.pieces[index] {
        Piece::Fixed(link) => vec![Chosen::Link(Link::clone(link))],
        Piece::Choice { name, vector_m, options } => {
            let slender = |option: &&LinkOption| {
                study.limit("wall_slenderness_max").is_none_or(|limit| wall_slenderness(option) <= limit)
            };
            options.iter().filter(slender).map(|o| Chosen::Link(Link::of(name, *vector_m, o))).collect()
        }
        Piece::Joint { drive: DriveChoice::Given(entry), name, bearing, .. } => {
            vec![Chosen::Joint(given(name, entry, bearing))]
        }
        Piece::Joint { name, axis, drive, bearing, extras_kg, fit, .. } => {
            let asked = demand(study, sizing, index, outboard);
            let joint = |drive: &Drive| {
                let beside = bearing.beside(drive.bearing);
                let mass_kg = drive.mass_kg + extras_kg + beside.map_or(0.0, |bearing| bearing.mass_kg);
                Chosen::Joint(Joint {
                    name: name.clone(),
                    mass_kg,
                    gear: drive.gear.clone(),
                    motor: drive.motor.clone(),
                    entry: json!({"type": "joint", "name": name, "axis": [axis.x, axis.y, axis.z],
                        "windup": drive.windup, "mass_kg": drive.mass_kg + extras_kg,
                        "bearing": beside.map(|bearing| bearing.entry())}),
                })
            };
            let most = if matches!(drive, DriveChoice::FirstFit) { 1 } else { usize::MAX };
            let holding = fits(study, bearing, &asked).filter(|drive| drive.sizes.fit(fit, axis, outboard));
            holding.take(most).map(joint).collect()
        }
    }
}

/// The first joint from the tip that no drive holds when every piece takes its first choice, and what is asked of it.
pub fn joint_that_nothing_holds(study: &Study) -> Option<(String, Source, Demand)> {
    let sizing = sizing_poses(study);
    let mut outboard: Vec<Chosen> = Vec::new();
    for index in (0..study.pieces.len()).rev() {
        match (choices(study, &sizing, index, &outboard).into_iter().next(), &study.pieces[index]) {
            (Some(choice), _) => outboard.insert(0, choice),
            (None, Piece::Joint { name, bearing, .. }) => {
                return Some((name.clone(), *bearing, demand(study, &sizing, index, &outboard)));
            }
            (None, _) => panic!("no section is left"),
        }
    }
    None
}

fn fits<'a>(study: &'a Study, bearing: &'a Source, asked: &'a Demand) -> impl Iterator<Item = &'a Drive> {
    study.drives.iter().filter(|drive| drive.holds(bearing, asked, &study.motion))
}

fn given(name: &str, entry: &Value, bearing: &Source) -> Joint {
    let mut entry = entry.clone();
    let mut mass_kg = entry["mass_kg"].as_f64().unwrap_or(0.0);
    if let Some(bearing) = bearing.beside(None) {
        mass_kg += bearing.mass_kg;
        entry["bearing"] = bearing.entry();
    }
    Joint { name: name.to_owned(), mass_kg, gear: String::new(), motor: String::new(), entry }
}

/// The widest flat between the corners over the wall's thickness; a round tube's diameter over it. Bars do not buckle so.
fn wall_slenderness(option: &LinkOption) -> f64 {
    let tube = &option.tube;
    if 2.0 * tube.wall_m == tube.width_m.min(tube.height_m) {
        return 0.0;
    }
    let corners_m = if tube.is_round { 0.0 } else { 2.0 * tube.wall_m };
    (tube.width_m.max(tube.height_m) - corners_m) / tube.wall_m
}

fn judged(study: &Study, poses: &[(&Pose, Posed)], chain: &[Chosen]) -> Design {
    let mut arm = arm_file(study.gravity_m_s2, chain);
    arm["effects"] = study.effects.clone();
    let (tip_deflection_mm, lowest_mode_hz) = objectives(&arm, study.poses.iter().map(|pose| &pose.case));
    Design {
        chain: chain.to_vec(),
        tip_deflection_mm,
        mass_kg: chain.iter().map(Chosen::mass_kg).sum(),
        lowest_mode_hz,
        stress_safety_factor: stress_safety_factor(study, poses, chain),
        material_cost_eur: chain.iter().map(link_cost_eur).sum(),
    }
}

fn link_cost_eur(piece: &Chosen) -> Option<f64> {
    match piece {
        Chosen::Link(Link { option: Some(option), mass_kg, .. }) => Some(option.cost_eur_per_kg? * mass_kg),
        _ => Some(0.0),
    }
}

/// Worst tip deflection \[mm\] and lowest mode \[Hz\] over the load cases, by finite elements.
pub fn objectives<'a>(arm: &Value, cases: impl Iterator<Item = &'a witness::LoadCase>) -> (f64, f64) {
    let mut options = witness::Options::default().with_modes(1);
    options.elements_per_link = ELEMENTS_PER_LINK;
    options.effects = witness::Effects::from_json(&arm["effects"]);
    cases.fold((0.0, f64::INFINITY), |(deflection_mm, mode_hz): (f64, f64), case| {
        let answer = witness::analyze(arm, case, &options);
        let first_hz = answer.modes.first().map_or(f64::INFINITY, |mode| mode.frequency_hz);
        (deflection_mm.max(1e3 * answer.tip_displacement_m.norm()), mode_hz.min(first_hz))
    })
}

pub fn meets(study: &Study, design: &Design) -> bool {
    let below = |key: &str, value: f64| study.limit(key).is_none_or(|limit| value <= limit);
    let above = |key: &str, value: f64| study.limit(key).is_none_or(|limit| value >= limit);
    let mut options = design.chain.iter().filter_map(|chosen| match chosen {
        Chosen::Link(link) => link.option.as_ref(),
        Chosen::Joint(_) => None,
    });
    options.all(|option| below("wall_slenderness_max", wall_slenderness(option)))
        && below("tip_deflection_max_mm", design.tip_deflection_mm)
        && below("mass_max_kg", design.mass_kg)
        && above("lowest_mode_min_hz", design.lowest_mode_hz)
        && design.material_cost_eur.is_none_or(|cost| below("material_cost_max_eur", cost))
        && design.stress_safety_factor.is_none_or(|factor| above("stress_safety_factor_min", factor))
}

impl Design {
    /// What was chosen freely: the option of every open link, the drive of every joint that is not `first_fit`.
    pub fn key(&self, study: &Study) -> String {
        let parts =
            study.pieces.iter().zip(&self.chain).filter_map(|(piece, chosen)| match (piece, chosen) {
                (Piece::Choice { .. }, Chosen::Link(Link { option: Some(o), .. })) => {
                    let [width, height, wall] =
                        [o.tube.width_m, o.tube.height_m, o.tube.wall_m].map(|m| 1e3 * m);
                    Some(link_key(&o.material, &o.profile, width, height, wall))
                }
                (Piece::Joint { drive: DriveChoice::AllFits, .. }, Chosen::Joint(joint)) => {
                    Some(drive_key(joint))
                }
                _ => None,
            });
        parts.collect::<Vec<_>>().join("; ")
    }

    /// Gear and motor of every joint that has them, base to tip.
    pub fn drives(&self) -> Vec<(String, String, String)> {
        let joints = self.chain.iter().filter_map(|piece| match piece {
            Chosen::Joint(joint) if !joint.gear.is_empty() => Some(joint),
            _ => None,
        });
        joints.map(|j| (j.name.clone(), j.gear.clone(), j.motor.clone())).collect()
    }

    /// The material of all open links, if it is one.
    pub fn only_material(&self) -> Option<&str> {
        let mut materials = self.chain.iter().filter_map(|piece| match piece {
            Chosen::Link(Link { option: Some(option), .. }) => Some(option.material.as_str()),
            _ => None,
        });
        let first = materials.next()?;
        materials.all(|other| other == first).then_some(first)
    }
}

/// A link's choice as text, dimensions in millimetres.
pub fn link_key(material: &str, profile: &str, width_mm: f64, height_mm: f64, wall_mm: f64) -> String {
    format!("{material} {profile} {width_mm:.6} x {height_mm:.6} x {wall_mm:.6}")
}

fn drive_key(joint: &Joint) -> String {
    format!("{} + {}", joint.gear, joint.motor)
}
