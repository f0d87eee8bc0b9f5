//! Reads the key `drives`: the parts from which the joints of a study are sized.

use super::drive_keys::DRIVES;
use super::motor_kinds::{read_motor_kinds, usual_motor_kinds};
use crate::arm::bearing::BearingSource;
use crate::arm::extras::ExtrasSource;
use crate::arm::file::read_gear_mass;
use crate::arm::transmission::Stage;
use crate::catalog::Catalogs;
use crate::catalog::gear::{Gear, GearKind, GearMass};
use crate::catalog::lookup::hint_for_unknown;
use crate::catalog::motor::{Motor, MotorKind};
use crate::input::json::{Node, Object};
use crate::sizing::select::DriveFilter;

/// The catalog parts from which drives are chosen.
#[derive(Debug, Clone)]
pub(super) struct Drives {
    pub filter: DriveFilter,
}

impl Default for Drives {
    /// The parts from which drives are chosen if the study has no key `drives`: all strain-wave gears, and the servo
    /// and hydraulic motors of the catalogs. Other kinds are used only if a study asks for them.
    fn default() -> Self {
        let filter = DriveFilter {
            gear_kinds: Some(vec![GearKind::StrainWave]),
            actuator_ids: Some(Vec::new()),
            motor_kinds: Some(usual_motor_kinds()),
            ..DriveFilter::everything(GearMass::HousedUnit)
        };
        Self { filter }
    }
}

/// Keys that select gears.
const GEAR_KEYS: [&str; 4] = ["gear_series", "gears", "gear_kinds", "ratios"];

pub(super) fn read_drives(node: &Node, catalogs: &Catalogs) -> Option<Drives> {
    let object = node.shaped(&DRIVES)?;
    let gear_mass = read_gear_mass(&object);
    let gears: Vec<&Gear> = catalogs.gears.iter().filter(|g| g.kind != GearKind::Actuator).collect();
    let motors = catalogs.motors.iter().filter(|m| m.kind != MotorKind::OfActuator);
    let known_series: Vec<&str> = gears.iter().map(|g| g.series.as_str()).collect();
    let known_gears: Vec<&str> = gears.iter().map(|g| g.id.as_str()).collect();
    let known_motors: Vec<&str> = motors.map(|m: &Motor| m.id.as_str()).collect();
    let mut known_ratios: Vec<f64> = gears.iter().map(|g| g.ratio).collect();
    known_ratios.sort_by(f64::total_cmp);
    known_ratios.dedup();
    let named = object.has("gear_series") || object.has("gears");
    let usual_gears = if named { None } else { Some(vec![GearKind::StrainWave]) };
    let usual_motors = if object.has("motor_models") { None } else { Some(usual_motor_kinds()) };
    let actuators = object.or("actuators", Some(Vec::new()), |n| read_actuators(n, catalogs));
    let (gear_series, gear_ids) = (
        names(&object, "gear_series", &known_series, "gears"),
        names(&object, "gears", &known_gears, "gears"),
    );
    let (ratios, gear_kinds) = (
        object.or("ratios", None, |n| read_ratios(n, &known_ratios).map(Some)),
        object.or("gear_kinds", usual_gears, |n| read_gear_kinds(n, catalogs).map(Some)),
    );
    let motor_kinds = object.or("motors", usual_motors, |n| read_motor_kinds(n).map(Some));
    let motor_ids = names(&object, "motor_models", &known_motors, "motors");
    let only_actuators = object.has("actuators") && !GEAR_KEYS.iter().any(|key| object.has(key));
    Some(Drives {
        filter: DriveFilter {
            gear_mass: gear_mass?,
            bearing: BearingSource::OfGear,
            extras: ExtrasSource::NONE,
            stage: Stage::NONE,
            needs_torsion: false,
            gear_series: gear_series?,
            ratios: ratios?,
            gear_kinds: if only_actuators { Some(Vec::new()) } else { gear_kinds? },
            gear_ids: gear_ids?,
            actuator_ids: actuators?,
            motor_kinds: motor_kinds?,
            motor_ids: motor_ids?,
        },
    })
}

/// Reads `"all"`, which means no restriction, or a list of models of actuators. The inner `None` means no restriction,
/// the outer `None` that a fault was recorded.
fn read_actuators(node: &Node, catalogs: &Catalogs) -> Option<Option<Vec<String>>> {
    if node.value().as_str() == Some("all") {
        return Some(None);
    }
    let actuators = catalogs.gears.iter().filter(|g| g.kind == GearKind::Actuator);
    list(node, &actuators.map(|g| g.id.as_str()).collect::<Vec<_>>(), "actuators").map(Some)
}

/// Reads a list of names, all of which must be among `known`. The inner `None` means that the object has no such key,
/// which is no restriction; the outer `None` means that a fault was recorded. `parts` is as in [`list`].
fn names(object: &Object, key: &str, known: &[&str], parts: &str) -> Option<Option<Vec<String>>> {
    object.or(key, None, |node| list(node, known, parts).map(Some))
}

/// Reads a list of names, all of which must be among `known`. `parts` is the list of `armwright catalog show` that has them.
/// Returns `None` after recording a fault.
fn list(node: &Node, known: &[&str], parts: &str) -> Option<Vec<String>> {
    let read: Vec<Option<String>> = node
        .array()?
        .iter()
        .map(|n| match n.string()? {
            name if known.contains(&name) => Some(name.to_string()),
            name => {
                n.fault(format!("\"{name}\" is not in the catalog"), &hint_for_unknown(name, known, parts))
            }
        })
        .collect();
    read.into_iter().collect()
}

/// Reads the kinds of gears that may be chosen. The catalogs must have a gear of one of them. Returns `None` after
/// recording a fault.
fn read_gear_kinds(node: &Node, catalogs: &Catalogs) -> Option<Vec<GearKind>> {
    let kind = |n: &Node| {
        let word = n.string()?;
        GearKind::from_word(word).or_else(|| {
            let hint = format!(
                "choose among: {}; actuators have their own key, \"actuators\"",
                GearKind::WORDS.join(", ")
            );
            n.fault(format!("\"{word}\" is not known"), &hint)
        })
    };
    let read: Vec<Option<GearKind>> = node.array()?.iter().map(kind).collect();
    let kinds = read.into_iter().collect::<Option<Vec<_>>>()?;
    let has = |kind: &GearKind| catalogs.gears.iter().any(|gear| gear.kind == *kind);
    if kinds.is_empty() || kinds.iter().any(has) {
        return Some(kinds);
    }
    let words_of = |counts: &dyn Fn(&GearKind) -> bool| -> String {
        let words = GearKind::WORDS.into_iter();
        let matching = words.filter(|word| GearKind::from_word(word).is_some_and(|kind| counts(&kind)));
        matching.collect::<Vec<_>>().join(", ")
    };
    node.fault(
        format!("the catalogs have no gear of the kind {}", words_of(&|kind| kinds.contains(kind))),
        &format!(
            "add rows to gears.csv in a folder of your own (--catalogs DIR), or ask for a kind that has rows: {}",
            words_of(&has)
        ),
    )
}

fn read_ratios(node: &Node, known: &[f64]) -> Option<Vec<f64>> {
    let ratio = |n: &Node| {
        let ratio = n.positive()?;
        known.iter().copied().find(|&k| k == ratio).or_else(|| {
            let list: Vec<String> = known.iter().map(f64::to_string).collect();
            n.fault(format!("= {ratio}: no gear has this ratio"), &format!("ratios: {}", list.join(", ")))
        })
    };
    let read: Vec<Option<f64>> = node.array()?.iter().map(ratio).collect();
    read.into_iter().collect()
}
