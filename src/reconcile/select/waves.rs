//! Smooth functions of an angle, and of the order of the rows, that residuals could follow.

use std::f64::consts::TAU;

/// Sine and cosine of an angle, once and twice a turn.
pub(crate) fn waves(angle_deg: f64) -> [f64; 4] {
    let a = angle_deg.to_radians();
    [libm::sin(a), libm::cos(a), libm::sin(2.0 * a), libm::cos(2.0 * a)]
}

/// Functions of the order of the rows of a file: straight line, parabola, and sine and cosine with one and two
/// periods over the file. `part` is the position of a row in the file, from 0 to 1.
pub(crate) fn order_functions(part: f64) -> [f64; 6] {
    let (a, b) = (TAU * part, 2.0 * TAU * part);
    [part - 0.5, (part - 0.5).powi(2), libm::sin(a), libm::cos(a), libm::sin(b), libm::cos(b)]
}
