//! Transmission errors: the error that an uneven gear or angle sensor adds to the angle of a joint, once and twice in
//! each turn.

/// The four waves of a joint angle: sine and cosine of the angle, sine and cosine of twice the angle.
pub fn transmission_waves(angle_rad: f64) -> [f64; 4] {
    let (sin, cos) = libm::sincos(angle_rad);
    let (sin2, cos2) = libm::sincos(2.0 * angle_rad);
    [sin, cos, sin2, cos2]
}

/// The transmission error of a joint at an angle \[rad\]. `waves_rad` are the amplitudes of the four
/// [waves](transmission_waves).
pub fn transmission_rad(waves_rad: &[f64; 4], angle_rad: f64) -> f64 {
    transmission_waves(angle_rad).iter().zip(waves_rad).map(|(wave, size)| wave * size).sum()
}
