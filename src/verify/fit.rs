//! Whether the parts of a joint fit into the space that they have (docs/study-format.md, "fit").
//!
//! | check | size of the parts | limit |
//! |---|---|---|
//! | gear next to the link | outer diameter of the gear | a factor times the width of the link |
//! | motor in the link | outer diameter of a round motor | the clear width of the hollow |
//! | the same | side of a square flange (AC servo motors, steppers) | the side of a square in the hollow |
//! | the same | length of the motor | the length of the link |
//! | cables | the bores of the parts on the axis | the smallest bore asked for |
//! | room at the joint | the length of the parts on the axis | the largest length asked for |
//!
//! The link of a joint is the first tube between it and the next joint. A size that the catalog lacks is not compared.
//!
//! Nothing of `sizing` or `space` is used, so that an error in a size there is not repeated here. Only the length of
//! the link in which a motor sits comes with the question.

use super::question::{AskedFit, AskedJoint};
use crate::arm::section::Section;
use crate::catalog::envelope::Envelope;
use crate::catalog::motor::{Motor, MotorKind};
use crate::mechanics::beam::section_frame;
use nalgebra::Vector3;

/// Relative tolerance for comparing sizes. Sizes are products of decimal numbers, and equal sizes may differ by
/// rounding.
const SAME_SIZE: f64 = 1e-9;

/// Widths of gear and motor \[m\]: either the largest widths for which a link leaves room, or the widths of a drive.
pub(super) type Widths = [f64; 3];

/// Widths without a limit: there is no link, or the study asks nothing of it.
pub(super) const ANY_WIDTH: Widths = [f64::INFINITY; 3];

/// The largest widths of gear and motor that fit to a tube. The tube has the section `section` and runs along
/// `vector_m` \[m\]. The gear and the motor belong to `joint`, the joint inboard of it.
pub(super) fn room(joint: &AskedJoint, vector_m: &Vector3<f64>, section: &Section) -> Widths {
    let AskedFit { gear_to_link_max, motor_in_link, .. } = joint.fit;
    let [mut gear_m, mut motor_m, mut square_m] = ANY_WIDTH;
    if let Some(factor) = gear_to_link_max {
        gear_m = factor * width_m(&joint.axis, vector_m, section) * (1.0 + SAME_SIZE);
    }
    if motor_in_link {
        let (width_m, height_m) = section.outer_m();
        motor_m = (width_m.min(height_m) - 2.0 * section.wall_m()) * (1.0 + SAME_SIZE);
        let is_round = matches!(section, Section::RoundTube { .. } | Section::RoundBar { .. });
        // The diagonal of a square in a circle is the diameter of the circle.
        square_m = if is_round { motor_m / 2f64.sqrt() } else { motor_m };
    }
    [gear_m, motor_m, square_m]
}

/// Width of a tube in the plane in which a joint turns it \[m\]. If the angle between the joint's axis and the tube is
/// below 8°, it is the smaller of the two outer sizes. The section frame of a tube changes at the same angle to the
/// vertical.
fn width_m(axis: &Vector3<f64>, vector_m: &Vector3<f64>, section: &Section) -> f64 {
    let frame = section_frame(vector_m);
    let (width_m, height_m) = section.outer_m();
    let link = frame.column(0).into_owned();
    if link.dot(axis).abs() > 0.99 {
        return width_m.min(height_m);
    }
    let across = link.cross(axis).normalize();
    let [on_y, on_z] = [1, 2].map(|side| frame.column(side).dot(&across));
    ((width_m * on_y).powi(2) + (height_m * on_z).powi(2)).sqrt()
}

/// Widths of gear and motor \[m\]. Each is 0 if the joint does not limit it or the catalog leaves it blank.
pub(super) fn widths(fit: &AskedFit, gear: &Envelope, motor: &Motor) -> Widths {
    let of = |asked: bool, width_m: Option<f64>| if asked { width_m.unwrap_or(0.0) } else { 0.0 };
    let is_square = matches!(motor.kind, MotorKind::AcServo | MotorKind::Stepper);
    let of_motor =
        |square: bool| of(fit.motor_in_link && is_square == square, motor.envelope.outer_diameter_m);
    [of(fit.gear_to_link_max.is_some(), gear.outer_diameter_m), of_motor(false), of_motor(true)]
}

/// Whether a drive has the bores and the length that its joint asks for. This does not depend on the link.
pub(super) fn goes_into_joint(fit: &AskedFit, gear: &Envelope, motor: &Envelope) -> bool {
    let mut on_axis = vec![*gear];
    if fit.motor_on_axis {
        on_axis.push(*motor);
    }
    let least_m = fit.cable_bore_min_m.unwrap_or(0.0) * (1.0 - SAME_SIZE);
    let most_m = fit.drive_length_max_m.unwrap_or(f64::INFINITY) * (1.0 + SAME_SIZE);
    let bores_hold = on_axis.iter().filter_map(|part| part.hollow_bore_m).all(|bore_m| bore_m >= least_m);
    let length_m: Option<f64> = on_axis.iter().map(|part| part.length_m).sum();
    let link_m = fit.link_length_m.unwrap_or(f64::INFINITY) * (1.0 + SAME_SIZE);
    let is_in_link = !fit.motor_in_link || motor.length_m.is_none_or(|length_m| length_m <= link_m);
    bores_hold && is_in_link && length_m.is_none_or(|length_m| length_m <= most_m)
}
