//! The numbers of one box, as intervals.

use super::parts::{INERTIAS, LeastDemand, LinkBox, STIFFNESSES, inertia, stiffness_of};
use super::pose::{Row, TILT, TORSION};
use super::problem::Problem;
use super::shape::Work as ShapeWork;
use super::torsion::{BreakPoints, CurveBox};
use crate::sizing::demand::JointDemand;
use crate::sizing::fit::LinkRoom;
use nalgebra::Vector3;

/// Working memory for the bound of one box. A worker uses it for box after box, so that no memory is allocated for each.
#[derive(Default)]
pub(super) struct Work {
    /// Greatest stiffnesses of each piece.
    pub(super) stiff: Vec<[f64; STIFFNESSES]>,
    /// Least stiffnesses of each piece.
    pub(super) soft: Vec<[f64; STIFFNESSES]>,
    /// Least line inertias of each piece; the mass \[kg\] of a joint in the first place.
    pub(super) light: Vec<[f64; INERTIAS]>,
    /// Greatest line inertias of each piece.
    pub(super) heavy: Vec<[f64; INERTIAS]>,
    /// Weight of each piece in each case, as an interval \[N\].
    pub(super) weights: Vec<Vec<[f64; 2]>>,
    /// The force of each row of each case, as an interval.
    pub(super) forces: Vec<Vec<[f64; 2]>>,
    /// Torsion curves of each joint; `None` for a rigid joint or another piece.
    pub(super) curves: Vec<Option<CurveBox>>,
    /// Greatest stiffnesses of each piece in each case. A gear's slope depends on its torque, so it differs from case
    /// to case.
    pub(super) stiff_in: Vec<Vec<[f64; STIFFNESSES]>>,
    /// Mass of each piece, as an interval \[kg\].
    pub(super) masses: Vec<[f64; 2]>,
    /// The least demand on each joint whose drive is a level.
    pub(super) least_demands: Vec<Option<LeastDemand>>,
    /// The greatest demand on each joint whose drive is a level.
    pub(super) greatest_demands: Vec<Option<JointDemand>>,
    /// Tilt of each joint's bearing per moment, as an interval \[rad/(N m)\]; 0 for a joint that does not tilt.
    pub(super) tilts: Vec<[f64; 2]>,
    /// Lever along the axis of the joint inboard to where each link attaches, as an interval \[m\].
    pub(super) levers: Vec<[f64; 2]>,
    /// Least and greatest room that each link leaves to the parts of the joint that carries it.
    pub(super) rooms: Vec<[LinkRoom; 2]>,
    /// Break points of the curves of each joint.
    pub(super) breaks: Vec<BreakPoints>,
    /// Least and greatest magnitude of the torque on each joint, in each judged case \[N m\].
    pub(super) torques: Vec<Vec<[f64; 2]>>,
    /// The judged case in which the tip's least deflection is greatest, and the direction of the tip's displacement
    /// there.
    pub(super) worst_tip: Option<(usize, Vector3<f64>)>,
    /// Direction of the tip's least deflection in each judged case.
    pub(super) tip_directions: Vec<Vector3<f64>>,
    /// Upper bound of the tip's deflection in each judged case in which contributions may oppose each other
    /// \[m\].
    pub(super) greatest_tip_m: Vec<f64>,
    /// For each piece, the relative growth of the deflection if the piece's stiffnesses had middle values instead of
    /// their greatest.
    pub(super) tip_growth: Vec<f64>,
    pub(super) shape: ShapeWork,
    /// Judged case, and number of the start, of the shape with the least quotient.
    pub(super) worst: (usize, usize),
}

impl Work {
    /// Empties all numbers for a problem of this size.
    pub(super) fn clear(&mut self, pieces: usize, cases: usize) {
        fn zero<T: Clone>(items: &mut Vec<T>, n: usize, value: T) {
            items.clear();
            items.resize(n, value);
        }
        zero(&mut self.stiff, pieces, [0.0; STIFFNESSES]);
        zero(&mut self.soft, pieces, [0.0; STIFFNESSES]);
        zero(&mut self.light, pieces, [0.0; INERTIAS]);
        zero(&mut self.heavy, pieces, [0.0; INERTIAS]);
        zero(&mut self.curves, pieces, None);
        zero(&mut self.masses, pieces, [0.0; 2]);
        zero(&mut self.tilts, pieces, [0.0; 2]);
        zero(&mut self.levers, pieces, [0.0; 2]);
        zero(&mut self.rooms, pieces, [LinkRoom::ANY; 2]);
        zero(&mut self.greatest_demands, pieces, None);
        self.least_demands.clear();
        self.least_demands.resize_with(pieces, || None);
        zero(&mut self.breaks, pieces, BreakPoints::default());
        self.weights.resize_with(cases, Vec::new);
        self.stiff_in.resize_with(cases, Vec::new);
        self.torques.resize_with(cases, Vec::new);
        self.forces.resize_with(cases, Vec::new);
        for case in 0..cases {
            zero(&mut self.weights[case], pieces, [0.0; 2]);
            zero(&mut self.torques[case], pieces, [0.0; 2]);
        }
    }

    /// Fills in the numbers of a joint.
    pub(super) fn joint(
        &mut self,
        problem: &Problem,
        piece: usize,
        mass_kg: [f64; 2],
        curve: Option<CurveBox>,
        tilt_rad_per_nm: [f64; 2],
    ) {
        self.masses[piece] = mass_kg;
        self.curves[piece] = curve;
        self.tilts[piece] = tilt_rad_per_nm;
        self.stiff[piece][TILT] = stiffness_of(tilt_rad_per_nm[0]);
        self.soft[piece][TILT] = stiffness_of(tilt_rad_per_nm[1]);
        self.light[piece][inertia::MASS] = mass_kg[0];
        self.heavy[piece][inertia::MASS] = mass_kg[1];
        let g = problem.space.gravity_m_s2;
        for weights in &mut self.weights {
            weights[piece] = mass_kg.map(|m| m * g);
        }
    }

    /// Fills in the numbers of a tube.
    pub(super) fn tube(&mut self, problem: &Problem, piece: usize, length_m: f64, links: &LinkBox) {
        // Infinite stiffness becomes 0, which stands for a coordinate that does not yield; infinity times
        // zero strain would be NaN.
        let finite = |s: f64| if s.is_finite() { s } else { 0.0 };
        self.levers[piece] = links.lever_m;
        self.rooms[piece] = links.room;
        self.stiff[piece] = links.high.stiffnesses.map(finite);
        self.soft[piece] = links.low.stiffnesses.map(finite);
        self.light[piece] = links.low.inertias;
        self.heavy[piece] = links.high.inertias;
        let (light, heavy) = (&links.low.inertias, &links.high.inertias);
        self.masses[piece] = [light[inertia::MASS] * length_m, heavy[inertia::MASS] * length_m];
        let g = problem.space.gravity_m_s2 * length_m;
        for (weights, pose) in self.weights.iter_mut().zip(problem.poses.iter()) {
            weights[piece] = [
                // The least net weight has the least mass and the greatest buoyancy.
                g * (light[inertia::MASS] - pose.water_kg_m3 * heavy[inertia::OUTER_AREA]),
                g * (heavy[inertia::MASS] - pose.water_kg_m3 * light[inertia::OUTER_AREA]),
            ];
        }
    }

    /// The torsion curves of the joint to which a row belongs; `None` if the row is that of a linear spring.
    #[inline]
    pub(super) fn curve(&self, row: &Row) -> Option<&CurveBox> {
        self.curves[row.piece].as_ref().filter(|_| row.coordinate == TORSION)
    }

    /// Whether every inertia, stiffness and torsion curve of the box has a single value, so that all its members have
    /// the same modes.
    pub(super) fn is_point(&self) -> bool {
        self.light == self.heavy
            && self.stiff == self.soft
            && self.curves.iter().flatten().all(|c| c.stiff == c.soft)
    }
}
