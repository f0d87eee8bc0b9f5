//! The numbers of a part on which bounds depend, and their intervals over a box of parts.
//!
//! A part is a tube or a drive. A box of parts is a set of them, its members. The bounds of a box hold for every
//! member.

use super::torsion::{BreakPoints, CurveBox};
use super::tree::{Bounds, Key};
use crate::arm::LinkModel;
use crate::arm::structure::{Beam, LinkPiece};
use crate::mechanics::beam::{line_stiffnesses, tube_inertia};
use crate::mechanics::link_stress::StressCheck;
use crate::sizing::bearing::BearingDemand;
use crate::sizing::demand::{JointDemand, JointMotion};
use crate::sizing::fit::LinkRoom;
use crate::sizing::limits::DriveLimits;
use crate::space::design_space::LinkOption;
use std::sync::Arc;

/// Number of line inertias of a [`Line`].
pub(super) const INERTIAS: usize = 5;
/// Number of stiffnesses of a [`Line`].
pub(super) const STIFFNESSES: usize = 5;

/// A tube's inertias and stiffnesses per metre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line {
    /// Mass \[kg/m\], outer area \[m²\], and rotary inertias about the link's x, y and z axis \[kg m\]. The x axis lies
    /// along the link.
    pub inertias: [f64; INERTIAS],
    /// `EI` about y and z \[N m²\], `κGA` \[N\], `GJ` \[N m²\], `EA` \[N\]. Infinite where the link model has
    /// no such strain.
    pub stiffnesses: [f64; STIFFNESSES],
}

/// Indices of the five inertias in [`Line::inertias`].
pub(super) mod inertia {
    pub(crate) const MASS: usize = 0;
    pub(crate) const OUTER_AREA: usize = 1;
    pub(crate) const POLAR: usize = 2;
    pub(crate) const ROTARY_Y: usize = 3;
    pub(crate) const ROTARY_Z: usize = 4;
}

impl Line {
    /// The numbers of a tube with its harness. The link model tells which strains the tube has.
    pub(super) fn new(beam: &Beam, harness_kg_per_m: f64, model: LinkModel) -> Self {
        let tube = tube_inertia(beam, model);
        let is_compliant = |place: usize| match model {
            LinkModel::Rigid => false,
            LinkModel::Bending => place < 2,
            LinkModel::Full => true,
        };
        let mut stiffnesses = line_stiffnesses(beam).map(|s| s / beam.flexibility);
        for (place, stiffness) in stiffnesses.iter_mut().enumerate() {
            if !is_compliant(place) {
                *stiffness = f64::INFINITY;
            }
        }
        Self {
            inertias: [
                tube.along_kg_per_m + harness_kg_per_m,
                beam.section.properties(beam.material.poisson).outer_area_m2,
                tube.polar_kg_m,
                tube.rotary_y_kg_m,
                tube.rotary_z_kg_m,
            ],
            stiffnesses,
        }
    }
}

/// A box of link options, with the least and the greatest value of each number over its members.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LinkBox {
    pub low: Line,
    pub high: Line,
    /// Least and greatest compliances over the members. Each compliance is the reciprocal of a stiffness per metre.
    pub compliances: [[f64; STIFFNESSES]; 2],
    /// Least ratio of stress to strength: per axial force \[1/N\], per moment about y, per moment about z and per
    /// torsional moment \[1/(N m)\]. Zero if the strength of a member is unknown.
    pub stress: [f64; 4],
    /// Whether some member is a round tube or bar, or has no known strength. Bending stresses of a round section about two
    /// axes add as a vector, which is less than their sum.
    pub round: bool,
    /// Least cost of the material \[EUR/m\].
    pub cost_eur_per_m: f64,
    /// Least and greatest lever \[m\]. The lever is a distance along the axis of the joint directly inboard: from the
    /// face of the joint's flange to the point where the link attaches. It is 0 if the bearing of this joint is not
    /// checked.
    pub lever_m: [f64; 2],
    /// Least and greatest space that the link leaves for the gear and motor of the joint inboard.
    pub room: [LinkRoom; 2],
}

impl LinkBox {
    /// The box of one option. `link` is the option with the effects of the study. `lever_m` is the lever of the loads
    /// on the bearing of the joint inboard \[m\], and `room` is the space that the option leaves for the drive of this
    /// joint.
    pub(super) fn of(
        option: &LinkOption,
        link: &LinkPiece,
        model: LinkModel,
        lever_m: f64,
        room: LinkRoom,
    ) -> Self {
        let nominal = Beam { material: option.material, section: option.section, flexibility: 1.0 };
        let line = Line::new(link.beam.as_ref().unwrap_or(&nominal), link.harness_kg_per_m, model);
        let check = StressCheck::new(&option.material, &option.section);
        let stress = check.as_ref().map_or([0.0; 4], |s| {
            [s.per_axial_n, s.per_moment_y, s.per_moment_z, s.per_torsion].map(|x| x / s.strength_pa)
        });
        Self {
            low: line,
            high: line,
            compliances: [line.stiffnesses.map(f64::recip); 2],
            stress,
            round: check.is_none_or(|s| s.round),
            cost_eur_per_m: option.cost_eur_per_kg.unwrap_or(0.0) * option.mass_kg_per_m(),
            lever_m: [lever_m; 2],
            room: [room; 2],
        }
    }
}

/// The smallest interval that contains two intervals.
fn joined(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

fn pairwise<const N: usize>(a: &[f64; N], b: &[f64; N], pick: fn(f64, f64) -> f64) -> [f64; N] {
    std::array::from_fn(|i| pick(a[i], b[i]))
}

impl Bounds for LinkBox {
    fn join(&self, other: &Self) -> Self {
        let line = |a: &Line, b: &Line, pick| Line {
            inertias: pairwise(&a.inertias, &b.inertias, pick),
            stiffnesses: pairwise(&a.stiffnesses, &b.stiffnesses, pick),
        };
        Self {
            low: line(&self.low, &other.low, f64::min),
            high: line(&self.high, &other.high, f64::max),
            compliances: [
                pairwise(&self.compliances[0], &other.compliances[0], f64::min),
                pairwise(&self.compliances[1], &other.compliances[1], f64::max),
            ],
            stress: pairwise(&self.stress, &other.stress, f64::min),
            round: self.round || other.round,
            cost_eur_per_m: self.cost_eur_per_m.min(other.cost_eur_per_m),
            lever_m: joined(self.lever_m, other.lever_m),
            room: [self.room[0].min(other.room[0]), self.room[1].max(other.room[1])],
        }
    }

    /// The logarithms of mass and stiffnesses, by which the tree separates tubes. Mass is weighted twice, because it is
    /// an objective and also loads everything inboard. Shear stiffness is weighted little and axial stiffness not at
    /// all, because they hardly change any objective.
    fn key(&self) -> Key {
        let s = self.low.stiffnesses.map(|s| if s.is_finite() { libm::log(s) } else { 0.0 });
        [2.0 * libm::log(self.low.inertias[inertia::MASS]), s[0], 0.7 * s[1], 0.1 * s[2], 0.3 * s[3]]
    }
}

/// Relative difference below which a torque and a break point count as equal.
pub(super) const SAME_TORQUE: f64 = 1e-12;

/// Number of rays: the proportions of static torque and inertia for which the capacity of each box of drives is stored.
pub(super) const RAYS: usize = 12;

/// Rays: demands on a joint in fixed proportions of static torque and inertia. A drive that carries a demand also
/// carries every smaller multiple of it. Take the multiple of a ray that lies just below a demand. If no member of a
/// box carries this multiple, no member carries the demand. This excludes boxes in which each single limit is met, but
/// by different members.
pub(super) struct Rays {
    /// Static torque \[N m\] and inertia \[kg m²\] whose multiples make up each ray.
    loads: [(f64, f64); RAYS],
    /// Demand on the joint under the static torque and the inertia of each ray.
    demands: [JointDemand; RAYS],
}

impl Rays {
    /// The rays of a joint, around the proportion of static torque to inertia that the payload alone causes. A part of
    /// the demand that does not grow with torque and inertia would break the proportions of the rays. So the demand of
    /// a duty that is stated in numbers is left out, and the remaining demand is a lower bound. The inertia of the
    /// motor itself does not grow with the load either:
    /// [`MotorHeat::multiple_of`](crate::sizing::heat::MotorHeat::multiple_of) accounts for it.
    pub(super) fn new(motion: &JointMotion, payload_static_nm: f64, payload_inertia_kgm2: f64) -> Self {
        let motion = motion.without_stated();
        let loads = std::array::from_fn(|k| match k {
            0 => (0.0, 1.0),
            1 => (1.0, 0.0),
            _ if payload_static_nm > 0.0 => {
                (1.0, 1.25 * 0.8f64.powi(k as i32 - 2) * payload_inertia_kgm2 / payload_static_nm)
            }
            _ => (0.0, 1.0),
        });
        Self { demands: loads.map(|(static_nm, inertia)| motion.demand(static_nm, inertia)), loads }
    }

    /// For each ray (fixed proportion of static torque and inertia), the greatest multiple of its demand that a drive
    /// with the limits `limits` carries.
    pub(super) fn capacity(&self, limits: &DriveLimits) -> [f64; RAYS] {
        self.demands.each_ref().map(|demand| limits.multiple_of(demand))
    }
}

/// Fraction by which the motor heat is lowered in a least demand and raised in a greatest demand, to cover rounding. A
/// margin on the loads alone would not be enough, because the motor's own inertia can cause most of the heat.
pub(super) const HEAT_ROUNDING: f64 = 1e-12;

/// The least demand that the members of a box put on a joint.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LeastDemand {
    pub demand: JointDemand,
    /// For each ray (a fixed proportion of static torque and inertia), the greatest multiple of the ray's demand that
    /// lies below `demand`.
    multiples: [f64; RAYS],
}

impl LeastDemand {
    /// The demand of a static torque \[N m\] and an inertia \[kg m²\], with the loads on the bearing and the space that
    /// the link leaves for the drive.
    pub(super) fn new(
        motion: &JointMotion,
        rays: &Rays,
        static_nm: f64,
        inertia_kgm2: f64,
        bearing: BearingDemand,
        room: LinkRoom,
    ) -> Self {
        let times = |asked: f64, unit: f64| if unit > 0.0 { asked / unit } else { f64::INFINITY };
        let multiples =
            rays.loads.map(|(t, i)| times(static_nm, t).min(times(inertia_kgm2, i)) * (1.0 - 1e-12));
        let demand = motion.demand(static_nm, inertia_kgm2).with_heat_times(1.0 - HEAT_ROUNDING);
        // The rays put no load on the bearing, so a multiple of a ray is below the demand whatever the bearing load is.
        Self { demand: demand.with_bearing(bearing).with_room(room), multiples }
    }
}

/// Tilt per moment that a rigid bearing gets in a joint where the bearings of other drives tilt \[rad/(N m)\]. A
/// stiffness of 0 could not stand for it, because 0 means a coordinate that is rigid in all members of all boxes. The
/// tilt adds less than 1e-9 of any deflection.
pub(super) const RIGID_RAD_PER_NM: f64 = 1e-18;

/// The stiffness of a linear spring \[N m/rad\] with this compliance \[rad/(N m)\]; 0 stands for a rigid spring.
#[inline]
pub(super) fn stiffness_of(rad_per_nm: f64) -> f64 {
    if rad_per_nm > 0.0 { rad_per_nm.recip() } else { 0.0 }
}

/// A box of drives, with the least and the greatest value of each number over its members.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DriveBox {
    /// Least and greatest mass \[kg\].
    pub mass_kg: [f64; 2],
    /// The greatest value of each limit of a drive over the members.
    pub limits: DriveLimits,
    /// The least value of each limit of a drive over the members.
    pub least_limits: DriveLimits,
    /// For each ray (fixed proportion of static torque and inertia), the greatest multiple of its demand that a single
    /// member carries.
    pub multiples: [f64; RAYS],
    /// Envelopes of the torsion curves of the members; `None` if one of them is rigid.
    pub curve: Option<CurveBox>,
    /// The break points (torques at which the slope changes) of the members' torsion curves, as a set.
    pub breaks: BreakPoints,
    /// Least and greatest tilt of the output bearing per moment \[rad/(N m)\], including the tilt that an effect adds
    /// in series. 0 if no drive of the joint has a bearing that tilts.
    pub tilt_rad_per_nm: [f64; 2],
    /// The limits of the drives, for a box that is one kind of several drives. A drive is left out if another drive of
    /// the kind reaches all its limits. The kind carries a demand if one of the listed drives does. `None` if one
    /// drive reaches the limits of all others, and for any other box.
    pub each: Option<Arc<[DriveLimits]>>,
}

impl DriveBox {
    /// The box of one kind: drives of equal mass, torsion curve and bearing stiffness. `None` without drives.
    pub(super) fn of_kind(drives: impl Iterator<Item = Self>) -> Option<Self> {
        let drives: Vec<Self> = drives.collect();
        let kind =
            drives.iter().cloned().reduce(|kind, drive| Self { curve: kind.curve, ..kind.join(&drive) })?;
        let covered = |(at, drive): (usize, &Self)| {
            let covers = |other: &Self| other.limits.cover(&drive.limits);
            drives[..at].iter().any(covers)
                || drives[at + 1..].iter().any(|o| covers(o) && !drive.limits.cover(&o.limits))
        };
        let each: Vec<DriveLimits> =
            drives.iter().enumerate().filter(|d| !covered(*d)).map(|(_, d)| d.limits).collect();
        // If one drive reaches the limits of all others, its limits are the limits of the box, and no list is needed.
        Some(Self { each: (each.len() > 1).then(|| Arc::from(each)), ..kind })
    }

    /// Whether some member may carry the least demand `asked`. `false` is certain; `true` may be wrong for a box of
    /// several drives.
    #[inline]
    pub(super) fn may_hold(&self, asked: &LeastDemand) -> bool {
        self.hold(&asked.demand)
            && self.multiples.iter().zip(&asked.multiples).all(|(carried, asked)| carried >= asked)
    }

    /// Whether the demand is within the greatest value of each limit over the members. For a box of a single kind the
    /// answer is exact: it tells whether one of the drives of the kind carries the demand.
    #[inline]
    pub(super) fn hold(&self, demand: &JointDemand) -> bool {
        self.limits.hold(demand)
            && self.each.as_ref().is_none_or(|each| each.iter().any(|limits| limits.hold(demand)))
    }
}

impl Bounds for DriveBox {
    fn join(&self, other: &Self) -> Self {
        Self {
            mass_kg: joined(self.mass_kg, other.mass_kg),
            limits: self.limits.max(&other.limits),
            least_limits: self.least_limits.min(&other.least_limits),
            multiples: pairwise(&self.multiples, &other.multiples, f64::max),
            // A rigid member makes the stiff side rigid, so the box has no curve.
            curve: self.curve.zip(other.curve).map(|(a, b)| a.join(&b)),
            breaks: self.breaks.join(&other.breaks),
            tilt_rad_per_nm: joined(self.tilt_rad_per_nm, other.tilt_rad_per_nm),
            each: None,
        }
    }

    /// The numbers by which the tree separates drives. The first three describe the torsion curve, because all drives
    /// with the same gear have the same curve. Mass and the load that the drive can carry follow.
    fn key(&self) -> Key {
        let k = self.curve.map_or([0.0; 3], |c| {
            let w = &c.stiff.windup;
            [libm::log(w.k1_nm_per_rad), libm::log(w.k3_nm_per_rad), 0.2 * libm::log(w.t1_nm.min(1e9))]
        });
        [
            4.0 * k[0],
            2.0 * k[1],
            k[2],
            libm::log(self.mass_kg[0].max(1e-3)),
            3.0 * libm::log(self.multiples[RAYS / 2].clamp(1e-9, 1e9)),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sizing::bearing::{BearingLimits, BearingLoad};
    use crate::sizing::fit::DriveWidths;
    use crate::sizing::heat::MotorHeat;
    use crate::sizing::requirement::MotionRequirement;
    use proptest::prelude::*;

    /// A drive whose limits are multiples of a usual demand: 100 N m and 10 kg m² at the joint, and a moment of 100 N m
    /// on its bearing.
    fn drive(of: [u32; 6], motion: &JointMotion, rays: &Rays) -> DriveBox {
        let usual = motion.demand(100.0, 10.0);
        let times = |k: usize| 0.2 * f64::from(of[k]);
        let limits = DriveLimits {
            static_torque_nm: times(0) * usual.static_torque_nm,
            peak_torque_nm: times(1) * usual.peak_torque_nm(),
            stop_torque_nm: times(2) * usual.stop_torque_nm,
            mean_torque_cubed_nm3: times(3).powi(3) * usual.mean_torque_cubed_nm3,
            bearing: BearingLimits { running_moment_nm: 100.0 * times(4), ..BearingLimits::NONE },
            widths: DriveWidths { gear_m: 0.02 * f64::from(of[5]), ..DriveWidths::default() },
            heat: MotorHeat::NONE,
        };
        DriveBox {
            mass_kg: [1.0; 2],
            limits,
            least_limits: limits,
            multiples: rays.capacity(&limits),
            curve: None,
            breaks: BreakPoints::default(),
            tilt_rad_per_nm: [0.0; 2],
            each: None,
        }
    }

    proptest! {
        /// A kind carries a demand exactly if one of its drives does. A box of kinds carries every demand that one of
        /// its drives carries.
        #[test]
        fn a_kind_holds_what_any_of_its_drives_holds(
            kinds in prop::collection::vec(prop::collection::vec(prop::array::uniform6(1u32..12), 1..5), 1..4),
            static_nm in 1.0f64..250.0, inertia_kgm2 in 0.1f64..25.0, moment_nm in 0.0f64..200.0,
            room_m in 0.05f64..0.3,
        ) {
            let motion = MotionRequirement::default().joint_motion(1.35, None);
            let rays = Rays::new(&motion, 50.0, 5.0);
            let running = BearingLoad { moment_nm, ..BearingLoad::default() };
            let bearing = BearingDemand { running, ..BearingDemand::default() };
            let asked = LeastDemand::new(&motion, &rays, static_nm, inertia_kgm2, bearing, LinkRoom { gear_m: room_m, ..LinkRoom::ANY });
            let mut with_ties = Vec::new();
            for kind in &kinds {
                let drives: Vec<DriveBox> = kind.iter().map(|of| drive(*of, &motion, &rays)).collect();
                let some_holds = drives.iter().any(|drive| drive.limits.hold(&asked.demand));
                let together = DriveBox::of_kind(drives.into_iter()).unwrap();
                prop_assert_eq!(together.hold(&asked.demand), some_holds);
                prop_assert_eq!(together.may_hold(&asked), some_holds);
                with_ties.push((together, some_holds));
            }
            let some_holds = with_ties.iter().any(|(_, holds)| *holds);
            let joined = with_ties.into_iter().map(|(kind, _)| kind).reduce(|a, b| a.join(&b)).unwrap();
            prop_assert!(joined.may_hold(&asked) || !some_holds);
        }
    }
}
