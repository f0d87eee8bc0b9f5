//! What catalogs know of the motors and gears of an arm, as a simulator needs it: inertia, peak torque and backlash at
//! the joint.

use crate::arm::{Arm, Joint};
use crate::catalog::Catalogs;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Inertia at the joint that is assumed where the inertia of the rotor is not known \[kg m², or kg for a joint that
/// slides\]. Without any inertia, motor and gear would be two hinges of one axis with nothing between them, and the
/// mass matrix would be singular. The assumed inertia changes nothing while the motors are held.
const STAND_IN_KGM2: f64 = 0.1;

/// Inertia and torque of the motor of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Motor {
    /// Inertia of rotor and gear input, referred to the joint \[kg m²\].
    pub armature_kgm2: f64,
    /// Peak torque of the motor, referred to the joint without losses \[N m\]; `None` if it is unknown.
    pub peak_nm: Option<f64>,
}

/// Inertia and peak torque of the motors by name of the joint. Where the inertia of the rotor or the ratio of the gear
/// is not known, 0.1 kg m² is used and the joint is named in `notes`.
pub(super) fn motors(arm: &Arm, catalogs: &Catalogs, notes: &mut Vec<String>) -> BTreeMap<String, Motor> {
    let stand_in = Motor { armature_kgm2: STAND_IN_KGM2, peak_nm: None };
    let mut out = BTreeMap::new();
    let (mut without_rotor, mut without_ratio) = (Vec::new(), Vec::new());
    for joint in arm.joints().filter(|joint| joint.coupled.is_none()) {
        let name = joint.name.clone();
        let motor = match motor(joint, catalogs) {
            Ok(motor) => motor,
            Err(Unknown::Rotor) => {
                without_rotor.push(joint.name.as_str());
                stand_in
            }
            Err(Unknown::Ratio) => {
                without_ratio.push(joint.name.as_str());
                stand_in
            }
        };
        out.insert(name, motor);
    }
    for joint in arm.prismatics() {
        without_rotor.push(joint.name.as_str());
        out.insert(joint.name.clone(), stand_in);
    }
    let reasons = [
        (without_rotor, "the catalogs do not know the rotor's inertia"),
        (without_ratio, "the ratio of the gear is not known (key gear_ratio)"),
    ];
    for (names, reason) in reasons.into_iter().filter(|(names, _)| !names.is_empty()) {
        notes.push(format!(
            "an armature of {STAND_IN_KGM2} kg m2 (kg where a joint slides) stands in where {reason}: {}",
            names.join(", ")
        ));
    }
    out
}

/// The property of the drive of a joint that is not known.
enum Unknown {
    Rotor,
    Ratio,
}

/// The motor of a joint, referred to the joint through its gear and stages. The gear is one of the catalogs, or the
/// file states its ratio.
fn motor(joint: &Joint, catalogs: &Catalogs) -> Result<Motor, Unknown> {
    let gear = joint.gear.as_ref().and_then(|name| catalogs.gear(name).ok());
    let motor = joint.motor.as_ref().and_then(|name| catalogs.motor(name).ok()).ok_or(Unknown::Rotor)?;
    let rotor_kgm2 = motor.rotor_inertia_kgm2.ok_or(Unknown::Rotor)?;
    let gear_ratio = joint.stages.gear_ratio.or(gear.map(|gear| gear.ratio)).ok_or(Unknown::Ratio)?;
    let gear_kgm2 = gear.and_then(|gear| gear.inertia_input_kgm2).unwrap_or_default();
    let ratio = joint.stages.whole_ratio(gear_ratio);
    let input_kgm2 = joint.stages.input_inertia_kgm2(rotor_kgm2, gear_kgm2, gear_ratio);
    Ok(Motor {
        armature_kgm2: ratio * ratio * input_kgm2,
        peak_nm: motor.peak_torque_nm.map(|nm| nm * ratio),
    })
}

/// Half width of the backlash of each gear \[rad\] by name of the joint. The joints with backlash are named in `notes`.
pub(super) fn plays(arm: &Arm, catalogs: &Catalogs, notes: &mut Vec<String>) -> BTreeMap<String, f64> {
    let arcmin_to_rad = PI / (180.0 * 60.0);
    let of_gear =
        |name: &Option<String>| catalogs.gear(name.as_ref()?).ok()?.backlash_arcmin.filter(|x| *x > 0.0);
    let joints = arm.joints().filter(|joint| joint.coupled.is_none());
    let plays: BTreeMap<String, f64> = joints
        .filter_map(|joint| Some((joint.name.clone(), of_gear(&joint.gear)? / 2.0 * arcmin_to_rad)))
        .collect();
    notes.push(match plays.is_empty() {
        true => "no gear of the arm has a backlash in the catalogs: there is no deadband".into(),
        false => format!(
            "backlash is a free hinge with a range, and with a small armature, without which the mass matrix would be singular \
             (a thousandth of the motor's, or what a time step of 0.1 ms needs on the spring of the gear), at: {}",
            plays.keys().cloned().collect::<Vec<_>>().join(", ")
        ),
    });
    plays
}
