//! Rows on the paper's sizing equations, Eqs 7 to 12, for joint 2 of Table 1.

use super::arm::PaperArm;
use super::equations::{DynamicTorque, LOAD_ACCELERATION_M_S2, dynamic_torque_at_joint_2};
use super::output::PaperError;
use super::parts;
use super::rows::PaperRow;
use crate::catalog::Catalogs;
use crate::report::number::fixed;

/// Reduction ratio of the paper's drives, for the rows that depend on it.
const RATIO: f64 = 100.0;

/// All rows of the sizing equations.
///
/// # Errors
/// The catalog lacks the paper's motor or gear, or its inertia.
pub(crate) fn rows(catalogs: &Catalogs) -> Result<Vec<PaperRow>, PaperError> {
    let arm = PaperArm::table_1();
    let motor = parts::motor(catalogs, "F11-10")?;
    let gear = parts::gear(catalogs, 58)?;
    let rotor_kgm2 =
        motor.rotor_inertia_kgm2.ok_or_else(|| parts::missing("rotor inertia of motor", &motor.id))?;
    let wave_kgm2 =
        gear.inertia_input_kgm2.ok_or_else(|| parts::missing("input inertia of gear", &gear.id))?;
    let rotor = dynamic_torque_at_joint_2(&arm, RATIO, rotor_kgm2);
    let both = dynamic_torque_at_joint_2(&arm, RATIO, rotor_kgm2 + wave_kgm2);
    Ok([linear(&rotor), rotary(&rotor, &both), total(&both)].concat())
}

fn linear(torque: &DynamicTorque) -> Vec<PaperRow> {
    vec![
        PaperRow::new("t_lin_factor", "T_lin over T_j", "", 4)
            .paper(0.5, "about 1/2")
            .reading(LOAD_ACCELERATION_M_S2 / super::arm::GRAVITY_M_S2, "Eq 8: a/g with a = 1 m/s in 0.20 s")
            .exact(torque.linear_inertia_nm / torque.static_nm)
            .because("Eq 8 gives every weight the load's acceleration; inboard masses accelerate less"),
        PaperRow::new("t_lin", "T_lin at joint 2", "N m", 1)
            .paper(torque.linear_half_nm, "1/2 T_2")
            .reading(torque.linear_ratio_nm, "(a/g) T_2")
            .exact(torque.linear_inertia_nm)
            .because("exact: moment of inertia about joint 2 times a over 1.35 m"),
    ]
}

fn rotary(rotor: &DynamicTorque, both: &DynamicTorque) -> Vec<PaperRow> {
    vec![
        PaperRow::new("joint_2_acceleration", "angular acceleration of joint 2", "rad/s2", 4)
            .exact(rotor.output_acceleration_rad_s2)
            .because("1 m/s in 0.20 s at the load's distance of 1.35 m"),
        PaperRow::new("t_rot_rotor", "T_rot of F11-10, N = 100", "N m", 2)
            .reading(
                rotor.rotary_motor_side_nm,
                "Eqs 10, 11: n_j is the motor's speed, so this is at its shaft",
            )
            .exact(rotor.rotary_output_side_nm)
            .because("exact: referred to the output of joint 2, N times larger"),
        PaperRow::new("t_rot_both", "T_rot with the gear's wave generator (Eq 9)", "N m", 2)
            .reading(both.rotary_motor_side_nm, "J_mot + J_trans, at the motor's shaft")
            .exact(both.rotary_output_side_nm)
            .because(format!(
                "with rotor and wave generator the inertia is {} times the rotor's alone",
                fixed(both.rotary_motor_side_nm / rotor.rotary_motor_side_nm, 1)
            )),
    ]
}

fn total(torque: &DynamicTorque) -> Vec<PaperRow> {
    vec![
        PaperRow::new("t_total", "T_2,tot (Eq 12)", "N m", 1)
            .reading(torque.total_as_printed_nm(), "as printed: T_rot of the motor's side is added")
            .exact(torque.total_at_output_nm())
            .because("exact: all three at the output, T_lin from the moment of inertia"),
    ]
}
