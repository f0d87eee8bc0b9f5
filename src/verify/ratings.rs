//! The loads that a drive can bear, computed from its catalog rows (Eqs 7-12 of docs/model.md; docs/sizing.md, "The
//! checks").
//!
//! Speed and duty cycle of a joint are fixed, so every check of a drive compares one torque with one number. The
//! torques are listed in [`Quantity`]. Each check is an entry of [`CHECKS`], which says which quantity it limits and
//! to what value. A further check is one more entry. A further torque is one more quantity, and [`Duty::demand`]
//! computes its value.
//!
//! Nothing of `sizing` is used, so that an error in a threshold there is not repeated here.

use super::bearing::BearingRatings;
use super::demand::{Demand, QUANTITIES, Quantity};
use super::duty::Duty;
use super::fit::{Widths, goes_into_joint, widths};
use super::heat::{MotorHeat, continuous_nm, efficiency, input_inertia_kgm2, peak_nm};
use super::question::AskedStage;
use crate::arm::bearing::Bearing;
use crate::catalog::envelope::Envelope;
use crate::catalog::gear::{Gear, GearKind, LifeLaw};
use crate::catalog::motor::Motor;

/// The limits of one drive: the greatest allowed torque of each quantity, the limits of the output bearing, the
/// heat of the motor, and the widths of gear and motor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ratings {
    most: [f64; QUANTITIES],
    pub bearing: BearingRatings,
    heat: MotorHeat,
    widths: Widths,
}

/// A limit of a drive on one quantity. `most` computes the limit; `None` if the catalog lacks a number that it
/// needs.
struct Check {
    on: Quantity,
    most: fn(&Gear, &Motor, &Duty) -> Option<f64>,
}

/// All checks of torques. A drive for which the catalog lacks a number of one of them is not offered.
const CHECKS: [Check; 8] = [
    Check { on: Quantity::Static, most: motor_hold_nm },
    Check { on: Quantity::Peak, most: |gear, _, _| limit(gear, gear.repeated_peak_torque_nm) },
    Check { on: Quantity::Peak, most: motor_peak_nm },
    Check { on: Quantity::Stop, most: |gear, _, _| limit(gear, gear.momentary_peak_torque_nm) },
    Check { on: Quantity::Stop, most: actuator_stop_nm },
    Check { on: Quantity::Stop, most: |gear, _, _| Some(breaks_nm(gear)) },
    Check {
        on: Quantity::MeanCubed,
        most: |gear, _, _| Some(limit(gear, gear.average_torque_limit_nm)?.powi(3)),
    },
    Check { on: Quantity::MeanCubed, most: life_nm3 },
];

impl Ratings {
    /// Ratings with which a drive passes every check.
    pub(super) const UNLIMITED: Self = Self {
        most: [f64::INFINITY; QUANTITIES],
        bearing: BearingRatings::UNLIMITED,
        heat: MotorHeat::NONE,
        widths: [0.0; 3],
    };

    /// The ratings of a drive under a joint's motion; `None` if the motion is too fast for the drive, if the drive does
    /// not go into the joint, or if the catalog lacks a number. A blank number of the bearing or of a size excludes
    /// nothing. `size` are the dimensions of the gear in the form that the study asks for: housed unit or component
    /// set.
    pub(super) fn of(
        gear: &Gear,
        size: &Envelope,
        motor: &Motor,
        bearing: Option<&Bearing>,
        duty: &Duty,
    ) -> Option<Self> {
        let heat = match duty.checks_heat {
            true => MotorHeat::of(
                gear,
                motor,
                &duty.stage,
                duty.speed_rad_s,
                duty.acceleration_rad_s2,
                &duty.stated.phases,
            )?,
            false => MotorHeat::NONE,
        };
        let bearing = BearingRatings::of(bearing, [duty.mean_speed_rad_s, duty.life_h]);
        let mut ratings = Self { bearing, heat, widths: widths(&duty.fit, size, motor), ..Self::UNLIMITED };
        for check in &CHECKS {
            let most = (check.most)(gear, motor, duty)?;
            let rating = &mut ratings.most[check.on as usize];
            *rating = rating.min(most);
        }
        let goes_in = goes_into_joint(&duty.fit, size, &motor.envelope);
        (turns_as_fast(gear, motor, duty)? && bears_the_stops(gear, duty) && goes_in).then_some(ratings)
    }

    /// Whether a drive with these ratings passes every check under `demand`: torques, bearing, motor heat and widths.
    pub(super) fn hold(&self, demand: &Demand) -> bool {
        // The torques are compared without a conditional jump, because this function is called for many drives of
        // nearly every box.
        let torques = self.most.iter().zip(&demand.torques);
        torques.fold(true, |held, (most, asked)| held & (asked <= most))
            && self.bearing.hold(&demand.bearing)
            && self.heat.holds(&demand.heat)
            && self.widths.iter().zip(&demand.room).all(|(width, room)| width <= room)
    }

    /// Whether a drive with these ratings meets every demand that a drive with the ratings `other` meets.
    pub(super) fn cover(&self, other: &Self) -> bool {
        self.most.iter().zip(&other.most).all(|(a, b)| a >= b)
            && self.bearing.cover(&other.bearing)
            && self.heat.covers(&other.heat)
            && self.widths.iter().zip(&other.widths).all(|(a, b)| a <= b)
    }

    /// Ratings that meet every demand that one of the two meets: the larger rating for each quantity, and the
    /// smaller of each number of heat and width. Smaller numbers are better for heat, because the heat grows with
    /// each of them and with every torque (see [`AskedMotion::grows`](super::question::AskedMotion::grows)).
    pub(super) fn max(&self, other: &Self) -> Self {
        Self {
            most: std::array::from_fn(|i| self.most[i].max(other.most[i])),
            bearing: self.bearing.max(&other.bearing),
            heat: self.heat.min(&other.heat),
            widths: std::array::from_fn(|i| self.widths[i].min(other.widths[i])),
        }
    }

    /// The greatest allowed torque of one quantity (static, peak, stop or mean).
    pub(super) fn on(&self, quantity: Quantity) -> f64 {
        self.most[quantity as usize]
    }
}

/// Whether gear and motor are allowed to turn as fast as the motion of the joint needs. `None` if the catalog lacks a
/// number that this needs.
fn turns_as_fast(gear: &Gear, motor: &Motor, duty: &Duty) -> Option<bool> {
    let of_curve = motor.curve.last().map(|point| point.speed_rpm);
    let of_row = motor.max_speed_rpm.or(motor.rated_speed_rpm);
    let motor_max_rpm = of_row.or(of_curve)?.min(of_curve.unwrap_or(f64::INFINITY));
    let fastest_rpm = input_rpm(gear, duty.speed_rad_s);
    let mean_rpm = input_rpm(gear, duty.mean_speed_rad_s);
    Some(
        is_within(fastest_rpm, limit(gear, gear.max_input_speed_rpm)?)
            && is_within(fastest_rpm * duty.stage.ratio, motor_max_rpm)
            && is_within(mean_rpm, limit(gear, gear.average_input_speed_limit_rpm)?),
    )
}

/// Whether a speed \[rpm\] is at most `most_rpm`. A difference of a trillionth is rounding of unit conversions.
fn is_within(rpm: f64, most_rpm: f64) -> bool {
    rpm - most_rpm <= 1e-12 * most_rpm
}

/// The limit that a rating of a gear sets. For a direct drive or an actuator, a rating that the catalog leaves blank
/// (`None`) means no limit, and the result is infinite. For other gears the limit is then unknown, and the result is
/// `None`.
fn limit(gear: &Gear, rating: Option<f64>) -> Option<f64> {
    match gear.kind {
        GearKind::Direct | GearKind::Actuator => Some(rating.unwrap_or(f64::INFINITY)),
        _ => rating,
    }
}

/// The smaller of the torques at which the gear buckles or its teeth jump \[N m\]; infinite if the catalog has
/// neither.
fn breaks_nm(gear: &Gear) -> f64 {
    [gear.buckling_torque_nm, gear.ratcheting_torque_nm].into_iter().flatten().fold(f64::INFINITY, f64::min)
}

/// Largest torque of an emergency stop at the joint \[N m\]: the peak torque of an actuator, minus the torque that
/// brakes the actuator's own rotor. It is infinite for other drives, whose gear does not carry the torque of the rotor.
fn actuator_stop_nm(gear: &Gear, motor: &Motor, duty: &Duty) -> Option<f64> {
    if gear.kind != GearKind::Actuator {
        return Some(f64::INFINITY);
    }
    let output_kgm2 = input_inertia_kgm2(gear, motor, &duty.stage)? * gear.ratio * gain(gear, &duty.stage)?;
    let most_nm = limit(gear, gear.momentary_peak_torque_nm)?;
    Some(most_nm - duty.stop_factor * duty.acceleration_rad_s2 * output_kgm2)
}

/// Whether the gear survives the number of emergency stops that the study asks for. In all stops together, a
/// strain-wave gear survives 1e4 waves of its wave generator. One turn of the wave generator makes two waves, and a
/// stop is taken as at least one wave.
fn bears_the_stops(gear: &Gear, duty: &Duty) -> bool {
    let waves = 2.0 * input_rpm(gear, duty.speed_rad_s) / 60.0 * duty.stop_s;
    let has_waves = gear.kind == GearKind::StrainWave;
    // The margin is for rounding, because the speed was converted to rad/s and back to rpm.
    duty.emergency_stops.is_none_or(|stops| !has_waves || stops * waves.max(1.0) <= 1e4 * (1.0 + 1e-9))
}

/// Speed of the gear's input \[rpm\] when the joint turns at `output_rad_s`.
fn input_rpm(gear: &Gear, output_rad_s: f64) -> f64 {
    gear.ratio * (output_rad_s * 30.0 / std::f64::consts::PI)
}

/// Torque at the joint for one newton metre at the motor. `None` if the catalog leaves the gear's efficiency blank.
fn gain(gear: &Gear, stage: &AskedStage) -> Option<f64> {
    Some(gear.ratio * efficiency(gear)? * stage.ratio * stage.efficiency)
}

/// Torque at the joint that the motor can hold continuously at rest: `T_rated N η` \[N m\]. Infinite with a brake,
/// which holds the joint instead.
fn motor_hold_nm(gear: &Gear, motor: &Motor, duty: &Duty) -> Option<f64> {
    match duty.has_brake {
        true => Some(f64::INFINITY),
        false => Some(continuous_nm(motor, 0.0)? * gain(gear, &duty.stage)?),
    }
}

/// Torque at the joint when the motor gives its peak torque \[N m\]. The torque that accelerates the rotor and the
/// wave generator is subtracted (Eqs 9-12): `(T_peak - (J_rotor + J_input) N α) N η`.
fn motor_peak_nm(gear: &Gear, motor: &Motor, duty: &Duty) -> Option<f64> {
    let stage = &duty.stage;
    let motor_rad_s2 = gear.ratio * stage.ratio * duty.acceleration_rad_s2;
    let own_nm = input_inertia_kgm2(gear, motor, stage)? * motor_rad_s2;
    let peak_nm = peak_nm(motor, input_rpm(gear, duty.speed_rad_s) * stage.ratio)?;
    Some((peak_nm - own_nm) * gain(gear, stage)?)
}

/// Cube of the mean torque under which the gear reaches the required life \[(N m)³\], from
/// `L10 = L_rated (T_rated / T_mean)^p (n_rated / n_mean)`. The life of a belt, a direct drive or an actuator is
/// checked only if its row states one.
fn life_nm3(gear: &Gear, _: &Motor, duty: &Duty) -> Option<f64> {
    let LifeLaw { rated_h, rated_speed_rpm, exponent } = gear.life;
    if rated_h.is_none() && matches!(gear.kind, GearKind::Belt | GearKind::Direct | GearKind::Actuator) {
        return Some(f64::INFINITY);
    }
    let at_rated_h = rated_h? * (rated_speed_rpm? / input_rpm(gear, duty.mean_speed_rad_s));
    let times = libm::exp(libm::log(at_rated_h / duty.life_h) / exponent);
    Some((gear.rated_torque_nm? * times).powi(3))
}

#[cfg(test)]
mod tests {
    use super::super::question::{AskedDrive, AskedFit, AskedJoint};
    use super::super::question::{AskedMotion, AskedPhase, AskedPhaseKind, LinearTorque};
    use super::*;
    use crate::arm::bearing::BearingSource;
    use crate::arm::extras::ExtrasSource;
    use crate::arm::joint_law::Curve;
    use crate::catalog::Catalogs;

    fn joint() -> AskedJoint {
        AskedJoint {
            name: "j".into(),
            axis: nalgebra::Vector3::y_axis(),
            bearing: BearingSource::Stated(None),
            extras: ExtrasSource::NONE,
            bodies: Default::default(),
            drive: AskedDrive::Given { curve: Curve::Rigid, mass_kg: 0.0 },
            max_speed_rad_s: None,
            has_brake: false,
            duty: Vec::new(),
            fit: AskedFit::default(),
            connection_share: 0.0,
            stage: AskedStage::NONE,
        }
    }

    /// The paper's motion: 1 m/s reached in 0.2 s; ramps of 0.2 s before and after 0.6 s of travel, then 1 s of
    /// rest.
    fn duty() -> Duty {
        let phase = |duration_s, kind| AskedPhase { duration_s, kind };
        let motion = AskedMotion {
            tip_speed_m_s: 1.0,
            ramp_time_s: 0.2,
            emergency_deceleration_m_s2: None,
            min_lever_m: 0.3,
            phases: vec![
                phase(0.2, AskedPhaseKind::Accelerate),
                phase(0.6, AskedPhaseKind::Constant),
                phase(0.2, AskedPhaseKind::Decelerate),
                phase(1.0, AskedPhaseKind::Rest),
            ],
            life_h: 10_000.0,
            linear_torque: LinearTorque::OfInertia,
            gravity_m_s2: 9.81,
            checks_motor_heat: true,
            emergency_stops: None,
        };
        Duty::new(&motion, 1.35, &joint())
    }

    #[test]
    fn the_ratings_of_a_drive_are_those_worked_out_by_hand() {
        let catalogs = Catalogs::builtin();
        let (gear, motor) = (catalogs.gear("HFUC-58-100").unwrap(), catalogs.motor("F11-10").unwrap());
        let ratings = Ratings::of(gear, &gear.envelope, motor, None, &duty()).unwrap();
        let near = |quantity, by_hand: f64| {
            let rating = ratings.on(quantity);
            assert!((rating / by_hand - 1.0).abs() < 1e-12, "{quantity:?}: {rating}, by hand {by_hand}");
        };
        let gain = 100.0 * gear.efficiency.unwrap();
        near(Quantity::Static, motor.rated_torque_nm.unwrap() * gain);
        // 0.00039 kg m² of the rotor and 0.00273 kg m² of the wave generator, α = 5 / 1.35 rad/s²
        let motor_nm = (motor.peak_torque_nm.unwrap() - 0.00312 * 100.0 * 5.0 / 1.35) * gain;
        near(Quantity::Peak, motor_nm.min(gear.repeated_peak_torque_nm.unwrap()));
        near(Quantity::Stop, gear.momentary_peak_torque_nm.unwrap());
        let mean_rpm = 100.0 * 0.4 / 1.35 * 60.0 / std::f64::consts::TAU;
        let life_nm3 = 0.7 * gear.rated_torque_nm.unwrap().powi(3) * 2000.0 / mean_rpm;
        near(Quantity::MeanCubed, life_nm3.min(gear.average_torque_limit_nm.unwrap().powi(3)));
    }

    #[test]
    fn the_demand_is_the_one_worked_out_by_hand() {
        // 40 N m of linear torque on 100 N m of static torque
        let Demand { torques, .. } = duty().demand(-100.0, 40.0 / (5.0 / 1.35), 1.0);
        let mean = (140f64.powi(3) * 0.5 + 100f64.powi(3) * 3.0 + 60f64.powi(3) * 0.5) / 4.0;
        for (asked, by_hand) in torques.iter().zip([100.0, 140.0, 180.0, mean]) {
            assert!((asked / by_hand - 1.0).abs() < 1e-12, "{asked}, by hand {by_hand}");
        }
    }

    #[test]
    fn a_drive_with_a_blank_number_or_that_turns_too_slowly_has_no_ratings() {
        let catalogs = Catalogs::builtin();
        let (gear, motor) = (catalogs.gear("HFUC-58-100").unwrap(), catalogs.motor("F11-10").unwrap());
        let blank = Gear { momentary_peak_torque_nm: None, ..gear.clone() };
        let slow = Gear { max_input_speed_rpm: Some(10.0), ..gear.clone() };
        let unknown = Gear { life: LifeLaw { rated_h: None, ..gear.life }, ..gear.clone() };
        for gear in [blank, slow, unknown] {
            assert_eq!(Ratings::of(&gear, &gear.envelope, motor, None, &duty()), None);
        }
    }
}
