//! Joint torques: a torque on a joint in addition to weight and load, such as the torque of a counterbalance.

/// A torque on a joint as a function of its angle q: `offset + sin_nm sin q + cos_nm cos q`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointTorque {
    /// Constant part \[N m\].
    pub offset_nm: f64,
    /// Amplitude of the part proportional to the sine of the angle \[N m\].
    pub sin_nm: f64,
    /// Amplitude of the part proportional to the cosine of the angle \[N m\].
    pub cos_nm: f64,
}

impl JointTorque {
    /// The torque at an angle of the joint \[N m\].
    pub fn at(&self, angle_rad: f64) -> f64 {
        let (sin, cos) = libm::sincos(angle_rad);
        self.offset_nm + self.sin_nm * sin + self.cos_nm * cos
    }

    /// The difference between two torques as functions of the angle: this torque minus `other`.
    pub fn beyond(&self, other: &Self) -> Self {
        Self {
            offset_nm: self.offset_nm - other.offset_nm,
            sin_nm: self.sin_nm - other.sin_nm,
            cos_nm: self.cos_nm - other.cos_nm,
        }
    }

    /// Whether the torque is zero at every angle.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}
