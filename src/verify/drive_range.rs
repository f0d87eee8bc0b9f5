//! The least and the greatest value of each number over a set of drives.
//!
//! A set of drives is bounded by two torsion curves, a stiff curve and a soft curve. First the slopes of each member
//! are made monotonic: *lifted* (each slope is raised to at least the slope before it) for the stiff bound, *lowered*
//! (each slope is reduced to at most the slope after it) for the soft bound.
//!
//! The stiff bound has the largest of the lifted slopes and the least of the break points. At every torque it is at
//! least as steep as each member: the bound enters each segment no later than the member does, and its slope there
//! is no smaller. The soft bound has the least of the lowered slopes and the largest of the break points, and is
//! nowhere steeper than a member.

use super::span::Span;
use crate::arm::joint_law::{Curve, JointLaw, LostMotion, Windup};

/// A set of drives, described by the least and the greatest value of each number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DriveRange {
    pub least_kg: f64,
    pub most_kg: f64,
    /// A torsion curve that is nowhere softer than the curve of any of the drives.
    pub stiff: Windup,
    /// A torsion curve that is nowhere stiffer than the curve of any of the drives.
    pub soft: Windup,
    /// Tilt of the output bearing \[rad/(N m)\] per moment about an axis at right angles to the joint's axis, effects
    /// included; 0 is rigid.
    pub tilt_rad_per_nm: Span,
    /// Greatest slope with which any of the drives vibrates \[N m/rad\], where the study lets modes use one slope
    /// at every torque. Infinite if the slope of some drive depends on the torque.
    pub modal_nm_per_rad: f64,
    /// Lost motion of the joint, the same for all of its drives.
    pub lost_motion: Option<LostMotion>,
    /// Half width of the joint's hysteresis \[rad\], the same for all of its drives. Friction reduces the twist by
    /// at most this angle, and by at most the torque divided by K2.
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

    /// Greatest tilt stiffness of the output bearings of the drives \[N m/rad\]; infinite if one of the bearings is
    /// rigid.
    pub(super) fn greatest_tilt_stiffness(&self) -> f64 {
        1.0 / self.tilt_rad_per_nm.least
    }

    /// Least twist of the joint over the drives and over torques in an interval, with its sign \[rad\]. Gear and lost
    /// motion twist least under the least torque, and friction reduces the twist most under the greatest torque.
    pub(super) fn least_angle_rad(&self, torque_nm: Span) -> f64 {
        let Span { least, most } = torque_nm;
        let gear = if least >= 0.0 { angle_rad(&self.stiff, least) } else { -angle_rad(&self.soft, -least) };
        let closed = self.lost_motion.map_or(0.0, |lost| lost.angle_rad(least));
        gear + closed - self.most_held_rad(most)
    }

    /// Greatest angle by which friction can reduce the twist under any torque up to `torque_nm`, with its sign \[rad\].
    fn most_held_rad(&self, torque_nm: f64) -> f64 {
        match torque_nm >= 0.0 {
            true => (torque_nm / self.soft.k2_nm_per_rad).min(self.friction_rad),
            false => (torque_nm / self.stiff.k2_nm_per_rad).max(-self.friction_rad),
        }
    }

    /// Greatest tangent stiffness that the joint has with any of the drives \[N m/rad\], under torques with a magnitude
    /// of at most `torque_nm`.
    pub(super) fn largest_slope(&self, torque_nm: f64) -> f64 {
        // A torque that is below a break point by less than rounding counts as being beyond it.
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

/// Twist of a torsion curve under a torque that is not negative \[rad\]. Break points may be infinite.
pub(super) fn angle_rad(curve: &Windup, torque_nm: f64) -> f64 {
    let first = torque_nm.min(curve.t1_nm);
    let second = torque_nm.min(curve.t2_nm) - first;
    let third = torque_nm - first - second.max(0.0);
    first / curve.k1_nm_per_rad + second.max(0.0) / curve.k2_nm_per_rad + third / curve.k3_nm_per_rad
}
