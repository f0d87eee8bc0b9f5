//! Deflections of an arm's elements as finite motions. They move the arm into the pose in which it hangs under its
//! weight and load.

use super::{Twist, angular, displacement_at};
use nalgebra::{Rotation3, Vector3};

/// The deflections by which a walk from base to tip moves the arm out of its undeflected pose.
#[derive(Debug, Clone, Default)]
pub(crate) struct Deflections {
    /// The strain coordinates (deflections) of all elements, base to tip. The coordinate of a passive joint includes
    /// the rotation that its linkage adds.
    strains: Vec<f64>,
    /// Number of strain coordinates that have been applied.
    next: usize,
}

impl Deflections {
    /// The deflections with these strain coordinates, none of which has been applied yet.
    pub(super) fn of(strains: Vec<f64>) -> Self {
        Self { strains, next: 0 }
    }

    /// The motion of everything outboard of the next element, whose twists are `twists`; `None` in the undeflected
    /// pose.
    pub(super) fn motion_of_next(&mut self, twists: &[Twist]) -> Option<Twist> {
        if self.strains.is_empty() {
            return None;
        }
        let own = self.strains.get(self.next..self.next + twists.len())?;
        self.next += twists.len();
        Some(twists.iter().zip(own).map(|(twist, strain)| twist * *strain).sum())
    }
}

/// Moves a frame at `at_m` with the attitude `rotation` by the screw motion of the twist `motion`.
pub(super) fn screw(motion: &Twist, at_m: &mut Vector3<f64>, rotation: &mut Rotation3<f64>) {
    let by_m = displacement_at(motion, at_m);
    deflect(&by_m, &angular(motion), at_m, rotation);
}

/// Moves a frame at `at_m` with the attitude `rotation` by a screw motion (Murray, Li and Sastry, A Mathematical
/// Introduction to Robotic Manipulation, eq. 2.36). Its twist turns the frame by `turn_rad`, and displaces its origin by
/// `by_m`, to first order.
pub(super) fn deflect(
    by_m: &Vector3<f64>,
    turn_rad: &Vector3<f64>,
    at_m: &mut Vector3<f64>,
    rotation: &mut Rotation3<f64>,
) {
    let angle_rad = turn_rad.norm();
    *at_m += match angle_rad > 0.0 {
        true => {
            // The velocity of the frame's origin turns during the motion, so it is integrated over the motion.
            let cross = turn_rad.cross_matrix() / angle_rad;
            let (sin, cos) = (libm::sin(angle_rad), libm::cos(angle_rad));
            by_m + cross * by_m * ((1.0 - cos) / angle_rad) + cross * cross * by_m * (1.0 - sin / angle_rad)
        }
        false => *by_m,
    };
    *rotation = Rotation3::from_scaled_axis(*turn_rad) * *rotation;
}
