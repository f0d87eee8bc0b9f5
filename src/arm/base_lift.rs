//! Base lift: a base whose feet are pressed to the floor by a preload, and lift off when the moment on the base
//! exceeds it.

use super::joint_law::Windup;

/// A base that is rigid as long as the moment about a horizontal axis is at most the preload, and tilts elastically
/// about this axis beyond it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BaseLift {
    /// Tilting stiffness of the base about a horizontal axis, once the feet have lifted off \[N m/rad\].
    pub stiffness_nm_per_rad: f64,
    /// Moment about a horizontal axis at which the feet lift off \[N m\].
    pub preload_nm: f64,
}

impl BaseLift {
    /// Tilt of the base about a horizontal axis \[rad\] under the moment about this axis \[N m\]. It is zero up to the
    /// preload.
    pub fn angle_rad(&self, moment_nm: f64) -> f64 {
        let beyond_nm = (moment_nm.abs() - self.preload_nm).max(0.0);
        (beyond_nm / self.stiffness_nm_per_rad).copysign(moment_nm)
    }

    /// The tilt as a function of the moment, written as the torsion curve of a gear, so that code for gears can use it.
    /// The first two segments are rigid; the third begins at the preload.
    pub(crate) fn as_windup(&self) -> Windup {
        Windup {
            k1_nm_per_rad: f64::INFINITY,
            k2_nm_per_rad: f64::INFINITY,
            k3_nm_per_rad: self.stiffness_nm_per_rad,
            t1_nm: 0.5 * self.preload_nm,
            t2_nm: self.preload_nm,
        }
    }

    /// Tangent compliance at a moment: further tilt per small further moment \[rad/(N m)\].
    pub fn tangent_compliance_rad_per_nm(&self, moment_nm: f64) -> f64 {
        if moment_nm.abs() > self.preload_nm { 1.0 / self.stiffness_nm_per_rad } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn feet_that_lift_off_are_a_torsion_curve_that_is_rigid_up_to_the_preload() {
        let lift = BaseLift { stiffness_nm_per_rad: 2e5, preload_nm: 30.0 };
        let curve = lift.as_windup();
        for moment_nm in [-80.0, -30.0, -1.0, 0.0, 20.0, 30.0, 30.1, 500.0] {
            assert_eq!(curve.angle_rad(moment_nm).abs(), lift.angle_rad(moment_nm).abs(), "{moment_nm}");
            assert!(curve.angle_rad(moment_nm) * moment_nm >= 0.0);
            let slope = 1.0 / curve.tangent_nm_per_rad(moment_nm);
            assert_eq!(slope, lift.tangent_compliance_rad_per_nm(moment_nm), "{moment_nm}");
        }
    }
}
