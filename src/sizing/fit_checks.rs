//! The checks of the sizes of parts one by one, as they are printed.

use super::check::{Check, CheckKind, check};
use super::drive::{Drive, Rating, known};
use super::fit::{FitRequirement, LinkRoom, MotorPlace};
use crate::catalog::gear::{Gear, GearMass};

/// Name of a blank size of a gear, for messages: its column or, for a component set, words that say that the catalog
/// has no such size.
fn size_of(which: GearMass, column: &'static str) -> &'static str {
    match which {
        GearMass::ComponentSet => "the size of the component set, which the catalog does not have",
        GearMass::HousedUnit => column,
    }
}

/// The checks of the diameter and the bore of a gear.
pub(super) fn gear_fits(
    gear: &Gear,
    which: GearMass,
    fit: &FitRequirement,
    room: &LinkRoom,
) -> impl Iterator<Item = Check> {
    let size = gear.envelope_as(which);
    let width = known(size.outer_diameter_m, size_of(which, "gear outer_diameter_mm"));
    let bore = known(size.hollow_bore_m, size_of(which, "gear hollow_bore_mm"));
    let width = at_most(CheckKind::GearWidth, width, room.gear_m);
    [width, fit.least_bore_m().map(|least_m| bore_check(CheckKind::GearBore, least_m, bore))]
        .into_iter()
        .flatten()
}

/// The checks of the diameter, the length and the bore of a motor, and of the length of motor and gear together.
pub(super) fn motor_fits(
    drive: &Drive,
    fit: &FitRequirement,
    room: &LinkRoom,
) -> impl Iterator<Item = Check> {
    let (gear, motor) = (&drive.gear_envelope(), &drive.motor.envelope);
    let width = known(motor.outer_diameter_m, "motor outer_diameter_mm");
    let clear_m = if drive.motor.kind.has_square_flange() { room.square_m } else { room.motor_m };
    let blank = match gear.length_m {
        None => size_of(drive.gear_mass, "gear length_mm"),
        Some(_) => "motor length_mm",
    };
    let length = known(fit.length_m(gear, motor), blank);
    let own_length = known(motor.length_m, "motor length_mm");
    let bore = known(motor.hollow_bore_m, "motor hollow_bore_mm");
    let least_bore_m = fit.least_bore_m().filter(|_| fit.motor == MotorPlace::Behind);
    let checks = [
        at_most(CheckKind::MotorWidth, width, clear_m),
        fit.most_motor_length_m().and_then(|most_m| at_most(CheckKind::MotorLength, own_length, most_m)),
        least_bore_m.map(|least_m| bore_check(CheckKind::MotorBore, least_m, bore)),
        at_most(CheckKind::DriveLength, length, fit.most_length_m().unwrap_or(f64::INFINITY)),
    ];
    checks.into_iter().flatten()
}

/// The check that a size is at most `room_m` \[m\]; `None` if `room_m` is infinite, which means no limit.
fn at_most(kind: CheckKind, size: Rating, room_m: f64) -> Option<Check> {
    let in_mm = |m: f64| m * 1e3;
    let needed =
        || check(kind, size.map(in_mm), Ok(in_mm(room_m)), size.unwrap_or(0.0), size.map(|_| room_m));
    room_m.is_finite().then(needed)
}

/// The check that a bore is at least `least_m` wide \[m\].
fn bore_check(kind: CheckKind, least_m: f64, bore: Rating) -> Check {
    check(kind, Ok(least_m * 1e3), bore.map(|m| m * 1e3), least_m, bore)
}

#[cfg(test)]
mod tests {
    use super::super::check::CheckState;
    use super::super::checks::{all_hold, checks};
    use super::super::demand::JointMotion;
    use super::super::limits::DriveLimits;
    use super::super::requirement::MotionRequirement;
    use super::super::testing::{ample, housed};
    use super::*;
    use crate::catalog::envelope::Envelope;
    use crate::catalog::motor::Motor;

    fn motion() -> JointMotion {
        MotionRequirement::default().joint_motion(1.35, None)
    }

    /// Messages of the failed checks of a drive with ample ratings, after one change. The link is 150 mm wide and has
    /// a hollow of 140 mm.
    fn misfits(change: fn(&mut Gear, &mut Motor, &mut FitRequirement)) -> Vec<String> {
        let mut fit = FitRequirement {
            gear_to_link_max: Some(1.2),
            motor: MotorPlace::Behind,
            cable_bore_min_m: Some(0.02),
            drive_length_max_m: Some(0.2),
            link_length_m: Some(0.15),
        };
        let (mut gear, mut motor) = ample();
        gear.envelope =
            Envelope { outer_diameter_m: Some(0.18), length_m: Some(0.08), hollow_bore_m: Some(0.02) };
        motor.envelope =
            Envelope { outer_diameter_m: Some(0.14), length_m: Some(0.12), hollow_bore_m: Some(0.02) };
        change(&mut gear, &mut motor, &mut fit);
        let motion = JointMotion { fit, ..motion() };
        let demand = motion.demand_of_torques(300.0, 100.0).with_room(fit.room(0.15, [0.14; 2]));
        let drive = housed(&gear, &motor);
        let checks = checks(&drive, &motion, &demand);
        let holds = DriveLimits::of(&drive, &motion).is_ok_and(|limits| limits.hold(&demand));
        assert_eq!(holds, all_hold(&checks), "search and checks");
        let said = |c: &&Check| c.kind.is_fit() && c.state != CheckState::Holds;
        checks.iter().filter(said).map(|c| format!("{}: {c}", c.kind.label())).collect()
    }

    #[test]
    fn each_size_is_compared_with_its_own_room_and_just_fits() {
        assert_eq!(misfits(|_, _, _| ()), [""; 0], "every part just fits");
        assert_eq!(
            misfits(|g, _, _| g.envelope.outer_diameter_m = Some(0.181)),
            ["gear width: width 181 mm needed, 180 allowed"]
        );
        assert_eq!(
            misfits(|g, _, _| g.envelope.hollow_bore_m = Some(0.019)),
            ["gear bore: bore 20.0 mm needed, 19.0 allowed"]
        );
        assert_eq!(
            misfits(|_, m, _| m.envelope.hollow_bore_m = Some(0.0)),
            ["motor bore: bore 20.0 mm needed, 0.0 allowed"]
        );
        assert_eq!(
            misfits(|_, m, _| m.envelope.length_m = Some(0.13)),
            ["drive length: length of the drive 210 mm needed, 200 allowed"]
        );
        assert_eq!(
            misfits(|_, m, fit| (m.envelope.outer_diameter_m, fit.motor) = (Some(0.15), MotorPlace::InLink)),
            ["motor width: width 150 mm needed, 140 allowed"]
        );
        assert_eq!(
            misfits(|_, m, fit| (m.envelope.length_m, fit.motor) = (Some(0.16), MotorPlace::InLink)),
            ["motor length: length 160 mm needed, 150 allowed"]
        );
    }

    #[test]
    fn a_motor_that_is_not_behind_the_gear_has_neither_length_nor_bore_on_the_axis() {
        for place in [MotorPlace::InLink, MotorPlace::Beside] {
            let (mut gear, mut motor) = ample();
            gear.envelope.length_m = Some(0.2);
            motor.envelope =
                Envelope { outer_diameter_m: None, length_m: Some(9.0), hollow_bore_m: Some(0.0) };
            let fit = FitRequirement {
                motor: place,
                cable_bore_min_m: Some(0.02),
                drive_length_max_m: Some(0.2),
                ..FitRequirement::default()
            };
            assert!(fit.allows(&gear.envelope, &motor.envelope), "{place:?}");
            assert!(
                !FitRequirement { motor: MotorPlace::Behind, ..fit }.allows(&gear.envelope, &motor.envelope)
            );
        }
    }

    #[test]
    fn of_a_component_set_no_size_is_known_whatever_the_housed_unit_has() {
        let (mut gear, mut motor) = ample();
        gear.mass_component_set_kg = gear.mass_housed_unit_kg;
        gear.envelope =
            Envelope { outer_diameter_m: Some(9.0), length_m: Some(9.0), hollow_bore_m: Some(0.0) };
        motor.envelope =
            Envelope { outer_diameter_m: Some(0.1), length_m: Some(0.1), hollow_bore_m: Some(0.1) };
        let fit = FitRequirement {
            gear_to_link_max: Some(1.2),
            motor: MotorPlace::Behind,
            cable_bore_min_m: Some(0.02),
            drive_length_max_m: Some(0.2),
            link_length_m: None,
        };
        let motion = JointMotion { fit, ..motion() };
        let demand = motion.demand_of_torques(300.0, 100.0).with_room(fit.room(0.15, [0.14; 2]));
        let holds = |which| {
            let drive = Drive { gear_mass: which, ..housed(&gear, &motor) };
            let said = checks(&drive, &motion, &demand).into_iter().filter(|c| c.kind.is_fit());
            let said: Vec<String> = said.map(|c| c.to_string()).collect();
            (DriveLimits::of(&drive, &motion).is_ok_and(|limits| limits.hold(&demand)), said)
        };
        assert!(!holds(GearMass::HousedUnit).0);
        let (fits, said) = holds(GearMass::ComponentSet);
        assert!(fits, "nothing is known that does not fit");
        let lacks = "not checked: lacks the size of the component set, which the catalog does not have";
        assert_eq!(said.iter().filter(|words| words.ends_with(lacks)).count(), 3, "{said:?}");
    }

    #[test]
    fn a_size_that_is_blank_is_said_and_excludes_nothing() {
        let blank = misfits(|g, m, fit| {
            (g.envelope, m.envelope, fit.motor) =
                (Envelope::default(), Envelope::default(), MotorPlace::Behind);
        });
        assert_eq!(
            blank,
            [
                "gear width: width not checked: lacks gear outer_diameter_mm",
                "gear bore: bore not checked: lacks gear hollow_bore_mm",
                "motor bore: bore not checked: lacks motor hollow_bore_mm",
                "drive length: length of the drive not checked: lacks gear length_mm",
            ]
        );
    }
}
