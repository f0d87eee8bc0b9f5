//! Numbers that sizing a joint needs and a part's row leaves blank, each with its purpose.

use super::gear::{Gear, GearKind, GearMass};
use super::motor::Motor;
use std::fmt;

/// A number that a part's row leaves blank.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lack {
    /// Name of the column that the number would have.
    pub figure: &'static str,
    /// The check or property for which the number is needed.
    pub purpose: &'static str,
}

impl fmt::Display for Lack {
    /// Writes the column and its purpose: `rated_life_h (life)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({})", self.figure, self.purpose)
    }
}

/// The missing numbers in one line: `no rated_life_h (life), no k1_nm_per_rad (torsion)`.
pub(crate) fn words(lacks: &[Lack]) -> String {
    lacks.iter().map(|lack| format!("no {lack}")).collect::<Vec<_>>().join(", ")
}

fn blank(figures: &[(Option<f64>, &'static str, &'static str)]) -> Vec<Lack> {
    let blank = figures.iter().filter(|(figure, ..)| figure.is_none());
    blank.map(|&(_, figure, purpose)| Lack { figure, purpose }).collect()
}

impl Gear {
    /// The numbers that the row of the gear leaves blank and that must be known before the gear can be chosen for a
    /// joint. `mass` says which mass is needed: the mass of the component set or of the housed unit. Empty if every
    /// check of the gear can be made.
    ///
    /// ```
    /// use armwright::catalog::{Catalogs, GearMass};
    ///
    /// let catalogs = Catalogs::builtin();
    /// let mut gear = catalogs.gear("HFUC-58-100").unwrap().clone();
    /// assert!(gear.lacks(GearMass::HousedUnit).is_empty());
    /// gear.life.rated_h = None;
    /// assert_eq!(gear.lacks(GearMass::HousedUnit)[0].to_string(), "rated_life_h (life)");
    /// ```
    pub fn lacks(&self, mass: GearMass) -> Vec<Lack> {
        let mut lacks =
            if self.kind.has_no_ratings_of_its_own() { Vec::new() } else { self.lacking_ratings() };
        lacks.extend(self.missing_of_torsion().into_iter().map(|figure| Lack { figure, purpose: "torsion" }));
        let column = match mass {
            _ if self.kind == GearKind::Actuator => "mass_kg",
            GearMass::ComponentSet => "mass_component_set_kg",
            GearMass::HousedUnit => "mass_housed_unit_kg",
        };
        lacks.extend(blank(&[(self.mass_kg(mass), column, "mass")]));
        lacks
    }

    /// The missing limits of torque and speed. For a belt, a blank limit is replaced by the next lower limit of its
    /// row, so its rated torque and its largest speed suffice.
    fn lacking_limits(&self) -> Vec<Lack> {
        let is_belt = self.kind == GearKind::Belt;
        let mut lacks = match is_belt && self.average_torque_limit_nm.is_none() {
            true => self.lacking_of_belt(),
            false => blank(&[
                (self.repeated_peak_torque_nm, "repeated_peak_torque_nm", "peak"),
                (self.average_torque_limit_nm, "average_torque_limit_nm", "mean"),
                (self.momentary_peak_torque_nm, "momentary_peak_torque_nm", "stop"),
            ]),
        };
        let mean_speed_rpm = self.average_input_speed_limit_rpm;
        lacks.extend(blank(&[(self.max_input_speed_rpm, "max_input_speed_rpm", "input speed")]));
        if !is_belt || self.max_input_speed_rpm.is_some() {
            lacks.extend(blank(&[(mean_speed_rpm, "average_input_speed_limit_rpm", "mean input speed")]));
        }
        lacks
    }

    /// The entry for a belt whose limit on the mean torque and whose rated torque are both blank. It names the rated
    /// torque, which would replace every blank torque limit, and the checks that would use it.
    fn lacking_of_belt(&self) -> Vec<Lack> {
        let is_blank = |rating: Option<f64>| rating.is_none();
        let purpose = match [self.repeated_peak_torque_nm, self.momentary_peak_torque_nm].map(is_blank) {
            [true, true] => "mean, peak and stop",
            [true, false] => "mean and peak",
            [false, true] => "mean and stop",
            [false, false] => "mean",
        };
        vec![Lack { figure: "rated_torque_nm", purpose }]
    }

    /// The missing ratings that the checks of a gear with teeth, or of a belt, need.
    fn lacking_ratings(&self) -> Vec<Lack> {
        let mut lacks = self.lacking_limits();
        lacks.extend(blank(&[
            (self.inertia_input_kgm2, "inertia_input_kgm2", "motor peak"),
            (self.efficiency, "efficiency_rated_2000rpm", "motor torque"),
        ]));
        if self.kind.wears_out() || self.life.rated_h.is_some() {
            lacks.extend(blank(&[
                (self.rated_torque_nm, "rated_torque_nm", "life"),
                (self.life.rated_h, "rated_life_h", "life"),
                (self.life.rated_speed_rpm, "rated_life_speed_rpm", "life"),
            ]));
        }
        lacks
    }
}

impl Motor {
    /// The numbers that the row of the motor leaves blank and that must be known before the motor can be chosen for a
    /// joint. Empty if every check of the motor can be made. For the motor of an actuator, the names are columns
    /// of `actuators.csv`.
    pub fn lacks(&self) -> Vec<Lack> {
        let of_actuator = self.kind == super::motor::MotorKind::OfActuator;
        let (inertia, of_inertia) = match of_actuator {
            true => ("inertia_output_kgm2", "peak and stop and rms"),
            false => ("rotor_inertia_kgm2", "peak and rms"),
        };
        let continuous = self.curve.iter().find_map(|point| point.continuous_torque_nm);
        let peak = self.curve.iter().find_map(|point| point.peak_torque_nm);
        let fastest = self.curve.last().map(|point| point.speed_rpm);
        blank(&[
            (continuous.or(self.rated_torque_nm), "rated_torque_nm", "hold and rms"),
            (peak.or(self.peak_torque_nm), "peak_torque_nm", "peak"),
            (fastest.or(self.max_speed_rpm).or(self.rated_speed_rpm), "max_speed_rpm", "speed"),
            (self.rotor_inertia_kgm2, inertia, of_inertia),
            (self.mass_kg, "mass_kg", "mass"),
        ])
    }
}
