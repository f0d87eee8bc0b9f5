//! The paper's own equations as they are printed. They do not use the general mechanics.

use super::arm::{GRAVITY_M_S2, JOINTS, PaperArm};
use crate::arm::LinkModel;

/// Eq 4: deflection of a cantilever under end force F, weight per length q and end torque T \[m\].
///
/// `δ = L²/(E I) (F L/3 + q L²/8 + T/2)`
pub fn deflection_eq_4_m(
    flexural_rigidity_nm2: f64,
    length_m: f64,
    force_n: f64,
    line_weight_n_per_m: f64,
    torque_nm: f64,
) -> f64 {
    length_m.powi(2) / flexural_rigidity_nm2
        * (force_n * length_m / 3.0 + line_weight_n_per_m * length_m.powi(2) / 8.0 + torque_nm / 2.0)
}

/// Eq 13: displacement of the end of the arm by the torsion of one joint \[m\]. `length_m` is the distance of the
/// end from the joint.
pub fn deflection_eq_13_m(torque_nm: f64, stiffness_nm_per_rad: f64, length_m: f64) -> f64 {
    libm::sin(torque_nm / stiffness_nm_per_rad) * length_m
}

/// The total deflection by the paper's equations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrintedDeflection {
    /// Displacement by each of the joints 2, 3 and 4: sine of the joint's torsion times the distance to the wrist
    /// \[m\] (Eqs 13, 14).
    pub joints_m: [f64; 3],
    /// Deflection of links 1 and 2 (Eq 4) \[m\].
    pub links_m: [f64; 2],
}

impl PrintedDeflection {
    /// Total deflection, Eq 15 \[m\].
    pub fn total_m(&self) -> f64 {
        self.joints_m.iter().sum::<f64>() + self.links_sum_m()
    }

    /// Sum δ1 + δ2 of the links in Eq 15, in which the slope at the end of link 1 is left out \[m\].
    pub fn links_sum_m(&self) -> f64 {
        self.links_m.iter().sum()
    }
}

/// The two interpretations of the end force F in Eq 4.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EndForce {
    /// The weight of everything outboard of the link, the next links included.
    AllOutboard,
    /// The weight of the motor and gear at the link's end only, as the text of the paper says.
    DriveAtTheEnd,
}

/// Eqs 4 and 13 to 15 for the stretched arm with constant stiffnesses. The length `L_tot` of Eq 13, from a joint to the
/// end of the arm, is here measured to the wrist. `force` says which weight is the end force of Eq 4.
pub fn printed_deflection(arm: &PaperArm, force: EndForce) -> PrintedDeflection {
    let [l1, l2] = arm.lengths_m;
    let to_wrist_m = [l1 + l2, l2, 0.0];
    let solved = arm.solve(LinkModel::Rigid);
    let torques_nm = JOINTS.map(|name| solved.torque_nm(name));
    let windup = |i: usize| libm::sin(arm.curves[i].angle_rad(torques_nm[i])) * to_wrist_m[i];
    let drives_kg = [arm.joint_3_kg, arm.wrist_kg];
    let outboard_kg =
        [arm.joint_3_kg + arm.link_kg(1) + arm.wrist_kg + arm.load_kg, arm.wrist_kg + arm.load_kg];
    let link = |i: usize| {
        let end_kg = if force == EndForce::AllOutboard { outboard_kg[i] } else { drives_kg[i] };
        deflection_eq_4_m(
            arm.material.youngs_modulus_pa * arm.second_moment_m4(i),
            arm.lengths_m[i],
            end_kg * GRAVITY_M_S2,
            arm.line_kg_per_m(i) * GRAVITY_M_S2,
            torques_nm[i + 1],
        )
    };
    PrintedDeflection { joints_m: [0, 1, 2].map(windup), links_m: [0, 1].map(link) }
}

/// Acceleration of a load that reaches 1 m/s in 0.20 s \[m/s²\].
pub const LOAD_ACCELERATION_M_S2: f64 = 1.0 / 0.20;

/// The torques of Eqs 8 to 12 for one joint, on both sides of the gear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DynamicTorque {
    /// Static torque T_j at the output \[N m\].
    pub static_nm: f64,
    /// T_lin, the torque of linear acceleration, by the factor 1/2 that the paper prints: T_j / 2 \[N m\].
    pub linear_half_nm: f64,
    /// T_lin by the definition in Eq 8, (a/g) T_j, with the acceleration a of the load and the gravitational
    /// acceleration g \[N m\].
    pub linear_ratio_nm: f64,
    /// Torque of linear acceleration, computed from inertia: moment of inertia of everything outboard about the
    /// joint, times the joint's acceleration \[N m\].
    pub linear_inertia_nm: f64,
    /// Angular acceleration of the joint: acceleration of the load, divided by the distance of the load \[rad/s²\].
    pub output_acceleration_rad_s2: f64,
    /// T_rot, the torque that accelerates motor and gear input, on the motor's shaft as in Eqs 10 and 11 \[N m\].
    pub rotary_motor_side_nm: f64,
    /// T_rot on the output side of the gear: larger than on the motor's shaft by the gear ratio \[N m\].
    pub rotary_output_side_nm: f64,
}

/// Eqs 8 to 12 at joint 2 of the stretched arm. `ratio` is the reduction ratio, and `input_inertia_kgm2` is the sum of
/// the moments of inertia of motor and gear at the motor's shaft (Eq 9).
pub fn dynamic_torque_at_joint_2(arm: &PaperArm, ratio: f64, input_inertia_kgm2: f64) -> DynamicTorque {
    let static_nm = arm.solve(LinkModel::Rigid).torque_nm(JOINTS[0]);
    let reach_m = arm.lengths_m.iter().sum::<f64>() + arm.third_link_m;
    let alpha = LOAD_ACCELERATION_M_S2 / reach_m;
    let structure = arm.arm().structure(crate::arm::JointModel::K2);
    let outboard_kgm2 = arm.with_posed(&structure, LinkModel::Rigid, |posed| posed.mass_matrix()[(0, 0)]);
    // theta'' in Eq 10 is the acceleration of the motor: n_j is the speed of the motor, which is the ratio times the
    // speed of the joint
    let rotary_motor_side_nm = input_inertia_kgm2 * ratio * alpha;
    DynamicTorque {
        static_nm,
        linear_half_nm: static_nm / 2.0,
        linear_ratio_nm: static_nm * LOAD_ACCELERATION_M_S2 / GRAVITY_M_S2,
        linear_inertia_nm: outboard_kgm2 * alpha,
        output_acceleration_rad_s2: alpha,
        rotary_motor_side_nm,
        rotary_output_side_nm: rotary_motor_side_nm * ratio,
    }
}

impl DynamicTorque {
    /// Total torque by Eq 12 as printed. T_rot on the motor's side is added to torques on the output side \[N m\].
    pub fn total_as_printed_nm(&self) -> f64 {
        self.static_nm + self.linear_half_nm + self.rotary_motor_side_nm
    }

    /// Total torque by Eq 12, with all three torques on the output side \[N m\].
    pub fn total_at_output_nm(&self) -> f64 {
        self.static_nm + self.linear_inertia_nm + self.rotary_output_side_nm
    }
}
