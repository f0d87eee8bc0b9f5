//! How the displacement by a candidate depends on the torques about it: in proportion (a spring), by play, beyond a
//! preload, or in proportion to the torque with a stiffness that varies with the joint's angle.
//!
//! - Play: a joint turns by `h tanh(T/T_c)`. This is the half width `h` in the direction of the torque, and less if the
//!   torque is small.
//! - Lift: the base is rigid about each horizontal axis up to the preload `M_p`, and tilts by `c (|M| - M_p)` beyond it.
//! - Waves: a joint turns by `T (a sin q + b cos q)`, `T (a sin 2q + b cos 2q)`, or both, in addition to its
//!   usual compliance.
//!
//! For a given torque `T_c` or preload `M_p` (the threshold) the half width or compliance enters the model linearly. So the
//! threshold is chosen out of a few, and then [refined](super::threshold).

use std::ops::Range;

/// How the displacement by a candidate depends on the torques about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Shape {
    /// In proportion to the torque.
    Spring,
    /// Play, with this torque scale `T_c` \[N m\].
    Play(f64),
    /// A base that tilts beyond this preload \[N m\].
    Lift(f64),
    /// A spring whose compliance varies with the joint's angle.
    Waves(Waves),
}

/// Which waves of the angle the compliance of a joint has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Waves {
    /// Once in each turn.
    Once,
    /// Twice in each turn.
    Twice,
    /// Once and twice in each turn.
    Both,
}

impl Waves {
    /// Indices of these waves among the four waves of an angle (sine and cosine, once and twice a turn).
    pub(crate) fn range(self) -> Range<usize> {
        match self {
            Waves::Once => 0..2,
            Waves::Twice => 2..4,
            Waves::Both => 0..4,
        }
    }
}

impl Shape {
    /// Torque scale or preload \[N m\]; `None` if the shape has none.
    pub(crate) fn threshold_nm(self) -> Option<f64> {
        match self {
            Shape::Play(nm) | Shape::Lift(nm) => Some(nm),
            Shape::Spring | Shape::Waves(_) => None,
        }
    }

    /// This shape with another torque scale or preload \[N m\]; a shape that has none is unchanged.
    pub(crate) fn with_threshold(self, nm: f64) -> Self {
        match self {
            Shape::Play(_) => Shape::Play(nm),
            Shape::Lift(_) => Shape::Lift(nm),
            Shape::Spring | Shape::Waves(_) => self,
        }
    }

    /// Whether the displacement is proportional to the weight.
    pub(crate) fn is_proportional(self) -> bool {
        self.threshold_nm().is_none()
    }

    /// By how much a rotation grows with the torque `nm` about its axis, over the size of the effect: over its compliance,
    /// or over its half width \[1/(N m)\]. Waves have this factor in addition to that of the angle.
    pub(crate) fn slope_per_nm(self, nm: f64) -> f64 {
        match self {
            Shape::Play(scale_nm) => libm::cosh(nm / scale_nm).powi(-2) / scale_nm,
            Shape::Lift(preload_nm) if nm.abs() <= preload_nm => 0.0,
            Shape::Spring | Shape::Lift(_) | Shape::Waves(_) => 1.0,
        }
    }

    /// Indices of the compliance's waves among the four waves of an angle; `None` if it does not vary with the angle.
    pub(crate) fn waves(self) -> Option<Range<usize>> {
        match self {
            Shape::Waves(waves) => Some(waves.range()),
            _ => None,
        }
    }
}

/// The part of a moment that exceeds the preload, with the sign of the moment \[N m\].
pub(crate) fn beyond_nm(moment_nm: f64, preload_nm: f64) -> f64 {
    (moment_nm.abs() - preload_nm).max(0.0).copysign(moment_nm)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::base_lift::BaseLift;

    #[test]
    fn the_base_tilts_by_the_law_of_the_effect() {
        let law = BaseLift { stiffness_nm_per_rad: 2e5, preload_nm: 30.0 };
        for moment_nm in [-80.0, -30.0, 0.0, 20.0, 31.0, 500.0] {
            assert!(
                (beyond_nm(moment_nm, 30.0) / 2e5 - law.angle_rad(moment_nm)).abs() < 1e-18,
                "{moment_nm}"
            );
        }
    }
}
