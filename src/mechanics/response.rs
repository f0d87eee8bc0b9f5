//! Response of the tip to a harmonic force at the tip: F(t) of Eq 16 in docs/model.md, with modal damping.
//!
//! The amplitude is `u(ω) = Σ u_k (u_k·F) / (1 - (ω/ω_k)² + 2 i ζ ω/ω_k)`. Here `u_k` is the displacement of the tip
//! in mode k, scaled to a strain energy of ½ J, and ζ is the damping ratio. The sum runs over all modes of the model;
//! at zero frequency it therefore equals the static compliance of the arm.

use super::chain::Posed;
use super::statics::Statics;
use nalgebra::{Complex, Vector3};
use std::f64::consts::TAU;

/// Displacement of the tip at one frequency of the force.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Frequency of the force \[Hz\].
    pub frequency_hz: f64,
    /// Complex amplitude of the displacement of the tip in world axes \[m\].
    pub tip_m: Vector3<Complex<f64>>,
}

impl Response {
    /// Amplitude along each world axis \[m\].
    pub fn amplitude_m(&self) -> Vector3<f64> {
        self.tip_m.map(|z| libm::hypot(z.re, z.im))
    }

    /// Phase of the displacement relative to the force, along each world axis \[rad\].
    pub fn phase_rad(&self) -> Vector3<f64> {
        self.tip_m.map(|z| libm::atan2(z.im, z.re))
    }
}

/// Displacement of the tip at each frequency \[Hz\] under a harmonic force at the tip. `force_n` is the amplitude of
/// the force in world axes \[N\]. Every mode has the same damping ratio.
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

/// The denominator of one mode in the sum of the response, `1 - (ω/ω_k)² + 2 i ζ ω/ω_k`. `inverse_square` is `1/ω_k²`
/// \[s²\].
fn resistance(inverse_square: f64, frequency_hz: f64, damping_ratio: f64) -> Complex<f64> {
    let ratio = TAU * frequency_hz * inverse_square.sqrt();
    Complex::new(1.0 - ratio * ratio, 2.0 * damping_ratio * ratio)
}
