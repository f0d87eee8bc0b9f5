//! Torsion curves of gears, and boxes of curves.

use super::joint_play::JointPlay;
use crate::arm::joint_law::{Curve, JointLaw, Segment, Windup};

/// Stiffness that stands for a rigid gear in series with lost motion \[N m/rad\]. It adds at most a part in 1e9 to
/// any compliance.
const RIGID_NM_PER_RAD: f64 = 1e18;

/// A torsion curve prepared for many evaluations, without divisions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Torsion {
    pub windup: Windup,
    /// Compliance of each segment \[rad/(N m)\]. `begins_rad` holds the twist where the second and the third segment
    /// begin \[rad\].
    compliance: [f64; 3],
    begins_rad: [f64; 2],
}

impl Torsion {
    fn new(windup: Windup) -> Self {
        let compliance = windup.segments().map(|s| 1.0 / s.stiffness_nm_per_rad);
        let second = windup.t1_nm * compliance[0];
        // A segment that never begins has no length.
        let third = second + (windup.t2_nm - windup.t1_nm).max(0.0) * compliance[1];
        Self { windup, compliance, begins_rad: [second, third] }
    }

    /// Twist under a torque \[rad\].
    #[inline]
    pub(super) fn angle_rad(&self, torque_nm: f64) -> f64 {
        let t = torque_nm.abs();
        let segment = usize::from(t > self.windup.t1_nm) + usize::from(t > self.windup.t2_nm);
        self.angle_in(segment, t).copysign(torque_nm)
    }

    /// Twist under a torque that is not negative, if the torque is in this segment \[rad\].
    #[inline]
    pub(super) fn angle_in(&self, segment: usize, t_nm: f64) -> f64 {
        let Windup { t1_nm, t2_nm, .. } = self.windup;
        match segment {
            0 => t_nm * self.compliance[0],
            1 => self.begins_rad[0] + (t_nm - t1_nm) * self.compliance[1],
            _ => self.begins_rad[1] + (t_nm - t2_nm) * self.compliance[2],
        }
    }
}

/// A box of torsion curves, between its stiffest and its softest envelope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CurveBox {
    /// A curve that is nowhere softer than a member. For a single member it is the member's curve.
    pub stiff: Torsion,
    /// A curve that is nowhere stiffer than a member. For a single member it is the member's curve.
    pub soft: Torsion,
    /// Whether modes use the slope of the first segment under any torque.
    pub k1_in_modes: bool,
}

impl CurveBox {
    /// The box of one joint's law without its play. `None` for a joint that does not twist.
    pub(super) fn of(law: &JointLaw) -> Option<Self> {
        let curve = match law.without_play() {
            Curve::Rigid if law.lost_motion.is_some() => Curve::Linear(RIGID_NM_PER_RAD),
            curve => curve,
        };
        let torsion = Torsion::new(curve.as_windup()?);
        Some(Self { stiff: torsion, soft: torsion, k1_in_modes: !matches!(curve, Curve::Windup(_)) })
    }

    /// Whether, for each gear of the box, modes see the same slope and the same play under all torques with
    /// magnitudes in an interval \[N m\].
    pub(super) fn keeps_its_slope(
        &self,
        play: Option<&JointPlay>,
        [least_nm, most_nm]: [f64; 2],
        breaks: BreakPoints,
    ) -> bool {
        let between = |t_nm: f64| least_nm <= t_nm && t_nm <= most_nm;
        let keeps_its_segment = self.k1_in_modes
            || match self.stiff == self.soft {
                true => !between(self.stiff.windup.t1_nm) && !between(self.stiff.windup.t2_nm),
                false => !breaks.any_between(least_nm, most_nm),
            };
        keeps_its_segment && play.is_none_or(|play| play.stays(most_nm))
    }

    /// Greatest slope that modes may see at torque magnitudes in an interval \[N m/rad\].
    pub(super) fn stiffest(&self, least_nm: f64, most_nm: f64) -> f64 {
        self.slopes(&self.stiff.windup, least_nm, most_nm).fold(0.0, f64::max)
    }

    /// Least slope that modes may see at torque magnitudes in an interval \[N m/rad\].
    pub(super) fn softest(&self, least_nm: f64, most_nm: f64) -> f64 {
        self.slopes(&self.soft.windup, least_nm, most_nm).fold(f64::INFINITY, f64::min)
    }

    /// Greatest slope of the static twist at torque magnitudes in an interval \[N m/rad\]. It also counts if modes
    /// use the slope of the first segment.
    pub(super) fn steepest(&self, least_nm: f64, most_nm: f64) -> f64 {
        slopes(&self.stiff.windup, least_nm, most_nm).fold(0.0, f64::max)
    }

    /// Least and greatest twist for torques in an interval, with play \[rad\].
    pub(super) fn twist(&self, play: Option<&JointPlay>, [low, high]: [f64; 2]) -> [f64; 2] {
        let least = if low >= 0.0 { &self.stiff } else { &self.soft }.angle_rad(low);
        let most = if high >= 0.0 { &self.soft } else { &self.stiff }.angle_rad(high);
        let [less, more] = self.twist_of_play(play, [low, high]);
        [least + less, most + more]
    }

    /// The part of the twist that comes from play \[rad\].
    pub(super) fn twist_of_play(&self, play: Option<&JointPlay>, between_nm: [f64; 2]) -> [f64; 2] {
        let middle = [&self.stiff, &self.soft].map(|torsion| torsion.compliance[1]);
        play.map_or([0.0; 2], |play| play.twist(middle, between_nm))
    }

    /// The slopes that modes may see at torque magnitudes in an interval.
    fn slopes(&self, w: &Windup, least_nm: f64, most_nm: f64) -> impl Iterator<Item = f64> {
        let (least_nm, most_nm) = if self.k1_in_modes { (0.0, 0.0) } else { (least_nm, most_nm) };
        slopes(w, least_nm, most_nm)
    }

    pub(super) fn join(&self, other: &Self) -> Self {
        Self {
            stiff: join(rising, [&self.stiff, &other.stiff], f64::max, f64::min),
            soft: join(rising_below, [&self.soft, &other.soft], f64::min, f64::max),
            k1_in_modes: self.k1_in_modes && other.k1_in_modes,
        }
    }
}

/// A curve that bounds two others on one side. Its slopes and break points are the extremes of theirs, after the
/// slopes of each were made to rise with torque.
fn join(
    lifted: fn(&Windup) -> Windup,
    both: [&Torsion; 2],
    slope: fn(f64, f64) -> f64,
    end: fn(f64, f64) -> f64,
) -> Torsion {
    let [a, b] = both.map(|torsion| lifted(&torsion.windup));
    Torsion::new(Windup {
        k1_nm_per_rad: slope(a.k1_nm_per_rad, b.k1_nm_per_rad),
        k2_nm_per_rad: slope(a.k2_nm_per_rad, b.k2_nm_per_rad),
        k3_nm_per_rad: slope(a.k3_nm_per_rad, b.k3_nm_per_rad),
        t1_nm: end(a.t1_nm, b.t1_nm),
        t2_nm: end(a.t2_nm, b.t2_nm),
    })
}

/// The curve with the least slopes that do not fall with torque and are nowhere below those of `w`. Of several such
/// curves, the greatest slopes and the least break points make a curve that is nowhere softer than any of them.
fn rising(w: &Windup) -> Windup {
    let k2 = w.k1_nm_per_rad.max(w.k2_nm_per_rad);
    Windup { k2_nm_per_rad: k2, k3_nm_per_rad: k2.max(w.k3_nm_per_rad), ..*w }
}

/// The curve with the greatest slopes that do not fall with torque and are nowhere above those of `w`.
fn rising_below(w: &Windup) -> Windup {
    let k2 = w.k2_nm_per_rad.min(w.k3_nm_per_rad);
    Windup { k1_nm_per_rad: k2.min(w.k1_nm_per_rad), k2_nm_per_rad: k2, ..*w }
}

/// The slopes of the segments that the torques of an interval touch. Torques are given by their magnitudes.
fn slopes(w: &Windup, least_nm: f64, most_nm: f64) -> impl Iterator<Item = f64> {
    // A break point belongs to the segment below it
    let touched = move |s: &Segment| least_nm <= s.to_nm && (most_nm > s.from_nm || s.from_nm == 0.0);
    w.segments().into_iter().filter(touched).map(|s| s.stiffness_nm_per_rad)
}

/// The break points of a set of curves, as bits on a logarithmic grid of about 5 %.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct BreakPoints([u64; 4]);

impl BreakPoints {
    const CELLS: f64 = 256.0;
    const OCTAVES: f64 = 18.0;
    const LEAST_LOG2: f64 = -4.0;

    /// The break points of one curve.
    pub(super) fn of(w: &Windup) -> Self {
        [w.t1_nm, w.t2_nm].into_iter().filter(|t| t.is_finite()).fold(Self::default(), |mut set, t_nm| {
            let cell = Self::cell(t_nm);
            set.0[cell / 64] |= 1 << (cell % 64);
            set
        })
    }

    pub(super) fn join(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] | other.0[i]))
    }

    /// Whether a break point may lie between two torques \[N m\].
    fn any_between(&self, least_nm: f64, most_nm: f64) -> bool {
        (Self::cell(least_nm)..=Self::cell(most_nm)).any(|cell| self.0[cell / 64] >> (cell % 64) & 1 == 1)
    }

    /// The grid cell of a torque. Torques beyond the grid count to its ends.
    fn cell(t_nm: f64) -> usize {
        let at = (libm::log2(t_nm) - Self::LEAST_LOG2) * (Self::CELLS / Self::OCTAVES);
        at.clamp(0.0, Self::CELLS - 1.0) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The prepared curve equals the curve, and a box of curves encloses its members.
        #[test]
        fn twists_are_those_of_the_curve_and_inside_every_box(
            slopes in prop::array::uniform6(0.1f64..3.0), ends in prop::array::uniform2((0.1f64..3.0, 0.0f64..3.0)),
            torque_nm in -8.0f64..8.0,
        ) {
            let windup = |g: usize| Windup {
                k1_nm_per_rad: slopes[g], k2_nm_per_rad: slopes[g + 2], k3_nm_per_rad: slopes[g + 4],
                t1_nm: ends[g].0, t2_nm: ends[g].0 + ends[g].1,
            };
            let both = [windup(0), windup(1)];
            let [a, b] = both.map(|curve| {
                CurveBox::of(&JointLaw::from(Curve::Windup(curve))).unwrap()
            });
            for (curve, windup) in [&a, &b].into_iter().zip(both) {
                let twist = windup.angle_rad(torque_nm);
                prop_assert!((curve.stiff.angle_rad(torque_nm) - twist).abs() <= 1e-14 * twist.abs());
                let [least, most] = a.join(&b).twist(None, [torque_nm; 2]);
                prop_assert!(least <= twist + 1e-12 && twist <= most + 1e-12, "{least} {twist} {most}");
            }
            let line = CurveBox::of(&JointLaw::from(Curve::Linear(2.0))).unwrap();
            prop_assert_eq!(line.stiff.angle_rad(torque_nm), 0.5 * torque_nm);
            prop_assert!(line.stiff == line.soft);
        }
    }
}
