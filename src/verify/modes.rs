//! The slowest case of a box's stiffest and lightest arm.

use super::bound::{Members, ROUNDING};
use super::pencil::{Factor, Pencil};
use super::pose::Pose;
use super::skeleton::Skeleton;

/// The judged case in which the stiffest arm of a box is slowest.
pub(super) struct Slow<'w> {
    pub pose: &'w Pose,
    pub mode: Vec<f64>,
    /// Its Rayleigh quotient.
    pub eigenvalue: f64,
}

impl Skeleton {
    /// The slowest case if the stiffest arm is faster than `hz` in every case; `None` if in one it is not.
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

    /// The least frequency that the study asks for \[Hz\], less rounding.
    pub(super) fn required_hz(&self) -> f64 {
        self.limits.required_mode_hz() * (1.0 - ROUNDING)
    }
}

/// `(2 π f)²`.
pub(super) fn eigenvalue_of(hz: f64) -> f64 {
    (std::f64::consts::TAU * hz).powi(2)
}
