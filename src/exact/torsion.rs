//! Torsion curves of gears (twist as a function of torque), and envelopes of several curves.

use super::joint_play::JointPlay;
use crate::arm::joint_law::{Curve, JointLaw, Segment, Windup};

/// Stiffness that stands for a rigid gear in series with lost motion \[N m/rad\]. Its compliance is so small that it
/// changes no compliance of a joint by more than a fraction of 1e-9.
const RIGID_NM_PER_RAD: f64 = 1e18;

/// A torsion curve with precomputed compliances, so that its evaluation needs no division.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Torsion {
    pub windup: Windup,
    /// Compliance of each of the three segments \[rad/(N m)\].
    compliance: [f64; 3],
    /// Twist at which the second and the third segment begin \[rad\].
    begins_rad: [f64; 2],
}

impl Torsion {
    fn new(windup: Windup) -> Self {
        let compliance = windup.segments().map(|s| 1.0 / s.stiffness_nm_per_rad);
        let second = windup.t1_nm * compliance[0];
        // A curve with a single slope has infinite T1 and T2, whose difference is NaN. `max` turns it into a length of
        // 0.
        let third = second + (windup.t2_nm - windup.t1_nm).max(0.0) * compliance[1];
        Self { windup, compliance, begins_rad: [second, third] }
    }

    /// Twist \[rad\] under a torque \[N m\] of either sign.
    #[inline]
    pub(super) fn angle_rad(&self, torque_nm: f64) -> f64 {
        let t = torque_nm.abs();
        let segment = usize::from(t > self.windup.t1_nm) + usize::from(t > self.windup.t2_nm);
        self.angle_in(segment, t).copysign(torque_nm)
    }

    /// Twist \[rad\] under a torque that is not negative \[N m\] and that lies in this segment.
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

/// A set of torsion curves, described by its stiffest and its softest envelope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CurveBox {
    /// A curve that is nowhere softer than any member. For a single member it is the member's curve itself.
    pub stiff: Torsion,
    /// A curve that is nowhere stiffer than any member. For a single member it is the member's curve itself.
    pub soft: Torsion,
    /// Whether modes use the slope of the first segment, K1, whatever the torque is.
    pub k1_in_modes: bool,
}

impl CurveBox {
    /// The box of the torsion curve in one joint's law, without play. `None` for a rigid joint without lost motion.
    pub(super) fn of(law: &JointLaw) -> Option<Self> {
        let curve = match law.without_play() {
            Curve::Rigid if law.lost_motion.is_some() => Curve::Linear(RIGID_NM_PER_RAD),
            curve => curve,
        };
        let torsion = Torsion::new(curve.as_windup()?);
        Some(Self { stiff: torsion, soft: torsion, k1_in_modes: !matches!(curve, Curve::Windup(_)) })
    }

    /// Whether every gear of the box vibrates with a single slope and a single play under all static torques whose
    /// magnitude lies between `least_nm` and `most_nm` \[N m\]. `breaks` are the break points of the gears' curves.
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

    /// Greatest slope with which a gear of the box may vibrate \[N m/rad\] under static torques whose magnitude lies
    /// between `least_nm` and `most_nm` \[N m\].
    pub(super) fn stiffest(&self, least_nm: f64, most_nm: f64) -> f64 {
        self.slopes(&self.stiff.windup, least_nm, most_nm).fold(0.0, f64::max)
    }

    /// Least slope with which a gear of the box may vibrate \[N m/rad\] under static torques whose magnitude lies
    /// between `least_nm` and `most_nm` \[N m\].
    pub(super) fn softest(&self, least_nm: f64, most_nm: f64) -> f64 {
        self.slopes(&self.soft.windup, least_nm, most_nm).fold(f64::INFINITY, f64::min)
    }

    /// Greatest slope of the torsion curves \[N m/rad\] for static twist under torques whose magnitude lies between
    /// `least_nm` and `most_nm` \[N m\]. Static twist uses the slope at the torque even if modes use K1.
    pub(super) fn steepest(&self, least_nm: f64, most_nm: f64) -> f64 {
        slopes(&self.stiff.windup, least_nm, most_nm).fold(0.0, f64::max)
    }

    /// The least and the greatest twist \[rad\] of any gear of the box with its play, under torques between `low` and
    /// `high` \[N m\].
    pub(super) fn twist(&self, play: Option<&JointPlay>, [low, high]: [f64; 2]) -> [f64; 2] {
        let least = if low >= 0.0 { &self.stiff } else { &self.soft }.angle_rad(low);
        let most = if high >= 0.0 { &self.soft } else { &self.stiff }.angle_rad(high);
        let [less, more] = self.twist_of_play(play, [low, high]);
        [least + less, most + more]
    }

    /// The least and the greatest twist \[rad\] that play adds to the twist of any gear of the box, under torques in
    /// the interval `between_nm` \[N m\].
    pub(super) fn twist_of_play(&self, play: Option<&JointPlay>, between_nm: [f64; 2]) -> [f64; 2] {
        let middle = [&self.stiff, &self.soft].map(|torsion| torsion.compliance[1]);
        play.map_or([0.0; 2], |play| play.twist(middle, between_nm))
    }

    /// The slopes of the curve `w` with which a gear may vibrate \[N m/rad\] under static torques whose magnitude lies
    /// between `least_nm` and `most_nm` \[N m\].
    fn slopes(&self, w: &Windup, least_nm: f64, most_nm: f64) -> impl Iterator<Item = f64> {
        let (least_nm, most_nm) = if self.k1_in_modes { (0.0, 0.0) } else { (least_nm, most_nm) };
        slopes(w, least_nm, most_nm)
    }

    /// The box of all members of this box and of `other`.
    pub(super) fn join(&self, other: &Self) -> Self {
        Self {
            stiff: join(rising, [&self.stiff, &other.stiff], f64::max, f64::min),
            soft: join(rising_below, [&self.soft, &other.soft], f64::min, f64::max),
            k1_in_modes: self.k1_in_modes && other.k1_in_modes,
        }
    }
}

/// A curve that bounds the curves `both` on one side. First `lifted` replaces each of them by a curve whose slope does
/// not fall with torque. Then `slope` selects the slope of each segment, and `end` the break points: the larger or the
/// smaller of the two.
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

/// The softest curve whose slope does not fall with torque and is nowhere below the slope of `w`. If several such
/// curves are combined by the greatest slopes and the least break points, the result is nowhere softer than any of
/// them.
fn rising(w: &Windup) -> Windup {
    let k2 = w.k1_nm_per_rad.max(w.k2_nm_per_rad);
    Windup { k2_nm_per_rad: k2, k3_nm_per_rad: k2.max(w.k3_nm_per_rad), ..*w }
}

/// The stiffest curve whose slope does not fall with torque and is nowhere above the slope of `w`.
fn rising_below(w: &Windup) -> Windup {
    let k2 = w.k2_nm_per_rad.min(w.k3_nm_per_rad);
    Windup { k1_nm_per_rad: k2.min(w.k1_nm_per_rad), k2_nm_per_rad: k2, ..*w }
}

/// The slopes of those segments of `w` \[N m/rad\] that contain a torque whose magnitude lies between `least_nm` and
/// `most_nm` \[N m\].
fn slopes(w: &Windup, least_nm: f64, most_nm: f64) -> impl Iterator<Item = f64> {
    // A break point belongs to the segment below it.
    let touched = move |s: &Segment| least_nm <= s.to_nm && (most_nm > s.from_nm || s.from_nm == 0.0);
    w.segments().into_iter().filter(touched).map(|s| s.stiffness_nm_per_rad)
}

/// A set of break points, stored as bits on a logarithmic grid of torque with steps of about 5 %.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct BreakPoints([u64; 4]);

impl BreakPoints {
    /// Number of grid cells.
    const CELLS: f64 = 256.0;
    /// Number of factors of two that the grid spans.
    const OCTAVES: f64 = 18.0;
    /// Binary logarithm of the torque at the lower end of the grid \[N m\].
    const LEAST_LOG2: f64 = -4.0;

    /// The break points of one curve.
    pub(super) fn of(w: &Windup) -> Self {
        [w.t1_nm, w.t2_nm].into_iter().filter(|t| t.is_finite()).fold(Self::default(), |mut set, t_nm| {
            let cell = Self::cell(t_nm);
            set.0[cell / 64] |= 1 << (cell % 64);
            set
        })
    }

    /// The break points of this set and of `other`.
    pub(super) fn join(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] | other.0[i]))
    }

    /// Whether the set may have a break point between two torques \[N m\]. The grid has steps of about 5 %, so the
    /// answer may be `true` although the nearest break point lies just outside.
    fn any_between(&self, least_nm: f64, most_nm: f64) -> bool {
        (Self::cell(least_nm)..=Self::cell(most_nm)).any(|cell| self.0[cell / 64] >> (cell % 64) & 1 == 1)
    }

    /// The index of the grid cell of a torque \[N m\]. Torques beyond the grid are assigned to its first or last cell.
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
        /// The curve with precomputed compliances equals the original curve, and a box of curves encloses its members.
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
