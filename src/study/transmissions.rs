//! Motors of a study that do not sit at their joints, and stages between them and their gears.

use crate::arm::LinkBody;
use crate::arm::transmission::{Carrier, HungOn, MotorAt, Placed, Seen, SeenMotion, Transmission};
use crate::arm::transmissions::{Driven, place_all};
use crate::catalog::Catalogs;
use crate::catalog::gear::GearKind;
use crate::input::json::Node;
use crate::sizing::select::DriveFilter;
use crate::space::design_space::{DriveChoice, MotorPlace, SpaceJoint, SpacePiece};
use crate::space::effects::along;

/// Adds the motors that do not sit at their joints to the pieces that carry them. Stores in every joint the other
/// joints with which it turns. Returns `None` after recording a fault.
pub(super) fn place_transmissions(
    pieces: &mut [SpacePiece],
    mut driven: Vec<Driven>,
    catalogs: &Catalogs,
) -> Option<()> {
    let seen: Vec<Seen> = pieces.iter().map(seen).collect();
    let mut sound = Some(());
    for of in &mut driven {
        if let (SpacePiece::Joint(joint), Some(transmission)) = (&pieces[of.joint], &mut of.transmission)
            && let Some(filter) = joint.drive.filter()
        {
            sound =
                behind_one_ratio(of.node.clone(), transmission, of.joint, filter, catalogs, &seen).and(sound);
        }
    }
    sound?;
    for (joint, placed) in place_all(&driven, &seen)? {
        sound = of_sized(&driven, joint, &placed, pieces).and(sound);
        if let (SpacePiece::Joint(joint), Some(terms)) = (&mut pieces[joint], &placed.turns_with) {
            joint.turns_with = terms.clone();
        }
        placed.hung.iter().for_each(|hung| carrier(&mut pieces[hung.element]).carry(hung));
    }
    sound
}

/// Sets the gear ratio of a transmission between a motor and a gear that is sized. If the joint turns with other joints
/// because of the transmission, all gears that may be chosen must have the same ratio. Otherwise a fault is reported,
/// as it is for actuators, which have their motors inside. Returns `None` after recording a fault.
fn behind_one_ratio(
    node: Node,
    transmission: &mut Transmission,
    joint: usize,
    filter: &DriveFilter,
    catalogs: &Catalogs,
    seen: &[Seen],
) -> Option<()> {
    if transmission.is_none() {
        return Some(());
    }
    if filter.actuator_ids.as_ref().is_none_or(|ids| !ids.is_empty()) {
        return node.fault(
            "lets actuators be chosen behind a transmission, and an actuator has its motor within",
            "leave \"actuators\" away in the drives of this joint, or the transmission",
        );
    }
    let gears =
        catalogs.gears.iter().filter(|gear| gear.kind != GearKind::Actuator && filter.allows_gear(gear));
    let mut ratios: Vec<f64> = gears.map(|gear| gear.ratio).collect();
    ratios.sort_by(f64::total_cmp);
    ratios.dedup();
    let any = transmission.with_gear_ratio(ratios.first().copied().unwrap_or(1.0));
    let placed = any.place(&node, joint, seen)?;
    if placed.turns_with.is_some_and(|terms| !terms.is_empty()) && ratios.len() > 1 {
        return node.fault_below(
            "motor_at",
            "lies beyond another joint, with which this one turns by the ratio of its gear, and gears of several ratios may be chosen",
            "ask for one of the \"ratios\" in the \"drives\" of this joint, or state \"turns_with\"",
        );
    }
    *transmission = any;
    Some(())
}

/// Stores in the joint number `number` where its motor sits, if its drive is sized and the motor does not sit at the
/// joint. The mass of the motor is known only when a drive is chosen. Such a motor must not sit along a tube; if it
/// does, a fault is recorded. Returns `None` after recording a fault.
fn of_sized(driven: &[Driven], number: usize, placed: &Placed, pieces: &mut [SpacePiece]) -> Option<()> {
    let of = driven.iter().find(|of| of.joint == number)?;
    let MotorAt { element: piece, on, point_m } = placed.motor;
    if !of.transmission.as_ref()?.is_elsewhere() {
        return Some(());
    }
    let bends = match &pieces[piece] {
        SpacePiece::Link(link) if matches!(link.body, LinkBody::Tube { .. }) => {
            along(&link.vector_m, &point_m) > 0.0
        }
        SpacePiece::Choice(choice) => along(&choice.vector_m, &point_m) > 0.0,
        _ => false,
    };
    let SpacePiece::Joint(joint) = &mut pieces[number] else { return Some(()) };
    if !joint.drive.is_sized() {
        return Some(());
    }
    if bends {
        return of.node.fault_below(
            "motor_point_m",
            "puts a motor that is sized along a tube, which its weight would bend by a different amount in every design",
            "let it stand at the start of the tube, or give the drive in numbers",
        );
    }
    joint.motor_place = Some(MotorPlace { piece, moves: on == HungOn::Moving, point_m });
    Some(())
}

/// The properties of the joint number `number` of the chain that the placing of motors needs: its transmission, and the
/// joints with which it turns.
pub(super) fn of_joint<'n>(
    node: &Node<'n>,
    joint: &SpaceJoint,
    number: usize,
    transmission: Option<Transmission>,
) -> Driven<'n> {
    Driven { node: node.clone(), joint: number, transmission, turns_with: joint.turns_with.clone() }
}

/// The drive of a joint with a transmission. If the drive is given, its torsion curve is replaced by that of its gear
/// and the stages of `transmission` together. All else stays.
pub(super) fn with_stages(drive: DriveChoice, transmission: Option<&Transmission>) -> DriveChoice {
    match (drive, transmission) {
        (DriveChoice::Given { curve, mass_kg, gear, motor }, Some(transmission)) => {
            DriveChoice::Given { curve: transmission.curve(curve), mass_kg, gear, motor }
        }
        (drive, _) => drive,
    }
}

fn seen(piece: &SpacePiece) -> Seen {
    let motion = match piece {
        SpacePiece::Joint(joint) => SeenMotion::turning(&joint.axis, joint.coupled.as_deref()),
        SpacePiece::Prismatic(_) => SeenMotion::Slides,
        SpacePiece::Link(_) | SpacePiece::Choice(_) => SeenMotion::Stays,
    };
    Seen { name: piece.name().to_string(), motion }
}

fn carrier(piece: &mut SpacePiece) -> Carrier<'_> {
    match piece {
        SpacePiece::Joint(joint) => Carrier::Joint(&mut joint.bodies),
        SpacePiece::Prismatic(slide) => Carrier::Joint(&mut slide.joint.bodies),
        SpacePiece::Link(link) => Carrier::Link(&mut link.bodies),
        SpacePiece::Choice(choice) => Carrier::Link(&mut choice.bodies),
    }
}
