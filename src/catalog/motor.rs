//! Motors: electric servo and hydraulic.

use super::Provenance;

/// Families of motors, as the catalog's `type` column names them.
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
}

impl MotorKind {
    /// Whether the motor is driven by oil.
    pub fn is_hydraulic(self) -> bool {
        matches!(self, MotorKind::HydraulicPiston | MotorKind::HydraulicOrbital)
    }
}

/// One motor. `None` is a figure the catalog does not give.
#[derive(Debug, Clone, PartialEq)]
pub struct Motor {
    /// Model as the vendor prints it; unique in the catalog.
    pub id: String,
    /// Family.
    pub kind: MotorKind,
    /// Vendor.
    pub vendor: String,
    /// Torque the motor holds continuously \[N m\].
    pub rated_torque_nm: Option<f64>,
    /// Torque the motor gives for a short time \[N m\].
    pub peak_torque_nm: Option<f64>,
    /// Speed at rated torque \[rpm\].
    pub rated_speed_rpm: Option<f64>,
    /// Largest speed \[rpm\].
    pub max_speed_rpm: Option<f64>,
    /// Rotor inertia \[kg m²\].
    pub rotor_inertia_kgm2: Option<f64>,
    /// Mass \[kg\].
    pub mass_kg: Option<f64>,
    /// Rated power \[W\].
    pub rated_power_w: Option<f64>,
    /// Where the row comes from.
    pub provenance: Provenance,
}
