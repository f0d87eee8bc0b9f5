//! The warning that the tip moves too far for the model, which is linear about the undeformed pose.
//!
//! *The limit.* If elastic deformation turns a part of the arm by an angle θ, the lever arms of its loads change.
//! If an arm points by an angle φ above the horizontal, the lever of its load changes by the fraction `θ tan φ`,
//! and the deflection changes with it. A tip that moves by 5 % of the reach has turned by θ = 0.05. The error of
//! the linear deflection is then 5 % at 45 degrees. It is 0.1 % for a horizontal arm, whose lever changes by the
//! fraction `θ²/2`.

use super::number::{fixed, percent, significant};

/// Largest tip displacement, as a fraction of the arm's reach, for which no warning is given.
pub(crate) const SMALL_PART: f64 = 0.05;

/// The warning for a tip displacement, in words that continue "the tip". `None` if the displacement is small, or if the
/// arm has no reach. An arm whose joints are all prismatic has no reach, because it moves without turning.
pub(crate) fn too_far(tip_m: f64, reach_m: f64) -> Option<String> {
    (reach_m > 0.0 && tip_m > SMALL_PART * reach_m).then(|| {
        format!(
            "moves by {} mm, more than {} of the arm's reach of {} m; the model is valid for small displacements only",
            significant(1e3 * tip_m, 4),
            percent(100.0 * SMALL_PART, 0),
            fixed(reach_m, 3)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ninety_millimetres_are_too_far_for_an_arm_of_a_metre_and_forty_are_not() {
        let words = too_far(0.09, 1.0).expect("a warning");
        assert!(
            words.starts_with("moves by 90.00 mm, more than 5 % of the arm's reach of 1.000 m"),
            "{words}"
        );
        assert_eq!(too_far(0.04, 1.0), None);
    }

    /// The rotation \[rad\] of a spring that holds a load on a lever of 1 m at an angle above the horizontal. The first
    /// number is from the linear model; the second is the rotation at which the spring balances the load on the rotated
    /// lever.
    fn turns_rad(compliance_rad: f64, above_rad: f64) -> [f64; 2] {
        let mut turn_rad = 0.0;
        // a fixed-point iteration: the torque follows from the rotated lever
        for _ in 0..200 {
            turn_rad = compliance_rad * libm::cos(above_rad - turn_rad);
        }
        [compliance_rad * libm::cos(above_rad), turn_rad]
    }

    #[test]
    fn at_the_limit_a_linear_deflection_is_off_by_five_percent_at_45_degrees_and_by_little_if_stretched() {
        let off = |above_deg: f64| {
            let above_rad = above_deg.to_radians();
            let [linear, balanced] = turns_rad(SMALL_PART / libm::cos(above_rad), above_rad);
            assert!((linear - SMALL_PART).abs() < 1e-12);
            (balanced / linear - 1.0).abs()
        };
        assert!((0.045..0.055).contains(&off(45.0)), "{}", off(45.0));
        assert!(off(0.0) < 0.002, "{}", off(0.0));
    }
}
