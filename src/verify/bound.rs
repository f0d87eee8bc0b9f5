//! Bounds of the members of a box: least mass, least deflection, and the stiffest and lightest arm.

use super::demand::Demand;
use super::drive_range::DriveRange;
use super::duty::Duty;
use super::layout::Coordinate;
use super::pencil::Pencil;
use super::pose::Pose;
use super::skeleton::Skeleton;
use super::span::Span;
use super::tubes::{DENSITIES, STIFFNESSES, TubeRange};
use nalgebra::Vector3;

/// Room for rounding where a limit decides (relative).
pub(super) const ROUNDING: f64 = 1e-9;

/// The parts of a box as ranges.
pub(super) struct Members<'w> {
    /// Drives that may hold, joint by joint.
    pub drives: Vec<DriveRange>,
    pub tubes: Vec<&'w TubeRange>,
    /// Masses of drives, then weights of tubes per length, in each of the study's surroundings.
    pub loads: Vec<Vec<Span>>,
}

/// A mass and a deflection that no member betters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct IdealPoint {
    pub mass_kg: f64,
    pub tip_m: f64,
    /// The judged case that bounds the deflection, and the direction in which it does.
    pub worst: usize,
    pub direction: Vector3<f64>,
}

/// What a joint is asked for at least or at most.
#[derive(Default)]
struct Asked {
    static_nm: Span,
    inertia_kgm2: Span,
}

impl<'w> Members<'w> {
    /// Tubes, and drives of which nothing is known yet: their masses are zero.
    pub(super) fn new(drives: Vec<DriveRange>, tubes: Vec<&'w TubeRange>, waters: usize) -> Self {
        let loads = |water: usize| {
            let drives = drives.iter().map(|_| Span::default());
            drives.chain(tubes.iter().map(|tube| weight(tube, water))).collect()
        };
        Self { loads: (0..waters).map(loads).collect(), drives, tubes }
    }

    /// Sets the range of drives of a joint.
    pub(super) fn set_drive(&mut self, joint: usize, range: DriveRange) {
        self.drives[joint] = range;
        let mass = Span { least: range.least_kg, most: range.most_kg };
        self.loads.iter_mut().for_each(|loads| loads[joint] = mass);
    }
}

impl Skeleton {
    /// What a joint is asked for at least and at most, with room for rounding.
    pub(super) fn demands(&self, joint: usize, duty: &Duty, members: &Members) -> [Demand; 2] {
        let asked = self.asked(joint, members);
        let (statics, inertia) = (asked.static_nm, asked.inertia_kgm2);
        let (less, more) = (1.0 - ROUNDING, 1.0 + ROUNDING);
        [
            duty.demand(statics.least * less, inertia.least * less, less),
            duty.demand(statics.most * more, inertia.most * more, more),
        ]
    }

    /// The worst static torque and inertia on a joint over the cases it is sized in; everything outboard of it
    /// is known.
    fn asked(&self, joint: usize, members: &Members) -> Asked {
        let mut asked = Asked::default();
        for pose in self.poses.iter().filter(|pose| pose.sizing) {
            let torque = pose.torques[joint].over(&members.loads[pose.water]);
            let inertia = self.inertia_about(pose, joint, members);
            for (worst, least, most) in [
                (&mut asked.static_nm, torque.least_size(), torque.largest_size()),
                (&mut asked.inertia_kgm2, inertia.least, inertia.most),
            ] {
                *worst = Span { least: worst.least.max(least), most: worst.most.max(most) };
            }
        }
        asked
    }

    /// Inertia of all that is outboard about a joint's axis: the entry of the twist of that joint.
    fn inertia_about(&self, pose: &Pose, joint: usize, members: &Members) -> Span {
        let entry = joint * (joint + 3) / 2;
        let of_drives = members.loads[pose.water][..members.drives.len()].iter().copied();
        let of_tubes = members.tubes.iter().flat_map(|tube| {
            let (least, most) = (&tube.least.around[pose.water], &tube.most.around[pose.water]);
            (0..DENSITIES).map(|i| Span { least: least.densities[i], most: most.densities[i] })
        });
        let fixed = Span { least: pose.inertia[entry], most: pose.inertia[entry] };
        of_drives
            .chain(of_tubes)
            .zip(&pose.inertia_per)
            .fold(fixed, |sum, (number, per)| sum.plus(number.times(per[entry])))
    }

    /// Whether the least stress at both ends of every tube leaves the safety that is asked for.
    pub(super) fn strong_enough(&self, members: &Members) -> bool {
        let Some(safety) = self.limits.stress_safety_factor_min else { return true };
        self.poses.iter().all(|pose| {
            let loads = &members.loads[pose.water];
            members.tubes.iter().zip(&pose.ends).all(|(tube, ends)| {
                let ratio = |end: &[super::span::Linear; 6]| {
                    let size = |i: usize| end[i].over(loads).least_size();
                    let [axial, about_y, about_z, torsion] = tube.least.stresses;
                    let (y, z) = (size(4) * about_y, size(5) * about_z);
                    let bending = if tube.most.round > 0.0 { y.hypot(z) } else { y + z };
                    let (normal, shear) = (size(0) * axial + bending, size(3) * torsion);
                    (normal * normal + 3.0 * shear * shear).sqrt() * pose.stress_factor
                };
                ends.iter().all(|end| ratio(end) * safety <= 1.0 + ROUNDING)
            })
        })
    }

    /// Mass and deflection that no member betters; `None` if they break a limit.
    pub(super) fn ideal_point(&self, members: &Members) -> Option<IdealPoint> {
        let drives: f64 = members.drives.iter().map(|drive| drive.least_kg).sum();
        let tubes: f64 = members.tubes.iter().map(|tube| tube.least.mass_kg).sum();
        let mut ideal = IdealPoint {
            mass_kg: self.offsets_kg + drives + tubes,
            tip_m: 0.0,
            worst: 0,
            direction: Vector3::zeros(),
        };
        for (place, pose) in self.poses.iter().enumerate().filter(|(_, pose)| pose.judged) {
            let Some(direction) = direction(pose, members) else { continue };
            let tip_m = tip_along(pose, members, &direction);
            if tip_m > ideal.tip_m {
                (ideal.tip_m, ideal.worst, ideal.direction) = (tip_m, place, direction);
            }
        }
        let within = |value: f64, most: Option<f64>| most.is_none_or(|most| value <= most * (1.0 + ROUNDING));
        let limits = &self.limits;
        (within(ideal.mass_kg, limits.mass_max_kg) && within(ideal.tip_m, limits.tip_deflection_max_m))
            .then_some(ideal)
    }

    /// The largest stiffness of each coordinate in a pose.
    pub(super) fn stiffnesses(&self, pose: &Pose, members: &Members) -> Vec<f64> {
        let loads = &members.loads[pose.water];
        let stiffness = |coordinate: &Coordinate| match *coordinate {
            Coordinate::Joint(joint) => {
                members.drives[joint].largest_slope(pose.torques[joint].over(loads).largest_size())
            }
            Coordinate::Tube(tube, shape) => {
                let (which, integral_m) = shape.stiffness(self.lengths_m[tube]);
                members.tubes[tube].most.stiffnesses[which] * integral_m
            }
            Coordinate::Spring(spring) => self.spring_stiffnesses[spring],
        };
        self.coordinates.iter().map(stiffness).collect()
    }

    /// The stiffest and lightest arm of a box in a pose.
    pub(super) fn pencil(&self, pose: &Pose, members: &Members) -> Pencil {
        let mut inertia = pose.inertia.clone();
        let masses = members.drives.iter().map(|drive| drive.least_kg);
        let tubes = members.tubes.iter().flat_map(|tube| tube.least.around[pose.water].densities);
        for (number, per) in masses.chain(tubes).zip(&pose.inertia_per) {
            inertia.iter_mut().zip(per).for_each(|(entry, per)| *entry += number * per);
        }
        Pencil::new(self.stiffnesses(pose, members), inertia)
    }
}

fn weight(tube: &TubeRange, water: usize) -> Span {
    Span { least: tube.least.around[water].weight_n_per_m, most: tube.most.around[water].weight_n_per_m }
}

/// Compliances of a set of tubes.
pub(super) fn compliances(tube: &TubeRange) -> [Span; STIFFNESSES] {
    std::array::from_fn(|i| Span {
        least: 1.0 / tube.most.stiffnesses[i],
        most: 1.0 / tube.least.stiffnesses[i],
    })
}

/// About the direction in which the tip of a box's stiffest arm moves; `None` if it does not. Any direction gives a bound.
pub(super) fn direction(pose: &Pose, members: &Members) -> Option<Vector3<f64>> {
    let loads = &members.loads[pose.water];
    let joints = members.drives.iter().zip(&pose.torques).zip(&pose.tip_m_per_rad).map(
        |((drive, torque), tip_m_per_rad)| {
            let torque_nm = torque.over(loads).middle();
            tip_m_per_rad * drive.least_angle_rad(Span { least: torque_nm, most: torque_nm })
        },
    );
    let tubes = members.tubes.iter().zip(&pose.works).flat_map(|(tube, works)| {
        works.iter().zip(compliances(tube)).map(|(work, compliance)| work.middle(loads) * compliance.least)
    });
    let tilts = pose.by_springs_m.iter().map(|by_spring_m| by_spring_m.middle(loads));
    joints.chain(tubes).chain(tilts).sum::<Vector3<f64>>().try_normalize(0.0)
}

/// The least that the tip moves in a direction.
fn tip_along(pose: &Pose, members: &Members, direction: &Vector3<f64>) -> f64 {
    let loads = &members.loads[pose.water];
    let joints = members.drives.iter().zip(&pose.torques).zip(&pose.tip_m_per_rad).map(
        |((drive, torque), tip_m_per_rad)| {
            let tip_m_per_rad = tip_m_per_rad.dot(direction);
            // a twist that moves the tip back counts with its sign turned
            let torque = torque.over(loads).times(1.0f64.copysign(tip_m_per_rad));
            if tip_m_per_rad == 0.0 { 0.0 } else { drive.least_angle_rad(torque) * tip_m_per_rad.abs() }
        },
    );
    let tubes = members.tubes.iter().zip(&pose.works).flat_map(|(tube, works)| {
        works
            .iter()
            .zip(compliances(tube))
            .map(|(work, compliance)| work.along(direction, loads).least_product(compliance))
    });
    let tilts = pose.by_springs_m.iter().map(|by_spring_m| by_spring_m.along(direction, loads).least);
    joints.chain(tubes).chain(tilts).sum()
}
