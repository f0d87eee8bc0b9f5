//! Reads the rails (prismatic joints) of a study whose drive is sized: the screws, racks and motors to choose from.

use super::drives::{Drives, read_drives};
use super::rail_keys::{RACK, SCREW};
use crate::arm::element_keys::read_name;
use crate::catalog::Catalogs;
use crate::catalog::gear::Gear;
use crate::input::json::{Node, Object};
use crate::sizing::rail::{Ends, Rack, Screw};
use crate::space::prismatic::RailDrive;

/// Keys of a prismatic joint that need a drive which is sized.
const OF_SIZED: [&str; 4] = ["drives", "screws", "racks", "brake"];

/// Reads how the drive of a prismatic joint is sized. The inner `None` means that the study gives the drive, the outer
/// `None` that a fault was recorded.
pub(super) fn read_rail_drive(
    object: &Object,
    usual: &Drives,
    catalogs: &Catalogs,
) -> Option<Option<RailDrive>> {
    let Some(drive) = object.optional("drive") else {
        let mut sound = Some(None);
        for key in OF_SIZED.iter().filter(|key| object.has(key)) {
            sound = object.node().fault_below(
                key,
                "has no \"drive\" beside it",
                "add \"drive\": \"first_fit\", or give the joint in numbers, stiffness_n_per_m among them",
            );
        }
        return sound;
    };
    let is_first_fit = match drive.string()? {
        "first_fit" => Some(()),
        other => drive.fault(
            format!("\"{other}\" is not known at a prismatic joint"),
            "write first_fit: the lightest pair of a screw or rack and a motor that holds",
        ),
    };
    if object.has("stiffness_n_per_m") {
        return object.node().fault_below(
            "stiffness_n_per_m",
            "stands beside \"drive\"",
            "that of a screw or rack that is sized comes with it; keep one",
        );
    }
    let screws = object.or("screws", Vec::new(), |n| all(n, read_screw));
    let racks = object.or("racks", Vec::new(), |n| all(n, read_rack));
    let drives = object.or("drives", usual.clone(), |n| read_drives(n, catalogs));
    let has_brake = object.or("brake", false, Node::boolean);
    is_first_fit?;
    let gears: Vec<Gear> = screws?.into_iter().chain(racks?).collect();
    if gears.is_empty() {
        return object.node().fault(
            "has a drive to be sized and neither screws nor racks",
            "add \"screws\" or \"racks\", a list of parts in numbers",
        );
    }
    if let Some(twice) = (1..gears.len()).find(|&i| gears[..i].iter().any(|gear| gear.id == gears[i].id)) {
        return object.node().fault(
            format!("has two parts named \"{}\"", gears[twice].id),
            "give every screw and rack a name of its own",
        );
    }
    Some(Some(RailDrive { gears, motors: drives?.filter, has_brake: has_brake? }))
}

fn all(node: &Node, read: impl Fn(&Node) -> Option<Gear>) -> Option<Vec<Gear>> {
    let items = node.array()?;
    if items.is_empty() {
        return node.fault("is empty", "list one part at least, or leave the key away");
    }
    let read: Vec<Option<Gear>> = items.iter().map(read).collect();
    read.into_iter().collect()
}

fn read_efficiency(object: &Object) -> Option<f64> {
    object.or("efficiency", 0.9, |n| match n.positive()? {
        part if part <= 1.0 => Some(part),
        part => n.fault(format!("= {part} is more than the whole"), "give a part such as 0.9"),
    })
}

fn read_screw(node: &Node) -> Option<Gear> {
    let object = node.shaped(&SCREW)?;
    let positive = |key| object.required(key).and_then(|n| n.positive());
    let known = |key| object.or(key, None, |n| n.positive().map(Some));
    let further = |key| object.or(key, 0.0, Node::non_negative);
    let (name, efficiency) = (read_name(&object), read_efficiency(&object));
    let [lead, root, length] = [positive("lead_mm"), positive("root_diameter_mm"), positive("length_mm")]
        .map(|mm| mm.map(|mm| mm / 1e3));
    let ends = object.or("ends", Ends::FixedSupported, read_ends);
    let (life, force, speed) = (known("dynamic_load_rating_n"), known("max_force_n"), known("max_speed_rpm"));
    let series = known("nut_stiffness_n_per_m");
    let ratio = object.or("ratio", 1.0, Node::positive);
    let (inertia, mass) = (further("inertia_kgm2"), further("mass_kg"));
    let backlash = further("backlash_mm");
    let screw = Screw {
        name: name?,
        lead_m: lead?,
        root_diameter_m: root?,
        length_m: length?,
        ends: ends?,
        dynamic_load_rating_n: life?,
        max_force_n: force?,
        max_speed_rpm: speed?,
        ratio: ratio?,
        efficiency: efficiency?,
        series_n_per_m: series?,
        further_inertia_kgm2: inertia?,
        further_mass_kg: mass?,
    };
    Some(with_backlash(screw.gear(), backlash?))
}

fn read_ends(node: &Node) -> Option<Ends> {
    let word = node.string()?;
    Ends::WORDS.iter().find(|(known, _)| *known == word).map(|(_, ends)| *ends).or_else(|| {
        let words: Vec<&str> = Ends::WORDS.iter().map(|(word, _)| *word).collect();
        node.fault(format!("\"{word}\" is not known"), &format!("choose one of: {}", words.join(", ")))
    })
}

fn read_rack(node: &Node) -> Option<Gear> {
    let object = node.shaped(&RACK)?;
    let positive = |key| object.required(key).and_then(|n| n.positive());
    let known = |key| object.or(key, None, |n| n.positive().map(Some));
    let (name, efficiency) = (read_name(&object), read_efficiency(&object));
    let (radius, stiffness) = (positive("pinion_radius_mm"), positive("stiffness_n_per_m"));
    let ratio = object.or("ratio", 1.0, Node::positive);
    let (force, speed) = (known("max_force_n"), known("max_speed_rpm"));
    let inertia = object.or("inertia_kgm2", 0.0, Node::non_negative);
    let mass = object.or("mass_kg", 0.0, Node::non_negative);
    let backlash = object.or("backlash_mm", 0.0, Node::non_negative);
    let rack = Rack {
        name: name?,
        pinion_radius_m: radius? / 1e3,
        ratio: ratio?,
        efficiency: efficiency?,
        max_force_n: force?,
        max_speed_rpm: speed?,
        stiffness_n_per_m: stiffness?,
        inertia_kgm2: inertia?,
        mass_kg: mass?,
    };
    Some(with_backlash(rack.gear(), backlash?))
}

/// The screw or rack `gear` with this backlash along the travel; its play stays blank if the backlash is 0.
fn with_backlash(gear: Gear, backlash_mm: f64) -> Gear {
    // in the data of the gear of a rail, a metre of travel takes the place of a radian
    let backlash_arcmin = 60.0 * (backlash_mm / 1e3).to_degrees();
    Gear { backlash_arcmin: (backlash_mm > 0.0).then_some(backlash_arcmin), ..gear }
}
