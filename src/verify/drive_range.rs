//! The least and the most of each number over a set of drives.
//!
//! A set of drives is bounded by two torsion curves. Of each member's curve the slopes are first made to
//! rise: lifted (each at least the one before) or lowered (each at most the one after). The largest lifted
//! slopes with the least break points make a curve that at every torque is at least as steep as any
//! member's, for a member that is in a later segment there has a slope that the later segment of the bound
//! exceeds too. The least lowered slopes with the largest break points make one that is nowhere steeper.

use super::span::Span;
use crate::arm::joint_law::{Curve, JointLaw, LostMotion, Windup};

/// Least and greatest numbers over a set of drives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DriveRange {
    pub least_kg: f64,
    pub most_kg: f64,
    /// A torsion curve that is nowhere softer than the curve of any of the drives.
    pub stiff: Windup,
    /// A torsion curve that is nowhere stiffer than the curve of any of the drives.
    pub soft: Windup,
    /// Tilt of the output bearing per moment across the axis, effects included \[rad/(N m)\]; 0 is rigid.
    pub tilt_rad_per_nm: Span,
    /// Greatest slope that a mode sees in any of the drives, if modes see one slope under every torque \[N m/rad\].
    /// Infinite if for some drive the slope depends on the torque.
    pub modal_nm_per_rad: f64,
    /// Lost motion of the joint, the same for all of its drives.
    pub lost_motion: Option<LostMotion>,
    /// Half width of the joint's hysteresis \[rad\], the same for all of its drives. Friction holds back at most this
    /// twist, and at most the twist that the torque would make with the slope K2.
    pub friction_rad: f64,
}

impl DriveRange {
    /// The range of a single drive.
    pub(super) fn of(law: &JointLaw, tilt_rad_per_nm: f64, mass_kg: f64) -> Self {
        let one_slope = |k: f64| Windup {
            k1_nm_per_rad: k,
            k2_nm_per_rad: k,
            k3_nm_per_rad: k,
            t1_nm: f64::INFINITY,
            t2_nm: f64::INFINITY,
        };
        let (windup, modal_nm_per_rad) = match law.without_play() {
            Curve::Rigid => (one_slope(f64::INFINITY), f64::INFINITY),
            Curve::Linear(k) => (one_slope(k), k),
            Curve::Windup(windup) => (windup, f64::INFINITY),
            Curve::WindupK1(windup) => (windup, windup.k1_nm_per_rad),
        };
        let [k1, k2, k3] = [windup.k1_nm_per_rad, windup.k2_nm_per_rad, windup.k3_nm_per_rad];
        let slopes = |[k1, k2, k3]: [f64; 3]| Windup {
            k1_nm_per_rad: k1,
            k2_nm_per_rad: k2,
            k3_nm_per_rad: k3,
            ..windup
        };
        Self {
            least_kg: mass_kg,
            most_kg: mass_kg,
            stiff: slopes([k1, k1.max(k2), k1.max(k2).max(k3)]),
            soft: slopes([k1.min(k2).min(k3), k2.min(k3), k3]),
            tilt_rad_per_nm: Span { least: tilt_rad_per_nm, most: tilt_rad_per_nm },
            modal_nm_per_rad,
            lost_motion: law.lost_motion,
            friction_rad: law.hysteresis_rad,
        }
    }

    pub(super) fn with(&self, other: &Self) -> Self {
        Self {
            least_kg: self.least_kg.min(other.least_kg),
            most_kg: self.most_kg.max(other.most_kg),
            stiff: curve(&self.stiff, &other.stiff, f64::max, f64::min),
            soft: curve(&self.soft, &other.soft, f64::min, f64::max),
            tilt_rad_per_nm: self.tilt_rad_per_nm.with(other.tilt_rad_per_nm),
            modal_nm_per_rad: self.modal_nm_per_rad.max(other.modal_nm_per_rad),
            ..*self
        }
    }

    /// Greatest stiffness of an output bearing against a tilt \[N m/rad\]; infinite if one of them is rigid.
    pub(super) fn greatest_tilt_stiffness(&self) -> f64 {
        1.0 / self.tilt_rad_per_nm.least
    }

    /// Least twist under the torques of an interval, with its sign \[rad\]. Gear and lost motion twist least under
    /// the least torque; friction holds back most under the greatest.
    pub(super) fn least_angle_rad(&self, torque_nm: Span) -> f64 {
        let Span { least, most } = torque_nm;
        let gear = if least >= 0.0 { angle_rad(&self.stiff, least) } else { -angle_rad(&self.soft, -least) };
        let closed = self.lost_motion.map_or(0.0, |lost| lost.angle_rad(least));
        gear + closed - self.most_held_rad(most)
    }

    /// Greatest twist that friction may hold back under any torque up to this one, with its sign \[rad\].
    fn most_held_rad(&self, torque_nm: f64) -> f64 {
        match torque_nm >= 0.0 {
            true => (torque_nm / self.soft.k2_nm_per_rad).min(self.friction_rad),
            false => (torque_nm / self.stiff.k2_nm_per_rad).max(-self.friction_rad),
        }
    }

    /// Greatest slope for a small further torque, at any torque of at most this magnitude \[N m/rad\].
    pub(super) fn largest_slope(&self, torque_nm: f64) -> f64 {
        // beyond a break point by less than rounding counts as beyond
        let reach_nm = torque_nm * (1.0 + 1e-9) + 1e-9;
        let gear = self.stiff.tangent_nm_per_rad(reach_nm).min(self.modal_nm_per_rad);
        let open = self.lost_motion.map_or(0.0, |lost| lost.tangent_compliance_rad_per_nm(reach_nm));
        1.0 / (1.0 / gear + open)
    }
}

fn curve(a: &Windup, b: &Windup, slope: fn(f64, f64) -> f64, break_point: fn(f64, f64) -> f64) -> Windup {
    Windup {
        k1_nm_per_rad: slope(a.k1_nm_per_rad, b.k1_nm_per_rad),
        k2_nm_per_rad: slope(a.k2_nm_per_rad, b.k2_nm_per_rad),
        k3_nm_per_rad: slope(a.k3_nm_per_rad, b.k3_nm_per_rad),
        t1_nm: break_point(a.t1_nm, b.t1_nm),
        t2_nm: break_point(a.t2_nm, b.t2_nm),
    }
}

/// Twist under a torque that is not negative \[rad\]; break points may be infinite.
pub(super) fn angle_rad(curve: &Windup, torque_nm: f64) -> f64 {
    let first = torque_nm.min(curve.t1_nm);
    let second = torque_nm.min(curve.t2_nm) - first;
    let third = torque_nm - first - second.max(0.0);
    first / curve.k1_nm_per_rad + second.max(0.0) / curve.k2_nm_per_rad + third / curve.k3_nm_per_rad
}
