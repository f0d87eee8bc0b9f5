//! A drive: a gear and a motor, with torques on either side of the gear (Eqs 9-12 of docs/model.md).

use super::demand::{JointMotion, input_speed_rpm};
use crate::arm::bearing::{Bearing, BearingSource};
use crate::arm::extras::{Extras, ExtrasSource};
use crate::arm::transmission::{Stage, Stages};
use crate::catalog::envelope::Envelope;
use crate::catalog::gear::{Gear, GearKind, GearMass};
use crate::catalog::motor::Motor;

/// A rating that the catalog leaves blank.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MissingRating(
    /// Name of the rating, as its column is called.
    pub &'static str,
);

impl std::fmt::Display for MissingRating {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.0)
    }
}

/// A rating, or its name if the catalog leaves it blank.
pub(super) type Rating = Result<f64, MissingRating>;

/// The rating, or an error with its name if it is blank.
pub(super) fn known(rating: Option<f64>, name: &'static str) -> Rating {
    rating.ok_or(MissingRating(name))
}

/// The rating of a gear, or an error with its name if it is blank. Some kinds of gear, such as direct drives, have no
/// ratings of their own; for these a blank rating counts as the value `none`.
pub(super) fn if_any(gear: &Gear, rating: Option<f64>, none: f64, name: &'static str) -> Rating {
    match rating {
        None if gear.kind.has_no_ratings_of_its_own() => Ok(none),
        rating => known(rating, name),
    }
}

/// A mass rounded to the microgram \[kg\]. Sums of catalog masses that are equal on paper are then equal as
/// floating-point numbers too.
pub(crate) fn to_the_microgram(mass_kg: f64) -> f64 {
    const PER_KG: f64 = 1e9;
    (mass_kg * PER_KG).round() / PER_KG
}

/// A gear and a motor, as they are mounted in a joint.
///
/// ```
/// use armwright::catalog::Catalogs;
/// use armwright::arm::{BearingSource, ExtrasSource, Stage};
/// use armwright::catalog::GearMass;
/// use armwright::sizing::{Drive, MotionRequirement};
///
/// let catalogs = Catalogs::builtin();
/// let (gear, motor) = (catalogs.gear("HFUC-58-100").unwrap(), catalogs.motor("F11-10").unwrap());
/// let drive = Drive {
///     gear,
///     motor,
///     gear_mass: GearMass::ComponentSet,
///     bearing: BearingSource::OfGear,
///     extras: ExtrasSource::NONE,
///     stage: Stage::NONE,
/// };
/// assert_eq!(drive.name(), "HFUC-58-100 + F11-10");
/// assert_eq!(drive.mass_kg().unwrap(), 12.2);
/// // Eq 11: the torque that accelerates rotor and wave generator, on the motor's side [N m]
/// let motion = MotionRequirement::default().joint_motion(1.35, None);
/// let rotary_nm = drive.rotary_torque_motor_nm(&motion).expect("all ratings are known");
/// assert!((rotary_nm - 1.156).abs() < 1e-3);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive<'c> {
    /// The gear.
    pub gear: &'c Gear,
    /// The motor.
    pub motor: &'c Motor,
    /// Which mass of the gear is used: the mass of the component set or the mass of the housed unit.
    pub gear_mass: GearMass,
    /// Where the output bearing comes from.
    pub bearing: BearingSource,
    /// Where the masses beyond gear, motor and bearing come from.
    pub extras: ExtrasSource,
    /// Belt, chain or spur stage between motor and gear. Its mass is not part of the mass of the drive.
    pub stage: Stage,
}

impl Drive<'_> {
    /// Name of the drive for messages: `gear + motor`, or the model if it is an actuator.
    pub fn name(&self) -> String {
        if self.gear.kind == GearKind::Actuator {
            return self.gear.id.clone();
        }
        format!("{} + {}", self.gear.id, self.motor.id)
    }

    /// Outer size of the gear, as far as it is known.
    pub(super) fn gear_envelope(&self) -> Envelope {
        self.gear.envelope_as(self.gear_mass)
    }

    /// The masses of the joint in addition to gear, motor and bearing: housing, brake, encoders, cables and so on.
    pub fn extras(&self) -> Extras {
        self.extras.with_parts(self.gear, self.motor, self.gear_mass)
    }

    /// Mass of gear, motor and extras \[kg\].
    ///
    /// # Errors
    /// The name of the mass that the catalog leaves blank.
    pub fn mass_with_extras_kg(&self) -> Result<f64, MissingRating> {
        Ok(self.mass_kg()? + self.extras().total_kg())
    }

    /// The output bearing; `None` if the joint has none.
    pub fn bearing(&self) -> Option<Bearing> {
        self.bearing.with_gear(self.gear, self.gear_mass)
    }

    /// Reduction ratio N of stage and gear.
    pub fn ratio(&self) -> f64 {
        self.stages().whole_ratio(self.gear.ratio)
    }

    fn stages(&self) -> Stages {
        Stages { before: self.stage, ..Stages::default() }
    }

    /// Speed of the motor while the joint cruises \[rpm\].
    pub fn motor_speed_rpm(&self, motion: &JointMotion) -> f64 {
        self.stage.ratio * input_speed_rpm(self.gear, motion)
    }

    /// Mass of gear and motor \[kg\], rounded to the microgram.
    ///
    /// # Errors
    /// The name of the mass that the catalog leaves blank.
    pub fn mass_kg(&self) -> Result<f64, MissingRating> {
        let name = match self.gear_mass {
            _ if self.gear.kind == GearKind::Actuator => "mass_kg",
            GearMass::ComponentSet => "gear mass_component_set_kg",
            GearMass::HousedUnit => "gear mass_housed_unit_kg",
        };
        let sum_kg =
            known(self.gear.mass_kg(self.gear_mass), name)? + known(self.motor.mass_kg, "motor mass_kg")?;
        Ok(to_the_microgram(sum_kg))
    }

    /// Eq 9: J_in, the inertia of rotor and gear input (wave generator), referred to the motor \[kg m²\]. It includes
    /// the inertia of a stage between motor and gear.
    ///
    /// # Errors
    /// The name of the inertia that the catalog leaves blank.
    pub fn input_inertia_kgm2(&self) -> Result<f64, MissingRating> {
        let rotor = match self.gear.kind {
            GearKind::Actuator => "inertia_output_kgm2",
            _ => "rotor_inertia_kgm2",
        };
        let rotor_kgm2 = known(self.motor.rotor_inertia_kgm2, rotor)?;
        let gear_kgm2 = if_any(self.gear, self.gear.inertia_input_kgm2, 0.0, "inertia_input_kgm2")?;
        Ok(self.stages().input_inertia_kgm2(rotor_kgm2, gear_kgm2, self.gear.ratio))
    }

    /// Efficiency of stage and gear.
    ///
    /// # Errors
    /// The name of the rating if the catalog leaves it blank.
    pub fn efficiency(&self) -> Result<f64, MissingRating> {
        let gear = if_any(self.gear, self.gear.efficiency, 1.0, "efficiency_rated_2000rpm")?;
        Ok(self.stage.efficiency * gear)
    }

    /// Torque at the joint per newton metre of torque at the motor: N η, ratio times efficiency.
    pub(super) fn gain(&self) -> Rating {
        Ok(self.ratio() * self.efficiency()?)
    }

    /// Torque that accelerates rotor and gear input of this drive, on the motor's side \[N m\] (Eq 11).
    ///
    /// # Errors
    /// The name of the inertia that the catalog leaves blank.
    pub fn rotary_torque_motor_nm(&self, motion: &JointMotion) -> Result<f64, MissingRating> {
        let inertia = self.input_inertia_kgm2()?;
        Ok(rotary_torque_motor_nm(inertia, self.ratio(), motion.acceleration_rad_s2))
    }

    /// Torque of the motor while the joint accelerates and the gear transmits `peak_torque_nm`, on the motor's side
    /// \[N m\] (Eq 12).
    ///
    /// # Errors
    /// The name of the rating that the catalog leaves blank.
    pub fn peak_motor_torque_nm(
        &self,
        motion: &JointMotion,
        peak_torque_nm: f64,
    ) -> Result<f64, MissingRating> {
        Ok(motor_torque_nm(peak_torque_nm, self.gain()?, self.rotary_torque_motor_nm(motion)?))
    }
}

/// Torque that accelerates rotor and gear input, on the motor's side \[N m\]: T_rot = J_in N α (Eqs 10-11).
///
/// In the paper's Eq 10, n_j is the speed of the motor, so θ̈ there is N α. `acceleration_rad_s2` is α, the
/// acceleration of the joint.
pub fn rotary_torque_motor_nm(input_inertia_kgm2: f64, ratio: f64, acceleration_rad_s2: f64) -> f64 {
    input_inertia_kgm2 * ratio * acceleration_rad_s2
}

/// Torque that accelerates rotor and gear input, referred to the joint \[N m\]: J_in N² α, which is N times the torque
/// on the motor's side (Eqs 10-11).
pub fn rotary_torque_output_nm(input_inertia_kgm2: f64, ratio: f64, acceleration_rad_s2: f64) -> f64 {
    ratio * rotary_torque_motor_nm(input_inertia_kgm2, ratio, acceleration_rad_s2)
}

/// Torque of the motor while the joint accelerates, on the motor's side \[N m\]: T / (N η) + T_rot, where `gain` is N η
/// (Eq 12).
pub fn motor_torque_nm(output_torque_nm: f64, gain: f64, rotary_torque_motor_nm: f64) -> f64 {
    output_torque_nm / gain + rotary_torque_motor_nm
}

/// Input speed of a strain-wave gear at which it excites a natural frequency \[rpm\]. The wave generator deforms the
/// flexspline twice in each turn, so the excitation frequency is 2 n / 60, and n = 30 f.
pub fn critical_rpm(frequency_hz: f64) -> f64 {
    30.0 * frequency_hz
}

#[cfg(test)]
mod tests {
    use super::super::testing::{component_set, f11_10, hfuc_58_100, housed};
    use super::*;
    use crate::sizing::requirement::MotionRequirement;

    #[test]
    fn the_papers_0_14_and_14_4_newton_metres_count_the_rotor_of_f11_10_alone() {
        // J = 0.00039 kg m² of catalogs/motors.csv, row F11-10, without the gear's wave generator.
        let rotor = f11_10().rotor_inertia_kgm2.unwrap();
        assert_eq!(rotor, 0.00039);
        assert_eq!(format!("{:.2}", rotary_torque_motor_nm(rotor, 100.0, 3.7)), "0.14");
        assert_eq!(format!("{:.1}", rotary_torque_output_nm(rotor, 100.0, 3.7)), "14.4");
    }

    #[test]
    fn with_the_wave_generator_of_hfuc_58_the_rotary_torque_is_eight_times_that() {
        // Eq 9 adds the inertia of the gear's input: 0.00273 kg m² (gears.csv, HFUC-58-100), seven times the inertia
        // of the rotor.
        let (gear, motor) = (hfuc_58_100(), f11_10());
        let drive = component_set(&gear, &motor);
        let inertia = drive.input_inertia_kgm2().unwrap();
        assert_eq!(inertia, 0.00312);
        assert_eq!(format!("{:.2}", rotary_torque_motor_nm(inertia, 100.0, 3.7)), "1.15");
        assert_eq!(format!("{:.1}", rotary_torque_output_nm(inertia, 100.0, 3.7)), "115.4");
    }

    #[test]
    fn the_motor_carries_the_load_through_the_gear_and_its_own_inertia_directly() {
        let (gear, motor) = (hfuc_58_100(), f11_10());
        let drive = housed(&gear, &motor);
        let motion = MotionRequirement::default().joint_motion(1.35, None);
        let torque = drive.peak_motor_torque_nm(&motion, 858.0).unwrap();
        let by_hand = 858.0 / (100.0 * 0.78) + 0.00312 * 100.0 * 5.0 / 1.35;
        assert!((torque - by_hand).abs() < 1e-12);
    }

    #[test]
    fn the_mass_is_that_of_the_build_asked_for_and_a_blank_is_named() {
        let (gear, mut motor) = (hfuc_58_100(), f11_10());
        let mass = |gear_mass, motor: &Motor| Drive { gear_mass, ..housed(&gear, motor) }.mass_kg();
        assert!((mass(GearMass::ComponentSet, &motor).unwrap() - 12.2).abs() < 1e-12, "Table 1");
        assert!((mass(GearMass::HousedUnit, &motor).unwrap() - 22.1).abs() < 1e-12);
        motor.mass_kg = None;
        assert_eq!(mass(GearMass::HousedUnit, &motor), Err(MissingRating("motor mass_kg")));
    }
}
