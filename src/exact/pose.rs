//! One case of a study as rows of numbers: what each weight does to each coordinate.

use super::interval::interval;
use super::parts::INERTIAS;
use crate::mechanics::Twist;
use nalgebra::{Matrix3, Matrix6, SMatrix, Vector3};

/// Coefficients smaller than this share of the largest are rounding.
const NOTHING: f64 = 1e-12;

/// Coordinates of a tube: curvatures along z and y (4 each), shears (3 each), twist, stretch (3 each).
pub(super) const COORDINATES: usize = 20;
/// The coordinates that move a tube's end.
pub(super) const ENDS: [usize; 8] = [0, 1, 4, 5, 8, 11, 14, 17];
/// Which stiffness of a [`Line`](super::parts::Line) resists each coordinate, and its degree.
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

/// Compliance of a tube's coordinate times its stiffness and length: `2i + 1`.
pub(super) fn degree_factor(coordinate: usize) -> f64 {
    f64::from(2 * RESISTED[coordinate].1 + 1)
}

/// A case compiled for the bound. Pieces are counted from the tip.
pub(super) struct Pose {
    pub judged: bool,
    pub sizing: bool,
    /// Whether no two parts move the tip against each other.
    pub contributions_align: bool,
    /// Weight of the water in a tube's outer area over that of its mass: net weight per length is
    /// `g (mass - water area)`.
    pub water_kg_m3: f64,
    pub pieces: Vec<PosedPiece>,
    /// What the payload and massive offsets do to a wrench or an inertia before any part is chosen.
    pub payload_inertia: Matrix6<f64>,
    /// Every coordinate that any weight or load strains, tip first.
    pub rows: Vec<Row>,
    pub stress: Vec<StressRow>,
    /// Inertia about each joint's axis.
    pub inertia_about: Vec<Option<InertiaRow>>,
}

/// A piece in a pose.
pub(super) enum PosedPiece {
    /// A joint: its twist, and where its mass is.
    Joint { twist: Twist, at_m: Vector3<f64> },
    /// A point mass, already counted.
    Body(Matrix6<f64>),
    /// A tube.
    Tube(Box<PosedTube>),
}

/// A tube in a pose.
pub(super) struct PosedTube {
    pub length_m: f64,
    pub root_m: Vector3<f64>,
    pub frame: Matrix3<f64>,
    /// Twist of everything outboard per unit of each of [`ENDS`].
    pub ends: [Twist; 8],
    /// Inertia over root motion and coordinates per unit of line density.
    pub forms: TubeForms,
    /// Added mass across the tube per outer area \[kg/m³\].
    pub added_kg_m3: f64,
    /// Whether its section is a choice.
    pub chosen: bool,
}

/// Inertia forms over `(root translation, root rotation, curvatures, shears)` of each plane, and over
/// `(root rotation, twists)` and `(root translation, stretches)` along the tube.
pub(super) struct TubeForms {
    pub across_z: SMatrix<f64, 9, 9>,
    pub across_y: SMatrix<f64, 9, 9>,
    pub rotary_y: SMatrix<f64, 9, 9>,
    pub rotary_z: SMatrix<f64, 9, 9>,
    pub polar: SMatrix<f64, 4, 4>,
    pub along: SMatrix<f64, 4, 4>,
}

/// The force on a strain coordinate and what it does to the tip.
pub(super) struct Row {
    pub piece: usize,
    /// Coordinate of a tube; 0 for a joint.
    pub coordinate: usize,
    /// Force without any weight of parts.
    pub fixed: f64,
    /// Force per newton of each piece's weight, up to and including `piece`.
    pub per_n: Vec<f64>,
    /// Displacement of the tip per unit of the coordinate, and how far that is.
    pub tip_m: Vector3<f64>,
    pub tip_m_per_unit: f64,
}

/// Force and moments at an end of an open tube.
pub(super) struct StressRow {
    pub piece: usize,
    /// Axial force, moments about y and z, torsion, as `fixed + per_n · weights`.
    pub loads: [(f64, Vec<f64>); 4],
}

/// Inertia about a joint's axis: `fixed + Σ per_line · inertias` of the pieces outboard.
pub(super) struct InertiaRow {
    pub fixed: f64,
    pub per_line: Vec<[f64; INERTIAS]>,
}

impl Pose {
    /// Torque on a joint as an interval \[N m\].
    pub fn torque(&self, piece: usize, weights: &[[f64; 2]]) -> [f64; 2] {
        let row = self.rows.iter().find(|row| row.piece == piece);
        row.map_or([0.0; 2], |row| interval(row.fixed, &row.per_n, weights))
    }

    /// Torque on a joint without the weight of any part \[N m\].
    pub fn payload_torque_nm(&self, piece: usize) -> f64 {
        self.rows.iter().find(|row| row.piece == piece).map_or(0.0, |row| row.fixed)
    }
}

impl Pose {
    /// Whether every force, and so every demand, grows with every weight.
    pub fn grows_with_weight(&self) -> bool {
        let loads = self.stress.iter().flat_map(|row| &row.loads);
        self.water_kg_m3 == 0.0
            && self.relevant_rows().all(|row| sign(row.fixed, &row.per_n).is_some())
            && loads.into_iter().all(|(fixed, per_n)| sign(*fixed, per_n).is_some())
    }

    /// Whether the parts of the arm move the tip in directions no two of which oppose: then it moves further
    /// if any of them yields more.
    pub fn contributions_align(&self) -> bool {
        let rows = self.relevant_rows();
        let ways: Vec<_> = rows.map(|row| row.tip_m * sign(row.fixed, &row.per_n).unwrap_or(0.0)).collect();
        let agree = |a: &Vector3<f64>, b: &Vector3<f64>| a.dot(b) >= -NOTHING * a.norm() * b.norm();
        ways.iter().enumerate().all(|(i, a)| ways[..i].iter().all(|b| agree(a, b)))
    }

    /// Joints, and what moves the tip.
    fn relevant_rows(&self) -> impl Iterator<Item = &Row> {
        let is_joint = |row: &Row| matches!(self.pieces[row.piece], PosedPiece::Joint { .. });
        self.rows.iter().filter(move |row| is_joint(row) || row.tip_m.norm() > 0.0)
    }
}

/// The one sign of a force and all its parts, 0 if there is none; `None` if they differ.
fn sign(fixed: f64, per_n: &[f64]) -> Option<f64> {
    let largest = per_n.iter().fold(0.0f64, |most, c| most.max(c.abs()));
    // a fixed force is compared in the same measure: as if it were that of one newton or more
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
