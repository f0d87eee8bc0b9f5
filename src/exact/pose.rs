//! One case of a study as rows of numbers: for each strain coordinate, the generalized force that each weight causes
//! and the displacement of the tip. A strain coordinate is one way in which a piece deforms, such as the torsion of a
//! joint.

use super::bearing_rows::BearingRows;
use super::interval::interval;
use super::parts::INERTIAS;
use crate::mechanics::{Twist, Wrench};
use nalgebra::{DMatrix, Matrix3, Matrix6, SMatrix, Vector3};

/// A coefficient whose magnitude is below this fraction of the largest coefficient counts as rounding.
const ROUNDING: f64 = 1e-12;

/// Number of strain coordinates of a tube: curvatures of the bending along z and along y (4 each), shears along z and y
/// (3 each), torsion (3), stretch (3). They are polynomial coefficients along the tube.
pub(super) const COORDINATES: usize = 20;
/// Indices of the eight strain coordinates of a tube that move its end. The others deform the tube only between its
/// ends.
pub(super) const ENDS: [usize; 8] = [0, 1, 4, 5, 8, 11, 14, 17];
/// For each coordinate: the index of the stiffness of a [`Line`](super::parts::Line) that resists it, and the
/// degree of its polynomial.
pub(super) const RESISTED: [(usize, u8); COORDINATES] = [
    (0, 0),
    (0, 1),
    (0, 2),
    (0, 3),
    (1, 0),
    (1, 1),
    (1, 2),
    (1, 3),
    (2, 0),
    (2, 1),
    (2, 2),
    (2, 0),
    (2, 1),
    (2, 2),
    (3, 0),
    (3, 1),
    (3, 2),
    (4, 0),
    (4, 1),
    (4, 2),
];

/// Index of a joint's torsion among its coordinates, and of the stiffness that resists it.
pub(super) const TORSION: usize = 0;
/// Index of the first of the two tilts of a joint's output bearing, and of the stiffness that resists both.
pub(super) const TILT: usize = 1;
/// Number of strain coordinates of a joint whose bearing tilts: the torsion and two tilts.
pub(super) const JOINT_COORDINATES: usize = 3;

/// `2i + 1` for a coordinate whose polynomial has degree `i`. This factor equals the coordinate's compliance times the
/// stiffness of the section times the length of the tube.
pub(super) fn degree_factor(coordinate: usize) -> f64 {
    f64::from(2 * RESISTED[coordinate].1 + 1)
}

/// A case, compiled for bounds. Pieces are counted from the tip.
pub(super) struct Pose {
    /// Whether deflection and lowest mode are judged in this case.
    pub judged: bool,
    /// Whether drives and stresses are checked in this case.
    pub sizing: bool,
    /// Whether all contributions to the tip's displacement add up: no two of them have a negative dot product, whatever
    /// the weights of the parts are.
    pub contributions_align: bool,
    /// Density of the water around the arm \[kg/m³\], 0 in air. The net weight of a tube per length is
    /// `g (mass per length - water · outer area)`.
    pub water_kg_m3: f64,
    pub pieces: Vec<PosedPiece>,
    /// Inertia of the payload about the world's origin.
    pub payload_inertia: Matrix6<f64>,
    /// The rows of this case, tip first. A row gives the generalized force on one strain coordinate. There is a row for
    /// each coordinate that moves the end of its piece and that some load strains, and in any case for the torsion of
    /// each joint.
    pub rows: Vec<Row>,
    /// Loads on the end sections of the tubes whose section is chosen, tip first.
    pub stress: Vec<StressRow>,
    /// Inertia of everything outboard about each joint's axis; `None` for a piece that is not a joint.
    pub inertia_about: Vec<Option<InertiaRow>>,
    /// Loads on the output bearing of each joint. `None` for a joint whose bearing is not checked, for any other piece,
    /// and for all pieces if the case is not a sizing case.
    pub bearings: Vec<Option<BearingRows>>,
}

/// A piece in a pose.
pub(super) enum PosedPiece {
    /// A joint. `twist` is the motion of everything outboard per radian (metre for a prismatic joint), and `at_m` the
    /// place of its mass. `across` has the motions of everything outboard per radian of tilt of the output bearing
    /// about two axes at right angles to the joint axis; `None` if no option tilts.
    Joint { twist: Twist, at_m: Vector3<f64>, across: Option<[Twist; 2]> },
    /// A rigid body, with its inertia about the world's origin.
    Body(Matrix6<f64>),
    /// A tube.
    Tube(Box<PosedTube>),
}

/// A tube in a pose.
pub(super) struct PosedTube {
    pub length_m: f64,
    /// Position of the inboard end \[m\].
    pub root_m: Vector3<f64>,
    /// Axes of the section frame as columns, x along the tube.
    pub frame: Matrix3<f64>,
    /// Motion of everything outboard (a kinematic twist) per unit of each of the eight coordinates that move the tube's
    /// end ([`ENDS`]).
    pub ends: [Twist; 8],
    /// Inertia matrices of the tube over the motion of its root and its strain coordinates, per unit of each line
    /// inertia (inertia per metre).
    pub forms: TubeForms,
    /// Added mass of the water across the tube, per outer area and length \[kg/m³\].
    pub added_kg_m3: f64,
    /// Whether the section of the tube is chosen by the search.
    pub chosen: bool,
    /// The given bodies on the tube; `None` if there are none.
    pub bodies: Option<Box<PosedBodies>>,
    /// The loads of springs on the tube.
    pub pulls: Pulls,
}

/// Given bodies on a tube. Each of them moves with a point of the tube's axis.
pub(super) struct PosedBodies {
    /// Inertia matrix of the bodies over the six motions of the tube's root and all its strain coordinates, in the
    /// section frame.
    pub inertia: DMatrix<f64>,
    /// Inertia of the bodies about the world's origin, for the tube taken as rigid.
    pub rigid: Matrix6<f64>,
    /// Wrench of the weight of all bodies on the tube, about the world's origin.
    pub weight: Wrench,
    /// Generalized force of the bodies' weight on each of the eight coordinates that move the tube's end ([`ENDS`]).
    pub end_forces: [f64; 8],
}

/// The loads of springs on a tube.
#[derive(Default)]
pub(super) struct Pulls {
    /// Force and moment of all springs on the tube, about the world's origin.
    pub wrench: Wrench,
    /// Generalized force of the springs on each of the eight coordinates that move the tube's end ([`ENDS`]).
    pub end_forces: [f64; 8],
}

/// Matrices of the quadratic forms of kinetic energy. `across` and `rotary` are over
/// `(root translation, root rotation, curvatures, shears)` in one plane. `polar` is over `(root rotation, torsions)`
/// about the tube's axis, and `along` over `(root translation, stretches)` along it.
pub(super) struct TubeForms {
    pub across_z: SMatrix<f64, 9, 9>,
    pub across_y: SMatrix<f64, 9, 9>,
    pub rotary_y: SMatrix<f64, 9, 9>,
    pub rotary_z: SMatrix<f64, 9, 9>,
    pub polar: SMatrix<f64, 4, 4>,
    pub along: SMatrix<f64, 4, 4>,
}

/// The generalized force on one strain coordinate as a linear function of the weights, and the displacement of the tip
/// that this coordinate causes.
pub(super) struct Row {
    /// Index of the piece to which the coordinate belongs.
    pub piece: usize,
    /// Index of the strain coordinate within its piece. For a joint 0 is the torsion; 1 and 2 are the tilts of the
    /// bearing.
    pub coordinate: usize,
    /// Part of the generalized force that does not depend on the weight of any part, for example the force due to the
    /// payload \[N or N m\].
    pub fixed: f64,
    /// The generalized force per newton of each piece's weight, for every piece from the tip to `piece` itself.
    pub per_n: Vec<f64>,
    /// Displacement of the tip per unit of the strain coordinate, in x, y and z.
    pub tip_m: Vector3<f64>,
    /// Length of the vector `tip_m`.
    pub tip_m_per_unit: f64,
}

/// Loads on the section at one end of a tube whose section is chosen.
pub(super) struct StressRow {
    pub piece: usize,
    /// Axial force \[N\], moments about y and z, and torsion \[N m\]. Each is the sum of a constant and of one
    /// coefficient per weight \[N\] of a piece, tip first.
    pub loads: [(f64, Vec<f64>); 4],
}

/// Inertia of everything outboard about a joint's axis \[kg m²\]: `fixed + Σ per_line · inertia` over the line inertias
/// of the pieces outboard, tip first.
pub(super) struct InertiaRow {
    pub fixed: f64,
    pub per_line: Vec<[f64; INERTIAS]>,
}

impl Pose {
    /// Torque on the joint with this piece number \[N m\], as an interval that follows from `weights`, the weight
    /// intervals of the pieces \[N\]. Zero for a piece that is not a joint.
    pub(super) fn torque(&self, piece: usize, weights: &[[f64; 2]]) -> [f64; 2] {
        self.torsion(piece).map_or([0.0; 2], |row| interval(row.fixed, &row.per_n, weights))
    }

    /// Torque on a joint from the payload and all loads other than the weights of parts \[N m\].
    pub(super) fn payload_torque_nm(&self, piece: usize) -> f64 {
        self.torsion(piece).map_or(0.0, |row| row.fixed)
    }

    /// The row of a joint's torsion; `None` for a piece that is not a joint.
    fn torsion(&self, piece: usize) -> Option<&Row> {
        self.rows.iter().find(|row| row.piece == piece && row.coordinate == TORSION)
    }
}

impl Pose {
    /// Whether the magnitude of every force, and so of every demand on a joint, grows with every weight.
    pub(super) fn grows_with_weight(&self) -> bool {
        let loads = self.stress.iter().flat_map(|row| &row.loads);
        self.water_kg_m3 == 0.0
            && self.relevant_rows().all(|row| sign(row.fixed, &row.per_n).is_some())
            && loads.into_iter().all(|(fixed, per_n)| sign(*fixed, per_n).is_some())
    }

    /// Whether all contributions to the tip's displacement add up: no two of them have a negative dot product. Then the
    /// tip moves further if any part becomes more compliant.
    pub(super) fn contributions_align(&self) -> bool {
        let rows = self.relevant_rows();
        let ways: Vec<_> = rows.map(|row| row.tip_m * sign(row.fixed, &row.per_n).unwrap_or(0.0)).collect();
        // A right angle with rounding must not count as opposition.
        let agree = |a: &Vector3<f64>, b: &Vector3<f64>| a.dot(b) >= -ROUNDING * a.norm() * b.norm();
        ways.iter().enumerate().all(|(i, a)| ways[..i].iter().all(|b| agree(a, b)))
    }

    /// The rows that matter for the tests of signs: the rows of joint torsions, and the rows of coordinates that move
    /// the tip.
    fn relevant_rows(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| self.is_torsion(row) || row.tip_m.norm() > 0.0)
    }

    /// Whether `row` belongs to the torsion of a joint, and not to a tilt of its bearing or to a tube.
    pub(super) fn is_torsion(&self, row: &Row) -> bool {
        row.coordinate == TORSION && matches!(self.pieces[row.piece], PosedPiece::Joint { .. })
    }
}

impl PosedPiece {
    /// For a coordinate of this piece: the index of the stiffness that resists it, and a factor. The factor divided by
    /// this stiffness is the deflection per unit of force.
    #[inline]
    pub(super) fn resisted(&self, coordinate: usize) -> (usize, f64) {
        match self {
            PosedPiece::Tube(tube) => (RESISTED[coordinate].0, degree_factor(coordinate) / tube.length_m),
            // Both tilts of a bearing have one stiffness.
            _ => (coordinate.min(TILT), 1.0),
        }
    }
}

/// The common sign of the constant force `fixed` and of the coefficients `per_n` of the weights: 1 or -1. It is 0 if
/// all of them are zero, and `None` if their signs differ.
fn sign(fixed: f64, per_n: &[f64]) -> Option<f64> {
    let largest = per_n.iter().fold(0.0f64, |most, c| most.max(c.abs()));
    // The fixed force and the coefficients have different units. They are compared as if every weight were
    // one newton.
    let nothing = ROUNDING * largest.max(fixed.abs()).max(1.0);
    let numbers = || per_n.iter().chain([&fixed]);
    let (rise, fall) = (numbers().any(|c| *c > nothing), numbers().any(|c| *c < -nothing));
    match (rise, fall) {
        (true, true) => None,
        (true, false) => Some(1.0),
        (false, true) => Some(-1.0),
        (false, false) => Some(0.0),
    }
}
