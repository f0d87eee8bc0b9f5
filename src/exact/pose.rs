//! One case of a study as rows of numbers: the effect of each weight on each strain coordinate.

use super::bearing_rows::BearingRows;
use super::interval::interval;
use super::parts::INERTIAS;
use crate::mechanics::{Twist, Wrench};
use nalgebra::{DMatrix, Matrix3, Matrix6, SMatrix, Vector3};

/// Coefficients below this part of the largest are rounding.
const NOTHING: f64 = 1e-12;

/// Number of strain coordinates of a tube: curvatures along z and y (4 each), shears along z and y (3 each),
/// twists (3), stretches (3).
pub(super) const COORDINATES: usize = 20;
/// The coordinates that move the end of a tube.
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

/// The coordinate of a joint's torsion, and the stiffness that resists it. Coordinates after it are the tilts of the
/// bearing, which one stiffness resists.
pub(super) const TORSION: usize = 0;
pub(super) const TILT: usize = 1;
/// Number of strain coordinates of a joint that tilts.
pub(super) const JOINT_COORDINATES: usize = 3;

/// `2i + 1` for a polynomial of degree `i`: the compliance of a coordinate times its stiffness and the tube's
/// length.
pub(super) fn degree_factor(coordinate: usize) -> f64 {
    f64::from(2 * RESISTED[coordinate].1 + 1)
}

/// A case, compiled for bounds. Pieces are counted from the tip.
pub(super) struct Pose {
    pub judged: bool,
    pub sizing: bool,
    /// Whether no two contributions to the tip's displacement may have opposite signs.
    pub contributions_align: bool,
    /// Density of the water around the arm, 0 in air \[kg/m³\]. The net weight per length of a tube is `g
    /// (mass - water · outer area)`.
    pub water_kg_m3: f64,
    pub pieces: Vec<PosedPiece>,
    /// Inertia of the payload, before any part is chosen.
    pub payload_inertia: Matrix6<f64>,
    /// The rows of all coordinates that are strained by a weight or by another load, tip first.
    pub rows: Vec<Row>,
    pub stress: Vec<StressRow>,
    /// Inertia about each joint's axis; `None` for a piece that is no joint.
    pub inertia_about: Vec<Option<InertiaRow>>,
    /// Loads on the output bearing of each joint; `None` where the case sizes nothing or no bearing is checked.
    pub bearings: Vec<Option<BearingRows>>,
}

/// A piece in a pose.
pub(super) enum PosedPiece {
    /// A joint: its unit twist, the point of its mass, and the unit twists about the two axes across its own,
    /// about which the output bearing tilts; `None` if no option tilts.
    Joint { twist: Twist, at_m: Vector3<f64>, across: Option<[Twist; 2]> },
    /// The inertia of a given body.
    Body(Matrix6<f64>),
    /// A tube.
    Tube(Box<PosedTube>),
}

/// A tube in a pose.
pub(super) struct PosedTube {
    pub length_m: f64,
    pub root_m: Vector3<f64>,
    pub frame: Matrix3<f64>,
    /// Twist of everything outboard per unit of each of the coordinates [`ENDS`].
    pub ends: [Twist; 8],
    /// Inertia forms over the motion of the root and the coordinates, per unit of each line inertia.
    pub forms: TubeForms,
    /// Added mass across the tube per outer area \[kg/m³\].
    pub added_kg_m3: f64,
    /// Whether its section is chosen by the search.
    pub chosen: bool,
    /// The bodies on the tube; `None` if there are none.
    pub bodies: Option<Box<PosedBodies>>,
    /// What springs do to the tube.
    pub pulls: Pulls,
}

/// Given bodies on a tube, each of which moves with a point of the axis.
pub(super) struct PosedBodies {
    /// Inertia over the motion of the root and the coordinates, in the section frame.
    pub inertia: DMatrix<f64>,
    /// Inertia about the world's origin, if the tube does not yield.
    pub rigid: Matrix6<f64>,
    pub weight: Wrench,
    /// Force of the weight on each of the coordinates [`ENDS`].
    pub end_forces: [f64; 8],
}

/// What springs do to a tube.
#[derive(Default)]
pub(super) struct Pulls {
    /// Force and moment about the world's origin.
    pub wrench: Wrench,
    /// Force on each of the coordinates [`ENDS`].
    pub end_forces: [f64; 8],
}

/// Quadratic forms of kinetic energy. In each plane they are over `(root translation, root rotation,
/// curvatures, shears)`; along the tube over `(root rotation, twists)` and `(root translation, stretches)`.
pub(super) struct TubeForms {
    pub across_z: SMatrix<f64, 9, 9>,
    pub across_y: SMatrix<f64, 9, 9>,
    pub rotary_y: SMatrix<f64, 9, 9>,
    pub rotary_z: SMatrix<f64, 9, 9>,
    pub polar: SMatrix<f64, 4, 4>,
    pub along: SMatrix<f64, 4, 4>,
}

/// The force on a strain coordinate, as a linear function of the weights, and the displacement of the tip by this
/// coordinate.
pub(super) struct Row {
    pub piece: usize,
    /// Index of a tube's coordinate. For a joint 0 is the torsion, 1 and 2 are the tilts of its bearing.
    pub coordinate: usize,
    /// Force without the weight of any part \[N or N m\].
    pub fixed: f64,
    /// For each piece up to and including `piece`, the force per newton of the piece's weight.
    pub per_n: Vec<f64>,
    /// Displacement of the tip per unit of the coordinate. `tip_m_per_unit` is the length of this vector.
    pub tip_m: Vector3<f64>,
    pub tip_m_per_unit: f64,
}

/// Force and moments on the section at an end of a chosen tube.
pub(super) struct StressRow {
    pub piece: usize,
    /// Axial force, moments about y and z, and torsion, each as `fixed + per_n · weights`.
    pub loads: [(f64, Vec<f64>); 4],
}

/// Inertia about a joint's axis \[kg m²\]: `fixed + Σ per_line · inertias` of the pieces outboard.
pub(super) struct InertiaRow {
    pub fixed: f64,
    pub per_line: Vec<[f64; INERTIAS]>,
}

impl Pose {
    /// Torque on a joint, as an interval \[N m\].
    pub(super) fn torque(&self, piece: usize, weights: &[[f64; 2]]) -> [f64; 2] {
        self.torsion(piece).map_or([0.0; 2], |row| interval(row.fixed, &row.per_n, weights))
    }

    /// Torque on a joint without the weight of any part \[N m\].
    pub(super) fn payload_torque_nm(&self, piece: usize) -> f64 {
        self.torsion(piece).map_or(0.0, |row| row.fixed)
    }

    /// The row of a joint's torsion.
    fn torsion(&self, piece: usize) -> Option<&Row> {
        self.rows.iter().find(|row| row.piece == piece && row.coordinate == TORSION)
    }
}

impl Pose {
    /// Whether every force, and so every demand on a joint, grows with every weight.
    pub(super) fn grows_with_weight(&self) -> bool {
        let loads = self.stress.iter().flat_map(|row| &row.loads);
        self.water_kg_m3 == 0.0
            && self.relevant_rows().all(|row| sign(row.fixed, &row.per_n).is_some())
            && loads.into_iter().all(|(fixed, per_n)| sign(*fixed, per_n).is_some())
    }

    /// Whether no two contributions to the tip's displacement may have opposite signs. Then the tip moves further if
    /// any part yields more.
    pub(super) fn contributions_align(&self) -> bool {
        let rows = self.relevant_rows();
        let ways: Vec<_> = rows.map(|row| row.tip_m * sign(row.fixed, &row.per_n).unwrap_or(0.0)).collect();
        // Rounding of right angles must not count as opposition.
        let agree = |a: &Vector3<f64>, b: &Vector3<f64>| a.dot(b) >= -NOTHING * a.norm() * b.norm();
        ways.iter().enumerate().all(|(i, a)| ways[..i].iter().all(|b| agree(a, b)))
    }

    /// The rows of torsions, and the rows of coordinates that move the tip.
    fn relevant_rows(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| self.is_torsion(row) || row.tip_m.norm() > 0.0)
    }

    /// Whether a row is that of a joint's torsion.
    pub(super) fn is_torsion(&self, row: &Row) -> bool {
        row.coordinate == TORSION && matches!(self.pieces[row.piece], PosedPiece::Joint { .. })
    }
}

impl PosedPiece {
    /// The index of the stiffness that resists a coordinate, and what the coordinate yields per force times that
    /// stiffness.
    #[inline]
    pub(super) fn resisted(&self, coordinate: usize) -> (usize, f64) {
        match self {
            PosedPiece::Tube(tube) => (RESISTED[coordinate].0, degree_factor(coordinate) / tube.length_m),
            // Both tilts of a bearing have one stiffness.
            _ => (coordinate.min(TILT), 1.0),
        }
    }
}

/// The common sign of the fixed part of a force and of its parts per weight. It is 0 if all are zero, and `None` if
/// signs differ.
fn sign(fixed: f64, per_n: &[f64]) -> Option<f64> {
    let largest = per_n.iter().fold(0.0f64, |most, c| most.max(c.abs()));
    // The fixed force and the coefficients have different units. They are compared as if every weight were
    // one newton.
    let nothing = NOTHING * largest.max(fixed.abs()).max(1.0);
    let numbers = || per_n.iter().chain([&fixed]);
    let (rise, fall) = (numbers().any(|c| *c > nothing), numbers().any(|c| *c < -nothing));
    match (rise, fall) {
        (true, true) => None,
        (true, false) => Some(1.0),
        (false, true) => Some(-1.0),
        (false, false) => Some(0.0),
    }
}
