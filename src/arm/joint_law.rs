//! Joint laws: the angle of torsion of a joint about its axis as a function of its torque.

use super::JointModel;
use super::effect::waves::transmission_waves;

/// The torsion curve of a gear, in three straight segments. The angle changes its sign with the torque. The slope
/// (angle per torque) is 1/K1 up to the torque T1, 1/K2 up to T2 and 1/K3 beyond.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Windup {
    /// Stiffness up to T1 \[N m/rad\].
    pub k1_nm_per_rad: f64,
    /// Stiffness between T1 and T2 \[N m/rad\].
    pub k2_nm_per_rad: f64,
    /// Stiffness beyond T2 \[N m/rad\].
    pub k3_nm_per_rad: f64,
    /// Torque T1 at which the first segment ends \[N m\].
    pub t1_nm: f64,
    /// Torque T2 at which the second segment ends \[N m\].
    pub t2_nm: f64,
}

/// One straight segment of a torsion curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Torque at which the segment begins \[N m\].
    pub from_nm: f64,
    /// Torque at which the segment ends \[N m\]; infinite for the last segment.
    pub to_nm: f64,
    /// Stiffness of the segment \[N m/rad\].
    pub stiffness_nm_per_rad: f64,
}

impl Windup {
    /// A torsion curve with the same stiffness in all three segments. The break points are arbitrary, because the slope
    /// does not change at them.
    pub fn straight(stiffness_nm_per_rad: f64) -> Self {
        let k = stiffness_nm_per_rad;
        Self { k1_nm_per_rad: k, k2_nm_per_rad: k, k3_nm_per_rad: k, t1_nm: 1.0, t2_nm: 2.0 }
    }

    /// The three segments in ascending order of torque. A torque at a break point belongs to the segment below it.
    #[inline]
    pub fn segments(&self) -> [Segment; 3] {
        let segment = |from_nm, to_nm, stiffness_nm_per_rad| Segment { from_nm, to_nm, stiffness_nm_per_rad };
        [
            segment(0.0, self.t1_nm, self.k1_nm_per_rad),
            segment(self.t1_nm, self.t2_nm, self.k2_nm_per_rad),
            segment(self.t2_nm, f64::INFINITY, self.k3_nm_per_rad),
        ]
    }

    /// Angle of torsion \[rad\] under the total torque on the joint \[N m\].
    #[inline]
    pub fn angle_rad(&self, torque_nm: f64) -> f64 {
        let t = torque_nm.abs();
        let first = t.min(self.t1_nm) / self.k1_nm_per_rad;
        let second = (t.min(self.t2_nm) - self.t1_nm).max(0.0) / self.k2_nm_per_rad;
        let third = (t - self.t2_nm).max(0.0) / self.k3_nm_per_rad;
        (first + second + third).copysign(torque_nm)
    }

    /// Tangent stiffness \[N m/rad\] at a torque \[N m\]. At a break point it is the stiffness of the segment below.
    #[inline]
    pub fn tangent_nm_per_rad(&self, torque_nm: f64) -> f64 {
        let t = torque_nm.abs();
        if t <= self.t1_nm {
            self.k1_nm_per_rad
        } else if t <= self.t2_nm {
            self.k2_nm_per_rad
        } else {
            self.k3_nm_per_rad
        }
    }

    /// Whether the tangent stiffness of this curve is at least the tangent stiffness of `other` at every torque up to
    /// `most_nm` \[N m\]. Both stiffnesses change only at break points, so they are compared at zero torque and just
    /// above each break point.
    pub fn never_softer(&self, other: &Self, most_nm: f64) -> bool {
        let starts = [0.0, self.t1_nm, self.t2_nm, other.t1_nm, other.t2_nm];
        starts.into_iter().all(|t| t > most_nm || self.slope_beyond(t) >= other.slope_beyond(t))
    }

    /// Tangent stiffness just above the torque `torque_nm` \[N m/rad\]. If this torque is a break point, it is the
    /// stiffness of the segment that begins at it.
    fn slope_beyond(&self, torque_nm: f64) -> f64 {
        match torque_nm {
            t if t < self.t1_nm => self.k1_nm_per_rad,
            t if t < self.t2_nm => self.k2_nm_per_rad,
            _ => self.k3_nm_per_rad,
        }
    }

    /// This curve with all three stiffnesses multiplied by `factor`. The break points stay.
    #[must_use]
    pub fn stiffened(&self, factor: f64) -> Self {
        Self {
            k1_nm_per_rad: self.k1_nm_per_rad * factor,
            k2_nm_per_rad: self.k2_nm_per_rad * factor,
            k3_nm_per_rad: self.k3_nm_per_rad * factor,
            ..*self
        }
    }
}

/// The torsion curve of a joint: its angle of torsion as a function of its torque.
///
/// ```
/// use armwright::arm::{Curve, JointModel, Windup};
///
/// let curve = Curve::Windup(Windup {
///     k1_nm_per_rad: 400e3,
///     k2_nm_per_rad: 610e3,
///     k3_nm_per_rad: 710e3,
///     t1_nm: 168.0,
///     t2_nm: 598.0,
/// });
/// // the two first segments under 568.3 N m
/// assert!((curve.angle_rad(568.3) - (168.0 / 400e3 + 400.3 / 610e3)).abs() < 1e-12);
/// assert_eq!(curve.tangent_compliance_rad_per_nm(568.3), 1.0 / 610e3);
/// assert_eq!(curve.reduced(JointModel::K2), Curve::Linear(610e3));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Curve {
    /// No torsion under any torque.
    Rigid,
    /// A single stiffness \[N m/rad\].
    Linear(f64),
    /// The three-segment curve of a gear.
    Windup(Windup),
    /// The three-segment curve of a gear for deflections. In vibrations the gear has its first slope K1 at every
    /// torque.
    WindupK1(Windup),
}

impl Curve {
    /// Angle of torsion \[rad\] under the total torque on the joint \[N m\].
    pub fn angle_rad(&self, torque_nm: f64) -> f64 {
        match self {
            Curve::Rigid => 0.0,
            Curve::Linear(stiffness) => torque_nm / stiffness,
            Curve::Windup(windup) | Curve::WindupK1(windup) => windup.angle_rad(torque_nm),
        }
    }

    /// Tangent compliance \[rad/(N m)\] at a torque \[N m\]: further angle per small further torque.
    pub fn tangent_compliance_rad_per_nm(&self, torque_nm: f64) -> f64 {
        match self {
            Curve::Rigid => 0.0,
            Curve::Linear(stiffness) => 1.0 / stiffness,
            Curve::Windup(windup) => 1.0 / windup.tangent_nm_per_rad(torque_nm),
            Curve::WindupK1(windup) => 1.0 / windup.k1_nm_per_rad,
        }
    }

    /// This curve with all of its stiffnesses multiplied by `factor`. The break points stay.
    #[must_use]
    pub fn stiffened(&self, factor: f64) -> Curve {
        match self {
            Curve::Rigid => Curve::Rigid,
            Curve::Linear(stiffness) => Curve::Linear(stiffness * factor),
            Curve::Windup(windup) => Curve::Windup(windup.stiffened(factor)),
            Curve::WindupK1(windup) => Curve::WindupK1(windup.stiffened(factor)),
        }
    }

    /// The curve written as three segments, which have equal stiffness if the curve is a straight line. `None` for a
    /// rigid joint.
    pub fn as_windup(&self) -> Option<Windup> {
        match *self {
            Curve::Rigid => None,
            Curve::Linear(k) => Some(Windup {
                k1_nm_per_rad: k,
                k2_nm_per_rad: k,
                k3_nm_per_rad: k,
                t1_nm: f64::INFINITY,
                t2_nm: f64::INFINITY,
            }),
            Curve::Windup(windup) | Curve::WindupK1(windup) => Some(windup),
        }
    }

    /// The curve with the compliance `rad_per_nm` \[rad/(N m)\] in series. Every segment becomes more compliant, and
    /// the break points stay.
    #[must_use]
    pub fn in_series(&self, rad_per_nm: f64) -> Curve {
        if rad_per_nm == 0.0 {
            return *self;
        }
        let both = |k: f64| 1.0 / (1.0 / k + rad_per_nm);
        let windup = |w: &Windup| Windup {
            k1_nm_per_rad: both(w.k1_nm_per_rad),
            k2_nm_per_rad: both(w.k2_nm_per_rad),
            k3_nm_per_rad: both(w.k3_nm_per_rad),
            ..*w
        };
        match self {
            Curve::Rigid => Curve::Linear(1.0 / rad_per_nm),
            Curve::Linear(stiffness) => Curve::Linear(both(*stiffness)),
            Curve::Windup(w) => Curve::Windup(windup(w)),
            Curve::WindupK1(w) => Curve::WindupK1(windup(w)),
        }
    }

    /// This curve seen from the output of a reduction whose input the gear turns. `ratio` is the turns of the input per
    /// turn of the output. Torques are multiplied by `ratio`, and angles of torsion are divided by it.
    #[must_use]
    pub fn behind(&self, ratio: f64) -> Curve {
        let stiffened = self.stiffened(ratio * ratio);
        let moved = |w: Windup| Windup { t1_nm: w.t1_nm * ratio, t2_nm: w.t2_nm * ratio, ..w };
        match stiffened {
            Curve::Windup(w) => Curve::Windup(moved(w)),
            Curve::WindupK1(w) => Curve::WindupK1(moved(w)),
            other => other,
        }
    }

    /// The curve that the joint model `model` uses in place of this curve.
    pub fn reduced(&self, model: JointModel) -> Curve {
        match model {
            JointModel::K2 => self.middle_slope(),
            JointModel::ThreeSegment => *self,
            JointModel::ThreeSegmentK1 => match *self {
                Curve::Windup(windup) => Curve::WindupK1(windup),
                other => other,
            },
        }
    }

    /// The curve of the paper's model: a straight line with the stiffness K2 of the gear. Rigid and straight curves are
    /// returned as they are.
    pub fn middle_slope(&self) -> Curve {
        match self {
            Curve::Windup(windup) | Curve::WindupK1(windup) => Curve::Linear(windup.k2_nm_per_rad),
            other => *other,
        }
    }
}

/// Smallest factor on a joint's mean compliance when the compliance varies with the angle. It keeps the compliance
/// positive.
const LEAST_COMPLIANCE_FACTOR: f64 = 0.02;

/// Torque below which a joint is taken as unloaded \[N m\]. Smaller torques are rounding errors.
const REST_NM: f64 = 1e-9;

/// Sign of a torque; 0 for an unloaded joint, whose torque is a rounding error.
fn sense(torque_nm: f64) -> f64 {
    if torque_nm.abs() < REST_NM { 0.0 } else { torque_nm.signum() }
}

/// Lost motion: clearance that closes smoothly as the torque T grows. It adds the angle `h tanh(T/Tc)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LostMotion {
    /// Half width h of the clearance \[rad\].
    pub half_width_rad: f64,
    /// Torque scale Tc of the closing \[N m\].
    pub torque_nm: f64,
}

impl LostMotion {
    /// Angle \[rad\] that lost motion adds under the total torque \[N m\].
    pub fn angle_rad(&self, torque_nm: f64) -> f64 {
        self.half_width_rad * libm::tanh(torque_nm / self.torque_nm)
    }

    /// Tangent compliance \[rad/(N m)\] at a torque \[N m\]. It falls as the torque grows.
    pub fn tangent_compliance_rad_per_nm(&self, torque_nm: f64) -> f64 {
        self.half_width_rad / self.torque_nm / libm::cosh(torque_nm / self.torque_nm).powi(2)
    }
}

/// A further angle of torsion found in readings, as a polynomial of the torque. With `p = T / torque_nm` it is
/// `odd[0] p |p| + odd[1] p³ + even[0] |p| + even[1] p²`. Beyond the reference torque, where no reading was, it continues
/// as a straight line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FurtherTwist {
    /// Coefficients of the terms that change sign with the torque \[rad\].
    pub odd_rad: [f64; 2],
    /// Coefficients of the terms that do not change sign with the torque \[rad\].
    pub even_rad: [f64; 2],
    /// Reference torque \[N m\]: at this torque p is 1, so the angle is the sum of the coefficients.
    pub torque_nm: f64,
}

impl FurtherTwist {
    /// Angle of torsion \[rad\] that this further term adds under the total torque on the joint \[N m\].
    pub fn angle_rad(&self, torque_nm: f64) -> f64 {
        let p = torque_nm / self.torque_nm;
        let edge = p.clamp(-1.0, 1.0);
        let ([a, b], [c, d]) = (self.odd_rad, self.even_rad);
        let inside = a * edge * edge.abs() + b * edge.powi(3) + c * edge.abs() + d * edge * edge;
        inside + (p - edge) * self.slope_rad(edge)
    }

    /// Tangent compliance \[rad/(N m)\] of this further term at a torque \[N m\]. It is negative where the term makes
    /// the joint stiffer.
    pub fn tangent_compliance_rad_per_nm(&self, torque_nm: f64) -> f64 {
        self.slope_rad((torque_nm / self.torque_nm).clamp(-1.0, 1.0)) / self.torque_nm
    }

    /// Derivative of the polynomial by p.
    fn slope_rad(&self, p: f64) -> f64 {
        let ([a, b], [c, d]) = (self.odd_rad, self.even_rad);
        2.0 * a * p.abs() + 3.0 * b * p * p + c * sense(p * self.torque_nm) + 2.0 * d * p
    }
}

/// The law of a joint: the angle of torsion about its axis as a function of torque, with everything that deflects in
/// series.
///
/// ```
/// use armwright::arm::{Curve, JointLaw};
///
/// // a gear of 1e5 N m/rad, and a flange of the same stiffness in series
/// let law = JointLaw { connection_rad_per_nm: 1e-5, ..JointLaw::from(Curve::Linear(1e5)) };
/// assert!((law.angle_rad(100.0) - 2e-3).abs() < 1e-15);
/// assert!((law.tangent_compliance_rad_per_nm(100.0) - 2e-5).abs() < 1e-18);
/// assert!(!law.is_rigid() && !law.has_play());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointLaw {
    /// Torsion curve of the gear.
    pub curve: Curve,
    /// Compliance of flange, shaft or bolts \[rad/(N m)\].
    pub connection_rad_per_nm: f64,
    /// Lost motion of the gear; `None` if there is none.
    pub lost_motion: Option<LostMotion>,
    /// Half width of the friction play (hysteresis) \[rad\]; 0 if there is none. If the history of the torque is
    /// unknown, it is taken to have risen from rest.
    pub hysteresis_rad: f64,
    /// How the compliance of gear and connection varies with the angle of the joint: relative amplitudes of the four
    /// [waves](transmission_waves) of the angle.
    pub waves: [f64; 4],
    /// A further angle of torsion found in readings, which no named effect explains; `None` if there is none.
    pub further: Option<FurtherTwist>,
}

impl From<Curve> for JointLaw {
    fn from(curve: Curve) -> Self {
        Self {
            curve,
            connection_rad_per_nm: 0.0,
            lost_motion: None,
            hysteresis_rad: 0.0,
            waves: [0.0; 4],
            further: None,
        }
    }
}

impl JointLaw {
    /// The law of the joint at the joint angle `angle_rad`. If the compliance varies with the angle
    /// ([`waves`](Self::waves)), the result has the compliance at this angle, whereas `self` has the mean over all
    /// angles.
    #[must_use]
    pub fn at_angle(&self, angle_rad: f64) -> Self {
        if self.waves == [0.0; 4] {
            return *self;
        }
        let waves = transmission_waves(angle_rad);
        let varied: f64 = waves.iter().zip(&self.waves).map(|(wave, size)| wave * size).sum();
        Self { waves: [0.0; 4], ..self.softer((1.0 + varied).max(LEAST_COMPLIANCE_FACTOR)) }
    }

    /// The law with the compliance of gear and connection multiplied by a factor.
    #[must_use]
    pub fn softer(&self, factor: f64) -> Self {
        Self {
            curve: self.curve.stiffened(1.0 / factor),
            connection_rad_per_nm: self.connection_rad_per_nm * factor,
            ..*self
        }
    }

    /// Angle of torsion \[rad\] under the total torque \[N m\], without friction play.
    pub fn angle_rad(&self, torque_nm: f64) -> f64 {
        let play = self.lost_motion.map_or(0.0, |lost| lost.angle_rad(torque_nm));
        let further = self.further.map_or(0.0, |twist| twist.angle_rad(torque_nm));
        self.curve.angle_rad(torque_nm) + self.connection_rad_per_nm * torque_nm + play + further
    }

    /// Tangent compliance \[rad/(N m)\] at a torque \[N m\]. Friction play adds nothing, because friction does not
    /// slip in small oscillations.
    pub fn tangent_compliance_rad_per_nm(&self, torque_nm: f64) -> f64 {
        let play = self.lost_motion.map_or(0.0, |lost| lost.tangent_compliance_rad_per_nm(torque_nm));
        let named = self.curve.tangent_compliance_rad_per_nm(torque_nm) + self.connection_rad_per_nm + play;
        match self.further {
            None => named,
            // the further term may make the joint stiffer, but the compliance must not become negative
            Some(twist) => (named + twist.tangent_compliance_rad_per_nm(torque_nm)).max(0.0),
        }
    }

    /// The torsion curve of gear and connection in series, without lost motion and friction play.
    pub fn without_play(&self) -> Curve {
        let softened = |k: f64| 1.0 / (1.0 / k + self.connection_rad_per_nm);
        let series = |w: Windup| Windup {
            k1_nm_per_rad: softened(w.k1_nm_per_rad),
            k2_nm_per_rad: softened(w.k2_nm_per_rad),
            k3_nm_per_rad: softened(w.k3_nm_per_rad),
            ..w
        };
        match self.curve {
            curve if self.connection_rad_per_nm == 0.0 => curve,
            Curve::Rigid => Curve::Linear(1.0 / self.connection_rad_per_nm),
            Curve::Linear(k) => Curve::Linear(softened(k)),
            Curve::Windup(w) => Curve::Windup(series(w)),
            Curve::WindupK1(w) => Curve::WindupK1(series(w)),
        }
    }

    /// Whether the joint has lost motion, friction play or a further angle found in readings, in addition to its
    /// torsion curve.
    pub fn has_play(&self) -> bool {
        self.lost_motion.is_some() || self.hysteresis_rad > 0.0 || self.further.is_some()
    }

    /// Whether the angle of torsion is not proportional to the torque.
    pub fn is_curved(&self) -> bool {
        self.has_play() || matches!(self.curve, Curve::Windup(_) | Curve::WindupK1(_))
    }

    /// Angle of torsion \[rad\] after the torque has risen from rest to `torque_nm`. Friction holds the joint back by
    /// up to the half width of the play.
    pub fn rising_angle_rad(&self, torque_nm: f64) -> f64 {
        self.play_angle_rad(torque_nm, &mut 0.0)
    }

    /// Stiffness of the spring in the friction play model \[N m/rad\]: the slope K2 of the gear in series with the
    /// connection. `None` without friction play, or if the joint has no compliance for friction to hold back.
    pub(crate) fn play_stiffness_nm_per_rad(&self) -> Option<f64> {
        // checked first, because this is called for every reading and most joints have no friction play
        if self.hysteresis_rad <= 0.0 {
            return None;
        }
        let gear = self.curve.middle_slope().tangent_compliance_rad_per_nm(0.0);
        let compliance = gear + self.connection_rad_per_nm;
        (compliance > 0.0).then(|| 1.0 / compliance)
    }

    /// Angle of torsion \[rad\] at a torque \[N m\], with friction play. `state` is the memory of the friction: a
    /// torque \[N m\] that trails the torque on the joint by at most the spring stiffness times the half width. The
    /// function updates it.
    pub fn play_angle_rad(&self, torque_nm: f64, state: &mut f64) -> f64 {
        let angle = self.angle_rad(torque_nm);
        let Some(stiffness) = self.play_stiffness_nm_per_rad() else { return angle };
        let reach = stiffness * self.hysteresis_rad;
        *state = state.max(torque_nm - reach).min(torque_nm + reach);
        angle + (*state - torque_nm) / stiffness
    }

    /// The state of the friction play \[N m\], for [`play_angle_rad`](Self::play_angle_rad), after the torque has risen
    /// from rest to `torque_nm`.
    pub fn play_at_rest_nm(&self, torque_nm: f64) -> f64 {
        torque_nm
            - sense(torque_nm) * self.play_stiffness_nm_per_rad().unwrap_or_default() * self.hysteresis_rad
    }

    /// Whether the joint has no torsion under any torque.
    pub fn is_rigid(&self) -> bool {
        self.curve == Curve::Rigid
            && self.connection_rad_per_nm == 0.0
            && self.lost_motion.is_none()
            && self.further.is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_of_a_further_twist_is_the_derivative_of_its_angle() {
        let twist = FurtherTwist { odd_rad: [2e-4, -1e-4], even_rad: [5e-5, 3e-5], torque_nm: 80.0 };
        for torque_nm in [-90.0, -20.0, 7.0, 60.0] {
            let step = 1e-4;
            let slope =
                (twist.angle_rad(torque_nm + step) - twist.angle_rad(torque_nm - step)) / (2.0 * step);
            assert!((slope - twist.tangent_compliance_rad_per_nm(torque_nm)).abs() < 1e-12, "{torque_nm}");
        }
        assert_eq!(twist.angle_rad(0.0), 0.0);
        assert!(
            (twist.angle_rad(80.0) - 1.8e-4).abs() < 1e-18 && (twist.angle_rad(-80.0) + 0.2e-4).abs() < 1e-18
        );
        // a joint of 1e5 N m/rad with a negative further compliance larger than its own is taken as rigid
        let stiff = FurtherTwist { odd_rad: [-8e-3, 0.0], even_rad: [0.0; 2], torque_nm: 80.0 };
        let law = JointLaw { further: Some(stiff), ..Curve::Linear(1e5).into() };
        assert_eq!(law.tangent_compliance_rad_per_nm(80.0), 0.0);
    }

    const HFUC_58: Windup = Windup {
        k1_nm_per_rad: 400e3,
        k2_nm_per_rad: 610e3,
        k3_nm_per_rad: 710e3,
        t1_nm: 168.0,
        t2_nm: 598.0,
    };

    #[test]
    fn with_k1_in_modes_only_small_oscillations_change() {
        let (tangent, k1) =
            (Curve::Windup(HFUC_58), Curve::Windup(HFUC_58).reduced(JointModel::ThreeSegmentK1));
        for torque_nm in [0.0, 50.0, -300.0, 900.0] {
            assert_eq!(tangent.angle_rad(torque_nm), k1.angle_rad(torque_nm));
            assert_eq!(k1.tangent_compliance_rad_per_nm(torque_nm), 1.0 / 400e3);
        }
        assert_eq!(Curve::Linear(3.0).reduced(JointModel::ThreeSegmentK1), Curve::Linear(3.0));
    }

    #[test]
    fn the_curve_is_odd_continuous_and_has_the_segment_slopes() {
        for t in [10.0, 168.0, 400.0, 598.0, 900.0] {
            assert_eq!(HFUC_58.angle_rad(-t), -HFUC_58.angle_rad(t));
            let step = 1e-6;
            let slope = (HFUC_58.angle_rad(t + 2.0 * step) - HFUC_58.angle_rad(t + step)) / step;
            assert!((slope * HFUC_58.tangent_nm_per_rad(t + step) - 1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn friction_play_on_a_rigid_joint_twists_nothing() {
        let law = JointLaw { hysteresis_rad: 1e-4, ..Curve::Rigid.into() };
        let mut state = law.play_at_rest_nm(20.0);
        for torque_nm in [20.0, 50.0, -30.0] {
            assert_eq!(law.play_angle_rad(torque_nm, &mut state), 0.0);
            assert_eq!(law.rising_angle_rad(torque_nm), 0.0);
        }
    }

    #[test]
    fn a_torque_that_rises_from_rest_follows_the_play_with_a_curve_in_series() {
        let law = JointLaw { hysteresis_rad: 1e-4, ..Curve::Windup(HFUC_58).into() };
        let mut state = 0.0;
        for torque_nm in [1.0, 40.0, 100.0, 300.0, 700.0] {
            let followed = law.play_angle_rad(torque_nm, &mut state);
            assert!((law.rising_angle_rad(torque_nm) - followed).abs() < 1e-18, "{torque_nm}");
            assert_eq!(law.rising_angle_rad(-torque_nm), -law.rising_angle_rad(torque_nm));
        }
        assert!((law.rising_angle_rad(700.0) - (law.angle_rad(700.0) - 1e-4)).abs() < 1e-15);
    }

    #[test]
    fn the_papers_joint_2_twists_by_the_sum_of_two_segments() {
        let by_hand = 168.0 / 400e3 + (568.3 - 168.0) / 610e3;
        assert!((HFUC_58.angle_rad(568.3) - by_hand).abs() < 1e-15);
    }
}
