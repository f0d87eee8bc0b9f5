//! The numbers of one box of designs as intervals: the least and the greatest value over its members.
//!
//! A box is a set of designs. A piece is a joint with its drive, or a link.

use super::parts::{INERTIAS, LeastDemand, LinkBox, STIFFNESSES, inertia, stiffness_of};
use super::pose::{Row, TILT, TORSION};
use super::problem::Problem;
use super::shape::BoxWork as ShapeWork;
use super::torsion::{BreakPoints, CurveBox};
use crate::sizing::demand::JointDemand;
use crate::sizing::fit::LinkRoom;
use nalgebra::Vector3;

/// Working memory with the intervals of one box. A worker uses it for box after box, so that no memory is allocated for
/// each.
#[derive(Default)]
pub(super) struct BoxWork {
    /// Greatest stiffnesses of each piece over the box, as in [`Line::stiffnesses`](super::parts::Line).
    pub(super) stiff: Vec<[f64; STIFFNESSES]>,
    /// Least stiffnesses of each piece over the box, in the same order as in `stiff`.
    pub(super) soft: Vec<[f64; STIFFNESSES]>,
    /// Least line inertias (inertias per metre of a tube) of each piece over the box, as in
    /// [`Line::inertias`](super::parts::Line). For a joint the first place is its mass \[kg\].
    pub(super) light: Vec<[f64; INERTIAS]>,
    /// Greatest line inertias of each piece over the box.
    pub(super) heavy: Vec<[f64; INERTIAS]>,
    /// Weight of each piece as an interval \[N\], less buoyancy: first index the case, second the piece.
    pub(super) weights: Vec<Vec<[f64; 2]>>,
    /// Generalized force on each strain coordinate as an interval \[N or N m\]: first index the case, second the row of
    /// [`Pose::rows`](super::pose::Pose).
    pub(super) forces: Vec<Vec<[f64; 2]>>,
    /// Torsion curves of each joint, one place for each piece. `None` for a rigid joint and for a piece that is not a
    /// joint.
    pub(super) curves: Vec<Option<CurveBox>>,
    /// Greatest stiffnesses of each piece: first index the case, second the piece. They differ between cases, because
    /// the slope of a gear's curve depends on its torque.
    pub(super) stiff_in: Vec<Vec<[f64; STIFFNESSES]>>,
    /// Mass of each piece, as an interval \[kg\].
    pub(super) masses: Vec<[f64; 2]>,
    /// The least demand on each joint whose drive the search chooses; one entry for each piece, `None` for any other
    /// piece.
    pub(super) least_demands: Vec<Option<LeastDemand>>,
    /// The greatest demand on each joint whose drive the search chooses; one entry for each piece, `None` for any other
    /// piece.
    pub(super) greatest_demands: Vec<Option<JointDemand>>,
    /// Tilt of each joint's output bearing per moment, as an interval \[rad/(N m)\]; 0 for a bearing that does not
    /// tilt.
    pub(super) tilts: Vec<[f64; 2]>,
    /// Lever of each link as an interval \[m\]: the distance along the axis of the joint directly inboard from the face
    /// of the joint's flange to the point where the link attaches.
    pub(super) levers: Vec<[f64; 2]>,
    /// Least and greatest space that each link leaves for the gear and motor of the joint inboard.
    pub(super) rooms: Vec<[LinkRoom; 2]>,
    /// Break points of the torsion curves that each joint may have.
    pub(super) breaks: Vec<BreakPoints>,
    /// Least and greatest magnitude of the torque on each joint in each judged case \[N m\]: first index the case,
    /// second the piece. A judged case counts for deflection and lowest mode.
    pub(super) torques: Vec<Vec<[f64; 2]>>,
    /// The judged case in which the least tip deflection of the box is greatest, and the direction in which the tip
    /// moves in this case (a unit vector). `None` if the tip need not move in any judged case.
    pub(super) worst_tip: Option<(usize, Vector3<f64>)>,
    /// For each judged case, the direction of the tip's displacement when it is least over the box.
    pub(super) tip_directions: Vec<Vector3<f64>>,
    /// Upper bound of the tip's deflection \[m\], one entry for each judged case in which contributions to the tip's
    /// displacement may oppose each other.
    pub(super) greatest_tip_m: Vec<f64>,
    /// For each piece, the fraction by which the least tip deflection of the box would grow if the piece had middle
    /// stiffnesses instead of its greatest ones. A middle stiffness is the geometric mean of the least and the greatest
    /// stiffness.
    pub(super) tip_growth: Vec<f64>,
    /// Buffers of the inverse iteration that improves trial shapes.
    pub(super) shape: ShapeWork,
    /// The trial shape (motion that bounds the lowest mode) with the least Rayleigh quotient, given by the index of its
    /// judged case and the index of its starting acceleration ([`START_SHAPES`](super::bound::START_SHAPES)).
    pub(super) worst: (usize, usize),
}

impl BoxWork {
    /// Prepares the memory for a box of a problem with this many pieces and cases. Numbers of an earlier box become
    /// zero.
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

    /// Writes the mass, weight, torsion curve and bearing stiffness of a joint into this memory. All are intervals over
    /// the drives of the box.
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

    /// Writes the stiffnesses, inertias, mass and weight of a tube into this memory. `links` has the intervals over the
    /// options of the box.
    pub(super) fn tube(&mut self, problem: &Problem, piece: usize, length_m: f64, links: &LinkBox) {
        // An infinite stiffness becomes 0, which stands for a rigid coordinate. Infinity times zero strain would be
        // NaN.
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

    /// The torsion curves of the joint to which a row belongs; `None` if the row is not the torsion of a joint or the
    /// joint is rigid.
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
