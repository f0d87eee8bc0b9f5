//! The judged case in which the ideal arm of a box (every stiffness greatest, every inertia least) vibrates
//! slowest. A judged case counts for deflection and lowest mode.

use super::bound::{Members, ROUNDING};
use super::pencil::{Factor, Pencil};
use super::pose::Pose;
use super::skeleton::Skeleton;

/// The judged case in which the ideal arm of a box has the lowest frequency, with the mode of the arm in that case.
pub(super) struct Slow<'w> {
    pub pose: &'w Pose,
    pub mode: Vec<f64>,
    /// Rayleigh quotient of the mode, strain energy over kinetic energy \[1/s²\].
    pub eigenvalue: f64,
}

impl Skeleton {
    /// The judged case in which the ideal arm of `members` has the lowest frequency. `None` if this frequency is at
    /// most `hz`.
    pub(super) fn slowest(&self, members: &Members, hz: f64) -> Option<Slow<'_>> {
        let eigenvalue = eigenvalue_of(hz);
        if !eigenvalue.is_finite() {
            return None;
        }
        let judged = self.poses.iter().filter(|pose| pose.judged);
        let pencils: Vec<(&Pose, Pencil, Factor)> = judged
            .map(|pose| {
                let pencil = self.pencil(pose, members);
                pencil.factor(eigenvalue).map(|factor| (pose, pencil, factor))
            })
            .collect::<Option<_>>()?;
        let slow = pencils.into_iter().map(|(pose, pencil, factor)| {
            let mode = pencil.lowest_mode(&factor);
            Slow { pose, eigenvalue: pencil.strain(&mode), mode }
        });
        slow.reduce(|a, b| if b.eigenvalue < a.eigenvalue { b } else { a })
    }

    /// The lowest mode that the study requires, less a margin for rounding \[Hz\].
    pub(super) fn required_hz(&self) -> f64 {
        self.limits.required_mode_hz() * (1.0 - ROUNDING)
    }
}

/// Eigenvalue of a frequency, `(2 π f)²` \[1/s²\].
pub(super) fn eigenvalue_of(hz: f64) -> f64 {
    (std::f64::consts::TAU * hz).powi(2)
}
