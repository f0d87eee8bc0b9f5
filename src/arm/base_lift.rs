//! Base lift: feet that stand on the floor by their preload, and lift off when the moment exceeds it.

/// A base that is rigid up to a moment about each horizontal axis, and yields beyond it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BaseLift {
    /// Stiffness beyond the preload \[N m/rad\].
    pub stiffness_nm_per_rad: f64,
    /// Moment about a horizontal axis at which the feet lift off \[N m\].
    pub preload_nm: f64,
}

impl BaseLift {
    /// Tilt about a horizontal axis under the moment about it \[rad\].
    pub fn angle_rad(&self, moment_nm: f64) -> f64 {
        let beyond_nm = (moment_nm.abs() - self.preload_nm).max(0.0);
        (beyond_nm / self.stiffness_nm_per_rad).copysign(moment_nm)
    }

    /// Tilt per small further moment \[rad/(N m)\].
    pub fn tangent_compliance_rad_per_nm(&self, moment_nm: f64) -> f64 {
        if moment_nm.abs() > self.preload_nm { 1.0 / self.stiffness_nm_per_rad } else { 0.0 }
    }
}
