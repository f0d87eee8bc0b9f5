//! How far a joint twists about its axis under a torque.

use super::JointModel;

/// The three-segment torsion curve of a harmonic-drive gear: odd in the torque, slope 1/K1 up to T1,
/// 1/K2 up to T2, 1/K3 beyond.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Windup {
    /// Stiffness up to T1 \[N m/rad\].
    pub k1_nm_per_rad: f64,
    /// Stiffness between T1 and T2 \[N m/rad\].
    pub k2_nm_per_rad: f64,
    /// Stiffness beyond T2 \[N m/rad\].
    pub k3_nm_per_rad: f64,
    /// End of the first segment \[N m\].
    pub t1_nm: f64,
    /// End of the second segment \[N m\].
    pub t2_nm: f64,
}

/// One straight segment of a torsion curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Torque where it begins \[N m\].
    pub from_nm: f64,
    /// Torque where it ends; infinite for the last \[N m\].
    pub to_nm: f64,
    /// Stiffness within it \[N m/rad\].
    pub stiffness_nm_per_rad: f64,
}

impl Windup {
    /// The three segments, from no torque upward. A break point belongs to the segment below it.
    #[inline]
    pub fn segments(&self) -> [Segment; 3] {
        let segment = |from_nm, to_nm, stiffness_nm_per_rad| Segment { from_nm, to_nm, stiffness_nm_per_rad };
        [
            segment(0.0, self.t1_nm, self.k1_nm_per_rad),
            segment(self.t1_nm, self.t2_nm, self.k2_nm_per_rad),
            segment(self.t2_nm, f64::INFINITY, self.k3_nm_per_rad),
        ]
    }

    /// Twist under the total torque \[rad\].
    #[inline]
    pub fn angle_rad(&self, torque_nm: f64) -> f64 {
        let t = torque_nm.abs();
        let first = t.min(self.t1_nm) / self.k1_nm_per_rad;
        let second = (t.min(self.t2_nm) - self.t1_nm).max(0.0) / self.k2_nm_per_rad;
        let third = (t - self.t2_nm).max(0.0) / self.k3_nm_per_rad;
        (first + second + third).copysign(torque_nm)
    }

    /// Stiffness for a small further torque \[N m/rad\]; at a break point that of the segment below.
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

    /// Whether the slope is at least that of another curve under every torque up to one \[N m\].
    pub fn never_softer(&self, other: &Self, most_nm: f64) -> bool {
        let starts = [0.0, self.t1_nm, self.t2_nm, other.t1_nm, other.t2_nm];
        starts.into_iter().all(|t| t > most_nm || self.slope_beyond(t) >= other.slope_beyond(t))
    }

    /// The slope just beyond a torque.
    fn slope_beyond(&self, torque_nm: f64) -> f64 {
        match torque_nm {
            t if t < self.t1_nm => self.k1_nm_per_rad,
            t if t < self.t2_nm => self.k2_nm_per_rad,
            _ => self.k3_nm_per_rad,
        }
    }

    /// The curve of a gear that is stiffer by a factor under every torque; its break points stay.
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

/// A joint's torsion curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Curve {
    /// No compliance.
    Rigid,
    /// One stiffness \[N m/rad\].
    Linear(f64),
    /// The three-segment curve of a gear.
    Windup(Windup),
    /// The three-segment curve of a gear that is taken to vibrate with its first slope under any torque.
    WindupK1(Windup),
}

impl Curve {
    /// Twist under the total torque \[rad\].
    pub fn angle_rad(&self, torque_nm: f64) -> f64 {
        match self {
            Curve::Rigid => 0.0,
            Curve::Linear(stiffness) => torque_nm / stiffness,
            Curve::Windup(windup) | Curve::WindupK1(windup) => windup.angle_rad(torque_nm),
        }
    }

    /// Twist per further torque \[rad/(N m)\].
    pub fn tangent_compliance_rad_per_nm(&self, torque_nm: f64) -> f64 {
        match self {
            Curve::Rigid => 0.0,
            Curve::Linear(stiffness) => 1.0 / stiffness,
            Curve::Windup(windup) => 1.0 / windup.tangent_nm_per_rad(torque_nm),
            Curve::WindupK1(windup) => 1.0 / windup.k1_nm_per_rad,
        }
    }

    /// The curve of a gear that is stiffer by a factor under every torque; its break points stay.
    #[must_use]
    pub fn stiffened(&self, factor: f64) -> Curve {
        match self {
            Curve::Rigid => Curve::Rigid,
            Curve::Linear(stiffness) => Curve::Linear(stiffness * factor),
            Curve::Windup(windup) => Curve::Windup(windup.stiffened(factor)),
            Curve::WindupK1(windup) => Curve::WindupK1(windup.stiffened(factor)),
        }
    }

    /// The curve as three segments, of one slope if it is a line; `None` if nothing twists.
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

    /// The curve that a joint model uses.
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

    /// The single number that stands for the curve in the paper's model: K2 of a gear.
    pub fn middle_slope(&self) -> Curve {
        match self {
            Curve::Windup(windup) | Curve::WindupK1(windup) => Curve::Linear(windup.k2_nm_per_rad),
            other => *other,
        }
    }
}

/// Torques smaller than this are rounding errors of a joint that carries nothing \[N m\].
const REST_NM: f64 = 1e-9;

/// Play that closes smoothly: `theta += h tanh(T/Tc)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LostMotion {
    /// Half width h \[rad\].
    pub half_width_rad: f64,
    /// Torque scale Tc \[N m\].
    pub torque_nm: f64,
}

impl LostMotion {
    /// Twist under the total torque \[rad\].
    pub fn angle_rad(&self, torque_nm: f64) -> f64 {
        self.half_width_rad * (torque_nm / self.torque_nm).tanh()
    }

    /// Twist per further torque \[rad/(N m)\]; it falls as the torque grows.
    pub fn tangent_compliance_rad_per_nm(&self, torque_nm: f64) -> f64 {
        self.half_width_rad / self.torque_nm / (torque_nm / self.torque_nm).cosh().powi(2)
    }
}

/// All that twists about a joint's axis, in series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointLaw {
    /// The gear.
    pub curve: Curve,
    /// Compliance of flange, shaft or bolts \[rad/(N m)\].
    pub connection_rad_per_nm: f64,
    /// Lost motion.
    pub lost_motion: Option<LostMotion>,
    /// Half width of the friction play \[rad\]; 0 = none. Without history: |T| rising from rest.
    pub hysteresis_rad: f64,
}

impl From<Curve> for JointLaw {
    fn from(curve: Curve) -> Self {
        Self { curve, connection_rad_per_nm: 0.0, lost_motion: None, hysteresis_rad: 0.0 }
    }
}

impl JointLaw {
    /// Twist under the total torque \[rad\] without the friction play.
    pub fn angle_rad(&self, torque_nm: f64) -> f64 {
        let play = self.lost_motion.map_or(0.0, |lost| lost.angle_rad(torque_nm));
        self.curve.angle_rad(torque_nm) + self.connection_rad_per_nm * torque_nm + play
    }

    /// Twist per further torque \[rad/(N m)\]; the friction play does not move in small oscillations.
    pub fn tangent_compliance_rad_per_nm(&self, torque_nm: f64) -> f64 {
        let play = self.lost_motion.map_or(0.0, |lost| lost.tangent_compliance_rad_per_nm(torque_nm));
        self.curve.tangent_compliance_rad_per_nm(torque_nm) + self.connection_rad_per_nm + play
    }

    /// Gear and connection as one curve; play is no part of it.
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

    /// Whether there is play beside the curve.
    pub fn has_play(&self) -> bool {
        self.lost_motion.is_some() || self.hysteresis_rad > 0.0
    }

    /// Twist when the torque has risen from rest to `torque_nm` \[rad\]: the friction play, at 0 at rest,
    /// holds back up to its half width.
    pub fn rising_angle_rad(&self, torque_nm: f64) -> f64 {
        self.play_angle_rad(torque_nm, &mut 0.0)
    }

    /// Stiffness of the spring that the friction play drags: the gear's middle slope with the
    /// connection in series \[N m/rad\]; none without play, or where nothing twists for friction to hold.
    pub(crate) fn play_stiffness_nm_per_rad(&self) -> Option<f64> {
        let gear = self.curve.middle_slope().tangent_compliance_rad_per_nm(0.0);
        let compliance = gear + self.connection_rad_per_nm;
        (self.hysteresis_rad > 0.0 && compliance > 0.0).then(|| 1.0 / compliance)
    }

    /// Twist at a torque when the friction play stands at `state` (a torque \[N m\], updated): the play
    /// follows the torque at a distance of at most k h.
    pub fn play_angle_rad(&self, torque_nm: f64, state: &mut f64) -> f64 {
        let angle = self.angle_rad(torque_nm);
        let Some(stiffness) = self.play_stiffness_nm_per_rad() else { return angle };
        let reach = stiffness * self.hysteresis_rad;
        *state = state.max(torque_nm - reach).min(torque_nm + reach);
        angle + (*state - torque_nm) / stiffness
    }

    /// Where the play stands after the torque's size has risen from rest to `torque_nm` \[N m\].
    pub fn play_at_rest_nm(&self, torque_nm: f64) -> f64 {
        let sign = if torque_nm.abs() < REST_NM { 0.0 } else { torque_nm.signum() };
        torque_nm - sign * self.play_stiffness_nm_per_rad().unwrap_or_default() * self.hysteresis_rad
    }

    /// Whether nothing twists.
    pub fn is_rigid(&self) -> bool {
        self.curve == Curve::Rigid && self.connection_rad_per_nm == 0.0 && self.lost_motion.is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
