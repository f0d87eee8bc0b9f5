//! The deflection of one measured point under gravity: what the arm file's own compliances give, and what each candidate
//! would add per unit of its compliance.

use super::shape::{Shape, beyond_nm};
use crate::mechanics::tip::UnitRotation;
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// Row and column of each entry of the compliance matrix of a frame (a rotational spring about all three axes), in
/// the order in which the entries are fitted.
pub(crate) const FRAME_ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (0, 1), (0, 2), (1, 2), (2, 2)];

/// How one measured point deflects under gravity in its pose, in the level frame.
#[derive(Debug, Clone)]
pub(crate) struct Deflection {
    /// Displacement of the point by the compliances that the arm file already has \[m\].
    pub known_m: Vector3<f64>,
    /// Derivatives of the known displacement with respect to the two horizontal components of the unit vector of
    /// gravity \[m\].
    pub known_slopes_m: [Vector3<f64>; 2],
    /// The rotations of all candidates in the level frame, in the order of the candidates.
    pub(super) rotations: Arc<[UnitRotation]>,
    pub(super) slots: Arc<[Slot]>,
    /// For each driven joint, sine and cosine of its angle and of twice its angle; empty if no candidate needs them.
    pub(super) waves: Arc<[[f64; 4]]>,
}

/// Where a candidate is among the rotations of all candidates: index of its first rotation, the number of its
/// rotations, and the number of its compliances. A candidate that is no spring uses the rotations of the spring at the
/// same place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slot {
    pub(super) first: usize,
    pub(super) rotations: usize,
    pub(super) compliances: usize,
    pub(super) shape: Shape,
    /// Index of the driven joint at the candidate's place, on whose angle the compliance may depend; 0 if there is
    /// none.
    pub(super) driven: usize,
}

impl Deflection {
    /// A deflection with the known displacement `known_m` and without candidates.
    pub(crate) fn known(known_m: Vector3<f64>) -> Self {
        let (known_slopes_m, rotations, slots, waves) = Default::default();
        Self { known_m, known_slopes_m, rotations, slots, waves }
    }

    /// Number of compliances of a candidate.
    pub(crate) fn count(&self, candidate: usize) -> usize {
        self.slots[candidate].compliances
    }

    /// The candidates of this deflection, with the threshold (torque scale of play, or preload) of the candidate
    /// `candidate` set to `nm` \[N m\].
    pub(super) fn slots_with_threshold(&self, candidate: usize, nm: f64) -> Arc<[Slot]> {
        let mut slots = self.slots.to_vec();
        slots[candidate].shape = slots[candidate].shape.with_threshold(nm);
        slots.into()
    }

    /// This deflection with the candidates `slots`, which differ in their thresholds only.
    pub(super) fn with_slots(&self, slots: &Arc<[Slot]>) -> Self {
        Self { slots: Arc::clone(slots), ..self.clone() }
    }

    /// The largest magnitude of the torques about the axes of a candidate, under gravity along -z \[N m\].
    pub(crate) fn torque_nm(&self, candidate: usize) -> f64 {
        self.rotations(candidate).iter().map(|rotation| rotation.pull_nm.z.abs()).fold(0.0, f64::max)
    }

    fn rotations(&self, candidate: usize) -> &[UnitRotation] {
        let slot = &self.slots[candidate];
        &self.rotations[slot.first..slot.first + slot.rotations]
    }

    /// Calls `each` once for each compliance of a candidate, with the displacement of the point per unit of this
    /// compliance, under gravity along `gravity` \[m per rad/(N m)\]. For play the unit is the half width \[m/rad\].
    pub(crate) fn per_compliance(
        &self,
        candidate: usize,
        gravity: &Vector3<f64>,
        mut each: impl FnMut(Vector3<f64>),
    ) {
        let own = self.rotations(candidate);
        let mut torques_nm = [0.0; 3];
        torques_nm.iter_mut().zip(own).for_each(|(nm, rotation)| *nm = rotation.pull_nm.dot(gravity));
        let along = |i: usize, j: usize| own[i].motion_m * torques_nm[j];
        let slot = &self.slots[candidate];
        match (slot.shape, slot.compliances) {
            (Shape::Play(scale_nm), _) => each(own[0].motion_m * libm::tanh(torques_nm[0] / scale_nm)),
            (Shape::Lift(preload_nm), _) => {
                let tilt = |i: usize| own[i].motion_m * beyond_nm(torques_nm[i], preload_nm);
                each((0..own.len()).map(tilt).sum());
            }
            (Shape::Waves(waves), _) => {
                let angle = &self.waves[slot.driven][waves.range()];
                angle.iter().for_each(|wave| each(along(0, 0) * *wave));
            }
            (Shape::Spring, 1) => each((0..own.len()).fold(Vector3::zeros(), |sum, i| sum + along(i, i))),
            (Shape::Spring, count) => FRAME_ENTRIES[..count].iter().for_each(|&(i, j)| {
                each(if i == j { along(i, i) } else { along(i, j) + along(j, i) });
            }),
        }
    }

    /// Displacement of the point under gravity along `gravity` if the candidate has the compliances `compliances`
    /// \[rad/(N m)\], in the level frame \[m\]. For play the entry is the half width \[rad\].
    pub(crate) fn displaced_m(
        &self,
        candidate: usize,
        compliances: &[f64],
        gravity: &Vector3<f64>,
    ) -> Vector3<f64> {
        if let [xx, yy, xy, xz, yz, zz @ ..] = compliances {
            // a frame: one product with its matrix is faster than a sum over its compliances
            let own = self.rotations(candidate);
            let torques_nm = Vector3::from_fn(|i, _| own[i].pull_nm.dot(gravity));
            let zz = zz.first().copied().unwrap_or_default();
            let turns_rad = Matrix3::new(*xx, *xy, *xz, *xy, *yy, *yz, *xz, *yz, zz) * torques_nm;
            return own.iter().zip(turns_rad.iter()).map(|(rotation, rad)| rotation.motion_m * *rad).sum();
        }
        let mut out = Vector3::zeros();
        let mut compliances = compliances.iter();
        self.per_compliance(candidate, gravity, |by| {
            out += by * compliances.next().copied().unwrap_or_default();
        });
        out
    }

    /// Derivative of [`displaced_m`](Self::displaced_m) as the direction `gravity` of gravity changes by `by`, in the level
    /// frame \[m\].
    pub(crate) fn leaning_m(
        &self,
        candidate: usize,
        compliances: &[f64],
        gravity: &Vector3<f64>,
        by: &Vector3<f64>,
    ) -> Vector3<f64> {
        let shape = self.slots[candidate].shape;
        if shape.is_proportional() {
            return self.displaced_m(candidate, compliances, by);
        }
        let per_size = |own: &UnitRotation| {
            own.motion_m * (shape.slope_per_nm(own.pull_nm.dot(gravity)) * own.pull_nm.dot(by))
        };
        let per_size: Vector3<f64> = self.rotations(candidate).iter().map(per_size).sum();
        per_size * compliances[0]
    }

    /// Displacement of the point per angle of rotation about the first axis of a candidate \[m/rad\], and the torque
    /// about this axis under gravity along -z \[N m\]. For a joint's axis, an error of the joint angle moves the
    /// point in the same direction.
    pub(crate) fn lever(&self, candidate: usize) -> (Vector3<f64>, f64) {
        self.rotations(candidate).first().map_or_else(Default::default, |s| (s.motion_m, -s.pull_nm.z))
    }
}
