//! Joint torques: a torque that acts on a joint beside weight and load, such as that of a counterbalance.

/// A torque that acts on a joint and follows the joint's angle q: `offset + sin_nm sin q + cos_nm cos q`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointTorque {
    /// Constant part \[N m\].
    pub offset_nm: f64,
    /// Part that follows the sine of the angle \[N m\].
    pub sin_nm: f64,
    /// Part that follows the cosine of the angle \[N m\].
    pub cos_nm: f64,
}

impl JointTorque {
    /// The torque at an angle of the joint \[N m\].
    pub fn at(&self, angle_rad: f64) -> f64 {
        let (sin, cos) = libm::sincos(angle_rad);
        self.offset_nm + self.sin_nm * sin + self.cos_nm * cos
    }

    /// What this torque is beyond another.
    pub fn beyond(&self, other: &Self) -> Self {
        Self {
            offset_nm: self.offset_nm - other.offset_nm,
            sin_nm: self.sin_nm - other.sin_nm,
            cos_nm: self.cos_nm - other.cos_nm,
        }
    }

    /// Whether there is none.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}
