//! Trial shapes, which give an upper bound of the lowest mode of every arm in a box.
//!
//! For any motion `x` of an arm, `λ₁ ≤ xᵀKx / xᵀMx` (Rayleigh). In strain coordinates (the ways in
//! which each piece deforms) `K` is diagonal, so `xᵀKx` is a
//! sum over the stiffnesses of the parts. The inertia of the arm does not depend on its stiffness, so `xᵀMx` is a sum
//! over the masses and line inertias, and no coefficient is negative. It is therefore enough to store two lists of
//! coefficients for each shape. With every stiffness at its greatest and every inertia at its least, the quotient
//! bounds the lowest mode of every member of the box, whatever the shape is.
//!
//! The bound is sharp if the shape is close to the lowest mode of the box's ideal arm. One step of inverse iteration
//! from the shape of the parent box is enough.

use super::parts::{INERTIAS, STIFFNESSES, inertia};
use super::pose::{
    COORDINATES, ENDS, JOINT_COORDINATES, Pose, PosedPiece, PosedTube, RESISTED, TILT, TORSION, degree_factor,
};
use crate::mechanics::{Twist, Wrench, angular, linear, stack};
use nalgebra::{DVector, SMatrix, SVector, Vector3};
use serde::{Deserialize, Serialize};

/// A motion of the arm, with the coefficients of its strain energy and kinetic energy for each piece. Pieces are
/// counted from the tip.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Shape {
    /// Strain coordinates: [`COORDINATES`] places for each piece, of which a joint uses the first three.
    x: Vec<f64>,
    /// Coefficients of `xᵀKx` (twice the strain energy): one for each stiffness of each piece.
    pub strain: Vec<[f64; STIFFNESSES]>,
    /// Coefficients of `xᵀMx` (twice the kinetic energy per squared angular frequency): one for each line inertia of
    /// each piece.
    pub kinetic: Vec<[f64; INERTIAS]>,
    /// Constant term of `xᵀMx`, from the payload and the bodies that the study gives.
    pub kinetic_fixed: f64,
}

/// The stiffnesses and inertias of an arm, piece by piece from the tip. For a box they are the greatest stiffnesses and
/// the least inertias: an ideal arm that need not be a member.
pub(super) struct Ideal<'a> {
    pub stiffness: &'a [[f64; STIFFNESSES]],
    pub inertia: &'a [[f64; INERTIAS]],
}

impl Shape {
    /// A shape of a low mode of an ideal arm, found by `steps` steps of inverse iteration. The first shape is the
    /// deformation under an acceleration of the base along `direction`. The shape is kept orthogonal to the shapes in
    /// `others`, so that it becomes a mode that differs from these.
    pub(super) fn start(
        pose: &Pose,
        ideal: &Ideal,
        direction: Vector3<f64>,
        others: &[Self],
        steps: usize,
    ) -> Self {
        let mut shape = Self {
            x: vec![0.0; pose.pieces.len() * COORDINATES],
            strain: vec![[0.0; STIFFNESSES]; pose.pieces.len()],
            kinetic: vec![[0.0; INERTIAS]; pose.pieces.len()],
            kinetic_fixed: 0.0,
        };
        let mut work = BoxWork::default();
        shape.iterate(pose, ideal, &stack(&direction, &Vector3::zeros()), &mut work);
        for _ in 1..steps {
            shape.clear_of(pose, ideal, others);
            shape.iterate(pose, ideal, &Twist::zeros(), &mut work);
        }
        shape.clear_of(pose, ideal, others);
        shape.energies(pose);
        shape
    }

    /// One step of inverse iteration of this shape, towards a mode of an ideal arm: the lowest of those modes that are
    /// orthogonal to the shapes in `others`.
    pub(super) fn improve(&mut self, pose: &Pose, ideal: &Ideal, others: &[Self], work: &mut BoxWork) {
        self.iterate(pose, ideal, &Twist::zeros(), work);
        self.clear_of(pose, ideal, others);
        self.energies(pose);
    }

    /// The Rayleigh quotient `xᵀKx / xᵀMx` \[1/s²\]. Infinite if the shape moves nothing.
    #[inline]
    pub(super) fn quotient(&self, ideal: &Ideal) -> f64 {
        let mut strain = 0.0;
        let kinetic = self.kinetic_energy(ideal.inertia);
        for (s, k) in self.strain.iter().zip(ideal.stiffness) {
            for i in 0..STIFFNESSES {
                strain += s[i] * k[i];
            }
        }
        if kinetic > 0.0 { strain / kinetic } else { f64::INFINITY }
    }

    /// Twice the kinetic energy of the shape per squared angular frequency, `xᵀMx`.
    #[inline]
    pub(super) fn kinetic_energy(&self, inertia: &[[f64; INERTIAS]]) -> f64 {
        let mut kinetic = self.kinetic_fixed;
        for (t, m) in self.kinetic.iter().zip(inertia) {
            for i in 0..INERTIAS {
                kinetic += t[i] * m[i];
            }
        }
        kinetic
    }

    /// Replaces this shape `x` by `C M x`, one step of inverse iteration, in which the base moves by `base`. Then the
    /// shape is scaled.
    fn iterate(&mut self, pose: &Pose, ideal: &Ideal, base: &Twist, work: &mut BoxWork) {
        inertia_forces(pose, ideal.inertia, base, &self.x, work);
        let mut largest = 0.0f64;
        for (piece, posed) in pose.pieces.iter().enumerate() {
            let here = piece * COORDINATES..(piece + 1) * COORDINATES;
            let (x, forces) = (&mut self.x[here.clone()], &work.forces[here]);
            let stiffness = &ideal.stiffness[piece];
            for (c, (x, force)) in x.iter_mut().zip(forces).enumerate().take(posed.coordinates()) {
                let stiffness = posed.coordinate_stiffness(c, stiffness);
                // A stiffness of 0 stands for a rigid coordinate.
                *x = if stiffness > 0.0 { force / stiffness } else { 0.0 };
                largest = largest.max(x.abs());
            }
        }
        // The scale of a shape is free. Scaling prevents overflow over many steps.
        if largest > 0.0 {
            self.x.iter_mut().for_each(|x| *x /= largest);
        }
    }

    /// Makes this shape orthogonal to the shapes in `others` with respect to the stiffness matrix `K`, so that it
    /// converges to a mode that differs from these.
    fn clear_of(&mut self, pose: &Pose, ideal: &Ideal, others: &[Self]) {
        for other in others {
            let (mut common, mut own) = (0.0, 0.0);
            for (piece, posed) in pose.pieces.iter().enumerate() {
                for c in 0..posed.coordinates() {
                    let at = piece * COORDINATES + c;
                    let work = other.x[at] * posed.coordinate_stiffness(c, &ideal.stiffness[piece]);
                    common += work * self.x[at];
                    own += work * other.x[at];
                }
            }
            if own > 0.0 {
                self.x.iter_mut().zip(&other.x).for_each(|(x, o)| *x -= common / own * o);
            }
        }
    }

    /// Computes the coefficients of `xᵀKx` and of `xᵀMx` for each piece.
    fn energies(&mut self, pose: &Pose) {
        let mut twist = Twist::zeros();
        self.kinetic_fixed = 0.0;
        for (piece, posed) in pose.pieces.iter().enumerate().rev() {
            let x = &self.x[piece * COORDINATES..(piece + 1) * COORDINATES];
            let (strain, kinetic) = (&mut self.strain[piece], &mut self.kinetic[piece]);
            match posed {
                PosedPiece::Joint { twist: axis, at_m, across } => {
                    kinetic[inertia::MASS] = displacement(&twist, at_m).norm_squared();
                    strain[TORSION] = x[0] * x[0];
                    strain[TILT] = x[1] * x[1] + x[2] * x[2];
                    // The mass of a joint is inboard of its springs, so its motion is computed before the motions of
                    // the springs are added.
                    twist += axis * x[0];
                    add_tilts(across, x, &mut twist);
                }
                PosedPiece::Body(body) => self.kinetic_fixed += twist.dot(&(body * twist)),
                PosedPiece::Tube(tube) => {
                    let local = Local::new(tube, &twist, x);
                    *kinetic = local.kinetic(tube);
                    self.kinetic_fixed += tube.bodies.as_ref().map_or(0.0, |bodies| {
                        let all = local.all();
                        all.dot(&(&bodies.inertia * &all))
                    });
                    *strain = [0.0; STIFFNESSES];
                    for (c, x) in x.iter().enumerate() {
                        strain[RESISTED[c].0] += x * x * tube.length_m / degree_factor(c);
                    }
                    tube.carry(&mut twist, x);
                }
            }
        }
        self.kinetic_fixed += twist.dot(&(pose.payload_inertia * twist));
    }
}

/// The dot product of two arrays.
pub(super) fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The sum of the dot products of two lists of arrays.
pub(super) fn products<const N: usize>(a: &[[f64; N]], b: &[[f64; N]]) -> f64 {
    a.iter().zip(b).map(|(a, b)| dot(a, b)).sum()
}

/// Writes `M x` to `work.forces`: the inertia force on every coordinate, divided by the squared angular frequency, when
/// the arm moves by `x` and its base by `base`. One pass goes outward and computes the motion, a second pass goes
/// inward and sums the forces. No matrix is formed.
pub(super) fn inertia_forces(
    pose: &Pose,
    inertia: &[[f64; INERTIAS]],
    base: &Twist,
    x: &[f64],
    work: &mut BoxWork,
) {
    work.momenta.clear();
    work.forces.resize(x.len(), 0.0);
    let mut twist = *base;
    for (piece, posed) in pose.pieces.iter().enumerate().rev() {
        let x = &x[piece * COORDINATES..(piece + 1) * COORDINATES];
        match posed {
            PosedPiece::Joint { twist: axis, at_m, across } => {
                let momentum = displacement(&twist, at_m) * inertia[piece][inertia::MASS];
                work.momenta.push(Momentum::Body(stack(&momentum, &at_m.cross(&momentum))));
                twist += axis * x[0];
                add_tilts(across, x, &mut twist);
            }
            PosedPiece::Body(body) => work.momenta.push(Momentum::Body(body * twist)),
            PosedPiece::Tube(tube) => {
                let local = Local::new(tube, &twist, x);
                work.momenta.push(Momentum::Tube(local.momentum(tube, &inertia[piece])));
                tube.carry(&mut twist, x);
            }
        }
    }
    let mut wrench: Wrench = pose.payload_inertia * twist;
    for (piece, posed) in pose.pieces.iter().enumerate() {
        let forces = &mut work.forces[piece * COORDINATES..(piece + 1) * COORDINATES];
        match (posed, work.momenta.pop()) {
            (PosedPiece::Joint { twist: axis, across, .. }, Some(Momentum::Body(momentum))) => {
                forces[0] = axis.dot(&wrench);
                for (force, tilt) in forces[TILT..].iter_mut().zip(across.iter().flatten()) {
                    *force = tilt.dot(&wrench);
                }
                wrench += momentum;
            }
            (PosedPiece::Body(_), Some(Momentum::Body(momentum))) => wrench += momentum,
            (PosedPiece::Tube(tube), Some(Momentum::Tube(local))) => {
                forces.copy_from_slice(&local.forces);
                for (end, coordinate) in ENDS.into_iter().enumerate() {
                    forces[coordinate] += tube.ends[end].dot(&wrench);
                }
                let force = tube.frame * local.root_force;
                let moment = tube.frame * local.root_moment + tube.root_m.cross(&force);
                wrench += stack(&force, &moment);
            }
            _ => {}
        }
    }
}

impl PosedPiece {
    /// Number of strain coordinates of the piece.
    pub(super) fn coordinates(&self) -> usize {
        match self {
            PosedPiece::Joint { across: None, .. } => 1,
            PosedPiece::Joint { across: Some(_), .. } => JOINT_COORDINATES,
            PosedPiece::Body(_) => 0,
            PosedPiece::Tube(_) => COORDINATES,
        }
    }

    /// Stiffness of a coordinate of the piece; 0 for a rigid coordinate. `stiffness` are the stiffnesses of the tube's
    /// section, or of the joint and its bearing.
    #[inline]
    pub(super) fn coordinate_stiffness(&self, coordinate: usize, stiffness: &[f64; STIFFNESSES]) -> f64 {
        match self {
            PosedPiece::Tube(tube) => {
                stiffness[RESISTED[coordinate].0] * tube.length_m / degree_factor(coordinate)
            }
            _ => stiffness[coordinate.min(TILT)],
        }
    }
}

/// Adds the motion that the two tilts of a joint's bearing cause to `twist`, the motion of everything outboard. `x` are
/// the coordinates of the joint.
#[inline]
fn add_tilts(across: &Option<[Twist; 2]>, x: &[f64], twist: &mut Twist) {
    for (tilt, x) in across.iter().flatten().zip(&x[TILT..]) {
        *twist += tilt * *x;
    }
}

/// Buffers of one step of inverse iteration.
#[derive(Default)]
pub(super) struct BoxWork {
    momenta: Vec<Momentum>,
    /// Inertia force on each strain coordinate. There are [`COORDINATES`] places for each piece, tip first.
    pub forces: Vec<f64>,
}

/// The momentum of a piece, stored on the way outward and used on the way inward.
enum Momentum {
    Body(Wrench),
    Tube(TubeMomentum),
}

/// The momentum of a tube in its section frame: force and moment at the root, and the generalized force on each
/// coordinate.
struct TubeMomentum {
    root_force: Vector3<f64>,
    root_moment: Vector3<f64>,
    forces: [f64; COORDINATES],
}

/// The displacement of a point \[m\] of a body that moves by a kinematic twist.
#[inline]
fn displacement(twist: &Twist, at_m: &Vector3<f64>) -> Vector3<f64> {
    linear(twist) + angular(twist).cross(at_m)
}

impl PosedTube {
    /// Adds the motion of the tube's end relative to its root to `twist`, the motion of everything outboard. `x` are
    /// the strain coordinates of the tube.
    #[inline]
    fn carry(&self, twist: &mut Twist, x: &[f64]) {
        for (end, coordinate) in ENDS.into_iter().enumerate() {
            *twist += self.ends[end] * x[coordinate];
        }
    }
}

/// The motion of a tube in its section frame, separated into two planes of bending (`z`, `y`), rotation about its axis
/// (`turn`) and translation along it (`along`).
struct Local {
    z: SVector<f64, 9>,
    y: SVector<f64, 9>,
    turn: SVector<f64, 4>,
    along: SVector<f64, 4>,
}

impl Local {
    #[inline]
    fn new(tube: &PosedTube, twist: &Twist, x: &[f64]) -> Self {
        let v = tube.frame.tr_mul(&displacement(twist, &tube.root_m));
        let w = tube.frame.tr_mul(&angular(twist));
        Self {
            z: SVector::from([v.z, w.y, x[0], x[1], x[2], x[3], x[8], x[9], x[10]]),
            y: SVector::from([v.y, w.z, x[4], x[5], x[6], x[7], x[11], x[12], x[13]]),
            turn: SVector::from([w.x, x[14], x[15], x[16]]),
            along: SVector::from([v.x, x[17], x[18], x[19]]),
        }
    }

    /// The momentum of the tube with the line inertias `line`, with the given bodies on it.
    #[inline]
    fn momentum(&self, tube: &PosedTube, line: &[f64; INERTIAS]) -> TubeMomentum {
        let f = &tube.forms;
        let across = line[inertia::MASS] + tube.added_kg_m3 * line[inertia::OUTER_AREA];
        let z = f.across_z * self.z * across + f.rotary_y * self.z * line[inertia::ROTARY_Y];
        let y = f.across_y * self.y * across + f.rotary_z * self.y * line[inertia::ROTARY_Z];
        let turn = f.polar * self.turn * line[inertia::POLAR];
        let along = f.along * self.along * line[inertia::MASS];
        let mut out = TubeMomentum {
            root_force: Vector3::new(along[0], y[0], z[0]),
            root_moment: Vector3::new(turn[0], z[1], y[1]),
            forces: [
                z[2], z[3], z[4], z[5], y[2], y[3], y[4], y[5], z[6], z[7], z[8], y[6], y[7], y[8], turn[1],
                turn[2], turn[3], along[1], along[2], along[3],
            ],
        };
        if let Some(bodies) = &tube.bodies {
            let momentum = &bodies.inertia * self.all();
            out.root_force += momentum.fixed_rows::<3>(0);
            out.root_moment += momentum.fixed_rows::<3>(3);
            out.forces.iter_mut().zip(momentum.iter().skip(6)).for_each(|(force, p)| *force += p);
        }
        out
    }

    /// Translation and rotation of the root, and then all coordinates in the order of their indices.
    fn all(&self) -> DVector<f64> {
        let (z, y, turn, along) = (&self.z, &self.y, &self.turn, &self.along);
        DVector::from_row_slice(&[
            along[0], y[0], z[0], turn[0], z[1], y[1], z[2], z[3], z[4], z[5], y[2], y[3], y[4], y[5], z[6],
            z[7], z[8], y[6], y[7], y[8], turn[1], turn[2], turn[3], along[1], along[2], along[3],
        ])
    }

    /// The coefficients of `xᵀMx` for each line inertia of the tube.
    #[inline]
    fn kinetic(&self, tube: &PosedTube) -> [f64; INERTIAS] {
        let f = &tube.forms;
        fn form<const N: usize>(m: &SMatrix<f64, N, N>, x: &SVector<f64, N>) -> f64 {
            x.dot(&(m * x)).max(0.0)
        }
        let across = form(&f.across_z, &self.z) + form(&f.across_y, &self.y);
        [
            across + form(&f.along, &self.along),
            across * tube.added_kg_m3,
            form(&f.polar, &self.turn),
            form(&f.rotary_y, &self.z),
            form(&f.rotary_z, &self.y),
        ]
    }
}
