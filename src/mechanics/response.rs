//! Response of the tip to a harmonic force at the tip: F(t) of Eq 16, with modal damping.
//!
//! In the modal coordinates of the flexibility form `u(ω) = Σ u_k (u_k·F) / (1 - (ω/ω_k)² + 2 i ζ ω/ω_k)`,
//! where `u_k` is the tip's motion in mode k scaled to a strain energy of ½ J. All modes of the model
//! are summed, so that the static limit is the arm's compliance.

use super::chain::Posed;
use super::statics::Statics;
use nalgebra::{Complex, Vector3};
use std::f64::consts::TAU;

/// Tip motion at one frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Frequency of the force \[Hz\].
    pub frequency_hz: f64,
    /// Complex amplitude of the tip displacement, world axes \[m\].
    pub tip_m: Vector3<Complex<f64>>,
}

impl Response {
    /// Amplitude along each world axis \[m\].
    pub fn amplitude_m(&self) -> Vector3<f64> {
        self.tip_m.map(Complex::norm)
    }

    /// Phase against the force along each world axis \[rad\].
    pub fn phase_rad(&self) -> Vector3<f64> {
        self.tip_m.map(Complex::arg)
    }
}

/// Tip motion under a harmonic tip force of amplitude `force_n`, with the same damping ratio in every mode.
pub fn frequency_response(
    posed: &Posed,
    statics: &Statics,
    force_n: &Vector3<f64>,
    damping_ratio: f64,
    frequencies_hz: &[f64],
) -> Vec<Response> {
    let modes = posed.solve_modes(statics);
    let shapes: Vec<(f64, Vector3<f64>)> = modes
        .inverse_squares
        .iter()
        .zip(modes.shapes.column_iter())
        .map(|(mu, shape)| (*mu, posed.tip_motion(&shape.into_owned())))
        .collect();
    frequencies_hz
        .iter()
        .map(|&frequency_hz| Response {
            frequency_hz,
            tip_m: shapes
                .iter()
                .map(|(mu, tip)| {
                    tip.map(Complex::from)
                        * (Complex::from(tip.dot(force_n)) / resistance(*mu, frequency_hz, damping_ratio))
                })
                .sum(),
        })
        .collect()
}

/// `1 - (ω/ω_k)² + 2 i ζ ω/ω_k`.
fn resistance(inverse_square: f64, frequency_hz: f64, damping_ratio: f64) -> Complex<f64> {
    let ratio = TAU * frequency_hz * inverse_square.sqrt();
    Complex::new(1.0 - ratio * ratio, 2.0 * damping_ratio * ratio)
}
