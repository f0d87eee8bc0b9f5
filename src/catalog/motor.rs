//! Motors: electric servo, stepper and hydraulic, and the motor within an integrated actuator.

use super::Provenance;
use super::envelope::Envelope;
use std::fmt;

/// Kinds of motors, as in the column `type` of the catalog.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotorKind {
    /// AC servo motor with housing.
    AcServo,
    /// Brushless servo motor with housing.
    BrushlessServo,
    /// Frameless servo motor (rotor and stator only).
    FramelessServo,
    /// Frameless torque motor (rotor and stator only).
    FramelessTorque,
    /// Hydraulic axial piston motor.
    HydraulicPiston,
    /// Hydraulic orbital motor.
    HydraulicOrbital,
    /// Stepper motor.
    Stepper,
    /// The motor inside an actuator of `actuators.csv`. No row of `motors.csv` is of this kind.
    OfActuator,
}

impl MotorKind {
    /// Whether the outer size of a motor of this kind is the side of a square flange. The outer size of motors of the
    /// other kinds is a diameter.
    pub fn has_square_flange(self) -> bool {
        matches!(self, MotorKind::AcServo | MotorKind::Stepper)
    }

    /// All kinds that `motors.csv` may have, in the order of [`Self::WORDS`].
    pub const ALL: [MotorKind; 7] = [
        MotorKind::AcServo,
        MotorKind::BrushlessServo,
        MotorKind::FramelessServo,
        MotorKind::FramelessTorque,
        MotorKind::HydraulicPiston,
        MotorKind::HydraulicOrbital,
        MotorKind::Stepper,
    ];

    /// Words of the column `type`: first the short word of each kind, then the longer words of the built-in file in
    /// the same order.
    pub const WORDS: [&'static str; 14] = [
        "ac-servo",
        "brushless-servo",
        "frameless-servo",
        "frameless-torque",
        "hydraulic-piston",
        "hydraulic-orbital",
        "stepper",
        "AC servo",
        "brushless servo",
        "frameless servo",
        "frameless torque motor",
        "hydraulic axial piston (bent axis)",
        "hydraulic orbital (geroler)",
        "stepper motor",
    ];

    /// Words by which a study can filter motors: two families, then the kinds. `electric` means servo motors.
    pub const CLASS_WORDS: [&'static str; 9] = [
        "electric",
        "hydraulic",
        "ac-servo",
        "brushless-servo",
        "frameless-servo",
        "frameless-torque",
        "hydraulic-piston",
        "hydraulic-orbital",
        "stepper",
    ];

    /// The short word for this kind, e.g. `frameless-servo`.
    pub fn word(self) -> &'static str {
        Self::WORDS[..Self::ALL.len()].get(self as usize).copied().unwrap_or("of-actuator")
    }

    /// The kind that a word of the column `type` means; `None` if it is not one of [`Self::WORDS`].
    pub fn from_word(word: &str) -> Option<Self> {
        let place = Self::WORDS.iter().position(|w| w.eq_ignore_ascii_case(word))?;
        Some(Self::ALL[place % Self::ALL.len()])
    }

    /// The kinds that a filter word means: all kinds of the family `electric` or `hydraulic`, or one kind. `None` for
    /// another word.
    pub fn of_class(word: &str) -> Option<Vec<Self>> {
        match word.to_lowercase().as_str() {
            "electric" => Some(Self::ALL.into_iter().filter(|kind| kind.is_servo()).collect()),
            "hydraulic" => Some(Self::ALL.into_iter().filter(|kind| kind.is_hydraulic()).collect()),
            kind => Self::from_word(kind).map(|kind| vec![kind]),
        }
    }

    /// Whether the motor is an electric servo motor.
    pub fn is_servo(self) -> bool {
        use MotorKind::{AcServo, BrushlessServo, FramelessServo, FramelessTorque};
        matches!(self, AcServo | BrushlessServo | FramelessServo | FramelessTorque)
    }

    /// Whether the motor is driven by oil.
    pub fn is_hydraulic(self) -> bool {
        matches!(self, MotorKind::HydraulicPiston | MotorKind::HydraulicOrbital)
    }
}

impl fmt::Display for MotorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}

/// One point of a motor's torque curve, as in `motor_curves.csv`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorCurvePoint {
    /// Speed of the motor \[rpm\].
    pub speed_rpm: f64,
    /// Torque that the motor can give continuously at this speed \[N m\]; `None` if unknown.
    pub continuous_torque_nm: Option<f64>,
    /// Torque that the motor can give for a short time at this speed \[N m\]. For a stepper, it is the largest torque
    /// without loss of steps. `None` if unknown.
    pub peak_torque_nm: Option<f64>,
}

/// One motor. `None` means that the catalog does not give the number.
#[derive(Debug, Clone, PartialEq)]
pub struct Motor {
    /// Model name as the vendor prints it, which is unique in the catalog.
    pub id: String,
    /// Kind of the motor.
    pub kind: MotorKind,
    /// Vendor of the motor.
    pub vendor: String,
    /// Torque that the motor can give continuously \[N m\]; `None` if unknown.
    pub rated_torque_nm: Option<f64>,
    /// Torque that the motor can give for a short time \[N m\]; `None` if unknown.
    pub peak_torque_nm: Option<f64>,
    /// Speed at rated torque \[rpm\]; `None` if unknown.
    pub rated_speed_rpm: Option<f64>,
    /// Largest speed of the motor \[rpm\]; `None` if unknown.
    pub max_speed_rpm: Option<f64>,
    /// Rotor inertia \[kg m²\]; `None` if unknown.
    pub rotor_inertia_kgm2: Option<f64>,
    /// Mass of the motor \[kg\]; `None` if unknown.
    pub mass_kg: Option<f64>,
    /// Torque curve, by ascending speed; empty if only the single ratings above are known.
    pub curve: Vec<MotorCurvePoint>,
    /// Rated power \[W\]; `None` if unknown.
    pub rated_power_w: Option<f64>,
    /// Outer size; for a frameless motor, the outer size of rotor and stator.
    pub envelope: Envelope,
    /// Source of the row.
    pub provenance: Provenance,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn class_words_name_families_and_kinds() {
        assert_eq!(MotorKind::of_class("electric").map(|k| k.len()), Some(4));
        assert_eq!(MotorKind::of_class("Hydraulic").map(|k| k.len()), Some(2));
        assert_eq!(MotorKind::of_class("frameless-torque"), Some(vec![MotorKind::FramelessTorque]));
        assert_eq!(MotorKind::of_class("steam"), None);
        assert!(MotorKind::CLASS_WORDS.iter().all(|word| MotorKind::of_class(word).is_some()));
    }

    #[test]
    fn every_kind_is_read_back_from_its_word() {
        for kind in MotorKind::ALL {
            assert_eq!(MotorKind::from_word(&kind.to_string()), Some(kind));
        }
    }
}
