//! Play of a joint (lost motion and friction), with bounds for torques in an interval.
//!
//! Lost motion is an angle of twist `h tanh(T/T_c)`. It grows with the torque `T`, and its slope falls. Friction holds
//! back the twist `c T` of the gear's spring (with the compliance `c` of its middle segment), by at most its half
//! width. Small oscillations do not overcome friction. Both effects belong to the joint and are the same for every
//! drive. Only `c` depends on the drive.

use crate::arm::joint_law::{JointLaw, LostMotion};

/// A torque below this fraction of the torque `T_c` of the lost motion does not change the slope of the lost motion.
const AT_REST: f64 = 1e-8;

/// The twist that a joint has in addition to its torsion curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct JointPlay {
    /// Clearance that closes as the torque grows; `None` if the joint has none.
    lost_motion: Option<LostMotion>,
    /// Greatest angle by which friction reduces the twist \[rad\]: the half width of the hysteresis.
    friction_rad: f64,
}

impl JointPlay {
    /// The play in the torque-twist law of a joint; `None` if the law has no play.
    pub(super) fn of(law: &JointLaw) -> Option<Self> {
        let play = Self { lost_motion: law.lost_motion, friction_rad: law.hysteresis_rad };
        law.has_play().then_some(play)
    }

    /// Whether friction holds back a part of the twist. If so, a smaller torque may leave the joint more twisted.
    pub(super) fn has_friction(&self) -> bool {
        self.friction_rad > 0.0
    }

    /// The least and the greatest twist that play adds to the twist of the gear \[rad\]. The torque lies between `low`
    /// and `high` \[N m\], and the compliance of the gear's spring between `stiff` and `soft` \[rad/(N m)\].
    pub(super) fn twist(&self, [stiff, soft]: [f64; 2], [low, high]: [f64; 2]) -> [f64; 2] {
        let lost = |torque_nm: f64| self.lost_motion.map_or(0.0, |lost| lost.angle_rad(torque_nm));
        let held_back = |torque_nm: f64, compliance: f64| {
            (torque_nm.abs() * compliance).min(self.friction_rad).copysign(torque_nm)
        };
        let least_held_back = held_back(low, if low >= 0.0 { stiff } else { soft });
        let most_held_back = held_back(high, if high >= 0.0 { soft } else { stiff });
        [lost(low) - most_held_back, lost(high) - least_held_back]
    }

    /// Upper bound of the stiffness of the joint for small oscillations \[N m/rad\]: a gear with the given stiffness
    /// \[N m/rad\] in series with the lost motion. `most_nm` is the greatest magnitude of the torque \[N m\].
    pub(super) fn in_series(&self, stiffness: f64, most_nm: f64) -> f64 {
        match self.lost_motion {
            None => stiffness,
            Some(lost) => 1.0 / (1.0 / stiffness + lost.tangent_compliance_rad_per_nm(most_nm)),
        }
    }

    /// Whether the slope of the lost motion is practically the same under all torques up to the magnitude `most_nm` \[N
    /// m\]. This slope is the stiffness of the lost motion for small oscillations.
    pub(super) fn stays(&self, most_nm: f64) -> bool {
        self.lost_motion.is_none_or(|lost| most_nm <= AT_REST * lost.torque_nm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::joint_law::{Curve, Windup};
    use crate::exact::torsion::CurveBox;
    use proptest::prelude::*;

    fn curve() -> impl Strategy<Value = Curve> {
        (1e4..1e6f64, 1e4..1e6f64, 1e4..1e6f64, 1.0..50.0f64, 50.0..200.0f64).prop_map(
            |(k1_nm_per_rad, k2_nm_per_rad, k3_nm_per_rad, t1_nm, t2_nm)| {
                Curve::Windup(Windup { k1_nm_per_rad, k2_nm_per_rad, k3_nm_per_rad, t1_nm, t2_nm })
            },
        )
    }

    proptest! {
        /// The twist and the stiffness of every drive lie within the bounds at every torque. If the interval
        /// is a point, the bounds of one drive are its exact values.
        #[test]
        fn no_drive_twists_beyond_the_bounds(
            curves in prop::collection::vec(curve(), 1..4), ends in [-300.0..300.0f64, -300.0..300.0f64],
            at in 0.0..1.0f64, h in 0.0..1e-3f64, t_c in 1.0..100.0f64, friction_rad in 0.0..1e-3f64,
        ) {
            let lost_motion = Some(LostMotion { half_width_rad: h, torque_nm: t_c });
            let laws: Vec<JointLaw> = curves
                .iter()
                .map(|curve| JointLaw { lost_motion, hysteresis_rad: friction_rad, ..(*curve).into() })
                .collect();
            let play = JointPlay::of(&laws[0]).expect("play");
            let range = [ends[0].min(ends[1]), ends[0].max(ends[1])];
            let boxes = || laws.iter().filter_map(CurveBox::of);
            let all = boxes().reduce(|a, b| a.join(&b)).expect("curves");
            let torque_nm = range[0] + at * (range[1] - range[0]);
            let size = range[1].max(-range[0]);
            let least = range[0].max(-range[1]).max(0.0);
            for (law, own) in laws.iter().zip(boxes()) {
                let angle = law.rising_angle_rad(torque_nm);
                let [low, high] = all.twist(Some(&play), range);
                prop_assert!(low <= angle + 1e-15 && angle <= high + 1e-15, "{low} {angle} {high}");
                let exact = own.twist(Some(&play), [torque_nm; 2]);
                prop_assert!((exact[0] - angle).abs() + (exact[1] - angle).abs() < 1e-14, "{exact:?} {angle}");
                let stiffness = 1.0 / law.tangent_compliance_rad_per_nm(torque_nm);
                let bound = play.in_series(all.stiffest(least, size), size);
                prop_assert!(stiffness <= bound * (1.0 + 1e-12), "{stiffness} {bound}");
                let point = play.in_series(own.stiffest(torque_nm.abs(), torque_nm.abs()), torque_nm.abs());
                prop_assert!((stiffness / point - 1.0).abs() < 1e-12);
            }
        }
    }
}
