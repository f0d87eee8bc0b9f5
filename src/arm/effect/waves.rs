//! The waves of a transmission error: what an uneven gear or angle sensor adds to a joint's angle, once and
//! twice a turn.

/// Sine and cosine of a joint's angle, then sine and cosine of twice the angle.
pub fn transmission_waves(angle_rad: f64) -> [f64; 4] {
    let (sin, cos) = libm::sincos(angle_rad);
    let (sin2, cos2) = libm::sincos(2.0 * angle_rad);
    [sin, cos, sin2, cos2]
}

/// The angle by which a joint turns too far at an angle \[rad\]; `waves_rad` are the amplitudes of the
/// [waves](transmission_waves).
pub fn transmission_rad(waves_rad: &[f64; 4], angle_rad: f64) -> f64 {
    transmission_waves(angle_rad).iter().zip(waves_rad).map(|(wave, size)| wave * size).sum()
}
