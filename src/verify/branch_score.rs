//! The choice of the level at which a box is divided.
//!
//! A box is a set of designs. Its ideal point has a mass, a deflection and a mode, each at least as good as in any
//! design of the box. A level is the choice of one drive or one tube.

use super::bound::{IdealPoint, Members, compliances};
use super::boxes::Boxes;
use super::drive_range::{DriveRange, angle_rad};
use super::layout::Coordinate;
use super::modes::Slow;
use super::parts_box::{PartsBox, Place};
use super::pencil::square;
use super::tubes::{DENSITIES, TubeRange};
use crate::arm::joint_law::Windup;

/// Scores the levels of a box by how much worse the ideal point becomes if a level has an average part instead of the
/// best part. The level with the largest score is halved. Any rule of choice gives a valid proof; this rule makes boxes
/// shrink fast.
pub(super) struct BranchScore<'a> {
    pub boxes: &'a Boxes,
    pub members: &'a Members<'a>,
    pub ideal: &'a IdealPoint,
    pub slow: &'a Slow<'a>,
    pub parts: &'a PartsBox,
}

impl BranchScore<'_> {
    /// How much worse the ideal point becomes if the level has an average part: a sum of relative changes of mass,
    /// deflection and squared frequency, without a unit.
    pub(super) fn score_of(&self, level: usize) -> f64 {
        let node = self.parts.0[level];
        let [mass_kg, tip_m, eigenvalue] = match self.boxes.skeleton.levels[level] {
            Place::Joint(joint) => self.of_joint(joint, node),
            Place::Tube(tube) => self.of_tube(tube),
        };
        let part = |score_of: f64, of: f64| {
            if of > 0.0 && score_of.is_finite() { (score_of / of).max(0.0) } else { 0.0 }
        };
        let slower = part(eigenvalue, self.slow.eigenvalue);
        part(mass_kg, self.ideal.mass_kg)
            + libm::log1p(part(tip_m, self.ideal.tip_m))
            + 0.5 * libm::log1p(slower)
    }

    /// By how much the ideal point becomes worse if `joint` has an average drive instead of the best drive. The three
    /// numbers are changes of the mass \[kg\], of the deflection \[m\] and of the squared angular frequency `λ` of the
    /// lowest mode \[1/s²\]. `node` is the node of the joint's tree in the box.
    fn of_joint(&self, joint: usize, node: u32) -> [f64; 3] {
        let (range, whole) = (&self.members.drives[joint], self.boxes.joints[joint].range(node));
        let mass_kg = 0.5 * (whole.most_kg.min(range.most_kg) - range.least_kg);
        let pose = &self.boxes.skeleton.poses[self.ideal.worst];
        let torque_nm = pose.torques[joint].over(&self.members.loads[pose.water]).least_size();
        let softer = 0.5 * (angle_rad(&range.soft, torque_nm) - angle_rad(&range.stiff, torque_nm));
        let tip_m = softer * pose.tip_m_per_rad[joint].dot(&self.ideal.direction).abs();
        let slope = |curve: &Windup| curve.tangent_nm_per_rad(torque_nm);
        let weaker = 0.5 * (slope(&range.stiff) - slope(&range.soft));
        let looser_rad_per_nm = 0.5 * (range.tilt_rad_per_nm.most - range.tilt_rad_per_nm.least);
        let by_tilt = pose.by_tilts[joint].along(&self.ideal.direction, &self.members.loads[pose.water]);
        let tip_m = tip_m + looser_rad_per_nm * by_tilt.middle().max(0.0);
        let x = &self.slow.mode;
        let inertia = mass_kg * square(&self.slow.pose.inertia_per[joint], x);
        let eigenvalue =
            weaker * x[joint] * x[joint] + self.slower_by_tilt(joint, range) + self.slow.eigenvalue * inertia;
        [mass_kg, tip_m + self.deflection_per(joint) * mass_kg, eigenvalue]
    }

    /// By how much twice the strain energy of the lowest mode falls if `joint` has an average bearing and not the
    /// stiffest one \[N m\]. `range` are the drives of the joint in the box.
    fn slower_by_tilt(&self, joint: usize, range: &DriveRange) -> f64 {
        let weaker = range.greatest_tilt_stiffness() - 1.0 / range.tilt_rad_per_nm.middle();
        let coordinates = self.boxes.skeleton.coordinates.iter().zip(&self.slow.mode);
        let tilts = coordinates.filter(|(c, _)| matches!(c, Coordinate::Tilt(j, _) if *j == joint));
        let strain: f64 = tilts.map(|(_, x)| weaker * x * x).sum();
        // A bearing that may be rigid does not tilt in the lowest mode of the ideal arm.
        if strain.is_finite() { strain } else { 0.0 }
    }

    /// By how much the ideal point becomes worse if the link has an average tube instead of the best tube. The three
    /// numbers are changes of the mass \[kg\], of the deflection \[m\] and of the squared angular frequency `λ` of the
    /// lowest mode \[1/s²\].
    fn of_tube(&self, tube: usize) -> [f64; 3] {
        let range: &TubeRange = self.members.tubes[tube];
        let pose = &self.boxes.skeleton.poses[self.ideal.worst];
        let loads = &self.members.loads[pose.water];
        let works = pose.works[tube].iter().zip(compliances(range)).zip(range.middle.stiffnesses);
        let softer: f64 = works
            .map(|((work, compliance), middle)| {
                let work = work.along(&self.ideal.direction, loads).middle().max(0.0);
                if compliance.least > 0.0 { work * (1.0 / middle - compliance.least) } else { 0.0 }
            })
            .sum();
        let load = self.boxes.joints.len() + tube;
        let heavier =
            range.middle.around[pose.water].weight_n_per_m - range.least.around[pose.water].weight_n_per_m;
        let tip_m = softer + self.deflection_per(load) * heavier;
        [range.middle.mass_kg - range.least.mass_kg, tip_m, self.slower_by_tube(tube, range)]
    }

    fn slower_by_tube(&self, tube: usize, range: &TubeRange) -> f64 {
        let (x, water) = (&self.slow.mode, self.slow.pose.water);
        let strain: f64 = self
            .boxes
            .skeleton
            .coordinates
            .iter()
            .zip(x)
            .filter_map(|(coordinate, x)| match *coordinate {
                Coordinate::Tube(t, shape) if t == tube => {
                    let (which, integral_m) = shape.stiffness(self.boxes.skeleton.lengths_m[tube]);
                    let weaker = range.most.stiffnesses[which] - range.middle.stiffnesses[which];
                    Some(weaker * integral_m * x * x)
                }
                _ => None,
            })
            .sum();
        let first = self.boxes.joints.len() + DENSITIES * tube;
        let more =
            |i: usize| range.middle.around[water].densities[i] - range.least.around[water].densities[i];
        let inertia: f64 =
            (0..DENSITIES).map(|i| more(i) * square(&self.slow.pose.inertia_per[first + i], x)).sum();
        strain + self.slow.eigenvalue * inertia
    }

    /// Deflection of the stiffest arm of the box per unit of the load with the index `load` (the mass of a drive
    /// \[kg\], or the weight per length of a tube \[N/m\]).
    fn deflection_per(&self, load: usize) -> f64 {
        let pose = &self.boxes.skeleton.poses[self.ideal.worst];
        let loads = &self.members.loads[pose.water];
        let direction = &self.ideal.direction;
        let joints = self.members.drives.iter().zip(&pose.torques).zip(&pose.tip_m_per_rad);
        let joints = joints.map(|((drive, torque), tip_m_per_rad)| {
            let slope = drive.stiff.tangent_nm_per_rad(torque.over(loads).least_size());
            torque.per_load[load] / slope * tip_m_per_rad.dot(direction)
        });
        let tubes = self.members.tubes.iter().zip(&pose.works).flat_map(|(tube, works)| {
            works.iter().zip(compliances(tube)).map(|(w, c)| w.per_load[load].dot(direction) * c.least)
        });
        let tilts = self.members.drives.iter().zip(&pose.by_tilts);
        let tilts = tilts.map(|(d, w)| w.per_load[load].dot(direction) * d.tilt_rad_per_nm.least);
        let springs = pose.by_springs_m.iter().map(|by_spring_m| by_spring_m.per_load[load].dot(direction));
        joints.chain(tubes).chain(tilts).chain(springs).sum()
    }
}
