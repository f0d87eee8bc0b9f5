//! Bounds for the members of a box: least mass, least deflection, and the ideal arm (every stiffness greatest,
//! every inertia least).
//!
//! A box is a set of designs, its members. A region is the set of designs below a mass, below a deflection and above a
//! frequency.

use super::bearing::BearingDemand;
use super::bearing_loads::Largest;
use super::demand::Demand;
use super::drive_range::DriveRange;
use super::duty::Duty;
use super::fit::{ANY_WIDTH, Widths};
use super::layout::Coordinate;
use super::pencil::Pencil;
use super::pose::Pose;
use super::skeleton::{Lever, Skeleton};
use super::span::Span;
use super::tubes::{DENSITIES, STIFFNESSES, TubeRange};
use nalgebra::Vector3;

/// Relative margin for rounding in comparisons with a limit.
pub(super) const ROUNDING: f64 = 1e-9;

/// The members of a box or region, given by the interval of each number of their parts.
pub(super) struct Members<'w> {
    /// For each joint, base first, the least and greatest numbers of the drives that may meet its demand.
    pub drives: Vec<DriveRange>,
    pub tubes: Vec<&'w TubeRange>,
    /// Intervals of the loads: the masses of the drives \[kg\], followed by the weights per length of the tubes
    /// \[N/m\]. There is one list for each medium around the arm (air, water) in the study.
    pub loads: Vec<Vec<Span>>,
}

/// A lower bound of the mass and a lower bound of the deflection over the members. Each is found by itself, so there
/// may be no single member that reaches both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct IdealPoint {
    pub mass_kg: f64,
    pub tip_m: f64,
    /// Index, among the poses, of the judged case that bounds the deflection, and the direction of the tip's
    /// displacement in this case. A judged case counts for deflection and lowest mode.
    pub worst: usize,
    pub direction: Vector3<f64>,
}

/// The loads on a joint over the members: intervals of the static torque \[N m\] and of the inertia outboard \[kg m²\].
#[derive(Default)]
struct Asked {
    static_nm: Span,
    inertia_kgm2: Span,
}

impl<'w> Members<'w> {
    /// Members with these tubes, and with drives whose masses are not known yet and count as zero.
    pub(super) fn new(drives: Vec<DriveRange>, tubes: Vec<&'w TubeRange>, waters: usize) -> Self {
        let loads = |water: usize| {
            let drives = drives.iter().map(|_| Span::default());
            drives.chain(tubes.iter().map(|tube| weight(tube, water))).collect()
        };
        Self { loads: (0..waters).map(loads).collect(), drives, tubes }
    }

    /// Sets the range of the drives of a joint, and with it their masses among the loads.
    pub(super) fn set_drive(&mut self, joint: usize, range: DriveRange) {
        self.drives[joint] = range;
        let mass = Span { least: range.least_kg, most: range.most_kg };
        self.loads.iter_mut().for_each(|loads| loads[joint] = mass);
    }

    /// Intervals of the masses of the drives, followed by the intervals of the inertias per length of the tubes.
    /// `water` is the index of the medium around the arm.
    fn inertias(&self, water: usize) -> impl Iterator<Item = Span> {
        let of_drives = self.loads[water][..self.drives.len()].iter().copied();
        let of_tubes = self.tubes.iter().flat_map(move |tube| {
            let (least, most) = (&tube.least.around[water], &tube.most.around[water]);
            (0..DENSITIES).map(|i| Span { least: least.densities[i], most: most.densities[i] })
        });
        of_drives.chain(of_tubes)
    }
}

impl Skeleton {
    /// Least and greatest demand on a joint's drive over the members, widened by a margin for rounding.
    pub(super) fn demands(&self, joint: usize, duty: &Duty, members: &Members) -> [Demand; 2] {
        let asked = self.asked(joint, members);
        let (statics, inertia) = (asked.static_nm, asked.inertia_kgm2);
        let (less, more) = (1.0 - ROUNDING, 1.0 + ROUNDING);
        let [least, most] = self.bearing_demands(joint, members);
        let [widest, narrowest] = self.rooms(joint, members);
        [
            Demand {
                bearing: least.times(less),
                room: widest,
                ..duty.demand(statics.least * less, inertia.least * less, less)
            },
            Demand {
                bearing: most.times(more),
                room: narrowest,
                ..duty.demand(statics.most * more, inertia.most * more, more)
            },
        ]
    }

    /// Lower and upper bound, over the members, of the largest loads on a joint's bearing in the sizing cases (in which
    /// drives and stresses are checked). The moments are taken at the face of the joint's flange, or at the centre of
    /// the bearing if the study states the lever. Zero if the bearing is not checked.
    fn bearing_demands(&self, joint: usize, members: &Members) -> [BearingDemand; 2] {
        let mut largest = Largest::default();
        for (pose, bearings) in self.poses.iter().zip(&self.bearings) {
            if let Some(Some(bearing)) = bearings.get(joint) {
                let inertias: Vec<Span> = members.inertias(pose.water).collect();
                bearing.load(&members.loads[pose.water], &inertias, &mut largest);
            }
        }
        let levers_m = match self.levers[joint] {
            Lever::Stated(lever_m) => [lever_m; 2],
            Lever::HalfOf(tube) => {
                [members.tubes[tube].least.half_width_m, members.tubes[tube].most.half_width_m]
            }
        };
        let [least, most] = largest.demands();
        [least.with_lever(levers_m[0]), most.with_lever(levers_m[1])]
    }

    /// The widest and the narrowest space that the members' tubes leave to the gear and motor of a joint \[m\].
    fn rooms(&self, joint: usize, members: &Members) -> [Widths; 2] {
        self.first_tubes[joint].map_or([ANY_WIDTH; 2], |tube| {
            let TubeRange { least, most, .. } = members.tubes[tube];
            [most.room, least.room]
        })
    }

    /// Intervals, over the members, of the largest static torque on a joint and of the largest inertia about it in the
    /// sizing cases. The drives outboard of the joint must be set in `members`.
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

    /// Interval, over the members, of the inertia of everything outboard about a joint's axis \[kg m²\]. It is the
    /// diagonal entry of the inertia matrix that belongs to the joint.
    fn inertia_about(&self, pose: &Pose, joint: usize, members: &Members) -> Span {
        let entry = joint * (joint + 3) / 2;
        let fixed = Span { least: pose.inertia[entry], most: pose.inertia[entry] };
        members
            .inertias(pose.water)
            .zip(&pose.inertia_per)
            .fold(fixed, |sum, (number, per)| sum.plus(number.times(per[entry])))
    }

    /// Whether some member may have the required safety factor at both ends of every tube. The least stress over
    /// the members is compared with the strength, so that `false` is a proof that no member is strong enough.
    pub(super) fn strong_enough(&self, members: &Members) -> bool {
        let Some(safety) = self.limits.stress_safety_factor_min else { return true };
        self.poses.iter().all(|pose| {
            let loads = &members.loads[pose.water];
            members.tubes.iter().zip(&pose.ends).all(|(tube, ends)| {
                let ratio = |end: &[super::span::Linear; 6]| {
                    let size = |i: usize| end[i].over(loads).least_size();
                    let [axial, about_y, about_z, torsion] = tube.least.stresses;
                    let (y, z) = (size(4) * about_y, size(5) * about_z);
                    let bending = if tube.most.round > 0.0 { libm::hypot(y, z) } else { y + z };
                    let (normal, shear) = (size(0) * axial + bending, size(3) * torsion);
                    (normal * normal + 3.0 * shear * shear).sqrt() * pose.stress_factor
                };
                ends.iter().all(|end| ratio(end) * safety <= 1.0 + ROUNDING)
            })
        })
    }

    /// Lower bounds of mass and deflection over the members; `None` if one of them is above its limit, so that no
    /// member meets the limits.
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

    /// The greatest stiffness of each coordinate over the members, in a pose. The order is the same as in
    /// `coordinates`.
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
            Coordinate::Tilt(joint, _) => members.drives[joint].greatest_tilt_stiffness(),
            // Shifts and travels are virtual motions by which loads are computed. No element deflects in this way.
            Coordinate::Shift(..) | Coordinate::Rail(_) => f64::INFINITY,
            Coordinate::Spring(spring) => self.spring_stiffnesses[spring],
        };
        self.coordinates.iter().map(stiffness).collect()
    }

    /// Stiffness and inertia matrices of the ideal arm in a pose: every stiffness at its greatest, every inertia at
    /// its least.
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

/// Interval of each compliance (1 / stiffness) over a set of tubes.
pub(super) fn compliances(tube: &TubeRange) -> [Span; STIFFNESSES] {
    std::array::from_fn(|i| Span {
        least: 1.0 / tube.most.stiffnesses[i],
        most: 1.0 / tube.least.stiffnesses[i],
    })
}

/// Approximate direction in which the tip of the stiffest arm of the members moves, as a unit vector; `None` if the tip
/// does not move. The displacement along any direction is a valid lower bound, so the direction need not be exact.
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
    let tilts = members.drives.iter().zip(&pose.by_tilts);
    let tilts = tilts.map(|(drive, by_tilt)| by_tilt.middle(loads) * drive.tilt_rad_per_nm.least);
    let springs = pose.by_springs_m.iter().map(|by_spring_m| by_spring_m.middle(loads));
    joints.chain(tubes).chain(tilts).chain(springs).sum::<Vector3<f64>>().try_normalize(0.0)
}

/// Lower bound of the displacement of the tip along a direction, over the members \[m\].
fn tip_along(pose: &Pose, members: &Members, direction: &Vector3<f64>) -> f64 {
    let loads = &members.loads[pose.water];
    let joints = members.drives.iter().zip(&pose.torques).zip(&pose.tip_m_per_rad).map(
        |((drive, torque), tip_m_per_rad)| {
            let tip_m_per_rad = tip_m_per_rad.dot(direction);
            // If the twist of a joint moves the tip backward along the direction, torque and lever change their signs.
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
    let tilts = members
        .drives
        .iter()
        .zip(&pose.by_tilts)
        .map(|(drive, by_tilt)| by_tilt.along(direction, loads).least_product(drive.tilt_rad_per_nm));
    let springs = pose.by_springs_m.iter().map(|by_spring_m| by_spring_m.along(direction, loads).least);
    joints.chain(tubes).chain(tilts).chain(springs).sum()
}
