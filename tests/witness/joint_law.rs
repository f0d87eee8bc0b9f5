//! How far a joint turns under a torque.

use serde_json::Value;

use super::arm::number;

/// The wind-up of a strain-wave gear: odd, slope 1/K1 to T1, 1/K2 to T2, 1/K3 beyond.
#[derive(Clone, Copy, Debug)]
pub struct ThreeSegment {
    pub k1_nm_per_rad: f64,
    pub k2_nm_per_rad: f64,
    pub k3_nm_per_rad: f64,
    pub t1_nm: f64,
    pub t2_nm: f64,
}

impl ThreeSegment {
    pub fn from_json(windup: &Value) -> Self {
        Self {
            k1_nm_per_rad: number(windup, "k1_nm_per_rad"),
            k2_nm_per_rad: number(windup, "k2_nm_per_rad"),
            k3_nm_per_rad: number(windup, "k3_nm_per_rad"),
            t1_nm: number(windup, "t1_nm"),
            t2_nm: number(windup, "t2_nm"),
        }
    }

    fn angle_rad(&self, torque_nm: f64) -> f64 {
        let size_nm = torque_nm.abs();
        let first_nm = size_nm.min(self.t1_nm);
        let second_nm = (size_nm.min(self.t2_nm) - self.t1_nm).max(0.0);
        let third_nm = (size_nm - self.t2_nm).max(0.0);
        let size_rad =
            first_nm / self.k1_nm_per_rad + second_nm / self.k2_nm_per_rad + third_nm / self.k3_nm_per_rad;
        size_rad * torque_nm.signum()
    }

    fn slope_rad_per_nm(&self, torque_nm: f64) -> f64 {
        let size_nm = torque_nm.abs();
        if size_nm <= self.t1_nm {
            1.0 / self.k1_nm_per_rad
        } else if size_nm <= self.t2_nm {
            1.0 / self.k2_nm_per_rad
        } else {
            1.0 / self.k3_nm_per_rad
        }
    }
}

/// One compliance in a joint.
#[derive(Clone, Copy, Debug)]
pub enum Term {
    /// A spring.
    Linear { stiffness_nm_per_rad: f64 },
    /// A gear's curve.
    ThreeSegment(ThreeSegment),
    /// h tanh(T / T_c).
    LostMotion { half_width_rad: f64, torque_nm: f64 },
}

impl Term {
    fn angle_rad(&self, torque_nm: f64) -> f64 {
        match *self {
            Self::Linear { stiffness_nm_per_rad } => torque_nm / stiffness_nm_per_rad,
            Self::ThreeSegment(curve) => curve.angle_rad(torque_nm),
            Self::LostMotion { half_width_rad, torque_nm: scale_nm } => {
                half_width_rad * (torque_nm / scale_nm).tanh()
            }
        }
    }

    fn slope_rad_per_nm(&self, torque_nm: f64) -> f64 {
        match *self {
            Self::Linear { stiffness_nm_per_rad } => 1.0 / stiffness_nm_per_rad,
            Self::ThreeSegment(curve) => curve.slope_rad_per_nm(torque_nm),
            Self::LostMotion { half_width_rad, torque_nm: scale_nm } => {
                half_width_rad / scale_nm / (torque_nm / scale_nm).cosh().powi(2)
            }
        }
    }
}

/// All compliances of a joint about its axis, in series. None is a rigid joint.
#[derive(Clone, Debug, Default)]
pub struct JointLaw {
    pub terms: Vec<Term>,
}

impl JointLaw {
    pub fn rigid() -> Self {
        Self::default()
    }

    pub fn linear(stiffness_nm_per_rad: f64) -> Self {
        Self { terms: vec![Term::Linear { stiffness_nm_per_rad }] }
    }

    pub fn three_segment(curve: ThreeSegment) -> Self {
        Self { terms: vec![Term::ThreeSegment(curve)] }
    }

    pub fn is_rigid(&self) -> bool {
        self.terms.is_empty()
    }

    /// The stiffness for small motions about this torque.
    pub fn tangent_nm_per_rad(&self, torque_nm: f64) -> f64 {
        1.0 / self.terms.iter().map(|term| term.slope_rad_per_nm(torque_nm)).sum::<f64>()
    }

    /// Torque over angle.
    pub fn secant_nm_per_rad(&self, torque_nm: f64) -> f64 {
        let angle_rad: f64 = self.terms.iter().map(|term| term.angle_rad(torque_nm)).sum();
        let is_measurable = angle_rad.abs() > 1e-30;
        if is_measurable { torque_nm / angle_rad } else { self.tangent_nm_per_rad(0.0) }
    }
}
