//! Motors of a bill of materials that sit elsewhere than the joints they drive.
//!
//! In an arm such a motor is a body of the element that carries it, with the mass of the motor, or of motor and gear.
//! It is recognized by this mass.

use super::bill_rows::{ROUNDING, Row, bodies_of, bought, which_mass};
use crate::arm::{Arm, Joint};
use crate::catalog::Catalogs;
use crate::catalog::gear::{Gear, GearKind, GearMass};
use crate::catalog::motor::Motor;
use nalgebra::Matrix3;

/// A motor that sits elsewhere than its joint.
pub(super) struct Elsewhere {
    /// Name of the joint that it drives.
    pub joint: String,
    /// The body of the arm that is this motor, or this motor with its gear: index of the element, and index of the body
    /// among those of the element.
    pub body: (usize, usize),
    /// The rows of this body: the motor, and the gear if it sits at the motor.
    pub rows: Vec<Row>,
    /// The row of the gear if it sits at the joint; `None` if it sits at the motor or is unknown.
    pub gear_row: Option<Row>,
}

/// The motors of an arm that sit elsewhere than their joints, as far as the catalogs know their masses.
pub(super) fn motors_elsewhere(arm: &Arm, catalogs: &Catalogs) -> Vec<Elsewhere> {
    let mut out: Vec<Elsewhere> = Vec::new();
    for joint in arm.joints() {
        let gear = joint.gear.as_ref().and_then(|name| catalogs.gear(name).ok());
        let motor = joint.motor.as_ref().and_then(|name| catalogs.motor(name).ok());
        let Some((motor, motor_kg)) = motor.and_then(|motor| Some((motor, motor.mass_kg?))) else { continue };
        let found = splits(joint, gear, motor_kg).into_iter().find_map(|split| {
            let body_kg = motor_kg + split.gear_at_motor.map_or(0.0, |(_, kg)| kg);
            let taken: Vec<(usize, usize)> = out.iter().map(|other| other.body).collect();
            Some((split, body_of_mass(arm, body_kg, &taken)?))
        });
        if let Some((split, body)) = found {
            out.push(Elsewhere {
                joint: joint.name.clone(),
                body,
                ..rows(joint, gear, (motor, motor_kg), &split)
            });
        }
    }
    out
}

/// One possible place of the gear of a joint whose motor sits elsewhere: at the joint or at the motor. It has the kind
/// of mass (housed unit or component set) and the mass \[kg\]. Both fields are `None` if no gear of the catalogs is
/// known.
#[derive(Debug, Clone, Copy, Default)]
struct Split {
    gear_at_joint: Option<(&'static str, f64)>,
    gear_at_motor: Option<(&'static str, f64)>,
}

/// The places that the gear of a joint may have if its motor, of the mass `motor_kg` \[kg\], sits elsewhere. There is
/// none if the mass of the joint shows that the motor sits at it.
fn splits(joint: &Joint, gear: Option<&Gear>, motor_kg: f64) -> Vec<Split> {
    let Some(gear) = gear.filter(|gear| gear.kind != GearKind::Actuator) else {
        // the gear is given in numbers or there is none; the motor may sit elsewhere only if stages (belts) lie between
        // it and the joint
        let may_be = joint.stages != Default::default() && joint.mass_kg < motor_kg;
        return if may_be { vec![Split::default()] } else { Vec::new() };
    };
    if let Some(which) = which_mass(gear, joint.mass_kg) {
        return vec![Split { gear_at_joint: Some((which, joint.mass_kg)), ..Split::default() }];
    }
    if joint.mass_kg > 0.0 {
        return Vec::new();
    }
    let masses = [(GearMass::HousedUnit, "housed unit"), (GearMass::ComponentSet, "component set")];
    let known = masses.into_iter().filter_map(|(which, word)| Some((word, gear.mass_kg(which)?)));
    known.map(|at_motor| Split { gear_at_motor: Some(at_motor), ..Split::default() }).collect()
}

/// The first body that has this mass \[kg\] and no inertia, and is not in the list `taken`; `None` if there is none.
fn body_of_mass(arm: &Arm, mass_kg: f64, taken: &[(usize, usize)]) -> Option<(usize, usize)> {
    let bodies = arm.chain.iter().enumerate().flat_map(|(element, item)| {
        bodies_of(item).into_iter().enumerate().map(move |(i, body)| ((element, i), body))
    });
    let mut same = bodies.filter(|(_, body)| {
        (body.mass_kg - mass_kg).abs() <= ROUNDING * mass_kg && body.inertia_kgm2 == Matrix3::zeros()
    });
    same.find(|(place, _)| !taken.contains(place)).map(|(place, _)| place)
}

/// The rows of motor and gear. The caller fills in the fields `joint` and `body`.
fn rows(joint: &Joint, gear: Option<&Gear>, (motor, motor_kg): (&Motor, f64), split: &Split) -> Elsewhere {
    let at = joint.name.as_str();
    let gear_row = |(which, kg): (&str, f64)| {
        gear.map(|gear| bought(at, &format!("{} ({which})", gear.id), "gear", kg, &gear.provenance))
    };
    let mut rows = vec![bought(at, &motor.id, "motor", motor_kg, &motor.provenance)];
    rows.extend(split.gear_at_motor.and_then(gear_row));
    Elsewhere { joint: String::new(), body: (0, 0), rows, gear_row: split.gear_at_joint.and_then(gear_row) }
}
